"""Robots of URDF and MJCF files: poses of links equal those of MuJoCo, on our robots and on random trees of bodies."""

from __future__ import annotations

import math
import re
from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest

from conftest import refused

mujoco = pytest.importorskip("mujoco")
ROBOTS = Path(__file__).resolve().parents[2] / "objects" / "robots"
TOLERANCE = 1e-12


def rotation(pose: np.ndarray) -> np.ndarray:
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, pose[3:])
    return matrix


def quaternion(roll: float, pitch: float, yaw: float) -> np.ndarray:
    turn = np.array([1.0, 0.0, 0.0, 0.0])
    for axis, angle in (([0, 0, 1], yaw), ([0, 1, 0], pitch), ([1, 0, 0], roll)):
        one, product = np.zeros(4), np.zeros(4)
        mujoco.mju_axisAngle2Quat(one, np.array(axis, float), angle)
        mujoco.mju_mulQuat(product, turn, one)
        turn = product
    return turn


def name_of(model, kind, index: int) -> str | None:
    return mujoco.mj_id2name(model, kind, index)


def random_positions(model, data, rng) -> dict[str, float]:
    """Sets random joint positions in MuJoCo's data, and returns them by the names of our joints."""
    q = {}
    for joint in range(model.njnt):
        name = name_of(model, mujoco.mjtObj.mjOBJ_JOINT, joint)
        at, kind = model.jnt_qposadr[joint], model.jnt_type[joint]
        values = rng.uniform(-1.4, 1.4, 6)
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            data.qpos[at : at + 7] = [*values[:3], *quaternion(*values[3:])]
            q |= {f"{name}.{key}": v for key, v in zip(("x", "y", "z", "roll", "pitch", "yaw"), values, strict=True)}
        elif kind == mujoco.mjtJoint.mjJNT_BALL:
            data.qpos[at : at + 4] = quaternion(*values[:3])
            q |= {f"{name}.{key}": v for key, v in zip(("roll", "pitch", "yaw"), values[:3], strict=True)}
        else:
            data.qpos[at] = q[name] = values[0]
    return q


def largest_difference(model, data, robot: bt.Robot, q: dict[str, float] | None) -> float:
    """Returns the largest difference of positions and rotation matrices of all bodies and sites, after mj_kinematics."""
    mujoco.mj_kinematics(model, data)
    places = [(mujoco.mjtObj.mjOBJ_BODY, model.nbody, data.xpos, data.xmat)]
    places += [(mujoco.mjtObj.mjOBJ_SITE, model.nsite, data.site_xpos, data.site_xmat)]
    worst = 0.0
    for kind, n, positions, matrices in places:
        for index in range(n):
            name = name_of(model, kind, index)
            if name == "world":
                continue
            if kind == mujoco.mjtObj.mjOBJ_SITE and f"{name}_site" in robot.links:
                name = f"{name}_site"
            pose = robot.pose(name, q)
            worst = max(worst, np.abs(pose[:3] - positions[index]).max())
            worst = max(worst, np.abs(rotation(pose) - matrices[index]).max())
    return worst


@pytest.mark.parametrize("file", sorted(ROBOTS.glob("*.*")), ids=lambda file: file.name)
def test_poses_equal_mujocos_on_our_robots(file: Path) -> None:
    robot = bt.Robot.read(file)
    text = file.read_text(encoding="utf-8")
    if file.suffix == ".urdf":
        # Without the extension, MuJoCo merges links without joints.
        settings = '<mujoco><compiler fusestatic="false" boundmass="1e-3" boundinertia="1e-6"/></mujoco>'
        text = text.replace("</robot>", settings + "</robot>")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    own = {joint.name for joint in robot.joints}
    assert len(own) > 0
    rng = np.random.default_rng(3)
    for _ in range(5):
        q = {name: value for name, value in random_positions(model, data, rng).items() if name in own}
        for constraint in range(model.neq):
            if model.eq_type[constraint] == mujoco.mjtEq.mjEQ_JOINT:
                first, second = model.eq_obj1id[constraint], model.eq_obj2id[constraint]
                offset, factor = model.eq_data[constraint][:2]
                at, of = model.jnt_qposadr[first], model.jnt_qposadr[second]
                data.qpos[at] = model.qpos0[at] + offset + factor * (data.qpos[of] - model.qpos0[of])
        assert largest_difference(model, data, robot, q) < TOLERANCE


