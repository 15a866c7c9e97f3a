"""Types of the compiled module `bubbletouch._core`. Lengths are in metres, forces in newtons, angles in radians."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias, TypedDict, TypeVar, final, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

__all__ = [
    "Catalogue",
    "Chain",
    "Contacts",
    "InternalError",
    "Joint",
    "KernelSvm",
    "LinearModel",
    "Mesh",
    "Patch",
    "Projection",
    "Reconstructor",
    "Robot",
    "ShearState",
    "Simulation",
    "Skin",
    "Solid",
    "SphereUnion",
    "Step",
    "_panic",
    "advise",
    "choose_svm",
    "column_families",
    "read_table",
    "rename_old_results",
    "run_audit",
    "run_study",
    "toml_of",
    "touch_poses",
    "with_recorded",
    "write_frame",
]

_Path: TypeAlias = str | PathLike[str]
_Unit: TypeAlias = Literal["m", "cm", "mm", "in"]
_Model: TypeAlias = Mesh | SphereUnion
_Objects: TypeAlias = _Model | Sequence[_Model]
_Out = TypeVar("_Out", NDArray[np.float32], NDArray[np.float64])

class _ReadOptions(TypedDict, total=False):
    """Options of Skin.read that the skins of MuJoCo and Drake have, too."""

    output: Literal["deflection", "force"]
    reach: float | None
    out: NDArray[np.float64] | None
    wrenches: NDArray[np.float64] | None
    contacts: NDArray[np.int64] | None
    taxel_forces: NDArray[np.float64] | None
    pair_forces: NDArray[np.float64] | None
    residuals: NDArray[np.float64] | None
    travels: NDArray[np.float64] | None

class InternalError(RuntimeError):
    """A bug of bubbletouch itself, wherever it was called from: its text asks for a report."""

@final
class Mesh:
    """Triangle mesh with exact contact: taxels touch its faces, edges and corners, from both sides.

    `Mesh(vertices, triangles)`: vertices (n, 3), metres; triangles (m, 3), vertex indices from 0, counter-clockwise seen from outside. Raises
    ValueError if a number is not finite or a vertex index does not exist.
    """

    def __new__(cls, vertices: ArrayLike, triangles: ArrayLike) -> Mesh: ...
    @staticmethod
    def read(path: _Path, *, unit: _Unit | None = None, close_holes: float | None = None) -> Mesh:
        """Reads a mesh from a PLY, OBJ, STL, Collada (.dae) or glTF (.glb, .gltf) file.

        unit: unit of the coordinates in the file. If None, the unit is metres, or the unit in a Collada file. The object must then
        be 0.1 mm to 10 m in size.
        close_holes: maximum width of the holes to close, metres. Each hole is closed by a cone of triangles. Default: no hole is closed.

        Closed parts that face inwards are turned outwards, with a UserWarning. Raises OSError if the file cannot be read, and ValueError if it contains
        no valid mesh.
        """

    @staticmethod
    def box(size: ArrayLike) -> Mesh:
        """Returns a box about the origin with the side lengths `size` (3,), metres, positive: 12 triangles."""

    @staticmethod
    def cylinder(radius: float, length: float, tolerance: float = 1e-5) -> Mesh:
        """Returns a cylinder about the origin along z, metres.

        tolerance: largest distance of the facets from the round surface, metres. The facets are inside the cylinder.
        """

    @staticmethod
    def ellipsoid(radii: ArrayLike, tolerance: float = 1e-5) -> Mesh:
        """Returns an ellipsoid about the origin with the given radii (3,) along the axes, metres.

        tolerance: largest distance of the facets from the surface, metres. The facets are inside the ellipsoid. A SphereUnion of one sphere is an exact
        ball.
        """

    @staticmethod
    def capsule(radius: float, length: float, tolerance: float = 1e-5) -> Mesh:
        """Returns a capsule about the origin along z: a cylinder with a hemisphere at each end. `length` is the distance between the centres of the
        hemispheres, metres, zero or more.

        Taxels touch the exact capsule. Its vertices and triangles, and all properties computed from them, describe facets inside the capsule.
        tolerance: largest distance of the facets from the surface, metres.
        """

    def mirrored(self, axis: Literal["x", "y", "z"]) -> Mesh:
        """Returns the mirror image of the mesh in the plane through the origin normal to the axis "x", "y" or "z". Triangles that face outwards face
        outwards again.
        """

    def pack(
        self, tolerance: float, *, sheet: bool = False, cache: _Path | None = None
    ) -> SphereUnion:
        """Packs the solid enclosed by the mesh with few spheres, on all cores.

        No sphere extends more than tolerance / 2 (metres, positive) beyond the surface. No point of the surface is more than the tolerance outside the
        spheres. If these bounds cannot be reached, ValueError is raised. The mesh must be closed. Parts that face inwards are turned outwards, with a
        UserWarning. With sheet=True, the surface is packed as a sheet without thickness; the mesh may then be open. A scan of 16,000 triangles takes
        seconds. Ctrl-C ends the call.

        cache: folder of packings, created if missing. If the folder contains the spheres of an equal mesh and tolerance, these are read; otherwise, the
        spheres are written to it. Studies use the same files, in the folder packings beside their results. Several processes can share a folder.
        """

    def vertex_spheres(self) -> SphereUnion:
        """Returns one sphere per distinct vertex, as in the original BubbleTouch. All radii equal twice the mean distance from a vertex to its nearest
        neighbour.
        """

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Vertices of the mesh (n, 3), metres; a copy."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Triangles of the mesh (m, 3) as vertex indices; a copy."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Bounding box (2, 3): the smallest and largest coordinates, metres."""

    @property
    def area(self) -> float:
        """Surface area of the mesh, m²."""

    @property
    def volume(self) -> float:
        """Volume of the mesh, m³; negative if the triangles of the given arrays face inwards."""

    @property
    def centroid(self) -> NDArray[np.float64]:
        """Centroid of the mesh's volume (3,), metres."""

    def __len__(self) -> int:
        """Number of triangles of the mesh."""

    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class ShearState:
    """Shear springs with friction of all taxels of a skin. Skin.shear_state() creates the state, and each Skin.read advances it by one step.

    Between two reads, a body in contact drags the taxels sideways until they slip. The shear force is at most the friction coefficient times the normal
    force.
    """

    @property
    def forces(self) -> NDArray[np.float64]:
        """Force of the bodies on each taxel after the last read, newtons, (n_taxels, 3) or (n, n_taxels, 3), in the frame of the taxel's patch. It is the sum
        of the normal force, the friction, and the lateral force of an inclined contact.
        """

    @property
    def slipping(self) -> NDArray[np.bool_]:
        """Whether each taxel slipped during the last step, (n_taxels,) or (n, n_taxels)."""

    def __copy__(self) -> ShearState: ...
    def __deepcopy__(self, memo: Any) -> ShearState: ...
    def reset(self, sets: Sequence[int] | None = None) -> None:
        """Sets the shear forces to zero, as before the first read. `sets` contains the indices of the sets of poses; None selects all sets."""

