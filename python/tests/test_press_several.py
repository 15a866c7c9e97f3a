"""Tests of presses on several objects, of forces as output, and of presses that slide."""

from __future__ import annotations

from typing import Any

import bubbletouch as bt
import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import refused

Floats = NDArray[np.float64]


def poses_of(*objects: bt.SphereUnion | bt.Mesh) -> Floats:
    """Returns poses (20, k, 7) of k objects beside each other, whose tops are at the same height."""
    random = np.random.default_rng(3)
    of_each = []
    for number, thing in enumerate(objects):
        aside = [[0.0, 0.0], [0.02, 0.0], [-0.01, 0.02]][number]
        offset, tilt = random.uniform(-0.01, 0.01, (20, 2)) + aside, random.uniform(-0.1, 0.1, (20, 2))
        of_each.append(bt.touch_poses(thing, offset=offset, tilt=tilt))
    return np.stack(of_each, axis=1)


@pytest.fixture(scope="module")
def poses(mug: bt.SphereUnion) -> Floats:
    return poses_of(mug, mug, mug)


def moved(poses: Floats, travel: Floats) -> Floats:
    """Returns the poses after the travel of the patch."""
    there = poses.copy()
    there[..., 2] -= np.reshape(travel, (-1,) + (1,) * (poses.ndim - 2))
    return there


def test_several_objects_press_as_the_largest_of_single_presses(
    patch: bt.Patch, mug: bt.SphereUnion, box: bt.Mesh
) -> None:
    ring = bt.Patch.hexagonal(20, 20, 3e-3, 5e-3)
    ball = bt.SphereUnion([[0.0, 0.0, 0.0]], 0.02)
    for skin in (patch, ring):
        for objects, tolerance in [([mug, mug, ball], 0.0), ([mug, box, ball], 1e-15), ((box, box, box), 1e-15)]:
            there = moved(poses_of(*objects), np.full(20, 3e-3))
            singles = [skin.press(thing, there[:, k]) for k, thing in enumerate(objects)]
            together = skin.press(objects, there)
            assert together.shape == (20, *skin.shape) and together.max() > 1e-3
            np.testing.assert_allclose(together, np.max(singles, axis=0), rtol=0, atol=tolerance)
            np.testing.assert_array_equal(skin.press(objects, there[7]), together[7])


def test_goals_of_several_objects_are_common_goals(
    patch: bt.Patch, mug: bt.SphereUnion, box: bt.Mesh
) -> None:
    objects = [mug, box, mug]
    poses = poses_of(*objects)
    frames, contacts = patch.press(objects, poses, depth=3e-3, contacts=True)
    np.testing.assert_allclose(frames.max(axis=(1, 2)), 3e-3, atol=1e-12)
    firsts = [patch.press(thing, poses[:, k], depth=0, contacts=True)[1].travel for k, thing in enumerate(objects)]
    np.testing.assert_allclose(contacts.travel, np.min(firsts, axis=0) + 3e-3, atol=1e-12)
    np.testing.assert_allclose(patch.press(objects, moved(poses, contacts.travel)), frames, atol=1e-12)
    np.testing.assert_allclose(patch.press(objects, poses, travel=contacts.travel), frames, atol=1e-12)
    forces = 100 * frames.sum(axis=(1, 2))
    np.testing.assert_allclose(patch.press(objects, poses, force=forces), frames, atol=1e-9)
    # Each contact belongs to the object that deflects its taxel most.
    singles = [patch.press(thing, moved(poses[:, k], contacts.travel)) for k, thing in enumerate(objects)]
    of_taxel = np.reshape(singles, (3, 20, -1))[:, contacts.pose, contacts.taxel]
    of_contact = of_taxel[contacts.object, np.arange(len(contacts))]
    np.testing.assert_allclose(of_contact, of_taxel.max(axis=0), atol=1e-12)
    assert set(contacts.object) == {0, 1, 2}
    assert set(patch.press(mug, poses[:, 0], depth=1e-3, contacts=True)[1].object) == {0}


def test_a_sequence_of_one_object_is_the_object(patch: bt.Patch, mug: bt.SphereUnion, poses: Floats) -> None:
    one = patch.press(mug, poses[:, 0], depth=2e-3, jacobian=True)
    of_list = patch.press([mug], poses[:, :1], depth=2e-3, jacobian=True)
    np.testing.assert_array_equal(of_list[0], one[0])
    np.testing.assert_array_equal(of_list[1][..., 0, :], one[1])
    matrices = np.tile(np.eye(4), (2, 1, 1))
    frame = patch.press([mug, mug], matrices)
    np.testing.assert_array_equal(frame, patch.press(mug, [0, 0, 0, 1, 0, 0, 0]))


