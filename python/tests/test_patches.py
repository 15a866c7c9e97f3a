"""Tests of patches: positions and properties of taxels."""

from __future__ import annotations

import pickle

import bubbletouch as bt
import numpy as np
import pytest

from conftest import refused


def test_a_grid_has_rows_along_y(patch: bt.Patch) -> None:
    assert patch.shape == (32, 48) and len(patch) == patch.n_taxels == 32 * 48
    centers = patch.centers.reshape(32, 48, 3)
    np.testing.assert_allclose(centers[:, 0, 1], (np.arange(32) - 15.5) * 2e-3, atol=1e-15)
    np.testing.assert_allclose(centers[0, :, 0], (np.arange(48) - 23.5) * 2e-3, atol=1e-15)
    assert (patch.axes == [0, 0, 1]).all()
    assert (patch.pitch, patch.stroke, patch.taxel_radius) == (2e-3, 5e-3, 1e-3)
    assert (patch.stiffness, patch.damping) == (100.0, 0.0)


def test_other_layouts_have_one_long_side(box: bt.Mesh) -> None:
    patches = {
        "hexagonal": bt.Patch.hexagonal(6, 5, 2e-3, 5e-3),
        "disc": bt.Patch.disc(8e-3, 2e-3, 5e-3),
        "cylinder": bt.Patch.cylinder(0.04, 0.06, np.pi, 3e-3, 5e-3),
        "sphere_cap": bt.Patch.sphere_cap(8e-3, np.pi / 2, 1.5e-3, 2e-3, taxel_radius=0.5e-3),
        "draped": bt.Patch.draped(box, 4e-3, 2e-3, seed=3),
    }
    for name, patch in patches.items():
        assert patch.shape == (patch.n_taxels,) and patch.n_taxels > 20, name
        assert patch.pitch is None
        np.testing.assert_allclose(np.linalg.norm(patch.axes, axis=1), 1.0, rtol=1e-12)
    assert patches["hexagonal"].n_taxels == 30
    round_z = patches["cylinder"].centers[:, :2]
    np.testing.assert_allclose(np.linalg.norm(round_z, axis=1), 0.04)


def test_taxels_of_arrays_may_differ() -> None:
    centers = [[0, 0, 0], [4e-3, 0, 0]]
    patch = bt.Patch.from_arrays(
        centers, [[0, 0, 1], [0, 0, 1]], stroke=[5e-3, 2e-3], taxel_radius=1e-3
    )
    np.testing.assert_array_equal(patch.stroke, [5e-3, 2e-3])
    plate = bt.SphereUnion([[2e-3, 0, 1.0]], 1.0)
    frame = patch.press(plate, [0, 0, 0, 1, 0, 0, 0], depth=4e-3)
    np.testing.assert_allclose(frame, [4e-3, 2e-3], rtol=1e-3)


def test_a_moved_patch_is_moved() -> None:
    ring = bt.Patch.cylinder(0.04, 0.02, np.pi, 3e-3, 5e-3)
    up = [0, 0, -0.04, *(np.array([1, 0, -1, 0]) / np.sqrt(2))]
    moved = ring.moved(up)
    highest = moved.centers[:, 2].argmax()
    np.testing.assert_allclose(moved.centers[highest, [1, 2]], 0, atol=1e-3)
    np.testing.assert_allclose(moved.axes[highest, 2], 1, atol=2e-3)


def test_a_moved_grid_keeps_the_shape_of_its_frames(mug: bt.SphereUnion) -> None:
    grid = bt.Patch.grid(16, 12, 3e-3, 5e-3)
    turned = grid.moved([0, 0, 0, *(np.array([1, 0, 0, 1]) / np.sqrt(2))])
    assert turned.shape == (16, 12) and turned.moved([0, 0, 1e-3, 1, 0, 0, 0]).shape == (16, 12)
    poses = bt.touch_poses(mug, offset=[[0, 0], [5e-3, 0]])
    frames = turned.press(mug, poses, depth=2e-3)
    assert frames.shape == (2, 16, 12)
    # The object seen from the turned patch is the object turned back.
    back = poses * [0, 0, 1, 1, 1, 1, 1]
    back[:, :2] = np.stack([poses[:, 1], -poses[:, 0]], axis=1)
    w, x, y, z = poses[:, 3:].T
    back[:, 3:] = np.stack([w + z, x + y, y - x, z - w], axis=1) / np.sqrt(2)
    np.testing.assert_allclose(frames, grid.press(mug, back, depth=2e-3), atol=1e-9)
    chain = bt.Chain([bt.Step.noise(0.01)], turned)
    assert chain(frames).shape == (2, 16, 12)
    again = pickle.loads(pickle.dumps(turned))
    np.testing.assert_array_equal(again.press(mug, poses, depth=2e-3), frames)


