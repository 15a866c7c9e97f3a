"""Which geoms touch which patches: the pairs that MuJoCo's collision filters leave, and the kinds of geoms."""

from __future__ import annotations

import bubbletouch as bt
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
from bubbletouch.mujoco import Skin, geom_surface  # noqa: E402

SOFT = dict(stroke=5e-3, stiffness=200.0)

FINGERS = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1" pos="0 0 -0.2"/>
    <body name="hand">
      <joint name="wrist" axis="0 1 0"/><geom name="palm" type="box" size="0.02 0.05 0.01" mass="1"/>
      <body name="proximal" pos="0.05 0 0">
        <joint name="proximal" axis="0 1 0"/><geom name="proximal" type="capsule" size="0.01 0.02" euler="0 90 0" mass="0.1"/>
        <body name="distal" pos="0.03 0 0">
          <joint name="distal" axis="0 1 0"/><geom name="distal" type="capsule" size="0.01 0.02" euler="0 90 0" mass="0.1"/>
          <geom name="nail" type="box" size="0.02 0.02 0.02" contype="0" conaffinity="0" mass="0.01"/>
          <body name="pad"><site name="pad" pos="0 0 0.0095"/></body>
        </body>
      </body>
      <body name="thumb" pos="0.08 0 0.0148" euler="180 0 0">
        <joint name="thumb" axis="1 0 0"/><geom name="thumb" type="box" size="0.02 0.01 0.005" mass="0.1"/><site name="thumb" pos="0 0 0.005"/>
      </body>
    </body>
    <body name="ghost"><freejoint/><geom name="ghost" type="box" size="0.02 0.02 0.02" contype="2" conaffinity="2" mass="0.1"/></body>
    <body name="listed"><freejoint/><geom name="listed" type="sphere" size="0.01" contype="0" conaffinity="0" mass="0.1"/></body>
    <body name="left_out"><freejoint/><geom name="left_out" type="sphere" size="0.01" mass="0.1"/></body>
  </worldbody>
  <contact><pair geom1="listed" geom2="distal"/><exclude body1="left_out" body2="distal"/></contact>
