"""Models of hands with an object, for tests and benchmarks. Needs the package mujoco."""

from __future__ import annotations

from pathlib import Path

import bubbletouch as bt
import mujoco
import numpy as np
from bubbletouch.mujoco import Skin
from numpy.typing import NDArray

ROBOTS = Path(__file__).resolve().parents[2] / "objects" / "robots"
BALL = '<geom name="ball" type="sphere" size="0.03" mass="0.15"/>'
BOX = '<geom name="box" type="box" size="0.03 0.025 0.025" mass="0.15"/>'
# Angles of closed joints, degrees; joints that are not listed stay at 0.
CLOSED = {"proximal": 80, "middle": 75, "distal": 45, "thumb_opposition": 35, "thumb_proximal": 90, "thumb_middle": 45, "thumb_distal": 45}


def with_object(robot: str, geoms: str = BALL, pose: str = 'pos="-0.005 0.075 0.06"', others: str = "") -> mujoco.MjModel:
    """Returns the model of a robot of objects/robots with a free body `object` of the given geoms, and other elements of MJCF."""
    text = f"""
    <mujoco>
      <include file="{robot}.xml"/>
      <worldbody><body name="object" {pose}><freejoint/>{geoms}</body></worldbody>
      {others}
    </mujoco>"""
    return mujoco.MjModel.from_xml_string(text, {f"{robot}.xml": (ROBOTS / f"{robot}.xml").read_bytes()})


def hand_controls(model: mujoco.MjModel, closed: float) -> NDArray[np.float64]:
    """Returns the controls of the five-finger hand, open at 0 and closed at 1, radians."""
    names = [model.actuator(number).name for number in range(model.nu)]
    angles = [CLOSED.get(name, CLOSED.get(name.split("_")[1], 0)) for name in names]
    return closed * np.deg2rad(angles)


def close_hand(model: mujoco.MjModel, data: mujoco.MjData, n_steps: int = 500) -> None:
    """Lets the object come to rest in the open hand for 150 steps, and closes the fingers over the next 250 of `n_steps` steps."""
    for step in range(n_steps):
        data.ctrl[:] = hand_controls(model, min(max((step - 150) / 250, 0.0), 1.0))
        mujoco.mj_step(model, data)


def close_gripper(model: mujoco.MjModel, data: mujoco.MjData, n_steps: int = 400) -> None:
    """Opens the gripper at once and closes it, without gravity."""
    model.opt.gravity[:] = 0.0
    data.qpos[:2] = 0.04
    data.ctrl[:] = 0.0
    for _ in range(n_steps):
        mujoco.mj_step(model, data)


def normal_forces(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, float]:
    """Returns the engine's normal force between the object and each body that it touches, newtons, by the name of the body."""
    forces: dict[str, float] = {}
    for number in range(data.ncon):
        bodies = [model.body(model.geom_bodyid[geom]).name for geom in data.contact.geom[number]]
        if "object" in bodies:
            force = np.zeros(6)
            mujoco.mj_contactForce(model, data, number, force)
            other = bodies[bodies[0] == "object"]
            forces[other] = forces.get(other, 0.0) + float(force[0])
    return forces


def full_hand(meshes: bool = False) -> tuple[mujoco.MjModel, mujoco.MjData, Skin]:
    """Returns the five-finger hand with a ball that three patches touch, and a skin of 20 patches of 8 × 8 taxels under five bodies.

    The other bodies lie beside the hand. meshes: whether the bodies are triangle meshes (the ball has about 1,300 triangles) instead of primitives.
    """
    kinds = ["sphere", "box", "capsule", "cylinder", "ellipsoid"]
    assets, geoms = "", []
    for number, kind in enumerate(kinds):
        shape = f'type="{kind}" size="0.03 0.025 0.02"'
        if meshes:
            size = [0.03, 0.03, 0.03] if kind == "sphere" else [0.03, 0.025, 0.02]
            mesh = bt.Mesh.ellipsoid(size, 2.5e-4)
            numbers = [" ".join(map(str, np.asarray(part).ravel().tolist())) for part in (mesh.vertices, mesh.triangles)]
            assets += f'<mesh name="{kind}" vertex="{numbers[0]}" face="{numbers[1]}"/>'
            shape = f'type="mesh" mesh="{kind}"'
        geoms.append(f'<geom name="{kind}" {shape} mass="0.15"/>')
    beside = "".join(f'<body pos="{0.2 + 0.1 * n} 0.1 0">{geom}</body>' for n, geom in enumerate(geoms[1:]))
    model = with_object("five_finger_hand", geoms[0], others=f"<asset>{assets}</asset><worldbody>{beside}</worldbody>")
    data = mujoco.MjData(model)
    close_hand(model, data, n_steps=345)
    names = [model.site(number).name for number in range(model.nsite)]
    pitches = [4e-3 if name.startswith("palm") else 1.75e-3 for name in names]
    layout = {name: bt.Patch.grid(8, 8, pitch, 3e-3, stiffness=300.0) for name, pitch in zip(names, pitches, strict=True)}
    return model, data, Skin(model, layout, geoms=kinds)
