"""Contact forces of MuJoCo on the taxels near their points: sum, moment and centre of pressure of each patch, and what carries a patch."""

from __future__ import annotations

import copy

import bubbletouch as bt
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
from bubbletouch.mujoco import Skin  # noqa: E402
from bubbletouch.mujoco.skin import _contact_forces  # noqa: E402
from hands import full_hand  # noqa: E402

from conftest import refused

SOFT = dict(stroke=4e-3, stiffness=600.0)


def simulated(text: str, n_steps: int = 0) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, n_steps)
    mujoco.mj_forward(model, data)
    return model, data


def engine_wrench(model, data, site: str, geoms: list[str] | None = None, faces: float = -1.0) -> np.ndarray:
    """Returns force and torque of all contacts on the body of a site, or on some geoms of it, in the frame of the site about its origin. Contacts whose normal
    has a smaller cosine than `faces` with the reversed z axis are left out."""
    at, body = model.site(site).id, model.site(site).bodyid[0]
    wrench, local = np.zeros(6), np.zeros(6)
    for number in range(data.ncon):
        mujoco.mj_contactForce(model, data, number, local)
        contact = data.contact[number]
        frame = contact.frame.reshape(3, 3)
        for geom, sign in zip(contact.geom, (-1.0, 1.0), strict=True):
            is_own = model.geom_bodyid[geom] == body if geoms is None else model.geom(geom).name in geoms
            if is_own and -sign * float(frame[0] @ data.site_xmat[at].reshape(3, 3)[:, 2]) >= faces:
                force, torque = sign * local[:3] @ frame, sign * local[3:] @ frame
                wrench[:3] += force
                wrench[3:] += torque + np.cross(contact.pos - data.site_xpos[at], force)
    turn = data.site_xmat[at].reshape(3, 3)
    return np.concatenate([wrench[:3] @ turn, wrench[3:] @ turn])


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
@pytest.mark.parametrize("condim", [1, 3, 4, 6])
def test_the_contact_forces_are_those_of_mj_contact_force(cone: str, condim: int) -> None:
    model, data = simulated(
        f"""<mujoco><option cone="{cone}"/><worldbody>
          <geom type="plane" size="1 1 1" condim="{condim}"/>
          <body pos="0 0 0.03"><freejoint/><geom type="box" size="0.03 0.02 0.031" condim="{condim}" euler="2 1 0"/></body>
          <body pos="0.2 0 0.029"><freejoint/><geom type="sphere" size="0.03" condim="{condim}"/></body>
        </worldbody></mujoco>"""
    )
    data.qvel[:] = np.linspace(-0.3, 0.4, model.nv)
    mujoco.mj_forward(model, data)
    assert data.ncon >= 3
    normal, friction, torque = _contact_forces(model, data)
    local = np.zeros(6)
    for number in range(data.ncon):
        mujoco.mj_contactForce(model, data, number, local)
        frame = data.contact.frame[number].reshape(3, 3)
        assert np.abs(normal[number] + friction[number] - local[:3] @ frame).max() < 1e-12
        assert np.abs(normal[number] - local[0] * frame[0]).max() < 1e-12
        assert np.abs(torque[number] - local[3:] @ frame).max() < 1e-12


