#!/usr/bin/env python3
"""Times MuJoCo and bubbletouch on equal presses: both programs get the same objects and poses in one run.

A patch of 64 x 64 taxels, 2 mm apart, is pressed 3 mm into an object. Three quantities are read, and errors are relative to the exact value of the
same quantity: the way of balls of 1 mm along the taxel's axis, the way of points along the axis, and the depth of points by signed distance.
README.md beside this file describes the methods and the settings. Needs mujoco, trimesh, numpy and bubbletouch (pip install ./python).
"""

import argparse
import csv
import datetime
import platform
import statistics
import time
from pathlib import Path

import bubbletouch as bt
import mujoco
import numpy as np
import trimesh

ROOT = Path(__file__).resolve().parents[2]
SIDE, PITCH, RADIUS, STROKE, DEPTH = 64, 2e-3, 1e-3, 5e-3, 3e-3
STIFFNESS, TAXEL_MASS = 100.0, 1e-3
# Quantities that a method reads of a taxel. A point is the foremost point of the ball at rest.
BALLS, POINTS, DISTANCE = "way of balls", "way of points", "signed distance of points"
# Radius of the taxels that bubbletouch presses for the way of points, metres.
POINT_RADIUS = 1e-9

COLUMNS = [
    "date", "machine", "program", "version", "quantity", "method", "setting", "object", "n_taxels", "n_touches", "us_per_touch",
    "error_mm", "error_p95_mm", "error_max_mm", "build_s",
]


def grid():
    """Returns the coordinates of the taxels along a side, metres, shape (SIDE,). Taxels are numbered row by row (y)."""
    return (np.arange(SIDE) - (SIDE - 1) / 2) * PITCH


def draw_poses(bounds, n, seed):
    """Returns random poses of an object 0.3 m above the patch, upside down, so that its top touches first: (n, 7), x, y, z, qw, qx, qy, qz."""
    rng = np.random.default_rng(seed)
    rows = []
    middle = bounds.mean(axis=0)
    for _ in range(n):
        yaw, tilts = rng.uniform(0, 2 * np.pi), np.radians(rng.uniform(-5, 5, 2))
        turn = trimesh.transformations.euler_matrix(np.pi + tilts[0], tilts[1], yaw, "rxyz")
        offset = rng.uniform(-10e-3, 10e-3, 2)
        # The middle of the object's box comes over the middle of the patch, and then aside by the offset.
        at = np.array([*offset, 0.3]) - turn[:3, :3] @ middle
        rows.append([*at, *trimesh.transformations.quaternion_from_matrix(turn)])
    return np.array(rows)


class Ours:
    """Presses with bubbletouch's Python module, on one thread. An object is a `bt.Mesh` or a `bt.SphereUnion`."""

    def __init__(self):
        self.patches = {radius: bt.Patch.grid(SIDE, SIDE, PITCH, STROKE, taxel_radius=radius) for radius in (RADIUS, POINT_RADIUS)}

    def press(self, thing, poses, radius=RADIUS):
        """Returns deflections at the poses, metres, (n, n_taxels)."""
        return self.patches[radius].press(thing, poses, threads=1).reshape(len(poses), -1)

    def time(self, thing, poses, radius=RADIUS, repeat=20):
        """Returns the processor times of `repeat` presses at all poses, microseconds a press."""
        out = np.empty((len(poses), SIDE, SIDE))
        return timed(lambda _: self.patches[radius].press(thing, poses, out=out, threads=1), range(repeat), len(poses))

    def at_depth(self, thing, poses):
        """Returns the poses after the travel to the depth `DEPTH`."""
        _, contacts = self.patches[RADIUS].press(thing, poses, depth=DEPTH, contacts=True, threads=1)
        there = poses.copy()
        there[:, 2] -= contacts.travel
        return there

    def pack(self, mesh, name, tolerance_mm):
        """Returns the packed spheres of a mesh and the packing time, seconds; NaN if an earlier run has packed the mesh."""
        folder = ROOT / "target" / "peers" / f"{name}_{tolerance_mm}"
        is_new = not folder.exists()
        start = time.perf_counter()
        spheres = mesh.pack(1e-3 * tolerance_mm, cache=folder)
        return spheres, time.perf_counter() - start if is_new else float("nan")


class Peer:
    """A method of MuJoCo: `model` and `data`, with the quantity that it reads and the time to build the model."""

    def compile(self, spec):
        start = time.perf_counter()
        self.model = spec.compile()
        self.build_s = time.perf_counter() - start
        self.data = mujoco.MjData(self.model)

    def place(self, pose):
        """Sets the pose of the object relative to the patch, whose points are at the height of the foremost points of the balls."""
        self.data.qpos[:] = pose
        self.data.qpos[2] -= RADIUS
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)