class Tree:
    """Random MJCF model: nested default classes, all orientations, fromto, frames, copies, several joints a body, and reference positions."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.n = 0
        self.is_degree = bool(self.rng.integers(2))
        sequence = "".join(self.rng.permutation(list("xyz")))
        sequence = "".join(c.upper() if self.rng.integers(2) else c for c in sequence)
        angle = "" if self.is_degree and self.rng.integers(2) else f'angle="{"degree" if self.is_degree else "radian"}"'
        bodies = "".join(self.body(depth=0) for _ in range(3))
        self.text = f"""<mujoco model="tree">
          <compiler {angle} eulerseq="{sequence}" autolimits="true"/>
          <default>
            <joint axis="{self.vector()}" pos="{self.vector(0.1)}"/>
            <site type="capsule" size="0.01 0.02" {self.orientation()}/>
            <default class="slides"><joint type="slide" ref="{self.rng.uniform(-1, 1)}"/>
              <default class="far"><joint axis="{self.vector()}" range="-1 1"/><site pos="{self.vector()}"/></default>
            </default>
            <default class="turned"><site {self.orientation()}/><joint ref="{self.rng.uniform(-1, 1)}"/></default>
          </default>
          <worldbody>{bodies}</worldbody>
        </mujoco>"""

    def name(self, kind: str) -> str:
        self.n += 1
        return f'name="{kind}{self.n}"'

    def vector(self, size: float = 1.0) -> str:
        return " ".join(repr(float(x)) for x in self.rng.normal(0, size, 3))

    def angle(self) -> float:
        return float(self.rng.uniform(-3, 3)) * (180 / math.pi if self.is_degree else 1)

    def orientation(self) -> str:
        some = [
            "",
            f'quat="{self.vector()} {self.rng.normal()}"',
            f'euler="{self.angle()} {self.angle()} {self.angle()}"',
            f'axisangle="{self.vector()} {self.angle()}"',
            f'xyaxes="{self.vector()} {self.vector()}"',
            f'zaxis="{self.vector()}"',
        ]
        return some[self.rng.integers(len(some))]

    def chosen_class(self, attribute: str = "class") -> str:
        some = ["", "", f'{attribute}="slides"', f'{attribute}="far"', f'{attribute}="turned"']
        return some[self.rng.integers(len(some))]

    def joint(self) -> str:
        extra = ["", "", f'type="hinge" ref="{self.angle()}"', f'axis="{self.vector()}" range="0 0.5"']
        return f'<joint {self.name("j")} {self.chosen_class()} {extra[self.rng.integers(len(extra))]}/>'

    def site(self) -> str:
        if self.rng.integers(3) == 0:
            # A class with a position would contradict fromto.
            return f'<site {self.name("s")} class="slides" size="0.01" fromto="{self.vector()} {self.vector()}"/>'
        return f'<site {self.name("s")} {self.chosen_class()} {self.orientation()}/>'

    def frame(self, inside: str) -> str:
        return f'<frame pos="{self.vector()}" {self.orientation()} {self.chosen_class("childclass")}>{inside}</frame>'

    def copies(self, inside: str) -> str:
        angles = f"{self.angle()} {self.angle()} {self.angle()}"
        return f'<replicate count="11" sep="-" euler="{angles}" offset="{self.vector()}">{inside}</replicate>'

    def body(self, depth: int) -> str:
        if depth == 0 and self.rng.integers(3) == 0:
            joints = f'<freejoint {self.name("j")}/>'
        else:
            joints = "".join(self.joint() for _ in range(self.rng.integers(4)))
            # No joint that turns the body may follow a ball joint.
            joints += f'<joint {self.name("j")} type="ball" range="0 1"/>' if self.rng.integers(3) == 0 else ""
            joints = self.frame(joints) if self.rng.integers(4) == 0 else joints
        inside = self.site() + self.site()
        inside += "".join(self.body(depth + 1) for _ in range(self.rng.integers(3) if depth < 3 else 0))
        if self.rng.integers(3) == 0:
            inside = self.frame(inside + self.site())
        elif self.rng.integers(6) == 0:
            inside += self.copies(self.site() + f'<body {self.name("b")} pos="{self.vector()}">{self.joint()}<geom size="0.1"/></body>')
        attributes = f'{self.name("b")} pos="{self.vector()}" {self.orientation()} {self.chosen_class("childclass")}'
        return f'<body {attributes}>{joints}<geom size="0.1"/>{inside}</body>'


@pytest.mark.parametrize("seed", range(40))
def test_poses_equal_mujocos_on_random_trees(seed: int, tmp_path: Path) -> None:
    text = Tree(seed).text
    file = tmp_path / "tree.xml"
    file.write_text(text, encoding="utf-8")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    robot = bt.Robot.read(file)
    assert robot.links[: model.nbody] == [name_of(model, mujoco.mjtObj.mjOBJ_BODY, i) for i in range(model.nbody)]
    assert largest_difference(model, data, robot, None) < TOLERANCE, "defaults"
    rng = np.random.default_rng(seed)
    for _ in range(2):
        q = random_positions(model, data, rng)
        assert set(q) == {joint.name for joint in robot.joints}
        assert largest_difference(model, data, robot, q) < TOLERANCE


def test_ranges_and_defaults_are_mujocos(tmp_path: Path) -> None:
    for seed in range(8):
        text = Tree(seed).text
        (tmp_path / "tree.xml").write_text(text, encoding="utf-8")
        model = mujoco.MjModel.from_xml_string(text)
        joints = {joint.name: joint for joint in bt.Robot.read(tmp_path / "tree.xml").joints}
        for index in range(model.njnt):
            kind = model.jnt_type[index]
            if kind not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
                continue
            joint = joints[name_of(model, mujoco.mjtObj.mjOBJ_JOINT, index)]
            assert joint.default == pytest.approx(model.qpos0[model.jnt_qposadr[index]], abs=1e-15)
            limited = model.jnt_limited[index]
            assert joint.range == pytest.approx(model.jnt_range[index] if limited else (-math.inf, math.inf), abs=1e-15)
            hinge = "revolute" if limited else "continuous"
            assert joint.kind == (hinge if kind == mujoco.mjtJoint.mjJNT_HINGE else "prismatic")


CORNER = """v 0 0 0
v 0.1 0 0
v 0 0.2 0
v 0 0 0.3
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
"""


@pytest.mark.parametrize("scale", ["1 1 1", "2 0.5 3", "-1 1 1", "-2 -1 -0.5"])
def test_meshes_of_geoms_lie_where_mujocos_do(tmp_path: Path, scale: str) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "corner.obj").write_text(CORNER, encoding="utf-8")
    (tmp_path / "m.xml").write_text(
        f"""<mujoco><compiler meshdir="meshes"/>
        <default><mesh scale="{scale}"/></default>
        <asset><mesh file="corner.obj" refpos="0.01 0.02 -0.03" refquat="1 0.2 -0.3 0.4"/></asset>
        <worldbody><body name="b"><freejoint/><geom type="mesh" mesh="corner" pos="0.1 -0.2 0.3" euler="10 20 30"/></body></worldbody></mujoco>""",
        encoding="utf-8",
    )
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "m.xml"))
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.geom_quat[0])
    theirs = model.mesh_vert @ turn.reshape(3, 3).T + model.geom_pos[0]
    ours = bt.Robot.read(tmp_path / "m.xml").mesh("b", shapes="collision")
    distances = np.linalg.norm(ours.vertices[:, None] - theirs[None], axis=2)
    assert distances.shape == (4, 4) and distances.min(axis=1).max() < 1e-7, "MuJoCo stores vertices as f32"
    assert ours.volume > 0, "the triangles face outwards, mirrored or not"


COLLADA = """<COLLADA><asset><unit meter="0.5"/></asset><library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="f">0 0 0 0.2 0 0 0 0.4 0 0 0 0.6</float_array><technique_common><accessor source="#f" count="4" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles></mesh></geometry></library_geometries></COLLADA>"""


@pytest.mark.parametrize("name", ["corner.obj", "corner.dae"])
@pytest.mark.parametrize("axis", range(3))
def test_a_mirrored_link_gives_the_mirrored_frame(tmp_path: Path, name: str, axis: int) -> None:
    (tmp_path / "corner.obj").write_text(CORNER, encoding="utf-8")
    (tmp_path / "corner.dae").write_text(COLLADA, encoding="utf-8")
    scales = np.ones((2, 3))
    scales[1, axis] = -1.0
    meshes = []
    for number, scale in enumerate(scales):
        file = tmp_path / f"r{number}.urdf"
        numbers = " ".join(map(str, scale))
        shape = f'<visual><geometry><mesh filename="{name}" scale="{numbers}"/></geometry></visual>'
        file.write_text(f'<robot name="r"><link name="a">{shape}</link></robot>', encoding="utf-8")
        meshes.append(bt.Robot.read(file).mesh("a", shapes="visual"))
    assert [mesh.volume for mesh in meshes] == pytest.approx([1e-3, 1e-3]), "both face outwards"
    patch = bt.Patch.grid(40, 40, 8e-3, 20e-3)
    mirror = np.diag(scales[1])
    across = np.diag([-1.0, 1.0, 1.0])
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, quaternion(0.7, -0.4, 0.3))
    frames = []
    for mesh, link_mirror, world_mirror in [(meshes[0], np.eye(3), np.eye(3)), (meshes[1], mirror, across)]:
        pose = np.eye(4)
        pose[:3, :3] = world_mirror @ turn.reshape(3, 3) @ link_mirror
        pose[:3, 3] = world_mirror @ [0.01, -0.02, 0.1]
        frames.append(patch.press(mesh, pose, depth=10e-3))
    assert (frames[0] > 0).sum() > 3
    assert np.abs(frames[1] - frames[0][:, ::-1]).max() < 1e-12


def test_positions_by_name_by_order_and_in_batches() -> None:
    robot = bt.Robot.read(ROBOTS / "arm.urdf")
    names = [joint.name for joint in robot.joints]
    link = robot.links[-1]
    rng = np.random.default_rng(1)
    q = rng.uniform(-1, 1, (5, len(names)))
    batch = robot.pose(link, q)
    assert batch.shape == (5, 7)
    for row, pose in zip(q, batch, strict=True):
        assert np.array_equal(robot.pose(link, row), pose)
        assert np.array_equal(robot.pose(link, dict(zip(names, row, strict=True))), pose)
    columns = {names[0]: q[:, 0], names[1]: 0.25}
    first = robot.pose(link, columns)
    default = [joint.default for joint in robot.joints]
    rows = np.tile(default, (5, 1))
    rows[:, 0], rows[:, 1] = q[:, 0], 0.25
    assert np.array_equal(first, robot.pose(link, rows))
    assert np.array_equal(robot.pose(link), robot.pose(link, default))
    assert robot.pose(link, np.empty((0, len(names)))).shape == (0, 7)
    base = np.array([1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0])
    assert robot.pose(link, base=base)[:3] == pytest.approx(robot.pose(link)[:3] + base[:3])


def test_wrong_arguments_are_named(tmp_path: Path) -> None:
    robot = bt.Robot.read(ROBOTS / "arm.urdf")
    link, joint = robot.links[-1], robot.joints[0].name
    for arguments, said in [
        (("nowhere",), "nowhere"),
        ((link, {joint: [0.0, 1.0], robot.joints[1].name: [0.0]}), "(1,)"),
        ((link, {joint: math.nan}), "finite"),
        ((link, {joint[:-1] + "9": 0.0}), joint[:-1] + "9"),
        ((link, [0.0]), f"({len(robot.joints)},)"),
        ((link, {joint: "far"}), joint),
        ((link, {0: 0.1}), "q: 0; names of joints"),
    ]:
        refused(re.escape(said), lambda: robot.pose(*arguments))
    gripper = bt.Robot.read(ROBOTS / "gripper.xml")
    refused("mimics `left_finger`", lambda: gripper.pose("right_finger", {"right_finger": 0.01}))
    with pytest.raises(FileNotFoundError):
        bt.Robot.read(tmp_path / "none.urdf")
    refused("no folder", lambda: bt.Robot.read(ROBOTS / "arm.urdf", {"arm": tmp_path / "none"}))
    refused("shapes: `both`; `visual` or `collision`|shapes: `both`; `collision` or `visual`", lambda: robot.mesh(link, shapes="both"))


def test_meshes_of_packages_are_found_by_name_or_above_the_file(tmp_path: Path) -> None:
    text = """<robot name="r"><link name="a"><collision><geometry><mesh filename="package://parts/corner.obj"/></geometry></collision></link></robot>"""
    (tmp_path / "urdf").mkdir()
    file = tmp_path / "urdf" / "r.urdf"
    file.write_text(text, encoding="utf-8")
    refused(r"packages = \{ parts.*parts/corner\.obj", lambda: bt.Robot.read(file).mesh("a"))
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "corner.obj").write_text(CORNER, encoding="utf-8")
    found = bt.Robot.read(file, packages={"parts": elsewhere}).mesh("a")
    assert found.volume == pytest.approx(1e-3)
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "corner.obj").write_text(CORNER, encoding="utf-8")
    assert bt.Robot.read(file).mesh("a").volume == pytest.approx(1e-3)


SUB = """
<mujoco>
  <compiler eulerseq="zyx"/>
  <default><joint axis="0 1 0"/><default class="c"><joint axis="0 1 1" ref="20"/></default></default>
  <worldbody>
    <geom size="0.2" pos="0 0 1"/><site name="base" pos="1 0 0"/>
    <body name="b0" pos="0.1 0.2 0.3"><joint name="j0"/><geom size="0.01" mass="0.1"/>
      <body name="b1" pos="0.3 0 0" euler="0 90 0"><joint name="j1" class="c"/><geom size="0.01" mass="0.1"/>
        <body name="b2" pos="0 0 0.2" euler="10 20 30"><joint name="j2" type="slide"/><joint name="j3"/><geom size="0.01" mass="0.1"/>
          <site name="tip" pos="0.1 0 0" euler="0 45 0"/></body>
        <body name="b3" quat="1 1 0 0"><geom size="0.01" mass="0.1"/></body>
      </body>
    </body>
    <body name="ball" pos="1 1 1"><freejoint name="free"/><geom size="0.01" mass="0.1"/></body>
  </worldbody>
  <equality><joint joint1="j3" joint2="j1" polycoef="0.1 0.5 0 0 0"/></equality>