</mujoco>"""


def test_patches_feel_the_geoms_that_mujoco_collides_with_their_body() -> None:
    model = mujoco.MjModel.from_xml_string(FINGERS)
    data = mujoco.MjData(model)
    for name, height in (("ghost", 0.025), ("listed", 0.5), ("left_out", 0.019)):
        data.joint(model.body(name).jntadr[0]).qpos[:3] = [0.08, 0.0, height]
    mujoco.mj_forward(model, data)
    patch = bt.Patch.grid(8, 8, 2e-3, **SOFT)
    # The parent link, the excluded sphere and the box of other contype overlap the pad, and MuJoCo creates no contact with them.
    pad = Skin(model, {"site:pad": patch})
    assert pad.geoms == ["floor", "palm", "thumb", "listed"]
    between = {frozenset(model.geom(geom).name for geom in pair) for pair in data.contact.geom.tolist()}
    assert [pair for pair in between if "distal" in pair] == [{"distal", "thumb"}]
    pair_forces = np.empty((1, len(pad.bodies)))
    pad.read(data, pair_forces=pair_forces)
    assert [pad.bodies[body] for body in np.flatnonzero(pair_forces)] == ["thumb"]
    everything = Skin(model, {"site:pad": patch}, geoms=["proximal", "thumb", "ghost", "left_out"])
    everything.read(data, pair_forces=(all_pairs := np.empty((1, 4))))
    assert (all_pairs > 0).all()
    # Two fingers that carry patches press each other.
    both = Skin(model, {"site:pad": patch, "site:thumb": bt.Patch.grid(8, 8, 2e-3, **SOFT)})
    assert both.geoms == ["floor", "palm", "proximal", "distal", "thumb", "listed", "left_out"]
    pairs = np.empty((2, len(both.bodies)))
    both.read(data, pair_forces=pairs)
    touched = {(p, both.bodies[b]) for p, b in np.argwhere(pairs > 0).tolist()}
    assert touched == {(0, "thumb"), (1, "proximal"), (1, "distal"), (1, "left_out")}
    # The body of the site has no geoms, so contacts of its parent press the patch.
    forces, residuals = np.empty_like(pairs), np.empty_like(pairs)
    both.read(data, match="normal_force", pair_forces=forces, residuals=residuals)
    engine = np.zeros(6)
    total = 0.0
    for number, pair in enumerate(data.contact.geom.tolist()):
        if set(pair) == {model.geom("distal").id, model.geom("thumb").id}:
            mujoco.mj_contactForce(model, data, number, engine)
            total += engine[0]
    assert total > 0 and abs((forces + residuals)[0, both.bodies.index("thumb")] - total) < 1e-9
    # Named geoms press all patches but those of their own body.
    named = Skin(model, {"site:pad": patch, "thumb": patch}, geoms=["distal", "thumb", "proximal"])
    named.read(data, pair_forces=(pairs := np.empty((2, 3))))
    assert (pairs[0, named.bodies.index("distal")], pairs[1, named.bodies.index("thumb")]) == (0.0, 0.0)
    assert pairs[0, named.bodies.index("proximal")] > 0


def test_links_of_a_fixed_robot_press_no_patch_of_each_other_and_fixed_objects_do() -> None:
    model = mujoco.MjModel.from_xml_string("""
    <mujoco><worldbody>
      <geom name="floor" type="plane" size="1 1 1"/>
      <body name="base"><geom name="base" size="0.02"/><body name="head" pos="0 0 0.02"><geom name="head" size="0.02"/><site name="top" pos="0 0 0.02"/></body></body>
      <body name="lamp" pos="0 0 0.06"><geom name="lamp" size="0.022"/></body>
    </worldbody></mujoco>""")
    skin = Skin(model, {"top": bt.Patch.grid(4, 4, 2e-3, **SOFT)})
    assert skin.geoms == ["floor", "lamp"]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert skin.read(data).all()


def test_pairs_that_cannot_touch_are_read_as_if_the_body_were_absent() -> None:
    rng = np.random.default_rng(4)
    patches = [bt.Patch.grid(6, 6, 3e-3, **SOFT), bt.Patch.sphere_cap(0.01, 1.5, 3e-3, **SOFT)]
    bodies = [bt.Mesh.box([0.02, 0.01, 0.03]), bt.SphereUnion(np.zeros((1, 3)), [0.012]), bt.Mesh.ellipsoid([0.01, 0.02, 0.015], 1e-4)]
    turn = rng.normal(size=(5, 4))
    patch_poses = np.tile([0.0, 0, 0, 1, 0, 0, 0], (2, 1))
    body_poses = np.concatenate([rng.uniform(-0.01, 0.01, (3, 3)) + [0, 0, 0.015], turn[:3] / np.linalg.norm(turn[:3], axis=1)[:, None]], axis=1)
    can = np.array([[True, False, True], [False, True, False]])
    skin = bt.Skin(patches, bodies, objects=[0, 0, 1], can_touch=can)
    forces = np.array([[1.5, 0.7], [0.4, 0.2]])
    for options in ({}, {"forces": forces}, {"forces": forces, "directions": np.tile([0.6, 0, 0.8], (2, 2, 1))}, {"shear": 1}):
        states = []
        if "shear" in options:
            states = [skin.shear_state(300.0, 0.5)]
            options = {"shear": states[0]}
        pairs = np.empty((2, 2))
        read = skin.read(patch_poses, body_poses, output="force", pair_forces=pairs, **options)
        for p in range(2):
            kept = np.flatnonzero(can[p])
            objects = sorted({[0, 0, 1][b] for b in kept})
            alone = bt.Skin([patches[p]], [bodies[b] for b in kept], objects=[objects.index([0, 0, 1][b]) for b in kept])
            of_patch = {key: options[key][p : p + 1][:, objects] for key in ("forces", "directions") if key in options}
            if states:
                of_patch["shear"] = alone.shear_state(300.0, 0.5)
            expected = alone.read(patch_poses[p], body_poses[kept], output="force", pair_forces=(of_pairs := np.empty((1, len(objects)))), **of_patch)
            first, last = skin.ranges[p]
            assert np.abs(read[first:last] - expected).max() < 1e-12 and expected.any(), (options, p)
            assert np.abs(pairs[p, objects] - of_pairs).max() < 1e-12
            assert not np.delete(pairs[p], objects).any()
    for wrong, words in ((can.T, r"can_touch: shape \(3, 2\); bool, shape \(2, 3\)"), ([["a"]], "can_touch: dtype")):
        with pytest.raises(ValueError, match=words):
            bt.Skin(patches, bodies, can_touch=wrong)


HILLS = """
<mujoco>
  <asset><hfield name="hills" nrow="9" ncol="7" size="0.06 0.08 0.02 0.01"/></asset>
  <worldbody>
    <geom name="hills" type="hfield" hfield="hills"/>
    <body name="foot" pos="0 0 0.05"><freejoint/><geom type="sphere" size="0.004"/><site name="sole" euler="180 0 0"/></body>
  </worldbody>