class TactileSensor(Peer):
    """MuJoCo's tactile sensor: the depth of each vertex of a pad inside the object, from the object's signed-distance octree."""

    method, quantity = "mujoco_tactile", DISTANCE

    def __init__(self, mesh, octree_depth):
        self.setting = f"octree depth {octree_depth}"
        spec = object_on_free_joint(mesh, needsdf=True, octree_maxdepth=octree_depth)
        xs = grid()
        vertices = np.array([[x, y, 0.0] for y in xs for x in xs])
        corner = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)[:-1, :-1].ravel()
        faces = np.concatenate([[[c, c + 1, c + SIDE], [c + 1, c + SIDE + 1, c + SIDE]] for c in corner])
        add_mesh(spec, "pad", vertices, faces, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
        # The sensor reads only objects that collide with its body. A box provides the collisions and costs 6 us.
        spec.worldbody.add_geom(name="pad", type=mujoco.mjtGeom.mjGEOM_MESH, meshname="pad", contype=0, conaffinity=0)
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.064, 0.064, 0.01], pos=[0, 0, -0.01])
        spec.add_sensor(
            name="skin", type=mujoco.mjtSensor.mjSENS_TACTILE, objtype=mujoco.mjtObj.mjOBJ_MESH, objname="pad",
            reftype=mujoco.mjtObj.mjOBJ_GEOM, refname="pad",
        )
        self.compile(spec)

    def read(self, pose):
        self.evaluate(pose)
        return self.data.sensordata[: SIDE * SIDE].copy()

    def evaluate(self, pose):
        """Evaluates only the stages that the sensor needs: kinematics, collisions and the sensor. A whole step takes slightly longer."""
        self.place(pose)
        mujoco.mj_collision(self.model, self.data)
        mujoco.mj_sensorVel(self.model, self.data)


class Rays(Peer):
    """MuJoCo's rangefinder of an orthographic camera: one ray along the axis of each taxel (`mj_ray`), which starts one stroke behind its point."""

    method, quantity, setting = "mujoco_rays", POINTS, "rangefinder of a camera"

    def __init__(self, mesh):
        spec = object_on_free_joint(mesh)
        camera = spec.worldbody.add_camera(name="skin", pos=[0, 0, -STROKE], quat=[0, 1, 0, 0])
        camera.proj, camera.fovy, camera.resolution = mujoco.mjtProjection.mjPROJ_ORTHOGRAPHIC, SIDE * PITCH, [SIDE, SIDE]
        spec.add_sensor(
            name="skin", type=mujoco.mjtSensor.mjSENS_RANGEFINDER, objtype=mujoco.mjtObj.mjOBJ_CAMERA, objname="skin",
            intprm=[1 << int(mujoco.mjtRayDataField.mjRAYDATA_DIST), 0, 0],
        )
        self.compile(spec)

    def read(self, pose):
        self.evaluate(pose)
        distance = self.data.sensordata
        return np.where(distance < 0, 0, np.maximum(0, STROKE - distance))

    def evaluate(self, pose):
        self.place(pose)
        mujoco.mj_camlight(self.model, self.data)
        mujoco.mj_sensorPos(self.model, self.data)


class Bodies(Peer):
    """Taxels as bodies on slide joints in MuJoCo. Each taxel is a ball of 1 g on a spring with critical damping."""

    method, quantity = "mujoco_bodies", BALLS

    def __init__(self, mesh, n_steps, dt):
        """Creates the model. The object is the convex hull of `mesh`, or a ball if `mesh` is a radius in metres."""
        self.n_steps = n_steps
        self.setting = f"{'ball' if np.isscalar(mesh) else 'hull'}, {n_steps} steps of {1e3 * dt:g} ms"
        spec = mujoco.MjSpec()
        spec.option.gravity = [0, 0, 0]
        spec.option.timestep = dt
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
        # Hardest contacts. With the engine's limit on the recovery time of contacts (two steps), taxels would not be at rest after ten steps.
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_REFSAFE
        contact = dict(solref=[0.1 * dt, 1], solimp=[0.99, 0.9999, 1e-4, 0.5, 2], friction=[0, 0, 0], condim=1)
        body = spec.worldbody.add_body(name="object", mocap=True)
        if np.isscalar(mesh):
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[mesh, 0, 0], contype=1, conaffinity=2, **contact)
        else:
            add_mesh(spec, "object", mesh.vertices, mesh.faces)
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="object", contype=1, conaffinity=2, **contact)
        damping = 2 * np.sqrt(STIFFNESS * TAXEL_MASS)
        for y in grid():
            for x in grid():
                taxel = spec.worldbody.add_body(pos=[x, y, 0])
                # Stiffness and damping are polynomials of the deflection and its rate.
                taxel.add_joint(
                    type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, -1], stiffness=[STIFFNESS, 0, 0], damping=[damping, 0, 0]
                )
                taxel.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[RADIUS, 0, 0], mass=TAXEL_MASS, contype=2, conaffinity=1, **contact)
        self.compile(spec)

    def read(self, pose):
        self.evaluate(pose)
        return self.data.qpos.copy()

    def evaluate(self, pose):
        model, data = self.model, self.data
        mujoco.mj_resetData(model, data)
        data.mocap_pos[0], data.mocap_quat[0] = pose[:3], pose[3:]
        for _ in range(self.n_steps):
            mujoco.mj_step(model, data)


