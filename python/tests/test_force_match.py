"""Presses of placed patches to given normal forces: in the core, and to the contact forces of MuJoCo."""

from __future__ import annotations

import tracemalloc

import bubbletouch as bt
import numpy as np
import pytest

from conftest import refused

STIFFNESS = 300.0
UNIT = [1.0, 0.0, 0.0, 0.0]
BALL = bt.SphereUnion(np.zeros((1, 3)), [0.02])


def poses(*places: list[float]) -> np.ndarray:
    return np.array([[*place, *UNIT] for place in places])


def grid() -> bt.Patch:
    return bt.Patch.grid(10, 12, 2e-3, 4e-3, stiffness=STIFFNESS)


@pytest.mark.parametrize("kind", ["grid", "hexagonal", "each", "cap"])
@pytest.mark.parametrize("thing", ["ball", "box"])
def test_a_pair_has_the_wanted_force_and_the_frame_of_the_travelled_pose(kind: str, thing: str, box: bt.Mesh) -> None:
    flat = grid()
    if kind == "hexagonal":
        patch = bt.Patch.hexagonal(10, 12, 2e-3, 4e-3, stiffness=STIFFNESS)
    elif kind == "each":
        stiffness = np.linspace(100, 500, flat.n_taxels)
        patch = bt.Patch.from_arrays(flat.centers, flat.axes, stroke=4e-3, taxel_radius=1e-3, stiffness=stiffness)
    elif kind == "cap":
        patch = bt.Patch.sphere_cap(8e-3, 1.4, 1.5e-3, 3e-3, stiffness=STIFFNESS)
    else:
        patch = flat
    body, height = (BALL, 0.02) if thing == "ball" else (box, 0.0)
    lift = 8e-3 if kind == "cap" else 0.0
    skin = bt.Skin([patch], [body])
    # One step away from the contact, and one step too deep.
    for gap in (1.5e-3, -1.5e-3):
        place = poses([1e-3, 0.5e-3, lift + height + gap])
        forces, travels, residuals = np.empty((1, 1)), np.empty((1, 1)), np.empty((1, 1))
        read = skin.read(
            poses([0, 0, 0]), place, forces=[[2.5]], pair_forces=forces, travels=travels, residuals=residuals
        )
        total = float((np.broadcast_to(patch.stiffness, read.shape) * read).sum())
        assert abs(total - 2.5) < 1e-9 and abs(forces[0, 0] - total) < 1e-12, (total, forces)
        assert abs(residuals[0, 0]) < 1e-9 and 0 < abs(travels[0, 0]) < 6e-3
        moved = place.copy()
        moved[0, 2] -= travels[0, 0]
        assert np.abs(skin.read(poses([0, 0, 0]), moved) - read).max() < 1e-12
    if kind == "grid":
        alone, contacts = patch.press(body, place[0], force=2.5, contacts=True)
        assert np.abs(alone.ravel() - read).max() < 1e-12 and abs(contacts.travel[0] - travels[0, 0]) < 1e-12


def test_a_curved_skin_is_pressed_against_the_direction_of_the_force() -> None:
    cap = bt.Patch.sphere_cap(8e-3, 1.5, 1.5e-3, 3e-3, stiffness=STIFFNESS)
    skin = bt.Skin([cap], [BALL])
    aside = np.array([np.sin(1.1), 0.0, np.cos(1.1)])
    place = poses(list(0.0285 * aside))
    travels = np.empty((1, 1))
    read = skin.read(poses([0, 0, 0]), place, forces=[[2.0]], directions=aside[None, None], travels=travels)
    assert abs(STIFFNESS * read.sum() - 2.0) < 1e-9 and abs(travels[0, 0]) < 2e-3
    moved = place.copy()
    moved[0, :3] -= travels[0, 0] * aside
    assert np.abs(skin.read(poses([0, 0, 0]), moved) - read).max() < 1e-12


