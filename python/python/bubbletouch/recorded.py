"""Recorded touches in memory, and readers of Zarr, HDF5, Parquet, CSV, NumPy archives and LeRobot folders.

A recording contains frames of touches with labels and groups. `run(study, recorded=...)` runs a study of the recording, and `audit(...)` checks it.
The packages h5py, zarr and pyarrow are imported only by the readers of their files.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Recorded", "read_recorded"]

_Array = NDArray[Any]

# Keys of [recorded] that may be arrays in memory, with the number of values per touch.
_OF_TOUCHES = ("labels", "groups", "labels_test", "groups_test", "lengths", "lengths_test", "depths")
_FRAMES = ("frames", "frames_test", "shear", "shear_test")
_ARRAYS = (*_FRAMES, *_OF_TOUCHES, "zero")
_SUFFIXES = {".npz": "NumPy", ".h5": "HDF5", ".hdf5": "HDF5", ".zarr": "Zarr", ".parquet": "Parquet", ".csv": "CSV"}
_FORMATS = "a .zarr folder, an .h5, .hdf5, .parquet, .csv or .npz file, a folder of such files, or a LeRobot folder"


class Recorded:
    """Recorded touches.

    frames: readings, shape (n, rows, columns), (n, n_taxels), (n, n_frames, n_taxels) or (n, n_frames, rows, columns); touches of unequal length are
    padded with NaN. A dict of such arrays, by name, contains several sensors that recorded the same touches.
    labels: class of each touch, integers or texts, shape (n,); None if unknown.
    groups: group of each touch (grasp, subject, session), shape (n,); None without groups.
    order: letters of the axes of the frames as in `recorded.order`, or a dict by the names of the sensors; None for the default order.
    lengths: number of frames of each touch, shape (n,); None if all touches have the same number.
    keys: further keys of `[recorded]`, such as {"full_scale": 255.0}. Of several sensors, each has its keys under its name.
    """

    def __init__(
        self,
        frames: _Array | Mapping[str, _Array],
        labels: _Array | None = None,
        groups: _Array | None = None,
        order: str | Mapping[str, str] | None = None,
        lengths: _Array | None = None,
        keys: Mapping[str, Any] | None = None,
    ) -> None:
        self.frames = frames
        self.labels = labels
        self.groups = groups
        self.order = order
        self.lengths = lengths
        self.keys = keys or {}

    def __len__(self) -> int:
        first = next(iter(self.frames.values())) if isinstance(self.frames, Mapping) else self.frames
        return len(first)

    def __repr__(self) -> str:
        sensors = self.frames if isinstance(self.frames, Mapping) else {"frames": self.frames}
        shapes = ", ".join(f"{name} {np.shape(array)}" for name, array in sensors.items())
        return f"<bubbletouch.Recorded of {len(self)} touches: {shapes}>"

    def table(self) -> dict[str, Any]:
        """Returns the table `[recorded]` of a study, with arrays in place of files."""
        shared = {"labels": self.labels, "groups": self.groups}
        if not isinstance(self.frames, Mapping):
            own = {"frames": self.frames, "order": self.order, "lengths": self.lengths, **shared, **self.keys}
            return {name: value for name, value in own.items() if value is not None}
        orders = self.order if isinstance(self.order, Mapping) else dict.fromkeys(self.frames, self.order)
        sensors = []
        for name, frames in self.frames.items():
            own = {"name": name, "frames": frames, "order": orders.get(name), "lengths": self.lengths, **self.keys.get(name, {})}
            sensors.append({key: value for key, value in own.items() if value is not None})
        others = {key: value for key, value in self.keys.items() if key not in self.frames}
        return {"sensors": sensors} | {name: value for name, value in {**shared, **others}.items() if value is not None}


def read_recorded(
    path: str | PathLike[str],
    frames: str | Sequence[str] | Mapping[str, str | Sequence[str]] | None = None,
    *,
    labels: str | None = None,
    groups: str | None = None,
    touches: str | None = None,
    order: str | Mapping[str, str] | None = None,
) -> Recorded:
    """Reads recorded touches from files.

    path: a Zarr folder, an HDF5, Parquet, CSV or NumPy file (.zarr, .h5, .hdf5, .parquet, .csv, .npz), or a folder of such files; or a LeRobot folder
    (v2 or v3). The first line of a CSV file has the names of its columns.
    frames: name of the array, column or feature with the readings; a dict of names reads several sensors. A list of columns of a Parquet or CSV file,
    or a pattern such as "taxel_*", reads one taxel per column. None: `frames`; in a LeRobot folder the only feature with `tactile` or `touch` in its name.
    labels: name of the array or column with the class of each touch. None: `labels` if it exists; in a LeRobot folder, the task.
    groups: name of the array or column with the group of each touch. None: `groups` if it exists; in a folder of files, the name of the file.
    touches: name of the array or column with the number of the touch of each row. The rows of a touch are its frames. None: each row is a touch; in a
    LeRobot folder, each episode. "index" makes each row of a LeRobot folder a touch; its group is then the episode.
    order: letters of the axes of the returned frames, as in `recorded.order`, or a dict by sensor. None: the default order.

    A name with `*` (HDF5 and Zarr) matches one array per touch, whose first axis is time: "data/*/obs/tactile". Labels and groups with `*` have one
    value for each touch; "data/*@label" reads an attribute. In a folder of files without `*`, each file is a touch if `labels` is an attribute
    ("@label") or a scalar, or if `touches` is "file".

    Touches with unequal numbers of frames are padded with NaN, and `lengths` contains their numbers. `run` then needs the key `resampled_frames`.

    Raises ValueError, with the file and the name, if an array does not exist or does not fit the others; ImportError if the package of the format
    is not installed; OSError if a file does not exist.
    """
    place = Path(path)
    if not place.exists():
        raise FileNotFoundError(f"{place}: no such file or folder; {_FORMATS}")
    if (place / "meta" / "info.json").is_file():
        return _of_lerobot(place, frames, (labels, groups, touches, order))
    wanted = frames if isinstance(frames, Mapping) else {"": frames or "frames"}
    files = _files(place)
    sources = [_open(file) for file in files]
    try:
        names = (labels, groups, touches)
        parts = [_part(source, wanted, names, len(files) > 1) for source in sources]
    finally:
        for source in sources:
            source.close()
    return _joined([str(file) for file in files], parts, (isinstance(frames, Mapping), order))


@dataclass
class _Part:
    """Touches of one file: for each sensor a list of touches, or an array whose first axis is the touch."""

    sensors: dict[str, list[_Array] | _Array]
    labels: _Array | None
    groups: _Array | None


@dataclass
class _Source:
    """Open file: its path, the names of its arrays, and functions that read an array or an attribute."""

    place: str
    names: list[str]
    read: Callable[[str], _Array]
    attribute: Callable[[str, str], Any] | None = None
    close: Callable[[], object] = lambda: None

    def array(self, name: str) -> _Array:
        """Returns an array by its name."""
        if name not in self.names:
            raise ValueError(f"{self.place}: no array `{name}`; {_listed(self.names)}")
        try:
            return np.asarray(self.read(name))
        except (OSError, ValueError, RuntimeError) as error:
            raise ValueError(f"{self.place}, array `{name}`: cannot be read ({error}); a complete file") from None

    def matches(self, pattern: str) -> list[str]:
        """Returns the names of the arrays that match a pattern; `*` stands for one part of a path. Numbers in names are ordered by value."""
        parts = pattern.split("/")
        found = []
        for name in self.names:
            own = name.split("/")
            if len(own) == len(parts) and all(fnmatchcase(a, b) for a, b in zip(own, parts, strict=True)):
                found.append(name)
        if not found:
            raise ValueError(f"{self.place}: no array `{pattern}`; {_listed(self.names)}")
        return sorted(found, key=_natural)

    def value(self, name: str) -> Any:
        """Returns a scalar, or an attribute that is written as `path@name`."""
        if "@" in name:
            owner, key = name.rsplit("@", 1)
            if self.attribute is None:
                raise ValueError(f"{self.place}: attribute `{name}`; the name of an array, because this format has no attributes")
            try:
                return self.attribute(owner, key)
            except KeyError:
                raise ValueError(f"{self.place}: no attribute `{name}`; an attribute of the file") from None
        value = self.array(name)
        if value.size != 1:
            raise ValueError(f"{self.place}, array `{name}`: shape {value.shape}; one value for each touch")
        return value.reshape(-1)[0]


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(names[:20]) + (", …" if len(names) > 20 else "")
    return f"one of {shown}" if names else "a file with arrays"


def _natural(name: str) -> list[tuple[int, int, str]]:
    """Returns a sorting key by which numbers in names are ordered by value."""
    parts: list[str] = [""]
    for letter in name:
        if parts[-1] and letter.isdigit() == parts[-1][-1].isdigit():
            parts[-1] += letter
        else:
            parts.append(letter)
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts[1:]]


def _package(name: str, place: Path) -> Any:
    """Returns an optional package. Raises ImportError, which names the package to install."""
    try:
        return import_module(name)
    except ImportError:
        package = name.split(".")[0]
        raise ImportError(f'{place}: needs the package {package}; pip install {package}, or pip install "bubbletouch[recorded]"') from None


def _is_zarr(path: Path) -> bool:
    return path.is_dir() and any((path / name).is_file() for name in ("zarr.json", ".zgroup", ".zarray"))


def _files(place: Path) -> list[Path]:
    """Returns the files of a recording: the path itself, or all files of a folder and its subfolders in natural order."""
    if place.is_file() or _is_zarr(place):
        if place.is_file() and place.suffix.lower() not in _SUFFIXES:
            raise ValueError(f"{place}: another file; {_FORMATS}")
        return [place]
    found = [file for file in place.rglob("*") if file.suffix.lower() in _SUFFIXES and (file.is_file() or _is_zarr(file))]
    if not found:
        raise ValueError(f"{place}: a folder without recordings; {_FORMATS}")
    return sorted(found, key=lambda file: _natural(file.relative_to(place).as_posix()))


def _open(file: Path) -> _Source:
    kind = "Zarr" if file.is_dir() else _SUFFIXES[file.suffix.lower()]
    open_of = {"NumPy": _open_npz, "HDF5": _open_hdf5, "Zarr": _open_zarr, "Parquet": _open_parquet, "CSV": _open_csv}[kind]
    try:
        return open_of(file)
    except (ImportError, FileNotFoundError, PermissionError):
        raise
    except Exception as error:
        raise ValueError(f"{file}: cannot be read ({error}); a complete {kind} file") from None


def _open_npz(file: Path) -> _Source:
    archive = np.load(file, allow_pickle=False)
    return _Source(str(file), list(archive.files), lambda name: archive[name], close=archive.close)


def _open_hdf5(file: Path) -> _Source:
    h5py = _package("h5py", file)
    opened = h5py.File(file, "r")
    names: list[str] = []

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            names.append(name)

    opened.visititems(visit)

    def attribute(owner: str, key: str) -> Any:
        return (opened[owner] if owner else opened).attrs[key]

    return _Source(str(file), names, lambda name: opened[name][()], attribute, opened.close)


def _open_zarr(file: Path) -> _Source:
    zarr = _package("zarr", file)
    opened = zarr.open(str(file), mode="r")
    if not hasattr(opened, "keys"):
        return _Source(str(file), ["frames"], lambda name: opened[...])
    names: list[str] = []

    def visit(group: Any, prefix: str) -> None:
        for key in group.keys():
            item = group[key]
            if hasattr(item, "keys"):
                visit(item, f"{prefix}{key}/")
            else:
                names.append(f"{prefix}{key}")

    visit(opened, "")

    def attribute(owner: str, key: str) -> Any:
        return (opened[owner] if owner else opened).attrs[key]

    return _Source(str(file), sorted(names, key=_natural), lambda name: opened[name][...], attribute)


def _open_parquet(file: Path) -> _Source:
    parquet = _package("pyarrow.parquet", file)
    opened = parquet.ParquetFile(file)
    names = list(opened.schema_arrow.names)

    def read(name: str) -> _Array:
        return _of_column(opened.read(columns=[name]).column(name))

    return _Source(str(file), names, read, close=opened.close)


def _open_csv(file: Path) -> _Source:
    with file.open(encoding="utf-8-sig", newline="") as opened:
        lines = csv.reader(opened)
        names = [name.strip() for name in next(lines, [])]
        rows = [line for line in lines if line]
    twice = [name for name in names if names.count(name) > 1]
    if not names or twice:
        given = f"column `{twice[0]}` twice" if twice else "an empty file"
        raise ValueError(f"{given}; a first line with the name of each column")
    for number, row in enumerate(rows, start=2):
        if len(row) != len(names):
            raise ValueError(f"row {number} has {len(row)} of {len(names)} columns")

    def read(name: str) -> _Array:
        texts = [row[names.index(name)].strip() for row in rows]
        for kind in (np.int64, np.float64):
            try:
                # An empty cell is a missing reading.
                return np.array([text or "nan" for text in texts]).astype(kind)
            except ValueError:
                continue
        return np.array(texts)

    return _Source(str(file), names, read)


def _of_column(column: Any) -> _Array:
    """Returns a Parquet column as an array; nested lists of equal length become axes."""
    compute, types = import_module("pyarrow.compute"), import_module("pyarrow.types")
    array = column.combine_chunks()
    if hasattr(array, "chunks"):
        array = import_module("pyarrow").concat_arrays(array.chunks) if array.num_chunks else array.chunk(0)
    if hasattr(array, "storage"):
        array = array.storage
    shape = [len(array)]
    while types.is_list(array.type) or types.is_large_list(array.type) or types.is_fixed_size_list(array.type):
        if array.null_count:
            raise ValueError("a row without a value; a list in each row")
        lengths = compute.unique(compute.list_value_length(array)).to_pylist()
        if len(lengths) > 1:
            raise ValueError(f"lists of {min(lengths)} to {max(lengths)} values; equal lengths")
        shape.append(lengths[0] if lengths else 0)
        array = compute.list_flatten(array)
    values = np.asarray(array.to_numpy(zero_copy_only=False))
    return values.reshape(shape)


def _numbers(place: str, values: _Array) -> _Array:
    """Returns readings as numbers. Raises ValueError for texts and objects."""
    if values.dtype.kind not in "fiub":
        raise ValueError(f"{place}: elements of type {values.dtype}; numbers")
    if values.size == 0:
        raise ValueError(f"{place}: shape {values.shape}; at least one reading")
    return values


def _keys(place: str, values: ArrayLike, n: int | None = None) -> _Array:
    """Returns labels or groups as integers or texts, one for each touch."""
    array = np.asarray(values)
    if array.dtype.kind in "SO":
        decoded = [value.decode() if isinstance(value, bytes) else value for value in array.ravel().tolist()]
        if not all(isinstance(value, str | int) for value in decoded):
            missing = next(value for value in decoded if not isinstance(value, str | int))
            raise ValueError(f"{place}: {missing!r}; integers or texts")
        array = np.asarray(decoded).reshape(array.shape)
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0]
    if array.ndim == 2 and array.dtype.kind in "fiub" and np.isin(array, [0, 1]).all() and (array.sum(axis=1) == 1).all():
        array = array.argmax(axis=1)
    if array.ndim != 1 or (n is not None and len(array) != n):
        raise ValueError(f"{place}: shape {array.shape}; ({'n' if n is None else n},), a value for each touch")
    if array.dtype.kind == "f":
        if not (np.isfinite(array).all() and (array == np.round(array)).all()):
            raise ValueError(f"{place}: numbers that are no integers; integers or texts")
        array = array.astype(np.int64)
    if array.dtype.kind not in "iubU":
        raise ValueError(f"{place}: elements of type {array.dtype}; integers or texts")
    return array


def _part(
    source: _Source, wanted: Mapping[str, str | Sequence[str]], names: tuple[str | None, str | None, str | None], is_one_of_several: bool
) -> _Part:
    labels, groups, touches = names
    is_each = any("*" in pattern for pattern in wanted.values() if isinstance(pattern, str)) and not source.place.lower().endswith((".parquet", ".csv"))
    if is_each:
        return _of_matches(source, wanted, (labels, groups))
    sensors: dict[str, list[_Array] | _Array] = {name: _readings(source, columns) for name, columns in wanted.items()}
    label = labels or ("labels" if "labels" in source.names else None)
    group = groups or ("groups" if "groups" in source.names else None)
    is_scalar = label is not None and ("@" in label or (label in source.names and source.array(label).size == 1))
    if touches == "file" or (is_one_of_several and touches is None and is_scalar):
        value = None if label is None else _keys(f"{source.place}, `{label}`", [source.value(label)])
        own = None if group is None else _keys(f"{source.place}, `{group}`", [source.value(group)])
        return _Part({name: [np.asarray(frames)] for name, frames in sensors.items()}, value, own)
    n = len(next(iter(sensors.values())))
    for name, frames in sensors.items():
        if len(frames) != n:
            raise ValueError(f"{source.place}, `{wanted[name]}`: {len(frames)} rows; {n}, as the other sensors have")

    def of_rows(key: str | None) -> _Array | None:
        return None if key is None else _keys(f"{source.place}, `{key}`", source.array(key), n)

    numbers = of_rows(touches)
    if numbers is None:
        return _Part(sensors, of_rows(label), of_rows(group))
    return _by_touch(source.place, sensors, (numbers, of_rows(label), of_rows(group)), (label, group))


def _readings(source: _Source, columns: str | Sequence[str]) -> _Array:
    """Returns the readings of an array, or of several columns with one taxel each."""
    if isinstance(columns, str) and "*" not in columns:
        return _numbers(f"{source.place}, array `{columns}`", np.atleast_1d(source.array(columns)))
    names = source.matches(columns) if isinstance(columns, str) else list(columns)
    return np.stack([_numbers(f"{source.place}, column `{name}`", source.array(name)) for name in names], axis=1)


def _of_matches(source: _Source, wanted: Mapping[str, str | Sequence[str]], keys: tuple[str | None, str | None]) -> _Part:
    """Returns the touches of a file with one array for each touch."""
    sensors: dict[str, list[_Array] | _Array] = {}
    paths: list[str] = []
    for name, pattern in wanted.items():
        if not isinstance(pattern, str) or "*" not in pattern:
            raise ValueError(f"{source.place}: `{pattern}`; a name with *, as the other sensors have")
        found = source.matches(pattern)
        if paths and len(found) != len(paths):
            raise ValueError(f"{source.place}, `{pattern}`: {len(found)} touches; {len(paths)}, as the other sensors have")
        paths = paths or [_stars(pattern, path) for path in found]
        sensors[name] = [_numbers(f"{source.place}, array `{path}`", source.array(path)) for path in found]

    def values(pattern: str | None) -> _Array | None:
        if pattern is None:
            return None
        if "*" not in pattern:
            return _keys(f"{source.place}, `{pattern}`", source.array(pattern), len(paths))
        each = [source.value(_filled(pattern, path)) for path in paths]
        return _keys(f"{source.place}, `{pattern}`", each, len(paths))

    return _Part(sensors, values(keys[0]), values(keys[1]))


def _stars(pattern: str, path: str) -> str:
    """Returns the parts of a path at the places of the parts with `*` in a pattern, separated by slashes."""
    pairs = zip(pattern.split("/"), path.split("/"), strict=True)
    return "/".join(own for part, own in pairs if "*" in part)


def _filled(pattern: str, stars: str) -> str:
    """Returns a pattern whose parts with `*` are replaced by the given parts."""
    parts: Iterator[str] = iter(stars.split("/"))
    path, at, key = pattern.partition("@")
    return "/".join(next(parts, part) if "*" in part else part for part in path.split("/")) + at + key


def _by_touch(
    place: str,
    sensors: Mapping[str, list[_Array] | _Array],
    columns: tuple[_Array, _Array | None, _Array | None],
    names: tuple[str | None, str | None],
) -> _Part:
    """Divides rows into touches, in the order of their first rows."""
    touches, first, numbers = np.unique(columns[0], return_index=True, return_inverse=True)
    order = np.argsort(first)
    rows = [np.flatnonzero(numbers == touch) for touch in order]

    def of_touches(values: _Array | None, name: str | None) -> _Array | None:
        if values is None:
            return None
        for touch, own in zip(order, rows, strict=True):
            if len(np.unique(values[own])) > 1:
                given = ", ".join(map(str, np.unique(values[own])[:3]))
                raise ValueError(f"{place}, `{name}`: {given} in touch {touches[touch]}; one value for all rows of a touch")
        return values[np.sort(first)]

    divided: dict[str, list[_Array] | _Array] = {name: [np.asarray(frames)[own] for own in rows] for name, frames in sensors.items()}
    return _Part(divided, of_touches(columns[1], names[0]), of_touches(columns[2], names[1]))


def _joined(places: list[str], parts: list[_Part], how: tuple[bool, str | Mapping[str, str] | None]) -> Recorded:
    """Joins the touches of all files."""
    are_sensors, order = how
    frames: dict[str, _Array] = {}
    lengths: _Array | None = None
    for name in parts[0].sensors:
        own = [part.sensors[name] for part in parts]
        frames[name], lengths_of = _padded(places, own, name)
        lengths = lengths if lengths_of is None else lengths_of
    n_of = [len(next(iter(part.sensors.values()))) for part in parts]

    def values(of: Callable[[_Part], _Array | None]) -> _Array | None:
        each = [of(part) for part in parts]
        if all(own is None for own in each):
            return None
        for place, own in zip(places, each, strict=True):
            if own is None:
                raise ValueError(f"{place}: no labels or groups; those that other files have")
        kinds = {own.dtype.kind == "U" for own in each if own is not None}
        if len(kinds) > 1:
            raise ValueError(f"{places[0]}: labels or groups that are texts in some files and integers in others; one kind")
        return np.concatenate([own for own in each if own is not None])

    groups = values(lambda part: part.groups)
    if groups is None and len(parts) > 1 and max(n_of) > 1:
        groups = np.repeat([Path(place).stem for place in places], n_of)
    said = frames if are_sensors else next(iter(frames.values()))
    return Recorded(said, values(lambda part: part.labels), groups, order, lengths)


def _padded(places: list[str], parts: Sequence[list[_Array] | _Array], name: str) -> tuple[_Array, _Array | None]:
    """Returns the touches as one array, padded with NaN to the longest touch, and the lengths of touches if they differ."""
    if all(isinstance(part, np.ndarray) for part in parts):
        for place, part in zip(places, parts, strict=True):
            _same_shape(place, name, np.shape(part)[1:], np.shape(parts[0])[1:])
        return np.concatenate([np.asarray(part) for part in parts]), None
    touches = [(place, np.asarray(touch)) for place, part in zip(places, parts, strict=True) for touch in part]
    for place, touch in touches:
        if touch.ndim < 2:
            raise ValueError(f"{place}, frames {name}: shape {touch.shape} of a touch; frames × taxels, or frames × rows × columns")
        _same_shape(place, name, touch.shape[1:], touches[0][1].shape[1:])
    return padded([touch for _, touch in touches])


def _same_shape(place: str, name: str, given: tuple[int, ...], allowed: tuple[int, ...]) -> None:
    if given != allowed:
        raise ValueError(f"{place}, frames {name}: frames of shape {given}; {allowed}, as other touches have")


def padded(touches: Sequence[ArrayLike]) -> tuple[_Array, _Array | None]:
    """Returns touches of unequal length, each with frames along the first axis, as one array padded with NaN; and their lengths if they differ."""
    arrays = [np.asarray(touch) for touch in touches]
    lengths = np.array([len(touch) for touch in arrays])
    if len(set(lengths.tolist())) == 1:
        return np.stack(arrays), None
    kind = np.result_type(np.float32, *{array.dtype for array in arrays})
    frames = np.full((len(arrays), int(lengths.max()), *arrays[0].shape[1:]), np.nan, dtype=kind)
    for touch, array in zip(frames, arrays, strict=True):
        touch[: len(array)] = array
    return frames, lengths


def _of_lerobot(
    folder: Path,
    frames: str | Sequence[str] | Mapping[str, str | Sequence[str]] | None,
    names: tuple[str | None, str | None, str | None, str | Mapping[str, str] | None],
) -> Recorded:
    """Reads a LeRobot folder of format v2 (a file for each episode) or v3 (many episodes in a file)."""
    parquet = _package("pyarrow.parquet", folder)
    pyarrow = _package("pyarrow", folder)
    labels, groups, touches, order = names
    info_file = folder / "meta" / "info.json"
    try:
        info = json.loads(info_file.read_text(encoding="utf-8"))
        features = {str(name): dict(about) for name, about in info["features"].items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"{info_file}: cannot be read ({error!r}); an object with `features`") from None
    numeric = [name for name, about in features.items() if about.get("dtype") not in ("video", "image", "string")]
    if frames is None:
        felt = [name for name in numeric if name.startswith("observation.") and ("tactile" in name or "touch" in name)]
        if len(felt) != 1:
            given = "no feature of touch" if not felt else f"features {', '.join(felt)}"
            raise ValueError(f"{info_file}: {given}; frames = a name, or a dict of names for several sensors, of {', '.join(numeric)}")
        frames = felt[0]
    wanted = {name: str(of) for name, of in frames.items()} if isinstance(frames, Mapping) else {"": str(frames)}
    for name in wanted.values():
        if name not in numeric:
            raise ValueError(f"{info_file}: no feature `{name}` of numbers; one of {', '.join(numeric)}")
    files = sorted((folder / "data").rglob("*.parquet"), key=lambda file: _natural(file.relative_to(folder).as_posix()))
    if not files:
        raise ValueError(f"{folder / 'data'}: no .parquet file; the rows of the episodes")
    columns = list(dict.fromkeys([*wanted.values(), "episode_index", "task_index", "frame_index", touches or "episode_index"]))
    columns += [name for name in (labels, groups) if name is not None and name not in columns]
    tables = []
    for file in files:
        try:
            there = set(parquet.read_schema(file).names)
            absent = [name for name in columns if name not in there and name not in ("task_index", "frame_index")]
            if absent:
                raise ValueError(f"no column `{absent[0]}`; one of {', '.join(sorted(there))}")
            tables.append(parquet.read_table(file, columns=[name for name in columns if name in there]))
        except (pyarrow.ArrowException, OSError, ValueError) as error:
            raise ValueError(f"{file}: {error}; a complete Parquet file") from None
    table = pyarrow.concat_tables(tables)
    if info.get("total_frames") not in (None, table.num_rows):
        raise ValueError(f"{folder / 'data'}: {table.num_rows} rows; {info['total_frames']}, as {info_file} says")

    def column(name: str) -> _Array:
        try:
            return _of_column(table.column(name))
        except (ValueError, pyarrow.ArrowException) as error:
            raise ValueError(f"{folder}, feature `{name}`: {error}") from None

    sensors: dict[str, list[_Array] | _Array] = {}
    for name, feature in wanted.items():
        values = _numbers(f"{folder}, feature `{feature}`", column(feature))
        shape = tuple(features[feature].get("shape") or values.shape[1:])
        if values.size != len(values) * int(np.prod(shape)):
            raise ValueError(f"{folder}, feature `{feature}`: rows of shape {values.shape[1:]}; {shape}, as {info_file} says")
        sensors[name] = values.reshape(len(values), *shape)
    numbers = _keys(f"{folder}, feature `{touches or 'episode_index'}`", column(touches or "episode_index"))
    if "frame_index" in table.column_names:
        # Rows of an episode are in order of time, whatever the order of the files.
        in_time = np.lexsort((column("frame_index").ravel(), column("episode_index").ravel()))
    else:
        in_time = np.argsort(column("episode_index").ravel(), kind="stable")

    def keys(name: str | None, default: str | None) -> tuple[_Array | None, str | None]:
        name = name or default
        if name is None or name not in table.column_names:
            return None, None
        values = _keys(f"{folder}, feature `{name}`", column(name))[in_time]
        return (_tasks(folder, values) if name == "task_index" else values), name

    of_labels, label = keys(labels, "task_index")
    of_groups, group = keys(groups, None if touches is None else "episode_index")
    rows = {name: np.asarray(values)[in_time] for name, values in sensors.items()}
    part = _by_touch(str(folder), rows, (numbers[in_time], of_labels, of_groups), (label, group))
    return _joined([str(folder)], [part], (isinstance(frames, Mapping), order))


def _tasks(folder: Path, numbers: _Array) -> _Array:
    """Returns the texts of tasks by their numbers; the numbers themselves if the folder has no file of tasks."""
    lines, table = folder / "meta" / "tasks.jsonl", folder / "meta" / "tasks.parquet"
    names: dict[int, str] = {}
    try:
        if lines.is_file():
            for line in lines.read_text(encoding="utf-8").splitlines():
                if line.strip():
                    task = json.loads(line)
                    names[int(task["task_index"])] = str(task["task"])
        elif table.is_file():
            columns = _package("pyarrow.parquet", folder).read_table(table).to_pydict()
            texts = next(columns[name] for name in ("task", "__index_level_0__") if name in columns)
            names = dict(zip(map(int, columns["task_index"]), map(str, texts), strict=True))
    except (ValueError, KeyError, StopIteration) as error:
        raise ValueError(f"{lines if lines.is_file() else table}: cannot be read ({error!r}); task_index and task of each task") from None
    if not names:
        return numbers
    for number in np.unique(numbers).tolist():
        if number not in names:
            raise ValueError(f"{folder}, feature `task_index`: {number}; one of {sorted(names)}")
    return np.array([names[number] for number in numbers.tolist()])


def with_files(table: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Returns a table `[recorded]` with files in place of arrays. Each file is named after its content and is written into the folder."""
    written: dict[str, Any] = {}
    for key, value in table.items():
        if key == "sensors":
            written[key] = [with_files(sensor, folder) for sensor in value]
        elif key in _FRAMES and isinstance(value, list | tuple):
            frames, lengths = padded(value)
            written[key] = _file(folder, key, frames)
            if lengths is not None:
                written[key.replace("frames", "lengths")] = _file(folder, "lengths", lengths)
        elif key in _ARRAYS and not isinstance(value, str | PathLike | float | int):
            written[key] = _file(folder, key, np.asarray(value))
        elif value is not None:
            written[key] = value
    return written


def _file(folder: Path, name: str, values: _Array) -> str:
    """Writes an array into the folder, and returns its path."""
    if values.dtype.kind == "O" or values.dtype.kind == "S":
        values = _keys(f"recorded.{name}", values)
    if values.dtype.kind not in "fiubU":
        raise ValueError(f"recorded.{name}: elements of type {values.dtype}; numbers, or texts of labels and groups")
    content = io.BytesIO()
    np.save(content, values, allow_pickle=False)
    data = content.getvalue()
    path = folder / f"{name}-{hashlib.sha256(data).hexdigest()[:16]}.npy"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        part.write_bytes(data)
        part.replace(path)
    return str(path.resolve())
