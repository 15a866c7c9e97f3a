"""Class `Skin`: patches on sites, bodies or geoms of a MuJoCo model."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

import bubbletouch._core as _core
from bubbletouch._contact_forces import contact_loads
from bubbletouch.mujoco.collisions import geoms_of_others, touching_geoms
from bubbletouch.mujoco.geoms import depth_behind, geom_surface
from bubbletouch.mujoco.sensor_callback import install

if TYPE_CHECKING:
    from typing_extensions import Unpack

Array = NDArray[np.float64]
Output = Literal["deflection", "force"]
Match = Literal["normal_force", "contact_force"]


class Skin:
    """Patches on sites, bodies or geoms of a MuJoCo model, under its geoms.

    model: mujoco.MjModel. The data of read() must belong to this model, or to one of the same structure with the same surfaces.
    layout: patches by the name of the site or body that carries each. If a site and a body have one name, the site carries the patch. "geom:NAME"
        is the frame of a geom, as for a patch draped on its geom_surface; "site:NAME" and "body:NAME" are possible, too. Taxels of a flat patch
        point along z of the frame.
    geoms: "all", or names or numbers of the geoms that can touch the skin. The name of an unnamed geom is geom_ID. With "all", a geom can touch a patch if MuJoCo can create a contact between the
        geom and the body of the patch, by contype and conaffinity, `<pair>`, `<exclude>`, and the filter of parent and child. Given geoms can touch the
        patches of all bodies to which they are not welded. Flexes never touch the skin; a warning says so.
    tolerance: largest distance of the facets of cylinders and ellipsoids from the surface, metres. Planes, spheres, boxes, capsules, meshes and height
        fields are exact; an SDF is the mesh that MuJoCo samples from it.
    hulls: whether a mesh presses with its convex hull, as in MuJoCo's contacts, instead of its own surface.

    All bodies that are welded to the body of a patch carry the patch: they never press it, and their contacts count for it. A taxel whose stroke and diameter
    exceed the thickness of its pad can be pressed from behind; a warning names the largest stroke that fits. The surfaces are read once; a model whose
    geoms change needs a new skin. Raises ValueError for names that the model does not have.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        layout: Mapping[str, _core.Patch],
        *,
        geoms: Literal["all"] | Sequence[str | int] = "all",
        tolerance: float = 1e-5,
        hulls: bool = False,
    ) -> None:
        if not isinstance(model, mujoco.MjModel):
            raise TypeError(f"model: {model!r}; a mujoco.MjModel, such as mujoco.MjModel.from_xml_path(file)")
        if not isinstance(layout, Mapping) or not layout:
            raise ValueError(f"layout: {layout!r}; a dict with at least one Patch, by the name of a site, body or geom")
        self._model = model
        self._patches = dict(layout)
        for name, patch in self._patches.items():
            if not isinstance(name, str) or not isinstance(patch, _core.Patch):
                raise TypeError(f"layout: {name!r} with {type(patch).__name__}; a name with a Patch")
        self._frames = _Frames(model, list(self._patches))
        bodies = self._frames.bodies
        if isinstance(geoms, str):
            if geoms != "all":
                raise ValueError(f'geoms: {geoms!r}; "all" or names of geoms')
            can_touch = touching_geoms(model, bodies)
            found = np.flatnonzero(can_touch.any(axis=0)).tolist()
        else:
            can_touch = geoms_of_others(model, bodies)
            found = [_geom(model, geom) for geom in geoms]
        if not can_touch[:, found].any():
            advice = ' (contype, conaffinity, <pair>, <exclude>, parent and child); names of geoms press without the filter' if geoms == "all" else ""
            given = "MuJoCo's collision filter leaves none" if geoms == "all" else "none on another body than the patches"
            raise ValueError(f"geoms: {given}; at least one that can touch the skin{advice}")
        if model.nflex:
            warnings.warn(f"the skin does not feel the {model.nflex} flexes of the model: geoms alone press it", stacklevel=2)
        self._geoms = np.array(found, dtype=np.intp)
        surfaces = [geom_surface(model, geom, tolerance, hulls=hulls) for geom in found]
        # The geoms of bodies that are welded together press a patch together, but for bodies that are fixed to the world.
        welds = np.where(model.body_weldid == 0, np.arange(model.nbody), model.body_weldid)
        self._bodies: list[int] = list(dict.fromkeys(welds[model.geom_bodyid[found]].tolist()))
        # Index of the object and of the carrier of each geom; -1 for none, also at the end, where flexes have their index.
        self._objects, self._carriers = np.full((2, model.ngeom + 1), -1, dtype=np.intp)
        self._objects[found] = [self._bodies.index(welds[model.geom_bodyid[geom]]) for geom in found]
        groups = list(dict.fromkeys(model.body_weldid[bodies].tolist()))
        for carrier, group in enumerate(groups):
            self._carriers[:-1][model.body_weldid[model.geom_bodyid] == group] = carrier
        self._skin = _core.Skin(
            list(self._patches.values()),
            surfaces,
            objects=self._objects[found].tolist(),
            can_touch=can_touch[:, found],
            carriers=[groups.index(model.body_weldid[body]) for body in bodies],
        )
        self._warn_of_thin_pads()
        # Model that was compared last, and whether it fits.
        self._compared: tuple[mujoco.MjModel, bool] = (model, True)
        # Time of the last read with each state of shear springs.
        self._times: dict[int, float] = {}
        names = zip(self._patches, self._skin.ranges, strict=True)
        self._slices = {name: slice(first, last) for name, (first, last) in names}

    @property
    def model(self) -> mujoco.MjModel:
        """Model of the skin."""
        return self._model

    @property
    def n_taxels(self) -> int:
        """Number of taxels of all patches."""
        return self._skin.n_taxels

    @property
    def patches(self) -> dict[str, _core.Patch]:
        """Patches by the names of their sites or bodies."""
        return dict(self._patches)

    @property
    def geoms(self) -> list[str]:
        """Names of the geoms that can touch the skin; an unnamed geom has the name geom_ID."""
        return [self._model.geom(geom).name or f"geom_{geom}" for geom in self._geoms]

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies of these geoms, in the order of pair_forces; an unnamed body has the name body_ID. Bodies that are welded together have the name
        of the first one."""
        return [self._model.body(body).name or f"body_{body}" for body in self._bodies]

    def fits(self, model: mujoco.MjModel) -> bool:
        """Returns whether a model has the structure of the skin's model and the same surfaces of the geoms that can touch the skin."""
        if model is self._model:
            return True
        if model is not self._compared[0]:
            self._compared = (model, _structure(model, self._geoms) == _structure(self._model, self._geoms))
        return self._compared[1]

    def read(
        self,
        data: mujoco.MjData,
        *,
        match: Match | None = None,
        shear: _core.ShearState | None = None,
        **options: Unpack[_core._ReadOptions],
    ) -> Array:
        """Returns the readings at the poses of `data`, (n_taxels,): deflections, metres, or forces along the taxels' axes, newtons.

        Call mj_step, mj_forward or mj_kinematics before; `match` needs the contact forces of mj_step or mj_forward.

        output: "deflection" (default) or "force".
        match: None reads the patches at the engine's poses: depths of overlap, not forces of the engine. "normal_force" gives the taxels the engine's normal
            forces: each contact acts on the patch of its body that it faces and whose taxels are near its point. The taxels of a flat patch have the sum
            and the moment of these forces, so the centre of pressure is the engine's; those of a curved patch have the sum along their axes.
            "contact_force" adds the engine's tangential forces, so that force and torque on each patch equal the engine's; `taxel_forces` and `wrenches`
            contain them. A body without contact force reads zero, even if it overlaps taxels. A contact that acts on no patch presses nothing; its force is
            in the residual of the nearest patch, if that is nearer than the patch's diameter. bubbletouch.Skin.read (loads) has the rules.
        reach: largest travel towards a body with `match`, metres; default: the patch's largest stroke plus its largest taxel diameter.
        shear: state of shear_state(), which is advanced by one step. The springs follow the geometry, so they also grow with the creep of the engine's soft
            friction; `match="contact_force"` has the engine's friction instead. The springs are reset if the time of `data` runs backwards.

        The following arrays are filled: out (n_taxels,), which is returned; wrenches (n_patches, 6), force and torque on each patch in its own frame;
        contacts (n_patches, 2) int64, numbers of touched taxels and of taxels at their stroke; taxel_forces (n_taxels, 3), force on each taxel in the frame
        of its patch; pair_forces, residuals and travels (n_patches, n_bodies), in the order of `bodies`: normal force, the engine's force minus the normal
        force (0 without `match`), newtons, and travel of the patch, metres.

        Raises ValueError if the model of `data` does not fit the skin, or if its poses were never computed.
        """
        if not self.fits(data.model):
            raise ValueError("data: of a model with other surfaces than the skin; a new Skin for each model")
        if not data.xmat[0, 0]:
            raise ValueError("data: no poses yet; call mujoco.mj_forward(model, data) or mj_step first")
        patch_poses = self._frames.poses(data)
        body_poses = (data.geom_xpos[self._geoms], data.geom_xmat[self._geoms])
        loads = None if match is None else self._loads(data, match)
        if shear is not None:
            if data.time < self._times.get(id(shear), -np.inf):
                shear.reset()
            self._times[id(shear)] = data.time
        return self._skin.read(patch_poses, body_poses, loads=loads, shear=shear, **options)

    def _loads(self, data: mujoco.MjData, match: str) -> tuple[NDArray[np.generic], ...]:
        """Returns the engine's contact forces as the argument `loads` of the core."""
        if match not in ("normal_force", "contact_force"):
            raise ValueError(f'match: {match!r}; None or "normal_force" or "contact_force"')
        forces = _contact_forces(self._model, data)
        geoms = data.contact.geom
        return contact_loads(self._carriers[geoms], self._objects[geoms], data.contact.pos, *forces[: 1 if match == "normal_force" else 3])

    def _warn_of_thin_pads(self) -> None:
        """Warns of patches whose taxels reach through the geoms of their bodies."""
        data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, data)
        for (name, patch), body, place, matrix in zip(self._patches.items(), self._frames.bodies, *self._frames.poses(data), strict=True):
            turn = matrix.reshape(3, 3).T
            thickness = depth_behind(self._model, data, body, place + patch.centers @ turn, patch.axes @ turn)
            diameters, strokes = (np.broadcast_to(of, thickness.shape) for of in (2.0 * np.asarray(patch.taxel_radius), patch.stroke))
            if ((thickness > 0.0) & (thickness < strokes + diameters)).any():
                least = float(np.min((thickness - diameters)[thickness > 0.0]))
                advice = f"a stroke of at most {1e3 * least:.3g} mm fits" if least > 0.0 else "no stroke fits"
                warnings.warn(
                    f"layout: {name!r}: stroke plus taxel diameter, {1e3 * float(np.max(strokes + diameters)):.3g} mm, exceed the pad's thickness, "
                    f"{1e3 * float(thickness[thickness > 0.0].min()):.3g} mm, so bodies behind the pad press its taxels; {advice}",
                    stacklevel=3,
                )

    def shear_state(self, stiffness: float | Array, friction: float | Array) -> _core.ShearState:
        """Returns the state of untouched taxels with shear springs, for the argument `shear` of read().

        stiffness: stiffness of the shear springs, N/m, positive; one number, or (n_taxels,).
        friction: coefficient of friction, zero or more; one number, or (n_taxels,).
        """
        return self._skin.shear_state(stiffness, friction)

    def frame(self, name: str, readings: Array) -> Array:
        """Returns the part of one patch in the shape of its frames: (ny, nx) of a grid, otherwise (n_taxels,)."""
        if name not in self._slices:
            raise ValueError(f"name: {name!r}; one of {', '.join(self._slices)}")
        return readings[self._slices[name]].reshape(self._patches[name].shape)

    def install(
        self, sensor: str, *, output: Output = "force", match: Match | None = None
    ) -> None:
        """Writes the readings into a `<user>` sensor at every evaluation of the sensors, by MuJoCo's sensor callback.

        The sensor has `dim` = n_taxels and `needstage="pos"` (with `match`: `needstage="acc"`), so that recordings, viewers and observations contain the
        skin. MuJoCo has one sensor callback for each process. Several skins share it, of one model or of several, and a callback that was set before is
        still called. A second skin at one sensor replaces the first. `mujoco.set_mjcb_sensor(None)` removes all skins. While a
        callback in Python is set, MuJoCo compiles no model with a `<user>` sensor, so compile all models first. Raises ValueError if the sensor does
        not fit.
        """
        number = _identity(self._model, mujoco.mjtObj.mjOBJ_SENSOR, sensor)
        is_user = self._model.sensor_type[number] == mujoco.mjtSensor.mjSENS_USER
        if not is_user or self._model.sensor_dim[number] != self.n_taxels:
            given = f"type {self._model.sensor_type[number]}, dim {self._model.sensor_dim[number]}"
            raise ValueError(f"sensor {sensor!r}: {given}; a <user> sensor with dim {self.n_taxels}")
        stage = int(self._model.sensor_needstage[number])
        if match is not None and stage != mujoco.mjtStage.mjSTAGE_ACC:
            raise ValueError(f'sensor {sensor!r}: needstage {stage}; "acc", because contact forces are computed late')
        first = int(self._model.sensor_adr[number])
        target = slice(first, first + self.n_taxels)

        def fill(data: mujoco.MjData) -> None:
            self.read(data, output=output, match=match, out=data.sensordata[target])

        install(self, number, stage, fill)

    def draw(self, scene: mujoco.MjvScene, data: mujoco.MjData, forces: Array, *, largest: float = 1.0) -> None:
        """Adds a sphere for each taxel to a scene of the viewer (`viewer.user_scn`), grey at rest to red at `largest` newtons.

        Clear the user scene before each frame with `viewer.user_scn.ngeom = 0`. Taxels beyond the scene's capacity are not drawn.
        """
        for (name, patch), place, matrix in zip(self._patches.items(), *self._frames.poses(data), strict=True):
            centers = place + patch.centers @ matrix.reshape(3, 3).T
            radii = np.broadcast_to(patch.taxel_radius, (patch.n_taxels,))
            for center, radius, force in zip(centers, radii, forces[self._slices[name]], strict=True):
                if scene.ngeom >= scene.maxgeom:
                    return
                part = min(max(float(force) / largest, 0.0), 1.0)
                color = np.array([0.6 + 0.4 * part, 0.6 * (1 - part), 0.6 * (1 - part), 1.0], dtype=np.float32)
                size = np.full(3, radius)
                sphere = mujoco.mjtGeom.mjGEOM_SPHERE
                mujoco.mjv_initGeom(scene.geoms[scene.ngeom], sphere, size, center, np.eye(3).ravel(), color)
                scene.ngeom += 1


