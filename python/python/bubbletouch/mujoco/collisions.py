"""Pairs of patch and geom that can touch each other, by MuJoCo's rules for collisions."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray


def carrying_bodies(model: mujoco.MjModel, bodies: Sequence[int]) -> list[int]:
    """Returns the body with collision geoms to which each patch belongs, given the bodies of the patches' frames.

    If a body has no collision geoms, its patches belong to the nearest ancestor that has some, provided that no joint lies between. Otherwise, they
    belong to the body itself.
    """
    solid = set(model.geom_bodyid[_colliding(model)].tolist())

    def carrying(body: int) -> int:
        weld, at = model.body_weldid[body], body
        while at not in solid and at != 0 and at != weld:
            at = int(model.body_parentid[at])
        return at if at in solid else body

    return [carrying(body) for body in bodies]


def touching_geoms(model: mujoco.MjModel, bodies: Sequence[int]) -> NDArray[np.bool_]:
    """Returns which geoms can touch the patches on the given bodies, (n_patches, ngeom).

    A geom can touch a patch if MuJoCo can create a contact between the geom and a geom of the patch's body. These rules apply: contype and conaffinity,
    `<pair>`, `<exclude>`, and the filters of welded bodies and of parent and child. If the body has no collision geoms, every collision geom of another
    body passes the rule of contype and conaffinity. Unlike in MuJoCo, bodies that are fixed to the world can touch each other, unless they belong to one tree.
    """
    return np.array([_touching(model, body) for body in bodies]).reshape(len(bodies), model.ngeom)


def geoms_of_others(model: mujoco.MjModel, bodies: Sequence[int]) -> NDArray[np.bool_]:
    """Returns which geoms are on other bodies than the patches, (n_patches, ngeom). Geoms of the world body count as others for all patches."""
    of_geoms: NDArray[np.intp] = model.geom_bodyid
    are_others: NDArray[np.bool_] = (of_geoms == 0) | (of_geoms != np.array(bodies, dtype=np.intp)[:, None])
    return are_others


def _touching(model: mujoco.MjModel, body: int) -> NDArray[np.bool_]:
    contype, conaffinity, others = model.geom_contype, model.geom_conaffinity, model.geom_bodyid
    own = np.flatnonzero((others == body) & _colliding(model))
    can: NDArray[np.bool_] = _colliding(model)
    if len(own):
        can = ((contype[own, None] & conaffinity) | (contype & conaffinity[own, None])).any(axis=0)
    weld, parent = model.body_weldid, model.body_weldid[model.body_parentid[model.body_weldid]]
    is_other = others != body
    # Different trees that are fixed to the world can touch, as their poses may be set by hand.
    is_other &= (weld[others] != weld[body]) | (weld[body] == 0) & (model.body_rootid[others] != model.body_rootid[body])
    if weld[body] != 0:
        if not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT:
            is_relative = (weld[others] == parent[body]) | (parent[others] == weld[body])
            is_other &= (weld[others] == 0) | ~is_relative
    for signature in model.exclude_signature.tolist():
        pair = (signature >> 16, signature & 0xFFFF)
        if body in pair:
            is_other &= others != pair[pair[0] == body]
    can &= is_other
    # Pairs that the model lists collide in spite of all filters.
    for first, second in zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True):
        for one, other in ((first, second), (second, first)):
            can[other] |= others[one] == body and others[other] != body
    return can


def _colliding(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Returns which geoms take part in collisions, (ngeom,)."""
    colliding: NDArray[np.bool_] = (model.geom_contype | model.geom_conaffinity) != 0
    colliding[model.pair_geom1] = colliding[model.pair_geom2] = True
    return colliding
