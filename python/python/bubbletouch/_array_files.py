"""Files with arrays by name: HDF5, Zarr, Parquet, CSV and NumPy archives. The packages h5py, zarr and pyarrow are imported at their first use."""

from __future__ import annotations

import glob
import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from bubbletouch import _core
from bubbletouch._arrays import Array

_SUFFIXES = {
    ".npz": "NumPy", ".npy": "NumPy", ".h5": "HDF5", ".hdf5": "HDF5", ".zarr": "Zarr", ".parquet": "Parquet", ".csv": "CSV", ".tsv": "CSV",
}
FORMATS = "a .zarr folder, an .h5, .hdf5, .parquet, .csv, .tsv, .npz or .npy file, a folder of such files, or a LeRobot folder"


@dataclass
class Source:
    """Open file: its path, the names of its arrays or columns, and functions that read an array or an attribute.

    readings: in a table of a text file, the columns that do not count its rows.
    """

    place: str
    names: list[str]
    read: Callable[[str], Array]
    attributes: Callable[[str], Mapping[str, Any]] | None = None
    close: Callable[[], object] = lambda: None
    is_table: bool = False
    readings: list[str] | None = None

    def array(self, name: str) -> Array:
        """Returns an array by its name."""
        if name not in self.names:
            raise ValueError(f"{self.place}: no array `{name}`; {_listed(self.names)}")
        try:
            return np.asarray(self.read(name))
        except (OSError, ValueError, RuntimeError) as error:
            if "allow_pickle" in str(error):
                trusted = f'numpy.load("{self.place}", allow_pickle=True) for a file that you trust, and run(recorded={{"frames": list(...), ...}})'
                raise ValueError(f"{self.place}, array `{name}`: pickled objects, which may run code; numbers, or {trusted}") from None
            raise ValueError(f"{self.place}, array `{name}`: cannot be read ({error}); a complete file") from None

    def matches(self, pattern: str) -> list[str]:
        """Returns the names that match a pattern; `*` stands for any text within one part of a path. In a pattern of columns, `*` stands for any text and `#`
        for a number. Columns have the order of the table; other arrays have the natural order, in which numbers in names are ordered by value.
        """
        of_columns = re.escape(pattern).replace(r"\*", ".*").replace(r"\#", "[0-9]+")
        found = [name for name in self.names if (re.fullmatch(of_columns, name) if self.is_table else matched(pattern, name))]
        if not found:
            raise ValueError(f"{self.place}: no array `{pattern}`; {_listed(self.names)}")
        return found if self.is_table else sorted(found, key=natural)

    def value(self, name: str) -> Any:
        """Returns a scalar, or an attribute that is written as `path@name`."""
        if "@" in name:
            owner, key = name.rsplit("@", 1)
            if self.attributes is None:
                raise ValueError(f"{self.place}: attribute `{name}`; the name of an array, because this format has no attributes")
            try:
                attributes = self.attributes(owner)
            except KeyError:
                raise ValueError(f"{self.place}: no `{owner}`; {_listed(self.names)}") from None
            if key not in attributes:
                raise ValueError(f"{self.place}: no attribute `{name}`; {_listed(sorted(attributes)) if attributes else 'an attribute of the file'}")
            return attributes[key]
        # An array with a value for each frame of the touch has equal values.
        values = self.array(name).reshape(-1)
        if len(values) == 0 or any(value != values[0] for value in values.tolist()):
            given = ", ".join(map(str, dict.fromkeys(values.tolist()[:1000])))[:60] or "no value"
            raise ValueError(f"{self.place}, array `{name}`: {given}; one value for each touch")
        return values[0]


# Parts of a pattern that stand for other texts.
WILD = re.compile(r"\*|\{label\}|\{group\}")


def matched(pattern: str, name: str) -> re.Match[str] | None:
    """Returns the match of a name with a pattern, or None. The groups of the match are the texts that stand for `*`, `{label}` and `{group}`, in their order;
    those of the marks have names. `*` stands for any text within one part of a path.
    """
    wild = {"*": "([^/]*)", "{label}": "(?P<label>[^/]+)", "{group}": "(?P<group>[^/]+)"}
    fixed = [re.escape(part) for part in WILD.split(pattern)]
    marks = [wild[mark] for mark in WILD.findall(pattern)] + [""]
    return re.fullmatch("".join(part + mark for part, mark in zip(fixed, marks, strict=True)), name)


def _listed(names: Sequence[str]) -> str:
    if len(names) > 20:
        # Names that differ in numbers are listed as one pattern.
        names = list(dict.fromkeys(re.sub(r"\d+", "*", name) for name in names))
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


def is_hidden(path: Path, folder: Path) -> bool:
    """Returns whether a path below a folder is hidden, such as `.ipynb_checkpoints` and the files `._NAME` that macOS writes beside others."""
    return any(part.startswith(".") for part in path.relative_to(folder).parts)


def _is_zarr(path: Path) -> bool:
    return path.is_dir() and any((path / name).is_file() for name in ("zarr.json", ".zgroup", ".zarray"))


def files_of(place: Path) -> list[Path]:
    """Returns the files of a recording: the path itself, or all files of a folder and its subfolders that are not hidden, in natural order."""
    if not place.exists():
        return _matching(place)
    if place.is_file() or _is_zarr(place):
        if place.is_file() and place.suffix.lower() not in _SUFFIXES:
            raise ValueError(f"{place}: another file; {FORMATS}")
        return [place]
    found = [file for file in place.rglob("*") if file.suffix.lower() in _SUFFIXES and (file.is_file() or _is_zarr(file))]
    found = [file for file in found if not is_hidden(file, place)]
    if not found:
        raise ValueError(f"{place}: a folder without recordings; {FORMATS}")
    return sorted(found, key=lambda file: natural(file.relative_to(place).as_posix()))


