"""Gymnasium environments with the skin in their observations."""

from __future__ import annotations

import warnings

import bubbletouch as bt
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
gymnasium = pytest.importorskip("gymnasium")
from bubbletouch.mujoco import SkinObservation  # noqa: E402
from gymnasium import spaces  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402
from hands import BOX, with_object  # noqa: E402

from conftest import refused


class Grasp(gymnasium.Env):
    """The gripper of objects/robots closes on a box."""

    def __init__(self, dict_space: bool = False) -> None:
        self.model = with_object("gripper", BOX, 'pos="0.003 0.004 0.115"')
        self.model.opt.gravity[:] = 0.0
        self.data = mujoco.MjData(self.model)
        self.action_space = spaces.Box(0.0, 0.04, (1,), np.float32)
        box = spaces.Box(-np.inf, np.inf, (self.model.nq,), np.float64)
        self.dict_space = dict_space
        self.observation_space = spaces.Dict({"q": box}) if dict_space else box

    def observe(self):
        q = self.data.qpos.copy()
        return {"q": q} if self.dict_space else q

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:2] = 0.04
        self.data.qpos[2] += self.np_random.uniform(-1e-3, 1e-3)
        mujoco.mj_forward(self.model, self.data)
        return self.observe(), {}

    def step(self, action):
        self.data.ctrl[:] = action
        mujoco.mj_step(self.model, self.data, nstep=20)
        return self.observe(), 0.0, False, False, {}


def layout() -> dict[str, bt.Patch]:
    return {name: bt.Patch.grid(16, 10, 2e-3, 4e-3, stiffness=300.0) for name in ("left_pad", "right_pad")}


@pytest.mark.parametrize("dict_space", [False, True])
@pytest.mark.parametrize("match", [None, "normal_force"])
def test_a_checked_environment_sees_the_skin(dict_space: bool, match) -> None:
    env = SkinObservation(Grasp(dict_space), layout(), match=match)
    with warnings.catch_warnings():
        # The checker advises to check the environment without its wrapper.
        warnings.simplefilter("ignore", UserWarning)
        check_env(env, skip_render_check=True)
    observation, _ = env.reset(seed=1)
    for _ in range(30):
        observation, *_ = env.step(np.zeros(1, np.float32))
        assert env.observation_space.contains(observation)
    skin = observation["skin"] if dict_space else observation[-320:]
    assert skin.dtype == (np.float32 if dict_space else np.float64) and skin.shape == (320,)
    read = env.skin.read(env.unwrapped.data, output="force", match=match)
    assert np.array_equal(skin, read.astype(skin.dtype)) and skin.any()
    before = observation["q"] if dict_space else observation[:-320]
    assert np.array_equal(before, env.unwrapped.observe()["q"] if dict_space else env.unwrapped.observe())


def test_a_stock_environment_has_a_skin_on_a_body() -> None:
    patch = bt.Patch.sphere_cap(0.02, 1.5, 5e-3, 4e-3)
    pytest.importorskip("imageio")  # of gymnasium[mujoco]
    env = gymnasium.make("Pusher-v5")
    n = env.observation_space.shape[0]
    env = SkinObservation(env, {"tips_arm": patch}, output="deflection")
    observation, _ = env.reset(seed=0)
    assert observation.shape == (n + patch.n_taxels,) and env.observation_space.contains(observation)
    copies = [env.step(np.zeros(7, np.float32))[0] for _ in range(3)]
    assert all(env.observation_space.contains(observation) for observation in copies)


def test_an_environment_is_made_again_and_says_what_the_taxels_do_not_carry() -> None:
    gymnasium.register("BubbletouchGrasp-v0", Grasp)
    env = SkinObservation(gymnasium.make("BubbletouchGrasp-v0", disable_env_checker=True), layout(), match="normal_force")
    again = env.spec.make(disable_env_checker=True)
    assert isinstance(again, SkinObservation)
    for made in (env, again):
        observation, info = made.reset(seed=3)
        assert info["skin"]["contacts"].shape == (2, 2) and info["skin"]["residuals"].shape == (2, len(made.skin.bodies))
        for _ in range(30):
            observation, _, _, _, info = made.step(np.zeros(1, np.float32))
        assert info["skin"]["contacts"][:, 0].any()
    # Taxels without stiffness carry little, which is said once.
    soft = {name: bt.Patch.grid(16, 10, 2e-3, 4e-3, stiffness=0.5) for name in ("left_pad", "right_pad")}
    env = SkinObservation(Grasp(), soft, match="normal_force")
    with pytest.warns(UserWarning, match="the taxels do not carry all contact forces"):
        env.reset(seed=3)
        for _ in range(30):
            info = env.step(np.zeros(1, np.float32))[-1]
    assert (info["skin"]["residuals"] > 1.0).any() and (info["skin"]["contacts"][:, 1] > 100).any()
    # An environment that compiles its model again has a new skin.
    inner = env.unwrapped
    inner.model = with_object("gripper", BOX.replace("0.03", "0.02", 1), 'pos="0.003 0.004 0.115"')
    inner.data = mujoco.MjData(inner.model)
    before = env.skin
    env.reset(seed=3)
    assert env.skin is not before


def test_other_environments_and_spaces_are_refused() -> None:
    refused("env: CartPoleEnv; an environment with MuJoCo", lambda: SkinObservation(gymnasium.make("CartPole-v1"), layout()))
    refused("key: 'q'; a name", lambda: SkinObservation(Grasp(True), layout(), key="q"))
    refused('output: \'area\'; "deflection" or "force"', lambda: SkinObservation(Grasp(), layout(), output="area"))
    env = Grasp()
    env.observation_space = spaces.Box(0, 1, (4, 4))
    refused("observation_space: Box", lambda: SkinObservation(env, layout()))
