#!/usr/bin/env python3
"""Reduces Kinect v2 logs to the 20 joints of base/body.h, 30 frames a second, whole millimetres
(skeleton/actors/joint_recording.h): make_motion_logs.py FOLDER_OF_DATA_SETS

Of the 25 joints SpineBase, SpineMid and SpineShoulder become hip_center, spine and shoulder_center;
neck, hand tips and thumbs are dropped. Camera space is kept (y up, right-handed).
"""
import csv
import gzip
import sys

V2 = ("SpineBase SpineMid Neck Head ShoulderLeft ElbowLeft WristLeft HandLeft ShoulderRight "
      "ElbowRight WristRight HandRight HipLeft KneeLeft AnkleLeft FootLeft HipRight KneeRight "
      "AnkleRight FootRight SpineShoulder HandTipLeft ThumbLeft HandTipRight ThumbRight").split()
V1 = ["SpineBase", "SpineMid", "SpineShoulder"] + V2[3:20]


def laban(path):
    for row in csv.reader(open(path)):
        n = [float(x) for x in row if x != ""]
        yield n[0] * 1e-7, [n[1 + 4 * V2.index(j):4 + 4 * V2.index(j)] for j in V1]


def keraal(path):
    for k, line in enumerate(gzip.open(path, "rt")):
        n = [float(x) for x in line.split()]
        if len(n) == 175:
            yield k / 30, [n[7 * V2.index(j):7 * V2.index(j) + 3] for j in V1]


def multitrack(path, scenario, person):
    sensor = None
    for row in csv.DictReader(gzip.open(path, "rt"), skipinitialspace=True):
        if row["Scenario_Id"] != scenario or row["Person_Id"] != person:
            continue
        sensor = sensor or row["Kinect_Id"]
        if row["Kinect_Id"] == sensor:
            yield (float(row["Tracker_Time"]) * 1e-3,
                   [[float(row[f"{j}_{a}"]) for a in "XYZ"] for j in V1])


def longest(frames):
    """The longest stretch without a gap of half a second; times rise."""
    best, run = [], []
    for f in frames:
        if run and f[0] <= run[-1][0]:
            continue
        if run and f[0] - run[-1][0] > 0.5:
            run = []
        run.append(f)
        if len(run) > len(best):
            best = run
    return best


def write(out, frames, most, note, skip=0):
    frames = longest(frames)[skip:]
    rows, i = [], 0
    for k in range(most):
        t = frames[0][0] + k / 30
        if t > frames[-1][0]:
            break
        while i + 2 < len(frames) and frames[i + 1][0] <= t:
            i += 1
        (t0, a), (t1, b) = frames[i], frames[i + 1]
        w = min(max((t - t0) / (t1 - t0), 0), 1)
        rows.append(",".join(str(round(1000 * (p + (q - p) * w)))
                             for u, v in zip(a, b) for p, q in zip(u, v)))
    with open(out, "w") as f:
        f.write("kinoscope joints,1,30\n# " + note + "\n" + "\n".join(rows) + "\n")
    print(out, len(rows), "frames of", len(frames))


def main(root):
    folder = root + "/skeleton-kinect2-laban-gestures/"
    for name, out in (("Ges01_wavehand", "laban-wave"), ("Ges03_drawlines", "laban-draw"),
                      ("Ges05_demopoint", "laban-point")):
        write(out + ".csv", laban(folder + name + ".csv"), 400, "LabanotationSuite " + name)
    # Nearer than the legs can be seen; before and after, the tracker folds them.
    write("laban-arms.csv", laban(folder + "joints.csv"), 270, "LabanotationSuite joints", 40)
    write("keraal-ctk.csv", keraal(root + "/skeleton-keraal-kinect2-vicon/"
                                   "G3-Kinect-CTK-P1T1-Unknown-C-0.txt.gz"), 400, "Keraal CTK, Kinect")
    folder = root + "/skeleton-kinect2-multitrack/"
    study4 = folder + "Study_4_Kinect_1_Time_1_22_06_PM.csv.gz"
    study24 = folder + "Study_24_Kinect_1_Time_2_49_46_PM.csv.gz"
    for scenario in "23":
        write(f"multitrack-4-{scenario}.csv", multitrack(study4, scenario, "0"), 330,
              f"KinectMultiTrack study 4, scenario {scenario}")
    for person in "01":
        write(f"multitrack-24-{person}.csv", multitrack(study24, "4", person), 160,
              f"KinectMultiTrack study 24, scenario 4, person {person}")


main(*sys.argv[1:])
