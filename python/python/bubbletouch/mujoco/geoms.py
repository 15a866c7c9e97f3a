"""Surfaces of MuJoCo's geoms as contact models."""

from __future__ import annotations

import mujoco
import numpy as np

import bubbletouch._core as _core



def geom_surface(model: mujoco.MjModel, geom: int, tolerance: float = 1e-5) -> _core.Mesh | _core.SphereUnion:
    """Returns the surface of a geom in the geom's frame: exact for spheres, boxes, capsules and meshes, otherwise facets within the tolerance, metres.

    A plane is a box of 2 km whose upper face is in the plane. Raises ValueError for height fields and signed distance fields.
    """
    kind, size = mujoco.mjtGeom(model.geom_type[geom]), model.geom_size[geom]
    kinds = mujoco.mjtGeom
    if kind == kinds.mjGEOM_SPHERE:
        return _core.SphereUnion(np.zeros((1, 3)), size[:1])
    if kind == kinds.mjGEOM_BOX:
        return _core.Mesh.box(2.0 * size)
    if kind == kinds.mjGEOM_PLANE:
        box = _core.Mesh.box([2e3, 2e3, 2e3])
        return _core.Mesh(box.vertices - [0.0, 0.0, 1e3], box.triangles)
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
    raise ValueError(f"geom {name}: a {kind.name[7:].lower()}; a plane, sphere, box, ellipsoid, capsule, cylinder or mesh")
