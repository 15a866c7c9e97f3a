"""Tests of signal chains and projections."""

from __future__ import annotations

import pickle

import bubbletouch as bt
import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import refused

Floats = NDArray[np.float64]


@pytest.fixture(scope="module")
def frames(patch: bt.Patch, mug: bt.SphereUnion) -> Floats:
    offset = np.random.default_rng(3).uniform(-0.02, 0.02, (20, 2))
    return patch.press(mug, bt.touch_poses(mug, offset=offset), depth=3e-3)


def test_a_chain_without_steps_changes_nothing(patch: bt.Patch, frames: Floats) -> None:
    read = bt.Chain([], patch)(frames)
    np.testing.assert_array_equal(read, frames)
    assert read is not frames


def test_forces_are_stiffness_times_deflection(patch: bt.Patch, frames: Floats) -> None:
    chain = bt.Chain([bt.Step.force()], patch)
    assert chain.quantity == "force" and bt.Chain([], patch).quantity == "deflection"
    np.testing.assert_allclose(chain(frames), 100 * frames, rtol=1e-12)


def test_noise_is_of_a_touch_and_its_level_alone(patch: bt.Patch, frames: Floats) -> None:
    loud, quiet = (bt.Chain([bt.Step.noise(std)], patch) for std in (0.1, 0.05))
    noise = loud(frames, seed=5) - frames
    assert noise.std() == pytest.approx(0.1 * 5e-3, rel=0.02)
    np.testing.assert_allclose(quiet(frames, seed=5) - frames, noise / 2, atol=1e-15)
    np.testing.assert_array_equal(loud(frames[7], seed=5, first=7), loud(frames, seed=5)[7])
    for threads in (1, 2, 5):
        np.testing.assert_array_equal(loud(frames, seed=5, threads=threads), loud(frames, seed=5))
    assert not np.array_equal(loud(frames, seed=5), loud(frames, seed=6))


def test_gains_are_of_a_skin(patch: bt.Patch, frames: Floats) -> None:
    step = bt.Step.error("gain", gain_std=0.1)
    one, again, other = (bt.Chain([step], patch, skin_seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one(frames), again(frames, seed=9))
    touched = frames > 0
    gains = one(frames)[touched] / frames[touched]
    assert 0.05 < gains.std() < 0.15
    assert not np.allclose(other(frames), one(frames))


def test_every_sensor_error_can_be_made(patch: bt.Patch, frames: Floats) -> None:
    strong = {"adc_bits": 4, "scan_time_ms": 10, "hysteresis_full_scale": 0.1}
    before = frames.copy()
    for name, strengths in bt.Step.errors().items():
        given = {key: strong.get(key, 0.1) for key in strengths}
        chain = bt.Chain([bt.Step.error(name, **given)], patch)
        read = chain.read_touch(frames, interval=0.01)
        assert read.shape == frames.shape and np.isfinite(read).all()
        assert not np.array_equal(read, frames), name
        assert name in repr(chain.steps[0])
    np.testing.assert_array_equal(frames, before)


def test_what_came_before_a_touch_is_remembered_but_not_returned(
    patch: bt.Patch, frames: Floats
) -> None:
    chain = bt.Chain([bt.Step.error("hysteresis", hysteresis_full_scale=0.2)], patch)
    read = chain.read_touch(frames, n_before=15)
    assert read.shape == (5, 32, 48)
    np.testing.assert_array_equal(read, chain.read_touch(frames)[15:])
    assert not np.allclose(read, chain.read_touch(frames[15:]))
    # Frames of a list have the shape of the list.
    np.testing.assert_array_equal(chain.read_touch(frames.tolist(), n_before=15), read)
    np.testing.assert_array_equal(chain(frames.tolist()), chain(frames))


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        ([bt.Step.noise(-1)], "noise std: -1"),
        ([bt.Step.noise(1, "n")], "noise unit: n on frames that are still deflections"),
        ([bt.Step.force(), bt.Step.noise(1, "mm")], "noise unit: mm on frames that are forces"),
        ([bt.Step.force(), bt.Step.force()], "force"),
        ([bt.Step.smoothing(float("nan"))], "smoothing"),
    ],
)
def test_what_cannot_be_a_chain_is_refused(
    patch: bt.Patch, steps: list[bt.Step], said: str
) -> None:
    refused(said, lambda: bt.Chain(steps, patch))


def test_what_cannot_be_a_step_or_a_frame_is_refused(patch: bt.Patch, frames: Floats) -> None:
    refused("noise unit: `bar`; one of `full_scale`, `mm`, `n`", lambda: bt.Step.noise(1, "bar"))  # type: ignore[arg-type]
    refused("sensor error: `rust`; hysteresis, crosstalk", lambda: bt.Step.error("rust"))
    refused("gain: `std`; gain_std", lambda: bt.Step.error("gain", std=1))
    refused("crosstalk: 2; a fraction, 0 to 1", lambda: bt.Step.error("crosstalk", crosstalk=2))
    refused("crosstalk: half; a fraction, 0 to 1", lambda: bt.Step.error("crosstalk", crosstalk="half"))
    chain = bt.Chain([bt.Step.noise(0.1)], patch)
    refused(r"frames: shape \(20, 32, 47\); \(n, 32, 48\) or \(n, 1536\), or one frame", lambda: chain(frames[:, :, 1:]))
    spoilt = frames.copy()
    spoilt[3, 1, 2] = np.nan
    refused("frames, frame 3, taxel 50: NaN; only finite numbers", lambda: chain(spoilt))
    refused("n_before: 20 of 20 frames", lambda: chain.read_touch(frames, n_before=20))
    refused("rates: shape", lambda: chain(frames, rates=frames[0]))
    refused("time: 2; 0 to 1, or None", lambda: chain.read_touch(frames, time=2))
    refused("interval: 0; a positive number of seconds", lambda: chain.read_touch(frames, interval=0))


