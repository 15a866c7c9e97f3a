"""What Rust does. Lengths in metres, forces in newtons, angles in radians."""

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias, TypeVar, final, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

__all__ = [
    "Catalogue",
    "Chain",
    "Contacts",
    "InternalError",
    "KernelSvm",
    "LinearModel",
    "Mesh",
    "Patch",
    "Projection",
    "Reconstructor",
    "Simulation",
    "Solid",
    "SphereUnion",
    "Step",
    "_kernel_pace",
    "_panic",
    "advise",
    "choose_svm",
    "run_study",
    "toml_of",
    "touch_poses",
    "write_frame",
]

_Path: TypeAlias = str | PathLike[str]
_Unit: TypeAlias = Literal["m", "cm", "mm", "in"]
_Model: TypeAlias = Mesh | SphereUnion
_Out = TypeVar("_Out", NDArray[np.float32], NDArray[np.float64])

class InternalError(RuntimeError):
    """A bug of bubbletouch itself, wherever it was called from: its text asks for a report."""

@final
class Mesh:
    """A triangle mesh with exact contact: taxels touch its faces, edges and corners, from both sides.

    `Mesh(vertices, triangles)`: vertices (n, 3), metres; triangles (m, 3), numbers of vertices from 0, counter-clockwise seen from outside.
    Raises ValueError for numbers that are not finite and for vertices that do not exist.
    """

    def __new__(cls, vertices: ArrayLike, triangles: ArrayLike) -> Mesh: ...
    @staticmethod
    def read(path: _Path, *, unit: _Unit | None = None, close_holes: float | None = None) -> Mesh:
        """Reads a PLY, OBJ or STL file.

        unit: unit of the file's numbers. None: metres, for objects of 0.1 mm to 10 m.
        close_holes: largest width of holes that are closed by a cone, metres.

        Closed parts that face inwards are turned outwards, with a UserWarning. Raises OSError if the file cannot be read, and ValueError if it
        contains no such mesh.
        """

    def pack(self, tolerance: float, *, sheet: bool = False) -> SphereUnion:
        """Packs the solid enclosed by the mesh with few spheres, on all cores.

        No sphere extends more than tolerance / 2 (metres, positive) beyond the surface. No point of the surface is more than the tolerance outside
        the spheres. Both bounds are verified; otherwise ValueError is raised. The mesh must be closed. Parts that face inwards are turned
        outwards, with a UserWarning. With sheet=True, the surface is packed as a sheet without thickness. A scan of 16,000 triangles takes
        seconds. Ctrl-C ends the call.
        """

    def vertex_spheres(self) -> SphereUnion:
        """Returns one sphere per vertex, with twice the mean distance to the nearest other vertex as radius: the objects of the original BubbleTouch."""

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Vertices (n, 3), metres; a copy."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Triangles (m, 3), as numbers of vertices; a copy."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Bounding box (2, 3): its least and its greatest corner, metres."""

    @property
    def area(self) -> float:
        """Surface area, m²."""

    @property
    def volume(self) -> float:
        """Volume, m³; negative if the triangles of the given arrays face inwards."""

    @property
    def centroid(self) -> NDArray[np.float64]:
        """Centroid of the volume (3,), metres."""

    def __len__(self) -> int:
        """How many triangles."""

    def __getnewargs__(self) -> tuple[NDArray[np.float64], NDArray[np.uint32]]: ...

@final
class SphereUnion:
    """A union of rigid spheres.

    `SphereUnion(centers, radii)`: centers (n, 3), metres; radii (n,) or one number, metres, positive. Raises ValueError with the number of the
    first invalid sphere, from 1.
    """

    def __new__(cls, centers: ArrayLike, radii: ArrayLike) -> SphereUnion: ...
    @staticmethod
    def read(path: _Path, *, unit: _Unit | None = None) -> SphereUnion:
        """Reads a CSV file with columns x, y, z, r in metres, or in another unit.

        Raises OSError if the file cannot be read, and ValueError if it contains no such spheres.
        """

    def write(self, path: _Path) -> None:
        """Writes a CSV file from which read() returns bitwise equal spheres. Raises OSError; an existing file is then kept."""

    @property
    def centers(self) -> NDArray[np.float64]:
        """Centres (n, 3), metres; a copy."""

    @property
    def radii(self) -> NDArray[np.float64]:
        """Radii (n,), metres; a copy."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Bounding box (2, 3): its least and its greatest corner, metres."""

    def __len__(self) -> int:
        """How many spheres."""

    def __getnewargs__(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...

@final
class Solid:
    """An object of a catalogue: a union of parametric shapes with real dimensions. It rests on z = 0; its bounding box is centred at x = y = 0."""

    @property
    def name(self) -> str: ...
    @property
    def set(self) -> str:
        """Name of the set: balls, boxes, cans, household, hands, or the name of a file."""

    @property
    def source(self) -> str:
        """Source of the dimensions."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Bounding box (2, 3): its least and its greatest corner, metres."""

    def pack(self, tolerance: float) -> SphereUnion:
        """Returns spheres whose surface is within the tolerance (metres, positive) of the solid's surface. Raises ValueError."""

@final
class Catalogue:
    """Catalogue of named objects, grouped in named sets."""

    @staticmethod
    def builtin() -> Catalogue:
        """Returns the catalogue that comes with bubbletouch: balls, boxes, cans, household objects and hands."""

    @staticmethod
    def read(path: _Path) -> Catalogue:
        """Reads a TOML file of objects. Raises OSError, or ValueError with the line of the file."""

    @property
    def names(self) -> list[str]:
        """Names of all objects, set by set."""

    @property
    def sets(self) -> list[str]: ...
    def object(self, name: str) -> Solid:
        """Returns the object with this name. Raises ValueError with similar names."""

    def set(self, name: str) -> list[Solid]:
        """Returns the objects of a set. Raises ValueError with the names of the sets."""

    def __len__(self) -> int: ...

@final
class Contacts:
    """Contacts of n presses: m pairs of a taxel and the part of the object that touches it, in the order of poses and taxels."""

    @property
    def pose(self) -> NDArray[np.int64]:
        """Number of the pose (m,), from 0."""

    @property
    def taxel(self) -> NDArray[np.int64]:
        """Number of the taxel (m,), in the order of the patch."""

    @property
    def part(self) -> NDArray[np.int64]:
        """Number of the sphere or triangle (m,) that determines the deflection."""

    @property
    def deflection(self) -> NDArray[np.float64]:
        """Deflection (m,), metres; equals the frame up to rounding."""

    @property
    def normal(self) -> NDArray[np.float64]:
        """Contact normal (m, 3): unit vector from the object's surface to the taxel, in the frame of the patch."""

    @property
    def point(self) -> NDArray[np.float64]:
        """Contact point (m, 3), metres, in the frame of the patch."""

    @property
    def force(self) -> NDArray[np.float64]:
        """Frictionless force of the taxel's spring on the object (m, 3), newtons, in the frame of the patch."""

    @property
    def gradient(self) -> NDArray[np.float64]:
        """Gradient ∂δ/∂x (m, 3) for a motion x of the part in the frame of the patch, before the taxel's stop. Its length is ∂δ/∂R for a sphere's
    radius R.
    """

    @property
    def travel(self) -> NDArray[np.float64]:
        """Travel of the patch along its z (n,), metres; NaN if no taxel met the object."""

    @property
    def n_touched(self) -> NDArray[np.int64]:
        """Number of taxels with a deflection (n,)."""

    @property
    def n_saturated(self) -> NDArray[np.int64]:
        """Number of saturated taxels (n,): at their stroke, and pushed further by the object."""

    def __len__(self) -> int: ...

@final
class Patch:
    """Taxels on a rigid substrate; created by one of the static methods.

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
        """Returns a grid of ny rows (along y, ascending) of nx taxels in the plane z = 0, `pitch` metres apart, centred on the origin. Frames are (ny,
    nx).
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
        """Returns ny staggered rows of nx taxels. Each inner taxel has six neighbours `pitch` metres away. The order is row by row."""

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
        """Returns the taxels of a hexagonal lattice within `radius` metres of the origin, row by row."""

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
        """Returns rings of taxels around z, facing away from z: a forearm or a finger.

        radius: of the rest centres; length: between the first and the last ring, zero or more; arc: above 0 to 2π, centred at +x; pitch: along
        the surface, approximated by a whole number of taxels. Presses go along z: use move() to turn the middle of the patch to z.
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
        """Returns rings of taxels on a sphere about the origin, from its pole at +z to `half_angle` (above 0 to π): a fingertip or an elbow."""

    @staticmethod
    def draped(
        mesh: Mesh,
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
        """Returns taxels distributed over the outer surface of a mesh.

        Their number equals that of a grid with this pitch; they are at least 0.83 pitches apart. The call takes 0.3 ms per taxel. A taxel whose
        axis would meet the mesh again is left out: see n_left_out. The region is the intersection of the given conditions: bounds (2, 3), its
        least and greatest corner; plane (2, 3), a point and the direction to the covered side; triangles, their numbers. Closed parts of the mesh
        that face inwards are turned outwards, with a UserWarning.
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
    ) -> Patch:
        """Returns a patch of given taxels: centers (n, 3) and unit axes (n, 3) that point away from the substrate. Axes may differ from unit length by
    1 %, and are normalised. The other arguments are (n,) or one number for all.
    """

    @staticmethod
    def read(
        path: str | PathLike[str],
        stroke: float,
        *,
        mesh: Mesh | None = None,
        sensor: str | None = None,
        taxel_radius: float | None = None,
        stiffness: float = 100.0,
        damping: float = 0.0,
    ) -> Patch:
        """Returns the taxels of a layout file.

        path: .csv (x_mm, y_mm, z_mm, nx, ny, nz, optional radius_mm, row, column); .npz (positions and normals, or poses and taxel2pixel as for
        DEX-01); .txt or .ini (iCub); .json (PaXini, with `mesh` for the normals); .urdf (<tactile> of urdf_tactile, or XELA's prismatic joints, with
        `sensor` if there are several). Default radius: the file's, or half the median distance of neighbours. Notes of the reader are UserWarnings.
        """

    def write(self, path: str | PathLike[str]) -> None:
        """Writes the layout as a CSV file that `read` reads: x_mm, y_mm, z_mm, nx, ny, nz, radius_mm, and row and column if the patch has pixels."""

    @property
    def pixels(self) -> NDArray[np.int64] | None:
        """Row and column of each taxel in the sensor's image, (n_taxels, 2) integers; None if the layout file has no image."""

    def moved(self, pose: ArrayLike) -> Patch:
        """Returns a copy moved in the frame of the patch; the copy is not a grid. pose: (7,) or (4, 4)."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a frame: (ny, nx) for a grid, otherwise (n_taxels,)."""

    @property
    def n_taxels(self) -> int: ...
    @property
    def n_left_out(self) -> int:
        """Number of taxels left out of a draped patch because their axes would meet the mesh again; 0 for other patches."""

    @property
    def centers(self) -> NDArray[np.float64]:
        """Rest centres (n_taxels, 3), metres; a copy."""

    @property
    def axes(self) -> NDArray[np.float64]:
        """Unit axes (n_taxels, 3), away from the substrate; a copy."""

    @property
    def pitch(self) -> float | None:
        """Distance between the taxels of a grid, metres; None for other patches."""

    @property
    def taxel_radius(self) -> float | NDArray[np.float64]:
        """Radius of the taxels, metres: one number, or one per taxel."""

    @property
    def stroke(self) -> float | NDArray[np.float64]:
        """Largest deflection, metres: one number, or one per taxel. A taxel whose deflection equals its stroke is saturated."""

    @property
    def stiffness(self) -> float | NDArray[np.float64]:
        """Stiffness, N/m: one number, or one per taxel."""

    @property
    def damping(self) -> float | NDArray[np.float64]:
        """Damping, N·s/m: one number, or one per taxel."""

    def __len__(self) -> int: ...
    @overload
    def press(
        self,
        object: _Model,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        out: _Out,
        dtype: DTypeLike | None = None,
        threads: int | None = None,
        contacts: Literal[False] = False,
        jacobian: Literal[False] = False,
    ) -> _Out: ...
    @overload
    def press(  # type: ignore[overload-overlap]
        self,
        object: _Model,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        out: None = None,
        dtype: type[np.float32] | Literal["float32"],
        threads: int | None = None,
        contacts: Literal[False] = False,
        jacobian: Literal[False] = False,
    ) -> NDArray[np.float32]: ...
    @overload
    def press(
        self,
        object: _Model,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        out: None = None,
        dtype: type[np.float64] | Literal["float64"] | None = None,
        threads: int | None = None,
        contacts: Literal[False] = False,
        jacobian: Literal[False] = False,
    ) -> NDArray[np.float64]: ...
    @overload
    def press(
        self,
        object: _Model,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        out: _Out,
        dtype: DTypeLike | None = None,
        threads: int | None = None,
        contacts: Literal[True],
        jacobian: Literal[False] = False,
    ) -> tuple[_Out, Contacts]: ...
    @overload
    def press(
        self,
        object: _Model,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        out: None = None,
        dtype: type[np.float64] | Literal["float64"] | None = None,
        threads: int | None = None,
        contacts: Literal[True],
        jacobian: Literal[False] = False,
    ) -> tuple[NDArray[np.float64], Contacts]: ...
    @overload
    def press(
        self,
        object: _Model,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        out: None = None,
        dtype: type[np.float64] | Literal["float64"] | None = None,
        threads: int | None = None,
        contacts: Literal[False] = False,
        jacobian: Literal[True],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    @overload
    def press(
        self,
        object: _Model,
        poses: ArrayLike,
        *,
        depth: ArrayLike | None = None,
        travel: ArrayLike | None = None,
        force: ArrayLike | None = None,
        out: NDArray[np.float32] | NDArray[np.float64] | None = None,
        dtype: DTypeLike | None = None,
        threads: int | None = None,
        contacts: bool = False,
        jacobian: bool = False,
    ) -> Any:
        """Presses the patch on an object at n poses; returns the deflections of the taxels, metres, from 0 to the stroke.

        poses: the object in the frame of the patch, (n, 7) of x, y, z, qw, qx, qy, qz or (n, 4, 4); (7,) or (4, 4) for a single pose.

        The patch approaches along its z. At most one of the following goals is given, as one number for all poses or (n,):

        - depth: metres past first contact, zero or more;
        - travel: metres from the given pose;
        - force: newtons, the sum Σ k δ of all springs.

        Without a goal, the patch is read at the pose. If the patch meets nothing, the deflections are zero.

        out: C-contiguous array of float32 or float64 for the frames; it is returned. dtype: of a new array, float64 or float32.
        threads: maximum number of threads; all cores if None. The call releases the interpreter's lock, and Ctrl-C ends it.

        Returns (n, ny, nx) for a grid, and (n, n_taxels) for another patch; without n for a single pose. The result is bitwise equal for any number
        of threads. With contacts=True, the Contacts are returned too; the frames are unchanged. With jacobian=True, the derivatives (…, 6) of the
        deflections are returned too: per metre along x, y, z, and per radian about x, y, z through the object's origin, in the axes of the patch.
        They are zero for free and saturated taxels. With a depth or a force, the derivatives include the change of the travel; a depth then needs a
        flat patch.

        Raises ValueError for arrays of a wrong shape or type, numbers that are not finite, and a force that cannot be reached.
        """

@final
class Step:
    """A step from deflections to sensor signals; created by one of the static methods. Chain checks whether a step is valid."""

    @staticmethod
    def force() -> Step:
        """Returns a step that converts deflections to forces k δ + c δ̇, newtons."""

    @staticmethod
    def noise(std: float, unit: Literal["full_scale", "mm", "n"] = "full_scale") -> Step:
        """Returns a step that adds Gaussian noise to every taxel. unit: fraction of full scale (of a taxel at its stroke), millimetres, or newtons;
    std: zero or more.
    """

    @staticmethod
    def smoothing(width: float) -> Step:
        """Returns a step that smooths frames with a Gaussian of standard deviation `width`, metres, zero or more."""

    @staticmethod
    def error(name: str, **strengths: float) -> Step:
        """Returns a step with a sensor error, such as Step.error("gain", gain_std=0.07). Raises ValueError with the allowed names or strengths.

        errors() lists all errors. Errors of an individual sensor (gain, drift, faults) are drawn from the chain's skin_seed.
        """

    @staticmethod
    def errors() -> dict[str, dict[str, str]]:
        """Returns the strengths of each sensor error, and the allowed values of each strength."""

@final
class Chain:
    """A sequence of steps from deflections to sensor signals, prepared for a patch.

    Chain([Step.error("gain", gain_std=0.05), Step.noise(0.02), Step.smoothing(4e-3)], patch, skin_seed=7)

    skin_seed: number of the individual sensor, which has its own gains, drift and faults; 0 and above. of_force: whether input frames are in
    newtons. Raises ValueError if the patch, or the order of the steps, does not allow a step.
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
        """Returns the sensor signals of frames; each frame is a separate touch at rest.

        frames: deflections (n, …) of n_taxels each, (n, ny, nx) of a grid, metres, or one frame; they are not changed. seed: of random values that
        change from touch to touch. Frame i uses the random numbers of touch `first` + i, independently of other frames. rates: δ̇, m/s, in the
        shape of the frames. Returns a float64 array of the shape of the frames, in the unit of `quantity`. Raises ValueError.
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
        """Returns the sensor signals of the frames of one touch, in order of time; hysteresis and scan order connect the frames.

        n_before: number of leading frames that affect later frames, but are not returned. interval: seconds between frames; None: the press waits
        at each frame. time: elapsed fraction of the session, 0 to 1, for drift. Returns (n − n_before, …). Raises ValueError.
        """

    @property
    def quantity(self) -> str:
        """Quantity of the returned signals: deflection (metres) or force (newtons)."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """Steps, in order."""

@final
class Projection:
    """A random projection y = Φx from frames of ny × nx taxels to m measurements, drawn once.

    Example: Projection("sbhe", patch.shape, 64, seed=7). ensemble: gaussian, bernoulli, circulant, sparse, sbhe, block_average, subsample,
    fourier, or identity (all taxels, for any m). n_measurements: 1 to the number of taxels. Raises ValueError.
    """

    def __new__(
        cls, ensemble: str, shape: tuple[int, ...], n_measurements: int, seed: int = 0
    ) -> Projection: ...
    def __call__(self, frames: ArrayLike) -> NDArray[np.float64]:
        """Returns the measurements (n, m) of frames (n, …) of n_taxels each; (1, m) for one frame. A row is bitwise equal in any batch."""

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Matrix Φ, (m, n_taxels); computed on access."""

    @property
    def ensemble(self) -> str:
        """Name of the ensemble."""

    @property
    def n_taxels(self) -> int:
        """Number of taxels of a frame."""

    @property
    def n_measurements(self) -> int:
        """Number of measurements m."""

    def __getnewargs__(self) -> tuple[str, tuple[int, int], int, int]: ...

@final
class Reconstructor:
    """Reconstructs frames from the measurements of one projection, with a basis fitted to training frames.

    Example: Reconstructor(projection, training, basis="pca", solver="lmmse", noise=1e-4). training: (n, ny, nx), metres.
    basis: dct, haar, daubechies4 (both for sides that are powers of two) or pca, which keeps the n_atoms components of largest variance. None
    keeps all atoms, and 256 of pca.
    solver: omp (matching pursuit), l1 (basis pursuit by FISTA) or lmmse (the linear estimate). noise: standard deviation on each taxel, in the
    unit of the frames. Raises ValueError.
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
        """Reconstructs measurements (n, m). Returns the frames (n, ny, nx), the number of atoms used n_atoms (n,), and is_capped (n,): whether the
    solver
    stopped at a limit.
    """

@final
class Simulation:
    """A scene, created from its text; use bubbletouch.simulate for a file or a dict.

    The simulation is an iterator over the frames of the scene. Alternatively, a program moves objects and robots step by step with set_…(),
    step(dt) and observe(). Frames are dicts:

    - time: seconds;
    - patches: for each patch, by name: pose (7,) in the world, deflection (ny, nx) or (n_taxels,) in metres, force in newtons of equal shape,
      force3 (n_taxels, 3) of the objects on each taxel in newtons in the frame of the patch (its sum is the wrench's force), signal (or None),
      wrench (6,) of force and torque on the patch in its frame, n_touched, n_saturated;
    - objects: for each object, by name: pose (7,) in the world, and held: imposed, pressed, at rest, unsettled or escaped.
    """

    def __new__(
        cls, text: str, place: str, folder: _Path, models: dict[str, Mesh | SphereUnion]
    ) -> Simulation: ...
    def reset(self, seed: int | None = None) -> None:
        """Resets the simulation to the state before the first frame, and removes everything set by hand. The sensor is unchanged. The noise of its
        readings is drawn from `seed` (None: the scene's seed). Raises ValueError.
        """

    def step(self, dt: float) -> None:
        """Advances the simulation by `dt` seconds. Poses set by hand are reached; everything else follows the scene. Raises ValueError."""

    def observe(self) -> dict[str, Any]:
        """Returns the current state as a frame; before any step, the first frame of the scene. Raises ValueError."""

    def set_object_pose(self, object: str, pose: ArrayLike) -> None:
        """Sets the pose of an object in the world from the next step on: (7,) or (4, 4). A free object comes to rest from this pose. Raises
    ValueError.
    """

    def set_robot_pose(self, robot: str, pose: ArrayLike) -> None:
        """Sets the pose of a robot's base in the world from the next step on: (7,) or (4, 4). Raises ValueError."""

    def set_joint_positions(self, robot: str, positions: ArrayLike) -> None:
        """Sets the joint positions of a robot from the next step on: (n_joints,) in the order of `robots`, radians and metres. Raises ValueError."""

    def patch(self, name: str) -> Patch:
        """Returns the patch with this name, in its own frame. Raises ValueError."""

    @property
    def time(self) -> float:
        """Time since the start, seconds."""

    @property
    def robots(self) -> dict[str, list[str]]:
        """For each robot, by name, the names of its movable joints."""

    def __iter__(self) -> Simulation: ...
    def __next__(self) -> dict[str, Any]: ...
    @property
    def n_frames(self) -> int:
        """Number of frames of the whole scene."""

    @property
    def output_rate(self) -> float:
        """Frames per second of the scene's time."""

    @property
    def patches(self) -> list[str]:
        """Names of the patches."""

    @property
    def objects(self) -> list[str]:
        """Names of the objects."""

    @property
    def title(self) -> str:
        """Title of the scene."""

@final
class KernelSvm:
    """A trained kernel SVM for labels 0, 1, …, used by bubbletouch.learning.SVC. It is pickled as its training rows, and trained again."""

    @staticmethod
    def train(features: ArrayLike, labels: ArrayLike, params: dict[str, Any]) -> KernelSvm:
        """Trains on features (n, m) and labels (n,). Raises ValueError."""

    def labels(self, features: ArrayLike) -> NDArray[np.int64]:
        """Returns the labels (n,) of features (n, m); of equally many votes, the lowest label wins."""

    def decision_values(self, features: ArrayLike) -> NDArray[np.float64]:
        """Returns the decision values (n, n_problems); positive values favour a problem's positive class."""

    @property
    def problems(self) -> list[dict[str, Any]]:
        """For each binary problem, its classes, training rows, signed multipliers, ρ, objective, iterations, and whether it was capped."""

    @property
    def n_capped(self) -> int:
        """Number of binary problems that stopped at the iteration cap."""

@final
class LinearModel:
    """A trained linear SVM without a kernel matrix for labels 0, 1, …, used by bubbletouch.learning.LinearSVC. It is pickled like KernelSvm."""

    @staticmethod
    def train(
        features: ArrayLike,
        labels: ArrayLike,
        c: float,
        tolerance: float,
        max_passes: int,
        seed: int,
    ) -> LinearModel:
        """Trains on features (n, m) and labels (n,). Raises ValueError."""

    def labels(self, features: ArrayLike) -> NDArray[np.int64]:
        """Returns the labels (n,) of features (n, m)."""

    def scores(self, features: ArrayLike) -> NDArray[np.float64]:
        """Returns the scores (n, n_classes); the largest score determines the label."""

    @property
    def weights(self) -> NDArray[np.float64]:
        """Weights (n_classes, m)."""

    @property
    def bias(self) -> NDArray[np.float64]:
        """Biases (n_classes,)."""

    @property
    def n_passes(self) -> int:
        """Largest number of passes over the rows of all problems."""

    @property
    def n_capped(self) -> int:
        """Number of problems that stopped at max_passes."""

def choose_svm(
    features: ArrayLike,
    labels: ArrayLike,
    params: dict[str, Any],
    folds: Sequence[tuple[ArrayLike, ArrayLike]],
    c: Sequence[float],
    gamma_scales: Sequence[float],
) -> dict[str, Any]:
    """Evaluates all γ and C over folds, on one matrix of products. γ values are multiples of 'scale'; without any, γ is unchanged. Returns the best
    C, the best γ, and tuples of C, γ and accuracy."""

def touch_poses(
    object: _Model,
    *,
    offset: ArrayLike | None = None,
    yaw: ArrayLike | None = None,
    tilt: ArrayLike | None = None,
    rest: int | None = None,
) -> NDArray[np.float64]:
    """Returns poses, for Patch.press, of an object that lies on a table under a patch that faces down.

    The object stands with its own z up or, with `rest`, in the stable pose of that number (0: the most probable). Its bounding box is centred
    at x = y = 0 and turned by `yaw` about the vertical. The axis of the patch goes through `offset` (x, y; metres) at the height of the
    object's top. It is tilted by `tilt` about the patch's x, then about its y.

    offset, tilt: (2,) or (n, 2); yaw: a number or (n,). Returns (7,) if all arguments are single values, otherwise (n, 7). Raises ValueError.
    """

def run_study(
    text: str,
    place: str,
    name: str,
    folder: _Path,
    out: _Path,
    seed: int | None = None,
    callback: Callable[[str, int, int], object] | None = None,
) -> list[tuple[str, str, str, dict[str, Any]]]:
    """Runs a study (TOML) into a folder; returns the file name, title, note and columns of each table."""

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
    """Returns advice from the results in a folder, as JSON: the cheapest configuration of a minimum quality, or the best within a cost. Raises
    ValueError.
    """

def toml_of(json: str) -> str:
    """Converts a study from JSON to TOML."""

def write_frame(path: _Path, frame: ArrayLike, pitch: float) -> None:
    """Writes the deflections (ny, nx; metres) of a grid with this pitch to a file. The extension selects a picture (.png), a table (.csv) or
    arrays (.npz). Raises OSError, or ValueError."""

def _kernel_pace(
    patch: Patch, object: _Model, poses: ArrayLike, depth: ArrayLike, seconds: float
) -> float: ...
def _panic() -> None: ...
