"""Skin for MuJoCo: taxels on sites or bodies of a model, read from `mjData` in the simulation loop. Needs the package mujoco.

    model = mujoco.MjModel.from_xml_path("hand.xml")
    data = mujoco.MjData(model)
    skin = bt.mujoco.Skin(model, {"palm": bt.Patch.grid(8, 8, pitch=4e-3, stroke=3e-3)})
    mujoco.mj_step(model, data)
    forces = skin.read(data, output="force")          # (n_taxels,), newtons
    skin.frame("palm", forces)                         # (8, 8)

The patches take no part in the dynamics: MuJoCo moves the bodies, and the skin computes what its taxels read at their poses. A geom touches a taxel as
far as the bodies of the engine overlap, so soft contacts (`solref`, `solimp`) decide the depth.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

import bubbletouch._core as _core

Array = NDArray[np.float64]


class Skin:
    """Patches on sites of a MuJoCo model, under its geoms.

    model: mujoco.MjModel.
    layout: patches by the name of the site that carries each. The patch frame is the site's frame: taxels of a flat patch point along the site's z.
    geoms: "all", or names of the geoms that can touch the skin. With "all", geoms of the patches' own bodies are left out, as are visual geoms
        (contype and conaffinity 0).
    tolerance: largest distance of the facets of cylinders and ellipsoids from the surface, metres. Spheres, boxes, capsules and meshes are exact.

    Raises ValueError for names that the model does not have, and for geoms without a surface (planes, height fields, SDFs) that are named.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        layout: Mapping[str, _core.Patch],
        *,
        geoms: Literal["all"] | Sequence[str] = "all",
        tolerance: float = 1e-5,
    ) -> None:
        self._model = model
        self._patches = dict(layout)
        sites = [_identity(model, mujoco.mjtObj.mjOBJ_SITE, name) for name in self._patches]
        carriers = {int(model.site_bodyid[site]) for site in sites}
        if isinstance(geoms, str):
            if geoms != "all":
                raise ValueError(f'geoms: {geoms!r}; "all" or names of geoms')
            found = [geom for geom in range(model.ngeom) if _can_touch(model, geom, carriers)]
        else:
            found = [_identity(model, mujoco.mjtObj.mjOBJ_GEOM, name) for name in geoms]
        if not found:
            raise ValueError("geoms: none that can touch the skin; at least one")
        self._sites = np.array(sites, dtype=np.intp)
        self._geoms = np.array(found, dtype=np.intp)
        bodies = [geom_surface(model, geom, tolerance) for geom in found]
        self._skin = _core.Skin(list(self._patches.values()), bodies)
        names = zip(self._patches, self._skin.ranges, strict=True)
        self._slices = {name: slice(first, last) for name, (first, last) in names}

    @property
    def n_taxels(self) -> int:
        """Number of taxels of all patches."""
        return self._skin.n_taxels

    @property
    def patches(self) -> dict[str, _core.Patch]:
        """Patches by the names of their sites."""
        return dict(self._patches)

    @property
    def geoms(self) -> list[str]:
        """Names of the geoms that can touch the skin; an unnamed geom has the name geom_ID."""
        return [self._model.geom(geom).name or f"geom_{geom}" for geom in self._geoms]

    def read(
        self,
        data: mujoco.MjData,
        *,
        output: Literal["deflection", "force"] = "deflection",
        out: Array | None = None,
        wrenches: Array | None = None,
    ) -> Array:
        """Returns the readings at the poses of `data`, (n_taxels,): deflections, metres, or forces along the taxels' axes, newtons.

        out: array of this shape that is filled and returned. wrenches: (n_patches, 6) array that is filled with the force and the torque on each
        patch, in the site's frame. Call mj_step, mj_forward or mj_kinematics before.
        """
        patch_poses = (data.site_xpos[self._sites], data.site_xmat[self._sites])
        body_poses = (data.geom_xpos[self._geoms], data.geom_xmat[self._geoms])
        return self._skin.read(patch_poses, body_poses, output=output, out=out, wrenches=wrenches)

    def frame(self, name: str, readings: Array) -> Array:
        """Returns the part of one patch in the shape of its frames: (ny, nx) of a grid, otherwise (n_taxels,)."""
        if name not in self._slices:
            raise ValueError(f"name: {name!r}; one of {', '.join(self._slices)}")
        return readings[self._slices[name]].reshape(self._patches[name].shape)

    def install(self, sensor: str, *, output: Literal["deflection", "force"] = "force") -> None:
        """Writes the readings into a `<user>` sensor at every evaluation of the sensors, by MuJoCo's sensor callback.

        The sensor has `dim` = n_taxels and `needstage="pos"`, so that recordings, viewers and observations contain the skin. MuJoCo has one
        sensor callback for each process: the last installed skin holds it. Raises ValueError if the sensor does not fit.
        """
        number = _identity(self._model, mujoco.mjtObj.mjOBJ_SENSOR, sensor)
        is_user = self._model.sensor_type[number] == mujoco.mjtSensor.mjSENS_USER
        if not is_user or self._model.sensor_dim[number] != self.n_taxels:
            given = f"type {self._model.sensor_type[number]}, dim {self._model.sensor_dim[number]}"
            raise ValueError(f"sensor {sensor!r}: {given}; a <user> sensor with dim {self.n_taxels}")
        first = int(self._model.sensor_adr[number])
        target = slice(first, first + self.n_taxels)
        stage = int(self._model.sensor_needstage[number])

        def callback(model: mujoco.MjModel, data: mujoco.MjData, now: int) -> None:
            if now == stage and model.nsensordata == self._model.nsensordata:
                self.read(data, output=output, out=data.sensordata[target])

        mujoco.set_mjcb_sensor(callback)

    def draw(self, scene: mujoco.MjvScene, data: mujoco.MjData, forces: Array, *, largest: float = 1.0) -> None:
        """Adds a sphere for each taxel to a scene of the viewer (`viewer.user_scn`), grey at rest to red at `largest` newtons.

        Clear the user scene before each frame with `viewer.user_scn.ngeom = 0`. Taxels beyond the scene's capacity are not drawn.
        """
        for (name, patch), site in zip(self._patches.items(), self._sites, strict=True):
            rotation = data.site_xmat[site].reshape(3, 3)
            centers = data.site_xpos[site] + patch.centers @ rotation.T
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


