"""Live view of a scene in rerun. Each taxel is a ball at its deflected position, coloured by its deflection, without interpolation.

Needs the package rerun-sdk.

```
rr.init("palm", spawn=True)
view = View(simulation)
for frame in simulation:
    view.show(frame)
```
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from bubbletouch._core import Simulation

__all__ = ["View"]

# Colours, RGB, of deflections 0, half the stroke and the stroke.
_COLORS = np.array([[40, 40, 60], [220, 80, 60], [255, 240, 160]], np.float64)


class View:
    """View of the frames of a simulation on the timeline "scene". The entity /NAME of a patch shows its taxels; the entity /NAME of an object shows
    its axes.

    to: rerun.RecordingStream that receives the data. Default: the active stream.
    """

    def __init__(self, simulation: Simulation, to: rr.RecordingStream | None = None) -> None:
        self._to = to
        self._skins = {name: simulation.patch(name) for name in simulation.patches}
        self._objects = simulation.objects
        for name in self._objects:
            rr.log(f"/{name}", rr.TransformAxes3D(0.02), static=True, recording=to)

    def show(self, frame: Mapping[str, Any]) -> None:
        """Shows a frame at the frame's time."""
        rr.set_time("scene", duration=frame["time"], recording=self._to)
        for name, skin in self._skins.items():
            felt = frame["patches"][name]
            self._place(name, felt["pose"])
            deflection = felt["deflection"].ravel()
            taxels = rr.Points3D(
                skin.centers - deflection[:, None] * skin.axes,
                radii=np.broadcast_to(skin.taxel_radius, len(deflection)),
                colors=_colors(deflection / skin.stroke),
            )
            rr.log(f"/{name}/taxels", taxels, recording=self._to)
            measured = rr.AnyValues(deflection_m=deflection, force_n=felt["force"].ravel())
            rr.log(f"/{name}/taxels", measured, recording=self._to)
        for name in self._objects:
            self._place(name, frame["objects"][name]["pose"])

    def _place(self, name: str, pose: NDArray[np.float64]) -> None:
        """Logs the pose (7,) of an entity."""
        x, y, z, qw, qx, qy, qz = pose.tolist()
        turn = rr.Quaternion(xyzw=[qx, qy, qz, qw])
        rr.log(f"/{name}", rr.Transform3D(translation=[x, y, z], quaternion=turn), recording=self._to)


def _colors(share: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Returns colours (n, 3), 0 to 255, of deflections (n,) that are fractions of the stroke."""
    channels = [np.interp(share, [0.0, 0.5, 1.0], channel) for channel in _COLORS.T]
    return np.stack(channels, axis=1).round().astype(np.uint8)
