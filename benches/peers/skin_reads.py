#!/usr/bin/env python3
"""Times readings of skin from Python as a simulation loop makes them, beside MuJoCo's own sensors; all in one process, in turn, one thread.

Four parts: 16 x 16 taxels at one pose and in batches, on meshes of 12 to 101,250 triangles; the same number of taxels on a curved layout, with
contacts and with shear; 64 x 64 taxels on meshes of a folder, exact and packed; and a hand of 20 patches under five bodies, beside a step of the
engine. Times are medians over rounds of the means of repeated calls.
Needs mujoco, trimesh, numpy and bubbletouch (pip install ./python).
"""

import argparse
import csv
import datetime
import statistics
import sys
import time
import warnings
from pathlib import Path

import bubbletouch as bt
import contact
import mujoco
import numpy as np
import trimesh

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python" / "tests"))

import hands  # noqa: E402

SIDE, PITCH, RADIUS, STROKE, DEPTH = 16, 2e-3, 1e-3, 5e-3, 2e-3
COLUMNS = ["date", "machine", "part", "object", "n_triangles", "n_taxels", "program", "method", "us", "ratio", "limit_us"]
TOUCH_GRID = """
<mujoco>
  <extension><plugin plugin="mujoco.sensor.touch_grid"/></extension>
  <worldbody>
    <body name="pad"><geom type="box" size="0.02 0.02 0.01" pos="0 0 -0.01"/><site name="pad"/></body>
    <body pos="0 0 0.028"><freejoint/><geom type="sphere" size="0.03"/></body>
  </worldbody>
  <sensor>
    <plugin name="grid" plugin="mujoco.sensor.touch_grid" objtype="site" objname="pad">
      <config key="size" value="16 16"/><config key="fov" value="45 45"/><config key="nchannel" value="1"/>
    </plugin>
  </sensor>
</mujoco>
"""


def torus(n=225, far=0.03, near=0.012):
    """Returns the vertices (n², 3), metres, and the triangles (2 n², 3) of a torus."""
    turns = 2 * np.pi * np.arange(n) / n
    around, across = [turns.ravel() for turns in np.meshgrid(turns, turns, indexing="ij")]
    out = far + near * np.cos(across)
    vertices = np.stack([out * np.cos(around), out * np.sin(around), near * np.sin(across)], axis=1)
    first = np.arange(n * n)
    i, j = first // n, first % n
    right, up = (i + 1) % n * n + j, i * n + (j + 1) % n
    both = (i + 1) % n * n + (j + 1) % n
    return vertices, np.concatenate([np.stack([first, right, both], 1), np.stack([first, both, up], 1)])


def alternate(calls, rounds, repeat):
    """Returns the time of each call, microseconds: the median over rounds of its mean time. All calls run in each round."""
    times = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            start = time.thread_time()
            for _ in range(repeat):
                call()
            times[name].append(1e6 * (time.thread_time() - start) / repeat)
    return {name: statistics.median(of_call) for name, of_call in times.items()}


def contact_poses(patch, mesh, n, depth, seed):
    """Returns poses at which the patch is `depth` metres past first contact with the mesh: (n, 7), x, y, z, qw, qx, qy, qz."""
    poses = contact.draw_poses(np.asarray(mesh.bounds), n, seed)
    poses[:, 2] -= patch.press(mesh, poses, depth=depth, contacts=True)[1].travel
    return poses


