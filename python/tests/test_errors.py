"""Tests of errors: one exception type per kind of error, with the messages of the library."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest

from conftest import refused

POSE = [0.0, 0, 0.03, 1, 0, 0, 0]


def misaligned(values: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
    """Returns a copy whose elements begin one byte after a multiple of their size."""
    array = np.zeros(values.nbytes + 1, np.uint8)[1:].view(values.dtype).reshape(values.shape)
    array[...] = values
    assert not array.flags.aligned
    return array


@pytest.fixture(scope="module")
def ball() -> bt.SphereUnion:
    return bt.SphereUnion([[0, 0, 0]], 20e-3)


def test_a_bug_asks_for_a_report() -> None:
    refused("a bug of bubbletouch .*asked for.*please report", lambda: bt._core._panic(), bt.InternalError)
    assert issubclass(bt.InternalError, RuntimeError)


def test_a_file_that_is_not_there_is_an_oserror(tmp_path: Path) -> None:
    missing = tmp_path / "missing.ply"
    for read in (bt.Mesh.read, bt.SphereUnion.read, bt.Catalogue.read):
        with pytest.raises(FileNotFoundError) as caught:
            read(missing)
        assert caught.value.filename == str(missing)
    with pytest.raises(OSError):
        bt.SphereUnion([[0, 0, 0]], 1).write(tmp_path / "no" / "such" / "folder.csv")


def test_a_file_that_is_something_else_is_bad_input(tmp_path: Path) -> None:
    text = tmp_path / "text.ply"
    text.write_text("no mesh")
    refused("text.ply", lambda: bt.Mesh.read(text))
    other = tmp_path / "mesh.txt"
    other.write_text("")
    refused("not a mesh by its name", lambda: bt.Mesh.read(other))
    refused("text.ply", lambda: bt.SphereUnion.read(text))
    refused("text.ply", lambda: bt.Catalogue.read(text))
    folder = tmp_path / "folder.ply"
    folder.mkdir()
    refused("folder.ply: a folder; a .ply, .obj, .stl, .dae, .glb or .gltf file", lambda: bt.Mesh.read(folder))


@pytest.mark.parametrize(
    ("centers", "radii", "said"),
    [
        ([[0, 0, float("nan")]], [1], r"sphere 1: centre \[0, 0, NaN\]; finite coordinates in metres"),
        ([[0, 0, 0]], [-1], "sphere 1: radius -1; a finite positive radius in metres"),
        ([[0, 0, 0], [0, 0, 1]], [1, float("inf")], "sphere 2: radius inf"),
        (np.zeros((0, 3)), [], "sphere union: no spheres; at least one sphere"),
        ([[0, 0]], [1], r"centers: shape \(1, 2\); \(n, 3\)"),
        ([0, 0, 0], [1], r"centers: shape \(3,\); \(n, 3\)"),
        ([[0, 0, 0]], [1, 2], r"radii: shape \(2,\); \(1,\), or one number for all"),
        ([["a", "b", "c"]], [1], "centers: dtype <U1; real numbers"),
        ([[0, 0, 1j]], [1], "centers: dtype complex128; real numbers"),
        ([[0, 0, 0], [1]], [1], "centers: .*; an array of real numbers"),
    ],
)
def test_what_cannot_be_spheres_is_refused(centers, radii, said) -> None:  # type: ignore[no-untyped-def]
    refused(said, lambda: bt.SphereUnion(centers, radii))


@pytest.mark.parametrize(
    ("vertices", "triangles", "said"),
    [
        (np.zeros((2, 3)), [[0, 1, 2]], "mesh"),
        ([[0, 0, np.inf], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], "mesh"),
        (np.eye(3), [[0, 1, -2]], "triangles: -2; whole numbers of vertices, from 0"),
        (np.eye(3), [[0, 1, 1.5]], "triangles: 1.5; whole numbers"),
        (np.eye(3), [[0, 1]], r"triangles: shape \(1, 2\); \(n, 3\)"),
    ],
)
def test_what_cannot_be_a_mesh_is_refused(vertices, triangles, said) -> None:  # type: ignore[no-untyped-def]
    refused(said, lambda: bt.Mesh(vertices, triangles))


def test_an_open_mesh_is_not_packed_and_the_advice_is_of_python() -> None:
    triangle = bt.Mesh(np.eye(3), [[0, 1, 2]])
    refused(r"close_holes=WIDTH.*sheet=True", lambda: triangle.pack(1e-2))
    assert len(triangle.pack(5e-2, sheet=True)) > 1
    refused("tolerance: -1 m; a finite positive length", lambda: triangle.pack(-1))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"poses": [0, 0, 0]}, r"poses: shape \(3,\); \(n, 7\) of x, y, z"),
        ({"poses": np.zeros((2, 3, 4))}, r"poses: shape \(2, 3, 4\)"),
        ({"poses": [POSE, [np.nan, *POSE[1:]]]}, r"poses\[1\]: .*NaN.*; finite x, y, z and a quat"),
        ({"poses": [[0, 0, 0, 2, 0, 0, 0]]}, r"poses\[0\]: .*a quaternion .* of length one"),
        ({"poses": [0, 0, 0, 0, 0, 0, 0]}, r"poses: .*a quaternion .* of length one"),
        ({"poses": np.diag([1, 1, -1, 1.0])}, "a rotation and a translation"),
        ({"poses": np.ones((4, 4))}, "a rotation and a translation"),
        ({"poses": ["x"] * 7}, "poses: dtype <U1; real numbers"),
        ({"depth": -1e-3}, "depth: -0.001; a finite number of metres, zero or more"),
        ({"depth": np.nan}, "depth: NaN; a finite number of metres"),
        ({"travel": np.inf}, "travel: inf; a finite number of metres"),
        ({"force": 0}, "force: 0; a finite positive number of newtons"),
        ({"depth": 1e-3, "force": 1}, "press: more than one of depth, travel and force"),
        ({"depth": [1e-3, 2e-3]}, "press: 2 amounts for 1 poses; one for all poses, or one each"),
        ({"depth": "deep"}, "depth: "),
        ({"threads": 0}, "threads: 0; at least 1, or None for all cores"),
        ({"poses": np.ma.masked_equal(POSE, 0.03)}, "poses: masked values; an array without a mask"),
        ({"out": np.zeros((8, 9))}, r"out: shape \(8, 9\); a float64 array in C order of shape \(8, 8\)"),
        ({"out": np.zeros((8, 8), int)}, "out: an array of int64; a float64 array in C order"),
        ({"out": [[0.0] * 8] * 8}, "out: <class 'list'>; a float64 array in C order"),
        ({"out": np.zeros((8, 16))[:, ::2]}, "out: an array in another order; a float64 array in C order"),
        ({"out": misaligned(np.zeros((8, 8)))}, "out: a misaligned array; a float64 array in C order"),
        ({"out": np.zeros((8, 8)), "dtype": "float32"}, "out: an array of float64; a float32 array in C order"),
        ({"dtype": "int8"}, "dtype: int8; float32 or float64"),
        ({"dtype": "no type"}, "dtype: no type; float32 or float64"),
    ],
)
def test_what_cannot_be_pressed_is_refused(ball: bt.SphereUnion, arguments, said) -> None:  # type: ignore[no-untyped-def]
    patch = bt.Patch.grid(8, 8, 2e-3, 5e-3)
    arguments = {"poses": POSE} | arguments
    refused(said, lambda: patch.press(ball, **arguments))
    # After an error, the patch and the object remain usable.
    assert patch.press(ball, POSE, depth=1e-3).max() == pytest.approx(1e-3)


def test_misaligned_strided_and_masked_arrays_are_read_as_their_values(ball: bt.SphereUnion) -> None:
    patch, poses = bt.Patch.grid(8, 8, 2e-3, 5e-3), np.tile(POSE, (3, 1))
    expected = patch.press(ball, poses, depth=1e-3)
    strided = np.repeat(poses, 2, axis=1)[:, ::2]
    for given in (misaligned(poses), strided, np.asfortranarray(poses), poses.astype(">f8"), np.ma.array(poses), misaligned(poses.astype(np.float32))):
        np.testing.assert_allclose(patch.press(ball, given, depth=1e-3), expected, atol=1e-9)


def test_a_read_only_array_is_not_written(ball: bt.SphereUnion) -> None:
    patch = bt.Patch.grid(8, 8, 2e-3, 5e-3)
    out = np.zeros((8, 8))
    out.flags.writeable = False
    refused("out: ", lambda: patch.press(ball, POSE, depth=1e-3, out=out))
    assert (out == 0).all()


def test_a_solid_says_how_it_is_pressed() -> None:
    solid = bt.Catalogue.builtin().object("mug")
    refused(r"object: .*Solid.*pack\(tolerance\)", lambda: bt.Patch.grid(8, 8, 2e-3, 5e-3).press(solid, POSE), TypeError)  # type: ignore[call-overload]


# Maximum time until a call ends, seconds. On an idle machine it is 0.2 s; the larger limit allows for a busy machine.
PROMPTLY = 5.0


def interrupted_after(seconds: float, call) -> float:  # type: ignore[no-untyped-def]
    """Sends Ctrl-C after `seconds`, and returns the time from Ctrl-C to the end of the call, seconds."""
    sent: list[float] = []

    def press_ctrl_c() -> None:
        time.sleep(seconds)
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=press_ctrl_c)
    thread.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
            time.sleep(5)
            pytest.fail("it ended before it was interrupted")
        return time.perf_counter() - sent[0]
    finally:
        thread.join()


@pytest.mark.parametrize("threads", [1, None])
def test_ctrl_c_ends_a_long_press(mug: bt.SphereUnion, threads: int | None) -> None:
    patch = bt.Patch.grid(2, 2, 2e-3, 5e-3)
    poses = np.tile(bt.touch_poses(mug), (1_000_000, 1))
    assert interrupted_after(0.5, lambda: patch.press(mug, poses, force=0.1, threads=threads)) < PROMPTLY
    assert patch.press(mug, poses[0], depth=1e-3).max() > 0


def test_ctrl_c_ends_a_long_packing() -> None:
    random = np.random.default_rng(1)
    turns = random.normal(size=(60, 3))
    centers = 0.2 * turns / np.linalg.norm(turns, axis=1)[:, None]
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) * 0.05
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    vertices = (centers[:, None] + corners).reshape(-1, 3)
    triangles = (faces + 4 * np.arange(60)[:, None, None]).reshape(-1, 3)
    spiky = bt.Mesh(vertices, triangles)
    assert interrupted_after(0.3, lambda: spiky.pack(0.2e-3)) < PROMPTLY


def test_ctrl_c_leaves_a_long_training() -> None:
    from bubbletouch.learning import SVC

    random = np.random.default_rng(0)
    features, labels = random.normal(size=(3000, 60)), random.integers(3, size=3000)
    svm = SVC(C=1e4, tol=1e-6)
    assert interrupted_after(0.3, lambda: svm.fit(features, labels)) < PROMPTLY


def test_a_forked_process_presses_too(mug: bt.SphereUnion) -> None:
    """On Linux, multiprocessing forks processes; a forked process does not inherit threads."""
    program = """
import multiprocessing, numpy, bubbletouch as bt
mug = bt.Catalogue.builtin().object("mug").pack(1e-3)
patch = bt.Patch.grid(16, 16, 4e-3, 5e-3)
poses = numpy.tile(bt.touch_poses(mug), (64, 1))
def press(_):
    return patch.press(mug, poses, depth=3e-3).sum()
if __name__ == "__main__":
    first = press(0)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map(press, range(4)) == [first] * 4
"""
    if not hasattr(os, "fork"):
        pytest.skip("this system does not fork")
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def test_objects_that_are_not_whole_are_not_unpickled() -> None:
    whole = pickle.dumps(bt.SphereUnion([[0, 0, 0]], 1))
    with pytest.raises((pickle.UnpicklingError, EOFError, ValueError)):
        pickle.loads(whole[:-20])
