"""Simulated touch for robot skin, in NumPy arrays.

Lengths are in metres, forces in newtons, angles in radians. A pose is the pose of the object in the patch frame (`patch_from_object`): seven
numbers x, y, z, qw, qx, qy, qz, or a 4 × 4 matrix. The taxels of a flat patch rest in the plane z = 0 of the patch and point along +z.

Invalid input raises ValueError with the message `<where>: <what was given>; <what is allowed>`. A file that cannot be read or written raises
OSError. A bug of this package raises InternalError; its message asks the user to report the bug.
"""

from typing import TYPE_CHECKING

from bubbletouch._core import (
    Catalogue,
    Chain,
    Contacts,
    InternalError,
    Joint,
    Mesh,
    Patch,
    Projection,
    Reconstructor,
    Robot,
    ShearState,
    Simulation,
    Skin,
    Solid,
    SphereUnion,
    Step,
    touch_poses,
    write_frame,
)
from bubbletouch.data_audit import Audit, Finding, audit
from bubbletouch.recorded import Recorded
from bubbletouch.recorded_files import read_recorded
from bubbletouch.study import Study, Table, advise, run, simulate

__all__ = [
    "Audit",
    "Catalogue",
    "Chain",
    "Contacts",
    "Finding",
    "InternalError",
    "Joint",
    "Mesh",
    "Patch",
    "Projection",
    "Reconstructor",
    "Recorded",
    "Robot",
    "ShearState",
    "Simulation",
    "Skin",
    "Solid",
    "SphereUnion",
    "Step",
    "Study",
    "Table",
    "advise",
    "audit",
    "read_recorded",
    "run",
    "simulate",
    "touch_poses",
    "write_frame",
]

if not TYPE_CHECKING:
    # Parts that need optional packages are imported at their first use: bt.mujoco.Skin.
    def __getattr__(name):
        if name in ("drake", "mujoco"):
            import importlib

            return importlib.import_module(f"bubbletouch.{name}")
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__version__ = "0.1.0"
