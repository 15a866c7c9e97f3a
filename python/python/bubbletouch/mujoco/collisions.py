"""Pairs of patch and geom that can touch each other, by MuJoCo's rules for collisions."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray


def touching_geoms(model: mujoco.MjModel, bodies: Sequence[int]) -> NDArray[np.bool_]:
    """Returns which geoms can touch the patches on the given bodies, (n_patches, ngeom).

    A geom can touch a patch if MuJoCo can create a contact between the geom and a geom of the patch's body. These rules apply: contype and conaffinity,
    `<pair>`, `<exclude>`, and the filters of welded bodies and of parent and child. If the body has no collision geoms, the geoms of all bodies that are
    welded to it count as its own. If there are none either, every collision geom passes the rule of contype and conaffinity. Unlike in MuJoCo,
    bodies that are fixed to the world can touch each other, unless they belong to one tree.
    """
    return np.array([_touching(model, body) for body in bodies]).reshape(len(bodies), model.ngeom)


def geoms_of_others(model: mujoco.MjModel, bodies: Sequence[int]) -> NDArray[np.bool_]:
    """Returns which geoms are not welded to the patches on the given bodies, (n_patches, ngeom)."""
    return np.array([~_is_own(model, body) for body in bodies]).reshape(len(bodies), model.ngeom)


def _is_own(model: mujoco.MjModel, body: int) -> NDArray[np.bool_]:
    """Returns which geoms move with a body, (ngeom,): those of all bodies that are welded to it. Bodies that are fixed to the world move with the world and
    with their own tree only, because their poses may be set by hand."""
    others: NDArray[np.intp] = model.geom_bodyid
    own: NDArray[np.bool_] = model.body_weldid[others] == model.body_weldid[body]
    if model.body_weldid[body] == 0 and body != 0:
        own &= model.body_rootid[others] == model.body_rootid[body]
    return own


def _touching(model: mujoco.MjModel, body: int) -> NDArray[np.bool_]:
    colliding, others, own = _colliding(model), model.geom_bodyid, _is_own(model, body)
    of_body = colliding & (others == body)
    solid = np.flatnonzero(of_body if of_body.any() else colliding & own)
    if not len(solid):
        return _of_pair(model, body, colliding) & ~own
    contype, conaffinity = model.geom_contype, model.geom_conaffinity
    can = np.zeros(model.ngeom, bool)
    for part in np.unique(others[solid]):
        geoms = solid[others[solid] == part]
        fits = ((contype[geoms, None] & conaffinity) | (contype & conaffinity[geoms, None])).any(axis=0)
        can |= _of_pair(model, int(part), colliding & fits)
    # Pairs that the model lists collide in spite of all filters.
    for first, second in zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True):
        can[second] |= first in solid
        can[first] |= second in solid
    return can & ~own


def _of_pair(model: mujoco.MjModel, body: int, can: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Returns which of the geoms `can` are left for a body by the filter of parent and child and by `<exclude>`."""
    others, weld = model.geom_bodyid, model.body_weldid
    can = can.copy()
    if weld[body] != 0 and not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT:
        parent = weld[model.body_parentid[weld]]
        can &= (weld[others] == 0) | ((weld[others] != parent[body]) & (parent[others] != weld[body]))
    for signature in model.exclude_signature.tolist():
        pair = (signature >> 16, signature & 0xFFFF)
        if body in pair:
            can &= others != pair[pair[0] == body]
    return can


def _colliding(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Returns which geoms take part in collisions, (ngeom,)."""
    colliding: NDArray[np.bool_] = (model.geom_contype | model.geom_conaffinity) != 0
    colliding[model.pair_geom1] = colliding[model.pair_geom2] = True
    return colliding
