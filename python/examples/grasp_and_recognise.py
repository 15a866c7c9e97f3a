"""A hand grasps boxes, cans and mugs in MuJoCo at random poses; an SVM recognises them by the forces on the taxels alone."""

# pyright: reportAttributeAccessIssue=false
from pathlib import Path

import mujoco
import numpy as np

import bubbletouch as bt
from bubbletouch.learning import SVC
from bubbletouch.mujoco import Skin

HAND = Path(__file__).resolve().parents[2] / "objects" / "robots" / "five_finger_hand.xml"
CUP = " ".join(f"{r * np.cos(a)} {r * np.sin(a)} {z}" for r, z in [(0.021, -0.03), (0.028, 0.03)] for a in np.arange(0, 6.28, 0.3))
SCENE = f"""<mujoco><include file="hand.xml"/><asset><mesh name="cup" vertex="{CUP}"/></asset>
    <worldbody><body pos="0 0.075 0.06"><freejoint/>%s</body></worldbody></mujoco>"""
OBJECTS = {
    "box": '<geom type="box" size="0.03 0.023 0.03"/>',
    "can": '<geom type="cylinder" size="0.025 0.03"/>',
    "mug": '<geom type="mesh" mesh="cup"/><geom type="capsule" fromto="0 0.035 -0.015 0 0.035 0.015" size="0.006"/>',
}
random, forces = np.random.default_rng(0), []
for geoms in OBJECTS.values():
    model = mujoco.MjModel.from_xml_string(SCENE % geoms, {"hand.xml": HAND.read_bytes()})
    sites, data = [model.site(number).name for number in range(model.nsite)], mujoco.MjData(model)
    skin = Skin(model, {name: bt.Patch.grid(8, 8, 4e-3 if "palm" in name else 1.75e-3, 3e-3, stiffness=300.0) for name in sites})
    closed = [0.0 if "spread" in model.actuator(k).name else 0.8 * model.actuator_ctrlrange[k, 1] for k in range(model.nu)]
    for turn in random.uniform(0, 2 * np.pi, 60):  # an object that lies in the palm at a random pose
        mujoco.mj_resetData(model, data)
        data.qpos[20:] += [*random.uniform(-5e-3, 5e-3, 2), 0, np.cos(turn / 2) - 1, 0, 0, np.sin(turn / 2)]
        for step in range(450):
            data.ctrl[:] = np.multiply(closed, np.clip((step - 150) / 250, 0, 1))
            mujoco.mj_step(model, data)
        forces.append(skin.read(data, output="force", match="normal_force"))

x, y = np.array(forces), np.repeat(list(OBJECTS), 60)
test = np.arange(len(y)) % 3 == 0
accuracy = np.mean(SVC(C=10).fit(x[~test], y[~test]).predict(x[test]) == y[test])
print(f"{accuracy:.1%} of {test.sum()} grasps at new poses recognised by {x.shape[1]} taxels")
assert accuracy > 0.8
