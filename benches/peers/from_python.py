#!/usr/bin/env python3
"""Times MuJoCo's tactile sensor and bubbletouch's Python package alternately on equal presses, in one process with one thread.

The sensor, the poses and the errors are those of contact.py. bubbletouch is called in two ways: with one pose per call into an existing array, as
MuJoCo is called, and with all poses in one call. Needs mujoco, trimesh, numpy and bubbletouch (pip install ./python).
"""

import argparse
import statistics
import time
from pathlib import Path

import bubbletouch as bt
import numpy as np
import trimesh
from contact import DEPTH, PITCH, RADIUS, SIDE, STIFFNESS, STROKE, TactileSensor, draw_poses, error_of, timed

TOLERANCES_MM = [1.0, 0.5, 0.4, 0.3, 0.2, 0.1]
# Number of repetitions of the poses in a batch.
REPEAT = 50


def ours(path):
    """Returns the mesh, and pairs of a setting's name and an object: the mesh packed within each tolerance, and the exact mesh."""
    mesh = bt.Mesh.read(path)
    packed = [(f"packed within {tolerance:g} mm", mesh.pack(1e-3 * tolerance)) for tolerance in TOLERANCES_MM]
    return mesh, [*packed, ("exact mesh", mesh)]


def on_mesh(path, n_touches, rounds, octree_depth):
    mesh = trimesh.load(path, process=False)
    exact, things = ours(path)
    patch = bt.Patch.grid(SIDE, SIDE, PITCH, STROKE, taxel_radius=RADIUS, stiffness=STIFFNESS)
    poses = draw_poses(mesh.bounds, n_touches, seed=len(mesh.faces))
    poses[:, 2] -= patch.press(exact, poses, depth=DEPTH, contacts=True)[1].travel
    truth = patch.press(exact, poses)
    truth = truth.reshape(n_touches, -1)
    sensor = TactileSensor(mesh, octree_depth)
    sensor.tune(poses, truth)
    error = error_of(np.array([sensor.read(pose) for pose in poses]), truth)[0]
    one, many = np.zeros((SIDE, SIDE)), np.full((REPEAT * n_touches, SIDE, SIDE), 1.0)
    repeated = np.tile(poses, (REPEAT, 1))
    times = {name: ([], []) for name, _ in things}
    peer = []
    for _ in range(rounds):
        peer += timed(sensor.evaluate, poses)
        for name, thing in things:
            alone, batch = times[name]
            alone += timed(lambda pose, thing=thing: patch.press(thing, pose, out=one), np.tile(poses, (5, 1)))
            # Processor time of the thread, because a busy machine may interrupt a batch.
            start = time.thread_time()
            patch.press(thing, repeated, out=many, threads=1)
            batch.append(1e6 * (time.thread_time() - start) / len(repeated))
    peer_us = statistics.median(peer)
    print(f"{path.stem:24} MuJoCo {sensor.setting}: {peer_us:8.1f} us, {error:.4f} mm")
    best = None
    for name, thing in things:
        own = error_of(patch.press(thing, poses).reshape(n_touches, -1), truth)[0]
        alone, batch = (statistics.median(of_kind) for of_kind in times[name])
        ratios = peer_us / alone, peer_us / batch
        print(f"    {name:22} {alone:8.2f} us a call, {batch:8.2f} us in a batch, {own:.4f} mm: {ratios[0]:.1f} x, {ratios[1]:.1f} x")
        if own <= error and (best is None or ratios[0] > best[0]):
            best = ratios
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--objects", type=Path, required=True, help="a folder of closed PLY meshes in metres")
    parser.add_argument("--names", nargs="*", help="only these meshes (names without ending); all when left out")
    parser.add_argument("--touches", type=int, default=10, help="touches an object")
    parser.add_argument("--rounds", type=int, default=5, help="how often all take turns")
    parser.add_argument("--octree-depth", type=int, default=6)
    options = parser.parse_args()
    paths = sorted(path for path in options.objects.glob("*.ply") if not options.names or path.stem in options.names)
    if not paths:
        parser.error(f"no PLY meshes of these names in {options.objects}")
    best = [on_mesh(path, options.touches, options.rounds, options.octree_depth) for path in paths]
    alone, batch = zip(*best, strict=True)
    print(
        f"at an equal or smaller error, {len(best)} objects: {statistics.median(alone):.1f} x a call (least {min(alone):.1f}),"
        f" {statistics.median(batch):.1f} x in a batch (least {min(batch):.1f})"
    )


if __name__ == "__main__":
    main()
