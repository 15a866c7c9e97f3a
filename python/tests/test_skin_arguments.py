"""Arguments of bt.Skin: shapes of poses, arrays that are filled, copies, and the messages for wrong ones."""

from __future__ import annotations

import copy
import pickle

import bubbletouch as bt
import numpy as np
import pytest

from conftest import refused

PATCH = bt.Patch.grid(4, 4, 2e-3, 3e-3, stiffness=100.0)
POSE = np.array([0.0, 0, 0, 1, 0, 0, 0])
BODY = np.array([1e-3, 0, 0.0105, 1, 0, 0, 0])


def skin() -> bt.Skin:
    return bt.Skin([PATCH], [bt.Mesh.box([0.02, 0.02, 0.02])])


def moved(n: int) -> np.ndarray:
    poses = np.tile(BODY, (n, 1))
    poses[:, 2] -= 1e-4 * np.arange(n)
    return poses


def test_a_single_patch_and_body_need_no_axis_and_one_set_serves_for_all() -> None:
    one = skin()
    bodies = moved(5)
    matrices = np.tile(np.eye(4), (5, 1, 1))
    matrices[:, :3, 3] = bodies[:, :3]
    expected = np.array([one.read(POSE, body) for body in bodies])
    assert expected.shape == (5, 16) and len(np.unique(expected.max(axis=1))) == 5
    patches = np.tile(POSE, (5, 1))
    for patch_poses in (POSE, POSE[None], POSE[None, None], patches, patches[:, None], np.eye(4), (POSE[:3], POSE[3:]), [POSE[:3], np.eye(3)]):
        for body_poses in (bodies, bodies[:, None], matrices, matrices[:, None], (bodies[:, :3], bodies[:, 3:]), [bodies[:, :3], bodies[:, 3:]]):
            assert np.array_equal(one.read(patch_poses, body_poses), expected)
    assert np.abs(one.read(patches, BODY) - expected[0]).max() == 0.0
    # A batch of one set keeps its axis.
    assert one.read(POSE, bodies[:1, None]).shape == (1, 16) and one.read(POSE, bodies[:1]).shape == (16,)
    assert one.read(POSE, np.zeros((0, 7))).shape == (0, 16)
    two = bt.Skin([PATCH, PATCH], [bt.Mesh.box([0.02, 0.02, 0.02])])
    assert np.array_equal(two.read([POSE, POSE], bodies), np.concatenate([expected, expected], axis=1))
    assert np.array_equal(two.read([POSE, POSE], bodies.astype(np.float32)[:, ::1]), two.read([POSE, POSE], bodies.astype(np.float32).astype(float)))


def test_wrong_poses_are_refused_with_their_place_and_numbers() -> None:
    one = skin()
    left = np.eye(4)
    left[0, 0] = -1
    nan = moved(3)
    nan[1, 0] = np.nan
    for poses, words in [
        (nan[:, None], r"body_poses\[1, 0\]: \[NaN, 0, 0.0104[0-9]*, 1, 0, 0, 0\]; finite x, y, z and a quaternion"),
        ([0, 0, 0, 0, 0, 0, 0], r"body_poses\[0\]: \[0, 0, 0, 0, 0, 0, 0\]; finite x, y, z and a quaternion"),
        ([0, 0, 0, 2, 0, 0, 0], r"body_poses\[0\]: .*of length one"),
        (left, r"body_poses\[0\]: \[-1, 0, .*; a rotation and a translation"),
        ((BODY[:3], left[:3, :3]), r"body_poses\[0\]: position \[0.001, 0, 0.0105\], rotation \[-1, .*; a finite position, and a right-handed rotation"),
        ((BODY[:3], [2, 0, 0, 0]), r"body_poses\[0\]: position .*, rotation \[2, 0, 0, 0\]; a finite position, and a quaternion"),
        (BODY[:6], r"body_poses: shape \(6,\); "),
    ]:
        refused(words, lambda: one.read(POSE, poses))
    refused("poses: 3 sets of patch_poses, 2 of body_poses; the same number of sets, or one set of either", lambda: one.read(np.tile(POSE, (3, 1)), moved(2)))
    refused("objects: -1; zero or a positive whole number", lambda: bt.Skin([PATCH], [bt.Mesh.box([0.02, 0.02, 0.02])], objects=[-1]))


