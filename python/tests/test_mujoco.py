"""Skin in MuJoCo's loop: what its taxels read is what the geometry at MuJoCo's poses gives."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import bubbletouch as bt

mujoco = pytest.importorskip("mujoco")
from bubbletouch.mujoco import Skin, geom_surface  # noqa: E402

from conftest import refused

MODEL = """
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <body name="palm" pos="0 0 0.1">
      <geom name="plate" type="box" size="0.04 0.04 0.005" pos="0 0 -0.008"/>
      <site name="palm" pos="0 0 0"/>
      <site name="edge" pos="0.2 0 0" euler="0 90 0"/>
    </body>
    <body name="ball" pos="0 0 0.128"><freejoint/><geom name="ball" type="sphere" size="0.03" mass="0.1"/></body>
    <body name="block" pos="0.26 0 0.1"><freejoint/><geom name="block" type="box" size="0.05 0.02 0.01" mass="0.1"/></body>
    <body name="rod" pos="0.6 0 0.1"><geom name="rod" type="capsule" size="0.01 0.03"/></body>
    <body name="can" pos="0.8 0 0.1"><geom name="can" type="cylinder" size="0.02 0.03"/></body>
    <body name="egg" pos="1 0 0.1"><geom name="egg" type="ellipsoid" size="0.02 0.03 0.01"/></body>
    <geom name="decal" type="sphere" size="0.5" contype="0" conaffinity="0"/>
  </worldbody>
  <sensor><user name="skin" dim="128" needstage="pos"/></sensor>
