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
from bubbletouch._arrays import Array, as_array, as_keys, as_numbers, check_frames, padded
from bubbletouch._numbers import whole
from bubbletouch.recorded import Recorded, named
from bubbletouch.recorded_files import read_recorded
from bubbletouch.study import Table

# Tables of an audit, as the core returns them.
_Tables = list[tuple[str, str, str, dict[str, Any]]]


@dataclass(frozen=True)
class Finding:
    """Finding of an audit.

    check: name of the check, such as "copies".
    subject: part of the data, such as "group"; may be empty.
    verdict: "fault", "not_checked", "note" or "passed".
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
        tables: _Tables,
        kept: tempfile.TemporaryDirectory[str] | None = None,
    ) -> None:
        self.folder = folder
        self.tables = {Path(table[0]).stem: Table(*table) for table in tables}
        rows = self.tables["findings"].columns
        self.findings = [_finding(dict(zip(rows, row, strict=True))) for row in zip(*rows.values(), strict=True)]
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


def _finding(row: Mapping[str, Any]) -> Finding:
    """Returns the finding in a row of the table of findings."""
    p_value, p_holm = (None if np.isnan(row[name]) else float(row[name]) for name in ("p_value", "p_holm"))
    interval = [float(row["value_low"]), float(row["value_high"])]
    numbers = float(row["value"]), interval, float(row["baseline"]), p_value, p_holm
    return Finding(row["check"], row["subject"], row["verdict"], *numbers, row["sentence"], row["advice"])


# A path of a file stands for the array in it.
_Given = ArrayLike | PathLike[str] | None


def audit(
    frames: ArrayLike | Sequence[ArrayLike] | Recorded | PathLike[str],
    labels: _Given = None,
    groups: _Given = None,
    *,
    sessions: _Given = None,
    times: _Given = None,
    test: Recorded | PathLike[str] | tuple[_Given, ...] | None = None,
    order: str | None = None,
    columns: str | None = None,
    grid: tuple[int, int] | None = None,
    full_scale: float | None = None,
    before_contact: tuple[int, int] | None = None,
    untouched: Sequence[int] = (),
    split: str | None = None,
    not_claimed: Sequence[str] | None = None,
    out: str | PathLike[str] | None = None,
    seed: int = 2018,
    permutations: int = 999,
) -> Audit:
    """Audits a data set; equals the command `bubbletouch audit`.

    frames: readings, shape (n, rows, columns), (n, n_frames, rows, columns) or (n, n_taxels); NaN or a masked value is a missing reading. A list contains
    touches of unequal length. A Recorded of one sensor contains labels, groups, order and full scale, too.
    A path is read as by the command, with the labels, groups, sessions, times and the test set beside the frames. Formats that the command does not read,
    such as HDF5 and LeRobot, are read by `read_recorded`. Each of the other arrays may also be the path of a file.
    labels: class of each touch, integers or texts, shape (n,), or entries 0 and 1, shape (n, classes). If None, only checks without classes are made.
    groups, sessions: group (grasp, pose, subject) and session (file, day, mounting) of each touch, shape (n,).
    times: time of each touch, shape (n,). If None, the order of the touches is their order in time.
    test: given test set, one more split: a tuple (frames, labels) or (frames, labels, groups), a Recorded, or the path of the frames. Its touches follow those
    of `frames`, so that `sessions` and `times`, if given, contain the values of both. None: a Recorded may contain `frames_test`, `labels_test` and
    `groups_test` in its keys.
    order: one letter for each axis of `frames`, as in `recorded.order`: n touches, t frames, y rows, x columns, c values of a taxel or taxels. None: "nc", "nyx"
    or "ntyx".
    columns: columns of a table that are readings, names or patterns such as "taxel_*", separated by commas. None: all columns.
    grid: rows and columns of the skin, if the axis c lists its taxels row by row.
    full_scale: reading at full scale. If None, a common largest reading of many touches counts as saturation.
    before_contact: range (start, stop) of the frames of each touch before the contact. A class that can be read from them is a fault.
    untouched: numbers of the taxels that nothing touches. A class that can be read from them is a fault.
    split: split of the claim, "group", "session", "time" or "given". If None, all splits that the data allow are tested.
    not_claimed: sources that should not name the class: "order", "session", "padding", "mean", "noise", "place", "single_taxel", "before_contact" and
    "untouched". A class that can be read from them is a fault; from other sources, a note. If None: order, session, padding, before_contact and untouched.
    out: folder of the page, tables and charts. If None, a temporary folder is used and deleted with the Audit.
    seed, permutations: seed of splits and permutations, and number of permutations of each test.

    Raises ValueError if an argument is invalid, and OSError if a file does not exist or cannot be written.
    """
    data: Any = frames
    lengths: Any = None
    counts = [whole("untouched", taxel, least=0) for taxel in untouched]
    seed, permutations = whole("seed", seed, least=0), whole("permutations", permutations, least=399, most=100_000)
    if _is_path(data) and _needs_reader(Path(data)):
        data = read_recorded(data)
    if isinstance(data, Recorded):
        recorded = _of_one_sensor("frames", data)
        labels = recorded.labels if labels is None else labels
        groups = recorded.groups if groups is None else groups
        order = order or (recorded.order if isinstance(recorded.order, str) else None)
        test = _test_of_keys(recorded) if test is None else test
        full_scale = recorded.keys.get("full_scale") if full_scale is None else full_scale
        grid = recorded.keys.get("grid") if grid is None else grid
        lengths = recorded.lengths if recorded.lengths is not None else recorded.keys.get("lengths")
        data = recorded.frames
    given = {"data": data, "labels": labels, "groups": groups, "sessions": sessions, "times": times, "lengths": lengths} | _test_set(test, order)
    kept = tempfile.TemporaryDirectory(prefix="bubbletouch-") if out is None else None
    folder = Path(kept.name) if kept is not None else Path(out or "")
    name = Path(data).stem if _is_path(data) else "arrays" if out is None else folder.name
    options = (order, columns, grid, full_scale, before_contact, counts, split, None if not_claimed is None else list(not_claimed), seed, permutations)
    found = _of_files(given, (*options, name, folder))
    return Audit(folder, found, kept)


def _of_files(given: Mapping[str, Any], options: tuple[Any, ...]) -> _Tables:
    """Audits files by their names, as the command does. Arrays are written to temporary files."""
    with tempfile.TemporaryDirectory(prefix="bubbletouch-") as folder:
        files = {key: Path(value) for key, value in given.items() if _is_path(value)}
        for key, path in files.items():
            if not path.exists():
                raise FileNotFoundError(f"{_ARGUMENTS.get(key, key)}: {path}: no such file; an array, or the path of a file")
        arrays = {key: value for key, value in given.items() if (value is not None or key == "data") and key not in files}
        # Sessions and times have values of the touches of both sets.
        shared = () if "frames_test" not in given else ("sessions", "times")
        check_frames({key.replace("data", "frames"): value for key, value in arrays.items() if key not in shared})
        for key in ("data", "frames_test"):
            if isinstance(arrays.get(key), list | tuple) or getattr(arrays.get(key), "dtype", None) == object:
                arrays[key], lengths = padded(_ARGUMENTS[key], list(arrays[key]))
                arrays |= {} if lengths is None else {key.replace("data", "lengths").replace("frames", "lengths"): lengths}
        for key, values in arrays.items():
            files[key] = Path(folder) / f"{key}.npy"
            place = _ARGUMENTS.get(key, key)
            is_key = key.removesuffix("_test") in ("labels", "groups", "sessions")
            array = as_keys(place, values) if is_key else _times(values) if key == "times" else as_numbers(place, as_array(place, values))
            np.save(files[key], array, allow_pickle=False)
        try:
            return _core.run_audit(files, *options)
        except ValueError as error:
            names = {str(files[key]): _ARGUMENTS.get(key, key) for key in arrays}
            raise named(error, names | {f"--{option}": option for option in ("order", "columns", "grid")}) from None


# Arguments whose arrays have other names in `run_audit`.
_ARGUMENTS = {"data": "frames", "frames_test": "test", "labels_test": "test, labels", "groups_test": "test, groups"}


def _times(values: Any) -> Array:
    """Returns times as numbers; dates become seconds."""
    array = as_array("times", values)
    if array.dtype.kind == "M":
        array = array.astype("datetime64[ns]").astype(np.float64) / 1e9
    return as_numbers("times", array).astype(np.float64).ravel()


def _is_path(values: Any) -> bool:
    return isinstance(values, str | PathLike)


def _needs_reader(path: Path) -> bool:
    """Returns whether `read_recorded` alone reads a file: HDF5, Zarr, Parquet and LeRobot."""
    return path.suffix.lower() in (".h5", ".hdf5", ".zarr", ".parquet") or (path / "meta" / "info.json").is_file()


def _of_one_sensor(place: str, recorded: Recorded) -> Recorded:
    if isinstance(recorded.frames, Mapping):
        raise ValueError(f"{place}: sensors {', '.join(recorded.frames)}; one sensor, because checks compare readings: Recorded.frames[NAME]")
    return recorded


def _test_of_keys(recorded: Recorded) -> tuple[Any, ...] | None:
    """Returns frames, labels and groups of the test set that the keys of a recording contain; None without such a set."""
    names = ("frames_test", "labels_test", "groups_test")
    of_test = tuple(recorded.keys.get(name) for name in names)
    return None if of_test[0] is None else of_test


def _test_set(test: Any, order: str | None) -> dict[str, Any]:
    """Returns the arrays of a given test set by the names of their keys. The axes of its frames have the order of the other frames."""
    if test is None:
        return {}
    lengths = None
    if _is_path(test):
        test = (test, None)
    if isinstance(test, Recorded):
        recorded = _of_one_sensor("test", test)
        if recorded.order is not None and recorded.order != order:
            raise ValueError(f"test: order {recorded.order!r}; {order!r}, as of the frames")
        lengths = recorded.lengths
        test = (recorded.frames, recorded.labels, recorded.groups)
    if not isinstance(test, tuple) or len(test) not in (2, 3):
        raise ValueError("test: not a test set; (frames, labels), (frames, labels, groups), a Recorded of one sensor, or a path")
    return dict(zip(("frames_test", "labels_test", "groups_test"), test, strict=False)) | {"lengths_test": lengths}
