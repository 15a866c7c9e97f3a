"""Tests of the Gymnasium environments."""

from __future__ import annotations

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")
import bubbletouch as bt
from bubbletouch.env import FindObject, FindObjectVector
from gymnasium.utils.env_checker import check_env

from conftest import refused


@pytest.fixture(scope="module")
def many() -> FindObjectVector:
    return FindObjectVector(64)


def test_gymnasiums_checks() -> None:
    environment = gymnasium.make("BubbleTouch/FindObject-v0")
    check_env(environment.unwrapped, skip_render_check=True)


def test_where_objects_lie_is_what_touch_poses_says(many: FindObjectVector) -> None:
    world = many._world
    random = np.random.default_rng(0)
    offset, yaw = random.uniform(-0.03, 0.03, (40, 2)), random.uniform(0, 6, 40)
    for number, thing in enumerate(world.objects):
        which = np.full(40, number)
        got, want = world._poses(which, offset, yaw), bt.touch_poses(thing, offset=offset, yaw=yaw)
        np.testing.assert_allclose(got[:, :3], want[:, :3], atol=1e-12)
        same = np.abs((got[:, 3:] * want[:, 3:]).sum(axis=1))
        np.testing.assert_allclose(same, 1, atol=1e-12)
        assert world.patch.press(thing, got, depth=3e-3).any()


def test_episodes_are_the_same_again_with_the_same_seed(many: FindObjectVector) -> None:
    actions = np.random.default_rng(1).uniform(-1, 1, (30, 64, 2)).astype(np.float32)
    runs = []
    for _ in range(2):
        observed, _ = many.reset(seed=4)
        run = [observed, *(many.step(action) for action in actions)]
        runs.append(run)
    np.testing.assert_array_equal(runs[0][0], runs[1][0])
    for one, other in zip(runs[0][1:], runs[1][1:], strict=True):
        for a, b in zip(one[:4], other[:4], strict=True):
            np.testing.assert_array_equal(a, b)


def test_episodes_end_and_begin_anew(many: FindObjectVector) -> None:
    observed, _ = many.reset(seed=2)
    assert many.observation_space.contains(observed)
    random = np.random.default_rng(3)
    over = np.zeros(64, bool)
    ends = right = 0
    for _ in range(100):
        observed, rewards, terminated, truncated, info = many.step(
            random.uniform(-1, 1, (64, 2)).astype(np.float32)
        )
        assert many.observation_space.contains(observed)
        assert (rewards[over] == 0).all() and not (terminated & truncated).any()
        assert not (terminated | truncated)[over].any()
        ends += terminated.sum()
        right += (rewards[terminated] > 0).sum()
        over = terminated | truncated
    assert ends > 100
    # The classifier is better than chance (1/4) for four objects touched at random places.
    assert right / ends > 0.75


def test_one_is_as_many() -> None:
    single, many = FindObject(), FindObjectVector(1)
    first, _ = single.reset(seed=8)
    np.testing.assert_array_equal(first, many.reset(seed=8)[0][0])
    action = np.array([0.5, -0.5], np.float32)
    for _ in range(5):
        one, several = single.step(action), many.step(action[None])
        np.testing.assert_array_equal(one[0], several[0][0])
        assert one[1] == several[1][0]


def test_what_cannot_be_told_apart_is_refused() -> None:
    refused("n_taxels: 15; an even number", lambda: FindObject(n_taxels=15))
    refused("objects: 1; at least two", lambda: FindObject(objects=["mug"]))
    refused("object: `mugg`; perhaps mug", lambda: FindObject(objects=["mug", "mugg"]))


@pytest.mark.parametrize(
    ("arguments", "error", "said"),
    [
        ({"reach": 0}, ValueError, "reach: 0; a finite number above 0"),
        ({"reach": float("nan")}, ValueError, "reach: NaN"),
        ({"confidence": float("nan")}, ValueError, "confidence: NaN; a finite number, at least 0"),
        ({"confidence": -1.0}, ValueError, "confidence: -1.0"),
        ({"max_steps": 0}, ValueError, "max_steps: 0; at least 1"),
        ({"max_steps": 2.5}, ValueError, "max_steps: 2.5; a whole number"),
        ({"n_taxels": 16.5}, ValueError, "n_taxels: 16.5; a whole number"),
        ({"training_seed": -1}, ValueError, "training_seed: -1; at least 0"),
        ({"training_seed": "1"}, TypeError, "training_seed: '1'; a whole number"),
    ],
)
def test_numbers_out_of_their_range_are_refused(arguments, error, said) -> None:  # type: ignore[no-untyped-def]
    refused(said, lambda: FindObject(**arguments), error)
    refused("num_envs: 0; at least 1", lambda: FindObjectVector(0))


