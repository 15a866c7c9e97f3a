"""Surfaces of MuJoCo's geoms as contact models."""

from __future__ import annotations

import warnings

import mujoco
import numpy as np
from numpy.typing import NDArray

import bubbletouch._core as _core

# Least tolerance of ellipsoids and round ends, relative to their mean radius. If smaller, large ones have millions of triangles; if larger, facets of a few
# centimetres are coarser than taxels.
RELATIVE = 1e-4


def geom_surface(model: mujoco.MjModel, geom: int, tolerance: float = 1e-5, *, hulls: bool = False) -> _core.Mesh | _core.SphereUnion:
    """Returns the surface of a geom in the geom's frame: exact for spheres, boxes, capsules, meshes and height fields, otherwise facets within the
    tolerance, metres.

    A plane is a box of 2 km whose upper face is in the plane. A height field is the solid of MuJoCo's prisms. A mesh is the mesh itself or, with
    `hulls`, its convex hull, which MuJoCo's contacts use. A closed mesh whose triangles point inwards is turned outwards with a warning. A signed distance
    field (SDF) is the mesh that MuJoCo samples from the field. The tolerance of large ellipsoids and round ends is at least 1e-4 of their mean radius. Raises
    ValueError if `hulls` is set and the model has no hull of the mesh.
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
        return _core.Mesh.ellipsoid(size, max(tolerance, RELATIVE * float(np.cbrt(size.prod()))))
    if kind == kinds.mjGEOM_CAPSULE:
        return _core.Mesh.capsule(size[0], 2.0 * size[1], max(tolerance, RELATIVE * float(size[0])))
    if kind == kinds.mjGEOM_CYLINDER:
        return _core.Mesh.cylinder(size[0], 2.0 * size[1], tolerance)
    if kind == kinds.mjGEOM_HFIELD:
        return _height_field(model, int(model.geom_dataid[geom]))
    if kind in (kinds.mjGEOM_MESH, kinds.mjGEOM_SDF):
        mesh = model.geom_dataid[geom]
        if hulls and kind == kinds.mjGEOM_MESH:
            if model.mesh_graphadr[mesh] < 0:
                raise ValueError(f"geom {_name(model, geom)}: the model has no convex hull of its mesh; hulls=False, or a mesh that collides")
            return _convex_hull(model, int(mesh))
        vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
        triangles = model.mesh_face[model.mesh_faceadr[mesh] :][: model.mesh_facenum[mesh]]
        surface = _core.Mesh(vertices.astype(np.float64), triangles)
        if surface.volume < 0.0 and _is_closed(triangles):
            warnings.warn(f"geom {_name(model, geom)}: the triangles of its mesh point inwards; they are turned outwards", stacklevel=2)
            return _core.Mesh(vertices.astype(np.float64), triangles[:, ::-1])
        return surface
    raise ValueError(f"geom {_name(model, geom)}: a {kind.name[7:].lower()}; a plane, sphere, box, ellipsoid, capsule, cylinder, mesh, hfield or sdf")


def depth_behind(
    model: mujoco.MjModel, data: mujoco.MjData, body: int, points: NDArray[np.float64], axes: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns how far the geoms that are welded to a body extend behind points on their surface, metres, (n,): the first gap against the axis. 0 if a point is
    on no such geom. Each geom counts from its first to its last surface along the axis."""
    far = 10.0 * (1.0 + float(model.stat.extent))
    of_geoms = np.flatnonzero(model.body_weldid[model.geom_bodyid] == model.body_weldid[body]).tolist()
    spans = np.full((len(of_geoms), len(points), 2), np.inf)
    for row, geom in enumerate(of_geoms):
        for at, (point, axis) in enumerate(zip(points, axes, strict=True)):
            from_front, from_back = _ray(model, data, geom, point + far * axis, -axis), _ray(model, data, geom, point - far * axis, axis)
            if from_front >= 0.0 and from_back >= 0.0:
                spans[row, at] = from_front - far, far - from_back
    depths = np.zeros(len(points))
    for _ in of_geoms:
        near = spans[..., 0] <= depths + SURFACE
        depths = np.maximum(depths, np.where(near, spans[..., 1], 0.0).max(axis=0))
    return depths