class Table:
    """Table of results, which prints each added row."""

    def __init__(self):
        self.rows = []
        self.fixed = {"date": datetime.date.today().isoformat(), "machine": contact.machine()}

    def add(self, part, of_object, n_triangles, n_taxels, program, method, us, ratio=None, limit=None):
        row = {"part": part, "object": of_object, "n_triangles": n_triangles, "n_taxels": n_taxels, "program": program, "method": method}
        row |= {"us": f"{us:.2f}", "ratio": "" if ratio is None else f"{ratio:.2f}", "limit_us": "" if limit is None else f"{limit:g}"}
        self.rows.append(self.fixed | row)
        print("  ".join(f"{value!s:>12}" for value in row.values()), flush=True)

    def write(self, path):
        with path.open("w", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(self.rows)


def small_shapes():
    """Returns three shapes by name: vertices, triangles, and the time limit of one read, microseconds."""
    box, ball = trimesh.creation.box([0.04, 0.03, 0.02]), trimesh.creation.icosphere(3, 0.03)
    return {
        "box": (np.asarray(box.vertices), np.asarray(box.faces), 6.0),
        "icosphere": (np.asarray(ball.vertices), np.asarray(ball.faces), 12.0),
        "torus": (*torus(), 100.0),
    }


def curved_patch():
    """Returns a patch of 256 listed taxels on a bump; their axes are inclined by up to 23 degrees."""
    half = 0.5 * (SIDE - 1) * PITCH
    x, y = (grid.ravel() for grid in np.meshgrid(*2 * [np.linspace(-half, half, SIDE)]))
    axes = np.stack([0.3 * x / half, 0.3 * y / half, np.ones_like(x)], axis=1)
    centers = np.stack([x, y, -0.15 * (x**2 + y**2) / half], axis=1)
    return bt.Patch.from_arrays(centers, axes / np.linalg.norm(axes, axis=1, keepdims=True), stroke=STROKE, taxel_radius=RADIUS)


def reads(patch, mesh, poses):
    """Returns functions that read a patch at all poses: deflections alone, with contacts, with bt.Skin, and with bt.Skin and shear."""
    skin, here = bt.Skin([patch], [mesh]), np.array([[0.0, 0, 0, 1, 0, 0, 0]])
    out, shear = np.zeros(patch.shape), skin.shear_state(stiffness=400.0, friction=0.5)
    return {
        "one pose": lambda: [patch.press(mesh, pose, out=out) for pose in poses],
        "contacts": lambda: [patch.press(mesh, pose, contacts=True) for pose in poses],
        "Skin.read": lambda: [skin.read(here, pose[None]) for pose in poses],
        "Skin.read, shear": lambda: [skin.read(here, pose[None], shear=shear) for pose in poses],
    }


def any_layout(table, options):
    """Times 256 taxels on a flat grid and on a curved layout, one pose per call. Ratios are relative to the read without contacts and shear."""
    contact.SIDE = SIDE
    patches = {"grid": bt.Patch.grid(SIDE, SIDE, PITCH, STROKE, taxel_radius=RADIUS), "curved": curved_patch()}
    for name, (vertices, triangles, _) in small_shapes().items():
        mesh = bt.Mesh(vertices, triangles)
        for kind, patch in patches.items():
            poses = contact_poses(patch, mesh, 16, DEPTH, seed=len(triangles))
            times = alternate(reads(patch, mesh, poses), options.rounds, 4)
            for method, us in times.items():
                plain = times["Skin.read" if method.startswith("Skin") else "one pose"]
                table.add("layouts", name, len(triangles), patch.n_taxels, "bubbletouch", f"{kind}: {method}", us / 16, us / plain)


def small_patch(table, options):
    """Times 16 x 16 taxels with one pose per call and with 1,024 poses per call."""
    contact.SIDE = SIDE
    shapes = small_shapes()
    patch = bt.Patch.grid(SIDE, SIDE, PITCH, STROKE, taxel_radius=RADIUS)
    points = bt.Patch.grid(SIDE, SIDE, PITCH, STROKE, taxel_radius=contact.POINT_RADIUS)
    out, many = np.zeros((SIDE, SIDE)), np.zeros((1024, SIDE, SIDE))
    for name, (vertices, triangles, limit) in shapes.items():
        mesh = bt.Mesh(vertices, triangles)
        poses = contact_poses(patch, mesh, 16, DEPTH, seed=len(triangles))
        batch = np.tile(poses, (64, 1))
        solid = trimesh.Trimesh(vertices, triangles, process=False)
        sensor, rays = contact.TactileSensor(solid, 6), contact.Rays(solid)
        lower = poses - [0, 0, RADIUS, 0, 0, 0, 0]
        calls = {
            "one pose": lambda: [patch.press(mesh, pose, out=out) for pose in poses],
            "batch": lambda: patch.press(mesh, batch, out=many, threads=1),
            "points": lambda: [points.press(mesh, pose, out=out) for pose in lower],
            "rays": lambda: [rays.evaluate(pose) for pose in poses],
            "tactile": lambda: [sensor.evaluate(pose) for pose in poses],
        }
        times = {call: us / (1024 if call == "batch" else 16) for call, us in alternate(calls, options.rounds, 4).items()}
        of_shape = (name, len(triangles), SIDE * SIDE)
        table.add("read", *of_shape, "bubbletouch", "one pose", times["one pose"], limit=limit)
        table.add("read", *of_shape, "bubbletouch", "batch of 1,024", times["batch"], limit=0.8 * limit)
        table.add("read", *of_shape, "bubbletouch", "way of points", times["points"], times["rays"] / times["points"])
        table.add("read", *of_shape, "MuJoCo", "rays", times["rays"])
        table.add("read", *of_shape, "MuJoCo", "tactile sensor", times["tactile"])
    model = mujoco.MjModel.from_xml_string(TOUCH_GRID)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    us = alternate({"grid": lambda: mujoco.mj_sensorAcc(model, data)}, options.rounds, 200)["grid"]
    table.add("read", "sphere", 0, SIDE * SIDE, "MuJoCo", "touch_grid", us)


def packed_within(path, mesh, folder):
    """Returns the spheres of a mesh, packed within 0.25 mm and stored in a folder. An open mesh is packed as a sheet."""
    kept = folder / f"{path.stem}_0.25.npz"
    if not kept.exists():
        folder.mkdir(parents=True, exist_ok=True)
        try:
            packed = mesh.pack(0.25e-3)
        except ValueError:
            packed = mesh.pack(0.25e-3, sheet=True)
        np.savez(kept, centers=packed.centers, radii=packed.radii)
    arrays = np.load(kept)
    return bt.SphereUnion(arrays["centers"], arrays["radii"])


def large_patch(table, options):
    """Times 64 x 64 taxels on meshes, exact and packed within 0.25 mm."""
    patch = bt.Patch.grid(64, 64, PITCH, STROKE, taxel_radius=RADIUS)
    out, ratios = np.zeros((64, 64)), []
    for path in sorted(options.objects.glob("*.ply")):
        if options.names and path.stem not in options.names:
            continue
        mesh = bt.Mesh.read(path)
        packed = packed_within(path, mesh, options.packings)
        poses = contact_poses(patch, mesh, 16, 3e-3, seed=len(mesh))
        things = {"exact": mesh, f"packed within 0.25 mm: {len(packed)} spheres": packed}
        calls = {
            name: lambda thing=thing: [patch.press(thing, pose, out=out) for pose in poses] for name, thing in things.items()
        }
        times = alternate(calls, options.rounds, 4)
        exact, spheres = (us / 16 for us in times.values())
        ratios.append(exact / spheres)
        for method, us in zip(times, (exact, spheres), strict=True):
            table.add("64 x 64", path.stem, len(mesh), 4096, "bubbletouch", method, us, us / spheres)
    if ratios:
        print(f"exact / packed: median {statistics.median(ratios):.2f}, largest {max(ratios):.2f}")


def hand(table, options):
    """Times a hand with 20 patches of 64 taxels, three of them in contact, under five bodies, and MuJoCo's step of this hand."""
    for meshes, limit in ((False, 60.0), (True, 150.0)):
        model, data, skin = hands.full_hand(meshes)
        out = np.zeros(skin.n_taxels)
        name = "five bodies, " + ("meshes" if meshes else "primitives")
        state = mujoco.mj_getState
        size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION)
        before = np.zeros(size)
        state(model, data, before, mujoco.mjtState.mjSTATE_INTEGRATION)

        def step(model=model, data=data, before=before):
            mujoco.mj_setState(model, data, before, mujoco.mjtState.mjSTATE_INTEGRATION)
            mujoco.mj_step(model, data)

        calls = {"mj_step": step, "read": lambda skin=skin, data=data, out=out: skin.read(data, out=out)}
        mujoco.mj_forward(model, data)
        times = alternate(calls, options.rounds, 50)
        table.add("hand", name, "", skin.n_taxels, "bubbletouch", "Skin.read", times["read"], times["mj_step"] / times["read"], limit)
        table.add("hand", name, "", skin.n_taxels, "MuJoCo", "mj_step", times["mj_step"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--objects", type=Path, help="a folder of PLY meshes in metres, for 64 x 64 taxels")
    parser.add_argument("--names", nargs="*", help="only these meshes (names without ending); all when left out")
    parser.add_argument("--rounds", type=int, default=15, help="how often all take turns")
    parser.add_argument("--packings", type=Path, default=ROOT / "target" / "peers", help="folder that keeps packings")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "peers" / "skin_reads.csv")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)
    table = Table()
    small_patch(table, options)
    any_layout(table, options)
    hand(table, options)
    if options.objects:
        large_patch(table, options)
    table.write(options.out)


if __name__ == "__main__":
    main()