</mujoco>"""


def test_a_height_field_presses_as_deep_as_rays_and_contacts_of_mujoco_say() -> None:
    model = mujoco.MjModel.from_xml_string(HILLS)
    rng = np.random.default_rng(6)
    model.hfield_data[:] = rng.uniform(0, 1, model.nhfielddata)
    data = mujoco.MjData(model)
    patch = bt.Patch.grid(12, 12, 4e-3, stroke=0.05, taxel_radius=1e-8)
    skin = Skin(model, {"sole": patch})
    assert skin.geoms == ["hills"]
    foot, geom = model.body("foot").id, np.zeros(1, np.int32)
    n_touched = 0
    for _ in range(20):
        turn = rng.normal(scale=0.2, size=3)
        data.qpos[:3] = [*rng.uniform(-0.03, 0.03, 2), 0.012]
        mujoco.mju_axisAngle2Quat(data.qpos[3:], turn / np.linalg.norm(turn), np.linalg.norm(turn))
        mujoco.mj_forward(model, data)
        read = skin.read(data)
        turned = data.site("sole").xmat.reshape(3, 3)
        for center, deflection in zip(data.site("sole").xpos + patch.centers @ turned.T, read, strict=True):
            # A ray along the axis, from the end of the stroke: it first meets the surface to which the taxel is pushed.
            hit = mujoco.mj_ray(model, data, center - 0.05 * turned[:, 2], turned[:, 2], None, 1, foot, geom)
            expected = 0.05 - hit if 0.0 <= hit < 0.05 else 0.0
            assert abs(deflection - expected) < 1e-7, (hit, deflection)
            n_touched += deflection > 0
    assert n_touched > 500
    # The solid is closed: its volume is the sum of its prisms.
    surface = geom_surface(model, model.geom("hills").id)
    heights = 0.02 * model.hfield_data.reshape(9, 7).astype(float)
    means = (2 * (heights[:-1, :-1] + heights[1:, 1:]) + heights[1:, :-1] + heights[:-1, 1:]) / 6
    assert abs(surface.volume - (means + 0.01).sum() * 0.02 * 0.02) < 1e-12


def test_a_concave_mesh_presses_with_its_surface_or_with_the_hull_of_the_engine() -> None:
    # A block of 40 mm with a notch of 20 mm in its lower side.
    profile = [(-20, 0), (-10, 0), (-10, 20), (10, 20), (10, 0), (20, 0), (20, 40), (-20, 40)]
    corners = [f"{1e-3 * x} {y} {1e-3 * z}" for y in (-0.02, 0.02) for x, z in profile]
    sides = [(k, (k + 1) % 8) for k in range(8)]
    faces = [(a, b, b + 8) for a, b in sides] + [(a, b + 8, a + 8) for a, b in sides]
    front = [(0, 2, 1), (0, 7, 2), (7, 3, 2), (7, 6, 3), (6, 5, 3), (5, 4, 3)]
    faces = [(b, a, c) for a, b, c in faces] + [(a + 8, b + 8, c + 8) for a, b, c in front] + [(a, c, b) for a, b, c in front]
    block = f'<mesh name="block" vertex="{" ".join(corners)}" face="{" ".join(map(str, sum(faces, ())))}"/>'
    text = f"""
    <mujoco><asset>{block}</asset><worldbody>
      <geom name="ball" type="sphere" size="0.008" pos="0 0 -0.008"/><site name="top" pos="0 0 0"/>
      <body name="block"><freejoint/><geom name="block" type="mesh" mesh="block" density="100"/></body>
    </worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    surface, hull = (geom_surface(model, model.geom("block").id, hulls=hulls) for hulls in (False, True))
    assert abs(surface.volume - (1600 - 400) * 40e-9) < 1e-11 and abs(hull.volume - 64e-6) < 1e-11
    data = mujoco.MjData(model)
    data.qpos[2] -= 1e-4
    mujoco.mj_forward(model, data)
    assert data.ncon > 0
    residuals = np.empty((1, 1))
    readings = {}
    for hulls in (False, True):
        skin = Skin(model, {"top": bt.Patch.grid(6, 6, 2e-3, 3e-3, stiffness=1e4)}, geoms=["block"], hulls=hulls)
        readings[hulls] = skin.read(data, output="force")
        skin.read(data, match="normal_force", residuals=residuals)
        assert (abs(residuals[0, 0]) < 1e-6) == hulls, (hulls, residuals)
    assert not readings[False].any() and readings[True].all()
    # MuJoCo keeps no hull of a mesh that does not collide.
    drawn = mujoco.MjModel.from_xml_string(text.replace('density="100"', 'density="100" contype="0" conaffinity="0"'))
    with pytest.raises(ValueError, match="geom block: the model has no convex hull of its mesh"):
        Skin(drawn, {"top": bt.Patch.grid(6, 6, 2e-3, 3e-3)}, geoms=["block"], hulls=True)
