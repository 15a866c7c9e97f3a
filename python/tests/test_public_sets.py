"""Tests of the scripts experiments/convert_*.py on small copies of the folders that the authors publish."""

from __future__ import annotations

import csv
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"


def convert(name: str, folder: Path, out: Path) -> str:
    """Runs a script and returns what it prints, or its error."""
    done = subprocess.run([sys.executable, str(EXPERIMENTS / f"convert_{name}.py"), str(folder), str(out)], capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else done.stderr


def load(out: Path, name: str) -> NDArray[np.generic]:
    array: NDArray[np.generic] = np.load(out / name, allow_pickle=False)
    return array


def files_of(out: Path) -> list[str]:
    """Returns the files that recorded.toml names."""
    lines = [line.split(" = ") for line in (out / "recorded.toml").read_text().splitlines()]
    return [line[1].strip('"') for line in lines if len(line) == 2 and ".npy" in line[1]]


def test_postures(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    for subject in ["S1", "S2", "S10"]:
        (tmp_path / "pmd/experiment-i" / subject).mkdir(parents=True)
        for number in range(1, 18):
            # The empty mat, an invalid frame, and nine frames that rise by one each second.
            level = 20 * number + int(subject[1:])
            frames = [np.zeros(2048, int), random.integers(0, 4096, 2048), *(np.full(2048, level + second) for second in range(9))]
            lines = ["\t".join(map(str, frame)) + "\t\n" for frame in frames]
            (tmp_path / "pmd/experiment-i" / subject / f"{number}.txt").write_text("".join(lines))
    out = tmp_path / "out"
    assert "408 frames of 3 subjects" in convert("postures", tmp_path / "pmd", out)
    frames, postures, subjects = load(out, "frames.npy"), load(out, "postures.npy"), load(out, "subjects.npy")
    assert frames.shape == (408, 64, 32) and frames.dtype == np.uint16
    assert list(dict.fromkeys(subjects)) == ["S1", "S2", "S10"] and list(dict.fromkeys(postures)) == [f"p{number:02}" for number in range(1, 18)]
    # Eight frames of each sequence from the middle of the first three valid frames to that of the last three.
    first = frames[:8, 0, 0].astype(int)
    assert first[0] == 20 + 1 + 1 and first[-1] == 20 + 1 + 7 and (np.diff(first) >= 0).all()
    assert frames[-1, 5, 5] == 20 * 17 + 10 + 7
    categories = load(out, "categories.npy")
    right = {str(posture) for posture in postures[categories == "right"]}
    assert right == {"p02", "p04", "p05", "p13"} and (categories == "left").sum() == len(right) * 24
    assert len(np.unique(load(out, "sequences.npy"))) == 51 and (load(out, "touches.npy") == np.arange(408)).all()
    with np.load(out / "empty.npz") as empty:
        assert empty["frames"].shape == (51, 2, 64, 32) and not empty["frames"][:, 0].any()
        assert empty["labels"].shape == empty["groups"].shape == (51,)
    assert files_of(out) == ["frames.npy", "postures.npy", "subjects.npy"]
    (tmp_path / "pmd/experiment-i/S2/9.txt").write_text("1\t2\n")
    said = convert("postures", tmp_path / "pmd", tmp_path / "none")
    assert "9.txt: 1 frames" in said and not (tmp_path / "none").exists()
    assert "no folders experiment-i/S1" in convert("postures", tmp_path / "out", tmp_path / "none")


def test_grasps(tmp_path: Path) -> None:
    fingers = [f"{finger}_biotac_{electrode}" for finger in ["ff", "mf", "th"] for electrode in range(1, 25)]
    for end, objects in [("", ["pringles", "coke"]), ("_test", ["mug"])]:
        for place, palm in enumerate(["down", "side", "45"]):
            with open(tmp_path / f"bts3v2_palm_{palm}{end}.csv", "w", newline="") as lines:
                table = csv.writer(lines)
                table.writerow(["object", "slipped", *fingers])
                for name in objects:
                    for slipped in (0.0, 1.0):
                        table.writerow([name, slipped, *(1000 * place + np.arange(72))])
    out = tmp_path / "out"
    assert "12 grasps in" in convert("grasps", tmp_path, out)
    for end, n in [("", 12), ("_test", 6)]:
        frames = load(out, f"frames{end}.npy")
        assert frames.shape == (n, 72) and frames.dtype == np.uint16
        assert (frames[-1] == 2000 + np.arange(72)).all()
        assert (load(out, f"mf{end}.npy") == frames[:, 24:48]).all() and load(out, f"th{end}.npy").shape == (n, 24)
        assert list(load(out, f"labels{end}.npy")) == ["stable", "slipped"] * (n // 2)
        assert list(load(out, f"palms{end}.npy")) == sorted(["down", "side", "45"] * (n // 3), key=["down", "side", "45"].index)
        assert (load(out, f"grasps{end}.npy") == np.arange(n)).all()
    assert set(load(out, "objects.npy")) == {"pringles", "coke"} and set(load(out, "objects_test.npy")) == {"mug"}
    assert all((out / name).is_file() for name in files_of(out)) and len(files_of(out)) == 6
    (tmp_path / "bts3v2_palm_45.csv").write_text("object,ff_biotac_1\npringles,3\n")
    assert "no column slipped" in convert("grasps", tmp_path, out)


@pytest.mark.parametrize("archive", [False, True])
def test_events(archive: bool, tmp_path: Path) -> None:
    random = np.random.default_rng(2)
    events = (random.random((6, 39, 2, 55)) < 0.2).astype(np.float32)
    names = [*(f"train/sample_{number}_label_{number % 2}.npy" for number in range(4)), *(f"test/sample_{number}_label_{number}.npy" for number in range(2))]
    for name, touch in zip(names, events, strict=True):
        (tmp_path / "Ev-Objects" / name).parent.mkdir(parents=True, exist_ok=True)
        np.save(tmp_path / "Ev-Objects" / name, touch)
    folder = tmp_path / "Ev-Objects"
    if archive:
        folder = tmp_path / "Ev-Objects.zip"
        with zipfile.ZipFile(folder, "w") as written:
            for name in names:
                written.write(tmp_path / "Ev-Objects" / name, f"Ev-Objects/{name}")
    out = tmp_path / "out"
    assert "4 recordings of 39 taxels × 2 signs × 55 steps" in convert("events", folder, out)
    for end, part in [("", events[:4]), ("_test", events[4:])]:
        frames, steps = load(out, f"frames{end}.npy"), load(out, f"steps{end}.npy")
        assert frames.shape == (len(part), 5, 78) and frames.dtype == steps.dtype == np.uint8
        assert (steps == part).all()
        # Windows of ten steps; the last five steps belong to none.
        assert (frames[:, 2, 2 * 7 + 1] == part[:, 7, 1, 20:30].sum(axis=1)).all()
        assert frames.sum() == part[..., :50].sum()
    assert list(load(out, "labels.npy")) == [0, 1, 0, 1] and list(load(out, "labels_test.npy")) == [0, 1]
    assert all((out / name).is_file() for name in files_of(out))
    assert "no files train/" in convert("events", out, tmp_path / "none")