def test_arrays_may_have_rows_columns_and_pixels() -> None:
    grid = bt.Patch.grid(2, 3, 3e-3, 5e-3)
    pixels = [[row, 2 - column] for row in range(2) for column in range(3)]
    patch = bt.Patch.from_arrays(
        grid.centers, grid.axes, stroke=5e-3, taxel_radius=1e-3, shape=(2, 3), pixels=pixels
    )
    assert patch.shape == (2, 3)
    np.testing.assert_array_equal(patch.pixels, pixels)
    again = pickle.loads(pickle.dumps(patch.moved([0, 0, 0, 1, 0, 0, 0])))
    assert again.shape == (2, 3)
    np.testing.assert_array_equal(again.pixels, pixels)
    for wrong, said in [
        ({"shape": (3, 3)}, "layout sides: 3 × 3 for 6 taxels"),
        ({"shape": (1, 2, 3)}, r"shape: \[1, 2, 3\]; \(6,\), or \(ny, nx\)"),
        ({"shape": (5,)}, r"shape: \[5\]"),
        ({"shape": (-2, -3)}, "shape: -2; at least 1"),
        ({"pixels": [[0, 1]]}, r"pixels: shape \(1, 2\); \(6, 2\)"),
        ({"pixels": np.full((6, 2), 0.5)}, "pixels: 0.5; integers from 0"),
    ]:
        refused(said, lambda: bt.Patch.from_arrays(grid.centers, grid.axes, stroke=5e-3, taxel_radius=1e-3, **wrong))  # type: ignore[arg-type]


