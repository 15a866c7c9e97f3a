"""An engine's contact forces as the argument `loads` of bubbletouch.Skin.read, for `match`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def contact_loads(carriers: NDArray[np.intp], objects: NDArray[np.intp], points: Array, *forces: Array) -> tuple[NDArray[np.generic], ...]:
    """Returns the loads of n contacts between pairs of geometries. Each contact acts on the carriers among its two geometries.

    carriers, objects: index of the carrier of patches and of the object of both geometries, (n, 2), -1 for none. points: (n, 3), world, metres. forces: normal
    forces and, optionally, friction forces and torques on the second geometry, (n, 3) each, world.
    """
    sides = [np.flatnonzero((carriers[:, own] >= 0) & (objects[:, 1 - own] >= 0)) for own in (0, 1)]
    pairs = [np.stack([carriers[rows, own], objects[rows, 1 - own]], axis=1) for own, rows in enumerate(sides)]
    vectors = [np.concatenate([-force[sides[0]], force[sides[1]]]) for force in forces]
    return np.concatenate(pairs), np.concatenate([points[rows] for rows in sides]), *vectors
