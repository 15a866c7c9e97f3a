"""Tests that Python, the command and the library return bitwise equal results."""

from __future__ import annotations

import csv
import os
import subprocess
from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest
from bubbletouch.learning import SVC, LinearSVC

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


N = 120


def balls(apart: float) -> bt.SphereUnion:
    return bt.SphereUnion([[k * apart, 0, 0.03] for k in (-1, 0, 1)], 0.012)


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:  # type: ignore[type-arg]
    """Returns the arrays computed by reference.rs, by name."""
    built = Path(__file__).resolve().parents[2] / "target" / "release" / "bubbletouch-reference"
    path = os.environ.get("BUBBLETOUCH_REFERENCE_BINARY") or (str(built) if built.exists() else None)
    if path is None:
        pytest.skip("nothing to compare with: cargo build --release -p bubbletouch-python --bin bubbletouch-reference")
    folder = tmp_path_factory.mktemp("reference")
    subprocess.run([path, str(folder)], check=True)
    return {file.stem: np.load(file) for file in folder.glob("*.npy")}


@pytest.fixture(scope="module")
def poses() -> np.ndarray:  # type: ignore[type-arg]
    numbers = np.arange(N)
    x, y, zero = (numbers - 60.0) / 8192.0, (numbers % 7) / 1024.0, np.zeros(N)
    return np.stack([x, y, zero, zero + 0.8, zero, zero, zero + 0.6], 1)


def pressed(patch: bt.Patch, poses: np.ndarray, **goal: float) -> np.ndarray:  # type: ignore[type-arg]
    frames = np.empty((N, patch.n_taxels))
    for which, apart in enumerate((0.014, 0.016, 0.02)):
        some = patch.press(balls(apart), poses[which::3], **goal)  # type: ignore[call-overload]
        frames[which::3] = some.reshape(-1, patch.n_taxels)
    return frames


def test_presses_of_the_library(reference, poses) -> None:  # type: ignore[no-untyped-def]
    patches = {
        "grid": bt.Patch.grid(20, 24, 2e-3, 5e-3),
        "hexagonal": bt.Patch.hexagonal(20, 24, 2e-3, 5e-3),
    }
    here = poses.copy()
    here[:, 2] = -0.02
    for name, patch in patches.items():
        depth, force = pressed(patch, poses, depth=3e-3), pressed(patch, poses, force=2.0)
        np.testing.assert_array_equal(depth, reference[f"{name}_depth"])
        np.testing.assert_array_equal(force, reference[f"{name}_force"])
        np.testing.assert_array_equal(pressed(patch, here), reference[f"{name}_here"])
        assert min(frames.max(axis=1).min() for frames in (depth, force)) > 0


@pytest.mark.filterwarnings("ignore:.*stopped at max_iter")
def test_chains_projections_and_svms_of_the_library(reference, poses) -> None:  # type: ignore[no-untyped-def]
    patch = bt.Patch.grid(20, 24, 2e-3, 5e-3)
    error = bt.Step.error
    steps = [
        error("hysteresis", hysteresis_full_scale=0.1),
        error("gain", gain_std=0.05),
        error("drift", drift_std_full_scale=0.02),
        error("faults", dead_fraction=0.01, stuck_fraction=0.02),
        bt.Step.noise(0.02),
        bt.Step.smoothing(4e-3),
        error("quantisation", adc_bits=10),
    ]
    frames = bt.Chain(steps, patch, skin_seed=7)(reference["grid_depth"], seed=2018)
    np.testing.assert_array_equal(frames, reference["chain"])
    names = sorted(set(reference) & {"gaussian", "bernoulli", "circulant", "sparse", "sbhe", "block_average", "subsample", "fourier", "identity"})
    assert len(names) == 9
    for name in names:
        measured = bt.Projection(name, (20, 24), 32, seed=11)(frames)
        np.testing.assert_array_equal(measured, reference[name])
    features, labels = 1e3 * reference["sbhe"], np.arange(N) % 3
    for kernel in ("linear", "rbf"):
        values = SVC(kernel=kernel).fit(features, labels).decision_values(features)
        np.testing.assert_array_equal(values, reference[f"svc_{kernel}"])
    scores = LinearSVC().fit(features, labels).decision_function(features)
    np.testing.assert_array_equal(scores, reference["linear_svc"])
