"""The same bits from Python as from the command."""

from __future__ import annotations

import csv
from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest

from conftest import Command

MM = 1e-3


def write_poses(path: Path, poses: np.ndarray) -> None:  # type: ignore[type-arg]
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["x", "y", "z", "qw", "qx", "qy", "qz"])
        rows.writerows([[repr(float(value)) for value in pose] for pose in poses])


@pytest.mark.parametrize("depth_mm", [3, None])
def test_presses_of_spheres(tmp_path: Path, command: Command, depth_mm: float | None) -> None:
    mug = bt.Catalogue.builtin().object("mug").pack(0.5 * MM)
    random = np.random.default_rng(5)
    offset, tilt = random.uniform(-0.02, 0.02, (40, 2)), random.uniform(-0.2, 0.2, (40, 2))
    poses = bt.touch_poses(mug, offset=offset, yaw=random.uniform(0, 6, 40), tilt=tilt)
    if depth_mm is None:
        poses[:, 2] -= 2 * MM
    write_poses(tmp_path / "poses.csv", poses)
    depth = [] if depth_mm is None else ["--depth-mm", depth_mm]
    command(
        "press", "--object", "mug", "--surface-error-mm", 0.5, "--poses", tmp_path / "poses.csv",
        *depth, "--taxels", "40x30", "--out", tmp_path / "frames.npy",
    )  # fmt: skip
    patch = bt.Patch.grid(30, 40, 2 * MM, 5 * MM)
    frames = patch.press(mug, poses, depth=None if depth_mm is None else depth_mm * MM)
    assert (frames > 0).any(axis=(1, 2)).all()
    np.testing.assert_array_equal(frames, np.load(tmp_path / "frames.npy"))


@pytest.mark.parametrize("model", ["mesh", "packed", "vertex_spheres"])
def test_presses_of_meshes(tmp_path: Path, command: Command, box: bt.Mesh, model: str) -> None:
    path = tmp_path / "box.obj"
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in box.vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in box.triangles.tolist()]
    path.write_text("\n".join(lines) + "\n")
    read = bt.Mesh.read(path)
    assert sorted(read.vertices.tolist()) == sorted(box.vertices.tolist())
    models = {
        "mesh": lambda: read,
        "packed": lambda: read.pack(0.5 * MM),
        "vertex_spheres": read.vertex_spheres,
    }
    thing = models[model]()
    turns = np.linspace(0, 1, 20)
    poses = bt.touch_poses(thing, yaw=turns, tilt=np.stack([0.2 * turns, 0.1 - 0.1 * turns], 1))
    write_poses(tmp_path / "poses.csv", poses)
    error = ["--surface-error-mm", 0.5] if model == "packed" else []
    command(
        "press", "--mesh", path, "--model", model, *error, "--poses", tmp_path / "poses.csv",
        "--depth-mm", 2, "--taxels", "32x32", "--out", tmp_path / "frames.npy",
    )  # fmt: skip
    frames = bt.Patch.grid(32, 32, 2 * MM, 5 * MM).press(thing, poses, depth=2 * MM)
    assert (frames > 0).any(axis=(1, 2)).all()
    np.testing.assert_array_equal(frames, np.load(tmp_path / "frames.npy"))


def test_where_an_object_lies(tmp_path: Path, command: Command) -> None:
    mug = bt.Catalogue.builtin().object("mug").pack(0.5 * MM)
    command(
        "press", "--object", "mug", "--surface-error-mm", 0.5, "--offset-x-mm", 7, "--offset-y-mm=-4",
        "--yaw-deg", 30, "--tilt-x-deg", 10, "--tilt-y-deg", 5, "--rest", 0, "--force-n", 2,
        "--out", tmp_path / "frame.npz",
    )  # fmt: skip
    pose = bt.touch_poses(
        mug, offset=[7 * MM, -4 * MM], yaw=np.radians(30), tilt=np.radians([10, 5]), rest=0
    )
    frame = bt.Patch.grid(64, 64, 2 * MM, 5 * MM).press(mug, pose, force=2)
    written = np.load(tmp_path / "frame.npz")
    np.testing.assert_array_equal(frame, written[written.files[0]].reshape(64, 64))
