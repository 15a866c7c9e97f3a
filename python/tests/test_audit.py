"""Tests of audits of arrays: findings as objects, tables, and messages."""

from __future__ import annotations

from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest
from numpy.typing import NDArray


def data(n: int = 120) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
    """Returns frames of a disc of one of three sizes at random places with noise, and the names of the classes."""
    random = np.random.default_rng(4)
    classes = random.integers(0, 3, n)
    y, x = np.mgrid[:12, :12]
    centres = random.uniform(4, 7, (n, 2, 1, 1))
    away = np.hypot(y - centres[:, 0], x - centres[:, 1])
    frames = np.clip((1.5 + classes)[:, None, None] - away, 0, 1) + 0.02 * random.standard_normal((n, 12, 12))
    return frames, np.array(["small", "middle", "large"])[classes]


def test_faults_are_objects_with_numbers(tmp_path: Path) -> None:
    frames, labels = data()
    frames[3, 5, 5] = np.nan
    frames[:, 6, 6] = 0.5
    found = bt.audit(frames, labels, out=tmp_path / "audit", permutations=399)
    assert {fault.check for fault in found.faults} >= {"missing_readings", "dead_taxels"}
    missing = next(finding for finding in found.findings if finding.check == "missing_readings")
    assert missing.verdict == "fault" and missing.value == 1 / frames.size and missing.advice
    assert "missing_readings" in found.tables["findings"]["check"]
    assert found.page.read_text(encoding="utf-8").count("<article") == len(found.findings)


def test_axes_are_ordered_and_a_temporary_folder_is_kept() -> None:
    frames, labels = data()
    touches = np.repeat(frames[:, None], 2, axis=1)
    whole = bt.audit(touches, labels, permutations=399)
    moved = bt.audit(np.moveaxis(touches, 1, -1), labels, order="n y x t", permutations=399)
    assert repr(whole.findings) == repr(moved.findings)
    assert whole.page.exists()


def test_wrong_arguments_are_named() -> None:
    frames, labels = data()
    with pytest.raises(ValueError, match="^labels: 119 numbers; 120, one for each touch$"):
        bt.audit(frames, labels[1:])
    with pytest.raises(ValueError, match="^frames: shape"):
        bt.audit(frames, labels, order="n t y")
    with pytest.raises(ValueError, match="^before_contact: 0..2; "):
        bt.audit(frames, labels, before_contact=(0, 2))
