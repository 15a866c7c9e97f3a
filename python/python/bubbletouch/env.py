"""Gymnasium environments: find what lies on a table by touch, and say what it is.

`gymnasium.make("BubbleTouch/FindObject-v0")` after `import bubbletouch.env`; `gymnasium.make_vec(..., vectorization_mode="vector_entry_point")` steps
many of them in one call.

An object out of a list lies on a table, at a place and a turn that nobody tells. The patch starts somewhere over the table; an action moves
it, and it comes down to a depth past first contact. An SVM, trained on touches of all objects, scores each frame's means over 2 × 2 taxels; the
scores of an episode's touches are added up, and when one object leads the next by `confidence`, the episode ends: reward 1 if that is the object, −1 if not.
A step costs 0.02; after `max_steps` the episode is cut off.
"""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Integral
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from bubbletouch._core import Catalogue, Patch, SphereUnion, touch_poses
from bubbletouch._numbers import real, whole
from bubbletouch.learning import SVC

__all__ = ["FindObject", "FindObjectVector"]

Floats = NDArray[np.float64]

STEP_COST = 0.02
OBJECTS = ("tennis", "golf", "mug", "banana")
# Metres past first contact of each touch.
DEPTH = 3e-3
# Touches of each object that the classifier learns from. More: it is right more often, and slower.
N_TRAINING = 400