def geom_surface(model: mujoco.MjModel, geom: int, tolerance: float = 1e-5) -> _core.Mesh | _core.SphereUnion:
    """Returns the surface of a geom in the geom's frame: exact for spheres, boxes, capsules and meshes, otherwise facets within the tolerance, metres.

    Raises ValueError for planes, height fields and signed distance fields.
    """
    kind, size = mujoco.mjtGeom(model.geom_type[geom]), model.geom_size[geom]
    kinds = mujoco.mjtGeom
    if kind == kinds.mjGEOM_SPHERE:
        return _core.SphereUnion(np.zeros((1, 3)), size[:1])
    if kind == kinds.mjGEOM_BOX:
        return _core.Mesh.box(2.0 * size)
    if kind == kinds.mjGEOM_ELLIPSOID:
        return _core.Mesh.ellipsoid(size, tolerance)
    if kind == kinds.mjGEOM_CAPSULE:
        return _core.Mesh.capsule(size[0], 2.0 * size[1], tolerance)
    if kind == kinds.mjGEOM_CYLINDER:
        return _core.Mesh.cylinder(size[0], 2.0 * size[1], tolerance)
    if kind == kinds.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
        triangles = model.mesh_face[model.mesh_faceadr[mesh] :][: model.mesh_facenum[mesh]]
        return _core.Mesh(vertices.astype(np.float64), triangles)
    name = model.geom(geom).name or f"geom_{geom}"
    raise ValueError(f"geom {name}: a {kind.name[7:].lower()}; a sphere, box, ellipsoid, capsule, cylinder or mesh")


def _identity(model: mujoco.MjModel, kind: mujoco.mjtObj, name: str) -> int:
    number = mujoco.mj_name2id(model, kind, name)
    if number < 0:
        word = kind.name[6:].lower()
        count = {"site": model.nsite, "geom": model.ngeom, "sensor": model.nsensor}[word]
        names = [mujoco.mj_id2name(model, kind, other) for other in range(count)]
        listed = ", ".join(name for name in names if name) or f"a model with named {word}s"
        raise ValueError(f"{word}: {name!r}; one of {listed}")
    return int(number)


def _can_touch(model: mujoco.MjModel, geom: int, carriers: set[int]) -> bool:
    """Returns whether a geom collides, has a surface, and is not on a body that carries a patch."""
    kind = mujoco.mjtGeom(model.geom_type[geom])
    has_surface = kind not in (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD, mujoco.mjtGeom.mjGEOM_SDF)
    collides = bool(model.geom_contype[geom] or model.geom_conaffinity[geom])
    return has_surface and collides and int(model.geom_bodyid[geom]) not in carriers


__all__ = ["Skin", "geom_surface"]

