"""Tests of presses with gradients for PyTorch."""

from __future__ import annotations

import bubbletouch as bt
import numpy as np
import pytest

torch = pytest.importorskip("torch")

from bubbletouch import autograd  # noqa: E402

from conftest import refused


@pytest.fixture(scope="module")
def poses() -> object:
    """Returns poses of an egg (two spheres) near the middle of the patch. No taxel is near a kink of the deflection."""
    turns = np.array([[0.9, 0.1, -0.2, 0.3], [0.5, -0.5, 0.4, 0.6], [1.0, 0.0, 0.0, 0.0]])
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    at = np.array([[1e-3, 2e-3, 0.018], [-3e-3, 1e-3, 0.017], [0.5e-3, -0.2e-3, 0.0185]])
    return torch.tensor(np.concatenate([at, turns], axis=1), dtype=torch.float64, requires_grad=True)


EGG = bt.SphereUnion([[0, 0, 0], [0.004, 0.002, 0.001]], [0.02, 0.019])
EGG_RADII = torch.tensor(EGG.radii)
PATCH = bt.Patch.grid(8, 6, 4e-3, 50e-3)
GOALS: list[dict[str, float]] = [{}, {"travel": 2e-3}, {"depth": 3e-3}, {"force": 2.0}]


@pytest.mark.parametrize("goal", GOALS, ids=lambda goal: next(iter(goal), "pose"))
def test_gradcheck(poses: object, goal: dict[str, float]) -> None:
    def press(at: object) -> object:
        return autograd.press(PATCH, EGG, at, **goal)

    frames = press(poses)
    assert np.array_equal(frames.detach().numpy(), PATCH.press(EGG, poses.detach().numpy(), **goal))
    assert (frames > 0).sum() > 20
    assert torch.autograd.gradcheck(press, (poses,), eps=1e-7, atol=1e-7, rtol=1e-5)
    one = poses.detach()[0].clone().requires_grad_()
    assert torch.autograd.gradcheck(press, (one,), eps=1e-7, atol=1e-7, rtol=1e-5)


@pytest.mark.parametrize("goal", [{}, {"travel": 2e-3}], ids=["pose", "travel"])
def test_gradcheck_of_spheres(poses: object, goal: dict[str, float]) -> None:
    centers, radii = (torch.tensor(numbers, requires_grad=True) for numbers in (EGG.centers, EGG.radii))
    patch = bt.Patch.grid(8, 6, 4e-3, 7e-3)

    def press(centers: object, radii: object, at: object) -> object:
        return autograd.press(patch, (centers, radii), at, **goal)

    frames = press(centers, radii, poses)
    assert np.array_equal(frames.detach().numpy(), patch.press(EGG, poses.detach().numpy(), **goal))
    assert (frames == 7e-3).sum() > 3 and ((frames > 0) & (frames < 7e-3)).sum() > 10, "some at their stroke, others not"
    assert torch.autograd.gradcheck(press, (centers, radii, poses), eps=1e-7, atol=1e-7, rtol=1e-5)
    assert torch.autograd.gradcheck(lambda centers: press(centers, EGG_RADII, poses.detach()[0]), (centers,), eps=1e-7, atol=1e-7)
    gradients = torch.autograd.grad(frames.sum(), (centers, radii))
    assert all((gradient.abs() > 1).any() for gradient in gradients), "both spheres are touched somewhere"


def test_descent_finds_the_radius() -> None:
    at = torch.tensor([0.0, 0.0, 0.017, 1.0, 0.0, 0.0, 0.0], dtype=torch.float64)
    centers = torch.tensor(EGG.centers)
    felt = autograd.press(PATCH, (centers, EGG_RADII), at)
    guess = torch.full((2,), 0.0195, dtype=torch.float64, requires_grad=True)
    for _ in range(200):
        loss = ((autograd.press(PATCH, (centers, guess), at) - felt) ** 2).sum()
        (gradient,) = torch.autograd.grad(loss, guess)
        with torch.no_grad():
            guess -= 0.02 * gradient
    assert (guess - EGG_RADII).abs().max() < 0.01e-3


def test_descent_finds_the_place() -> None:
    truth = torch.tensor([1e-3, -2e-3, 0.017, 1.0, 0.0, 0.0, 0.0], dtype=torch.float64)
    felt = autograd.press(PATCH, EGG, truth)
    guess = torch.tensor([0.0, 0.0, 0.018, 1.0, 0.0, 0.0, 0.0], dtype=torch.float64, requires_grad=True)
    for _ in range(200):
        loss = ((autograd.press(PATCH, EGG, guess) - felt) ** 2).sum()
        (gradient,) = torch.autograd.grad(loss, guess)
        with torch.no_grad():
            guess[:3] -= 0.02 * gradient[:3]
    assert torch.linalg.norm(guess[:3] - truth[:3]) < 0.1e-3


def test_bad_poses_are_refused() -> None:
    for bad in (torch.zeros(4, 4, dtype=torch.float64), torch.zeros(7), torch.zeros(1, 2, 7, dtype=torch.float64)):
        refused("poses: .*float64", lambda: autograd.press(PATCH, EGG, bad))
    refused("quaternion", lambda: autograd.press(PATCH, EGG, torch.zeros(7, dtype=torch.float64)))
    centers, radii = torch.tensor(EGG.centers), torch.tensor(EGG.radii, requires_grad=True)
    at = torch.tensor([0, 0, 0.02, 1, 0, 0, 0], dtype=torch.float64)
    refused("centers: .*float64", lambda: autograd.press(PATCH, (centers[:, :2], radii), at))
    refused("radii: .*float64", lambda: autograd.press(PATCH, (centers, radii[:1]), at))
    refused("with a depth or a force", lambda: autograd.press(PATCH, (centers, radii), at, depth=1e-3))
    # Without gradients with respect to spheres, a depth is allowed.
    assert autograd.press(PATCH, (centers, radii.detach()), at, depth=1e-3).max() > 0
