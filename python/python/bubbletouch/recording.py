"""Recordings of scenes as arrays, Arrow tables and Parquet files.

A Recording needs only NumPy; tables need pyarrow. `bubbletouch.lerobot`, `bubbletouch.mcap_file` and `bubbletouch.live` write or show the frames in
other formats.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bubbletouch._core import Patch, Simulation

__all__ = ["RecordedPatch", "Recording"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class RecordedPatch:
    """Readings of a patch in n frames of m taxels.

    patch: the patch, in its own frame.
    pose: poses of the patch in the world, (n, 7).
    deflection, force: metres and newtons, (n, ny, nx) or (n, m).
    force3: force on each taxel, newtons, (n, m, 3), in the patch frame.
    wrench: force and torque on the patch, newtons and newton metres, (n, 6), in the patch frame.
    signal: sensor signals in the shape of deflection, or None.
    """

    patch: Patch
    pose: Floats
    deflection: Floats
    force: Floats
    force3: Floats
    wrench: Floats
    signal: Floats | None

    def points(self) -> Floats:
        """Returns (n, m, 6): the position x, y, z of each taxel at rest, metres, and the force Fx, Fy, Fz on it, newtons, in the world frame."""
        turns = rotations(self.pose)
        at = np.einsum("nij,mj->nmi", turns, self.patch.centers) + self.pose[:, None, :3]
        return np.concatenate([at, np.einsum("nij,nmj->nmi", turns, self.force3)], axis=2)


@dataclass(frozen=True)
class Recording:
    """Frames of a scene.

    time: seconds, (n,), ascending.
    patches: readings of the patches, by name.
    objects: poses (n, 7) of the objects in the world, by name.
    """

    title: str
    time: Floats
    patches: dict[str, RecordedPatch]
    objects: dict[str, Floats]

    @classmethod
    def of(cls, simulation: Simulation, frames: Iterable[Mapping[str, Any]] | None = None) -> Recording:
        """Creates a recording from frames of a simulation; None: all remaining frames.

        Raises ValueError if there is no frame. Errors of the simulation are passed on.
        """
        kept = list(simulation if frames is None else frames)
        if not kept:
            raise ValueError("frames: none; at least one")

        def patch(name: str) -> RecordedPatch:
            felt = [frame["patches"][name] for frame in kept]
            stack = {key: np.stack([one[key] for one in felt]) for key in ("pose", "deflection", "force", "force3", "wrench")}
            signal = None if felt[0]["signal"] is None else np.stack([one["signal"] for one in felt])
            return RecordedPatch(simulation.patch(name), **stack, signal=signal)

        return cls(
            simulation.title,
            np.array([frame["time"] for frame in kept]),
            {name: patch(name) for name in simulation.patches},
            {name: np.stack([frame["objects"][name]["pose"] for frame in kept]) for name in simulation.objects},
        )

    def __len__(self) -> int:
        return len(self.time)

    def table(self) -> Any:
        """Returns a pyarrow.Table with one row per frame.

        The columns are time_s; NAME.pose, NAME.deflection, NAME.force, NAME.force3, NAME.wrench and NAME.signal of each patch; NAME.pose of each
        object. All columns except time_s are fixed-shape tensors with the shapes of the arrays. The metadata of the schema contains the title and,
        as JSON, the positions and axes of the taxels.

        Raises ImportError without pyarrow.
        """
        import pyarrow as pa

        columns: dict[str, Any] = {"time_s": pa.array(self.time)}
        layouts = {}
        for name, felt in self.patches.items():
            for key in ("pose", "deflection", "force", "force3", "wrench", "signal"):
                values = getattr(felt, key)
                if values is not None:
                    columns[f"{name}.{key}"] = pa.FixedShapeTensorArray.from_numpy_ndarray(np.ascontiguousarray(values))
            layouts[name] = {"centers_m": felt.patch.centers.tolist(), "axes": felt.patch.axes.tolist()}
        for name, poses in self.objects.items():
            columns[f"{name}.pose"] = pa.FixedShapeTensorArray.from_numpy_ndarray(poses)
        metadata = {"title": self.title, "patches": json.dumps(layouts)}
        return pa.table(columns).replace_schema_metadata(metadata)

    def write_parquet(self, path: str | PathLike[str]) -> None:
        """Writes the table to a Parquet file. Raises ImportError without pyarrow, and OSError if the file cannot be written."""
        import pyarrow.parquet as pq

        pq.write_table(self.table(), path)


def rotations(poses: Floats) -> Floats:
    """Returns the rotation matrices (n, 3, 3) of poses (n, 7)."""
    w, x, y, z = poses[:, 3:].T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
