"""An engine's contact forces on the patches of a skin, for `match="normal_force"`."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import bubbletouch._core as _core

Array = NDArray[np.float64]

# Least cosine between a contact force and the axis of the nearest taxel, reversed: contacts up to 60° off the axis press on the patch. If larger, contacts
# on the rims of curved skins are lost; if smaller, contacts on the side of a finger press on its pad.
FACING = 0.5


class WantedForces(NamedTuple):
    """Forces of the pairs of patch and object, (n_patches, n_objects), newtons."""

    # Forces that the patches are to have.
    forces: Array
    # Directions of the patches' travels in their frames, (n_patches, n_objects, 3), or None if all patches are flat.
    directions: Array | None
    # Contact forces on the bodies of the patches that press on no patch; each belongs to the nearest patch.
    beside: Array


class Contact(NamedTuple):
    """Contact of two geometries of an engine."""

    first: Hashable
    second: Hashable
    # Place of the contact in the world, metres, (3,).
    place: Array
    # Unit normal from the first to the second geometry in the world, (3,): the contact force pushes the second one along it.
    normal: Array
    # Force along the normal, newtons.
    force: float


class ContactForces:
    """Distributes an engine's contact forces over patches.

    patches: patches of the skin. carriers: body of each patch. bodies: body of each geometry of the engine. objects: number of
    the rigid object of each geometry that can touch the skin.
    """

    def __init__(
        self,
        patches: Sequence[_core.Patch],
        carriers: Sequence[Hashable],
        bodies: Mapping[Any, Hashable],
        objects: Mapping[Any, int],
    ) -> None:
        self._centers = [np.asarray(patch.centers) for patch in patches]
        self._axes = [np.asarray(patch.axes) for patch in patches]
        self._is_flat = [bool((axes == [0.0, 0.0, 1.0]).all()) for axes in self._axes]
        self._columns = objects
        of_body = {body: [p for p, carrier in enumerate(carriers) if carrier == body] for body in carriers}
        self._patches_of = {geometry: of_body[body] for geometry, body in bodies.items() if body in of_body}

    def wanted(self, contacts: Iterable[Contact], poses: tuple[Array, Array], overlaps: Array) -> WantedForces:
        """Returns the requested normal forces of the pairs.

        poses: positions (n_patches, 3) and rotation matrices (n_patches, 9) of the patches. overlaps: normal forces of the pairs at the engine's poses,
        (n_patches, n_objects), by which the force of a contact is divided if several patches of one body face it.
        """
        forces, beside = np.zeros(overlaps.shape), np.zeros(overlaps.shape)
        directions = np.zeros((*overlaps.shape, 3))
        for contact in contacts:
            force = contact.force
            for own, other, sign in ((contact.first, contact.second, -1.0), (contact.second, contact.first, 1.0)):
                patches, column = self._patches_of.get(own), self._columns.get(other)
                if patches is None or column is None or force <= 0.0:
                    continue
                away, pushes, facing = [], [], []
                for patch in patches:
                    rotation = poses[1][patch].reshape(3, 3)
                    offsets = self._centers[patch] - (contact.place - poses[0][patch]) @ rotation
                    squares = np.einsum("ij,ij->i", offsets, offsets)
                    nearest = int(squares.argmin())
                    push = sign * contact.normal @ rotation
                    away.append(float(squares[nearest]))
                    pushes.append(push)
                    facing.append(-float(push @ self._axes[patch][nearest]) > FACING)
                if not any(facing):
                    beside[patches[int(np.argmin(away))], column] += force
                    continue
                shares = np.where(facing, overlaps[patches, column], 0.0)
                if not shares.any():
                    # No overlap in the geometry: the facing patch next to the contact has the whole force.
                    shares[int(np.argmin(np.where(facing, away, np.inf)))] = 1.0
                shares *= force / shares.sum()
                for patch, share, push in zip(patches, shares, pushes, strict=True):
                    forces[patch, column] += share
                    directions[patch, column] -= share * push
        if all(self._is_flat):
            return WantedForces(forces, None, beside)
        lengths = np.linalg.norm(directions, axis=-1, keepdims=True)
        flat = np.reshape(self._is_flat, (-1, 1, 1)) | (lengths == 0.0)
        directions = np.where(flat, [0.0, 0.0, 1.0], directions / np.where(lengths == 0.0, 1.0, lengths))
        return WantedForces(forces, directions, beside)
