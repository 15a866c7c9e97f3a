"""Tests of numeric arguments: an error message contains the name, the given value and the allowed values."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest

ALLOWED = "zero or a positive whole number below 2⁶⁴"


def grid() -> bt.Patch:
    return bt.Patch.grid(4, 4, 2e-3, 5e-3)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda number: bt.Chain([], grid(), skin_seed=number), "skin_seed"),
        (lambda number: bt.Chain([], grid())(np.zeros((1, 4, 4)), seed=number), "seed"),
        (lambda number: bt.Chain([], grid())(np.zeros((1, 4, 4)), first=number), "first"),
        (lambda number: bt.Chain([], grid()).read_touch(np.zeros((1, 4, 4)), seed=number), "seed"),
        (lambda number: bt.Chain([], grid()).read_touch(np.zeros((1, 4, 4)), n_before=number), "n_before"),
        (lambda number: bt.Projection("gaussian", (4, 4), 8, seed=number), "seed"),
    ],
)
def test_whole_numbers_are_refused_by_name(call: Callable[[Any], Any], name: str) -> None:
    for number in (-1, 2**64):
        with pytest.raises(ValueError, match=f"{name}: {number}; {ALLOWED}"):
            call(number)
    with pytest.raises(TypeError, match="float"):
        call(1.5)


def test_axes_of_few_digits_are_normalised_and_others_are_refused() -> None:
    axes = [[0.5774, 0.5774, 0.5774], [0, 0, 0.991]]
    patch = bt.Patch.from_arrays(np.zeros((2, 3)), axes, stroke=1e-3, taxel_radius=1e-3)
    np.testing.assert_allclose(np.linalg.norm(patch.axes, axis=1), 1, atol=1e-15)
    with pytest.raises(ValueError, match="layout, taxel 2: axis .* of length 1.02; a vector of length one, within 1 %"):
        bt.Patch.from_arrays(np.zeros((2, 3)), [[0, 0, 1], [0, 0, 1.02]], stroke=1e-3, taxel_radius=1e-3)


def test_what_is_not_read_of_a_robots_file_is_a_warning(tmp_path: Path) -> None:
    urdf = "<robot name='r'><link name='base'/><sensor name='s'><parent link='base'/><tactile/></sensor></robot>"
    (tmp_path / "r.urdf").write_text(urdf, encoding="utf-8")
    scene = tmp_path / "s.toml"
    scene.write_text(
        'title = "A robot"\nrobots = [{ name = "robot", urdf = "r.urdf" }]\n'
        'patches = [{ name = "pad", robot = "robot", layout = { grid = { nx = 2, ny = 2, pitch_mm = 4.0 } }, stroke_mm = 5.0 }]\n',
        encoding="utf-8",
    )
    with pytest.warns(UserWarning, match="robots.robot: .*tactile sensor `s` on link `base` is not read"):
        bt.simulate(scene)
