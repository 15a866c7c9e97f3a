"""Skin for Drake: taxels on frames of a MultibodyPlant, read at the poses of a context. Needs the package drake.

    skin = Skin(plant, scene_graph, {"palm": bt.Patch.grid(8, 8, pitch=4e-3, stroke=3e-3)})
    forces = skin.read(simulator.get_context(), output="force", match="normal_force")     # (n_taxels,), newtons

The patches do not affect the dynamics. The interface equals bubbletouch.mujoco.Skin and has the same core.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydrake import geometry as shapes
from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

import bubbletouch._core as _core
from bubbletouch._contact_forces import contact_loads

if TYPE_CHECKING:
    from typing_extensions import Unpack

Array = NDArray[np.float64]


class Skin:
    """Patches on frames of a finalized plant, under its collision geometries.

    layout: patches by the name of the frame or body that carries each. geometries: "all", or names of geometries with the proximity role; with "all", a
    geometry can touch a patch if Drake's collision filter allows it to touch the patch's body. tolerance: as for bubbletouch.mujoco.Skin.
    """

    def __init__(
        self, plant: MultibodyPlant, scene_graph: SceneGraph, layout: Mapping[str, _core.Patch], *,
        geometries: Literal["all"] | Sequence[str] = "all", tolerance: float = 1e-5,
    ) -> None:
        self._plant, self._scene_graph = plant, scene_graph
        self._frames = [plant.GetFrameByName(name) for name in layout]
        carriers = [frame.body().index() for frame in self._frames]
        of = scene_graph.model_inspector()
        found = [i for i in of.GetAllGeometryIds() if of.GetProximityProperties(i)]
        bodies = {i: plant.GetBodyFromFrameId(of.GetFrameId(i)).index() for i in found}
        names = {of.GetName(i).split("::")[-1]: i for i in found}
        fixed = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}
        own = [[i for i in found if bodies[i] == body] for body in carriers]
        can = {i: np.array([bodies[i] != body for body in carriers]) for i in found}
        if geometries == "all":
            for i in found:  # Drake filters all pairs of bodies that are fixed to the world.
                filtered = [bool(j) and all(of.CollisionFiltered(i, k) for k in j) for j in own]
                can[i] &= [not filtered[p] or (bodies[i] in fixed and body in fixed) for p, body in enumerate(carriers)]
            self._touching = [i for i in found if any(can[i])]
        else:
            if unknown := [name for name in geometries if name not in names]:
                raise ValueError(f"geometries: {unknown[0]!r}; one of {', '.join(names)}")
            self._touching = [names[name] for name in geometries]
        # The geometries of one body press a patch together.
        self.bodies = list(dict.fromkeys(bodies[i] for i in self._touching))
        objects = {i: self.bodies.index(bodies[i]) for i in self._touching}
        surfaces = [shape_surface(of.GetShape(i), tolerance) for i in self._touching]
        groups = list(dict.fromkeys(carriers))
        # Index of the carrier and of the object of each geometry; -1 for none.
        self._carrier = {i: groups.index(body) if body in groups else -1 for i, body in bodies.items()}
        self._object = {i: objects.get(i, -1) for i in found}
        self.skin = _core.Skin(
            list(layout.values()), surfaces, objects=list(objects.values()), can_touch=np.array([can[i] for i in self._touching]).T,
            carriers=[groups.index(body) for body in carriers],
        )

    def read(self, context: Context, *, match: Literal["normal_force", "contact_force"] | None = None, **options: Unpack[_core._ReadOptions]) -> Array:
        """Returns the readings at the poses of the diagram's context, (n_taxels,). The options are those of bubbletouch.Skin.read; `match` is the one of
        bubbletouch.mujoco.Skin.read, with the point contacts of the plant's contact results."""
        plant = self._plant.GetMyContextFromRoot(context)
        query: Any = self._scene_graph.get_query_output_port().Eval(self._scene_graph.GetMyContextFromRoot(context))
        patches = _parts([frame.CalcPoseInWorld(plant) for frame in self._frames])
        bodies = _parts([query.GetPoseInWorld(identity) for identity in self._touching])
        if match not in (None, "normal_force", "contact_force"):
            raise ValueError(f'match: {match!r}; None or "normal_force" or "contact_force"')
        loads = None if match is None else self._loads(self._plant.get_contact_results_output_port().Eval(plant), match)
        return self.skin.read(patches, bodies, loads=loads, **options)

    def _loads(self, results: Any, match: str) -> tuple[NDArray[np.generic], ...]:
        contacts = [results.point_pair_contact_info(k) for k in range(results.num_point_pair_contacts())]
        pairs = [(c.point_pair().id_A, c.point_pair().id_B) for c in contacts]
        carriers, objects = (np.array([[of[i] for i in pair] for pair in pairs], int).reshape(-1, 2) for of in (self._carrier, self._object))
        points = np.array([c.contact_point() for c in contacts]).reshape(-1, 3)
        # Drake's normal points from B to A, and its force acts on B.
        normals = -np.array([c.point_pair().nhat_BA_W for c in contacts]).reshape(-1, 3)
        forces = np.array([c.contact_force() for c in contacts]).reshape(-1, 3)
        normal = np.einsum("ck,ck->c", forces, normals)[:, None] * normals
        others = () if match == "normal_force" else (forces - normal, np.zeros_like(forces))
        return contact_loads(carriers, objects, points, normal, *others)


def shape_surface(shape: Any, tolerance: float = 1e-5) -> _core.Mesh | _core.SphereUnion:
    """Returns the surface of a shape as bubbletouch.mujoco.geom_surface does; a Mesh or Convex is its convex hull, as for Drake's point contact."""
    if isinstance(shape, shapes.Sphere):
        return _core.SphereUnion(np.zeros((1, 3)), [shape.radius()])
    if isinstance(shape, shapes.Box):
        return _core.Mesh.box(shape.size())
    if isinstance(shape, shapes.HalfSpace):
        box = _core.Mesh.box([2e3, 2e3, 2e3])
        return _core.Mesh(box.vertices - [0.0, 0.0, 1e3], box.triangles)
    if isinstance(shape, shapes.Ellipsoid):
        return _core.Mesh.ellipsoid([shape.a(), shape.b(), shape.c()], tolerance)
    if isinstance(shape, shapes.Capsule | shapes.Cylinder):
        make = _core.Mesh.capsule if isinstance(shape, shapes.Capsule) else _core.Mesh.cylinder
        return make(shape.radius(), shape.length(), tolerance)
    if not isinstance(shape, shapes.Mesh | shapes.Convex):
        raise ValueError(f"geometry: {type(shape).__name__}; a HalfSpace, Sphere, Box, Ellipsoid, Capsule, Cylinder, Mesh or Convex")
    hull = shape.GetConvexHull()
    faces = [hull.element(k) for k in range(hull.num_elements())]
    fans = [(f.vertex(0), f.vertex(k), f.vertex(k + 1)) for f in faces for k in range(1, f.num_vertices() - 1)]
    return _core.Mesh([hull.vertex(k) for k in range(hull.num_vertices())], fans)


def _parts(poses: Sequence[Any]) -> tuple[Array, Array]:
    """Returns the positions (n, 3) and rotation matrices (n, 9) of rigid transforms."""
    return np.array([X.translation() for X in poses]), np.array([X.rotation().matrix().ravel() for X in poses])


__all__ = ["Skin", "shape_surface"]