def test_arrays_to_fill_are_checked_before_anything_is_changed() -> None:
    one = skin()
    state = one.shear_state(100.0, 0.5)
    locked = np.zeros(16)
    locked.setflags(write=False)
    out, wrenches = np.full(16, -1.0), np.full((1, 6), -1.0)
    for wrong, words in [
        ({"travels": np.zeros((1, 1), np.float32)}, r"travels: an array of float32; a float64 array in C order of shape \(1, 1\)"),
        ({"contacts": np.zeros((1, 2))}, "contacts: an array of float64; an int64 array in C order"),
        ({"pair_forces": np.zeros(1)}, r"pair_forces: shape \(1,\); a float64 array in C order of shape \(1, 1\)"),
        ({"residuals": [[0.0]]}, "residuals: <class 'list'>; a float64 array"),
        ({"out": np.zeros(32)[::2]}, "out: an array in another order; a float64 array in C order"),
        ({"out": locked}, "out: The given array is not writeable; a writeable array"),
        ({"out": np.zeros(16, ">f8")}, "out: an array of >f8; a float64 array"),
    ]:
        refused(words, lambda: one.read(POSE, BODY, shear=state, **{"out": out, "wrenches": wrenches, **wrong}))
        assert (out == -1).all() and (wrenches == -1).all() and not state.forces.any()
    rows = np.zeros((3, 16))
    assert one.read(POSE, BODY, out=rows[1]).any() and not rows[[0, 2]].any()


def test_skins_are_pickled_and_copied() -> None:
    bodies = [bt.Mesh.box([0.02, 0.02, 0.02]), bt.SphereUnion(np.zeros((1, 3)), [0.012])]
    can_touch = np.array([[True, False], [True, True]])
    two = bt.Skin([PATCH, bt.Patch.sphere_cap(0.01, 1.5, 3e-3, 3e-3)], bodies, objects=[0, 0], can_touch=can_touch)
    # The skin keeps the pairs, whatever becomes of the array.
    can_touch[:] = False
    poses = (np.tile(POSE, (2, 1)), moved(2))
    expected = two.read(*poses)
    assert expected.any()
    for other in (pickle.loads(pickle.dumps(two)), copy.copy(two), copy.deepcopy(two)):
        assert np.array_equal(other.read(*poses, pair_forces=np.empty((2, 1))), expected)
    state = two.shear_state(100.0, 0.5)
    two.read(*poses, shear=state)
    two.read(poses[0], poses[1] + [2e-4, 0, 0, 0, 0, 0, 0], shear=state)
    kept = copy.deepcopy(state)
    assert np.array_equal(kept.forces, state.forces) and kept.forces[:, 0].any()
    two.read(*poses, shear=state)
    assert not np.array_equal(kept.forces, state.forces)
    two.read(*poses, shear=kept)
    assert np.array_equal(kept.forces, state.forces)


def test_a_skin_of_mujoco_is_pickled_with_its_model() -> None:
    mujoco = pytest.importorskip("mujoco")
    from bubbletouch.mujoco import Skin

    model = mujoco.MjModel.from_xml_string("""
    <mujoco><worldbody><geom name="plate" type="box" size="0.05 0.05 0.01" pos="0 0 -0.01"/><site name="top"/>
      <body pos="0 0 0.019"><freejoint/><geom type="sphere" size="0.02"/></body></worldbody></mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    one = Skin(model, {"top": PATCH})
    for other in (pickle.loads(pickle.dumps(one)), copy.deepcopy(one)):
        assert np.array_equal(other.read(data, match="normal_force"), one.read(data, match="normal_force")) and one.read(data).any()
