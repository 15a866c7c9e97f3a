"""The gripper and the five-finger hand of objects/robots: they hold objects in MuJoCo."""

from __future__ import annotations

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
from hands import BALL, BOX, close_gripper, close_hand, normal_forces, with_object  # noqa: E402

CAN = '<geom name="can" type="cylinder" size="0.028 0.04" euler="0 90 0" mass="0.15"/>'


@pytest.mark.parametrize("geoms", [BALL, BOX, CAN])
def test_the_hand_holds_an_object_with_all_parts(geoms) -> None:
    model = with_object("five_finger_hand", geoms)
    assert (model.nq - 7, model.nu, model.nsite) == (20, 20, 20)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.ncon == 0  # no part of the open hand touches another
    close_hand(model, data)
    before = data.body("object").xpos.copy()
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert np.linalg.norm(data.body("object").xpos - before) < 5e-3
    forces = normal_forces(model, data)
    touching = {body.split("_")[0] for body, force in forces.items() if force > 0.1}
    assert {"palm", "thumb"} < touching and len(touching) >= 5, forces
    # The hand holds the object in any direction.
    for gravity in np.vstack([np.eye(3), -np.eye(3)]) * 9.81:
        turned = mujoco.MjData(model)
        mujoco.mj_copyData(turned, model, data)
        model.opt.gravity[:] = gravity
        for _ in range(250):
            mujoco.mj_step(model, turned)
        assert np.linalg.norm(turned.body("object").xpos - data.body("object").xpos) < 0.01, gravity


@pytest.mark.parametrize("geoms", [BALL, BOX, CAN])
def test_the_gripper_holds_an_object_by_equal_forces(geoms) -> None:
    model = with_object("gripper", geoms, 'pos="0.003 0.004 0.115"')
    data = mujoco.MjData(model)
    close_gripper(model, data)
    model.opt.gravity[:] = [9.81, 0.0, 0.0]
    before = data.body("object").xpos.copy()
    for _ in range(1000):
        mujoco.mj_step(model, data)
    forces = normal_forces(model, data)
    left, right = forces["left_finger"], forces["right_finger"]
    assert len(forces) == 2 and abs(left - right) < 0.2 and min(left, right) > 5, forces
    # The axes of the pads' sites point to each other.
    axes = [data.site(f"{side}_pad").xmat.reshape(3, 3)[:, 2] for side in ("left", "right")]
    apart = data.site("right_pad").xpos - data.site("left_pad").xpos
    assert axes[0] @ apart > 0.02 and np.allclose(axes[0], -axes[1])
    assert np.linalg.norm(data.body("object").xpos - before) < 2e-3