</mujoco>
"""


@pytest.fixture(scope="module")
def model():
    return mujoco.MjModel.from_xml_string(MODEL)


def patches() -> dict[str, bt.Patch]:
    return {name: bt.Patch.grid(8, 8, pitch=4e-3, stroke=5e-3, stiffness=200.0) for name in ("palm", "edge")}


def placed(model, **moves):
    data = mujoco.MjData(model)
    for name, pose in moves.items():
        start = model.jnt_qposadr[model.body_jntadr[model.body(name).id]]
        data.qpos[start : start + 7] = pose
    mujoco.mj_forward(model, data)
    return data


def test_readings_are_those_of_each_body_alone_and_the_larger_where_both_touch(model) -> None:
    layout = patches()
    skin = Skin(model, layout, geoms=["ball", "block"])
    data = placed(model, ball=[0.003, 0.001, 0.13, 1, 0, 0, 0], block=[0.008, 0, 0.1115, 0.8, 0, 0, 0.6])
    read = skin.read(data)
    assert read.shape == (128,)
    palm = skin.frame("palm", read)
    assert palm.shape == (8, 8) and not skin.frame("edge", read).any()
    site = data.site("palm")
    expected = np.zeros((8, 8))
    for name in ("ball", "block"):
        geom = data.geom(name)
        pose = np.eye(4)
        pose[:3, :3] = site.xmat.reshape(3, 3).T @ geom.xmat.reshape(3, 3)
        pose[:3, 3] = site.xmat.reshape(3, 3).T @ (geom.xpos - site.xpos)
        alone = layout["palm"].press(geom_surface(model, model.geom(name).id), pose)
        assert alone.any(), name
        expected = np.maximum(expected, alone)
    assert np.abs(palm - expected).max() < 1e-12


def test_deflections_of_a_sphere_and_a_box_are_their_closed_forms(model) -> None:
    skin = Skin(model, patches(), geoms=["ball", "block"])
    data = placed(model, ball=[0.0, 0.0, 0.1302, 1, 0, 0, 0])
    centers = patches()["palm"].centers
    height = 0.0302  # of the ball's centre above the taxels' centres
    reach = 0.03 + 2e-3
    across = np.hypot(centers[:, 0], centers[:, 1])
    closed = np.clip(np.sqrt(np.maximum(reach**2 - across**2, 0.0)) - height, 0.0, 5e-3)
    closed[across >= reach] = 0.0
    assert np.abs(skin.read(data)[:64] - closed).max() < 1e-12
    data = placed(model, ball=[0.5, 0, 0.5, 1, 0, 0, 0], block=[0.0, 0.0, 0.111, 1, 0, 0, 0])
    palm = skin.frame("palm", skin.read(data))
    assert np.abs(palm - 1e-3).max() < 1e-12  # taxel radius 2 mm, face 1 mm above the centres


def test_forces_wrenches_and_out(model) -> None:
    skin = Skin(model, patches())
    assert skin.geoms == ["floor", "ball", "block", "rod", "can", "egg"]
    data = placed(model, ball=[0.004, 0.002, 0.13, 1, 0, 0, 0])
    out, wrenches = np.empty(128), np.empty((2, 6))
    forces = skin.read(data, output="force", out=out, wrenches=wrenches)
    assert forces is out
    assert np.array_equal(forces, 200.0 * skin.read(data))
    centers = patches()["palm"].centers
    on_patch = -forces[:64, None] * np.array([0.0, 0.0, 1.0])
    assert np.abs(wrenches[0, :3] - on_patch.sum(axis=0)).max() < 1e-12
    assert np.abs(wrenches[0, 3:] - np.cross(centers, on_patch).sum(axis=0)).max() < 1e-12
    assert not wrenches[1].any()


def test_a_batch_of_poses_is_its_poses_one_by_one(model) -> None:
    layout = list(patches().values())
    skin = bt.Skin(layout, [bt.SphereUnion(np.zeros((1, 3)), [0.03])])
    rng = np.random.default_rng(0)
    unit = np.array([1.0, 0, 0, 0])
    patch_poses = np.tile(np.concatenate([[0.0, 0, 0], unit]), (5, 2, 1))
    patch_poses[:, 1, 0] = 0.02
    body_poses = np.tile(np.concatenate([[0.0, 0, 0.03], unit]), (5, 1, 1))
    body_poses[:, 0, :2] = rng.uniform(-0.01, 0.01, (5, 2))
    batch = skin.read(patch_poses, body_poses)
    assert batch.shape == (5, 128)
    for number in range(5):
        one = skin.read(patch_poses[number], (body_poses[number, :, :3], body_poses[number, :, 3:]))
        assert np.array_equal(one, batch[number])
    matrices = np.tile(np.eye(3), (5, 1, 1, 1))
    assert np.array_equal(skin.read(patch_poses, (body_poses[..., :3], matrices)), batch)
    sheared = matrices + 0.0
    sheared[..., 0, 1] = 0.5  # of determinant one, and no rotation
    refused(r"body_poses\[0, 0\]: position .*; a finite position, and a right-handed rotation matrix", lambda: skin.read(patch_poses, (body_poses[..., :3], sheared)))
    for poses, wanted in [
        (body_poses[:, :, :6], "shape"),
        (np.zeros((5, 2, 7)), "k = 1 poses"),
        (np.zeros((5, 1, 7)), r"body_poses\[0, 0\]: \[0, 0, .*a quaternion"),
        (body_poses[:3], "5 sets of patch_poses, 3 of body_poses"),
    ]:
        refused(wanted, lambda: skin.read(patch_poses, poses))


def test_facets_of_round_geoms_are_within_the_tolerance(model) -> None:
    for name in ("rod", "can", "egg"):
        mesh = geom_surface(model, model.geom(name).id, 1e-5)
        size = model.geom(name).size
        corners = np.array(mesh.vertices)[np.array(mesh.triangles)]
        middles = corners.mean(axis=1)
        if name == "egg":
            # To first order: (|x / size| − 1) divided by the gradient.
            scaled = middles / size
            length = np.linalg.norm(scaled, axis=1)
            off = (length - 1) * length / np.linalg.norm(scaled / size, axis=1)
        elif name == "rod":
            along = np.clip(middles[:, 2], -size[1], size[1])
            off = np.linalg.norm(middles - along[:, None] * [0, 0, 1], axis=1) - size[0]
        else:
            side = np.hypot(middles[:, 0], middles[:, 1]) - size[0]
            off = np.where(np.abs(np.abs(middles[:, 2]) - size[1]) < 1e-12, 0.0, side)
        assert np.abs(off).max() < 2e-5, name


def test_a_user_sensor_holds_the_readings_at_every_step(model) -> None:
    skin = Skin(model, patches())
    skin.install("skin")
    try:
        data = placed(model, ball=[0.002, 0, 0.1305, 1, 0, 0, 0])
        assert np.array_equal(data.sensordata, skin.read(data, output="force")) and data.sensordata.any()
        before = data.sensordata.copy()
        for _ in range(20):
            mujoco.mj_step(model, data)
        assert not np.array_equal(data.sensordata, before)
    finally:
        mujoco.set_mjcb_sensor(None)
    refused("dim 64", lambda: Skin(model, {"palm": patches()["palm"]}).install("skin"))


def test_skins_of_several_sensors_and_models_share_the_callback(model) -> None:
    # MuJoCo compiles no model with a <user> sensor while a callback in Python is set.
    text = MODEL.replace("<sensor>", '<sensor><user name="left" dim="16" needstage="pos"/><user name="right" dim="9" needstage="pos"/>')
    other, again = (mujoco.MjModel.from_xml_string(text) for _ in range(2))
    bare = mujoco.MjModel.from_xml_string('<mujoco><worldbody/><sensor><user name="s" dim="128" needstage="pos"/></sensor></mujoco>')
    calls = []
    mujoco.set_mjcb_sensor(lambda model, data, stage: calls.append(stage))
    try:
        left = Skin(other, {"palm": bt.Patch.grid(4, 4, 4e-3, 5e-3)})
        right = Skin(other, {"palm": bt.Patch.grid(3, 3, 4e-3, 5e-3)})
        first = Skin(model, patches())
        left.install("left", output="deflection")
        right.install("right")
        first.install("skin")
        for of, skins in ((other, {"left": left, "right": right}), (again, {"left": left, "right": right}), (model, {"skin": first})):
            data = placed(of, ball=[0.002, 0, 0.1305, 1, 0, 0, 0])
            for name, skin in skins.items():
                read = skin.read(data, output="deflection" if name == "left" else "force")
                assert np.array_equal(data.sensor(name).data, read) and read.any(), name
        assert calls
        # A model without skins, with as many sensor values.
        mujoco.mj_forward(bare, mujoco.MjData(bare))
        mujoco.set_mjcb_sensor(None)
        left.install("left")
        data = placed(other, ball=[0.002, 0, 0.1305, 1, 0, 0, 0])
        assert data.sensor("left").data.any() and not data.sensor("right").data.any()
    finally:
        mujoco.set_mjcb_sensor(None)


def test_taxels_are_drawn_where_they_are(model) -> None:
    skin = Skin(model, patches())
    data = placed(model, ball=[0.002, 0, 0.1305, 1, 0, 0, 0])
    scene = mujoco.MjvScene(model, maxgeom=100)
    skin.draw(scene, data, skin.read(data, output="force"))
    assert scene.ngeom == 100
    first = scene.geoms[0]
    assert np.allclose(first.pos, data.site("palm").xpos + patches()["palm"].centers[0], atol=1e-6)


PICTURE = """
import mujoco, numpy as np
from test_mujoco import MODEL, Skin, patches, placed
model = mujoco.MjModel.from_xml_string(MODEL)
model.geom_rgba[model.geom("ball").id, 3] = model.geom_rgba[model.geom("decal").id, 3] = 0.0
skin = Skin(model, patches())
camera = mujoco.MjvCamera()
camera.lookat[:], camera.distance, camera.elevation, camera.azimuth = [0, 0, 0.1], 0.15, -89, 90
with mujoco.Renderer(model, 120, 160) as renderer:
    for height in (0.1305, 0.2):
        data = placed(model, ball=[0.004, 0, height, 1, 0, 0, 0])
        renderer.update_scene(data, camera)
        skin.draw(renderer.scene, data, skin.read(data, output="force"), largest=0.3)
        picture = renderer.render().astype(int)
        red = np.argwhere(picture[..., 0] > 2 * picture[..., 1:].max(axis=-1) + 20)
        print(len(red), *(red.mean(axis=0) if len(red) else ()))