# Largest distance of a taxel above the surface of its pad, and largest gap between two geoms of a pad, metres. If larger, taxels over a hollow count as lying on
# its floor; if smaller, a site just above its pad has no pad.
SURFACE = 1e-3


def _ray(model: mujoco.MjModel, data: mujoco.MjData, geom: int, point: NDArray[np.float64], direction: NDArray[np.float64]) -> float:
    """Returns the distance along a ray to the surface of a geom, metres; negative if the ray misses it."""
    kind = mujoco.mjtGeom(model.geom_type[geom])
    if kind in (mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_SDF):
        return float(mujoco.mj_rayMesh(model, data, geom, point, direction))
    if kind == mujoco.mjtGeom.mjGEOM_HFIELD:
        return float(mujoco.mj_rayHfield(model, data, geom, point, direction))
    return float(mujoco.mju_rayGeom(data.geom_xpos[geom], data.geom_xmat[geom], model.geom_size[geom], point, direction, int(kind)))


def _is_closed(triangles: NDArray[np.int32]) -> bool:
    """Returns whether each edge of a mesh has a second triangle, which passes it in the other direction."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    return bool(np.array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0)))


def _name(model: mujoco.MjModel, geom: int) -> str:
    return model.geom(geom).name or f"geom_{geom}"


def _convex_hull(model: mujoco.MjModel, mesh: int) -> _core.Mesh:
    """Returns the convex hull of a mesh from its graph in the model: numbers of vertices and faces, tables of vertices and edges, and corners of the faces."""
    graph = model.mesh_graph[model.mesh_graphadr[mesh] :]
    n_vertices, n_faces = int(graph[0]), int(graph[1])
    corners = graph[2 + 3 * n_vertices + 3 * n_faces :][: 3 * n_faces]
    used, triangles = np.unique(corners, return_inverse=True)
    vertices = model.mesh_vert[model.mesh_vertadr[mesh] + used]
    return _core.Mesh(vertices.astype(np.float64), triangles.reshape(-1, 3))


def _height_field(model: mujoco.MjModel, field: int) -> _core.Mesh:
    """Returns the solid between a height field and its base. Each cell has two triangles, which meet on the diagonal from the lower row and column."""
    n_rows, n_columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    width, depth, top, base = model.hfield_size[field]
    numbers = np.arange(n_rows * n_columns).reshape(n_rows, n_columns)
    heights = top * model.hfield_data[model.hfield_adr[field] :][: numbers.size].astype(np.float64)
    x, y = np.meshgrid(np.linspace(-width, width, n_columns), np.linspace(-depth, depth, n_rows))
    surface = np.stack([x.ravel(), y.ravel(), heights], axis=1)
    a, b, c, d = (part.ravel() for part in (numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]))
    # Rim, counterclockwise from above; below it the rim of the base, with a vertex in the middle.
    rim = np.concatenate([numbers[0, :-1], numbers[:-1, -1], numbers[-1, :0:-1], numbers[:0:-1, 0]])
    below = numbers.size + np.arange(len(rim))
    following, below_following = np.roll(rim, -1), np.roll(below, -1)
    middle = np.full(len(rim), numbers.size + len(rim))
    foot = np.append(surface[rim], [[0.0, 0.0, 0.0]], axis=0)
    foot[:, 2] = -base
    triangles = [(a, b, c), (a, c, d), (rim, below, below_following), (rim, below_following, following), (middle, below_following, below)]
    return _core.Mesh(np.append(surface, foot, axis=0), np.concatenate([np.stack(corners, axis=1) for corners in triangles]))
