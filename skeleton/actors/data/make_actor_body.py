#!/usr/bin/env python3
"""Writes actor_body.bin from MakeHuman's base mesh, skeleton and weights.

  make_actor_body.py base.obj default.mhskel default_weights.mhw actor_body.bin

Keeps the mesh group "body", merges the 163 bones into those of actor_bone.h, and keeps each
vertex's four largest weights. Layout, little endian: the magic "KACTOR1\\0"; vertices, quads, bones
(u32 each); bones: head and tail (6 float32, m); the 20 joints of base/body.h (3 float32 each, m);
vertices (3 int16, unit 0.1 mm); quads (4 uint16); weights (4 times bone u8, weight u8; the weights
of a vertex sum to 255). x to the person's left, y up from the floor, z forward.
"""
import json
import struct
import sys

CENTER = {
    "pelvis": (["root", "pelvis.L", "pelvis.R", "spine05"], "spine05", "spine04"),
    "waist": (["spine04", "spine03"], "spine04", "spine02"),
    "chest": (["spine02", "spine01", "breast.L", "breast.R"], "spine02", "neck01"),
    "neck": (["neck01", "neck02", "neck03"], "neck01", "head"),
    "head": (None, "head", "head:tail"),  # and whatever hangs on it
}
FINGERS = [f"finger{i}" for i in (2, 3, 4, 5)]
TOES = [f"toe{i}-{k}" for i in (1, 2, 3, 4, 5) for k in (1, 2, 3) if not (i == 1 and k == 3)]
SIDE = {
    "clavicle": (["clavicle", "shoulder01"], "clavicle", "upperarm01"),
    "upper_arm_high": (["upperarm01"], "upperarm01", "lowerarm01"),
    "upper_arm_low": (["upperarm02"], "upperarm02", "lowerarm01"),
    "forearm_high": (["lowerarm01"], "lowerarm01", "wrist"),
    "forearm_low": (["lowerarm02"], "lowerarm02", "wrist"),
    "hand": (["wrist"] + [f"metacarpal{i}" for i in (1, 2, 3, 4)], "wrist", "finger3-1"),
    "fingers": ([f + "-1" for f in FINGERS], "finger3-1", "finger3-2"),
    "finger_tips": ([f + k for f in FINGERS for k in ("-2", "-3")], "finger3-2", "finger3-3:tail"),
    "thumb": (["finger1-1", "finger1-2", "finger1-3"], "finger1-1", "finger1-3:tail"),
    "thigh_high": (["upperleg01"], "upperleg01", "lowerleg01"),
    "thigh_low": (["upperleg02"], "upperleg02", "lowerleg01"),
    "shin_high": (["lowerleg01"], "lowerleg01", "foot"),
    "shin_low": (["lowerleg02"], "lowerleg02", "foot"),
    "foot": (["foot"], "foot", "toe3-1"),
    "toes": (TOES, "toe3-1", "toe3-3:tail"),
}


def main(obj, skeleton_file, weights_file, out):
    vertices, quads, group = [], [], None
    for line in open(obj):
        t = line.split()
        if not t:
            continue
        if t[0] == "v":
            vertices.append([float(c) / 10 for c in t[1:4]])  # decimetres
        elif t[0] == "g":
            group = t[1]
        elif t[0] == "f" and group == "body":
            quads.append([int(c.split("/")[0]) - 1 for c in t[1:]])
    count = 1 + max(max(q) for q in quads)
    assert len({i for q in quads for i in q}) == count
    floor = min(v[1] for v in vertices[:count])
    for v in vertices:
        v[1] -= floor

    skeleton = json.load(open(skeleton_file))

    def place(joint):
        ring = skeleton["joints"][joint]
        return [sum(vertices[i][k] for i in ring) / len(ring) for k in range(3)]

    def end_of(name, side):
        bone, _, tail = name.partition(":")
        bone += side if bone + side in skeleton["bones"] else ""
        return place(skeleton["bones"][bone]["tail" if tail else "head"])

    bones = [(n, parts, h, t, "") for n, (parts, h, t) in CENTER.items()]
    for side in (".L", ".R"):
        for n, (parts, h, t) in SIDE.items():
            bones.append((n + side, [p + side for p in parts], h, t, side))
    bone_of = {p: i for i, b in enumerate(bones) if b[1] for p in b[1]}
    head = [b[0] for b in bones].index("head")

    weights = [{} for _ in range(count)]
    for name, rows in json.load(open(weights_file))["weights"].items():
        bone = bone_of.get(name, head)
        for i, w in rows:
            if i < count:
                weights[i][bone] = weights[i].get(bone, 0) + w

    def middle(points):
        return [sum(p[k] for p in points) / len(points) for k in range(3)]

    def side_joint(name, side):
        if name == "hand":
            return middle([place(skeleton["bones"][f"metacarpal{i}{side}"]["tail"])
                           for i in (1, 2, 3, 4)])
        if name == "ball":
            return middle([place(skeleton["bones"][f"toe{i}-1{side}"]["head"]) for i in (1, 2, 3, 4)])
        return place(skeleton["bones"][name + side]["head"])

    hips = middle([side_joint("upperleg01", s) for s in (".L", ".R")])
    shoulders = middle([side_joint("upperarm01", s) for s in (".L", ".R")])
    hip_center = [0, hips[1] + 0.05, hips[2] + 0.01]
    shoulder_center = [0, shoulders[1] + 0.035, 0.01]
    spine = [0, hip_center[1] + 0.28 * (shoulder_center[1] - hip_center[1]), 0.03]
    skull = [0, place(skeleton["bones"]["head"]["head"])[1] + 0.055, 0.035]
    joints = [hip_center, spine, shoulder_center, skull]
    for chain in (["upperarm01", "lowerarm01", "wrist", "hand"],
                  ["upperleg01", "lowerleg01", "foot", "ball"]):
        for side in (".L", ".R"):
            joints += [side_joint(n, side) for n in chain]
    # Kinect order: left arm, right arm, left leg, right leg.

    with open(out, "wb") as f:
        f.write(b"KACTOR1\0" + struct.pack("<3I", count, len(quads), len(bones)))
        for _, _, h, t, side in bones:
            f.write(struct.pack("<6f", *end_of(h, side), *end_of(t, side)))
        for j in joints:
            f.write(struct.pack("<3f", *j))
        for v in vertices[:count]:
            f.write(struct.pack("<3h", *(round(c * 1e4) for c in v)))
        for q in quads:
            f.write(struct.pack("<4H", *q))
        for i, w in enumerate(weights):
            best = sorted(w.items(), key=lambda p: (-p[1], p[0]))[:4]
            total = sum(p[1] for p in best)
            assert total > 0, i
            rounded = [[b, round(255 * p / total)] for b, p in best]
            rounded[0][1] += 255 - sum(r[1] for r in rounded)
            rounded += [[0, 0]] * (4 - len(rounded))
            f.write(bytes(x for r in rounded for x in r))
    print(count, "vertices", len(quads), "quads", [b[0] for b in bones])


main(*sys.argv[1:])
