"""Reader of recorded touches: Zarr, HDF5, Parquet, CSV, NumPy archives and LeRobot folders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bubbletouch import _core
from bubbletouch._array_files import WILD, Source, files_of, matched, note_counts, open_file
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
    folder (v2 or v3). Hidden files of a folder are not read. The first line of a CSV file has the names of its columns, also the numbers of columns that
    pandas writes; without names, all columns are readings. In a pattern such as
    "grasps/{label}/*.npy", `*` stands for any text, and the texts in the places of {label} and {group} are the label and the group of the file.
    frames: name of the array, column or feature with the readings; a dict of names reads several sensors. A list of columns of a Parquet or CSV file,
    or a pattern such as "taxel_*", reads one taxel per column, in the order of the columns in the file. Default: `frames`, or all columns of a CSV file
    but labels, groups and touches, if their names differ in numbers alone; in a LeRobot folder the only feature with `tactile` or `touch` in its name.
    labels: name of the array or column with the class of each touch, or an array of the classes. Default: `labels` if it exists; in a LeRobot folder, the task.
    groups: name of the array or column with the group of each touch, or an array of the groups. Default: `groups` if it exists; in a folder of files, the path
    of the file.
    touches: name of the array or column with the number of the touch of each row, or with the row at which each touch ends. The rows of a touch are its
    frames; they are adjacent. A number may occur again, such as in each session, if the labels or groups of its touches differ. Default: each row is a touch; in a
    LeRobot folder, each episode. "index" makes each row of a LeRobot folder a touch; its group is then the episode.
    order: letters of the axes of the returned frames, as in `recorded.order`, or a dict by sensor. Default: the order of a study without `order`; "n t c" or "n t y x" if rows are
    joined to touches.

    A name with `*` (HDF5 and Zarr) matches one array per touch, whose first axis is time: "data/*/obs/tactile". Labels and groups with `*` have one
    value for each touch; "data/*@label" reads an attribute. In "{label}/*/tactile", the name of a group of arrays is the label. In a folder of files without `*`, each file is a touch if `labels` is an attribute
    ("@label") or a scalar, or if `touches` is "file".

    Files, and arrays with `*`, have natural order: numbers in names are ordered by value (touch_2 before touch_10), unlike in `sorted(glob.glob(...))`. Rows
    have the order of the file. The names of the touches are in `Recorded.touches`: paths of files or of arrays, or numbers. Arrays of labels and groups
    follow this order: `labels=[label_of[name] for name in found.touches]`. Arrays of several sensors are joined by the texts in the places of `*`.

    Touches with unequal numbers of frames are padded with NaN, and `lengths` contains their numbers, for each sensor its own. `run` then needs the key `resampled_frames`.

    Raises ValueError, with the file and the name, if an array does not exist or does not fit the others; ImportError if the package of the format
    is not installed; OSError if a file does not exist.
    """
    place = Path(path)
    given = {"labels": labels, "groups": groups}
    patterns = [] if place.exists() else [str(place)]
    patterns += [name for name in (frames.values() if isinstance(frames, Mapping) else [frames]) if isinstance(name, str)]
    for name, value in given.items():
        mark = f"{{{name.removesuffix('s')}}}"
        if value is not None and (both := [pattern for pattern in patterns if mark in pattern]):
            raise ValueError(f"{name}: given beside {mark} in `{both[0]}`; one of both")
    arrays = {name: value for name, value in given.items() if value is not None and not isinstance(value, str)}
    labels, groups = (None if name in arrays else value for name, value in given.items())
    found = _read(place, frames, (labels, groups, touches, order), bool(arrays))
    for name, value in arrays.items():
        setattr(found, name, as_keys(name, value, len(found)))
    return found


def _read(
    place: Path,
    frames: str | Sequence[str] | Mapping[str, str | Sequence[str]] | None,
    names: tuple[Any, Any, str | None, str | Mapping[str, str] | None],
    has_labels_by_position: bool,
) -> Recorded:
    if (place / "meta" / "info.json").is_file():
        return of_lerobot(place, frames, names, has_labels_by_position)
    wanted = frames if isinstance(frames, Mapping) else {"": frames}
    files = files_of(place)
    sources = [open_file(file) for file in files]
    try:
        of_files = (_part(source, wanted, names[:3], (len(files) > 1, has_labels_by_position)) for source in sources)
        parts = [_with_marks(part, str(place)) for part in of_files]
    finally:
        for source in sources:
            source.close()
    return joined(parts, (isinstance(frames, Mapping), names[3]))


def _with_marks(part: Part, pattern: str) -> Part:
    """Returns the touches of a file with the label and the group that its path contains in the places of `{label}` and `{group}` in a pattern."""
    found = matched(pattern, part.place)
    marks = found.groupdict() if found else {}
    n = len(part.touches)
    labels, groups = (np.repeat(marks[name], n) if name in marks else own for name, own in (("label", part.labels), ("group", part.groups)))
    return replace(part, labels=labels, groups=groups)


