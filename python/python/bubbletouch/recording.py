"""Recordings of scenes: frames as arrays, and as Arrow tables and Parquet files.

A Recording needs NumPy alone; tables need pyarrow. `bubbletouch.lerobot`, `.mcap_file` and `.live` have other forms of the same frames.
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
    """What a patch felt in n frames of m taxels.

    patch: its skin, in its own frame. pose: (n, 7) in the world. deflection, force: (n, ny, nx) or (n, m), metres and newtons. force3: (n, m, 3)
    on the taxels, newtons, in the frame of the patch. wrench: (n, 6) on the patch in its frame. signal: as deflection, or None.
    """

    patch: Patch
    pose: Floats
    deflection: Floats
    force: Floats
    force3: Floats
    wrench: Floats
    signal: Floats | None

    def points(self) -> Floats:
        """(n, m, 6): x, y, z of each taxel at rest and the force on it, Fx, Fy, Fz, in the world; metres and newtons."""
        turns = rotations(self.pose)
        at = np.einsum("nij,mj->nmi", turns, self.patch.centers) + self.pose[:, None, :3]
        return np.concatenate([at, np.einsum("nij,nmj->nmi", turns, self.force3)], axis=2)


@dataclass(frozen=True)
class Recording:
    """Frames of a scene. time: (n,) seconds, ascending; patches by name; poses (n, 7) of objects in the world by name."""

    title: str
    time: Floats
    patches: dict[str, RecordedPatch]
    objects: dict[str, Floats]

    @classmethod
    def of(cls, simulation: Simulation, frames: Iterable[Mapping[str, Any]] | None = None) -> Recording:
        """Of frames of a simulation; None: all that it has left. Raises ValueError for none, and what the simulation raises."""
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
        """As a pyarrow.Table, a row a frame: time_s; NAME.pose, .deflection, .force, .force3, .wrench and .signal of each patch and NAME.pose of
        each object, fixed-shape tensors of the shapes above. The schema's metadata has the title and, as JSON, where taxels are.

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
        """Writes the table as a Parquet file. Raises ImportError without pyarrow; OSError."""
        import pyarrow.parquet as pq

        pq.write_table(self.table(), path)


def rotations(poses: Floats) -> Floats:
    """(n, 3, 3) of poses (n, 7)."""
    w, x, y, z = poses[:, 3:].T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
