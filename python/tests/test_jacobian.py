"""Tests of the derivatives of deflections against central differences."""

from __future__ import annotations

import bubbletouch as bt
import numpy as np
import pytest
from numpy.typing import NDArray

Floats = NDArray[np.float64]
STEP = 1e-7


def turned(pose: Floats, change: Floats) -> Floats:
    """Returns the pose (7,) after a motion (6,): translation, metres, and rotation vector in the axes of the patch, radians."""
    angle = np.linalg.norm(change[3:])
    axis = change[3:] / angle if angle > 0 else change[3:]
    w, v = np.cos(angle / 2), axis * np.sin(angle / 2)
    q0, q = pose[3], pose[4:]
    turn = [w * q0 - v @ q, *(w * q + q0 * v + np.cross(v, q))]
    return np.concatenate([pose[:3] + change[:3], turn])


def differences(patch: bt.Patch, thing: bt.SphereUnion | bt.Mesh, pose: Floats, **goal: float) -> Floats:
    """Returns the central differences of the deflections (n_taxels, 6); NaN if the touching part of a taxel differs between the two sides."""
    columns = []
    for number in range(6):
        change = np.zeros(6)
        change[number] = STEP
        sides = [
            patch.press(thing, turned(pose, sign * change), contacts=True, **goal)  # type: ignore[call-overload]
            for sign in (1, 0, -1)
        ]
        parts = []
        for _, contacts in sides:
            part = np.full(patch.n_taxels, -1)
            part[contacts.taxel] = contacts.part
            parts.append(part)
        frames = [frame.ravel() for frame, _ in sides]
        column = (frames[0] - frames[2]) / (2 * STEP)
        same = (parts[0] == parts[1]) & (parts[1] == parts[2])
        columns.append(np.where(same, column, np.nan))
    return np.stack(columns, -1)


GOALS: list[dict[str, float]] = [{}, {"travel": 1e-3}, {"depth": 3e-3}, {"force": 2.0}]


@pytest.mark.parametrize("goal", GOALS, ids=lambda goal: next(iter(goal), "pose"))
@pytest.mark.parametrize("layout", ["grid", "hexagonal", "cap"])
def test_it_is_the_limit_of_differences(layout: str, goal: dict[str, float]) -> None:
    patch = {
        "grid": lambda: bt.Patch.grid(16, 16, 2e-3, 4e-3),
        "hexagonal": lambda: bt.Patch.hexagonal(16, 16, 2e-3, 4e-3),
        "cap": lambda: bt.Patch.sphere_cap(0.02, 1.0, 2e-3, 4e-3).moved([0, 0, -0.02, 1, 0, 0, 0]),
    }[layout]()
    balls = bt.SphereUnion([[0, 0, 0], [9e-3, 2e-3, 1e-3], [-7e-3, 8e-3, 2e-3]], [0.011, 0.009, 0.01])
    turn = np.array([0.9, 0.1, -0.2, 0.3])
    pose = np.array([0.4e-3, -0.7e-3, 9.5e-3, *(turn / np.linalg.norm(turn))])
    if layout == "cap" and "depth" in goal:
        with pytest.raises(ValueError, match="jacobian: with a depth, on a patch that is not flat"):
            patch.press(balls, pose, jacobian=True, **goal)  # type: ignore[call-overload]
        return
    frame, jacobian = patch.press(balls, pose, jacobian=True, **goal)  # type: ignore[call-overload]
    assert jacobian.shape == (*patch.shape, 6)
    rows, expected = jacobian.reshape(-1, 6), differences(patch, balls, pose, **goal)
    known = np.isfinite(expected).all(axis=1)
    touched = frame.ravel() > 0
    assert known.mean() > 0.8 and (touched & known).sum() > 10
    # Errors are relative to the row. Derivatives per metre are about 1; derivatives per radian are about 0.03 m and may be zero in a column.
    unit = np.array([1, 1, 1, 0.03, 0.03, 0.03])
    error, size = np.abs(rows - expected)[known] / unit, np.abs(expected)[known] / unit
    assert (error.max(axis=1) < 1e-6 * np.maximum(size.max(axis=1), 1)).all()
    assert (rows[~touched] == 0).all()
    np.testing.assert_array_equal(frame, patch.press(balls, pose, **goal))  # type: ignore[call-overload]


def test_of_a_mesh_too(box: bt.Mesh) -> None:
    patch = bt.Patch.grid(20, 20, 2e-3, 5e-3)
    pose = bt.touch_poses(box, yaw=0.3, tilt=[0.1, 0.05])
    _, jacobian = patch.press(box, pose, depth=2e-3, jacobian=True)
    rows, expected = jacobian.reshape(-1, 6), differences(patch, box, pose, depth=2e-3)
    known = np.isfinite(expected).all(axis=1)
    scale = np.abs(expected[known]).max(axis=0)
    # The deflection has kinks at edges and between faces, which the part numbers do not show.
    close = np.abs(rows[known] - expected[known]) <= 1e-5 * np.maximum(scale, 1e-2)
    assert close.all(axis=1).mean() > 0.97


def test_of_spheres_by_what_contacts_say() -> None:
    patch = bt.Patch.grid(16, 16, 2e-3, 5e-3)
    center, radius = np.array([[0.3e-3, -0.2e-3, 0.0]]), 0.012
    pose = np.array([0, 0, 0.01, 1, 0, 0, 0])
    _, contacts = patch.press(bt.SphereUnion(center, radius), pose, contacts=True)
    wide, narrow = (
        patch.press(bt.SphereUnion(center, radius + step), pose).ravel() for step in (STEP, -STEP)
    )
    expected = ((wide - narrow) / (2 * STEP))[contacts.taxel]
    inner = contacts.deflection > 1e-4
    by_radius = np.linalg.norm(contacts.gradient, axis=1)
    np.testing.assert_allclose(by_radius[inner], expected[inner], rtol=1e-6)


def test_batches_have_rows_for_each_pose(mug: bt.SphereUnion, patch: bt.Patch) -> None:
    poses = bt.touch_poses(mug, offset=np.random.default_rng(0).uniform(-0.01, 0.01, (30, 2)))
    frames, contacts, jacobian = patch.press(mug, poses, depth=3e-3, contacts=True, jacobian=True)
    assert jacobian.shape == (30, 32, 48, 6)
    for number in (0, 17):
        one = patch.press(mug, poses[number], depth=3e-3, jacobian=True)
        np.testing.assert_array_equal(one[0], frames[number])
        np.testing.assert_array_equal(one[1], jacobian[number])
    assert len(contacts) == contacts.n_touched.sum()