class _World:
    """Objects, skin and classifier, for any number of episodes at once."""

    def __init__(self, objects: Sequence[str], n_taxels: int, reach: float, training_seed: int) -> None:
        n_taxels = whole("n_taxels", n_taxels, least=2, most=2048)
        if n_taxels % 2:
            raise ValueError(f"n_taxels: {n_taxels}; an even number of rows and columns")
        if len(objects) < 2:
            raise ValueError(f"objects: {len(objects)}; at least two to tell apart")
        catalogue = Catalogue.builtin()
        self.objects: list[SphereUnion] = [catalogue.object(name).pack(1e-3) for name in objects]
        self.patch = Patch.grid(n_taxels, n_taxels, 64e-3 / n_taxels, 5e-3)
        self.reach = real("reach", reach, above=0)
        # Where each object stands if the patch's axis goes through its middle.
        self.upright = np.stack([touch_poses(thing) for thing in self.objects])
        random = np.random.default_rng(whole("training_seed", training_seed, least=0))
        n = N_TRAINING
        which = np.repeat(np.arange(len(objects)), n)
        offset = random.uniform(-0.06, 0.06, (len(which), 2))
        frames = self.touch(which, offset, random.uniform(0, 2 * np.pi, len(which)))
        touched = frames.any(axis=(1, 2))
        features = self.features(frames[touched])
        self.classifier = SVC(C=10, multi_class="ovr").fit(features, which[touched])

    def features(self, frames: NDArray[np.float32]) -> Floats:
        """(n, n_taxels / 4): means over 2 × 2 taxels, shares of the stroke."""
        corners = [frames[:, y::2, x::2] for y in (0, 1) for x in (0, 1)]
        means = (corners[0] + corners[1] + corners[2] + corners[3]) / np.float32(4 * 5e-3)
        return means.reshape(len(frames), self.patch.n_taxels // 4).astype(np.float64)

    def scores(self, frames: NDArray[np.float32]) -> Floats:
        """(n, n_objects); zero of a frame that nothing touches."""
        scores = np.zeros((len(frames), len(self.classifier.problems_)))
        touched = np.flatnonzero(frames.any(axis=(1, 2)))
        if len(touched):
            # The estimator's own checks cost as much as what it computes.
            scores[touched] = self.classifier._model.decision_values(self.features(frames[touched]))
        return scores

    def touch(self, which: NDArray[np.int64], offset: Floats, yaw: Floats) -> NDArray[np.float32]:
        """Frames (n, ny, nx), metres, of the patch over places of the table seen from each object's own middle."""
        poses = self._poses(which, offset, yaw)
        frames = np.empty((len(which), *self.patch.shape), np.float32)
        for number, thing in enumerate(self.objects):
            rows = np.flatnonzero(which == number)
            if len(rows):
                frames[rows] = self.patch.press(thing, poses[rows], depth=DEPTH, dtype="float32")
        return frames

    def _poses(self, which: NDArray[np.int64], offset: Floats, yaw: Floats) -> Floats:
        # touch_poses for many objects at once: facing down, half a turn about x after the yaw about z.
        poses = self.upright[which].copy()
        x, y = poses[:, 0].copy(), poses[:, 1].copy()
        cos, sin = np.cos(yaw), np.sin(yaw)
        # The middle of the object's box is at (−x, y) of its own frame, upside-down in the patch's.
        poses[:, 0] = cos * x + sin * y - offset[:, 0]
        poses[:, 1] = -sin * x + cos * y + offset[:, 1]
        half = yaw / 2
        zero = np.zeros_like(half)
        poses[:, 3:] = np.stack([zero, np.cos(half), -np.sin(half), zero], 1)
        return poses


class FindObjectVector(VectorEnv[NDArray[np.float32], NDArray[np.float32], Any]):
    """Many episodes, stepped in one call; an episode that has ended begins anew at its next step.

    num_envs: how many, at least 1. objects: two or more names of the catalogue. n_taxels: rows and columns of the patch, 64 mm wide; an even number. reach: how far from the table's
    middle patch and object may be, metres, above 0. confidence: by how much one score must lead, at least 0. max_steps: of an episode, at least 1.
    training_seed: of the touches that the classifier learns from. Raises TypeError and ValueError.

    Observations: float32 (num_envs, n_taxels² + 2), deflections as shares of the stroke and the patch's place as a share of the reach. Actions: float32
    (num_envs, 2), −1 to 1: moves along x and y by up to 20 mm.
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int = 1,
        *,
        objects: Sequence[str] = OBJECTS,
        n_taxels: int = 16,
        reach: float = 0.06,
        confidence: float = 3.0,
        max_steps: int = 20,
        training_seed: int = 0,
    ) -> None:
        self.num_envs = num_envs = whole("num_envs", num_envs, least=1)
        self.confidence: float = real("confidence", confidence, least=0)
        self.max_steps: int = whole("max_steps", max_steps, least=1)
        self._world = _World(objects, n_taxels, reach, training_seed)
        low = np.r_[np.zeros(self._world.patch.n_taxels), -np.ones(2)].astype(np.float32)
        self.single_observation_space = spaces.Box(low, np.ones(len(low), np.float32))
        self.single_action_space = spaces.Box(-1, 1, (2,), np.float32)
        batch = gymnasium.vector.utils.batch_space
        self.observation_space = batch(self.single_observation_space, num_envs)
        self.action_space = batch(self.single_action_space, num_envs)
        n = num_envs
        self._which = np.zeros(n, np.int64)
        self._middle, self._patch = np.zeros((2, n, 2))
        self._yaw = np.zeros(n)
        self._scores = np.zeros((n, len(objects)))
        self._n_steps = np.zeros(n, np.int64)
        self._is_over = np.zeros(n, bool)
        # A generator of each environment, if a list of seeds was given; otherwise one for all.
        self._own_random: list[np.random.Generator] | None = None

    def _begin(self, rows: NDArray[Any]) -> None:
        if self._own_random is None:
            self._draw(rows, self.np_random)
        else:
            for row in rows:
                self._draw(np.array([row]), self._own_random[row])
        self._scores[rows] = 0
        self._n_steps[rows] = 0

    def _draw(self, rows: NDArray[Any], random: np.random.Generator) -> None:
        n, reach = len(rows), self._world.reach
        self._which[rows] = random.integers(len(self._world.objects), size=n)
        self._middle[rows] = random.uniform(-reach / 2, reach / 2, (n, 2))
        self._yaw[rows] = random.uniform(0, 2 * np.pi, n)
        self._patch[rows] = random.uniform(-reach, reach, (n, 2))

    def _observe(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        frames = self._world.touch(self._which, self._patch - self._middle, self._yaw)
        shares = np.minimum(frames.reshape(self.num_envs, -1) / np.float32(5e-3), 1)
        place = (self._patch / self._world.reach).astype(np.float32)
        return np.concatenate([shares, place], 1), frames

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """New episodes in all environments; a seed makes them, and all after them, the same again.

        A sequence has a seed of each environment: its episodes are those of that environment alone with that seed. None in it: new ones.
        Raises TypeError and ValueError.
        """
        if seed is None or isinstance(seed, Integral):
            super().reset(seed=None if seed is None else whole("seed", seed, least=0), options=options)
            # As in Gymnasium, a reset without a seed goes on with the generators that there are.
            self._own_random = self._own_random if seed is None else None
        else:
            self._own_random = self._generators(seed)
        self._begin(np.arange(self.num_envs))
        self._is_over[:] = False
        return self._observe()[0], {"object": self._which.copy()}

    def _generators(self, seeds: int | Sequence[int | None]) -> list[np.random.Generator]:
        given = list(seeds) if isinstance(seeds, Sequence | np.ndarray) else None
        if given is None:
            raise TypeError(f"seed: {seeds!r}; a whole number, one for each of {self.num_envs} environments, or None")
        if len(given) != self.num_envs:
            raise ValueError(f"seed: {len(given)} seeds; one for each of {self.num_envs} environments")
        checked = [None if one is None else whole(f"seed[{number}]", one, least=0) for number, one in enumerate(given)]
        return [gymnasium.utils.seeding.np_random(one)[0] for one in checked]

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], Floats, NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Moves and touches in all environments; those whose episode had ended begin another instead, with no reward."""
        actions = np.clip(np.asarray(actions, np.float64), -1, 1)
        if actions.shape != (self.num_envs, 2):
            raise ValueError(f"actions: shape {actions.shape}; ({self.num_envs}, 2)")
        anew = self._is_over
        self._begin(np.flatnonzero(anew))
        goes = np.where(anew[:, None], 0, 0.02 * actions)
        self._patch = np.clip(self._patch + goes, -self._world.reach, self._world.reach)
        observed, frames = self._observe()
        self._scores[~anew] += self._world.scores(frames[~anew])
        self._n_steps[~anew] += 1
        order = np.sort(self._scores, axis=1)
        terminated = ~anew & (order[:, -1] - order[:, -2] >= self.confidence)
        is_right = self._scores.argmax(axis=1) == self._which
        rewards = np.where(anew, 0.0, -STEP_COST) + terminated * np.where(is_right, 1.0, -1.0)
        truncated = ~anew & ~terminated & (self._n_steps >= self.max_steps)
        self._is_over = terminated | truncated
        return observed, rewards, terminated, truncated, {"object": self._which.copy(), "scores": self._scores.copy()}


class FindObject(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """One episode at a time; arguments, observations and actions as FindObjectVector's, without their first side."""

    metadata = {"render_modes": []}

    def __init__(self, **arguments: Any) -> None:
        self._many = FindObjectVector(1, **arguments)
        self.observation_space = self._many.single_observation_space
        self.action_space = self._many.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """A new episode; a seed makes it, and all after it, the same again."""
        super().reset(seed=seed, options=options)
        self._many._np_random = self.np_random
        observed, info = self._many.reset()
        return observed[0], {"object": int(info["object"][0])}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Moves and touches."""
        observed, rewards, terminated, truncated, info = self._many.step(np.asarray(action)[None])
        said = {"object": int(info["object"][0]), "scores": info["scores"][0]}
        return observed[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), said


gymnasium.register(
    id="BubbleTouch/FindObject-v0",
    entry_point="bubbletouch.env:FindObject",
    vector_entry_point="bubbletouch.env:FindObjectVector",
)