def _matching(pattern: Path) -> list[Path]:
    """Returns the files whose paths match a pattern, in natural order."""
    text = str(pattern)
    found = [Path(file) for file in glob.glob(WILD.sub("*", text)) if Path(file).suffix.lower() in _SUFFIXES]
    found = [file for file in found if matched(text, str(file)) is not None]
    if not found:
        raise FileNotFoundError(f"{pattern}: no such file or folder; {FORMATS}, or a pattern with *, {{label}} or {{group}} of such files")
    return sorted(found, key=lambda file: natural(file.as_posix()))


def open_file(file: Path) -> Source:
    kind = "Zarr" if file.is_dir() else _SUFFIXES[file.suffix.lower()]
    try:
        source = {"CSV": _open_table, "NumPy": _open_npz, "HDF5": _open_hdf5, "Zarr": _open_zarr, "Parquet": _open_parquet}[kind](file)
    except Exception as error:
        # The errors of tables in text files name the file.
        if kind == "CSV" or isinstance(error, ImportError | FileNotFoundError | PermissionError):
            raise
        raise ValueError(f"{file}: cannot be read ({error}); a complete {kind} file") from None
    if len(set(source.names)) < len(source.names):
        twice = next(name for name in source.names if source.names.count(name) > 1)
        raise ValueError(f"{file}: column `{twice}` twice; each name once")
    return source


def _attributes_of(opened: Any) -> Callable[[str], Mapping[str, Any]]:
    """Returns the function that returns the attributes of an array or a group of an HDF5 or Zarr file; an empty name is the file itself."""
    def attributes(owner: str) -> Mapping[str, Any]:
        found: Mapping[str, Any] = (opened[owner] if owner else opened).attrs
        return found

    return attributes


def _open_npz(file: Path) -> Source:
    with file.open("rb") as opened:
        # NumPy takes any other file as pickled objects.
        if not opened.read(6).startswith((b"\x93NUMPY", b"PK\x03\x04", b"PK\x05\x06")):
            raise ValueError("it begins neither as a .npy nor as a .npz file")
    if file.suffix.lower() == ".npy":
        return Source(str(file), ["frames"], lambda name: np.load(file, allow_pickle=False))
    archive = np.load(file, allow_pickle=False)
    return Source(str(file), list(archive.files), lambda name: archive[name], close=archive.close)


def _open_hdf5(file: Path) -> Source:
    h5py = optional_package("h5py", file)
    opened = h5py.File(file, "r")
    names: list[str] = []

    def visit(group: Any, prefix: str, above: tuple[Any, ...]) -> None:
        for key in group:
            try:
                item = group[key]
            except (KeyError, OSError):
                # A link to an object that does not exist.
                continue
            name = f"{prefix}{key}"
            if isinstance(item, h5py.Dataset):
                # A table has an array for each of its columns.
                names.extend([f"{name}/{column}" for column in item.dtype.names or ()] or [name])
            elif isinstance(item, h5py.Group) and item not in above:
                # Links are followed, but not to a group that contains the link.
                visit(item, f"{name}/", (*above, item))

    visit(opened, "", (opened["/"],))

    def read(name: str) -> Array:
        table, _, column = name.rpartition("/")
        values: Array = opened[table].fields(column)[()] if table and isinstance(opened[table], h5py.Dataset) else opened[name][()]
        return values

    return Source(str(file), names, read, _attributes_of(opened), opened.close)


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

    return Source(str(file), sorted(names, key=natural), lambda name: opened[name][...], _attributes_of(opened))


def _open_parquet(file: Path) -> Source:
    parquet = optional_package("pyarrow.parquet", file)
    opened = parquet.ParquetFile(file)
    names = list(opened.schema_arrow.names)

    def read(name: str) -> Array:
        return of_column(opened.read(columns=[name]).column(name))

    return Source(str(file), names, read, close=opened.close, is_table=True)


def _open_table(file: Path) -> Source:
    """Opens a table in a text file, as studies read it."""
    names, columns, kept, notes = _core.read_table(str(file))
    for note in notes:
        warnings.warn(note, stacklevel=2)
    if names is None:
        # Without names of columns, all columns but those that count the rows are readings.
        note_counts(str(file), [str(column + 1) for column in range(len(columns)) if column not in kept])
        return Source(str(file), ["frames"], lambda name: np.stack([_of_cells(columns[column]) for column in kept], axis=1))
    readings = [names[column] for column in kept]
    return Source(str(file), names, lambda name: _of_cells(columns[names.index(name)]), is_table=True, readings=readings)


def note_counts(place: str, columns: Sequence[str]) -> None:
    """Issues a warning that columns which count the rows of a table are left out."""
    for column in columns:
        warnings.warn(f"{place}: column {column} counts the rows; it is left out", stacklevel=2)


def _of_cells(cells: list[str]) -> Array:
    """Returns the cells of a column as integers, numbers or texts. An empty cell is a missing reading."""
    for kind in (np.int64, np.float64):
        try:
            return np.array([cell or "nan" for cell in cells]).astype(kind)
        except ValueError:
            continue
    return np.array(cells)


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