@pytest.mark.parametrize("goal", [{}, {"depth": 3e-3}, {"force": 20.0}])
def test_derivatives_by_the_pose_of_each_object_are_differences(
    patch: bt.Patch, mug: bt.SphereUnion, poses: Floats, goal: dict[str, float]
) -> None:
    objects, start = [mug, mug, mug], poses[2]
    if not goal:
        start = moved(start, patch.press(objects, start, depth=3e-3, contacts=True)[1].travel)
    frame, changes = patch.press(objects, start, jacobian=True, output="force", **goal)  # type: ignore[call-overload]
    assert changes.shape == (32, 48, 3, 6)
    step = 1e-8
    for k in range(3):
        for axis in range(3):
            ahead, behind = start.copy(), start.copy()
            ahead[k, axis] += step
            behind[k, axis] -= step
            pressed = [patch.press(objects, side, output="force", **goal) for side in (ahead, behind)]  # type: ignore[call-overload]
            expected = (pressed[0] - pressed[1]) / (2 * step)
            off = np.abs(changes[..., k, axis] - expected)
            # At a few taxels another sphere becomes the deepest one within the step.
            assert np.quantile(off[frame > 0], 0.98) < 1e-3 * np.abs(expected).max() + 1e-3
    assert all(np.abs(changes[..., k, :]).max() > 10 for k in range(3))


def test_forces_are_stiffness_times_deflection(patch: bt.Patch, mug: bt.SphereUnion, poses: Floats) -> None:
    stiffness = np.linspace(50, 150, 30)
    uneven = bt.Patch.from_arrays(
        bt.Patch.hexagonal(5, 6, 3e-3, 5e-3).centers, np.tile([0, 0, 1], (30, 1)),
        stroke=5e-3, taxel_radius=1.5e-3, stiffness=stiffness, shape=(5, 6),
    )  # fmt: skip
    for skin, factor in [(patch, 100.0), (uneven, stiffness.reshape(5, 6))]:
        frames, changes = skin.press(mug, poses[:, 0], depth=3e-3, jacobian=True)
        forces, slopes = skin.press(mug, poses[:, 0], depth=3e-3, jacobian=True, output="force")
        np.testing.assert_array_equal(forces, frames * factor)
        np.testing.assert_array_equal(slopes, changes * np.expand_dims(factor, -1))
        out = np.full(frames.shape, np.nan, np.float32)
        skin.press(mug, poses[:, 0], depth=3e-3, output="force", out=out)
        single = skin.press(mug, poses[:, 0], depth=3e-3, dtype="float32").astype(np.float64)
        np.testing.assert_array_equal(out, (single * factor).astype(np.float32))
    total = patch.press(mug, poses[:, 0], force=3.0, output="force").sum(axis=(1, 2))
    np.testing.assert_allclose(total, 3.0, rtol=1e-11)


PLATE = bt.Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 2, 1], [0, 3, 2]])
OVER = [0.013, 0.0, 0.01, 1.0, 0.0, 0.0, 0.0]


def test_a_plate_sticks_with_its_shear_springs_and_slips_at_the_friction_cone(patch: bt.Patch) -> None:
    way = np.array([[0.2e-3, -0.1e-3], [4e-3, 3e-3]])
    felt = patch.press_and_slide(
        PLATE, np.tile(OVER, (2, 1)), depth=2e-3, slide=way, friction=0.5, shear_stiffness=250.0
    )
    np.testing.assert_allclose(felt["deflection"], 2e-3, atol=1e-12)
    np.testing.assert_allclose(felt["travel"], 0.01 - patch.taxel_radius + 2e-3, atol=1e-12)
    np.testing.assert_allclose(felt["force3"][..., 2], -0.2, atol=1e-10)
    # The patch moves along +x, so that the plate pushes its taxels along −x.
    np.testing.assert_allclose(felt["force3"][0, :, :2], np.tile(-250.0 * way[0], (32 * 48, 1)), atol=1e-9)
    np.testing.assert_allclose(felt["force3"][1, :, :2], np.tile([-0.08, -0.06], (32 * 48, 1)), atol=1e-9)
    assert not felt["is_slipping"][0].any() and felt["is_slipping"][1].all()
    np.testing.assert_allclose(felt["wrench"][:, :3], felt["force3"].sum(axis=1), atol=1e-9)