def test_pairs_without_force_at_their_pose_and_out_of_reach(box: bt.Mesh) -> None:
    skin = bt.Skin([grid(), grid()], [BALL, box])
    at, bodies = poses([0, 0, 0], [0.1, 0, 0]), poses([0, 0, 0.02], [0.1, 0, 0.0])
    plain = skin.read(at, bodies)
    assert plain[:120].any() and plain[120:].any()
    forces, travels, residuals = np.empty((2, 2)), np.empty((2, 2)), np.empty((2, 2))
    asked = dict(pair_forces=forces, travels=travels, residuals=residuals)

    # NaN reads at the pose, and 0 does not touch although ball and patch overlap.
    read = skin.read(at, bodies, forces=[[0.0, np.nan], [np.nan, np.nan]], **asked)
    assert not read[:120].any() and np.array_equal(read[120:], plain[120:])
    assert np.isnan(travels[0, 0]) and not travels[1].any() and not residuals.any()
    assert forces[0, 0] == 0.0 and abs(forces[1, 1] - STIFFNESS * plain[120:].sum()) < 1e-12

    # A force that is too large, and a body that is too far away.
    largest = STIFFNESS * 4e-3 * 120
    read = skin.read(at, bodies, forces=[[1e3, 0.0], [0.5, 0.0]], **asked)
    assert np.abs(travels[:, 0] - 6e-3).max() < 1e-15  # stroke and diameter
    assert forces[0, 0] < largest and abs(residuals[0, 0] - (1e3 - forces[0, 0])) < 1e-9
    assert forces[1, 0] == 0.0 and residuals[1, 0] == 0.5
    read = skin.read(at, bodies, forces=[[0.0, 0.0], [0.0, 2 * largest]], reach=0.05, **asked)
    # All taxels are at their stroke, and the box of 20 mm is not yet behind the substrate.
    assert abs(residuals[1, 1] - largest) < 1e-9 and abs(travels[1, 1] - 0.024) < 1e-12
    assert np.abs(read[120:] - 4e-3).max() == 0.0

    # A patch far too deep in a body goes back out of the reach.
    deep = poses([0, 0, 0.0], [0.1, 0, -0.0135])
    for far in (0.002, 6e-3):
        read = skin.read(at, deep, forces=[[1.0, 0.0], [0.0, 1.0]], reach=far, **asked)
        assert np.abs(np.diag(residuals)).max() < 1e-9 and travels[0, 0] < -0.019 and travels[1, 1] < -0.0135

    for wrong, message in [
        (dict(forces=[[1.0, 2.0]]), "shape"),
        (dict(forces=[[-1.0, 0], [0, 0]]), "forces, pair 0: -1"),
        (dict(forces=[[0, 0], [0, np.inf]]), "forces, pair 3: inf"),
        (dict(forces=np.ones((2, 2)), directions=np.zeros((2, 2, 3))), "directions, pair 0"),
        (dict(directions=np.zeros((2, 2, 3))), "directions without forces"),
        (dict(reach=0.0), "reach: 0"),
        (dict(residuals=np.empty((2, 3))), "residuals: shape"),
        (dict(contacts=np.empty((2, 2))), "contacts: .*int64"),
    ]:
        refused(message, lambda: skin.read(at, bodies, **wrong))


def test_a_thin_plate_deep_in_the_skin_does_not_slip_behind_it() -> None:
    disc = bt.Patch.disc(0.01, 2e-3, 4e-3, stiffness=STIFFNESS)
    corners = np.array([[x, y, z] for x in (-20, 20) for y in (-20, 20) for z in (0, 1)]) * 1e-3
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]  # fmt: skip
    skin = bt.Skin([disc], [bt.Mesh(corners, faces)])
    for height in (-2.9e-3, -1e-3, 2e-3):
        for force in (0.5, 0.99 * STIFFNESS * 4e-3 * disc.n_taxels):
            residuals = np.empty((1, 1))
            skin.read(poses([0, 0, 0]), poses([0, 0, height]), forces=[[force]], residuals=residuals)
            assert abs(residuals[0, 0]) < 1e-9, (height, force, residuals)