def pads(rng: np.random.Generator, word: str, up: float) -> tuple[str, dict[str, bt.Patch]]:
    """Returns several pads of random size and place, each a geom with a site of the same name, and their patches. They face along `up` times z."""
    text, layout = "", {}
    for number in range(int(rng.integers(2, 5))):
        nx, ny = rng.integers(8, 14, 2).tolist()
        pitch = float(rng.uniform(1.5e-3, 3e-3))
        x, y = 0.06 * (number % 2) - 0.03, 0.05 * (number // 2) - 0.025
        size = f"{0.5 * nx * pitch} {0.5 * ny * pitch} 0.01"
        name = f"{word}_{number}"
        text += f'<geom name="{name}" type="box" size="{size}" pos="{x} {y} {-0.01 * up}" mass="0.05"/><site name="{name}" pos="{x} {y} 0" zaxis="0 0 {up}"/>'
        # Pads that no load of the grasp saturates.
        layout[name] = bt.Patch.grid(ny, nx, pitch, stroke=8e-3, stiffness=float(rng.uniform(2e3, 6e3)))
    return text, layout


def things(rng: np.random.Generator) -> list[str]:
    a, b, c = rng.uniform(0.01, 0.03, 3)
    return [
        f'<geom type="sphere" size="{a}"/>',
        f'<geom type="box" size="{a} {b} {c}"/>',
        f'<geom type="capsule" size="{a} {b}"/>',
        f'<geom type="cylinder" size="{a} {b}"/>',
        f'<geom type="ellipsoid" size="{a} {b} {c}"/>',
        f'<geom type="box" size="{a} {b} {c}"/><geom type="sphere" size="{c}" pos="{a} 0 0"/>',
    ]


def test_each_patch_has_the_force_and_the_moment_of_its_contacts_in_random_grasps() -> None:
    rng = np.random.default_rng(61)
    n_loaded = 0
    for _ in range(50):  # 300 grasps
        for geoms in things(rng):
            (below, layout), (above, of_lid) = pads(rng, "palm", 1.0), pads(rng, "lid", -1.0)
            layout |= of_lid
            turn = rng.normal(size=4)
            x, y = rng.uniform(-0.04, 0.04, 2)
            lean = rng.uniform(-0.2, 0.2, 3)
            text = f"""<mujoco><option gravity="{lean[0]} {lean[1]} {-9.81 - lean[2]}"/><worldbody>
              <body name="palm">{below}</body>
              <body name="lid" pos="0 0 0.09"><joint type="slide" axis="0 0 1" damping="2"/>{above}</body>
              <body name="thing" pos="{x} {y} 0.035" quat="{" ".join(map(str, turn))}"><freejoint/>{geoms}</body>
            </worldbody></mujoco>"""
            model, data = simulated(text, int(rng.integers(60, 200)))
            skin = Skin(model, layout)
            wrenches, forces, residuals = np.zeros((len(layout), 6)), np.zeros((skin.n_taxels, 3)), np.zeros((len(layout), len(skin.bodies)))
            read = skin.read(data, output="force", match="contact_force", wrenches=wrenches, taxel_forces=forces, residuals=residuals)
            normal = skin.read(data, output="force", match="normal_force")
            for name, wrench in zip(layout, wrenches, strict=True):
                engine = engine_wrench(model, data, name, [name], faces=0.5)
                patch, own = layout[name], skin.frame(name, read).ravel()
                assert np.abs(wrench[:3] - engine[:3]).max() < 1e-6, (name, wrench, engine)
                assert np.abs(wrench[3:] - engine[3:]).max() < 1e-8, (name, wrench, engine)
                if engine[2] > -1e-6:
                    assert own.sum() < 1e-6
                    continue
                n_loaded += 1
                pressed, friction = own @ patch.centers[:, :2] / own.sum(), forces[skin._slices[name]]
                assert np.abs(friction.sum(axis=0) - engine[:3]).max() < 1e-6
                centre = np.array([-engine[4], engine[3]]) / engine[2]
                # Contacts on the rim, and lateral forces above the taxels, may have their centre outside all taxels.
                half = patch.centers[:, :2].max(axis=0)
                assert np.abs(pressed - np.clip(centre, -half, half)).max() <= 0.5 * patch.pitch
            # The normal forces alone have the same sum, whatever the friction. A contact of two pads acts on both.
            local, total = np.zeros(6), 0.0
            for number in range(data.ncon):
                mujoco.mj_contactForce(model, data, number, local)
                total += local[0] * np.isin(data.contact.geom[number], [model.geom(name).id for name in layout]).sum()
            if np.abs(residuals).max() < 1e-9:
                assert abs(normal.sum() - total) < 1e-6 * max(total, 1.0)
    assert n_loaded > 500


def test_a_bar_on_two_pads_loads_each_as_the_engine_does() -> None:
    model, data = simulated(
        """<mujoco><worldbody>
          <body name="base">
            <geom name="left" type="box" size="0.02 0.02 0.01" pos="-0.1 0 -0.01"/><site name="left" pos="-0.1 0 0"/>
            <geom name="right" type="box" size="0.02 0.02 0.01" pos="0.1 0 -0.01"/><site name="right" pos="0.1 0 0"/>
          </body>
          <body pos="0.07 0 0.0099"><freejoint/><geom type="box" size="0.2 0.01 0.01" mass="0.05"/>
            <geom type="sphere" size="0.01" pos="0 0 0.03" mass="1" contype="0" conaffinity="0"/></body>
        </worldbody></mujoco>""",
        300,
    )
    patch = bt.Patch.grid(20, 20, 2e-3, **SOFT)
    skin = Skin(model, {"left": patch, "right": patch})
    read = skin.read(data, output="force", match="normal_force")
    for side in ("left", "right"):
        engine = engine_wrench(model, data, side, [side])
        assert abs(skin.frame(side, read).sum() + engine[2]) < 1e-6, side
    assert skin.frame("right", read).sum() > 5 * skin.frame("left", read).sum()


@pytest.mark.parametrize("beside", [2e-3, 1e-2, 2.5e-2, 0.4])
def test_a_contact_beside_the_skin_adds_nothing(beside: float) -> None:
    model, data = simulated(
        f"""<mujoco><worldbody>
          <body name="table"><geom type="box" size="1 1 0.02" pos="0 0 -0.02"/><site name="mat"/></body>
          <body pos="{0.016 + beside} 0 0.0199"><freejoint/><geom type="sphere" size="0.02" mass="0.5"/></body>
        </worldbody></mujoco>""",
        200,
    )
    skin = Skin(model, {"mat": bt.Patch.grid(16, 16, 2e-3, **SOFT)})
    residuals = np.zeros((1, 1))
    for match in ("normal_force", "contact_force"):
        assert not skin.read(data, match=match, residuals=residuals).any()
        # The force is named where it is near.
        assert abs(residuals[0, 0] - (4.905 if beside < 0.04 else 0.0)) < 0.01


def test_a_held_object_is_in_balance_for_ten_seconds() -> None:
    text = """<mujoco><option timestep="0.002" cone="elliptic" impratio="100"/><worldbody>
      <body name="left" pos="-0.03 0 0"><joint name="l" type="slide" axis="1 0 0"/><geom name="left" type="box" size="0.01 0.02 0.02" mass="0.1"/>
        <site name="left" pos="0.01 0 0" zaxis="1 0 0"/></body>
      <body name="right" pos="0.03 0 0"><joint name="r" type="slide" axis="-1 0 0"/><geom name="right" type="box" size="0.01 0.02 0.02" mass="0.1"/>
        <site name="right" pos="-0.01 0 0" zaxis="-1 0 0"/></body>
      <body name="thing"><freejoint/><geom type="box" size="0.0201 0.015 0.015" mass="0.1" friction="1"/></body>
    </worldbody><actuator><motor joint="l"/><motor joint="r"/></actuator></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.ctrl[:] = 3.0
    patch = bt.Patch.grid(20, 20, 2e-3, stroke=4e-3, stiffness=600.0)
    skin = Skin(model, {"left": patch, "right": patch})
    wrenches, forces = np.zeros((2, 6)), np.zeros((skin.n_taxels, 3))
    for _ in range(10):
        mujoco.mj_step(model, data, 500)
        mujoco.mj_forward(model, data)
        skin.read(data, match="contact_force", wrenches=wrenches, taxel_forces=forces)
        lifted = 0.0
        for name, wrench in zip(("left", "right"), wrenches, strict=True):
            lifted -= float(data.site(name).xmat.reshape(3, 3)[2] @ wrench[:3])
        # The box pulls the pads down with its weight.
        assert abs(lifted - 0.981) < 0.01 * 0.981
        by_taxels = [forces[part] for part in (slice(0, 400), slice(400, 800))]
        assert np.abs(np.array([part.sum(axis=0) for part in by_taxels]) - wrenches[:, :3]).max() < 1e-12


def test_friction_of_a_box_of_ten_geoms_is_that_of_one_box(box: bt.Mesh) -> None:
    patch = bt.Patch.grid(30, 10, 2e-3, **SOFT)
    parts = [bt.Mesh.box([0.006, 0.03, 0.02]) for _ in range(10)]
    one, ten = bt.Skin([patch], [bt.Mesh.box([0.06, 0.03, 0.02])]), bt.Skin([patch], parts, objects=[0] * 10)
    states = [skin.shear_state(400.0, 0.5) for skin in (one, ten)]
    for step in range(40):
        place = np.array([4e-4 * step - 8e-3, 0.0, 0.009, 1.0, 0.0, 0.0, 0.0])
        places = np.tile(place, (10, 1))
        places[:, 0] += 0.006 * np.arange(10) - 0.027
        wrenches = [np.zeros((1, 6)) for _ in states]
        one.read([0, 0, 0, 1, 0, 0, 0], place, shear=states[0], wrenches=wrenches[0])
        ten.read([0, 0, 0, 1, 0, 0, 0], places, shear=states[1], wrenches=wrenches[1])
        assert abs(wrenches[0][0, 0] - wrenches[1][0, 0]) < 1e-9 * max(1.0, abs(wrenches[0][0, 0]))
    assert abs(wrenches[0][0, 0]) > 1.0


PLATE = """<mujoco><worldbody>{table}
  <body name="ball" pos="0 0 0.0195"><freejoint/><geom name="ball" type="sphere" size="0.02" mass="0.25"/></body>
</worldbody>{more}</mujoco>"""
TABLE = '<body name="table"><geom name="table" type="box" size="0.1 0.1 0.02" pos="0 0 -0.02"/></body>'


def test_bodies_that_are_welded_together_carry_a_patch_and_never_press_it() -> None:
    patch = {"skin": bt.Patch.grid(16, 16, 2e-3, **SOFT)}
    on_world = TABLE + '<site name="skin"/>'
    on_child = TABLE.replace("</body>", '<body name="pad"><site name="skin"/></body></body>')
    moving = '<body name="hand"><joint type="slide" axis="1 0 0" damping="1e6"/><geom type="box" size="0.1 0.1 0.005" pos="0 0 -0.04" mass="1"/>{}</body>'
    solid, bare = '<body name="solid"><geom type="box" size="0.1 0.1 0.02" pos="0 0 -0.02" mass="1"/></body>', '<body name="bare"><site name="skin"/></body>'
    on_sibling = moving.format(solid + bare)
    on_solid_child = moving.format(solid + '<site name="skin"/>')
    for table in (on_world, on_child, on_sibling, on_solid_child):
        model, data = simulated(PLATE.format(table=table, more=""), 300)
        skin = Skin(model, patch)
        assert "ball" in skin.geoms and not {"table", "solid", "hand"} & set(skin.geoms)
        residuals = np.zeros((1, len(skin.bodies)))
        read = skin.read(data, output="force", match="normal_force", residuals=residuals)
        assert abs(read.sum() - 0.25 * 9.81) < 0.01 and np.abs(residuals).max() < 1e-9, table
        # Far from the ball, nothing presses.
        data.qpos[-5] = 1.0
        mujoco.mj_forward(model, data)
        assert not skin.read(data).any(), table


def test_two_models_of_one_structure_have_their_own_skins() -> None:
    sensor = '<sensor><user name="skin" dim="256" needstage="pos"/></sensor>'
    text = PLATE.format(table=TABLE.replace("/></body>", '/><site name="skin"/></body>'), more=sensor)
    models = [mujoco.MjModel.from_xml_string(text) for _ in range(2)]
    assert models[0].signature == models[1].signature
    skins = [Skin(models[0], {"skin": bt.Patch.grid(16, 16, 2e-3, stroke=4e-3, stiffness=stiffness)}) for stiffness in (600.0,)]
    skins.append(Skin(models[1], {"skin": bt.Patch.grid(16, 16, 2e-3, stroke=4e-3, stiffness=300.0)}))
    for skin in skins:
        skin.install("skin")
    try:
        sums = []
        for model in models:
            data = mujoco.MjData(model)
            mujoco.mj_forward(model, data)
            sums.append(data.sensordata.sum())
        assert sums[0] > 0.0 and abs(sums[0] - 2.0 * sums[1]) < 1e-12
        # A copy of a model has the same surfaces. A model of the same structure with another ball has no skin, and a skin refuses its data.
        same, other = copy.copy(models[0]), copy.copy(models[0])
        other.geom_size[other.geom("ball").id, 0] = 0.03
        assert other.signature == models[0].signature
        for model, reads in ((same, True), (other, False)):
            data = mujoco.MjData(model)
            mujoco.mj_forward(model, data)
            assert data.sensordata.any() == reads
        refused("data: of a model with other surfaces", lambda: skins[0].read(data))
        refused("data: no poses yet", lambda: skins[0].read(mujoco.MjData(models[0])))
    finally:
        mujoco.set_mjcb_sensor(None)


def test_shear_springs_are_reset_when_time_runs_backwards() -> None:
    text = PLATE.format(table=TABLE.replace("/></body>", '/><site name="skin"/></body>'), more="")
    model, data = simulated(text)
    skin = Skin(model, {"skin": bt.Patch.grid(16, 16, 2e-3, **SOFT)})
    state, wrenches = skin.shear_state(400.0, 0.5), np.zeros((1, 6))
    for step in range(10):
        data.qpos[0], data.time = 2e-4 * step, 0.1 * step
        mujoco.mj_forward(model, data)
        skin.read(data, shear=state, wrenches=wrenches)
    assert abs(wrenches[0, 0]) > 0.1
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    skin.read(data, shear=state, wrenches=wrenches)
    assert abs(wrenches[0, 0]) < 1e-9
    refused("shear: a state beside friction forces", lambda: skin.read(data, shear=state, match="contact_force"))


def test_what_a_model_hides_is_said() -> None:
    text = PLATE.format(table=TABLE.replace("/></body>", '/><site name="skin"/></body>'), more="")
    model, _ = simulated(text)
    refused(r"model: 'a.xml'; a mujoco.MjModel, such as mujoco.MjModel.from_xml_path", lambda: Skin("a.xml", {"skin": bt.Patch.grid(4, 4, 2e-3, **SOFT)}), TypeError)
    assert Skin(model, {"skin": bt.Patch.grid(4, 4, 2e-3, **SOFT)}, geoms=[1]).geoms == ["ball"]
    # An unnamed geom has the name geom_ID, which is also a carrier of patches.
    unnamed = mujoco.MjModel.from_xml_string(text.replace('<geom name="ball" ', "<geom ").replace('<geom name="table" ', "<geom "))
    patch = {"geom:geom_0": bt.Patch.grid(4, 4, 2e-3, **SOFT)}
    assert Skin(unnamed, patch).geoms == Skin(unnamed, patch, geoms=["geom_1"]).geoms == ["geom_1"]
    refused("geom: 'geom_0'; one of table, ball", lambda: Skin(model, {"skin": bt.Patch.grid(4, 4, 2e-3, **SOFT)}, geoms=["geom_0"]))
    refused("geoms: 7; a name, or a number from 0 to 1", lambda: Skin(model, {"skin": bt.Patch.grid(4, 4, 2e-3, **SOFT)}, geoms=[7]))
    thin = mujoco.MjModel.from_xml_string(text.replace("0.1 0.1 0.02", "0.1 0.1 0.0025").replace("0 0 -0.02", "0 0 -0.0025"))
    with pytest.warns(UserWarning, match="'skin': stroke plus taxel diameter, 6 mm, exceed the pad's thickness, 5 mm, .* at most 3 mm fits"):
        Skin(thin, {"skin": bt.Patch.grid(4, 4, 2e-3, **SOFT)})
    # Pads that are meshes and height fields are as thick as boxes.
    slab = " ".join(map(str, bt.Mesh.box([0.2, 0.2, 0.005]).vertices.ravel().tolist()))
    assets = f'<asset><mesh name="slab" vertex="{slab}"/><hfield name="field" nrow="2" ncol="2" size="0.1 0.1 0.001 0.004" elevation="1 1 1 1"/></asset>'
    for shape in ('type="mesh" mesh="slab" pos="0 0 -0.0025"', 'type="hfield" hfield="field" pos="0 0 -0.001"'):
        table = f'<body><geom name="table" {shape}/><site name="skin"/></body>'
        other = mujoco.MjModel.from_xml_string(PLATE.format(table=table, more="").replace("<worldbody>", assets + "<worldbody>"))
        with pytest.warns(UserWarning, match="exceed the pad's thickness, 5 mm, .* at most 3 mm fits"):
            Skin(other, {"skin": bt.Patch.grid(4, 4, 2e-3, **SOFT)})
    flex = """<flexcomp name="cloth" type="grid" count="4 4 1" spacing="0.01 0.01 0.01" pos="0 0 1" dim="2" mass="0.1"><edge equality="true"/></flexcomp>"""
    with_flex = mujoco.MjModel.from_xml_string(text.replace("</worldbody>", flex + "</worldbody>"))
    with pytest.warns(UserWarning, match="does not feel the 1 flexes"):
        Skin(with_flex, {"skin": bt.Patch.grid(4, 4, 2e-3, **SOFT)})


def test_a_mesh_whose_triangles_point_inwards_is_turned_outwards() -> None:
    cube = bt.Mesh.box([0.04, 0.04, 0.04])
    numbers = " ".join(map(str, cube.vertices.ravel().tolist()))
    inwards = " ".join(map(str, cube.triangles[:, ::-1].ravel().tolist()))
    text = PLATE.format(table=TABLE.replace("/></body>", '/><site name="skin"/></body>'), more="").replace(
        '<geom name="ball" type="sphere" size="0.02" mass="0.25"/>', '<geom name="cube" type="mesh" mesh="cube" mass="0.25"/>'
    )
    asset = f'<asset><mesh name="cube" inertia="shell" vertex="{numbers}" face="{inwards}"/></asset>'
    model, data = simulated(text.replace("<worldbody>", asset + "<worldbody>"))
    data.qpos[2] = 0.018
    mujoco.mj_forward(model, data)
    with pytest.warns(UserWarning, match="geom cube: the triangles of its mesh point inwards"):
        skin = Skin(model, {"skin": bt.Patch.grid(8, 8, 2e-3, **SOFT)})
    assert abs(skin.read(data).max() - 3e-3) < 1e-9  # 2 mm and the radius of a taxel


def test_twenty_patches_share_the_forces_of_a_hand() -> None:
    model, data, skin = full_hand()
    wrenches, residuals = np.zeros((20, 6)), np.zeros((20, len(skin.bodies)))
    skin.read(data, match="contact_force", wrenches=wrenches, residuals=residuals)
    assert np.abs(wrenches).sum() > 0.1