def test_a_batch_of_slides_is_its_slides_one_by_one(patch: bt.Patch, mug: bt.SphereUnion, box: bt.Mesh, poses: Floats) -> None:
    ring = bt.Patch.hexagonal(16, 16, 3e-3, 5e-3, stiffness=70.0)
    random = np.random.default_rng(8)
    given: dict[str, Any] = {"depth": random.uniform(1e-3, 3e-3, 20), "slide": random.uniform(-2e-3, 2e-3, (20, 2))}
    for skin, thing, at in [(patch, mug, poses[:, 0]), (ring, [mug, box, mug], poses_of(mug, box, mug))]:
        friction = random.uniform(0.1, 0.8, skin.n_taxels)
        batch = skin.press_and_slide(thing, at, **given, friction=friction)
        for threads in (1, 3):
            again = skin.press_and_slide(thing, at, **given, friction=friction, threads=threads)
            assert all(np.array_equal(again[key], batch[key]) for key in batch)
        for number in range(20):
            single = {key: values[number] for key, values in given.items()}
            one = skin.press_and_slide(thing, at[number], **single, friction=friction)
            assert all(np.array_equal(one[key], batch[key][number]) for key in batch)
        force = batch["force3"]
        normal, across = -force[..., 2], np.linalg.norm(force[..., :2], axis=-1)
        assert (across > 0.01).sum() > 100 and batch["is_slipping"].any()
        np.testing.assert_allclose(force.sum(axis=1), batch["wrench"][:, :3], atol=1e-9)
        np.testing.assert_allclose(normal, 100.0 * batch["deflection"].reshape(20, -1) * np.divide(skin.stiffness, 100.0), atol=1e-12)


def test_without_friction_and_slide_the_forces_are_those_of_a_press(patch: bt.Patch, mug: bt.SphereUnion, poses: Floats) -> None:
    felt = patch.press_and_slide(mug, poses[:, 0], depth=3e-3, slide=[0.0, 0.0], friction=0.0)
    frames, contacts = patch.press(mug, poses[:, 0], depth=3e-3, contacts=True)
    np.testing.assert_allclose(felt["deflection"], frames, atol=1e-14)
    expected = np.zeros((20, patch.n_taxels, 3))
    expected[contacts.pose, contacts.taxel] = -contacts.force
    np.testing.assert_allclose(felt["force3"], expected, atol=1e-10)
    away = patch.press_and_slide(mug, poses[0, 0] + [9, 0, 0, 0, 0, 0, 0], depth=1e-3, slide=[1e-3, 0], friction=0.3)
    assert np.isnan(away["travel"]) and away["travel"].shape == () and (away["force3"] == 0).all()


def test_invalid_arguments_of_several_objects_and_slides_are_refused(
    patch: bt.Patch, mug: bt.SphereUnion, poses: Floats
) -> None:
    two = [mug, mug]
    slide: dict[str, Any] = {"depth": 1e-3, "slide": [0, 0], "friction": 0.1}
    for call, said in [
        (lambda: patch.press(two, poses), r"poses: shape \(20, 3, 7\); \(n, 2, 7\)"),
        (lambda: patch.press(two, poses[0, 0]), r"poses: shape \(7,\); \(n, 2, 7\)"),
        (lambda: patch.press(two, np.where(np.arange(7) == 3, np.nan, poses[:, :2])), r"poses\[0, 0\]"),
        (lambda: patch.press([], poses[:, :0]), "object: no object; at least one"),
        (lambda: patch.press(mug, poses[0, 0], output="pressure"), 'output: `pressure`; deflection or force'),  # type: ignore[call-overload]
        (lambda: patch.press_and_slide(mug, poses[0, 0], **slide | {"slide": [0, 0, 0]}), r"slide: shape \(3,\)"),
        (lambda: patch.press_and_slide(mug, poses[0, 0], **slide | {"slide": [0, np.inf]}), "slide: .*finite"),
        (lambda: patch.press_and_slide(mug, poses[0, 0], **slide | {"friction": -1}), "friction"),
        (lambda: patch.press_and_slide(mug, poses[0, 0], **slide, shear_stiffness=0), "shear stiffness: 0 N/m"),
        (lambda: patch.press_and_slide(mug, poses[0, 0], **slide | {"depth": -1}), "depth: -1"),
    ]:
        refused(said, lambda: call())
    refused(r"object\[1\]", lambda: patch.press([mug, "mug"], poses[:, :2]), TypeError)  # type: ignore[list-item]
    refused("object: ", lambda: patch.press(3, poses[:, 0]), TypeError)  # type: ignore[call-overload]