def object_on_free_joint(mesh, **options):
    """Returns a model without gravity whose only body is the object, a mesh with a free joint."""
    spec = mujoco.MjSpec()
    spec.option.gravity = [0, 0, 0]
    add_mesh(spec, "object", mesh.vertices, mesh.faces, **options)
    body = spec.worldbody.add_body(name="object")
    body.add_freejoint()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="object")
    return spec


def add_mesh(spec, name, vertices, faces, **options):
    mesh = spec.add_mesh(name=name)
    mesh.uservert, mesh.userface = np.asarray(vertices).ravel().tolist(), np.asarray(faces).ravel().tolist()
    for key, value in options.items():
        setattr(mesh, key, value)


def depths_by_distance(mesh, poses, inside):
    """Returns the exact signed distance of the points below the surface of a closed mesh, metres, (n, n_taxels): an independent slow computation.

    Points with a way of zero (`inside`, (n, n_taxels), is false) are outside and have depth zero.
    """
    xs = grid()
    points = np.array([[x, y, RADIUS] for y in xs for x in xs])
    depths = np.zeros(inside.shape)
    for pose, of_pose, row in zip(poses, inside, depths):
        turn = trimesh.transformations.quaternion_matrix(pose[3:])[:3, :3]
        in_object = (points[of_pose] - pose[:3]) @ turn
        row[of_pose] = trimesh.proximity.closest_point_naive(mesh, in_object)[1]
    return depths


def error_of(felt, truth):
    """Returns the mean, the 95th percentile and the maximum of |felt - truth|, mm, over taxels that are touched in either of them."""
    either = (felt > 0) | (truth > 0)
    off = 1e3 * np.abs(np.maximum(felt, 0) - truth)[either]
    return off.mean(), np.percentile(off, 95), off.max()


def timed(evaluate, poses, n=1):
    """Returns the processor time of each pose's evaluation, which consists of n touches, microseconds a touch."""
    times = []
    for pose in poses:
        start = time.process_time()
        evaluate(pose)
        times.append(1e6 * (time.process_time() - start) / n)
    return times


def compare(object_name, truth, peers, ours, sources, poses, rounds):
    """Returns the table rows of an object. Peers and bubbletouch alternate; the times are medians over all rounds.

    `truth` has the exact readings of each quantity; `sources` has the quantity, name, object and packing time of each source of ours. For the way of points,
    bubbletouch presses balls of nearly no radius at the foremost points.
    """
    times = {method: [] for method in (*peers, *range(len(sources)))}
    at = {BALLS: (poses, RADIUS), POINTS: (poses - [0, 0, RADIUS, 0, 0, 0, 0], POINT_RADIUS)}
    for _ in range(rounds):
        for number, (quantity, _, thing, _) in enumerate(sources):
            times[number] += ours.time(thing, *at[quantity])
        for peer in peers:
            times[peer] += timed(peer.evaluate, poses)
    rows = []
    for number, (quantity, setting, thing, build_s) in enumerate(sources):
        errors = error_of(ours.press(thing, *at[quantity]), truth[quantity])
        rows.append(("bubbletouch", quantity, "bubbletouch", setting, statistics.median(times[number]), errors, build_s))
    for peer in peers:
        errors = error_of(np.array([peer.read(pose) for pose in poses]), truth[peer.quantity])
        rows.append(("MuJoCo", peer.quantity, peer.method, peer.setting, statistics.median(times[peer]), errors, peer.build_s))
    return [row_of(object_name, len(poses), *row) for row in rows]


def row_of(object_name, n_touches, program, quantity, method, setting, us, errors, build_s):
    row = dict(zip(["error_mm", "error_p95_mm", "error_max_mm"], [f"{error:.6f}" for error in errors]))
    version = mujoco.__version__ if program == "MuJoCo" else package_version()
    return row | {
        "date": datetime.date.today().isoformat(), "machine": machine(), "program": program, "version": version,
        "quantity": quantity, "method": method, "setting": setting, "object": object_name, "n_taxels": SIDE * SIDE, "n_touches": n_touches, "us_per_touch": f"{us:.3f}",
        "build_s": "" if np.isnan(build_s) else f"{build_s:.2f}",
    }