ENSEMBLES = [
    "gaussian", "bernoulli", "circulant", "sparse", "sbhe", "block_average", "subsample", "fourier", "identity",
]  # fmt: skip


@pytest.mark.parametrize("name", ENSEMBLES)
def test_measurements_are_phi_times_the_frame(frames: Floats, name: str) -> None:
    projection = bt.Projection(name, (32, 48), 64, seed=11)
    assert projection.n_measurements == (1536 if name == "identity" else 64)
    measured = projection(frames)
    flat = frames.reshape(20, -1)
    np.testing.assert_allclose(measured, flat @ projection.matrix.T, atol=1e-12)
    np.testing.assert_array_equal(projection(frames[4]), measured[4:5])
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(projection))(frames), measured)
    if name not in ("identity", "block_average", "fourier"):
        assert not np.array_equal(bt.Projection(name, (32, 48), 64, seed=12)(frames), measured)


def test_what_cannot_be_a_projection_is_refused(frames: Floats) -> None:
    refused("ensemble: `wavelet`; ", lambda: bt.Projection("wavelet", (32, 48), 64))
    for shape, m, said in (((32, 48), 0, "number of measurements"), ((32, 48), 2000, "number of measurements"), ((32, 48), -1, "n_measurements: -1"), ((-2, 48), 1, "shape: -2")):
        refused(said, lambda: bt.Projection("sbhe", shape, m))
    refused("frames: shape", lambda: bt.Projection("sbhe", (32, 32), 64)(frames))


@pytest.mark.parametrize("basis", ["pca", "dct"])
@pytest.mark.parametrize("solver", ["omp", "l1", "lmmse"])
def test_frames_come_back_from_measurements(basis: str, solver: str) -> None:
    patch, ball = bt.Patch.grid(16, 16, 4e-3, 5e-3), bt.SphereUnion([[0, 0, 0.033]], 0.033)
    offset = np.random.default_rng(8).uniform(-0.02, 0.02, (300, 2))
    frames = patch.press(ball, bt.touch_poses(ball, offset=offset), depth=3e-3)
    errors = []
    for m in (64, 128):
        projection = bt.Projection("gaussian", patch.shape, m, seed=1)
        rebuild = bt.Reconstructor(
            projection, frames[:250], basis=basis, solver=solver, noise=1e-5
        )
        found = rebuild(projection(frames[250:]))
        assert found["frames"].shape == (50, 16, 16)
        assert found["n_atoms"].shape == (50,) and not found["is_capped"].any()
        wrong = found["frames"] - frames[250:]
        errors.append(np.linalg.norm(wrong) / np.linalg.norm(frames[250:]))
    assert errors[1] < 0.5 * errors[0] + 0.03 and errors[1] < 0.25


def test_what_cannot_be_rebuilt_is_refused(frames: Floats) -> None:
    projection = bt.Projection("gaussian", (32, 48), 64)
    refused("basis: `fourier`; one of `dct`, `haar`", lambda: bt.Reconstructor(projection, frames, basis="fourier"))
    refused("solver: `fast`; one of `omp`, `l1`, `lmmse`", lambda: bt.Reconstructor(projection, frames, solver="fast"))
    refused("noise: -1; zero or a positive number", lambda: bt.Reconstructor(projection, frames, noise=-1))
    refused("training: shape", lambda: bt.Reconstructor(projection, frames[:, :, 1:]))
    rebuild = bt.Reconstructor(projection, frames)
    refused(r"measurements: shape \(2, 63\); \(n, 64\)", lambda: rebuild(np.zeros((2, 63))))
    refused("measurements: NaN", lambda: rebuild(np.full((2, 64), np.nan)))


def test_frames_of_a_grid_have_its_rows_and_columns() -> None:
    patch = bt.Patch.grid(6, 4, 2e-3, 5e-3)
    chain = bt.Chain([bt.Step.smoothing(4e-3)], patch)
    projection = bt.Projection("gaussian", patch.shape, 5)
    frames = np.random.default_rng(1).uniform(0, 1e-3, (3, *patch.shape))
    flat = chain(frames.reshape(3, 24))
    np.testing.assert_array_equal(chain(frames).reshape(3, 24), flat)
    np.testing.assert_array_equal(chain(frames[0]).ravel(), flat[0])
    for turned in (frames.swapaxes(1, 2), frames[0].T, frames.reshape(3, 2, 12)):
        for call in (chain, chain.read_touch, projection):
            refused(r"frames: shape .*\(n, 6, 4\) or \(n, 24\)", lambda: call(turned))
    refused("rates: shape", lambda: chain(frames, rates=frames.swapaxes(1, 2)))
