"""A ball rolls over a palm of taxels in MuJoCo's simulation; the skin reads the force on each taxel at every step."""

# The package mujoco has no types of its own.
# pyright: reportAttributeAccessIssue=false

import mujoco
import numpy as np

import bubbletouch as bt
from bubbletouch.mujoco import Skin

MODEL = """
<mujoco>
  <worldbody>
    <body name="palm">
      <geom type="box" size="0.04 0.04 0.005" pos="0 0 -0.008"/>
      <geom type="box" size="0.04 0.04 0.001" pos="0 0 0.0005" rgba="0 0 0 0"/>
      <site name="palm"/>
    </body>
    <body name="ball" pos="-0.02 0 0.0314">
      <freejoint/>
      <geom name="ball" type="sphere" size="0.03" mass="0.1"/>
    </body>
  </worldbody>
</mujoco>
"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qvel[:3] = [0.2, 0.0, 0.0]
skin = Skin(model, {"palm": bt.Patch.grid(16, 16, pitch=4e-3, stroke=5e-3)})

for step in range(100):
    mujoco.mj_step(model, data)
    forces = skin.frame("palm", skin.read(data, output="force"))
    if step % 20 == 0 and forces.any():
        row, column = np.unravel_index(forces.argmax(), forces.shape)
        print(f"{data.time:.3f} s: {forces.sum():5.2f} N on {np.count_nonzero(forces)} taxels, most on row {row}, column {column}")
