"""Shear springs with friction between successive reads of a skin, compared with scenes and closed forms."""

from __future__ import annotations

import bubbletouch as bt
import numpy as np

from conftest import refused

UNIT = [1.0, 0.0, 0.0, 0.0]
STIFFNESS, SHEAR, FRICTION = 100.0, 400.0, 0.5
BALL = bt.SphereUnion(np.zeros((1, 3)), [0.03])


def pose(x: float, y: float, z: float) -> np.ndarray:
    return np.array([[x, y, z, *UNIT]])


def test_a_box_drags_the_taxels_until_they_slip(box: bt.Mesh) -> None:
    patch = bt.Patch.grid(6, 8, 2e-3, 5e-3, stiffness=STIFFNESS)
    skin = bt.Skin([patch], [box])
    state = skin.shear_state(SHEAR, FRICTION)
    depth = 1e-3
    normal = STIFFNESS * depth
    reach = FRICTION * normal / SHEAR  # displacement at which a taxel slips
    wrench = np.empty((1, 6))
    for step, x in enumerate(np.linspace(0, 3 * reach, 31)):
        read = skin.read(pose(0, 0, 0), pose(x, 0, 1e-3 - depth), output="force", shear=state, wrenches=wrench)
        assert np.abs(read - normal).max() < 1e-12
        expected = [min(SHEAR * x, FRICTION * normal), 0.0, -normal]
        assert np.abs(state.forces - expected).max() < 1e-12, step
        assert np.abs(wrench[0, :3] - 48 * np.array(expected)).max() < 1e-9
        assert state.slipping.all() == (x > reach * (1 + 1e-9))
    # Out of contact, and back again without the old displacement.
    skin.read(pose(0, 0, 0), pose(0, 0, 0.1), shear=state)
    assert not state.forces.any() and not state.slipping.any()
    skin.read(pose(0, 0, 0), pose(0, 0, 0.0), shear=state)
    assert np.abs(state.forces - [0, 0, -normal]).max() < 1e-12
    skin.read(pose(0, 0, 0), pose(reach / 2, 0, 0.0), shear=state)
    assert state.forces[:, 0].all()
    state.reset()
    assert not state.forces.any()


def test_a_skin_with_shear_reads_what_a_scene_reads() -> None:
    layout = {"grid": {"nx": 12, "ny": 10, "pitch_mm": 2.0}}
    taxel = {"stroke_mm": 5.0, "stiffness_n_per_m": STIFFNESS, "friction": FRICTION, "shear_stiffness_n_per_m": SHEAR}
    simulation = bt.simulate(
        {
            "title": "A ball rolls and slides on a palm",
            "output_hz": 10.0,
            "duration_s": 10.0,
            "patches": [{"name": "palm", "layout": layout, **taxel}],
            "objects": [{"name": "ball", "object": BALL, "at": {"position_mm": [0.0, 0.0, 50.0]}}],
        }
    )
    patch = bt.Patch.grid(10, 12, 2e-3, 5e-3, stiffness=STIFFNESS)
    skin = bt.Skin([patch], [BALL])
    state = skin.shear_state(SHEAR, FRICTION)
    wrench, dragged = np.empty((1, 6)), 0
    for step in range(12):
        turn = 0.01 * step
        ball = np.array([[4e-4 * step, 1e-4 * step, 0.029, np.cos(turn), 0, np.sin(turn), 0]])
        simulation.set_object_pose("ball", ball[0])
        simulation.step(0.1)
        palm = simulation.observe()["patches"]["palm"]
        read = skin.read(pose(0, 0, 0), ball, output="force", shear=state, wrenches=wrench)
        assert np.abs(read - palm["force"].ravel()).max() < 1e-12
        assert np.abs(state.forces - palm["force3"]).max() < 1e-12, step
        assert np.abs(wrench[0] - palm["wrench"]).max() < 1e-12
        dragged += state.slipping.any()
    assert dragged > 3


def test_matched_forces_carry_friction_and_batches_are_their_sets(box: bt.Mesh) -> None:
    layout = [bt.Patch.grid(6, 8, 2e-3, 5e-3, stiffness=STIFFNESS), bt.Patch.disc(8e-3, 2e-3, 4e-3)]
    skin = bt.Skin(layout, [box, BALL])
    both = np.array([[0, 0, 0, *UNIT], [0.1, 0, 0, *UNIT]])
    n, rng = 3, np.random.default_rng(2)
    batch = skin.shear_state(SHEAR, np.full(skin.n_taxels, FRICTION), n=n)
    alone = [skin.shear_state(SHEAR, FRICTION) for _ in range(n)]
    forces = np.array([[2.0, 0.0], [0.0, 0.7]])
    bodies = np.tile([[0, 0, 0, *UNIT], [0.1, 0, 0.03, *UNIT]], (n, 1, 1))
    for _ in range(4):
        bodies[..., :2] += rng.uniform(-2e-4, 2e-4, (n, 2, 2))
        read = skin.read(np.tile(both, (n, 1, 1)), bodies, forces=np.tile(forces, (n, 1, 1)), shear=batch, output="force")
        for number, state in enumerate(alone):
            one = skin.read(both, bodies[number], forces=forces, shear=state, output="force")
            assert np.array_equal(one, read[number])
            assert np.array_equal(state.forces, batch.forces[number])
            assert np.array_equal(state.slipping, batch.slipping[number])
            assert abs(one[:48].sum() - 2.0) < 1e-9 and abs(one[48:].sum() - 0.7) < 1e-9
            lateral = np.hypot(*state.forces[:48, :2].T)
            assert (lateral <= FRICTION * one[:48] * (1 + 1e-12)).all()
    assert lateral.any()
    batch.reset([1])
    assert not batch.forces[1].any() and batch.forces[0].any()
    refused("sets: 3; 0 to 2", lambda: batch.reset([3]))
    refused("shear: n = 3; a state of one set", lambda: skin.read(both, bodies[0], shear=batch))
    refused("shear: a state of another skin", lambda: bt.Skin(layout[:1], [box]).read(both[:1], bodies[0, :1], shear=alone[0]))
    refused("shear stiffness", lambda: skin.shear_state(0.0, 0.5))