"""


def test_a_picture_shows_pressed_taxels_in_red() -> None:
    environment = os.environ | {"MUJOCO_GL": "egl", "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    done = subprocess.run([sys.executable, "-c", PICTURE], env=environment, capture_output=True, text=True)
    if done.returncode and re.search("EGL|OpenGL|egl", done.stderr):
        pytest.skip("no display without a screen (EGL)")
    assert done.returncode == 0, done.stderr
    pressed, free = done.stdout.splitlines()
    n, row, column = map(float, pressed.split())
    assert n > 50 and abs(row - 60) < 10 and 80 < column < 100 and free == "0"


def test_names_that_are_not_there_are_refused(model) -> None:
    refused(r"layout: 'hand'; a site \(palm, edge\), a body \(world, palm, ball", lambda: Skin(model, {"hand": patches()["palm"]}))
    refused("geom: 'cup'; one of floor", lambda: Skin(model, patches(), geoms=["cup"]))
    refused("geom: 'foot'; one of floor", lambda: Skin(model, {"geom:foot": patches()["palm"]}))
    refused("geoms: none on another body than the patches; at least one that can touch the skin$", lambda: Skin(model, {"palm": patches()["palm"]}, geoms=["plate"]))
    refused("layout: {}; a dict with at least one Patch", lambda: Skin(model, {}))
    refused(r"layout: \['palm'\]; a dict with at least one Patch", lambda: Skin(model, ["palm"]))
    for layout, words in (({"palm": 3}, "layout: 'palm' with int; a name with a Patch"), ({3: patches()["palm"]}, "layout: 3 with Patch; a name")):
        refused(words, lambda: Skin(model, layout), TypeError)
    ghost = mujoco.MjModel.from_xml_string("""
    <mujoco><worldbody><geom name="floor" type="plane" size="1 1 1" conaffinity="0"/>
      <body><freejoint/><geom size="0.1" contype="0"/><site name="palm"/></body></worldbody></mujoco>""")
    Skin(ghost, {"palm": patches()["palm"]})
    ghost.geom_contype[0] = 0
    refused(r"geoms: MuJoCo's collision filter leaves none; .*contype.*; names of geoms press without the filter", lambda: Skin(ghost, {"palm": patches()["palm"]}))
    assert Skin(ghost, {"palm": patches()["palm"]}, geoms=["floor"]).geoms == ["floor"]


def test_a_floor_presses_a_foot_from_below_alone() -> None:
    tilt = 0.1
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco><worldbody>
      <geom name="floor" type="plane" size="0 0 1" pos="0 0 0.3" euler="{np.rad2deg(tilt)} 0 0"/>
      <body name="foot" pos="7 0 0.32"><freejoint/><geom name="ankle" type="capsule" size="0.02 0.03" pos="0 0 0.021" euler="0 90 0"/>
        <site name="sole" euler="180 0 0"/><site name="instep" pos="0 0 0.04"/></body>
    </worldbody></mujoco>""")
    data = mujoco.MjData(model)
    data.qpos[3:7] = [np.cos(tilt / 2), np.sin(tilt / 2), 0, 0]
    flat = bt.Patch.grid(6, 6, 2e-3, 5e-3)
    around = bt.Patch.draped(geom_surface(model, model.geom("ankle").id), 6e-3, 5e-3)
    skin = Skin(model, {"sole": flat, "site:instep": flat, "geom:ankle": around})
    assert skin.geoms == ["floor"]
    up = np.array([0.0, -np.sin(tilt), np.cos(tilt)])
    for height in (2e-3 - 1e-4, 2e-3 + 1e-4, -2e-3):
        data.qpos[:3] = np.array([7.0, 0.0, 0.3]) + height * up
        mujoco.mj_kinematics(model, data)
        read = skin.read(data)
        # The sole faces the floor in parallel: taxel radius 1 mm.
        assert np.abs(skin.frame("sole", read) - np.clip(1e-3 - height, 0, 5e-3)).max() < 1e-12
        assert not skin.frame("site:instep", read).any()
        rotation = data.geom("ankle").xmat.reshape(3, 3)
        height_of = ((around.centers @ rotation.T + data.geom("ankle").xpos) - [0, 0, 0.3]) @ up
        ankle = skin.frame("geom:ankle", read)
        facing = (around.axes @ rotation.T) @ up
        closed = np.where(facing < -0.5, np.clip((3e-3 - height_of) / -facing, 0, 5e-3), 0.0)
        assert np.abs(ankle - closed)[facing < -0.5].max() < 1e-12 and not ankle[facing > 0].any()
        assert ankle.any() or height > 0


