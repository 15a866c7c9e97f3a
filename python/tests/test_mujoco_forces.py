"""Skin in MuJoCo whose normal forces are the engine's."""

from __future__ import annotations

import bubbletouch as bt
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
from bubbletouch.mujoco import Skin  # noqa: E402
from hands import BALL, BOX, close_gripper, close_hand, normal_forces, with_object  # noqa: E402

SOFT = dict(stroke=4e-3, stiffness=600.0)
MATCH = dict(match="normal_force")


def pads(kind: str) -> dict[str, bt.Patch]:
    if kind == "grid":
        return {name: bt.Patch.grid(16, 10, 2e-3, **SOFT) for name in ("left_pad", "right_pad")}
    return {name: bt.Patch.hexagonal(18, 10, 2e-3, **SOFT) for name in ("left_pad", "right_pad")}


def things(rng: np.random.Generator) -> list[str]:
    """Returns one geom of each kind with random sizes."""
    a, b, c = rng.uniform(0.012, 0.028, 3)
    points = rng.normal(size=(20, 3)) * 0.02
    hull = " ".join(f"{x:.5f}" for x in (points * (0.025 / np.linalg.norm(points, axis=1))[:, None]).ravel())
    return [
        f'<geom name="thing" type="sphere" size="{a}"/>',
        f'<geom name="thing" type="box" size="{a} {b} {c}"/>',
        f'<geom name="thing" type="capsule" size="{a} 0.02"/>',
        f'<geom name="thing" type="cylinder" size="{a} {b}"/>',
        f'<geom name="thing" type="ellipsoid" size="{a} {b} {c}"/>',
        # Two boxes side by side and a ball: all press the same taxels.
        f'<geom name="thing" type="box" size="{a} {b} {c}"/><geom type="box" size="{a} {b} {c}" pos="{a} 0 0"/><geom type="sphere" size="{c}"/>',
        f'<geom name="thing" type="mesh" mesh="hull"/>|<asset><mesh name="hull" vertex="{hull}"/></asset>',
    ]


@pytest.mark.parametrize("kind", ["grid", "hexagonal"])
def test_the_sum_of_forces_is_the_engine_s_in_random_grasps(kind: str) -> None:
    rng = np.random.default_rng(5)
    for _ in range(15):  # 105 grasps
        for text in things(rng):
            geoms, _, others = text.partition("|")
            turn = rng.normal(size=4)
            x, y, z = rng.uniform(-4e-3, 4e-3, 3)
            pose = f'pos="{x} {y} {0.114 + z}" quat="{" ".join(map(str, turn / np.linalg.norm(turn)))}"'
            model = with_object("gripper", geoms, pose, others)
            data = mujoco.MjData(model)
            close_gripper(model, data, n_steps=int(rng.integers(120, 400)))
            skin = Skin(model, pads(kind))
            assert skin.bodies == ["left_finger", "right_finger", "object"]
            pair_forces, residuals, travels = np.empty((2, 3)), np.empty((2, 3)), np.empty((2, 3))
            read = skin.read(
                data, output="force", **MATCH, pair_forces=pair_forces, residuals=residuals, travels=travels
            )
            forces = normal_forces(model, data)
            engine = np.array([forces.get(f"{side}_finger", 0.0) for side in ("left", "right")])
            assert engine.max() > 0.1
            assert np.abs(pair_forces[:, 2] - engine).max() < 1e-6 and np.abs(residuals).max() < 1e-6, (text, residuals)
            assert abs(read.sum() - engine.sum()) < 1e-6