def test_patches_are_pickled(mug: bt.SphereUnion) -> None:
    pose = bt.touch_poses(mug)
    made = [
        bt.Patch.grid(8, 9, 4e-3, 5e-3, taxel_radius=1.5e-3, stiffness=30, damping=0.2),
        bt.Patch.hexagonal(8, 9, 4e-3, 5e-3),
    ]
    for patch in made:
        again = pickle.loads(pickle.dumps(patch))
        assert again.shape == patch.shape and again.stiffness == patch.stiffness
        expected = patch.press(mug, pose, depth=2e-3)
        np.testing.assert_array_equal(again.press(mug, pose, depth=2e-3), expected)
        assert expected.max() > 0


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: bt.Patch.grid(8, 8, -1e-3, 5e-3), "taxel pitch: -0.001 m; a finite positive number"),
        (lambda: bt.Patch.grid(8, 8, float("nan"), 5e-3), "taxel pitch: NaN m; a finite positive"),
        (lambda: bt.Patch.grid(0, 8, 1e-3, 5e-3), "taxel grid: 8 × 0 taxels; at least one"),
        (lambda: bt.Patch.grid(-2, 8, 1e-3, 5e-3), "ny: -2; at least 1"),
        (lambda: bt.Patch.grid(8, 8, 1e-3, 0), "taxel stroke: 0 m; a finite positive number"),
        (lambda: bt.Patch.grid(8, 8, 1e-3, 5e-3, stiffness=-1), "taxel stiffness: -1 N/m"),
        (lambda: bt.Patch.grid(8, 8, 1e-3, 5e-3, damping=-1), "taxel damping: -1 N·s/m"),
        (lambda: bt.Patch.grid(9999, 9999, 1e-3, 5e-3), "taxel grid: 99980001 taxels; 1 to 4194304"),
        (lambda: bt.Patch.cylinder(0.04, 0.06, 9, 3e-3, 5e-3), "cylinder arc"),
        (lambda: bt.Patch.disc(-1, 3e-3, 5e-3), "disc radius: -1 m"),
        (
            lambda: bt.Patch.from_arrays([[0, 0]], [[0, 0, 1]], stroke=1e-3, taxel_radius=1e-3),
            r"centers: shape \(1, 2\); \(n, 3\)",
        ),
        (
            lambda: bt.Patch.from_arrays([[0, 0, 0]], [[0, 0, 2]], stroke=1e-3, taxel_radius=1e-3),
            "layout, taxel 1: axis .*; a vector of length one",
        ),
        (
            lambda: bt.Patch.from_arrays(
                [[0, 0, 0]], [[0, 0, 1]], stroke=[1e-3, 1e-3], taxel_radius=1e-3
            ),
            r"stroke: shape \(2,\); \(1,\), or one number for all",
        ),
        (
            lambda: bt.Patch.from_arrays([], [], stroke=1e-3, taxel_radius=1e-3),
            r"centers: shape \(0,\); \(n, 3\)",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_a_patch_is_refused_in_the_librarys_words(make, said) -> None:  # type: ignore[no-untyped-def]
    refused(said, lambda: make())


def test_taxels_draped_over_a_sphere_lie_on_the_sphere() -> None:
    center = np.array([0.01, -0.02, 0.03])
    tip = bt.SphereUnion(center[None], [0.012])
    patch = bt.Patch.draped(tip, 2e-3, 2e-3, plane=[center, [0, 0, 1]])
    offsets = patch.centers - center
    assert np.abs(np.linalg.norm(offsets, axis=1) - 0.012).max() < 1e-15
    assert np.abs(patch.axes - offsets / 0.012).max() < 1e-12 and patch.axes[:, 2].min() > -0.05
    # As many taxels as a grid on the half sphere.
    assert abs(patch.n_taxels - 2 * np.pi * 0.012**2 / 4e-6) < 10
    refused("mesh: a SphereUnion of 2 spheres; a Mesh, or one sphere", lambda: bt.Patch.draped(bt.SphereUnion(np.zeros((2, 3)), [0.01, 0.02]), 2e-3, 2e-3))


def test_a_draped_patch_covers_a_region_of_the_outer_surface() -> None:
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    triangles = np.array([[a, b, c] for a, b, c, _ in faces] + [[a, c, d] for a, _, c, d in faces])
    inner = triangles[:, ::-1] + 8
    housing = bt.Mesh(np.concatenate([0.021 * corners, 0.017 * corners]), np.concatenate([triangles, inner]))
    patch = bt.Patch.draped(housing, 4e-3, 2e-3)
    assert (np.abs(patch.centers).max(axis=1) > 0.0209).all() and patch.n_left_out > 100
    top = bt.Patch.draped(housing, 4e-3, 2e-3, triangles=[1, 7])
    assert (top.centers[:, 2] > 0.0209).all() and top.n_left_out == 0
    plane = bt.Patch.draped(housing, 4e-3, 2e-3, plane=[[0, 0, 0], [2.0, 0, 0]])
    assert (plane.centers[:, 0] >= 0).all()
    box = bt.Patch.draped(housing, 4e-3, 2e-3, bounds=[[0, 0, 0], [1, 1, 1]])
    assert (box.centers >= 0).all() and box.n_taxels < plane.n_taxels < patch.n_taxels
    assert bt.Patch.disc(8e-3, 2e-3, 5e-3).n_left_out == 0
    refused("mesh: <class 'bubbletouch.Solid'>; a SphereUnion or a Mesh", lambda: bt.Patch.draped(bt.Catalogue.builtin().object("mug"), 2e-3, 2e-3), TypeError)  # type: ignore[arg-type]
    refused("region: triangle 24; 0 to 23", lambda: bt.Patch.draped(housing, 4e-3, 2e-3, triangles=[24]))
    refused(r"bounds: shape \(3, 3\); \(2, 3\)", lambda: bt.Patch.draped(housing, 4e-3, 2e-3, bounds=np.zeros((3, 3))))
