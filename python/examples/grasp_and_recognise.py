"""A hand grasps boxes, cans and mugs in MuJoCo at random poses; an SVM recognises them by the forces on the taxels alone."""

# The package mujoco has no types of its own.
# pyright: reportAttributeAccessIssue=false

from pathlib import Path

import mujoco
import numpy as np

import bubbletouch as bt
from bubbletouch.learning import SVC
from bubbletouch.mujoco import Skin

HAND = Path(__file__).resolve().parents[2] / "objects" / "robots" / "five_finger_hand.xml"
CUP = " ".join(f"{r * np.cos(a)} {r * np.sin(a)} {z}" for r, z in [(0.021, -0.03), (0.028, 0.03)] for a in np.arange(0, 6.28, 0.3))
OBJECTS = {
    "box": '<geom type="box" size="0.03 0.023 0.03" mass="0.2"/>',
    "can": '<geom type="cylinder" size="0.025 0.03" mass="0.2"/>',
    "mug": '<geom type="mesh" mesh="cup" mass="0.2"/><geom type="capsule" fromto="0 0.035 -0.015 0 0.035 0.015" size="0.006"/>',
}
CLOSED = {"proximal": 1.4, "middle": 1.3, "distal": 0.8, "opposition": 0.6, "spread": 0.0}


def grasps(geoms: str, n: int, random: np.random.Generator) -> list[np.ndarray]:
    """Returns the forces on the taxels, newtons, (n, n_taxels), in n grasps of an object that lies in the palm."""
    body = f'<body name="object" pos="0 0.075 0.06"><freejoint/>{geoms}</body>'
    scene = f'<mujoco><include file="hand.xml"/><asset><mesh name="cup" vertex="{CUP}"/></asset><worldbody>{body}</worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(scene, {"hand.xml": HAND.read_bytes()})
    sites = [model.site(number).name for number in range(model.nsite)]
    skin = Skin(model, {name: bt.Patch.grid(8, 8, 4e-3 if "palm" in name else 1.75e-3, 3e-3, stiffness=300.0) for name in sites})
    closed = np.array([CLOSED[model.actuator(number).name.split("_")[1]] for number in range(model.nu)])
    data, forces = mujoco.MjData(model), []
    for _ in range(n):
        mujoco.mj_resetData(model, data)
        yaw = random.uniform(0, 2 * np.pi)
        data.qpos[20:22] += random.uniform(-5e-3, 5e-3, 2)
        data.qpos[23:27] = [np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]
        for step in range(450):
            data.ctrl[:] = closed * np.clip((step - 150) / 250, 0, 1)
            mujoco.mj_step(model, data)
        forces.append(skin.read(data, output="force", match="normal_force"))
    return forces


random = np.random.default_rng(0)
x = np.concatenate([grasps(geoms, 60, random) for geoms in OBJECTS.values()])
y = np.repeat(list(OBJECTS), 60)
test = np.arange(len(y)) % 3 == 0
accuracy = np.mean(SVC(C=10).fit(x[~test], y[~test]).predict(x[test]) == y[test])
print(f"{accuracy:.1%} of {test.sum()} grasps at new poses recognised by {x.shape[1]} taxels")
assert accuracy > 0.8