def _part(
    source: Source,
    wanted: Mapping[str, str | Sequence[str] | None],
    names: tuple[str | None, ...],
    how: tuple[bool, bool],
) -> Part:
    """Returns the touches of a file. `how` states whether the file is one of several, and whether labels or groups are joined by positions."""
    chosen = {name: _default(source, names) if columns is None else columns for name, columns in wanted.items()}
    if source.attributes is not None:
        # In HDF5 and Zarr files, a path from the root may begin with a slash.
        chosen = {name: columns.removeprefix("/") if isinstance(columns, str) else columns for name, columns in chosen.items()}
        names = tuple(name if name is None else name.removeprefix("/") for name in names)
    labels, groups, touches = names
    if not source.is_table and any(WILD.search(pattern) for pattern in chosen.values() if isinstance(pattern, str)):
        return _of_matches(source, chosen, (labels, groups))
    sensors: dict[str, list[Array] | Array] = {name: _readings(source, columns) for name, columns in chosen.items()}
    label = labels or ("labels" if "labels" in source.names else None)
    group = groups or ("groups" if "groups" in source.names else None)
    is_scalar = label is not None and ("@" in label or (label in source.names and source.array(label).size == 1))
    if touches == "file" or (how[0] and touches is None and is_scalar):
        value = None if label is None else as_keys(f"{source.place}, `{label}`", [source.value(label)])
        own = None if group is None else as_keys(f"{source.place}, `{group}`", [source.value(group)])
        return Part({name: [np.asarray(frames)] for name, frames in sensors.items()}, value, own, source.place, [""])
    n = len(next(iter(sensors.values())))
    for name, frames in sensors.items():
        if len(frames) != n:
            raise ValueError(f"{source.place}, `{chosen[name]}`: {len(frames)} rows; {n}, as the other sensors have")

    def of_rows(key: str | None) -> Array | None:
        return None if key is None else as_keys(f"{source.place}, `{key}`", source.array(key), n if touches is None else None)

    numbers = of_rows(touches)
    if numbers is None:
        return Part(sensors, of_rows(label), of_rows(group), source.place, [str(row) for row in range(n)])
    return by_touch(source.place, sensors, (numbers, of_rows(label), of_rows(group)), (str(touches), label, group), how[1])


def _default(source: Source, names: tuple[str | None, ...]) -> str | list[str]:
    """Returns the array `frames` or, in a table of a text file without such a column, the columns that are neither labels, groups nor numbers of rows."""
    others = {"labels", "groups", *names}
    readings = source.readings or []
    columns = [name for name in readings if name not in others]
    if not columns or "frames" in source.names:
        return "frames"
    if families := _core.column_families(columns):
        allowed = f'those that are readings, such as frames="{families[1]}", or frames="*" for all'
        raise ValueError(f"{source.place}: columns of several kinds: {families[0]}; {allowed}")
    note_counts(source.place, [f"`{name}`" for name in source.names if name not in readings and name not in others])
    return columns


def _readings(source: Source, columns: str | Sequence[str]) -> Array:
    """Returns the readings of an array, or of several columns with one taxel each."""
    if isinstance(columns, str) and (columns in source.names or not source.is_table):
        return as_numbers(f"{source.place}, array `{columns}`", np.atleast_1d(source.array(columns)))
    patterns = [columns] if isinstance(columns, str) else columns
    names = [name for pattern in patterns for name in source.matches(pattern)]
    return np.stack([as_numbers(f"{source.place}, column `{name}`", source.array(name)) for name in names], axis=1)


def _of_matches(source: Source, wanted: Mapping[str, str | Sequence[str]], keys: tuple[str | None, str | None]) -> Part:
    """Returns the touches of a file with one array for each touch. Arrays of several sensors are joined by the texts in the places of `*`."""
    # Path of the array of each sensor, and marks, for each touch.
    touches: dict[tuple[str, ...], tuple[dict[str, str], dict[str, str]]] = {}
    for name, pattern in wanted.items():
        if not isinstance(pattern, str) or not WILD.search(pattern):
            raise ValueError(f"{source.place}: `{pattern}`; a name with *, as the other sensors have")
        for path in source.matches(pattern):
            found = matched(pattern, path)
            if found is not None:
                touches.setdefault(found.groups(), ({}, found.groupdict()))[0][name] = path
    for paths, _ in touches.values():
        for name, pattern in wanted.items():
            if name not in paths:
                given = f"`{next(iter(paths.values()))}` without an array `{pattern}` of the same touch"
                raise ValueError(f"{source.place}: {given}; an array of each sensor for each touch")
    sensors: dict[str, list[Array] | Array] = {
        name: [as_numbers(f"{source.place}, array `{paths[name]}`", source.array(paths[name])) for paths, _ in touches.values()] for name in wanted
    }

    def values(pattern: str | None, mark: str) -> Array | None:
        if pattern is None:
            each = [marks[mark] for _, marks in touches.values() if mark in marks]
            return np.array(each) if each else None
        if not WILD.search(pattern):
            return as_keys(f"{source.place}, `{pattern}`", source.array(pattern), len(touches))
        each = [source.value(_filled(pattern, texts)) for texts in touches]
        return as_keys(f"{source.place}, `{pattern}`", each, len(touches))

    names = [next(iter(paths.values())) for paths, _ in touches.values()]
    return Part(sensors, values(keys[0], "label"), values(keys[1], "group"), source.place, names)


def _filled(pattern: str, texts: Sequence[str]) -> str:
    """Returns a pattern with texts in the places of `*`, `{label}` and `{group}`, in their order."""
    own = iter(texts)
    return WILD.sub(lambda found: next(own, found.group()), pattern)
