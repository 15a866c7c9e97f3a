"""Files with arrays by name: HDF5, Zarr, Parquet, CSV and NumPy archives. The packages h5py, zarr and pyarrow are imported at their first use."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from bubbletouch._arrays import Array

_SUFFIXES = {".npz": "NumPy", ".h5": "HDF5", ".hdf5": "HDF5", ".zarr": "Zarr", ".parquet": "Parquet", ".csv": "CSV"}
FORMATS = "a .zarr folder, an .h5, .hdf5, .parquet, .csv or .npz file, a folder of such files, or a LeRobot folder"


@dataclass
class Source:
    """Open file: its path, the names of its arrays, and functions that read an array or an attribute."""

    place: str
    names: list[str]
    read: Callable[[str], Array]
    attribute: Callable[[str, str], Any] | None = None
    close: Callable[[], object] = lambda: None

    def array(self, name: str) -> Array:
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
        return sorted(found, key=natural)

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


def natural(name: str) -> list[tuple[int, int, str]]:
    """Returns a sorting key by which numbers in names are ordered by value."""
    parts: list[str] = [""]
    for letter in name:
        if parts[-1] and letter.isdigit() == parts[-1][-1].isdigit():
            parts[-1] += letter
        else:
            parts.append(letter)
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts[1:]]


def optional_package(name: str, place: Path) -> Any:
    """Returns an optional package. Raises ImportError, which names the package to install."""
    try:
        return import_module(name)
    except ImportError:
        package = name.split(".")[0]
        raise ImportError(f'{place}: needs the package {package}; pip install {package}, or pip install "bubbletouch[recorded]"') from None


def _is_zarr(path: Path) -> bool:
    return path.is_dir() and any((path / name).is_file() for name in ("zarr.json", ".zgroup", ".zarray"))


def files_of(place: Path) -> list[Path]:
    """Returns the files of a recording: the path itself, or all files of a folder and its subfolders in natural order."""
    if place.is_file() or _is_zarr(place):
        if place.is_file() and place.suffix.lower() not in _SUFFIXES:
            raise ValueError(f"{place}: another file; {FORMATS}")
        return [place]
    found = [file for file in place.rglob("*") if file.suffix.lower() in _SUFFIXES and (file.is_file() or _is_zarr(file))]
    if not found:
        raise ValueError(f"{place}: a folder without recordings; {FORMATS}")
    return sorted(found, key=lambda file: natural(file.relative_to(place).as_posix()))


def open_file(file: Path) -> Source:
    kind = "Zarr" if file.is_dir() else _SUFFIXES[file.suffix.lower()]
    open_of = {"NumPy": _open_npz, "HDF5": _open_hdf5, "Zarr": _open_zarr, "Parquet": _open_parquet, "CSV": _open_csv}[kind]
    try:
        return open_of(file)
    except (ImportError, FileNotFoundError, PermissionError):
        raise
    except Exception as error:
        raise ValueError(f"{file}: cannot be read ({error}); a complete {kind} file") from None


def _open_npz(file: Path) -> Source:
    archive = np.load(file, allow_pickle=False)
    return Source(str(file), list(archive.files), lambda name: archive[name], close=archive.close)


def _open_hdf5(file: Path) -> Source:
    h5py = optional_package("h5py", file)
    opened = h5py.File(file, "r")
    names: list[str] = []

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            names.append(name)

    opened.visititems(visit)

    def attribute(owner: str, key: str) -> Any:
        return (opened[owner] if owner else opened).attrs[key]

    return Source(str(file), names, lambda name: opened[name][()], attribute, opened.close)


def _open_zarr(file: Path) -> Source:
    zarr = optional_package("zarr", file)
    opened = zarr.open(str(file), mode="r")
    if not hasattr(opened, "keys"):
        return Source(str(file), ["frames"], lambda name: opened[...])
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

    return Source(str(file), sorted(names, key=natural), lambda name: opened[name][...], attribute)


def _open_parquet(file: Path) -> Source:
    parquet = optional_package("pyarrow.parquet", file)
    opened = parquet.ParquetFile(file)
    names = list(opened.schema_arrow.names)

    def read(name: str) -> Array:
        return of_column(opened.read(columns=[name]).column(name))

    return Source(str(file), names, read, close=opened.close)


def _open_csv(file: Path) -> Source:
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

    def read(name: str) -> Array:
        column = names.index(name)
        texts = [row[column].strip() for row in rows]
        for kind in (np.int64, np.float64):
            try:
                # An empty cell is a missing reading.
                return np.array([text or "nan" for text in texts]).astype(kind)
            except ValueError:
                continue
        return np.array(texts)

    return Source(str(file), names, read)


def of_column(column: Any) -> Array:
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
