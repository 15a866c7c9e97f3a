"""Gymnasium wrapper that adds the skin to the observations of a MuJoCo environment. Needs the package gymnasium."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import DTypeLike, NDArray

import bubbletouch._core as _core
from bubbletouch.mujoco.skin import Output, Skin


class SkinObservation(gymnasium.ObservationWrapper[Any, Any, Any]):
    """Adds the readings of a skin to the observations of an environment that simulates with MuJoCo.

    env: environment whose `unwrapped` has `model` and `data`, such as `gymnasium.make("HalfCheetah-v5")`.
    layout, geoms, tolerance, hulls: as for bubbletouch.mujoco.Skin.
    output: "force", newtons, or "deflection", metres.
    match: None or "normal_force", as for Skin.read.
    key: name of the readings in a Dict space.
    dtype: type of the readings in a Dict space.

    A Dict space has the readings (n_taxels,) under `key` in addition. To a Box space of one axis, the readings are appended in the type of the Box. The
    readings are at the poses of the environment's last mj_step or mj_forward, as MuJoCo's own sensors are. Raises ValueError for other environments and
    spaces, and for a key that the space has already.
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        layout: Mapping[str, _core.Patch],
        *,
        geoms: Literal["all"] | Sequence[str] = "all",
        output: Output = "force",
        match: Literal["normal_force"] | None = None,
        key: str = "skin",
        dtype: DTypeLike = np.float32,
        tolerance: float = 1e-5,
        hulls: bool = False,
    ) -> None:
        super().__init__(env)
        inner: Any = env.unwrapped
        if not (hasattr(inner, "model") and hasattr(inner, "data")):
            raise ValueError(f"env: {type(inner).__name__}; an environment with MuJoCo's model and data")
        self.skin = Skin(inner.model, layout, geoms=geoms, tolerance=tolerance, hulls=hulls)
        self._key, self._output, self._match = key, output, match
        limits = [np.broadcast_to(_limit(patch, output), (patch.n_taxels,)) for patch in self.skin.patches.values()]
        given = env.observation_space
        if isinstance(given, spaces.Dict):
            if key in given.spaces:
                raise ValueError(f"key: {key!r}; a name that the observation space does not have")
            self._dtype = np.dtype(dtype)
            skin = spaces.Box(np.zeros(self.skin.n_taxels, self._dtype), np.concatenate(limits).astype(self._dtype))
            self.observation_space = spaces.Dict({**given.spaces, key: skin})
        elif isinstance(given, spaces.Box) and len(given.shape) == 1 and np.issubdtype(given.dtype, np.floating):
            self._dtype = np.dtype(given.dtype)
            low = np.concatenate([given.low, np.zeros(self.skin.n_taxels)]).astype(self._dtype)
            high = np.concatenate([given.high, *limits]).astype(self._dtype)
            self.observation_space = spaces.Box(low, high, dtype=given.dtype.type)
        else:
            raise ValueError(f"observation_space: {given}; a Dict, or a Box of numbers with one axis")

    def observation(self, observation: Any) -> Any:
        """Returns an observation of the environment with the readings of the skin."""
        data: Any = self.env.unwrapped
        readings = self.skin.read(data.data, output=self._output, match=self._match)
        readings = readings.astype(self._dtype)
        if isinstance(self.observation_space, spaces.Dict):
            return {**observation, self._key: readings}
        return np.concatenate([observation, readings])


def _limit(patch: _core.Patch, output: Output) -> NDArray[np.float64] | float:
    """Returns the largest readings of the taxels of a patch."""
    if output not in ("deflection", "force"):
        raise ValueError(f'output: {output!r}; "deflection" or "force"')
    return patch.stroke * patch.stiffness if output == "force" else patch.stroke


__all__ = ["SkinObservation"]