class _Frames:
    """Sites, bodies and geoms that carry patches."""

    def __init__(self, model: mujoco.MjModel, names: Sequence[str]) -> None:
        found = [_carrier(model, name) for name in names]
        kinds = sorted({kind for kind, _ in found}, key="site body geom".split().index)
        # Kind of frame, rows of its patches, and numbers of its sites, bodies or geoms.
        self._parts = [
            (kind, [row for row, (other, _) in enumerate(found) if other == kind], [at for other, at in found if other == kind])
            for kind in kinds
        ]
        of = {"site": model.site_bodyid, "body": range(model.nbody), "geom": model.geom_bodyid}
        # Body that carries each patch.
        self.bodies = [int(of[kind][at]) for kind, at in found]

    def poses(self, data: mujoco.MjData) -> tuple[Array, Array]:
        """Returns the positions (n_patches, 3) and the rotation matrices (n_patches, 9) of the patches in the world."""
        frames: dict[str, tuple[Any, Any]] = {"site": (data.site_xpos, data.site_xmat), "body": (data.xpos, data.xmat), "geom": (data.geom_xpos, data.geom_xmat)}
        if len(self._parts) == 1:
            [(kind, _, numbers)] = self._parts
            return frames[kind][0][numbers], frames[kind][1][numbers]
        positions, rotations = np.empty((len(self.bodies), 3)), np.empty((len(self.bodies), 9))
        for kind, rows, numbers in self._parts:
            positions[rows], rotations[rows] = frames[kind][0][numbers], frames[kind][1][numbers]
        return positions, rotations