def test_each_environment_has_the_episodes_of_its_own_seed() -> None:
    several, single = FindObjectVector(3), FindObjectVector(1)
    actions = np.random.default_rng(1).uniform(-1, 1, (40, 3, 2)).astype(np.float32)
    first, _ = several.reset(seed=[3, 4, 5])
    steps = [several.step(action) for action in actions]
    assert any(step[2].any() or step[3].any() for step in steps), "an episode begins anew"
    for number, seed in enumerate([3, 4, 5]):
        alone, _ = single.reset(seed=seed)
        np.testing.assert_array_equal(first[number], alone[0])
        for action, step in zip(actions, steps, strict=True):
            one = single.step(action[[number]])
            np.testing.assert_array_equal(step[0][number], one[0][0])
            assert step[1][number] == one[1][0]
    again, _ = several.reset(seed=np.array([3, 4, 5]))
    np.testing.assert_array_equal(again, first)
    other, _ = several.reset(seed=(3, None, 6))
    np.testing.assert_array_equal(other[0], first[0])
    assert (other[1:] != first[1:]).any(axis=1).all()
    refused("seed: 2 seeds; one for each of 3 environments", lambda: several.reset(seed=[3, 4]))
    refused(r"seed\[1\]: 1.5; a whole number", lambda: several.reset(seed=[3, 1.5, 4]))
    refused("seed: 1.5; a whole number, one for each of 3", lambda: several.reset(seed=1.5), TypeError)
    refused("seed: -1; at least 0", lambda: several.reset(seed=-1))


def test_vectors_are_made_by_name() -> None:
    vector = gymnasium.make_vec(
        "BubbleTouch/FindObject-v0", num_envs=3, vectorization_mode="vector_entry_point"
    )
    assert vector.reset(seed=0)[0].shape == (3, 258)
    refused(r"actions: shape \(2, 2\); \(3, 2\)", lambda: vector.step(np.zeros((2, 2), np.float32)))


def test_a_reset_mask_resets_only_the_environments_of_the_mask(many: FindObjectVector) -> None:
    actions = np.random.default_rng(2).uniform(-1, 1, (6, 64, 2)).astype(np.float32)
    mask = np.arange(64) % 3 == 0
    runs = []
    for options in (None, {"reset_mask": mask}):
        many.reset(seed=list(range(64)))
        for action in actions[:3]:
            many.step(action)
        before = many._patch.copy(), many._n_steps.copy(), many._scores.copy()
        if options:
            observed, info = many.reset(seed=list(range(100, 164)), options=options)
            assert observed.shape == (64, 258) and len(info["object"]) == 64
            for now, then in zip((many._patch, many._n_steps, many._scores), before, strict=True):
                assert np.array_equal(now[~mask], then[~mask])
            assert not many._n_steps[mask].any() and not many._scores[mask].any()
        runs.append([many.step(action)[0][~mask] for action in actions[3:]])
    # The other environments go on as without the reset.
    np.testing.assert_array_equal(*runs)
    anew = FindObjectVector(64)
    expected = anew.reset(seed=list(range(100, 164)))[0][mask]
    np.testing.assert_array_equal(many.reset(seed=list(range(100, 164)), options={"reset_mask": mask})[0][mask], expected)
    for wrong in (np.zeros(64, bool), mask[:3], mask.astype(int)):
        refused("reset_mask", lambda: many.reset(options={"reset_mask": wrong}))


def test_an_action_that_is_no_number_is_refused_and_moves_nothing(many: FindObjectVector) -> None:
    many.reset(seed=3)
    actions = np.zeros((64, 2), np.float32)
    actions[5, 1] = np.nan
    before = many._patch.copy()
    refused(r"actions\[5\]: NaN", lambda: many.step(actions))
    assert np.array_equal(many._patch, before)
    assert np.isfinite(many.step(np.zeros((64, 2), np.float32))[0]).all()
