"""Measures presses into NumPy arrays: one thread, all threads, and one pose, beside the kernel alone.

The kernel is timed by the program bubbletouch-reference (cargo build --release -p bubbletouch-python --bin bubbletouch-reference). The kernel does not write its
results into an array.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import bubbletouch as bt
import numpy as np

ROUNDS = 5
REFERENCE = Path(__file__).resolve().parents[2] / "target" / "release" / "bubbletouch-reference"


def best(call: Callable[[], object], repeat: int = 1) -> float:
    """Returns the shortest time of a call, seconds: the minimum over ROUNDS rounds of the mean over `repeat` calls."""
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for _ in range(repeat):
            call()
        times.append((time.perf_counter() - start) / repeat)
    return min(times)


def batches(name: str, patch: bt.Patch, thing: bt.SphereUnion | bt.Mesh) -> None:
    """Prints the speeds of a batch of 2,048 poses, in taxel readings per second."""
    random = np.random.default_rng(0)
    n = 2048
    offset, yaw = random.uniform(-0.01, 0.01, (n, 2)), random.uniform(0, 6.28, n)
    poses = bt.touch_poses(thing, offset=offset, yaw=yaw)
    out = np.zeros((n, *patch.shape))
    paces = {}
    for threads in (1, None):
        call = lambda: patch.press(thing, poses, depth=3e-3, out=out, threads=threads)  # noqa: B023, E731
        paces[threads] = out.size / best(call)
    new = out.size / best(lambda: patch.press(thing, poses, depth=3e-3, threads=1))
    one, many = paces[1], paces[None]
    print(
        f"{name:24} {len(thing):6} parts  one thread {one:.2e}/s  all {many:.2e}/s ({many / one:.2f} x)  new array {new:.2e}/s ({new / one:4.0%})"
    )


def one_pose(side: int) -> None:
    """Prints the times of a call with one pose on side × side taxels, microseconds."""
    patch, ball = bt.Patch.grid(side, side, 2e-3, 5e-3), bt.SphereUnion([[0, 0, 0]], 0.02)
    pose, out = np.array([0, 0, 0.03, 1, 0, 0, 0]), np.zeros((side, side))
    n = 20_000
    kernel = float(subprocess.run([REFERENCE, "pace", str(side)], check=True, capture_output=True, text=True).stdout)
    kept = best(lambda: patch.press(ball, pose, depth=1e-3, out=out), n)
    new = best(lambda: patch.press(ball, pose, depth=1e-3), n)
    print(
        f"one pose, {side:2} x {side:2}: kernel {1e6 * kernel:.2f} us, call {1e6 * kept:.2f} us with out,"
        f" {1e6 * new:.2f} us without: overhead {1e6 * (kept - kernel):.2f} and {1e6 * (new - kernel):.2f} us"
    )


def main() -> None:
    patch = bt.Patch.grid(64, 64, 2e-3, 5e-3)
    things: dict[str, bt.SphereUnion | bt.Mesh] = {
        name: bt.Catalogue.builtin().object(name).pack(0.5e-3) for name in ("mug", "banana")
    }
    for path in map(Path, sys.argv[1:]):
        things[path.stem] = bt.Mesh.read(path).pack(0.2e-3)
    for name, thing in things.items():
        batches(name, patch, thing)
    for side in (8, 64):
        one_pose(side)


if __name__ == "__main__":
    main()