def package_version():
    lines = (ROOT / "Cargo.toml").read_text().splitlines()
    return next(line.split('"')[1] for line in lines if line.startswith("version"))


def machine():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def on_mesh(path, ours, options):
    mesh = trimesh.load(path, process=False)
    print(f"{path.stem}: {len(mesh.faces)} triangles", flush=True)
    exact = bt.Mesh.read(path)
    poses = ours.at_depth(exact, draw_poses(mesh.bounds, options.touches, seed=len(mesh.faces)))
    sources = [(BALLS, "exact mesh", exact, 0.0), (POINTS, "exact mesh", exact, 0.0)]
    for tolerance in options.tolerances_mm:
        spheres, build_s = ours.pack(exact, path.stem, tolerance)
        sources.append((BALLS, f"packed within {tolerance:g} mm", spheres, build_s))
    rays = Rays(mesh)
    points = np.array([rays.read(pose) for pose in poses])
    truth = {BALLS: ours.press(exact, poses), POINTS: points, DISTANCE: depths_by_distance(mesh, poses, points > 0)}
    sensors = [TactileSensor(mesh, depth) for depth in options.octree_depths]
    bodies = [Bodies(mesh, n, dt) for dt in options.dts for n in options.steps]
    return compare(path.stem, truth, [rays, *sensors, *bodies], ours, sources, poses, options.rounds)


def on_ball(ours, options, radius=0.05):
    """Returns the table rows of a ball, which is one exact sphere without a mesh."""
    ball = bt.SphereUnion([[0.0, 0.0, 0.0]], [radius])
    poses = ours.at_depth(ball, draw_poses(np.array([[-radius] * 3, [radius] * 3]), options.touches, seed=1))
    truth = {BALLS: ours.press(ball, poses)}
    bodies = [Bodies(radius, n, dt) for dt in options.dts for n in options.steps]
    return compare("ball_100mm", truth, bodies, ours, [(BALLS, "one sphere", ball, 0.0)], poses, options.rounds)


def tell(rows):
    """Prints the rows. For MuJoCo, prints the ratio of its time to the shortest time of bubbletouch for an equal quantity at an equal or smaller error."""
    for row in rows:
        print("  {object:24} {program:12} {quantity:24} {setting:28} {us_per_touch:>10} us  {error_mm} mm".format(**row), end="")
        equal = [our for our in rows if our["program"] == "bubbletouch" and our["object"] == row["object"] and our["quantity"] == row["quantity"]]
        better = [our for our in equal if float(our["error_mm"]) <= float(row["error_mm"]) + 1e-3]
        if row["program"] == "MuJoCo" and better:
            best = min(better, key=lambda our: float(our["us_per_touch"]))
            print(f"  {float(row['us_per_touch']) / float(best['us_per_touch']):7.1f} x {best['setting']}", end="")
        print()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--objects", type=Path, required=True, help="a folder of closed PLY meshes in metres")
    parser.add_argument("--names", nargs="*", help="only these meshes (names without ending); all when left out")
    parser.add_argument("--touches", type=int, default=10, help="touches an object")
    parser.add_argument("--rounds", type=int, default=3, help="how often all take turns")
    parser.add_argument("--tolerances-mm", type=float, nargs="*", default=[0.5, 0.2, 0.1])
    parser.add_argument("--octree-depths", type=int, nargs="*", default=[6, 7])
    parser.add_argument("--steps", type=int, nargs="*", default=[1, 3], help="steps of taxels as bodies; three settle them")
    parser.add_argument("--dts", type=float, nargs="*", default=[1e-2], help="their time steps, s")
    parser.add_argument("--append", action="store_true", help="keep the rows of other objects that the file has")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "peers" / "contact.csv")
    options = parser.parse_args()
    paths = sorted(path for path in options.objects.glob("*.ply") if not options.names or path.stem in options.names)
    if not paths:
        parser.error(f"no PLY meshes of these names in {options.objects}")
    ours = Ours()
    rows = kept(options.out) if options.append else []
    if not options.append:
        rows += on_ball(ours, options)
        tell(rows)
    for path in paths:
        new = on_mesh(path, ours, options)
        tell(new)
        rows = [row for row in rows if row["object"] != path.stem] + new
        write(options.out, rows)


def kept(path):
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def write(path, rows):
    """Writes the rows to a temporary file and renames it, so that no partial table remains."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    with open(part, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    part.replace(path)


if __name__ == "__main__":
    main()
