"""Class `Skin`: patches on sites, bodies or geoms of a MuJoCo model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

import bubbletouch._core as _core
from bubbletouch._contact_forces import Contact, ContactForces
from bubbletouch.mujoco.collisions import carrying_bodies, geoms_of_others, touching_geoms
from bubbletouch.mujoco.geoms import geom_surface
from bubbletouch.mujoco.sensor_callback import install

Array = NDArray[np.float64]
Output = Literal["deflection", "force"]


class Skin:
    """Patches on sites, bodies or geoms of a MuJoCo model, under its geoms.

    model: mujoco.MjModel.
    layout: patches by the name of the site or body that carries each. If a site and a body have one name, the site carries the patch. "geom:NAME"
        is the frame of a geom, as for a patch draped on its geom_surface; "site:NAME" and "body:NAME" are possible, too. Taxels of a flat patch
        point along z of the frame.
    geoms: "all", or names of the geoms that can touch the skin. With "all", a geom can touch a patch if MuJoCo can create a contact between the geom
        and the body of the patch, by contype and conaffinity, `<pair>`, `<exclude>`, and the filter of parent and child. Named geoms can touch the
        patches of all other bodies, geoms of the world all patches. Flexes never touch the skin.
    tolerance: largest distance of the facets of cylinders and ellipsoids from the surface, metres. Planes, spheres, boxes, capsules, meshes and height
        fields are exact; an SDF is the mesh that MuJoCo samples from it.
    hulls: whether a mesh presses with its convex hull, as in MuJoCo's contacts, instead of its own surface.

    If the body of a frame has no collision geoms, the patch belongs to the nearest parent body that has some, provided that no joint lies between.
    The surfaces are read once; a model whose geoms change needs a new skin. Raises ValueError for names that the model does not have.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        layout: Mapping[str, _core.Patch],
        *,
        geoms: Literal["all"] | Sequence[str] = "all",
        tolerance: float = 1e-5,
        hulls: bool = False,
    ) -> None:
        self._model = model
        self._patches = dict(layout)
        if not self._patches:
            raise ValueError("layout: no patch; at least one, by the name of a site, body or geom")
        for name, patch in self._patches.items():
            if not isinstance(name, str) or not isinstance(patch, _core.Patch):
                raise TypeError(f"layout: {name!r} with {type(patch).__name__}; a name with a Patch")
        self._frames = _Frames(model, list(self._patches))
        carriers = carrying_bodies(model, self._frames.bodies)
        if isinstance(geoms, str):
            if geoms != "all":
                raise ValueError(f'geoms: {geoms!r}; "all" or names of geoms')
            can_touch = touching_geoms(model, carriers)
            found = np.flatnonzero(can_touch.any(axis=0)).tolist()
        else:
            can_touch = geoms_of_others(model, carriers)
            found = [_identity(model, mujoco.mjtObj.mjOBJ_GEOM, name) for name in geoms]
        if not can_touch[:, found].any():
            advice = ' (contype, conaffinity, <pair>, <exclude>, parent and child); names of geoms press without the filter' if geoms == "all" else ""
            given = "MuJoCo's collision filter leaves none" if geoms == "all" else "none on another body than the patches"
            raise ValueError(f"geoms: {given}; at least one that can touch the skin{advice}")
        self._geoms = np.array(found, dtype=np.intp)
        bodies = [geom_surface(model, geom, tolerance, hulls=hulls) for geom in found]
        # The geoms of one body press a patch together.
        of_geoms: dict[int, int] = dict(enumerate(model.geom_bodyid.tolist()))
        self._bodies = list(dict.fromkeys(of_geoms[geom] for geom in found))
        objects = {geom: self._bodies.index(of_geoms[geom]) for geom in found}
        self._skin = _core.Skin(list(self._patches.values()), bodies, objects=list(objects.values()), can_touch=can_touch[:, found])
        self._contact_forces = ContactForces(list(self._patches.values()), carriers, of_geoms, objects)
        names = zip(self._patches, self._skin.ranges, strict=True)
        self._slices = {name: slice(first, last) for name, (first, last) in names}

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
        """Names of the bodies of these geoms, in the order of pair_forces; an unnamed body has the name body_ID."""
        return [self._model.body(body).name or f"body_{body}" for body in self._bodies]

    def read(
        self,
        data: mujoco.MjData,
        *,
        output: Output = "deflection",
        match: Literal["normal_force"] | None = None,
        reach: float | None = None,
        shear: _core.ShearState | None = None,
        out: Array | None = None,
        wrenches: Array | None = None,
        contacts: NDArray[np.int64] | None = None,
        pair_forces: Array | None = None,
        residuals: Array | None = None,
        travels: Array | None = None,
    ) -> Array:
        """Returns the readings at the poses of `data`, (n_taxels,): deflections, metres, or forces along the taxels' axes, newtons.

        Call mj_step, mj_forward or mj_kinematics before; `match` needs the contact forces of mj_step or mj_forward.

        match: None reads the patches at the engine's poses. "normal_force" lets each patch travel until its normal force under each body is the engine's.
            The engine's normal force of a pair of patch and body is the sum of the forces along the contact normal over all contacts of the pair (first
            number of mj_contactForce). All geoms of the body press the patch together. A contact of the patch's body counts if the force on the patch
            is within 60° of the reversed axis of the taxel nearest to the contact. If several patches of one body face a contact, its force is divided
            among them by their normal forces at the engine's poses. Otherwise, the nearest patch has the force. Flat patches travel along z, other
            patches against the mean contact force.
            A body without contact force reads zero, even if it overlaps taxels. A contact without overlap moves the patch to the body. A contact that
            faces no patch presses nothing; its force is in the residual of the nearest patch.
        reach: largest travel towards a body with `match`, metres; default: the patch's largest stroke plus its largest taxel diameter.
        shear: state of shear_state(), which is advanced by one step.

        The following arrays are filled: out (n_taxels,), which is returned; wrenches (n_patches, 6), force and torque on each patch in its own frame;
        contacts (n_patches, 2) int64, numbers of touched taxels and of taxels at their stroke; pair_forces, residuals and travels (n_patches, n_bodies),
        in the order of `bodies`: normal force, the engine's force minus the normal force (0 without `match`), newtons, and travel of the patch, metres.
        """
        patch_poses = self._frames.poses(data)
        body_poses = (data.geom_xpos[self._geoms], data.geom_xmat[self._geoms])
        if match is None:
            forces = directions = beside = None
        elif match == "normal_force":
            overlaps = np.empty((len(self._patches), len(self._bodies)))
            self._skin.read(patch_poses, body_poses, pair_forces=overlaps)
            forces, directions, beside = self._contact_forces.wanted(_contacts(self._model, data), patch_poses, overlaps)
        else:
            raise ValueError(f'match: {match!r}; None or "normal_force"')
        read = self._skin.read(
            patch_poses,
            body_poses,
            output=output,
            forces=forces,
            directions=directions,
            reach=reach,
            shear=shear,
            out=out,
            wrenches=wrenches,
            contacts=contacts,
            pair_forces=pair_forces,
            residuals=residuals,
            travels=travels,
        )
        if residuals is not None and beside is not None:
            residuals += beside
        return read

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
        self, sensor: str, *, output: Output = "force", match: Literal["normal_force"] | None = None
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

        install(self._model, number, stage, fill)

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
        frames = {"site": (data.site_xpos, data.site_xmat), "body": (data.xpos, data.xmat), "geom": (data.geom_xpos, data.geom_xmat)}
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
    if prefix in kinds:
        return prefix, _identity(model, kinds[prefix], rest)
    raise ValueError(f"layout: {name!r}; a site ({_names(model, kinds['site'])}), a body ({_names(model, kinds['body'])}) or geom:NAME")


def _contacts(model: mujoco.MjModel, data: mujoco.MjData) -> Iterator[Contact]:
    """Yields the contacts of the engine with their normal forces."""
    places, normals, force = data.contact.pos, data.contact.frame[:, :3], np.zeros(6)
    for number, (first, second) in enumerate(data.contact.geom.tolist()):
        mujoco.mj_contactForce(model, data, number, force)
        yield Contact(first, second, places[number], normals[number], float(force[0]))


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
