"""Tests of presses: results and output arrays."""

from __future__ import annotations

import threading

import bubbletouch as bt
import numpy as np
import pytest
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@pytest.fixture(scope="module")
def poses(mug: bt.SphereUnion) -> Floats:
    random = np.random.default_rng(7)
    offset, tilt = random.uniform(-0.01, 0.01, (50, 2)), random.uniform(-0.1, 0.1, (50, 2))
    return bt.touch_poses(mug, offset=offset, tilt=tilt, yaw=random.uniform(0, 6, 50))


def test_a_ball_presses_as_the_closed_form_says() -> None:
    patch = bt.Patch.grid(15, 17, 2e-3, 5e-3)
    ball = bt.SphereUnion([[0, 0, 0]], 20e-3)
    frame = patch.press(ball, [0.3e-3, -0.4e-3, 30e-3, 1, 0, 0, 0], depth=3e-3)
    across = patch.centers[:, :2] - [0.3e-3, -0.4e-3]
    reach = 21e-3
    heights = np.sqrt(np.maximum(reach**2 - (across**2).sum(axis=1), 0))
    expected = np.maximum(heights - heights.max() + 3e-3, 0) * (heights > 0)
    np.testing.assert_allclose(frame.ravel(), expected, atol=1e-15)


def test_shapes_are_those_of_the_poses_and_the_patch(
    patch: bt.Patch, mug: bt.SphereUnion, poses: Floats
) -> None:
    ring = bt.Patch.hexagonal(10, 12, 4e-3, 5e-3)
    assert patch.press(mug, poses, depth=1e-3).shape == (50, 32, 48)
    assert patch.press(mug, poses[0], depth=1e-3).shape == (32, 48)
    assert ring.press(mug, poses, depth=1e-3).shape == (50, 120)
    assert ring.press(mug, poses[0], depth=1e-3).shape == (120,)
    assert patch.press(mug, poses[:0], depth=1e-3).shape == (0, 32, 48)


def test_a_batch_is_its_poses_one_by_one_at_any_number_of_threads(
    patch: bt.Patch, mug: bt.SphereUnion, poses: Floats, box: bt.Mesh
) -> None:
    ring = bt.Patch.hexagonal(16, 16, 3e-3, 5e-3)
    for skin, thing in [(patch, mug), (patch, box), (ring, mug), (ring, box)]:
        one_by_one = np.stack([skin.press(thing, pose, depth=3e-3) for pose in poses])
        for threads in (None, 1, 2, 7):
            batch = skin.press(thing, poses, depth=3e-3, threads=threads)
            np.testing.assert_array_equal(batch, one_by_one)
        assert one_by_one.max() > 0


def test_frames_are_written_in_place(patch: bt.Patch, mug: bt.SphereUnion, poses: Floats) -> None:
    expected = patch.press(mug, poses, depth=3e-3)
    out = np.full((50, 32, 48), np.nan)
    assert patch.press(mug, poses, depth=3e-3, out=out) is out
    np.testing.assert_array_equal(out, expected)
    single = np.full((50, 32, 48), np.nan, np.float32)
    patch.press(mug, poses, depth=3e-3, out=single)
    np.testing.assert_array_equal(single, expected.astype(np.float32))
    new = patch.press(mug, poses, depth=3e-3, dtype="float32")
    assert new.dtype == np.float32
    np.testing.assert_array_equal(new, single)
    # The output is a part of a larger array, and contains previous values.
    many = np.ones((100, 32, 48))
    patch.press(mug, poses, depth=3e-3, out=many[25:75])
    np.testing.assert_array_equal(many[25:75], expected)
    assert (many[:25] == 1).all() and (many[75:] == 1).all()
    away = poses + [10, 0, 0, 0, 0, 0, 0]
    patch.press(mug, away, depth=3e-3, out=out)
    assert (out == 0).all()


def test_matrices_are_poses_too(patch: bt.Patch, mug: bt.SphereUnion, poses: Floats) -> None:
    w, x, y, z = poses[:, 3:].T
    matrices = np.zeros((50, 4, 4))
    matrices[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], 1)
    matrices[:, 1, :3] = np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], 1)
    matrices[:, 2, :3] = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1)
    matrices[:, :3, 3], matrices[:, 3, 3] = poses[:, :3], 1
    frames = patch.press(mug, matrices, depth=3e-3)
    np.testing.assert_allclose(frames, patch.press(mug, poses, depth=3e-3), atol=1e-14)
    np.testing.assert_array_equal(patch.press(mug, matrices[3], depth=3e-3), frames[3])