</mujoco>"""


@pytest.mark.parametrize(
    "bodies",
    [
        '<attach model="sub" body="b0" prefix="x_"/>',
        '<attach model="sub" prefix="x_"/>',
        '<body name="a" pos="1 0 0"><joint name="ja"/><geom size="0.1"/><frame pos="0 0 1" euler="0.1 0.2 0.3"><attach model="sub" body="b1" prefix="x_"/></frame></body>',
        '<replicate count="3" offset="1 0 0" euler="0 0 0.5"><attach model="sub" body="b1" prefix="x_"/></replicate>',
        '<frame pos="1 0 0" euler="0 0 1"><attach model="sub" body="ball" prefix="x_"/></frame>',
        '<attach model="middle" prefix="y_"/><attach model="sub" body="b2" prefix="z_"/>',
    ],
)
def test_attached_models_stand_where_mujocos_do(bodies: str, tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "sub.xml").write_text(SUB)
    middle = """<mujoco><asset><model name="s" file="sub.xml"/></asset><worldbody><body name="top" pos="0 1 0"><joint name="jt"/><geom size="0.1"/>
      <frame euler="0 0 90"><attach model="s" body="b1" prefix="x_"/></frame></body></worldbody></mujoco>"""
    (tmp_path / "parts" / "middle.xml").write_text(middle)
    file = tmp_path / "main.xml"
    file.write_text(f"""<mujoco><compiler angle="radian"/><asset><model name="sub" file="parts/sub.xml"/><model name="middle" file="parts/middle.xml"/></asset>
      <worldbody>{bodies}</worldbody></mujoco>""")
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    robot = bt.Robot.read(file)
    assert robot.links[: model.nbody] == [name_of(model, mujoco.mjtObj.mjOBJ_BODY, i) for i in range(model.nbody)]
    own = {joint.name for joint in robot.joints}
    rng = np.random.default_rng(3)
    for _ in range(5):
        q = {name: value for name, value in random_positions(model, data, rng).items() if name in own}
        for constraint in range(model.neq):
            first, second = model.eq_obj1id[constraint], model.eq_obj2id[constraint]
            offset, factor = model.eq_data[constraint][:2]
            at, of = model.jnt_qposadr[first], model.jnt_qposadr[second]
            data.qpos[at] = model.qpos0[at] + offset + factor * (data.qpos[of] - model.qpos0[of])
        assert largest_difference(model, data, robot, q) < TOLERANCE


def test_wrong_attached_models_are_named(tmp_path: Path) -> None:
    file = tmp_path / "main.xml"
    (tmp_path / "sub.xml").write_text(SUB)
    for attach, words in [
        ('<attach model="sup" prefix="x_"/>', r"main.xml, line 1: `model` .sup., which is no <model> of <asset>; perhaps `sub`"),
        ('<attach model="sub" body="b9" prefix="x_"/>', "`body` .b9., which is no body of the model; perhaps `b0`"),
        ('<attach model="sub" prefix="x_"/><attach model="sub" prefix="x_"/>', "main.xml, line 1: .*sub.xml, line 6: a second site `x_base`"),
        ('<body><attach model="sub" body="ball" prefix="x_"/></body>', "the free joint `x_free`; the only joint of a body in <worldbody>"),
        ('<attach model="self" prefix="x_"/>', "too many models inside each other; at most 20"),
        ('<attach model="none" prefix="x_"/>', "none.xml: cannot be read"),
    ]:
        models = "".join(f'<model name="{name}" file="{of}.xml"/>' for name, of in (("sub", "sub"), ("self", "main"), ("none", "none")))
        file.write_text(f"<mujoco><asset>{models}</asset><worldbody>{attach}</worldbody></mujoco>")
        refused(words, lambda: bt.Robot.read(file))


COPIED = """
<default><default class="c"><joint axis="0 1 0" range="-1 1"/><site pos="0 0 0.3"/></default></default>
<worldbody>
  <frame name="f" pos="0 0 1" euler="0.1 0.2 0.3" childclass="c">
    <body name="b" pos="1 0 0"><joint name="j"/><geom size="0.1"/><site name="s"/>
      <body name="b2" pos="0 1 0" euler="0 0 1"><joint name="j2" axis="1 0 0"/><geom size="0.1"/></body>
    </body>
  </frame>
  BODIES
