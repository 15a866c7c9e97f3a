"""Skin for MuJoCo: taxels on sites, bodies or geoms of a model, read from `mjData` in the simulation loop. Needs the package mujoco.

    model = mujoco.MjModel.from_xml_path("hand.xml")
    data = mujoco.MjData(model)
    skin = Skin(model, {"palm": bt.Patch.grid(8, 8, pitch=4e-3, stroke=3e-3)})
    mujoco.mj_step(model, data)
    forces = skin.read(data, output="force")          # (n_taxels,), newtons
    skin.frame("palm", forces)                         # (8, 8)

The patches do not affect the dynamics: MuJoCo moves the bodies, and the skin computes the readings of its taxels at their poses. By default, a geom
deflects a taxel as far as the geometry overlaps, so the depth depends on soft contacts (`solref`, `solimp`). `match="normal_force"` presses each
patch until its normal force equals the engine's contact force.

`SkinObservation` adds the skin to the observations of a Gymnasium environment; it needs the package gymnasium.
"""

from typing import TYPE_CHECKING, Any

from bubbletouch.mujoco.geoms import geom_surface
from bubbletouch.mujoco.skin import Skin

if TYPE_CHECKING:
    from bubbletouch.mujoco.observation import SkinObservation
else:

    def __getattr__(name: str) -> Any:
        # Gymnasium is needed only by the wrapper.
        if name == "SkinObservation":
            from bubbletouch.mujoco.observation import SkinObservation

            return SkinObservation
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = ["Skin", "SkinObservation", "geom_surface"]
