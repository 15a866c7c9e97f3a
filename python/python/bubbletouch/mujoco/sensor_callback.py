"""MuJoCo's sensor callback, shared by all skins of a process."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mujoco

# Stages and functions that fill sensors, by the number of the sensor, for the signature of each compiled model.
_sensors: dict[int, dict[int, tuple[int, Callable[[mujoco.MjData], None]]]] = {}
# Callback of the user that was set before the first skin was installed.
_previous: Callable[[Any, Any, Any], None] | None = None


def install(model: mujoco.MjModel, sensor: int, stage: int, fill: Callable[[mujoco.MjData], None]) -> None:
    """Lets `fill` write a sensor at its stage, for all data of models that are compiled from the same description as `model`."""
    global _previous
    current = mujoco.get_mjcb_sensor()
    if current is not _dispatch:
        # The user has set or removed the callback, so the skins installed before are gone.
        _sensors.clear()
        _previous = current
    _sensors.setdefault(model.signature, {})[sensor] = (stage, fill)
    mujoco.set_mjcb_sensor(_dispatch)


def _dispatch(model: mujoco.MjModel, data: mujoco.MjData, now: int) -> None:
    if _previous is not None:
        _previous(model, data, now)
    for stage, fill in _sensors.get(model.signature, {}).values():
        if stage == now:
            fill(data)
