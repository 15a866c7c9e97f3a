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
    """A triangle mesh, touched exactly: taxels feel its faces, edges and corners, from both sides.

    `Mesh(vertices, triangles)`: vertices (n, 3), metres; triangles (m, 3), numbers of vertices from 0, counter-clockwise seen from
    outside. Raises ValueError for numbers that are not finite and vertices that are not there.
    """

    def __new__(cls, vertices: ArrayLike, triangles: ArrayLike) -> Mesh: ...
    @staticmethod
    def read(path: _Path, *, unit: _Unit | None = None, close_holes: float | None = None) -> Mesh:
        """A PLY, OBJ or STL file.

        unit: of the file's numbers; None: metres, and then an object of 0.1 mm to 10 m. close_holes: the widest hole that is closed by a
        cone, metres. Closed parts that face inwards are turned outwards, with a UserWarning. Raises OSError for a file that cannot be read,
        ValueError for one that is no such mesh.
        """

    def pack(self, tolerance: float, *, sheet: bool = False) -> SphereUnion:
        """Few spheres for the solid that the mesh encloses, on all cores.

        No sphere reaches more than tolerance / 2 (metres, positive) outside it, and no point of its surface is more than the tolerance
        outside the spheres: proved, or a ValueError. The mesh must be closed; parts that face inwards are turned outwards, with a
        UserWarning. With sheet=True its surface itself is packed, without thickness. Takes seconds for a scan of 16,000 triangles. Ctrl-C ends it.
        """

    def vertex_spheres(self) -> SphereUnion:
        """A sphere around each vertex, of twice the mean distance to the nearest other vertex: the objects of the original BubbleTouch."""

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(n, 3), metres; a copy."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(m, 3), numbers of vertices; a copy."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3): the least and the largest corner of the box around it, metres."""

    @property
    def area(self) -> float:
        """m²."""

    @property
    def volume(self) -> float:
        """m³; negative if the triangles of the arrays that it was made from face inwards."""

    @property
    def centroid(self) -> NDArray[np.float64]:
        """(3,): of the volume, metres."""

    def __len__(self) -> int:
        """How many triangles."""

    def __getnewargs__(self) -> tuple[NDArray[np.float64], NDArray[np.uint32]]: ...

@final
class SphereUnion:
    """A union of rigid spheres.

    `SphereUnion(centers, radii)`: centers (n, 3), metres; radii (n,) or one number, metres, positive. Raises ValueError, which names the
    first sphere (from 1) that cannot be.
    """

    def __new__(cls, centers: ArrayLike, radii: ArrayLike) -> SphereUnion: ...
    @staticmethod
    def read(path: _Path, *, unit: _Unit | None = None) -> SphereUnion:
        """A CSV file with columns x, y, z, r in metres, or in a unit.

        Raises OSError for a file that cannot be read, ValueError for one that holds no such spheres.
        """

    def write(self, path: _Path) -> None:
        """Writes a CSV file of which read() gives the same bits. Raises OSError; what stood there is kept then."""

    @property
    def centers(self) -> NDArray[np.float64]:
        """(n, 3), metres; a copy."""

    @property
    def radii(self) -> NDArray[np.float64]:
        """(n,), metres; a copy."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3): the least and the largest corner of the box around it, metres."""

    def __len__(self) -> int:
        """How many spheres."""

    def __getnewargs__(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...

@final
class Solid:
    """An object of a catalogue: a union of parametric shapes with real dimensions, resting on z = 0, its box centred at x = y = 0."""

    @property
    def name(self) -> str: ...
    @property
    def set(self) -> str:
        """The set that it belongs to: balls, boxes, cans, household, hands, or a file's name."""

    @property
    def source(self) -> str:
        """Where its dimensions are from."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3): the least and the largest corner of the box around it, metres."""

    def pack(self, tolerance: float) -> SphereUnion:
        """Spheres whose surface is within the tolerance (metres, positive) of the solid's. Raises ValueError."""

@final
class Catalogue:
    """Named objects in named sets."""

    @staticmethod
    def builtin() -> Catalogue:
        """The objects that come with bubbletouch: balls, boxes, cans, a household and hands."""

    @staticmethod
    def read(path: _Path) -> Catalogue:
        """A TOML file of objects. Raises OSError, or ValueError with the file's line."""

    @property
    def names(self) -> list[str]:
        """Of all objects, set by set."""

    @property
    def sets(self) -> list[str]: ...
    def object(self, name: str) -> Solid:
        """The object of a name. Raises ValueError, which offers names that resemble it."""

    def set(self, name: str) -> list[Solid]:
        """The objects of a set. Raises ValueError, which lists the sets."""

    def __len__(self) -> int: ...

@final
class Contacts:
    """Which part of the object touches which taxel: m contacts in the order of poses and taxels, and n poses."""

    @property
    def pose(self) -> NDArray[np.int64]:
        """(m,): number of the pose, from 0."""

    @property
    def taxel(self) -> NDArray[np.int64]:
        """(m,): number of the taxel, in the order of the patch."""

    @property
    def part(self) -> NDArray[np.int64]:
        """(m,): number of the sphere, or of the triangle, that decides how far the taxel goes."""

    @property
    def deflection(self) -> NDArray[np.float64]:
        """(m,): metres; that of the frame to rounding."""

    @property
    def normal(self) -> NDArray[np.float64]:
        """(m, 3): unit, from the object's surface to the taxel, in the frame of the patch."""

    @property
    def point(self) -> NDArray[np.float64]:
        """(m, 3): where they touch, metres, in the frame of the patch."""

    @property
    def force(self) -> NDArray[np.float64]:
        """(m, 3): of the taxel's spring on the object without friction, newtons, in the frame of the patch."""

    @property
    def gradient(self) -> NDArray[np.float64]:
        """(m, 3): ∂δ/∂x for a motion x of the part in the frame of the patch, before the taxel's stop; its length is ∂δ/∂R of a sphere's radius."""

    @property
    def travel(self) -> NDArray[np.float64]:
        """(n,): how far the patch went along its z, metres; NaN where no taxel met the object."""

    @property
    def n_touched(self) -> NDArray[np.int64]:
        """(n,): taxels with a deflection."""

    @property
    def n_saturated(self) -> NDArray[np.int64]:
        """(n,): taxels at their stroke that the object would push further."""

    def __len__(self) -> int: ...

@final
class Patch:
    """Taxels on a rigid substrate, made by one of its static methods.

    A taxel is a sphere of `taxel_radius` (metres, positive; half the pitch if None) on a spring of `stiffness` (N/m, positive) with
    a `damping` (N·s/m, zero or more; read by signal chains and scenes), which goes in by its `stroke` (metres, positive) at most. All raise ValueError for what is out of its range, and for
    more than 4,194,304 taxels.
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
        """ny rows (along y, ascending) of nx taxels in the plane z = 0, `pitch` metres apart, centred on the origin. Frames are (ny, nx)."""

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
        """ny staggered rows of nx taxels, each inner one with six neighbours `pitch` metres away; row by row."""

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
        """The places of a hexagonal lattice no farther than `radius` metres from the origin; row by row."""

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
        """Rings of taxels around z, pointing away from it: a forearm, a finger.

        radius: of the rest centres; length: between the first and the last ring, zero or more; arc: above 0 to 2π, its middle at +x;
        pitch: along the surface, met as well as whole numbers of taxels allow. Presses go along z: move() the patch to bring its middle
        there.
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
        """Rings of taxels on a sphere about the origin, from its pole at +z to `half_angle` (above 0 to π): a fingertip, an elbow."""

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
        """Taxels spread over a mesh's outer surface, as many as on a grid of this pitch, at least 0.83 pitches apart; 0.3 ms a taxel. A taxel
        whose axis would meet the mesh again is left out: see n_left_out. The region is where all that is given holds: bounds (2, 3), its least
        and greatest corner; plane (2, 3), a point and the direction to the side that counts; triangles, their numbers. Closed parts of the
        mesh that face inwards are turned outwards, with a UserWarning.
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
        """Any taxels: centers (n, 3), axes (n, 3) of length one within 1 % (they are normalised), away from the substrate; the others (n,) or one number for all."""

    def moved(self, pose: ArrayLike) -> Patch:
        """The same taxels elsewhere in the frame of the patch, and no grid any more. pose: (7,) or (4, 4)."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Of a frame: (ny, nx) of a grid, otherwise (n_taxels,)."""

    @property
    def n_taxels(self) -> int: ...
    @property
    def n_left_out(self) -> int:
        """Taxels that a draped patch leaves out because their axes would meet the mesh again; 0 for other patches."""

    @property
    def centers(self) -> NDArray[np.float64]:
        """(n_taxels, 3): where they rest, metres; a copy."""

    @property
    def axes(self) -> NDArray[np.float64]:
        """(n_taxels, 3): unit, away from the substrate; a copy."""

    @property
    def pitch(self) -> float | None:
        """Of a grid, metres."""

    @property
    def taxel_radius(self) -> float | NDArray[np.float64]:
        """Metres; one number, or one each."""

    @property
    def stroke(self) -> float | NDArray[np.float64]:
        """Metres; one number, or one each. A taxel whose deflection is its stroke is saturated."""

    @property
    def stiffness(self) -> float | NDArray[np.float64]:
        """N/m; one number, or one each."""

    @property
    def damping(self) -> float | NDArray[np.float64]:
        """N·s/m; one number, or one each."""

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
        """Deflections of the taxels pressed on an object at n poses, metres, 0 to the stroke.

        poses: the object in the frame of the patch, (n, 7) of x, y, z, qw, qx, qy, qz or (n, 4, 4); (7,) or (4, 4) for one alone.

        The patch comes from the front along its z. At most one of

        - depth: metres past first contact, zero or more;
        - travel: metres from the pose given;
        - force: newtons that all springs carry together, Σ k δ;

        each one number for all poses, or (n,). With none the patch is read where it is. A pose at which it meets nothing gives zeros.

        out: a C-contiguous array of float32 or float64 that takes the frames, and is returned. dtype: of a new array, float64 or float32.
        threads: at most so many, all cores if None. The interpreter's lock is free meanwhile, and Ctrl-C ends the call.

        Returns (n, ny, nx) of a grid, (n, n_taxels) of another patch, without n for one pose; the same bits at any number of threads.
        With contacts=True also the Contacts; frames are the same. With jacobian=True also (…, 6): how each deflection changes with the
        pose, by metres of the object along x, y, z and by radians about x, y, z through the object's origin, all axes the patch's; zero for
        taxels that are free or saturated. With a depth or a force the travel changes along; a depth needs a flat patch for it.

        Raises ValueError for arrays of another shape or type, numbers that are not finite, and a force that cannot be reached.
        """

@final
class Step:
    """A step from deflections to what a skin's electronics read, made by one of its static methods. What it may be is checked by Chain."""

    @staticmethod
    def force() -> Step:
        """Deflections become forces, k δ + c δ̇, newtons."""

    @staticmethod
    def noise(std: float, unit: Literal["full_scale", "mm", "n"] = "full_scale") -> Step:
        """Gaussian noise on every taxel: a fraction of the full scale (of a taxel at its stroke), millimetres, or newtons; zero or more."""

    @staticmethod
    def smoothing(width: float) -> Step:
        """A Gaussian over the array, of standard deviation `width` in metres, zero or more."""

    @staticmethod
    def error(name: str, **strengths: float) -> Step:
        """A sensor error: Step.error("gain", gain_std=0.07). Raises ValueError, which lists the names, or the strengths of one.

        errors() has all; those that belong to a piece of hardware (gain, drift, faults) are drawn from the chain's skin_seed.
        """

    @staticmethod
    def errors() -> dict[str, dict[str, str]]:
        """Of each sensor error its strengths, and of each strength what is allowed."""

@final
class Chain:
    """Steps from deflections to what is read, in their order, prepared for a patch.

    Chain([Step.error("gain", gain_std=0.05), Step.noise(0.02), Step.smoothing(4e-3)], patch, skin_seed=7)

    skin_seed: the piece of hardware, which has its own gains, drift and faults; 0 and above. of_force: whether frames are newtons from
    the start. Raises ValueError for a step that this patch, or its place in the chain, cannot have.
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
        """What is read of frames, each that of a touch by itself, at rest.

        frames: deflections (n, …) of n_taxels each, (n, ny, nx) of a grid, metres, or one frame; they stay as they are. seed: of what changes from touch to
        touch; frame i has the random numbers of touch `first` + i, whatever else is read. rates: δ̇, m/s, as frames. Returns an array
        of the same shape, float64, in the unit of `quantity`. Raises ValueError.
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
        """What is read of the frames of one touch, in the order of time: hysteresis and scan order connect them.

        n_before: leading frames that are remembered, but not returned. interval: seconds between frames; None: the press waits at each.
        time: the share of the session that has gone, 0 to 1, for drift. Returns (n − n_before, …). Raises ValueError.
        """

    @property
    def quantity(self) -> str:
        """Of what it returns: deflection (metres) or force (newtons)."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """The steps, in their order."""

@final
class Projection:
    """A random projection y = Φx from frames of ny × nx taxels to m measurements, drawn once.

    Projection("sbhe", patch.shape, 64, seed=7). ensemble: gaussian, bernoulli, circulant, sparse, sbhe, block_average, subsample,
    fourier, or identity (all taxels, whatever m). n_measurements: 1 to the number of taxels. Raises ValueError.
    """

    def __new__(
        cls, ensemble: str, shape: tuple[int, ...], n_measurements: int, seed: int = 0
    ) -> Projection: ...
    def __call__(self, frames: ArrayLike) -> NDArray[np.float64]:
        """Measurements (n, m) of frames (n, …) of n_taxels each, or of one frame: (1, m). A row has the same bits in any batch."""

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Φ, (m, n_taxels); made when it is asked for."""

    @property
    def ensemble(self) -> str:
        """Its name."""

    @property
    def n_taxels(self) -> int:
        """Of a frame."""

    @property
    def n_measurements(self) -> int:
        """m."""

    def __getnewargs__(self) -> tuple[str, tuple[int, int], int, int]: ...

@final
class Reconstructor:
    """Rebuilds frames from the measurements of one projection, by what training frames are made of.

    Reconstructor(projection, training, basis="pca", solver="lmmse", noise=1e-4). training: (n, ny, nx), metres. basis: dct, haar,
    daubechies4 (both of sides that are powers of two) or pca, of which the n_atoms that carry most are kept (None: all; of pca 256). solver: omp (matching
    pursuit), l1 (basis pursuit by FISTA) or lmmse (the linear estimate). noise: standard deviation on each taxel, in the frames' unit. Raises ValueError.
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
        """Of measurements (n, m): frames (n, ny, nx), n_atoms (n,) that each took, is_capped (n,) where its solver stopped at a limit."""

@final
class Simulation:
    """A scene, from its text: bubbletouch.simulate takes a file or a dict.

    It is an iterator of frames, one after the other as the scene says; or a program moves things itself, step by step, with set_…(),
    step(dt) and observe(). Frames are dicts:

    - time: seconds;
    - patches: of each by name pose (7,) in the world, deflection (ny, nx) or (n_taxels,) in metres, force likewise in newtons, force3
      (n_taxels, 3) of the objects on each taxel in newtons in the frame of the patch, whose sum is the wrench's force, signal (or None),
      wrench (6,) of force and torque on the patch in its frame, n_touched, n_saturated;
    - objects: of each by name pose (7,) in the world, and held: imposed, pressed, at rest, unsettled or escaped.
    """

    def __new__(
        cls, text: str, place: str, folder: _Path, models: dict[str, Mesh | SphereUnion]
    ) -> Simulation: ...
    def reset(self, seed: int | None = None) -> None:
        """Back to before the first frame, and nothing is set by hand any more. The skin stays as it is; the noise of its readings is that of
        `seed` (None: the scene's own). Raises ValueError.
        """

    def step(self, dt: float) -> None:
        """A step by hand of `dt` seconds: what was set goes there, all else goes on as the scene says. Raises ValueError."""

    def observe(self) -> dict[str, Any]:
        """What everything is like now, as a frame; before any step, the scene's first. Raises ValueError."""

    def set_object_pose(self, object: str, pose: ArrayLike) -> None:
        """From the next step on an object is here, in the world: (7,) or (4, 4). A free one comes to rest from here. Raises ValueError."""

    def set_robot_pose(self, robot: str, pose: ArrayLike) -> None:
        """From the next step on the base of a robot is here, in the world: (7,) or (4, 4). Raises ValueError."""

    def set_joint_positions(self, robot: str, positions: ArrayLike) -> None:
        """From the next step on the joints of a robot are here: (n_joints,) in the order of `robots`, radians and metres. Raises ValueError."""

    def patch(self, name: str) -> Patch:
        """The skin of a patch, in its own frame. Raises ValueError."""

    @property
    def time(self) -> float:
        """Seconds since the start."""

    @property
    def robots(self) -> dict[str, list[str]]:
        """By name, the names of their joints that move."""

    def __iter__(self) -> Simulation: ...
    def __next__(self) -> dict[str, Any]: ...
    @property
    def n_frames(self) -> int:
        """Of the whole scene."""

    @property
    def output_rate(self) -> float:
        """Frames a second of the scene's time."""

    @property
    def patches(self) -> list[str]:
        """Their names."""

    @property
    def objects(self) -> list[str]:
        """Their names."""

    @property
    def title(self) -> str:
        """What the scene is about."""

@final
class KernelSvm:
    """A trained SVM with a kernel, on labels 0, 1, …: what bubbletouch.learning.SVC fits. Pickled as its training rows, and trained again."""

    @staticmethod
    def train(features: ArrayLike, labels: ArrayLike, params: dict[str, Any]) -> KernelSvm:
        """Trains on features (n, m) and labels (n,). Raises ValueError."""

    def labels(self, features: ArrayLike) -> NDArray[np.int64]:
        """(n,): of features (n, m); of equally many votes the lowest label."""

    def decision_values(self, features: ArrayLike) -> NDArray[np.float64]:
        """(n, n_problems): above 0 speaks for a problem's positive class."""

    @property
    def problems(self) -> list[dict[str, Any]]:
        """Of each binary problem its classes, training rows, signed multipliers, ρ, objective, iterations, and whether it was capped."""

    @property
    def n_capped(self) -> int:
        """Binary problems that stopped at the iteration cap."""

@final
class LinearModel:
    """A trained linear SVM without a kernel matrix, on labels 0, 1, …: what bubbletouch.learning.LinearSVC fits. Pickled as KernelSvm."""

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
        """(n,): of features (n, m)."""

    def scores(self, features: ArrayLike) -> NDArray[np.float64]:
        """(n, n_classes): the largest says the label."""

    @property
    def weights(self) -> NDArray[np.float64]:
        """(n_classes, m)."""

    @property
    def bias(self) -> NDArray[np.float64]:
        """(n_classes,)."""

    @property
    def n_passes(self) -> int:
        """Passes over the rows, most of all problems."""

    @property
    def n_capped(self) -> int:
        """Problems that stopped at max_passes."""

def choose_svm(
    features: ArrayLike,
    labels: ArrayLike,
    params: dict[str, Any],
    folds: Sequence[tuple[ArrayLike, ArrayLike]],
    c: Sequence[float],
    gamma_scales: Sequence[float],
) -> dict[str, Any]:
    """Accuracies of every γ (as multiples of that of scale; none: as it is) and C over folds, on one matrix of products: the best C, the best γ, and
    tuples of C, γ and accuracy."""

def touch_poses(
    object: _Model,
    *,
    offset: ArrayLike | None = None,
    yaw: ArrayLike | None = None,
    tilt: ArrayLike | None = None,
    rest: int | None = None,
) -> NDArray[np.float64]:
    """Poses of an object that lies on a table under a patch that faces down, for Patch.press.

    The object stands with its own z up, or, with `rest`, in its stable pose of that number (0: the likeliest); the box around it is
    centred at x = y = 0 and turned by `yaw` about the vertical. The axis of the patch goes through `offset` (x, y; metres) at the
    height of the object's top and is tilted by `tilt` about the patch's x, then its y.

    offset, tilt: (2,) or (n, 2); yaw: a number or (n,). Returns (7,) if all are of one, otherwise (n, 7). Raises ValueError.
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
    """Runs a study (TOML) into a folder: of each table its file's name, title, note and columns."""

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
    """What the results in a folder advise, as JSON: at least so good, or at most so dear. Raises ValueError."""

def toml_of(json: str) -> str:
    """A study in TOML from the same in JSON."""

def write_frame(path: _Path, frame: ArrayLike, pitch: float) -> None:
    """Writes the deflections (ny, nx; metres) of a grid with this pitch as a picture (.png), a table (.csv) or arrays (.npz), by the
    ending of the name. Raises OSError, or ValueError."""

def _kernel_pace(
    patch: Patch, object: _Model, poses: ArrayLike, depth: ArrayLike, seconds: float
) -> float: ...
def _panic() -> None: ...
