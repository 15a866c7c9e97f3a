"""Converts the pressure maps of lying people to the arrays of real_postures.toml.

python convert_postures.py FOLDER OUT

FOLDER is the folder of PhysioNet's "A Pressure Map Dataset for In-bed Posture Classification" 1.0.0 (physionet.org/content/pmd; mirror:
github.com/cecilia-lin/PosturePress, folder `data`). Experiment I has 13 subjects S1 to S13 and 17 postures 1.txt to 17.txt each. A file has one frame of
64 × 32 sensors per second. Its first frame is the empty mat and its second frame is not valid.

OUT receives, for n = subjects × postures × FRAMES touches, sorted by subject, posture and time:
- frames.npy      uint16, n × 64 × 32: medians of three consecutive frames
- categories.npy  text, n: supine, right or left
- postures.npy    text, n: p01 to p17, the numbers of the files
- subjects.npy    text, n: S1 to S13
- sequences.npy   text, n: subject and posture, such as S1_p01
- touches.npy     int64, n: a number for each touch, so that each touch is a group of its own
- recorded.toml   the table [recorded] for `bubbletouch audit OUT`: 17 postures, grouped by subject
- empty.npz       frames 221 × 2 × 64 × 32 (the empty mat before each sequence, and the median of the sequence), labels (posture) and groups (subject)
"""

import sys
from pathlib import Path

import numpy as np

# Frames of a sequence, evenly spaced in time. Frames of one sequence hardly differ.
FRAMES = 8
# Postures by the number of the file: 1 lies flat, 15 to 17 lie on an inclined bed, 4 to 7 lie on wedges, 13 and 14 are fetal.
CATEGORY = {**{number: "supine" for number in range(1, 18)}, **dict.fromkeys([2, 4, 5, 13], "right"), **dict.fromkeys([3, 6, 7, 14], "left")}


def read(path):
    """Returns the frames of a file, shape (n, 64, 32)."""
    with open(path) as lines:
        rows = [np.array(line.split(), dtype=np.uint16) for line in lines if line.strip()]
    if len(rows) < 5 or any(len(row) != 64 * 32 for row in rows):
        raise SystemExit(f"{path}: {len(rows)} frames; at least 5 frames of 2048 readings are needed")
    return np.stack(rows).reshape(-1, 64, 32)


def main(folder, out):
    folder, out = Path(folder), Path(out)
    subjects = sorted((folder / "experiment-i").glob("S[0-9]*"), key=lambda path: int(path.name[1:]))
    if not subjects:
        raise SystemExit(f"{folder}: no folders experiment-i/S1, S2, …")
    frames, categories, postures, names, empty = [], [], [], [], []
    for subject in subjects:
        for number in CATEGORY:
            readings = read(subject / f"{number}.txt")
            middles = np.linspace(3, len(readings) - 2, FRAMES).round().astype(int)
            frames += [np.median(readings[at - 1 : at + 2], axis=0).astype(np.uint16) for at in middles]
            categories += [CATEGORY[number]] * FRAMES
            postures += [f"p{number:02}"] * FRAMES
            names += [subject.name] * FRAMES
            empty.append([readings[0], np.median(readings[2:], axis=0).astype(np.uint16)])
    out.mkdir(parents=True, exist_ok=True)
    np.save(out / "frames.npy", np.stack(frames))
    np.save(out / "categories.npy", np.array(categories))
    np.save(out / "postures.npy", np.array(postures))
    np.save(out / "subjects.npy", np.array(names))
    np.save(out / "sequences.npy", np.array([f"{name}_{posture}" for name, posture in zip(names, postures)]))
    np.save(out / "touches.npy", np.arange(len(frames)))
    np.savez(out / "empty.npz", frames=np.array(empty), labels=np.array(postures[::FRAMES]), groups=np.array(names[::FRAMES]))
    (out / "recorded.toml").write_text('[recorded]\nframes = "frames.npy"\nlabels = "postures.npy"\ngroups = "subjects.npy"\nfull_scale = 1000.0\n')
    print(f"{len(frames)} frames of {len(subjects)} subjects in {out}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit("usage: python convert_postures.py FOLDER OUT")
    main(*sys.argv[1:])
