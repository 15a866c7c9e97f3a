"""Tests that a million calls do not increase the memory, in a separate process without other tests."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest

STATUS = Path("/proc/self/statm")
# Maximum increase of the memory, bytes. A leak of more than 4 bytes per call exceeds the limit.
MOST_BYTES = 4_000_000


def resident_bytes() -> int:
    """Returns the resident memory of this process, bytes."""
    return int(STATUS.read_text().split()[1]) * 4096


def growth(call: Callable[[], object], n: int) -> int:
    """Returns the increase of the resident memory over n calls, after n / 10 calls as a warm-up, bytes."""
    for _ in range(n // 10):
        call()
    before = resident_bytes()
    for _ in range(n):
        call()
    return resident_bytes() - before


@pytest.mark.skipif(not STATUS.exists(), reason="this system does not tell how much memory is used")
def test_a_million_calls_leak_nothing() -> None:
    done = subprocess.run([sys.executable, __file__], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def main() -> None:
    patch, ball = bt.Patch.grid(8, 8, 2e-3, 5e-3), bt.SphereUnion([[0, 0, 0]], 0.02)
    pose, out = np.array([0, 0, 0.03, 1, 0, 0, 0]), np.zeros((8, 8))
    many = np.tile(pose, (8, 1))
    chain = bt.Chain([bt.Step.noise(0.1)], patch)
    wrong = np.zeros(6)

    def refused() -> None:
        with pytest.raises(ValueError):
            patch.press(ball, wrong)

    assert growth(lambda: patch.press(ball, pose, depth=1e-3, out=out), 1_000_000) < MOST_BYTES
    assert growth(lambda: patch.press(ball, pose, depth=1e-3), 300_000) < MOST_BYTES
    assert growth(lambda: patch.press(ball, pose, contacts=True, jacobian=True), 50_000) < MOST_BYTES
    assert growth(lambda: patch.press(ball, many, depth=1e-3), 50_000) < MOST_BYTES
    assert growth(lambda: bt.Patch.grid(8, 8, 2e-3, 5e-3).centers, 50_000) < MOST_BYTES
    assert growth(lambda: chain(out), 50_000) < MOST_BYTES
    assert growth(refused, 50_000) < MOST_BYTES


if __name__ == "__main__":
    main()