def test_depth_travel_and_force_agree(
    patch: bt.Patch, mug: bt.SphereUnion, box: bt.Mesh, poses: Floats
) -> None:
    ring = bt.Patch.hexagonal(20, 20, 3e-3, 5e-3)
    for skin, thing in [(patch, mug), (ring, mug), (patch, box), (ring, box)]:
        frames, contacts = skin.press(thing, poses, depth=2e-3, contacts=True)
        again = skin.press(thing, poses, travel=contacts.travel)
        np.testing.assert_allclose(again, frames, atol=1e-15)
        forces = 100.0 * frames.reshape(50, -1).sum(axis=1)
        by_force = skin.press(thing, poses, force=forces)
        np.testing.assert_allclose(by_force, frames, atol=1e-9)
        moved = poses.copy()
        moved[:, 2] -= contacts.travel
        np.testing.assert_allclose(skin.press(thing, moved), frames, atol=1e-12)


def test_each_pose_may_have_a_depth_of_its_own(
    patch: bt.Patch, mug: bt.SphereUnion, poses: Floats
) -> None:
    depths = np.linspace(0, 4e-3, 50)
    deepest = patch.press(mug, poses, depth=depths).max(axis=(1, 2))
    np.testing.assert_allclose(deepest, depths, atol=1e-12)


def test_contacts_say_what_touches_what(
    patch: bt.Patch, mug: bt.SphereUnion, box: bt.Mesh, poses: Floats
) -> None:
    for thing in (mug, box):
        frames, contacts = patch.press(thing, poses, depth=4e-3, contacts=True)
        np.testing.assert_array_equal(frames, patch.press(thing, poses, depth=4e-3))
        flat = frames.reshape(50, -1)
        np.testing.assert_allclose(contacts.deflection, flat[contacts.pose, contacts.taxel], atol=1e-14)
        np.testing.assert_array_equal(contacts.n_touched, (flat > 0).sum(axis=1))
        np.testing.assert_allclose(np.linalg.norm(contacts.normal, axis=1), 1, atol=1e-9)
        # Without friction, the force is parallel to the normal, and its component along the taxel's axis is the spring force.
        # At a grazing contact, whose normal is perpendicular to the axis, the force is bounded.
        head_on = contacts.normal[:, 2] < -0.01
        assert head_on.mean() > 0.99
        np.testing.assert_allclose(
            contacts.force[head_on, 2], 100 * contacts.deflection[head_on], rtol=1e-9
        )
        np.testing.assert_allclose(
            np.cross(contacts.force, contacts.normal), 0, atol=1e-9 * np.abs(contacts.force).max()
        )
        assert contacts.part.max() < len(thing) and len(contacts) > 1000
    assert bt.Patch.grid(4, 4, 2e-3, 1e-3).press(
        mug, poses[0], depth=5e-3, contacts=True
    )[1].n_saturated > 0


def test_where_nothing_is_met_frames_are_zero_and_the_travel_is_nan(
    patch: bt.Patch, mug: bt.SphereUnion, poses: Floats
) -> None:
    poses = poses[:8] + np.array([10.0, 0, 0, 0, 0, 0, 0]) * (np.arange(8) % 2)[:, None]
    # The travel is 2 mm past the largest travel to first contact.
    travel = 2e-3 + patch.press(mug, poses[::2], depth=1e-9, contacts=True)[1].travel.max()
    there = poses - np.array([0, 0, travel, 0, 0, 0, 0])
    goals: list[tuple[Floats, dict[str, float]]] = [
        (there, {}),
        (poses, {"travel": travel}),
        (poses, {"depth": 2e-3}),
        (poses, {"force": 1.0}),
    ]
    for given, goal in goals:
        frames, contacts = patch.press(mug, given, contacts=True, **goal)  # type: ignore[call-overload]
        assert (frames[1::2] == 0).all() and (frames[::2].max(axis=(1, 2)) > 0).all()
        assert np.isnan(contacts.travel[1::2]).all() and np.isfinite(contacts.travel[::2]).all()
        assert set(contacts.pose) == {0, 2, 4, 6}


def test_a_press_to_a_force_feels_it(patch: bt.Patch, mug: bt.SphereUnion, poses: Floats) -> None:
    frames = patch.press(mug, poses, force=3.0)
    np.testing.assert_allclose(100 * frames.sum(axis=(1, 2)), 3.0, rtol=1e-11)
    with pytest.raises(ValueError, match=r"poses\[0\]: .*1000000"):
        patch.press(mug, poses, force=1e6)


def test_threads_of_python_press_at_once(
    patch: bt.Patch, mug: bt.SphereUnion, poses: Floats
) -> None:
    expected = patch.press(mug, poses, depth=3e-3)
    failed: list[int] = []

    def press() -> None:
        for _ in range(20):
            if not np.array_equal(patch.press(mug, poses, depth=3e-3), expected):
                failed.append(1)

    threads = [threading.Thread(target=press) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed


def test_a_stable_pose_lies_lower_than_the_object_stands() -> None:
    can = bt.Catalogue.builtin().set("cans")[0].pack(1e-3)
    heights = []
    for rest in (None, 0):
        pose = bt.touch_poses(can, rest=rest)
        heights.append(pose[2])
    assert all(height > 0 for height in heights)
    with pytest.raises(ValueError, match="rest: 99; 0 to .*, the stable poses of this object"):
        bt.touch_poses(can, rest=99)
