"""Gymnasium environments in which an object on a table is found and recognised by touch.

After `import bubbletouch.env`, `gymnasium.make("BubbleTouch/FindObject-v0")` creates one environment. `gymnasium.make_vec(...,
vectorization_mode="vector_entry_point")` creates many environments that are stepped in one call.

An object from a list lies on a table. Its identity, position and rotation are hidden. The patch starts at a random place over the table. An action
moves the patch; then the patch moves down to a depth past first contact. An SVM is trained on touches of all objects. Its features are the means of
each frame over 2 × 2 taxels. The scores of the touches in an episode are summed. If the largest score exceeds the second largest by at least
`confidence`, the episode ends. The reward is 1 if the object is correct, otherwise −1. A step costs 0.02. After `max_steps` steps, the episode is
truncated.
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
# Depth of each touch past first contact, metres.
DEPTH = 3e-3
# Number of training touches per object. If larger, the classifier is more accurate and slower.
N_TRAINING = 400


class _World:
    """Objects, patch and classifier of the environments, shared by any number of episodes."""

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
        # Pose of each object in the patch frame if the patch's axis goes through the middle of the object.
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
        """Returns the features (n, n_taxels / 4): means of the deflections over 2 × 2 taxels, as fractions of the stroke."""
        corners = [frames[:, y::2, x::2] for y in (0, 1) for x in (0, 1)]
        means = (corners[0] + corners[1] + corners[2] + corners[3]) / np.float32(4 * 5e-3)
        return means.reshape(len(frames), self.patch.n_taxels // 4).astype(np.float64)

    def scores(self, frames: NDArray[np.float32]) -> Floats:
        """Returns the scores (n, n_objects) of frames; the scores are 0 for a frame without contact."""
        scores = np.zeros((len(frames), len(self.classifier.problems_)))
        touched = np.flatnonzero(frames.any(axis=(1, 2)))
        if len(touched):
            # Calls the model directly: the estimator's checks take as long as the computation.
            scores[touched] = self.classifier._model.decision_values(self.features(frames[touched]))
        return scores

    def touch(self, which: NDArray[np.int64], offset: Floats, yaw: Floats) -> NDArray[np.float32]:
        """Returns frames (n, ny, nx), metres, float32.

        which: object indices (n,). offset: position of the patch relative to the middle of the object, metres, (n, 2). yaw: rotation of the object
        about the vertical, radians, (n,).
        """
        poses = self._poses(which, offset, yaw)
        frames = np.empty((len(which), *self.patch.shape), np.float32)
        for number, thing in enumerate(self.objects):
            rows = np.flatnonzero(which == number)
            if len(rows):
                frames[rows] = self.patch.press(thing, poses[rows], depth=DEPTH, dtype="float32")
        return frames

    def _poses(self, which: NDArray[np.int64], offset: Floats, yaw: Floats) -> Floats:
        # Equals touch_poses for several objects: the patch faces down, so a half turn about x follows the yaw about z.
        poses = self.upright[which].copy()
        x, y = poses[:, 0].copy(), poses[:, 1].copy()
        cos, sin = np.cos(yaw), np.sin(yaw)
        # The middle of the object's bounding box is at (−x, y) in the object frame; the object is upside-down in the patch frame.
        poses[:, 0] = cos * x + sin * y - offset[:, 0]
        poses[:, 1] = -sin * x + cos * y + offset[:, 1]
        half = yaw / 2
        zero = np.zeros_like(half)
        poses[:, 3:] = np.stack([zero, np.cos(half), -np.sin(half), zero], 1)
        return poses


class FindObjectVector(VectorEnv[NDArray[np.float32], NDArray[np.float32], Any]):
    """Many environments that are stepped in one call. After the end of an episode, the next step starts a new episode.

    num_envs: number of environments, at least 1.
    objects: two or more names of objects in the catalogue.
    n_taxels: number of rows and of columns of the patch, even; the patch is 64 mm wide.
    reach: largest coordinate of the patch relative to the middle of the table, metres, above 0. Objects lie within half of it.
    confidence: minimum difference between the two largest scores that ends an episode, at least 0.
    max_steps: maximum number of steps of an episode, at least 1.
    training_seed: seed of the touches on which the classifier is trained.

    Observations: float32 (num_envs, n_taxels² + 2): deflections as fractions of the stroke, and the position of the patch as a fraction of the
    reach. Actions: float32 (num_envs, 2), −1 to 1: moves along x and y by up to 20 mm. Raises TypeError and ValueError for invalid arguments.
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
        # One random generator per environment after a reset with a list of seeds; otherwise None: all share one generator.
        self._own_random: list[np.random.Generator] | None = None

    def _begin(self, rows: NDArray[Any]) -> None:
        """Starts new episodes in the given environments."""
        if self._own_random is None:
            self._draw(rows, self.np_random)
        else:
            for row in rows:
                self._draw(np.array([row]), self._own_random[row])
        self._scores[rows] = 0
        self._n_steps[rows] = 0

    def _draw(self, rows: NDArray[Any], random: np.random.Generator) -> None:
        """Draws the objects, their poses and the positions of the patches for the given environments."""
        n, reach = len(rows), self._world.reach
        self._which[rows] = random.integers(len(self._world.objects), size=n)
        self._middle[rows] = random.uniform(-reach / 2, reach / 2, (n, 2))
        self._yaw[rows] = random.uniform(0, 2 * np.pi, n)
        self._patch[rows] = random.uniform(-reach, reach, (n, 2))

    def _observe(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Returns the observations and the frames of all environments."""
        frames = self._world.touch(self._which, self._patch - self._middle, self._yaw)
        shares = np.minimum(frames.reshape(self.num_envs, -1) / np.float32(5e-3), 1)
        place = (self._patch / self._world.reach).astype(np.float32)
        return np.concatenate([shares, place], 1), frames

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts new episodes; returns the observations of all environments, and a dict with the indices of the objects.

        seed: one seed makes the current and all later episodes reproducible. A sequence contains one seed per environment: the episodes of an
        environment equal those of a single environment with this seed. Default: random episodes.
        options: {"reset_mask": mask} starts new episodes only in the environments for which the mask is true; the others and their random numbers stay
        unchanged. Default: all environments.

        Raises TypeError and ValueError for invalid seeds and masks.
        """
        mask = self._mask((options or {}).get("reset_mask"))
        # As in Gymnasium, a reset without a seed continues with the current generators.
        if seed is not None:
            before = self._own_random or [self.np_random] * self.num_envs
            if isinstance(seed, Integral):
                super().reset(seed=whole("seed", seed, least=0))
                anew = [self.np_random] * self.num_envs
            else:
                anew = self._generators(seed)
            chosen = [new if is_reset else old for new, old, is_reset in zip(anew, before, mask, strict=True)]
            self._own_random = None if all(one is self.np_random for one in chosen) else chosen
        self._begin(np.flatnonzero(mask))
        self._is_over[mask] = False
        return self._observe()[0], {"object": self._which.copy()}

    def _mask(self, mask: Any) -> NDArray[np.bool_]:
        """Returns the environments to reset. Raises ValueError if the mask is not a bool array (num_envs,) with a true value."""
        if mask is None:
            return np.ones(self.num_envs, bool)
        chosen: NDArray[np.bool_] = np.asarray(mask)
        if chosen.dtype != bool or chosen.shape != (self.num_envs,) or not chosen.any():
            raise ValueError(f"options['reset_mask']: {mask!r}; a bool array ({self.num_envs},) with at least one true value")
        return chosen

    def _generators(self, seeds: int | Sequence[int | None]) -> list[np.random.Generator]:
        """Returns one random generator per environment. Raises TypeError and ValueError for invalid seeds."""
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
        """Moves and presses the patches of all environments. Environments whose episode has ended start a new episode instead, with reward 0.

        Returns observations, rewards, terminated, truncated, and a dict with the indices of the objects and the summed scores. Raises ValueError, and
        moves nothing, if an action is NaN or the actions have another shape.
        """
        actions = np.clip(np.asarray(actions, np.float64), -1, 1)
        if actions.shape != (self.num_envs, 2):
            raise ValueError(f"actions: shape {actions.shape}; ({self.num_envs}, 2)")
        if np.isnan(actions).any():
            raise ValueError(f"actions[{np.argwhere(np.isnan(actions))[0][0]}]: NaN; numbers from -1 to 1")
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
    """Single environment. Arguments, observations and actions are as for FindObjectVector, without num_envs and the first axis."""

    metadata = {"render_modes": []}

    def __init__(self, **arguments: Any) -> None:
        self._many = FindObjectVector(1, **arguments)
        self.observation_space = self._many.single_observation_space
        self.action_space = self._many.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts a new episode; returns the observation, and a dict with the index of the object.

        seed: makes the current and all later episodes reproducible.
        """
        super().reset(seed=seed, options=options)
        self._many._np_random = self.np_random
        observed, info = self._many.reset()
        return observed[0], {"object": int(info["object"][0])}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Moves and presses the patch. Returns observation, reward, terminated, truncated, and a dict with the object's index and the summed scores."""
        observed, rewards, terminated, truncated, info = self._many.step(np.asarray(action)[None])
        said = {"object": int(info["object"][0]), "scores": info["scores"][0]}
        return observed[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), said


gymnasium.register(
    id="BubbleTouch/FindObject-v0",
    entry_point="bubbletouch.env:FindObject",
    vector_entry_point="bubbletouch.env:FindObjectVector",
)
