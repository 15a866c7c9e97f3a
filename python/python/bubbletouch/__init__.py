"""Simulated touch for robot skin, in NumPy arrays.

All lengths are metres, forces newtons, angles radians. A pose is the object in the frame of the patch (`patch_from_object`): seven numbers
x, y, z, qw, qx, qy, qz, or a 4 × 4 matrix. Taxels of a flat patch rest in its plane z = 0 and point along +z.

Bad input raises ValueError as `<where>: <what was given>; <what is allowed>`, a file that cannot be read or written OSError, and a bug of
this package InternalError, whose text asks for a report.
"""

from bubbletouch._core import (
    Catalogue,
    Chain,
    Contacts,
    InternalError,
    Mesh,
    Patch,
    Projection,
    Reconstructor,
    Simulation,
    Solid,
    SphereUnion,
    Step,
    touch_poses,
    write_frame,
)
from bubbletouch.study import Study, Table, advise, run, simulate

__all__ = [
    "Catalogue",
    "Chain",
    "Contacts",
    "InternalError",
    "Mesh",
    "Patch",
    "Projection",
    "Reconstructor",
    "Simulation",
    "Solid",
    "SphereUnion",
    "Step",
    "Study",
    "Table",
    "advise",
    "run",
    "simulate",
    "touch_poses",
    "write_frame",
]
__version__ = "0.1.0"
