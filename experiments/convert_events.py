"""Converts events of an event-driven tactile sensor to the arrays of real_events.toml.

python convert_events.py FOLDER OUT

FOLDER is Ev-Objects or Ev-Containers of github.com/clear-nus/TactileSGNet, a folder or Ev-Objects.zip: files train/sample_N_label_L.npy and
test/sample_N_label_L.npy, float32 of 39 taxels × 2 signs × T time steps (250 or 325), which are 1 where the taxel had an event of that sign.

OUT receives, for n training recordings (576 of 36 objects, or 240 of 20 containers) and with _test after the name for those of the given test set:
- frames.npy  uint8, n × T / STEPS × 78: numbers of events in STEPS time steps, of both signs of each taxel
- steps.npy   uint8, n × 39 × 2 × T: events of each time step (order "n c c t")
- labels.npy  int64, n
- recorded.toml  the table [recorded] for `bubbletouch audit OUT`, with the given test set
"""

import io
import re
import sys
import zipfile
from pathlib import Path

import numpy as np

# Time steps whose events are counted together.
STEPS = 10
RECORDED = """[recorded]
frames = "frames.npy"
labels = "labels.npy"
frames_test = "frames_test.npy"
labels_test = "labels_test.npy"
order = "ntc"
"""
NAME = re.compile(r"(train|test)/sample_(\d+)_label_(\d+)\.npy$")


def files(folder):
    """Returns the bytes of each recording by part, number and label."""
    if folder.is_file():
        with zipfile.ZipFile(folder) as archive:
            content = {name: archive.read(name) for name in archive.namelist() if NAME.search(name)}
    else:
        content = {path.as_posix(): path.read_bytes() for path in folder.glob("t*/*.npy") if NAME.search(path.as_posix())}
    found = {}
    for name, data in content.items():
        part, number, label = NAME.search(name).groups()
        found[part, int(number), int(label)] = data
    return found


def main(folder, out):
    folder, out = Path(folder), Path(out)
    found = files(folder)
    out.mkdir(parents=True, exist_ok=True)
    for part, end in [("train", ""), ("test", "_test")]:
        keys = sorted(key for key in found if key[0] == part)
        if not keys:
            raise SystemExit(f"{folder}: no files {part}/sample_0_label_0.npy, …")
        events = np.stack([np.load(io.BytesIO(found[key])) for key in keys])
        n, n_taxels, n_signs, n_steps = events.shape
        whole = events[..., : n_steps // STEPS * STEPS]
        counts = whole.reshape(n, n_taxels * n_signs, -1, STEPS).sum(axis=-1)
        np.save(out / f"frames{end}.npy", counts.transpose(0, 2, 1).astype(np.uint8))
        np.save(out / f"steps{end}.npy", events.astype(np.uint8))
        np.save(out / f"labels{end}.npy", np.array([label for _, _, label in keys]))
        print(f"{n} recordings{end} of {n_taxels} taxels × {n_signs} signs × {n_steps} steps in {out}")
    (out / "recorded.toml").write_text(RECORDED)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit("usage: python convert_events.py FOLDER OUT")
    main(*sys.argv[1:])