def test_deflections_are_those_of_mujocos_signed_distance(model) -> None:
    """Pushed along its axis by its deflection, a taxel's sphere touches the geoms: MuJoCo's distance of the sphere is zero."""
    xml = """
    <mujoco><worldbody>
      <geom name="taxel" type="sphere" size="0.0015"/>
      <body name="body"><freejoint/>
        <geom name="ball" type="sphere" size="0.012"/>
        <geom name="block" type="box" size="0.014 0.01 0.006"/>
        <geom name="rod" type="capsule" size="0.006 0.013"/>
      </body>
    </worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    patch = bt.Patch.grid(12, 12, pitch=3e-3, stroke=8e-3, taxel_radius=1.5e-3)
    taxel = model.geom("taxel").id
    rng = np.random.default_rng(3)
    n_touched = 0
    for name in ("ball", "block", "rod"):
        geom = model.geom(name).id
        surface = geom_surface(model, geom)
        for _ in range(40):
            turn = rng.normal(size=4)
            data.qpos[:3] = rng.uniform(-0.01, 0.01, 3) + [0, 0, 0.012]
            data.qpos[3:7] = turn / np.linalg.norm(turn)
            mujoco.mj_kinematics(model, data)
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom]
            pushed = patch.press(surface, pose).reshape(-1)
            for center, deflection in zip(patch.centers, pushed, strict=True):
                data.geom_xpos[taxel] = center - [0, 0, deflection]
                distance = mujoco.mj_geomDistance(model, data, taxel, geom, 1.0, None)
                if deflection == 0.0:
                    assert distance > -1e-9, name
                elif deflection < 8e-3:
                    assert abs(distance) < 1e-9, name
                    n_touched += 1
    assert n_touched > 1000


def test_shear_forces_in_the_loop_and_the_short_name(model) -> None:
    assert bt.mujoco.Skin is Skin
    with pytest.raises(AttributeError, match="no attribute 'gazebo'"):
        _ = bt.gazebo
    skin = Skin(model, patches(), geoms=["ball"])
    state = skin.shear_state(400.0, 0.5)
    wrenches, counts = np.empty((2, 6)), np.empty((2, 2), np.int64)
    for step in range(5):
        data = placed(model, ball=[1e-4 * step, 0, 0.13, 1, 0, 0, 0])
        forces = skin.read(data, output="force", shear=state, wrenches=wrenches, contacts=counts)
    assert forces.any() and np.array_equal(-state.forces[:64, 2], forces[:64])
    assert 0 < wrenches[0, 0] <= 0.5 * forces.sum() and np.abs(wrenches[0, :3] - state.forces[:64].sum(axis=0)).max() < 1e-12
    assert counts[0, 0] == np.count_nonzero(forces) and not counts[1].any()


def test_threads_read_one_skin_at_the_same_time(model) -> None:
    skin = Skin(model, patches())
    rng = np.random.default_rng(3)
    datas = [placed(model, ball=[*rng.uniform(-0.01, 0.01, 2), 0.13, 1, 0, 0, 0]) for _ in range(4)]
    expected = [skin.read(data) for data in datas]
    with ThreadPoolExecutor(4) as pool:
        # A read that holds the interpreter's lock while it waits for another read would never end.
        work = [pool.submit(skin.read, datas[number % 4]) for number in range(2000)]
        for number, one in enumerate(work):
            assert np.array_equal(one.result(timeout=60), expected[number % 4])
