"""Gymnasium wrapper that adds the skin to the observations of a MuJoCo environment. Needs the package gymnasium."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import DTypeLike, NDArray

import bubbletouch._core as _core
from bubbletouch.mujoco.skin import Match, Output, Skin


class SkinObservation(gymnasium.ObservationWrapper[Any, Any, Any], gymnasium.utils.RecordConstructorArgs):
    """Adds the readings of a skin to the observations of an environment that simulates with MuJoCo.

    env: environment whose `unwrapped` has `model` and `data`, such as `gymnasium.make("HalfCheetah-v5")`.
    layout, geoms, tolerance, hulls: as for bubbletouch.mujoco.Skin.
    output: "force", newtons, or "deflection", metres.
    match: None, "normal_force" or "contact_force", as for Skin.read.
    key: name of the readings in a Dict space.
    dtype: type of the readings in a Dict space.

    A Dict space has the readings (n_taxels,) under `key` in addition. To a Box space of one axis, the readings are appended in the type of the Box. The
    readings are at the poses of the environment's last mj_step or mj_forward, as MuJoCo's own sensors are. `info` contains, under `key`, the numbers of
    touched and saturated taxels of each patch, (n_patches, 2), and with `match` the forces that the taxels do not carry, (n_patches, n_bodies), newtons; the
    first such force of more than 1 % raises a warning. An environment that compiles its model again gets a new skin. Raises ValueError for other environments and
    spaces, and for a key that the space has already.
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        layout: Mapping[str, _core.Patch],
        *,
        geoms: Literal["all"] | Sequence[str | int] = "all",
        output: Output = "force",
        match: Match | None = None,
        key: str = "skin",
        dtype: DTypeLike = np.float32,
        tolerance: float = 1e-5,
        hulls: bool = False,
    ) -> None:
        gymnasium.utils.RecordConstructorArgs.__init__(
            self, layout=layout, geoms=geoms, output=output, match=match, key=key, dtype=dtype, tolerance=tolerance, hulls=hulls
        )
        gymnasium.ObservationWrapper.__init__(self, env)
        inner: Any = env.unwrapped
        if not (hasattr(inner, "model") and hasattr(inner, "data")):
            raise ValueError(f"env: {type(inner).__name__}; an environment with MuJoCo's model and data")
        self._layout = layout
        self._options: dict[str, Any] = {"geoms": geoms, "tolerance": tolerance, "hulls": hulls}
        self.skin = Skin(inner.model, layout, **self._options)
        self._model = inner.model
        self._key, self._output, self._match = key, output, match
        self._has_warned = False
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

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Resets the environment; `info` has the entry of the skin."""
        observation, info = self.env.reset(seed=seed, options=options)
        return self.observation(observation), {**info, self._key: self._counts}

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Steps the environment; `info` has the entry of the skin."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        return self.observation(observation), reward, terminated, truncated, {**info, self._key: self._counts}

    def observation(self, observation: Any) -> Any:
        """Returns an observation of the environment with the readings of the skin."""
        inner: Any = self.env.unwrapped
        if inner.model is not self._model:
            self._model, self.skin = inner.model, Skin(inner.model, self._layout, **self._options)
        shape = (len(self.skin.patches), len(self.skin.bodies))
        contacts, forces, residuals = np.zeros((shape[0], 2), np.int64), np.zeros(shape), np.zeros(shape)
        read = self.skin.read(
            inner.data, output=self._output, match=self._match, contacts=contacts, pair_forces=forces, residuals=residuals
        )
        self._counts: dict[str, NDArray[Any]] = {"contacts": contacts} | ({"residuals": residuals} if self._match else {})
        if not self._has_warned and (np.abs(residuals) > 0.01 * (forces + residuals)).any():
            self._has_warned = True
            warnings.warn("the taxels do not carry all contact forces: some are at their stroke, or contacts are beside the skin; see info", stacklevel=3)
        readings = read.astype(self._dtype)
        if isinstance(self.observation_space, spaces.Dict):
            return {**observation, self._key: readings}
        return np.concatenate([observation, readings])


def _limit(patch: _core.Patch, output: Output) -> NDArray[np.float64] | float:
    """Returns the largest readings of the taxels of a patch."""
    if output not in ("deflection", "force"):
        raise ValueError(f'output: {output!r}; "deflection" or "force"')
    return patch.stroke * patch.stiffness if output == "force" else patch.stroke


__all__ = ["SkinObservation"]