@pytest.mark.parametrize("kind", ["grid", "disc"])
def test_the_bodies_of_one_object_press_together(kind: str, box: bt.Mesh) -> None:
    patch = grid() if kind == "grid" else bt.Patch.disc(0.012, 2e-3, 4e-3, stiffness=STIFFNESS)
    bodies = [box, BALL, box]  # the balls and boxes share taxels
    at, places = poses([0, 0, 0]), poses([0.01, 0, 1e-3], [0, 0, 0.0195], [-0.03, 0, 5e-4])
    apart, together = bt.Skin([patch], bodies), bt.Skin([patch], bodies, objects=[0, 1, 0])
    plain = apart.read(at, places)
    assert np.array_equal(plain, together.read(at, places))
    for gap in (0.0, 2e-3, -5e-3):
        places[:, 2] += gap
        forces, travels, residuals = (np.empty((1, 2)) for _ in range(3))
        arrays = dict(pair_forces=forces, travels=travels, residuals=residuals)
        read = together.read(at, places, forces=[[3.0, 0.0]], **arrays)
        # The boxes alone, moved by the travel, have the whole force.
        moved = places.copy()
        moved[:, 2] -= travels[0, 0]
        moved[1, 2] = 1.0
        assert abs(STIFFNESS * read.sum() - 3.0) < 1e-9 and np.abs(residuals).max() < 1e-9
        assert np.abs(apart.read(at, moved) - read).max() < 1e-12
        one = bt.Skin([patch], bodies, objects=[0, 0, 0])
        read = one.read(at, places, forces=[[3.0]])
        assert abs(STIFFNESS * read.sum() - 3.0) < 1e-9
    for wrong, message in [([0, 1], "2 indices; one for each of 3"), ([0, 2, 0], "no body of object 1"), ([1, 1, 2], "object 0")]:
        refused(f"objects: .*{message}", lambda: bt.Skin([patch], bodies, objects=wrong))


def test_a_batch_is_its_sets_one_by_one_with_all_results(box: bt.Mesh) -> None:
    rng = np.random.default_rng(1)
    skin = bt.Skin([grid(), bt.Patch.disc(0.01, 2e-3, 4e-3)], [BALL, box])
    n = 4
    at = np.tile(poses([0, 0, 0], [0.03, 0, 0]), (n, 1, 1))
    bodies = np.tile(poses([0, 0, 0.02], [0.03, 0, 0.0]), (n, 1, 1))
    bodies[..., :3] += rng.uniform(-1e-3, 1e-3, (n, 2, 3))
    forces = rng.uniform(0, 2, (n, 2, 2)) * np.eye(2)
    shapes = dict(out=(n, skin.n_taxels), wrenches=(n, 2, 6), pair_forces=(n, 2, 2), residuals=(n, 2, 2), travels=(n, 2, 2))
    batch = {name: np.empty(shape) for name, shape in shapes.items()}
    counts = np.empty((n, 2, 2), np.int64)
    assert skin.read(at, bodies, forces=forces, contacts=counts, **batch) is batch["out"]
    assert np.abs(batch["pair_forces"] - forces).max() < 1e-9 and counts.all(axis=0)[:, 0].all()
    for number in range(n):
        one = {name: np.empty(shape[1:]) for name, shape in shapes.items()}
        of_one = np.empty((2, 2), np.int64)
        skin.read(at[number], bodies[number], forces=forces[number], contacts=of_one, **one)
        for name, array in one.items():
            assert np.array_equal(array, batch[name][number], equal_nan=True), name
        first = one["out"][:120]
        assert np.array_equal(of_one, counts[number]) and of_one[0, 0] == np.count_nonzero(first)
        assert of_one[0, 1] == np.count_nonzero(first >= 4e-3)


def test_one_patch_and_one_body_need_no_axis_and_out_no_memory() -> None:
    patch = bt.Patch.grid(64, 64, 1e-3, 3e-3)
    skin, ball = bt.Skin([patch], [BALL]), np.array([0, 0, 0.02, *UNIT])
    once = skin.read(np.eye(4), ball)
    assert once.any() and np.array_equal(once, skin.read(poses([0, 0, 0]), ball[None]))
    assert np.array_equal(once, skin.read((np.zeros(3), np.eye(3)), (ball[:3], ball[3:])))
    refused("k = 2 poses", lambda: bt.Skin([patch] * 2, [BALL]).read(np.eye(4), ball))
    out, forces, residuals = np.empty(patch.n_taxels), np.ones((1, 1)), np.empty((1, 1))
    arrays = dict(out=out, forces=forces, residuals=residuals)
    skin.read(ball, ball, **arrays)
    tracemalloc.start()
    for _ in range(100):
        skin.read(ball, ball, **arrays)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 4000 < out.nbytes, most
