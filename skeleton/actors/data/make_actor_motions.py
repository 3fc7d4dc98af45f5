#!/usr/bin/env python3
"""Reduces BVH files to the 20 joints of base/body.h, 30 a second, as a joint list (see
skeleton/actors/joint_recording.h): make_actor_motions.py IN.bvh OUT.csv SCALE_TO_METRES UP FIRST
UP is the source's upward axis, y or z; FIRST the first frame to take (CMU's own is a T). The lowest
joint of all frames gets the height of an ankle's underside.

Joints where these bodies have none: hip_center and shoulder_center lie between the two hips and a
little above the two shoulders, spine between them, hands beyond wrists.
"""
import math
import sys

# Per rig: hip, knee, ankle, toes; shoulder, elbow, wrist, finger; head; forms with {} per side.
RIGS = {
    "LeftUpLeg": dict(sides=("Left", "Right"), leg=["{}UpLeg", "{}Leg", "{}Foot", "{}ToeBase"],
                      arm=["{}Arm", "{}ForeArm", "{}Hand", "{}HandIndex"], head="Head", neck="Neck1"),
    "UpLeg_L": dict(sides=("_L", "_R"), leg=["UpLeg{}", "LoLeg{}", "Foot{}", "Toe{}"],
                    arm=["UpArm{}", "LoArm{}", "Hand{}", "Middle1{}"], head="Head", neck="Neck"),
    "upperleg01.L": dict(sides=(".L", ".R"), leg=["upperleg01{}", "lowerleg01{}", "foot{}", "toe2-1{}"],
                         arm=["upperarm01{}", "lowerarm01{}", "wrist{}", "finger3-1{}"], head="head",
                         neck="neck01"),
}


def rotation(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {"X": [[1, 0, 0], [0, c, -s], [0, s, c]], "Y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
            "Z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis]


def mul(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def apply(m, v):
    return [sum(m[i][k] * v[k] for k in range(3)) for i in range(3)]


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def mix(a, b, w):
    return [x + (y - x) * w for x, y in zip(a, b)]


def read(path):
    tokens = open(path).read().split()
    joints, stack, i = [], [], 0  # name, parent, offset, channels
    while tokens[i] != "MOTION":
        t = tokens[i]
        if t in ("ROOT", "JOINT", "End"):
            joints.append([tokens[i + 1] if t != "End" else "", stack[-1] if stack else -1, None, []])
            stack.append(len(joints) - 1)
            i += 2
        elif t == "}":
            stack.pop()
            i += 1
        elif t == "OFFSET":
            joints[stack[-1]][2] = [float(x) for x in tokens[i + 1:i + 4]]
            i += 4
        elif t == "CHANNELS":
            n = int(tokens[i + 1])
            joints[stack[-1]][3] = tokens[i + 2:i + 2 + n]
            i += 2 + n
        else:
            i += 1
    frames, step = int(tokens[i + 2]), float(tokens[i + 5])
    numbers = [float(x) for x in tokens[i + 6:]]
    width = sum(len(j[3]) for j in joints)
    assert len(numbers) == frames * width
    return joints, step, [numbers[k * width:(k + 1) * width] for k in range(frames)]


def pose(joints, row):
    at, places, turns = 0, [], []
    for _, parent, offset, channels in joints:
        shift, turn = list(offset), [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        values = dict(zip(channels, row[at:at + len(channels)]))
        at += len(channels)
        if parent < 0 and "Xposition" in values:
            shift = [values[a + "position"] for a in "XYZ"]
        for c in channels:
            if c.endswith("rotation"):
                turn = mul(turn, rotation(c[0], values[c]))
        if parent < 0:
            places.append(shift)
            turns.append(turn)
        else:
            places.append(add(places[parent], apply(turns[parent], shift)))
            turns.append(mul(turns[parent], turn))
    return {j[0]: p for j, p in zip(joints, places)}


def kinect(rig, p):
    def limb(kind, side):
        return [p[n.format(rig["sides"][side])] for n in rig[kind]]
    p["LeftHandIndex"], p["RightHandIndex"] = p.get("LFingers"), p.get("RFingers")
    arms, legs = [limb("arm", s) for s in (0, 1)], [limb("leg", s) for s in (0, 1)]
    hips, shoulders = mix(legs[0][0], legs[1][0], 0.5), mix(arms[0][0], arms[1][0], 0.5)
    hip_center = mix(hips, shoulders, 0.09)
    shoulder_center = mix(shoulders, p[rig["neck"]], 0.5)
    head = add(p[rig["head"]], mix([0, 0, 0], [a - b for a, b in zip(p[rig["head"]], p[rig["neck"]])], 0.7))
    return ([hip_center, mix(hip_center, shoulder_center, 0.28), shoulder_center, head] + arms[0] +
            arms[1] + legs[0] + legs[1])


def main(source, out, scale, up, first):
    joints, step, rows = read(source)
    rows = rows[int(first):]
    names = {j[0] for j in joints}
    rig = next(r for key, r in RIGS.items() if key in names)
    scale = float(scale)
    count = max(1, int((len(rows) - 1) * step * 30 + 1e-6) + 1)
    frames = []
    for k in range(count):
        at = min(k / 30 / step, len(rows) - 1)
        i = min(int(at), len(rows) - 1)
        a = kinect(rig, pose(joints, rows[i]))
        b = kinect(rig, pose(joints, rows[min(i + 1, len(rows) - 1)]))
        points = [[c * scale for c in mix(u, v, at - i)] for u, v in zip(a, b)]
        frames.append([[q[0], q[2], -q[1]] if up == "z" else q for q in points])
    floor = min(q[1] for points in frames for q in points) - 0.04
    with open(out, "w") as f:
        f.write("kinoscope joints,1,30\n")
        for points in frames:
            f.write(",".join(str(round(1000 * (c - (floor if k == 1 else 0))))
                             for q in points for k, c in enumerate(q)) + "\n")
    print(out, count, "frames")


main(*sys.argv[1:])
