"""MuJoCo's sensor callback, shared by all skins of a process."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import mujoco

if TYPE_CHECKING:
    from bubbletouch.mujoco.skin import Skin

# Skin, stage and function that fill each sensor, by the number of the sensor and the model of the skin.
_sensors: dict[tuple[int, int], tuple[Skin, int, Callable[[mujoco.MjData], None]]] = {}
# Callback of the user that was set before the first skin was installed.
_previous: Callable[[Any, Any, Any], None] | None = None


def install(skin: Skin, sensor: int, stage: int, fill: Callable[[mujoco.MjData], None]) -> None:
    """Lets `fill` write a sensor at its stage, for all data of models that fit the skin."""
    global _previous
    current = mujoco.get_mjcb_sensor()
    if current is not _dispatch:
        # The user has set or removed the callback, so the skins installed before are gone.
        _sensors.clear()
        _previous = current
    _sensors[id(skin.model), sensor] = (skin, stage, fill)
    mujoco.set_mjcb_sensor(_dispatch)


def _dispatch(model: mujoco.MjModel, data: mujoco.MjData, now: int) -> None:
    if _previous is not None:
        _previous(model, data, now)
    at_stage = [(skin, fill) for skin, stage, fill in _sensors.values() if stage == now]
    # Of skins of several models with the same surfaces, the one of the model itself has the last word.
    for skin, fill in sorted(at_stage, key=lambda item: item[0].model is model):
        if skin.fits(model):
            fill(data)
