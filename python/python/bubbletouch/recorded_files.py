"""Reader of recorded touches: Zarr, HDF5, Parquet, CSV, NumPy archives and LeRobot folders."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from bubbletouch._array_files import Source, files_of, matched, open_file
from bubbletouch._arrays import Array, as_keys, as_numbers
from bubbletouch._lerobot_reader import of_lerobot
from bubbletouch._touch_sets import Part, by_touch, joined
from bubbletouch.recorded import Recorded

__all__ = ["read_recorded"]


def read_recorded(
    path: str | PathLike[str],
    frames: str | Sequence[str] | Mapping[str, str | Sequence[str]] | None = None,
    *,
    labels: str | ArrayLike | None = None,
    groups: str | ArrayLike | None = None,
    touches: str | None = None,
    order: str | Mapping[str, str] | None = None,
) -> Recorded:
    """Reads recorded touches from files.

    path: a Zarr folder, an HDF5, Parquet, CSV or NumPy file (.zarr, .h5, .hdf5, .parquet, .csv, .tsv, .npz, .npy), or a folder of such files; or a LeRobot
    folder (v2 or v3). The first line of a CSV file has the names of its columns; without names, all columns are readings. In a pattern such as
    "grasps/{label}/*.npy", `*` stands for any text, and the texts in the places of {label} and {group} are the label and the group of the file.
    frames: name of the array, column or feature with the readings; a dict of names reads several sensors. A list of columns of a Parquet or CSV file,
    or a pattern such as "taxel_*", reads one taxel per column. Default: `frames`; in a LeRobot folder the only feature with `tactile` or `touch` in its name.
    labels: name of the array or column with the class of each touch, or an array of the classes. Default: `labels` if it exists; in a LeRobot folder, the task.
    groups: name of the array or column with the group of each touch, or an array of the groups. Default: `groups` if it exists; in a folder of files, the name of the file.
    touches: name of the array or column with the number of the touch of each row, or with the row at which each touch ends. The rows of a touch are its
    frames. Default: each row is a touch; in a
    LeRobot folder, each episode. "index" makes each row of a LeRobot folder a touch; its group is then the episode.
    order: letters of the axes of the returned frames, as in `recorded.order`, or a dict by sensor. Default: the order of a study without `order`; "n t c" or "n t y x" if rows are
    joined to touches.

    A name with `*` (HDF5 and Zarr) matches one array per touch, whose first axis is time: "data/*/obs/tactile". Labels and groups with `*` have one
    value for each touch; "data/*@label" reads an attribute. In "{label}/*/tactile", the name of a group of arrays is the label. In a folder of files without `*`, each file is a touch if `labels` is an attribute
    ("@label") or a scalar, or if `touches` is "file".

    Touches with unequal numbers of frames are padded with NaN, and `lengths` contains their numbers. `run` then needs the key `resampled_frames`.

    Raises ValueError, with the file and the name, if an array does not exist or does not fit the others; ImportError if the package of the format
    is not installed; OSError if a file does not exist.
    """
    place = Path(path)
    given = {"labels": labels, "groups": groups}
    labels, groups = (value if value is None or isinstance(value, str) else None for value in given.values())
    found = _read(place, frames, (labels, groups, touches), order)
    for name, value in given.items():
        if value is not None and not isinstance(value, str):
            setattr(found, name, as_keys(name, value, len(found)))
    return found


def _read(
    place: Path,
    frames: str | Sequence[str] | Mapping[str, str | Sequence[str]] | None,
    names: tuple[str | None, str | None, str | None],
    order: str | Mapping[str, str] | None,
) -> Recorded:
    if (place / "meta" / "info.json").is_file():
        return of_lerobot(place, frames, (*names, order))
    wanted = frames if isinstance(frames, Mapping) else {"": frames or "frames"}
    files = files_of(place)
    sources = [open_file(file) for file in files]
    try:
        parts = [_with_marks(_part(source, wanted, names, len(files) > 1), str(place)) for source in sources]
    finally:
        for source in sources:
            source.close()
    return joined([str(file) for file in files], parts, (isinstance(frames, Mapping), order))


def _with_marks(part: Part, pattern: str) -> Part:
    """Returns the touches of a file with the label and the group that its path contains in the places of `{label}` and `{group}` in a pattern."""
    marks = matched(pattern, part.place) or {}
    n = len(next(iter(part.sensors.values())))
    labels, groups = (np.repeat(marks[name], n) if name in marks else own for name, own in (("label", part.labels), ("group", part.groups)))
    return replace(part, labels=labels, groups=groups)


def _part(
    source: Source, wanted: Mapping[str, str | Sequence[str]], names: tuple[str | None, ...], is_one_of_several: bool
) -> Part:
    if source.attributes is not None:
        # In HDF5 and Zarr files, a path from the root may begin with a slash.
        wanted = {name: columns.removeprefix("/") if isinstance(columns, str) else columns for name, columns in wanted.items()}
        names = tuple(name if name is None else name.removeprefix("/") for name in names)
    labels, groups, touches = names
    is_each = any(set("*{") & set(pattern) for pattern in wanted.values() if isinstance(pattern, str)) and not source.place.lower().endswith((".parquet", ".csv", ".tsv"))
    if is_each:
        return _of_matches(source, wanted, (labels, groups))
    sensors: dict[str, list[Array] | Array] = {name: _readings(source, columns) for name, columns in wanted.items()}
    label = labels or ("labels" if "labels" in source.names else None)
    group = groups or ("groups" if "groups" in source.names else None)
    is_scalar = label is not None and ("@" in label or (label in source.names and source.array(label).size == 1))
    if touches == "file" or (is_one_of_several and touches is None and is_scalar):
        value = None if label is None else as_keys(f"{source.place}, `{label}`", [source.value(label)])
        own = None if group is None else as_keys(f"{source.place}, `{group}`", [source.value(group)])
        return Part({name: [np.asarray(frames)] for name, frames in sensors.items()}, value, own, source.place)
    n = len(next(iter(sensors.values())))
    for name, frames in sensors.items():
        if len(frames) != n:
            raise ValueError(f"{source.place}, `{wanted[name]}`: {len(frames)} rows; {n}, as the other sensors have")

    def of_rows(key: str | None) -> Array | None:
        return None if key is None else as_keys(f"{source.place}, `{key}`", source.array(key), n if touches is None else None)

    numbers = of_rows(touches)
    if numbers is None:
        return Part(sensors, of_rows(label), of_rows(group), source.place)
    return by_touch(source.place, sensors, (numbers, of_rows(label), of_rows(group)), (label, group))


def _readings(source: Source, columns: str | Sequence[str]) -> Array:
    """Returns the readings of an array, or of several columns with one taxel each."""
    if isinstance(columns, str) and "*" not in columns:
        return as_numbers(f"{source.place}, array `{columns}`", np.atleast_1d(source.array(columns)))
    names = source.matches(columns) if isinstance(columns, str) else list(columns)
    return np.stack([as_numbers(f"{source.place}, column `{name}`", source.array(name)) for name in names], axis=1)


def _of_matches(source: Source, wanted: Mapping[str, str | Sequence[str]], keys: tuple[str | None, str | None]) -> Part:
    """Returns the touches of a file with one array for each touch."""
    sensors: dict[str, list[Array] | Array] = {}
    paths: list[str] = []
    marks: list[dict[str, str]] = []
    for name, pattern in wanted.items():
        if not isinstance(pattern, str) or not set("*{") & set(pattern):
            raise ValueError(f"{source.place}: `{pattern}`; a name with *, as the other sensors have")
        found = source.matches(pattern)
        marks = marks or [matched(pattern, path) or {} for path in found]
        if paths and len(found) != len(paths):
            raise ValueError(f"{source.place}, `{pattern}`: {len(found)} touches; {len(paths)}, as the other sensors have")
        paths = paths or [_stars(pattern, path) for path in found]
        sensors[name] = [as_numbers(f"{source.place}, array `{path}`", source.array(path)) for path in found]

    def values(pattern: str | None, mark: str) -> Array | None:
        if pattern is None:
            return np.array([own[mark] for own in marks]) if mark in marks[0] else None
        if "*" not in pattern:
            return as_keys(f"{source.place}, `{pattern}`", source.array(pattern), len(paths))
        each = [source.value(_filled(pattern, path)) for path in paths]
        return as_keys(f"{source.place}, `{pattern}`", each, len(paths))

    return Part(sensors, values(keys[0], "label"), values(keys[1], "group"), source.place)


def _stars(pattern: str, path: str) -> str:
    """Returns the parts of a path at the places of the parts with `*` or `{` in a pattern, separated by slashes."""
    pairs = zip(pattern.split("/"), path.split("/"), strict=True)
    return "/".join(own for part, own in pairs if set("*{") & set(part))


def _filled(pattern: str, stars: str) -> str:
    """Returns a pattern whose parts with `*` are replaced by the given parts."""
    parts: Iterator[str] = iter(stars.split("/"))
    path, at, key = pattern.partition("@")
    return "/".join(next(parts, part) if "*" in part else part for part in path.split("/")) + at + key
