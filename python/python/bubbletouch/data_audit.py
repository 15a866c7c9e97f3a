"""Audit of a data set: whether recorded frames with labels can carry a claim about recognition."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bubbletouch import _core
from bubbletouch.recorded import Recorded
from bubbletouch.study import Table


@dataclass(frozen=True)
class Finding:
    """Finding of an audit.

    check: name of the check, such as "near_duplicates".
    subject: part of the data, such as "group split"; may be empty.
    verdict: "fault", "note", "passed" or "not_checked".
    value: measured number; NaN if there is none. Its meaning is in the sentence.
    interval: list of the lower and upper end of the 95 % interval of the value; NaN if there is none.
    baseline: value without the fault, such as the accuracy by chance; NaN if there is none.
    p_value, p_holm: p-value of the test, and the p-value after Holm's correction over all tests; None for counts.
    sentence: description of the result.
    advice: recommended action; empty if no action is needed.
    """

    check: str
    subject: str
    verdict: str
    value: float
    interval: list[float]
    baseline: float
    p_value: float | None
    p_holm: float | None
    sentence: str
    advice: str


class Audit:
    """Findings of an audit, the tables behind them, and the folder with report.html, charts and pictures."""

    def __init__(
        self,
        folder: Path,
        findings: list[tuple[Any, ...]],
        tables: list[tuple[str, str, str, dict[str, Any]]],
        kept: tempfile.TemporaryDirectory[str] | None = None,
    ) -> None:
        self.folder = folder
        names = Finding.__dataclass_fields__
        self.findings = [Finding(**dict(zip(names, said, strict=True))) for said in findings]
        self.tables = {Path(table[0]).stem: Table(*table) for table in tables}
        self._kept = kept

    @property
    def faults(self) -> list[Finding]:
        """Findings that are faults of the data."""
        return [finding for finding in self.findings if finding.verdict == "fault"]

    @property
    def page(self) -> Path:
        """Path of the page with all findings, charts and tables."""
        return self.folder / "report.html"

    def __repr__(self) -> str:
        names = ", ".join(sorted({finding.check for finding in self.faults}))
        return f"<bubbletouch.Audit in {self.folder}: {names or 'no faults'}>"


def audit(
    frames: ArrayLike | Recorded,
    labels: ArrayLike | None = None,
    groups: ArrayLike | None = None,
    *,
    sessions: ArrayLike | None = None,
    times: ArrayLike | None = None,
    test: Recorded | ArrayLike | tuple[ArrayLike, ...] | None = None,
    order: str | None = None,
    full_scale: float | None = None,
    before_contact: tuple[int, int] | None = None,
    out: str | PathLike[str] | None = None,
    seed: int = 2018,
    permutations: int = 999,
) -> Audit:
    """Audits a data set; equals the command `bubbletouch audit`.

    frames: readings, shape (n, rows, columns), (n, n_frames, rows, columns) or (n, n_taxels); NaN for a missing reading. A Recorded of one sensor
    contains labels, groups, order and full scale, too.
    labels: class of each touch, numbers or texts, shape (n,). If None, only checks without classes are made.
    groups, sessions: group (grasp, pose, subject) and session (file, day, mounting) of each touch, shape (n,).
    times: time of each touch, shape (n,). If None, the order of the touches is their order in time.
    test: given test set, one more split: a tuple (frames, labels) or (frames, labels, groups), or a Recorded. Its touches follow those of `frames`, so
    that `sessions` and `times`, if given, contain the values of both. None: a Recorded may contain `frames_test`, `labels_test` and `groups_test` in its keys.
    order: one letter for each axis of `frames`: n touches, t frames, y rows, x columns, c taxels. None: "nc", "nyx" or "ntyx".
    full_scale: reading at full scale. If None, a plateau of the largest readings counts as saturation.
    before_contact: range (start, stop) of the frames of each touch before the contact. If None, the audit detects the frames without contact.
    out: folder of the page, tables and charts. If None, a temporary folder is used and deleted with the Audit.
    seed, permutations: seed of splits and permutations, and number of permutations of each test.

    Raises ValueError if an argument is invalid, and OSError if a file cannot be written.
    """
    if isinstance(frames, Recorded):
        recorded = frames
        if isinstance(recorded.frames, Mapping):
            raise ValueError(f"frames: sensors {', '.join(recorded.frames)}; one sensor, because checks compare readings: Recorded.frames[NAME]")
        labels = recorded.labels if labels is None else labels
        groups = recorded.groups if groups is None else groups
        order = order or (recorded.order if isinstance(recorded.order, str) else None)
        test = _test_of_keys(recorded) if test is None else test
        full_scale = recorded.keys.get("full_scale") if full_scale is None else full_scale
        frames = recorded.frames
    array, n_frames, grid = _arranged(np.asarray(frames), order)
    if not 399 <= permutations <= 100_000:
        raise ValueError(f"permutations: {permutations}; 399 to 100000")
    n_training = len(array)
    if test is not None:
        tested, *of_test = _test_set(test, order)
        if tested.shape[1:] != array.shape[1:]:
            raise ValueError(f"test: frames of shape {tested.shape[1:]} a touch; {array.shape[1:]}, as the other frames")
        array = np.concatenate([array, tested])
        labels, groups = (
            _joined(name, (first, n_training), (second, len(tested)))
            for name, first, second in zip(("labels", "groups"), (labels, groups), of_test, strict=True)
        )
    classes, numbers = _numbered("labels", labels)
    kept = tempfile.TemporaryDirectory(prefix="bubbletouch-") if out is None else None
    folder = Path(kept.name) if kept is not None else Path(out or "")
    findings, tables = _core.run_audit(
        array.reshape(len(array), n_frames, -1),
        grid,
        numbers,
        classes,
        _numbered("groups", groups)[1],
        _numbered("sessions", sessions)[1],
        None if times is None else np.asarray(times, dtype=np.float64).ravel().tolist(),
        None if test is None else n_training,
        full_scale,
        before_contact,
        seed,
        permutations,
        "arrays" if out is None else folder.name,
        folder,
    )
    return Audit(folder, findings, tables, kept)


def _test_of_keys(recorded: Recorded) -> tuple[Any, ...] | None:
    """Returns frames, labels and groups of the test set that the keys of a recording contain; None without such a set."""
    names = ("frames_test", "labels_test", "groups_test")
    of_test = tuple(recorded.keys.get(name) for name in names)
    return None if of_test[0] is None else of_test


def _test_set(test: Any, order: str | None) -> tuple[np.ndarray[Any, Any], Any, Any]:
    """Returns the frames of a given test set with the axes of `_arranged`, its labels and its groups."""
    if isinstance(test, Recorded):
        order = test.order if isinstance(test.order, str) else order
        test = (test.frames, test.labels, test.groups)
    if not isinstance(test, tuple) or len(test) not in (2, 3) or isinstance(test[0], Mapping):
        raise ValueError("test: not a test set; (frames, labels), (frames, labels, groups), or a Recorded of one sensor")
    frames, labels, groups = test if len(test) == 3 else (*test, None)
    return _arranged(np.asarray(frames), order)[0], labels, groups


def _joined(name: str, *parts: tuple[ArrayLike | None, int]) -> ArrayLike | None:
    """Returns the values of the training touches, followed by those of the test set; each part has its values and its number of touches."""
    arrays = [np.asarray(values) for values, _ in parts if values is not None]
    if not arrays:
        return None
    if len(arrays) < len(parts):
        raise ValueError(f"test: {name} of one part alone; {name} of the touches and of the test set, or of neither")
    for values, (_, n) in zip(arrays, parts, strict=True):
        if values.shape != (n,):
            raise ValueError(f"{name}: shape {values.shape}; ({n},), one for each touch")
    if len({values.dtype.kind in "US" for values in arrays}) > 1:
        raise ValueError(f"test: {name} are numbers and texts; one of both")
    return np.concatenate(arrays)


def _arranged(frames: np.ndarray[Any, Any], order: str | None) -> tuple[np.ndarray[Any, Any], int, tuple[int, int] | None]:
    """Returns the frames with the axes touch, frame, taxel or row and column; the number of frames; and the grid."""
    usual = {2: "nc", 3: "nyx", 4: "ntyx"}.get(frames.ndim)
    letters = "".join((order or usual or "").split())
    is_grid = "y" in letters
    allowed = {"n", "t", "y", "x"} if is_grid else {"n", "t", "c"}
    is_order = len(letters) == frames.ndim and set(letters) <= allowed and letters.count("n") == 1
    if not is_order or (is_grid and letters.count("x") != 1) or (not is_grid and "c" not in letters):
        given = f"shape {frames.shape} in the order {order or usual!r}"
        raise ValueError(f"frames: {given}; a letter for each axis: n touches, t frames, y rows and x columns, or c taxels")
    axes = [place for letter in "ntcyx" for place, own in enumerate(letters) if own == letter]
    lengths = dict(zip(letters, frames.shape, strict=True))
    grid = (lengths["y"], lengths["x"]) if is_grid else None
    return np.ascontiguousarray(frames.transpose(axes)), lengths.get("t", 1), grid


def _numbered(name: str, values: ArrayLike | None) -> tuple[list[str], list[int] | None]:
    """Returns the distinct values as texts and the number of each value."""
    if values is None:
        return [], None
    array = np.asarray(values)
    if array.ndim != 1:
        raise ValueError(f"{name}: shape {array.shape}; one dimension, a value for each touch")
    if array.dtype.kind == "f" and np.isnan(array).any():
        raise ValueError(f"{name}: NaN; a value for each touch")
    distinct, numbers = np.unique(array, return_inverse=True)
    names: Sequence[Any] = distinct.tolist()
    return [str(name) for name in names], numbers.tolist()