def _carrier(model: mujoco.MjModel, name: str) -> tuple[str, int]:
    """Returns the kind and the number of the site, body or geom that carries a patch."""
    kinds = {"site": mujoco.mjtObj.mjOBJ_SITE, "body": mujoco.mjtObj.mjOBJ_BODY, "geom": mujoco.mjtObj.mjOBJ_GEOM}
    for kind in ("site", "body"):
        if (number := mujoco.mj_name2id(model, kinds[kind], name)) >= 0:
            return kind, number
    prefix, _, rest = name.partition(":")
    if prefix == "geom":
        return prefix, _geom(model, rest)
    if prefix in kinds:
        return prefix, _identity(model, kinds[prefix], rest)
    raise ValueError(f"layout: {name!r}; a site ({_names(model, kinds['site'])}), a body ({_names(model, kinds['body'])}) or geom:NAME")


def _contact_forces(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Array, Array, Array]:
    """Returns the normal forces, the friction forces and the torques of all contacts on their second geom, (ncon, 3) each, in the world. The numbers are
    those of mj_contactForce, for all contacts at once."""
    contact, forces = data.contact, data.efc_force
    frame, dims, address = contact.frame.reshape(-1, 3, 3), contact.dim, contact.efc_address
    local = np.zeros((len(dims), 6))
    for dim in np.unique(dims[address >= 0]).tolist():
        rows = np.flatnonzero((dims == dim) & (address >= 0))
        if dim == 1 or model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC:
            local[rows, :dim] = forces[address[rows, None] + np.arange(dim)]
        else:  # Edges of the pyramid, two for each direction.
            edges = forces[address[rows, None] + np.arange(2 * (dim - 1))].reshape(len(rows), dim - 1, 2)
            local[rows, 0] = edges.sum(axis=(1, 2))
            local[rows, 1:dim] = contact.friction[rows, : dim - 1] * (edges[..., 0] - edges[..., 1])
    normal = local[:, :1] * frame[:, 0]
    friction = np.einsum("ck,ckx->cx", local[:, 1:3], frame[:, 1:])
    return normal, friction, np.einsum("ck,ckx->cx", local[:, 3:], frame)