def floating(gap: float, force: float, others: str = "") -> tuple[object, object]:
    """Returns a ball over a plate whose contact has a given distance, metres, and normal force, newtons."""
    text = f"""
    <mujoco>
      <option gravity="0 0 {-force / 0.1}" timestep="1e-4"/>
      <worldbody>
        <body name="plate"><geom name="plate" type="box" size="0.03 0.03 0.005" pos="0 0 -0.005"/><site name="top"/>{others}</body>
        <body name="ball" pos="0 0 {0.02 + gap}"><freejoint/><geom name="ball" type="sphere" size="0.02" mass="0.1" margin="0.02"/></body>
      </worldbody>
    </mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def test_force_without_overlap_moves_the_patch_to_the_geom_and_overlap_without_force_reads_zero() -> None:
    model, data = floating(3e-3, 0.98)
    patch = bt.Patch.grid(10, 10, 2e-3, **SOFT)
    skin = Skin(model, {"top": patch})
    engine = sum(c[0] for c in contact_forces(model, data))
    assert engine > 0.1 and not skin.read(data).any()
    travels, residuals = np.empty((1, 1)), np.empty((1, 1))
    read = skin.read(data, output="force", **MATCH, travels=travels, residuals=residuals)
    assert abs(read.sum() - engine) < 1e-6 and travels[0, 0] > 2e-3 and abs(residuals[0, 0]) < 1e-6
    read = skin.read(data, output="force", **MATCH, reach=1e-3, travels=travels, residuals=residuals)
    assert not read.any() and residuals[0, 0] == engine and travels[0, 0] == 1e-3

    # The engine knows of no contact: the pair is excluded.
    model, data = floating(-1e-3, 0.98)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    mujoco.mj_forward(model, data)
    assert data.ncon == 0 and skin.read(data).any()
    assert not skin.read(data, **MATCH).any()


def contact_forces(model, data) -> list[np.ndarray]:
    forces = [np.zeros(6) for _ in range(data.ncon)]
    for number, force in enumerate(forces):
        mujoco.mj_contactForce(model, data, number, force)
    return forces


def test_contacts_on_the_back_press_no_patch_and_are_in_the_residual() -> None:
    model, data = floating(-1e-4, 5.0, '<site name="back" pos="0 0 -0.01" euler="180 0 0"/>')
    engine = sum(c[0] for c in contact_forces(model, data))
    skin = Skin(model, {"back": bt.Patch.grid(4, 4, 2e-3, **SOFT)}, geoms=["ball"])
    residuals = np.empty((1, 1))
    assert not skin.read(data, **MATCH, residuals=residuals).any()
    assert abs(residuals[0, 0] - engine) < 1e-12 and engine > 0.1
    # Beside a patch that faces the contact, it presses that one alone.
    both = {name: bt.Patch.grid(4, 4, 2e-3, **SOFT) for name in ("back", "top")}
    skin = Skin(model, both, geoms=["ball"])
    read = skin.read(data, output="force", **MATCH)
    assert not skin.frame("back", read).any() and abs(read.sum() - engine) < 1e-6
    with pytest.raises(ValueError, match='match: \'force\'; None or "normal_force"'):
        skin.read(data, match="force")


def test_a_contact_acts_on_the_patch_next_to_it_and_a_curved_fingertip_has_it_from_the_side() -> None:
    left, right = '<site name="left" pos="-0.01 0 0"/>', '<site name="right" pos="0.01 0 0"/>'
    model, data = floating(-5e-4, 5.0, left + right)
    layout = {name: bt.Patch.grid(10, 10, 2e-3, **SOFT) for name in ("left", "right")}
    skin = Skin(model, layout)
    for place, touched in ((-0.012, "left"), (-0.002, "left"), (0.002, "right"), (0.015, "right")):
        data.qpos[0] = place
        mujoco.mj_forward(model, data)
        engine = sum(c[0] for c in contact_forces(model, data))
        read = skin.read(data, output="force", **MATCH)
        assert abs(skin.frame(touched, read).sum() - engine) < 1e-6 and abs(read.sum() - engine) < 1e-6, place

    tip = """
    <mujoco><worldbody>
      <body name="tip"><geom name="tip" type="sphere" size="0.008"/></body>
      <body name="wall" pos="0.0275 0 0.004"><freejoint/><geom name="wall" type="sphere" size="0.02" mass="1"/></body>
    </worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(tip)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    engine = sum(c[0] for c in contact_forces(model, data))
    cap = bt.Patch.sphere_cap(7.5e-3, 1.9, 1.2e-3, 3e-3, stiffness=600.0)
    skin = Skin(model, {"tip": cap})  # on the body
    travels = np.empty((1, 1))
    read = skin.read(data, output="force", **MATCH, travels=travels)
    assert engine > 1 and abs(read.sum() - engine) < 1e-6 and abs(travels[0, 0]) < 3e-3
    strongest = cap.axes[read.argmax()]
    assert strongest @ [0.99, 0, 0.14] > 0.95


def test_matched_forces_of_the_hand_reach_a_user_sensor() -> None:
    names = [f"{finger}_{part}" for finger in ("index", "middle", "ring", "little", "thumb") for part in ("middle", "distal")]
    layout = {name: bt.Patch.grid(8, 8, 1.8e-3, **SOFT) for name in names}
    layout |= {f"palm_{part}": bt.Patch.grid(8, 8, 4e-3, **SOFT) for part in ("index", "little", "thenar", "hypothenar")}
    sensor = f'<sensor><user name="skin" dim="{64 * len(layout)}" needstage="acc"/><user name="early" dim="{64 * len(layout)}" needstage="pos"/></sensor>'
    for geoms in (BALL, BOX):
        model = with_object("five_finger_hand", geoms, others=sensor)
        data = mujoco.MjData(model)
        skin = Skin(model, layout)
        with pytest.raises(ValueError, match="needstage"):
            skin.install("early", **MATCH)
        skin.install("skin", **MATCH)
        try:
            close_hand(model, data)
        finally:
            mujoco.set_mjcb_sensor(None)
        residuals, forces = (np.empty((len(layout), len(skin.bodies))) for _ in range(2))
        read = skin.read(data, output="force", **MATCH, residuals=residuals, pair_forces=forces)
        assert np.array_equal(data.sensordata[: len(read)], read)
        of_object = [name == "object" for name in skin.bodies]
        carriers = {model.body(model.site(name).bodyid[0]).name for name in layout}
        engine = sum(force for body, force in normal_forces(model, data).items() if body in carriers)
        assert abs((forces + residuals)[:, of_object].sum() - engine) < 1e-9
        assert forces.sum() > 0.5 * engine, (forces.sum(), engine)
