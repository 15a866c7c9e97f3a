"""Converts grasps with three BioTac SP fingertips to the arrays of real_grasps.toml and real_grasps_new_objects.toml.

python convert_grasps.py FOLDER OUT

FOLDER is a copy of github.com/3dperceptionlab/biotacsp-stability-set-v2 (MIT): tables bts3v2_palm_{down,side,45}.csv of 41 objects and
bts3v2_palm_{down,side,45}_test.csv of 10 new objects. A row has the object, whether it slipped when it was lifted, and 24 electrodes of each of the fingertips
ff (index), mf (middle) and th (thumb).

OUT receives, for n = 4682 grasps of the 41 objects, and with _test after the name for 1149 grasps of the new objects:
- frames.npy         uint16, n × 72: electrodes of ff, mf and th, 12 bits
- ff.npy, mf.npy, th.npy  uint16, n × 24: electrodes of one fingertip
- labels.npy         text, n: slipped or stable
- objects.npy        text, n: the object
- palms.npy          text, n: down, side or 45
- grasps.npy         int64, n: a number for each grasp, so that each grasp is a group of its own
- recorded.toml      the table [recorded] for `bubbletouch audit OUT`: grasps grouped by object, with the new objects as test set
"""

import csv
import sys
from pathlib import Path

import numpy as np

PALMS = ["down", "side", "45"]
FINGERS = ["ff", "mf", "th"]
RECORDED = """[recorded]
frames = "frames.npy"
labels = "labels.npy"
groups = "objects.npy"
frames_test = "frames_test.npy"
labels_test = "labels_test.npy"
groups_test = "objects_test.npy"
full_scale = 4095.0
"""


def read(path):
    """Returns objects, labels and readings of a table."""
    with open(path, newline="") as lines:
        rows = list(csv.DictReader(lines))
    names = [f"{finger}_biotac_{electrode}" for finger in FINGERS for electrode in range(1, 25)]
    missing = [name for name in ["object", "slipped", *names] if not rows or name not in rows[0]]
    if missing:
        raise SystemExit(f"{path}: no column {missing[0]}")
    readings = np.array([[float(row[name]) for name in names] for row in rows]).astype(np.uint16)
    labels = ["slipped" if float(row["slipped"]) else "stable" for row in rows]
    return [row["object"] for row in rows], labels, readings


def main(folder, out):
    folder, out = Path(folder), Path(out)
    out.mkdir(parents=True, exist_ok=True)
    for end in ["", "_test"]:
        tables = [read(folder / f"bts3v2_palm_{palm}{end}.csv") for palm in PALMS]
        frames = np.concatenate([readings for _, _, readings in tables])
        np.save(out / f"frames{end}.npy", frames)
        for finger, readings in zip(FINGERS, np.split(frames, len(FINGERS), axis=1)):
            np.save(out / f"{finger}{end}.npy", readings)
        np.save(out / f"labels{end}.npy", np.array([label for _, labels, _ in tables for label in labels]))
        np.save(out / f"objects{end}.npy", np.array([name for names, _, _ in tables for name in names]))
        np.save(out / f"palms{end}.npy", np.repeat(PALMS, [len(names) for names, _, _ in tables]))
        np.save(out / f"grasps{end}.npy", np.arange(len(frames)))
        print(f"{len(frames)} grasps{end} in {out}")
    (out / "recorded.toml").write_text(RECORDED)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit("usage: python convert_grasps.py FOLDER OUT")
    main(*sys.argv[1:])