</worldbody>
<equality><joint joint1="j" joint2="j2" polycoef="0.1 0.5 0 0 0"/></equality>"""


@pytest.mark.parametrize(
    "bodies",
    [
        '<frame pos="0 2 0" euler="0 0.5 0"><attach frame="f" prefix="p_"/></frame>',
        '<frame pos="0 2 0" euler="0 0.5 0"><attach body="b" prefix="p_"/></frame>',
        '<body name="o" pos="0 2 0"><joint name="jo"/><geom size="0.1"/><attach body="b2" prefix="p_"/></body>',
        '<replicate count="2" offset="1 0 0"><attach body="b" prefix="p_"/></replicate>',
        '<frame pos="3 0 0"><attach model="Named" frame="f" prefix="p_"/></frame><attach model="Named" body="b2" prefix="q_"/>',
    ],
)
def test_attached_parts_of_the_same_model_and_frames_stand_where_mujocos_do(bodies: str, tmp_path: Path) -> None:
    asset = '<compiler angle="radian"/><asset><model file="sub.xml"/></asset>' if "model=" in bodies else '<compiler angle="radian"/>'
    (tmp_path / "sub.xml").write_text(f'<mujoco model="Named"><compiler angle="radian"/>{COPIED.replace("BODIES", "")}</mujoco>')
    file = tmp_path / "main.xml"
    file.write_text(f"<mujoco>{asset}{COPIED.replace('BODIES', bodies)}</mujoco>")
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    robot = bt.Robot.read(file)
    assert robot.links[: model.nbody] == [name_of(model, mujoco.mjtObj.mjOBJ_BODY, i) for i in range(model.nbody)]
    followers = {int(model.eq_obj1id[constraint]) for constraint in range(model.neq)}
    rng = np.random.default_rng(3)
    for _ in range(5):
        q = random_positions(model, data, rng)
        for follower in followers:
            q.pop(name_of(model, mujoco.mjtObj.mjOBJ_JOINT, follower))
        for constraint in range(model.neq):
            at, of = model.jnt_qposadr[model.eq_obj1id[constraint]], model.jnt_qposadr[model.eq_obj2id[constraint]]
            data.qpos[at] = 0.1 + 0.5 * data.qpos[of]
        assert largest_difference(model, data, robot, q) < TOLERANCE


def test_wrong_copies_within_a_model_are_named(tmp_path: Path) -> None:
    file = tmp_path / "main.xml"
    for attach, words in [
        ('<attach prefix="p_"/>', "<attach> without `model`; the attribute `model`, or one of `body` and `frame`"),
        ('<attach body="b3" prefix="p_"/>', "`body` .b3., which is no body of the model"),
        ('<attach frame="g" prefix="p_"/>', "`frame` .g., which is no frame of the model; perhaps `f`"),
        ('<attach body="b"/>', "a second body `b`"),
        ('<body name="x"><attach body="x" prefix="p_"/></body>', "too many elements inside each other; at most 500"),
    ]:
        file.write_text(f"<mujoco>{COPIED.replace('BODIES', attach)}</mujoco>")
        refused(words, lambda: bt.Robot.read(file))
