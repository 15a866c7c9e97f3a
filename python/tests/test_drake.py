"""Skin in Drake: the core is the one that MuJoCo uses."""

from __future__ import annotations

import bubbletouch as bt
import numpy as np
import pytest

pytest.importorskip("pydrake")
from bubbletouch.drake import Skin, shape_surface  # noqa: E402
from pydrake import geometry as shapes  # noqa: E402
from pydrake.math import RigidTransform, RotationMatrix  # noqa: E402
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction  # noqa: E402
from pydrake.multibody.tree import FixedOffsetFrame, PrismaticJoint, SpatialInertia  # noqa: E402
from pydrake.systems.analysis import Simulator  # noqa: E402
from pydrake.systems.framework import DiagramBuilder  # noqa: E402

from conftest import refused

MASS = 0.2
# Shapes, with the height of their lowest point below their centre.
SHAPES = [
    (shapes.Sphere(0.03), 0.03),
    (shapes.Box(0.05, 0.04, 0.03), 0.015),
    (shapes.Capsule(0.015, 0.03), 0.03),
    (shapes.Cylinder(0.02, 0.04), 0.02),
    (shapes.Ellipsoid(0.03, 0.02, 0.02), 0.02),
]


def scene(shape, height: float, tilt: float = 0.0, **options):
    """Returns a diagram of a plate with a patch `palm` and a free body over it, with the skin."""
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=1e-3)
    friction = CoulombFriction(0.8, 0.8)
    inertia = SpatialInertia.SolidBoxWithMass(MASS, 0.04, 0.04, 0.04)
    plate = plant.AddRigidBody("plate", inertia)
    plant.RegisterCollisionGeometry(plate, RigidTransform([0, 0, -0.01]), shapes.Box(0.1, 0.1, 0.02), "plate", friction)
    plant.WeldFrames(plant.world_frame(), plate.body_frame(), RigidTransform(RotationMatrix.MakeXRotation(tilt), [0, 0, 0.1]))
    plant.AddFrame(FixedOffsetFrame("palm", plate.body_frame(), RigidTransform()))
    thing = plant.AddRigidBody("thing", inertia)
    plant.RegisterCollisionGeometry(thing, RigidTransform(), shape, "thing", friction)
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform([0, 0, -1]), shapes.HalfSpace(), "floor", friction)
    plant.Finalize()
    layout = {"palm": bt.Patch.grid(20, 20, 3e-3, 4e-3, stiffness=200.0)}
    skin = Skin(plant, scene_graph, layout, **options)
    simulator = Simulator(builder.Build())
    place = RigidTransform(RotationMatrix.MakeXRotation(tilt), RotationMatrix.MakeXRotation(tilt) @ [0, 0, height] + [0, 0, 0.1])
    plant.SetFreeBodyPose(plant.GetMyMutableContextFromRoot(simulator.get_mutable_context()), thing, place)
    return simulator, plant, skin, layout["palm"]


@pytest.mark.parametrize(("shape", "below"), SHAPES, ids=lambda value: type(value).__name__)
def test_readings_are_those_of_the_surface_at_the_engine_s_pose(shape, below: float) -> None:
    surface = shape_surface(shape)
    for tilt in (0.0, 0.4):
        simulator, _, skin, patch = scene(shape, below, tilt)
        read = skin.read(simulator.get_context())
        alone = patch.press(surface, [0, 0, below, 1, 0, 0, 0])
        assert alone.any() and np.abs(read - alone.ravel()).max() < 1e-12


@pytest.mark.parametrize("shape", [shapes.Sphere(0.02), shapes.Box(0.05, 0.04, 0.04)], ids=["ball", "box"])
def test_matched_forces_are_the_engine_s(shape) -> None:
    simulator, plant, skin, _ = scene(shape, 0.0199)
    residuals, forces = np.empty((1, 2)), np.empty((1, 2))
    context, n_pressed = simulator.get_context(), 0
    for time in np.linspace(0.01, 0.5, 30):
        simulator.AdvanceTo(time)
        read = skin.read(context, output="force", match="normal_force", residuals=residuals, pair_forces=forces)
        results = plant.get_contact_results_output_port().Eval(plant.GetMyContextFromRoot(context))
        contacts = [results.point_pair_contact_info(k) for k in range(results.num_point_pair_contacts())]
        engine = sum(abs(contact.contact_force() @ contact.point_pair().nhat_BA_W) for contact in contacts)
        assert abs(read.sum() - engine) < 1e-6 and np.abs(residuals).max() < 1e-6, time
        assert abs(forces.sum() - read.sum()) < 1e-9
        n_pressed += engine > 0.1
    assert n_pressed > 10
    if isinstance(shape, shapes.Sphere):
        assert abs(engine - MASS * 9.81) < 0.01  # the ball lies still
    refused("match: 'force'", lambda: skin.read(context, match="force"))


def test_hulls_and_names(tmp_path) -> None:
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    file = tmp_path / "cube.obj"
    faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    file.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {face}\n" for face in faces))
    for kind in (shapes.Mesh, shapes.Convex):
        mesh = shape_surface(kind(str(file), 0.02))
        assert np.allclose(mesh.bounds, [[0, 0, 0], [0.02] * 3]) and abs(mesh.volume - 8e-6) < 1e-15
    refused("MeshcatCone; a HalfSpace, Sphere", lambda: shape_surface(shapes.MeshcatCone(1.0)))
    _, _, skin, _ = scene(shapes.Sphere(0.03), 0.03)
    assert skin.skin.n_taxels == 400
    refused("geometries: 'cup'; one of .*thing", lambda: scene(shapes.Sphere(0.03), 0.03, geometries=["cup"]))


def test_neighbours_that_drake_filters_press_no_patch() -> None:
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=1e-3)
    below = plant.world_body()
    for name in ("base", "link", "tip"):
        body = plant.AddRigidBody(name, SpatialInertia.SolidBoxWithMass(MASS, 0.04, 0.04, 0.04))
        plant.RegisterCollisionGeometry(body, RigidTransform(), shapes.Box(0.05, 0.05, 0.06), name, CoulombFriction(0.8, 0.8))
        plant.AddJoint(PrismaticJoint(name, below.body_frame(), body.body_frame(), [0, 0, 1]))
        below = body
    plant.Finalize()
    patch = bt.Patch.grid(4, 4, 3e-3, 5e-3)
    # The boxes overlap; joints connect base and link, and link and tip.
    skin = Skin(plant, scene_graph, {"link": patch, "tip": patch})
    assert [plant.get_body(body).name() for body in skin.bodies] == ["base"]
    read = skin.read(Simulator(builder.Build()).get_context())
    assert not read[:16].any() and read[16:].all()