@final
class Skin:
    """Patches of skin and bodies that may touch them, read at given poses in one call.

    `Skin(patches, bodies)` has a sequence of Patch and a sequence of Mesh or SphereUnion as arguments. If several bodies deflect a taxel, the largest
    deflection counts. Several threads may read one skin at the same time.

    objects: index of the rigid object to which each body belongs, (n_bodies,), from 0. If None, each body is an object. Requested forces act between
    patches and objects, so the bodies of an object press a patch together.
    can_touch: pairs of patch and body that can touch, (n_patches, n_bodies) bool; None for all pairs. A body never presses a patch that it cannot touch.
    carriers: index of the rigid body that carries each patch, (n_patches,), from 0, for the argument loads of read(). If None, each patch has its own.

    Raises ValueError if the sequence of patches is empty, if the indices of objects skip a number, or if can_touch has another shape.
    """

    def __new__(
        cls,
        patches: Sequence[Patch],
        bodies: Sequence[_Model],
        *,
        objects: Sequence[int] | None = None,
        can_touch: ArrayLike | None = None,
        carriers: Sequence[int] | None = None,
    ) -> Skin: ...
    @property
    def n_taxels(self) -> int:
        """Number of taxels of all patches."""

    @property
    def ranges(self) -> list[tuple[int, int]]:
        """First and last index (exclusive) of each patch's taxels in a frame: a list of pairs, one per patch."""

    def read(
        self,
        patch_poses: ArrayLike | tuple[ArrayLike, ArrayLike],
        body_poses: ArrayLike | tuple[ArrayLike, ArrayLike],
        *,
        output: Literal["deflection", "force"] = "deflection",
        forces: ArrayLike | None = None,
        directions: ArrayLike | None = None,
        loads: Sequence[ArrayLike] | None = None,
        reach: float | None = None,
        shear: ShearState | None = None,
        out: NDArray[np.float64] | None = None,
        wrenches: NDArray[np.float64] | None = None,
        contacts: NDArray[np.int64] | None = None,
        taxel_forces: NDArray[np.float64] | None = None,
        pair_forces: NDArray[np.float64] | None = None,
        residuals: NDArray[np.float64] | None = None,
        travels: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Reads all patches under all bodies. Returns a frame of the skin, (n_taxels,) or (n, n_taxels) float64, patch after patch.

        patch_poses, body_poses: poses of the k patches and of the k bodies in the world, in their order. The shape is (k, 7) or (n, k, 7) of x, y, z, qw, qx,
        qy, qz, or (…, k, 4, 4). A pair (positions, rotations) is also allowed. Its positions are (…, k, 3). Its rotations are quaternions w, x, y, z,
        (…, k, 4), or matrices by rows, (…, k, 9) or (…, k, 3, 3), as in MuJoCo. A single patch or body needs no axis k. If only one of the two arguments
        has n sets, the other one applies to all of them.
        output: "deflection", metres, or "force", newtons along the axis of each taxel (stiffness times deflection).

        forces: requested normal forces of the pairs of patch and object, newtons, (n_patches, n_objects) or (n, n_patches, n_objects), zero or more. The
        normal force of a pair is the sum of the forces of the patch's taxels along their axes under this object alone. The patch travels from its pose
        until it has the requested force. A pair with force 0 has no contact, even if patch and object overlap. A pair with NaN is read at its pose.
        directions: directions of the travel in the patch frames, unit vectors, (…, n_patches, n_objects, 3); default z.
        loads: contact forces of an engine, instead of forces: a tuple of arrays with a row for each contact, for one set of poses. pairs: carrier of the patch
        and object, (m, 2). points: (m, 3), metres. normal forces on the carrier: (m, 3), newtons. Two more arrays are optional: friction forces, (m, 3),
        and torques about the points, (m, 3), N·m. All vectors are in the world. A contact acts on the nearest patch of the carrier that faces it: the normal
        force is within 60° of the nearest taxel's reversed axis, and the point within one spacing (or the radius) of the taxel's axis and
        within reach along it. Other contacts act on no patch. The taxels of a flat patch have the sum and the moment of the normal forces, those of a
        curved patch the sum along their axes. With friction forces, the sum and the moment of all forces on the patch are those of the contacts. A contact
        at the rim is up to half a spacing outside all taxels; wrenches contain the torque of this offset.

        reach: largest travel towards the object, metres. The default is the patch's largest stroke plus its largest taxel diameter. If the force is not
        reached, the press ends at this travel, or before the object is behind the substrate.
        shear: ShearState of this skin, which is advanced by one step. The wrenches then contain friction and the lateral forces of inclined contacts.

        The call fills the following arrays. They are float64 (contacts: int64), in C order, with a first axis n for n sets of poses.
        out: the frame; this array is returned.
        wrenches: (n_patches, 6), force and torque of the normal forces on each patch, in the patch's frame about its origin, newtons and newton metres.
        contacts: (n_patches, 2), numbers of touched taxels and of taxels at their stroke.
        taxel_forces: (n_taxels, 3), force on each taxel in the frame of its patch, newtons: along the axis and, with friction loads, tangential.
        pair_forces: (n_patches, n_objects), normal force of each pair, newtons.
        residuals: (n_patches, n_objects), requested force minus normal force of each pair, newtons; 0 for pairs that are read at their poses. A load
        that acts on no patch of its carrier belongs to the nearest one, if it is nearer than the diameter of the patch.
        travels: (n_patches, n_objects), travel of the patch of each pair, metres; NaN for pairs with force 0.
        """

    def shear_state(self, stiffness: ArrayLike, friction: ArrayLike, *, n: int | None = None) -> ShearState:
        """Returns the state of untouched taxels with shear springs, for the argument `shear` of read().

        stiffness: stiffness of the shear springs, N/m, positive; one number, or (n_taxels,).
        friction: coefficient of friction, zero or more; one number, or (n_taxels,).
        n: number of sets of poses in each read; None for poses without an axis of sets.
        """

    def __len__(self) -> int: ...
    def __getnewargs_ex__(self) -> tuple[tuple[Any, ...], dict[str, Any]]: ...

@final
class SphereUnion:
    """Union of rigid spheres.

    `SphereUnion(centers, radii)`: centers (n, 3), metres; radii (n,) or one number, metres, positive. Raises ValueError if a sphere is invalid; the
    message contains its number, from 1.
    """

    def __new__(cls, centers: ArrayLike, radii: ArrayLike) -> SphereUnion: ...
    @staticmethod
    def read(path: _Path, *, unit: _Unit | None = None) -> SphereUnion:
        """Reads spheres from a CSV file with columns x, y, z, r, in metres or in another unit.

        Raises OSError if the file cannot be read, and ValueError if it contains no valid spheres.
        """

    def write(self, path: _Path) -> None:
        """Writes the spheres to a CSV file, from which read() returns bitwise equal spheres. Raises OSError if writing fails; an existing file is then
        kept.
        """

    @property
    def centers(self) -> NDArray[np.float64]:
        """Centres of the spheres (n, 3), metres; a copy."""

    @property
    def radii(self) -> NDArray[np.float64]:
        """Radii of the spheres (n,), metres; a copy."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Bounding box (2, 3): the smallest and largest coordinates, metres."""

    def __len__(self) -> int:
        """Number of spheres of the union."""

    def __getnewargs__(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...

@final
class Solid:
    """Object of a catalogue: a union of parametric shapes with real dimensions. The object rests on z = 0; its bounding box is centred at x = y = 0."""

    @property
    def name(self) -> str:
        """Name of the object."""

    @property
    def set(self) -> str:
        """Name of the set to which the object belongs: balls, boxes, cans, household, hands, or the name of a file."""

    @property
    def source(self) -> str:
        """Source of the object's dimensions, such as a standard."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Bounding box (2, 3): the smallest and largest coordinates, metres."""

    def pack(self, tolerance: float) -> SphereUnion:
        """Returns spheres whose surface is within the tolerance (metres, positive) of the solid's surface. Raises ValueError for an invalid tolerance."""

@final
class Catalogue:
    """Catalogue of named objects, grouped into named sets."""

    @staticmethod
    def builtin() -> Catalogue:
        """Returns the built-in catalogue of bubbletouch: balls, boxes, cans, household objects and hands."""

    @staticmethod
    def read(path: _Path) -> Catalogue:
        """Reads objects from a TOML file. Raises OSError if the file cannot be read, and ValueError, with the line number, if it is invalid."""

    @property
    def names(self) -> list[str]:
        """Names of all objects, set by set."""

    @property
    def sets(self) -> list[str]:
        """Names of all sets."""

    def object(self, name: str) -> Solid:
        """Returns the object with the given name. If there is none, raises ValueError, which lists similar names."""

    def set(self, name: str) -> list[Solid]:
        """Returns all objects of the set with the given name. If there is no such set, raises ValueError, which lists the sets."""

    def __len__(self) -> int:
        """Number of objects in the catalogue."""

@final
class Contacts:
    """Contacts of presses at n poses, ordered by pose and taxel. Each of the m contacts is a pair of a taxel and the sphere or triangle of an object that
    touches it.
    """

    @property
    def pose(self) -> NDArray[np.int64]:
        """For each contact (m,), the number of its pose, from 0."""

    @property
    def taxel(self) -> NDArray[np.int64]:
        """For each contact (m,), the number of its taxel in the patch, from 0."""

    @property
    def object(self) -> NDArray[np.int64]:
        """For each contact (m,), the number of the object that touches the taxel, from 0; always 0 for a single object."""

    @property
    def part(self) -> NDArray[np.int64]:
        """For each contact (m,), the number of the sphere or triangle of the object that determines the taxel's deflection."""

    @property
    def deflection(self) -> NDArray[np.float64]:
        """For each contact (m,), the deflection of its taxel, metres; equals the deflection in the frame up to rounding."""

    @property
    def normal(self) -> NDArray[np.float64]:
        """For each contact (m, 3), the contact normal: unit vector from the object's surface to the taxel, in the patch frame."""

    @property
    def point(self) -> NDArray[np.float64]:
        """For each contact (m, 3), the contact point, metres, in the patch frame."""

    @property
    def force(self) -> NDArray[np.float64]:
        """For each contact (m, 3), the frictionless force of the taxel's spring on the object, newtons, in the patch frame."""

    @property
    def gradient(self) -> NDArray[np.float64]:
        """For each contact (m, 3), the gradient ∂δ/∂x of the deflection δ for a motion x of the touching part in the patch frame. The gradient ignores the
        limit of the stroke. For a sphere of radius R, the length of the gradient is ∂δ/∂R.
        """

    @property
    def travel(self) -> NDArray[np.float64]:
        """For each pose (n,), the travel of the patch along its z axis, metres; NaN if no taxel touched the object."""

    @property
    def n_touched(self) -> NDArray[np.int64]:
        """For each pose (n,), the number of deflected taxels."""

    @property
    def n_saturated(self) -> NDArray[np.int64]:
        """For each pose (n,), the number of saturated taxels: their deflection equals the stroke, and the object pushes further."""

    def __len__(self) -> int:
        """Number m of contacts."""

@final
class Patch:
    """Taxels on a rigid substrate. A patch is created by one of the static methods.

    A taxel is a sphere of `taxel_radius` (metres, positive; half the pitch if None) on a spring of `stiffness` (N/m, positive). Its `damping`
    (N·s/m, zero or more) is used by signal chains and scenes. Its deflection is at most its `stroke` (metres, positive). The methods raise
    ValueError for values out of range, and for more than 4,194,304 taxels.
    """

    @staticmethod
    def grid(
        ny: int,
        nx: int,
        pitch: float,
        stroke: float,
        *,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns a grid of ny rows (along y, ascending) of nx taxels in the plane z = 0. The taxels are `pitch` metres apart; the grid is centred on the
        origin. Frames have the shape (ny, nx).
        """

    @staticmethod
    def hexagonal(
        ny: int,
        nx: int,
        pitch: float,
        stroke: float,
        *,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns a patch of ny staggered rows of nx taxels on a hexagonal lattice. Each inner taxel has six neighbours `pitch` metres away. The taxels
        are numbered row by row.
        """

    @staticmethod
    def disc(
        radius: float,
        pitch: float,
        stroke: float,
        *,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns a patch of all taxels of a hexagonal lattice within `radius` metres of the origin. The taxels are numbered row by row."""

    @staticmethod
    def cylinder(
        radius: float,
        length: float,
        arc: float,
        pitch: float,
        stroke: float,
        *,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns a patch of rings of taxels around the z axis that face away from the axis, as on a forearm or a finger.

        radius: distance of the rest centres from the axis, metres.
        length: distance between the first and the last ring, metres, zero or more.
        arc: angle covered by a ring, radians, above 0 to 2π, centred at +x.
        pitch: distance between taxels along the surface, metres; rounded so that a whole number of taxels fits.

        Presses move along z: use moved() to turn the middle of the patch to z.
        """

    @staticmethod
    def sphere_cap(
        radius: float,
        half_angle: float,
        pitch: float,
        stroke: float,
        *,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns a patch of rings of taxels on a sphere about the origin, as on a fingertip or an elbow.

        radius: radius of the sphere, metres.
        half_angle: angle from the pole at +z to the edge, radians, above 0 to π.
        """

    @staticmethod
    def draped(
        mesh: Mesh | SphereUnion,
        pitch: float,
        stroke: float,
        *,
        seed: int = 0,
        bounds: ArrayLike | None = None,
        plane: ArrayLike | None = None,
        triangles: Sequence[int] | None = None,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns a patch of taxels that are distributed over the outer surface of a mesh, or of a SphereUnion of one sphere.

        The number of taxels equals the number in a grid with this pitch. The taxels are at least 0.83 pitches apart. The call takes 0.3 ms per taxel. A
        taxel whose axis would meet the mesh again is omitted; n_left_out counts these taxels. Closed parts of the mesh that face inwards are turned
        outwards, with a UserWarning.

        The region is the intersection of the given conditions:

        - bounds (2, 3): smallest and largest coordinates, metres;
        - plane (2, 3): a point, metres, and the direction to the covered side;
        - triangles: triangle indices.
        """

    @staticmethod
    def from_arrays(
        centers: ArrayLike,
        axes: ArrayLike,
        *,
        stroke: ArrayLike,
        taxel_radius: ArrayLike,
        stiffness: ArrayLike | None = None,
        damping: ArrayLike | None = None,
        shape: Sequence[int] | None = None,
        pixels: ArrayLike | None = None,
    ) -> Patch:
        """Returns a patch of given taxels: centers (n, 3), metres, and unit axes (n, 3) that point away from the substrate. The lengths of the axes may
        differ from 1 by 1 %; the axes are normalised. The other arguments are arrays (n,), or one number for all taxels. Defaults: stiffness 100 N/m,
        damping 0.

        shape: shape of a frame, (ny, nx) if the taxels are numbered row by row. Default: (n,).
        pixels: row and column of each taxel in the sensor's image, (n, 2) integers from 0.
        """

    @staticmethod
    def from_points(
        positions: ArrayLike,
        normals: ArrayLike | Mesh,
        stroke: float | None = None,
        *,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
        shape: Sequence[int] | None = None,
        pixels: ArrayLike | None = None,
    ) -> Patch:
        """Returns a patch of taxels at given points, metres, (n, 3), with normals that point away from the substrate.

        stroke: metres. Default: the diameter of the taxel.
        normals: vectors of any length, (n, 3), or a Mesh whose surface gives the normals. Each point must be at most 5 mm from the mesh.
        taxel_radius: metres. Default: half the median distance between neighbours.
        shape: shape of a frame, (ny, nx) if the taxels are numbered row by row. Default: (n,).
        pixels: row and column of each taxel in the sensor's image, (n, 2) integers from 0.
        """

    @staticmethod
    def projected(
        mesh: Mesh,
        pose: ArrayLike,
        ny: int,
        nx: int,
        pitch: float,
        stroke: float | None = None,
        *,
        missing: Literal["error", "drop"] = "error",
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns a flat grid of ny × nx taxels that is wrapped around the surface of a mesh.

        The grid lies in the plane z = 0 of the pose, with `pitch` metres between taxels. The pose is (7,) or (4, 4), in the frame of the mesh. Each taxel
        moves along −z of the pose to the first point of the mesh. Its axis is the outward normal of the triangle at this point. The centres and axes are
        in the frame of the mesh. Closed parts of the mesh that face inwards are turned outwards, with a UserWarning.

        stroke: metres. Default: the diameter of the taxel.
        missing: "error" raises ValueError if a taxel meets no outer face of the mesh. "drop" omits such taxels, and n_left_out counts them.

        Frames have the shape (ny, nx) if no taxel is omitted. `pixels` contains the row and column of each taxel in the grid.
        """

    @staticmethod
    def read(
        path: str | PathLike[str],
        stroke: float | None = None,
        *,
        mesh: Mesh | None = None,
        unit: _Unit | None = None,
        sensor: str | None = None,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns a patch with the taxels of a layout file.

        The extension of `path` selects the format:

        - .csv: columns x_mm, y_mm, z_mm, nx, ny, nz, and optionally radius_mm, row and column;
        - .npz: positions and normals, or poses and taxel2pixel as for DEX-01;
        - .txt or .ini: iCub;
        - .json: PaXini;
        - .urdf: `<tactile>` of urdf_tactile, or XELA's prismatic joints; `sensor` selects one of several sensors.

        stroke: metres. Default: the diameter of the taxel.
        mesh: surface that gives the normals, for files without normals or with placeholders, such as files of iCub and PaXini.
        unit: "m", "cm", "mm" or "in", for .npz, .txt, .ini and .json files that do not state their unit. Default: mm for PaXini, metres for others.
        taxel_radius: metres. Default: the radius in the file, or half the median distance between neighbours.

        Frames have the shape (ny, nx) if the file numbers its taxels row by row in a complete image. Notes of the reader are issued as UserWarnings.
        Raises ValueError with the file and the row if the file is invalid, and OSError if it cannot be read.
        """

    def write(
        self,
        path: _Path,
        *,
        format: Literal["csv", "npz", "dex-01", "icub", "paxini", "urdf"] | None = None,
    ) -> None:
        """Writes the layout to a file that Patch.read can read. The file contains positions and normals, and radii and pixels if the format has them.

        format: csv, npz, dex-01 (poses and taxel2pixel in a .npz file), icub (.txt or .ini), paxini (.json) or urdf. None selects the format by the extension.

        Radii and pixels that the format cannot represent are omitted, with a UserWarning. If a csv, npz or icub file is read again, the layout is bitwise
        equal. Other formats round the last digits. Raises OSError if the file cannot be written.
        """

    def draw(self, path: _Path, *, title: str | None = None) -> None:
        """Draws the taxels to a file that ends in .svg or .png. The picture has a map with the taxels' numbers, from 0, and an oblique view with their axes.

        title: heading of the picture, "patch" if None.
        """

    @property
    def pixels(self) -> NDArray[np.int64] | None:
        """Row and column of each taxel in the sensor's image, (n_taxels, 2) integers; None if the layout file contains no image."""

    def moved(self, pose: ArrayLike) -> Patch:
        """Returns a copy of the patch, moved by a pose in the patch frame. Frames of the copy have the same shape. pose: (7,) or (4, 4)."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a frame of the patch: (ny, nx) for taxels in rows and columns, otherwise (n_taxels,)."""

    @property
    def n_taxels(self) -> int:
        """Number of taxels of the patch."""

    @property
    def n_left_out(self) -> int:
        """Number of taxels omitted from a draped patch because their axes would meet the mesh again; 0 for other patches."""

    @property
    def centers(self) -> NDArray[np.float64]:
        """Rest centres of the taxels (n_taxels, 3), metres; a copy."""

    @property
    def axes(self) -> NDArray[np.float64]:
        """Unit axes of the taxels (n_taxels, 3), pointing away from the substrate; a copy."""

    @property
    def pitch(self) -> float | None:
        """Distance between neighbouring taxels of a grid, metres; None for other patches."""

    @property
    def taxel_radius(self) -> float | NDArray[np.float64]:
        """Radius of the taxels, metres: one number, or one per taxel."""

    @property
    def stroke(self) -> float | NDArray[np.float64]:
        """Stroke (largest deflection) of the taxels, metres: one number, or one per taxel. A taxel whose deflection equals its stroke is saturated."""

    @property
    def stiffness(self) -> float | NDArray[np.float64]:
        """Stiffness of the taxels, N/m: one number, or one per taxel."""

    @property
    def damping(self) -> float | NDArray[np.float64]:
        """Damping of the taxels, N·s/m: one number, or one per taxel."""

    def __len__(self) -> int:
        """Number of taxels of the patch."""

    @overload
    def press(
        self,
        object: _Objects,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        output: Literal["deflection", "force"] = "deflection",
        out: _Out,
        dtype: DTypeLike | None = None,
        threads: int | None = None,
        contacts: Literal[False] = False,
        jacobian: Literal[False] = False,
    ) -> _Out: ...
    @overload
    def press(  # type: ignore[overload-overlap]
        self,
        object: _Objects,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        output: Literal["deflection", "force"] = "deflection",
        out: None = None,
        dtype: type[np.float32] | Literal["float32"],
        threads: int | None = None,
        contacts: Literal[False] = False,
        jacobian: Literal[False] = False,
    ) -> NDArray[np.float32]: ...
    @overload
    def press(
        self,
        object: _Objects,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        output: Literal["deflection", "force"] = "deflection",
        out: None = None,
        dtype: type[np.float64] | Literal["float64"] | None = None,
        threads: int | None = None,
        contacts: Literal[False] = False,
        jacobian: Literal[False] = False,
    ) -> NDArray[np.float64]: ...
    @overload
    def press(
        self,
        object: _Objects,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        output: Literal["deflection", "force"] = "deflection",
        out: _Out,
        dtype: DTypeLike | None = None,
        threads: int | None = None,
        contacts: Literal[True],
        jacobian: Literal[False] = False,
    ) -> tuple[_Out, Contacts]: ...
    @overload
    def press(
        self,
        object: _Objects,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        output: Literal["deflection", "force"] = "deflection",
        out: None = None,
        dtype: type[np.float64] | Literal["float64"] | None = None,
        threads: int | None = None,
        contacts: Literal[True],
        jacobian: Literal[False] = False,
    ) -> tuple[NDArray[np.float64], Contacts]: ...
    @overload
    def press(
        self,
        object: _Objects,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        output: Literal["deflection", "force"] = "deflection",
        out: None = None,
        dtype: type[np.float64] | Literal["float64"] | None = None,
        threads: int | None = None,
        contacts: Literal[False] = False,
        jacobian: Literal[True],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    @overload
    def press(
        self,
        object: _Objects,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        output: Literal["deflection", "force"] = "deflection",
        out: NDArray[np.float32] | NDArray[np.float64] | None = None,
        dtype: DTypeLike | None = None,
        threads: int | None = None,
        contacts: bool = False,
        jacobian: bool = False,
    ) -> Any:
        """Presses the patch on one or several objects at n poses. Returns the deflections of the taxels, metres, from 0 to the stroke.

        object: a Mesh or a SphereUnion, or a sequence of k of them. If several objects deflect a taxel, the largest deflection counts.
        poses: poses of the object in the patch frame, (n, 7) of x, y, z, qw, qx, qy, qz or (n, 4, 4). A single pose is (7,) or (4, 4). For a sequence of k
        objects, the shape is (n, k, 7) or (n, k, 4, 4). A single pose of each object is (k, 7) or (k, 4, 4).

        The patch approaches along its z axis. At most one of the following goals is given, as one number for all poses or (n,):

        - depth: metres past first contact, zero or more;
        - travel: metres from the given pose;
        - force: newtons, positive, the sum Σ k δ of all springs.

        Without a goal, the deflections are computed at the given pose. If the patch does not touch the object, the deflections are zero.

        output: "deflection" or "force". The force of a taxel along its axis is its stiffness times its deflection, newtons.
        out: C-contiguous array of float32 or float64 that receives the frames and is returned.
        dtype: type of a new array, float64 (default) or float32.
        threads: maximum number of threads; all cores if None. The call releases the interpreter's lock, and Ctrl-C ends the call.

        Returns an array (n, ny, nx) for a grid, and (n, n_taxels) for another patch; for a single pose, without the axis n. The result is bitwise equal
        for any number of threads. With contacts=True, the Contacts are also returned; the frames are unchanged. With jacobian=True, the derivatives
        (…, 6) of the output with respect to the object's pose are also returned; (…, k, 6) for a sequence of k objects. The derivatives are
        per metre along x, y, z, and per radian about x, y, z through the object's origin, in the axes of the patch. Free and saturated taxels have zeros.
        With a depth or a force, the derivatives include the change of the travel. With a depth, the patch must be flat.

        Raises ValueError for arrays of a wrong shape or type, numbers that are not finite, and a force that cannot be reached.
        """

    def press_and_slide(
        self,
        object: _Objects,
        poses: ArrayLike,
        *,
        depth: ArrayLike,
        slide: ArrayLike,
        friction: ArrayLike,
        shear_stiffness: ArrayLike | None = None,
        threads: int | None = None,
    ) -> dict[str, NDArray[Any]]:
        """Presses the patch to a depth past first contact, then slides it along its x and y axes, at n poses. The skin has friction: the objects drag the
        taxels sideways until they slip. The friction is zero at first contact.

        object, poses, threads: as in press().
        depth: metres, zero or more; one number, or (n,).
        slide: motion of the patch after the press along x and y, metres, (2,) or (n, 2).
        friction: coefficient between taxels and objects, zero or more; one number, or (n_taxels,).
        shear_stiffness: stiffness of the taxels across their axes, N/m; one number, or (n_taxels,). Default: the stiffness along the axes.

        Returns a dict of arrays at the end of the slide. For a single pose, the arrays have no axis n. The keys are:

        - deflection: metres, (n, ny, nx) for a grid, and (n, n_taxels) for another patch;
        - force3: force of the objects on each taxel, newtons, (n, n_taxels, 3), in the patch frame;
        - is_slipping: whether the contact of the taxel slipped in the last step, in the shape of the deflections;
        - wrench: force and torque on the patch about its origin, newtons and newton metres, (n, 6), in the patch frame;
        - travel: travel of the patch along z, metres, (n,). If the path misses all objects, the travel is NaN and all other results are zero.

        Raises ValueError if an argument is invalid.
        """

@final
class Step:
    """Step of a signal chain, created by one of the static methods. Chain checks whether a step is valid."""

    @staticmethod
    def force() -> Step:
        """Returns a step that converts deflections to forces k δ + c δ̇, newtons."""

    @staticmethod
    def noise(std: float, unit: Literal["full_scale", "mm", "n"] = "full_scale") -> Step:
        """Returns a step that adds Gaussian noise to every taxel.

        std: standard deviation, zero or more.
        unit: unit of std. full_scale is the fraction of the signal of a taxel at its stroke, mm is millimetres, n is newtons.
        """

    @staticmethod
    def smoothing(width: float) -> Step:
        """Returns a step that smooths frames with a Gaussian of standard deviation `width` (metres, zero or more)."""

    @staticmethod
    def error(name: str, **strengths: float) -> Step:
        """Returns a step with a sensor error, such as Step.error("gain", gain_std=0.07). If a name or a strength is invalid, raises ValueError, which
        lists the allowed ones.

        errors() returns all errors. Errors of an individual sensor (gain, drift, faults) are drawn from the chain's skin_seed.
        """

    @staticmethod
    def errors() -> dict[str, dict[str, str]]:
        """Returns all sensor errors, as a dict from the name of an error to its strengths. The strengths are a dict from the name of a strength to its
        allowed values, as text.
        """

@final
class Chain:
    """Signal chain: a sequence of steps from deflections to sensor signals, prepared for a patch.

    Example: Chain([Step.error("gain", gain_std=0.05), Step.noise(0.02), Step.smoothing(4e-3)], patch, skin_seed=7)

    skin_seed: seed of the individual sensor's gains, drift and faults, 0 or above.
    of_force: whether input frames are in newtons.

    Raises ValueError if the patch, or the order of the steps, does not allow a step.
    """

    def __new__(
        cls, steps: Sequence[Step], patch: Patch, *, skin_seed: int = 0, of_force: bool = False
    ) -> Chain: ...
    def __call__(
        self,
        frames: ArrayLike,
        *,
        seed: int = 0,
        first: int = 0,
        rates: ArrayLike | None = None,
        threads: int | None = None,
    ) -> NDArray[np.float64]:
        """Returns the sensor signals of frames; each frame is treated as a separate touch at rest.

        frames: deflections, metres, shape (n, …) with n_taxels numbers per frame, (n, ny, nx) for a grid, or one frame. The array is not changed.
        seed: seed of the random values that change from touch to touch. Frame i uses the random numbers of touch `first` + i, independently of other
        frames.
        rates: deflection rates δ̇, m/s, in the shape of the frames; None: 0.
        threads: maximum number of threads; all cores if None.

        Returns a float64 array of the shape of the frames, in the unit of `quantity`. Raises ValueError if an argument is invalid.
        """

    def read_touch(
        self,
        frames: ArrayLike,
        *,
        seed: int = 0,
        n_before: int = 0,
        interval: float | None = None,
        time: float | None = None,
        rates: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Returns the sensor signals of the frames of one touch, in order of time. With hysteresis or a scan order, a signal depends on several frames.

        n_before: number of leading frames that affect later frames, but are not returned.
        interval: time between frames, seconds. Default: the press stops at each frame until all taxels are read.
        time: elapsed fraction of the session, 0 to 1, for drift. Default: random, from the seed.

        Returns (n − n_before, …). Raises ValueError if an argument is invalid.
        """

    @property
    def quantity(self) -> str:
        """Physical quantity of the returned signals: deflection (metres) or force (newtons)."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """Steps of the chain, in order."""

@final
class Projection:
    """Random projection y = Φx of frames with ny × nx taxels to m measurements; Φ is drawn once.

    Example: Projection("sbhe", patch.shape, 64, seed=7).

    ensemble: gaussian, bernoulli, circulant, sparse, sbhe, block_average, subsample, fourier, or identity (all taxels, for any m).
    n_measurements: 1 to the number of taxels.

    Raises ValueError if an argument is invalid.
    """

    def __new__(
        cls, ensemble: str, shape: tuple[int, ...], n_measurements: int, seed: int = 0
    ) -> Projection: ...
    def __call__(self, frames: ArrayLike) -> NDArray[np.float64]:
        """Returns the measurements (n, m) of frames (n, …) with n_taxels numbers per frame; (1, m) for one frame. The measurements of a frame are bitwise
        equal in any batch.
        """

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Measurement matrix Φ (m, n_taxels); computed on access."""

    @property
    def ensemble(self) -> str:
        """Name of the ensemble from which the measurement matrix is drawn."""

    @property
    def n_taxels(self) -> int:
        """Number of taxels per frame."""

    @property
    def n_measurements(self) -> int:
        """Number m of measurements per frame."""

    def __getnewargs__(self) -> tuple[str, tuple[int, int], int, int]: ...

@final
class Reconstructor:
    """Reconstructor of frames from the measurements of one projection, with a basis fitted to training frames.

    Example: Reconstructor(projection, training, basis="pca", solver="lmmse", noise=1e-4).

    training: frames (n, ny, nx), metres.
    basis: dct, haar, daubechies4 (both for sides that are powers of two) or pca.
    n_atoms: number of atoms, for pca the components of largest variance. Default: all atoms, or 256 of pca.
    solver: omp (orthogonal matching pursuit), l1 (basis pursuit by FISTA) or lmmse (linear minimum mean square error estimate).
    noise: standard deviation on each taxel, in the unit of the frames.

    Raises ValueError if an argument is invalid.
    """

    def __new__(
        cls,
        projection: Projection,
        training: ArrayLike,
        *,
        basis: str = "pca",
        solver: str = "lmmse",
        n_atoms: int | None = None,
        noise: float = 0.0,
        seed: int = 0,
    ) -> Reconstructor: ...
    def __call__(self, measurements: ArrayLike) -> dict[str, NDArray[Any]]:
        """Reconstructs frames from measurements (n, m).

        Returns a dict: frames (n, ny, nx); the numbers of atoms used, n_atoms (n,); is_capped (n,), whether the solver stopped at a limit.
        """

@final
class Robot:
    """Robot of a URDF or MJCF file: links, joints and their poses. Use Robot.read.

    The base of a URDF robot is the link that no joint moves. The base of an MJCF robot is the link `world`; the other links are the bodies and, after them,
    the sites with a name.
    """

    @staticmethod
    def read(file: _Path, packages: Mapping[str, _Path] | None = None) -> Robot:
        """Reads a robot from a URDF or MJCF file. The root element determines the format.

        packages: folders by the names of packages, for meshes at package://NAME/…. If None, packages are searched in the folders above the file.

        Parts of the file that are not used are listed in `notes`. Mesh files are opened only by mesh(). Raises OSError if the file cannot be read, and
        ValueError if a part that places links is invalid.
        """

    @property
    def name(self) -> str:
        """Name of the robot."""

    @property
    def links(self) -> list[str]:
        """Names of all links."""

    @property
    def joints(self) -> list[Joint]:
        """Joint positions that `q` contains, in the order of `q`."""

    @property
    def notes(self) -> list[str]:
        """Remarks on parts of the file that are not used."""

    def pose(
        self, link: str, q: Mapping[str, ArrayLike] | ArrayLike | None = None, *, base: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """Returns the pose of a link in the world for joint positions `q`.

        q: dict from the names of joints to positions, numbers or (n,), radians and metres; or an array (d,) or (n, d) in the order of `joints`. Joints that the
        dict does not contain, and all joints without q, have their default positions. Limits are not checked.
        base: pose of the base in the world, (7,) or (4, 4). Default: the identity.

        Returns x, y, z, qw, qx, qy, qz: (7,), or (n, 7) for n positions. Raises ValueError if an argument is invalid.
        """

    def mesh(self, link: str, *, shapes: Literal["collision", "visual"] | None = None, pitch: float = 1e-3) -> Mesh:
        """Returns the surface of a link as a mesh in the link's frame, for example for Patch.draped.

        shapes: collision or visual. If None, the collision shapes are used, or the visual shapes if the link has no collision shapes.
        pitch: distance of the taxels for which the facets of round shapes are fine enough, metres.

        Raises ValueError if the link has no such shapes, or a mesh file is not found or invalid.
        """

@final
class Joint:
    """Joint position of a Robot. Fixed joints and joints that mimic others have none."""

    @property
    def name(self) -> str:
        """Name of the joint. A joint of several positions has the suffixes .x, .y, .z, .roll, .pitch, .yaw or .theta."""

    @property
    def kind(self) -> str:
        """Kind of the joint: revolute, continuous, prismatic, planar, floating or ball."""

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest position, radians or metres; infinite without a limit."""

    @property
    def default(self) -> float:
        """Position if `q` does not contain the joint: in URDF 0 or the limit nearest to 0, in MJCF `ref`."""

@final
class Simulation:
    """Simulation of a scene, created from the scene's text; use bubbletouch.simulate for a file or a dict.

    The simulation is an iterator over the frames of the scene. Alternatively, a program moves objects and robots step by step with set_…(),
    step(dt) and observe(). Threads that share a simulation wait for each other. A frame is a dict:

    - time: seconds;
    - patches: dict from the name of a patch to its reading, see below;
    - objects: dict from the name of an object to a dict: pose (7,) in the world, and held: imposed, pressed, at rest, unsettled or escaped.

    The reading of a patch is a dict:

    - pose: (7,) in the world;
    - deflection and force: metres and newtons, (ny, nx) for taxels in rows and columns, otherwise (n_taxels,);
    - force3: force of the objects on each taxel, newtons, (n_taxels, 3), in the patch frame; the sum equals the force of the wrench;
    - signal: sensor signals in the shape of the deflections, or None;
    - wrench: force and torque on the patch, newtons and newton metres, (6,), in the patch frame;
    - n_touched and n_saturated: numbers of taxels.
    """

    def __new__(
        cls, text: str, place: str, folder: _Path, models: dict[str, Mesh | SphereUnion]
    ) -> Simulation: ...
    def reset(self, seed: int | None = None) -> None:
        """Resets the simulation to the state before the first frame, and removes all manual settings. The sensor is unchanged. The noise of the readings
        is drawn from `seed` (default: the scene's seed). Raises ValueError if the seed is invalid.
        """

    def step(self, dt: float) -> None:
        """Advances the simulation by `dt` seconds. Manually set poses are reached; all other motions follow the scene. Raises ValueError if `dt` is not
        positive, or a pose overflows.
        """

    def observe(self, *, out: dict[str, Any] | None = None) -> dict[str, Any]:
        """Returns the current state as a frame. Before any step, the state is the first frame of the scene. Raises ValueError if a pose overflows.

        out: a frame that observe() of an equal simulation returned. Its arrays receive the new values, and the frame is returned. In a loop this is
        faster, because no arrays are allocated.
        """

    def set_object_pose(self, object: str, pose: ArrayLike) -> None:
        """Sets the pose of an object in the world from the next step on: (7,) or (4, 4). A free object comes to rest from this pose. Raises ValueError if
        an argument is invalid.
        """

    def set_robot_pose(self, robot: str, pose: ArrayLike) -> None:
        """Sets the pose of a robot's base in the world from the next step on: (7,) or (4, 4). Raises ValueError if an argument is invalid."""

    def set_joint_positions(self, robot: str, positions: ArrayLike) -> None:
        """Sets the joint positions of a robot from the next step on: (n_joints,) in the order of `robots`, radians and metres. Raises ValueError if an
        argument is invalid.
        """

    def patch(self, name: str) -> Patch:
        """Returns the patch with this name, in the patch frame. If there is none, raises ValueError."""

    @property
    def time(self) -> float:
        """Time since the start of the scene, seconds, in the current state."""

    @property
    def robots(self) -> dict[str, list[str]]:
        """Dict from the name of each robot to the names of its movable joints."""

    def __iter__(self) -> Simulation: ...
    def __next__(self) -> dict[str, Any]: ...
    @property
    def n_frames(self) -> int:
        """Number of frames in the whole scene."""

    @property
    def output_rate(self) -> float:
        """Number of frames per second of simulated time."""

    @property
    def patches(self) -> list[str]:
        """Names of all patches of the scene."""

    @property
    def objects(self) -> list[str]:
        """Names of all objects of the scene."""

    @property
    def title(self) -> str:
        """Title of the scene."""

@final
class KernelSvm:
    """Trained kernel SVM for labels 0, 1, …, used by bubbletouch.learning.SVC. Pickling stores its training rows; unpickling trains it again."""

    @staticmethod
    def train(features: ArrayLike, labels: ArrayLike, params: dict[str, Any]) -> KernelSvm:
        """Trains an SVM on features (n, m) and labels (n,). Raises ValueError if an argument is invalid."""

    def labels(self, features: ArrayLike) -> NDArray[np.int64]:
        """Returns the predicted labels (n,) of features (n, m). If several classes have the most votes, the lowest label is returned."""

    def decision_values(self, features: ArrayLike) -> NDArray[np.float64]:
        """Returns the decision values (n, n_problems); positive values favour a problem's positive class."""

    def class_scores(self, values: ArrayLike) -> NDArray[np.float64]:
        """Returns the scores (n, n_classes) of decision values (n, n_problems). A score of one-vs-one is the number of votes plus a term between −1/3 and 1/3."""

    @property
    def problems(self) -> list[dict[str, Any]]:
        """Binary problems of the SVM, one dict each. A dict contains the classes, the training rows, the signed multipliers, ρ (negative bias), the objective,
        the number of iterations, and whether the solver stopped at the iteration cap.
        """

    @property
    def n_capped(self) -> int:
        """Number of binary problems whose training stopped at the iteration cap."""

@final
class LinearModel:
    """Trained linear SVM without a kernel matrix for labels 0, 1, …, used by bubbletouch.learning.LinearSVC. Pickling stores its training rows;
    unpickling trains it again.
    """

    @staticmethod
    def train(features: ArrayLike, labels: ArrayLike, params: dict[str, Any]) -> LinearModel:
        """Trains a linear SVM on features (n, m) and labels (n,). Raises ValueError if an argument is invalid."""

    def labels(self, features: ArrayLike) -> NDArray[np.int64]:
        """Returns the predicted labels (n,) of features (n, m)."""

    def scores(self, features: ArrayLike) -> NDArray[np.float64]:
        """Returns the scores (n, n_classes); the class with the largest score is predicted."""

    @property
    def weights(self) -> NDArray[np.float64]:
        """Weights of the linear model (n_classes, m)."""

    @property
    def bias(self) -> NDArray[np.float64]:
        """Biases of the linear model (n_classes,)."""

    @property
    def n_passes(self) -> int:
        """Number of passes over the training rows: the largest number of any binary problem."""

    @property
    def n_capped(self) -> int:
        """Number of binary problems that stopped at max_passes."""

def choose_svm(
    features: ArrayLike,
    labels: ArrayLike,
    params: dict[str, Any],
    folds: Sequence[tuple[ArrayLike, ArrayLike]],
    c: Sequence[float],
    gamma_scales: Sequence[float],
) -> dict[str, Any]:
    """Evaluates all pairs of C and γ by cross-validation; all pairs share one matrix of inner products.

    gamma_scales: values of γ as multiples of 'scale'; if empty, γ is unchanged.

    Returns a dict with the best C, gamma and accuracy, with `tried` (tuples of C, γ and accuracy) and with n_capped.
    """

def touch_poses(
    object: _Model,
    *,
    offset: ArrayLike | None = None,
    yaw: ArrayLike | None = None,
    tilt: ArrayLike | None = None,
    rest: int | None = None,
) -> NDArray[np.float64]:
    """Returns object poses for Patch.press: the object lies on a table under a patch that faces down.

    The object stands with its own z axis up or, with `rest`, in the stable pose of that number (0: the most probable). Its bounding box is centred
    at x = y = 0 and turned by `yaw` about the vertical. The axis of the patch goes through `offset` (x, y) at the height of the object's top. The
    axis is tilted by `tilt` about the patch's x axis, then about its y axis.

    offset: metres, (2,) or (n, 2).
    tilt: radians, (2,) or (n, 2).
    yaw: radians, one number or (n,).

    Returns (7,) if all arguments are single values, otherwise (n, 7). Raises ValueError if an argument is invalid.
    """

def column_families(names: list[str]) -> tuple[str, str] | None:
    """Returns a list of the families of columns, and the pattern of the largest family; None if all names differ in numbers alone."""

def read_table(path: str) -> tuple[list[str] | None, list[list[str]], list[int], list[str]]:
    """Reads a table in a text file. Returns the names of its columns, or None without a header; the cells of each column; the numbers of the columns that do
    not count the rows; and notes on what was left out. Raises ValueError if the lines differ in the number of cells.
    """

def run_audit(
    files: Mapping[str, _Path],
    order: str | None,
    columns: str | None,
    grid: tuple[int, int] | None,
    full_scale: float | None,
    before_contact: tuple[int, int] | None,
    untouched: Sequence[int],
    split: str | None,
    not_claimed: Sequence[str] | None,
    seed: int,
    permutations: int,
    name: str,
    out: _Path,
) -> list[tuple[str, str, str, dict[str, Any]]]:
    """Audits files, by their names `data`, `labels`, `groups`, `sessions`, `times`, `lengths`, `frames_test`, `labels_test`, `groups_test` and `lengths_test`, as the
    command `bubbletouch audit` does. Writes the page, tables and charts to a folder. Returns the tables; the first one lists the findings.
    """

def rename_old_results(folder: _Path) -> None:
    """Renames a result folder to FOLDER.1, FOLDER.2, …; does nothing if it does not exist."""

def run_study(
    study: dict[str, Any], callback: Callable[[str, int, int], object] | None = None
) -> list[tuple[str, str, str, dict[str, Any]]]:
    """Runs a study and writes its results into a folder. Returns the file name, title, note and columns of each table. The study is a dict of text (TOML), place,
    name, folder, out, seed, classifiers, features, shard, merges and threads. Classifiers and features are tuples of name, version and object. A shard, such as
    `3/8`, writes its journal alone and returns no tables.
    """

def advise(
    results: _Path,
    reach: float | None,
    budget: float | None,
    value: str | None,
    cost: str | None,
    table: str | None,
    given: list[str],
    worst: bool,
    limits: list[tuple[str, float]],
) -> str:
    """Returns advice from the results in a folder, as JSON: the cheapest configuration with a minimum quality, or the best one within a cost. Raises
    ValueError if there is no such configuration, or an argument is invalid.
    """

def toml_of(json: str) -> str:
    """Converts a study from JSON to TOML."""

def with_recorded(text: str, place: str, json: str) -> str:
    """Returns the TOML text of a study whose table `[recorded]` contains the keys of a JSON object. Keys of the study that the object lacks are kept. Raises
    ValueError, which names `place`, if the text is no TOML.
    """

def write_frame(path: _Path, frame: ArrayLike, pitch: float) -> None:
    """Writes the deflections (ny, nx; metres) of a grid with this pitch (metres) to a file. The extension selects a picture (.png), a table (.csv) or
    arrays (.npz). Raises OSError if the file cannot be written, and ValueError if an argument is invalid.
    """

def _panic() -> None:
    """Panics; used in tests of the conversion to an exception."""