def _structure(model: mujoco.MjModel, geoms: NDArray[np.intp]) -> list[bytes]:
    """Returns what readings depend on besides poses: names, the bodies of sites, geoms and sensors, and the surfaces of some geoms."""
    if model.ngeom <= geoms.max():
        return []
    bodies = [model.body_parentid, model.body_weldid, model.geom_bodyid, model.site_bodyid, model.sensor_adr, model.sensor_dim]
    surfaces = [model.geom_type[geoms], model.geom_size[geoms], model.geom_dataid[geoms], model.mesh_vert, model.mesh_face, model.hfield_size, model.hfield_data]
    return [model.names, *(part.tobytes() for part in [*bodies, *surfaces])]


def _geom(model: mujoco.MjModel, geom: str | int) -> int:
    if isinstance(geom, str):
        unnamed = [number for number in range(model.ngeom) if geom == f"geom_{number}" and not model.geom(number).name]
        return unnamed[0] if unnamed else _identity(model, mujoco.mjtObj.mjOBJ_GEOM, geom)
    if not 0 <= geom < model.ngeom:
        raise ValueError(f"geoms: {geom}; a name, or a number from 0 to {model.ngeom - 1}")
    return int(geom)


def _identity(model: mujoco.MjModel, kind: mujoco.mjtObj, name: str) -> int:
    number = mujoco.mj_name2id(model, kind, name)
    if number < 0:
        raise ValueError(f"{_word(kind)}: {name!r}; one of {_names(model, kind)}")
    return int(number)


def _word(kind: mujoco.mjtObj) -> str:
    return str(kind.name[6:].lower())


def _names(model: mujoco.MjModel, kind: mujoco.mjtObj) -> str:
    """Returns the names of all elements of one kind, for messages."""
    word = _word(kind)
    count = {"site": model.nsite, "body": model.nbody, "geom": model.ngeom, "sensor": model.nsensor}[word]
    names = [mujoco.mj_id2name(model, kind, other) for other in range(count)]
    return ", ".join(name for name in names if name) or f"a model with named {word}s"
