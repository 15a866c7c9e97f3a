"""Shared fixtures: objects, a patch, and the bubbletouch command for comparisons."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest

Command = Callable[..., str]


def refused(said: str, call: Callable[[], object], error: type[Exception] = ValueError) -> None:
    """Checks that a call raises an error whose text matches `said`."""
    with pytest.raises(error, match=said):
        call()


@pytest.fixture(scope="session")
def mug() -> bt.SphereUnion:
    return bt.Catalogue.builtin().object("mug").pack(0.5e-3)


@pytest.fixture(scope="session")
def patch() -> bt.Patch:
    return bt.Patch.grid(32, 48, 2e-3, 5e-3)


@pytest.fixture(scope="session")
def box() -> bt.Mesh:
    """Returns a box of 40 × 30 × 20 mm whose lowest face is at z = 0."""
    corners = np.array([[x, y, z] for x in (-20, 20) for y in (-15, 15) for z in (0, 20)]) * 1e-3
    faces = [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]  # fmt: skip
    return bt.Mesh(corners, faces)


@pytest.fixture(scope="session")
def command() -> Command:
    """Returns a function that runs the bubbletouch command of the same build. If the command is not built, the test is skipped with a message."""
    built = Path(__file__).resolve().parents[2] / "target" / "release" / "bubbletouch"
    named = os.environ.get("BUBBLETOUCH_COMMAND")
    path = named or (str(built) if built.exists() else shutil.which("bubbletouch"))
    if path is None:
        pytest.skip("no bubbletouch command to compare with: cargo build --release")

    def run(*arguments: object) -> str:
        """Returns what the command prints to standard output."""
        return subprocess.run([path, *map(str, arguments)], check=True, capture_output=True, text=True).stdout

    return run
