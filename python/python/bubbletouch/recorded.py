"""Recorded touches in memory. `run(study, recorded=...)` runs a study of them, and `audit(...)` checks them."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bubbletouch._arrays import Array, as_array, as_keys, as_numbers, check_frames, padded
from bubbletouch._core import Patch

__all__ = ["Recorded"]

# Keys of [recorded] that may be arrays in memory.
_FRAMES = ("frames", "frames_test", "shear", "shear_test")
# Keys that may be texts.
_KEYS = ("labels", "groups", "labels_test", "groups_test")
_ARRAYS = (*_FRAMES, *_KEYS, "lengths", "lengths_test", "depths", "zero")


class Recorded:
    """Recorded touches.

    frames: readings, shape (n, rows, columns), (n, n_taxels), (n, n_frames, n_taxels) or (n, n_frames, rows, columns); touches of unequal length are
    padded with NaN. A dict of such arrays, by name, contains several sensors that recorded the same touches.
    labels: class of each touch, integers or texts, shape (n,); None if unknown.
    groups: group of each touch (grasp, subject, session), shape (n,); None without groups.
    order: letters of the axes of the frames as in `recorded.order`, or a dict by the names of the sensors; None for the default order.
    lengths: number of frames of each touch, shape (n,), or a dict by the names of the sensors; None if all touches have the same number.
    touches: names of the touches, texts, shape (n,), in the order of `frames`; None if the touches have no names.
    splits: split of each trial, a pair (train, test) of arrays of touch numbers, as scikit-learn's `list(cv.split(X, y, groups))`; None for the splits of
    the study. The key `trials` of the study is at most their number.
    keys: further keys of `[recorded]`, such as {"full_scale": 255.0}. Of several sensors, each has its keys under its name. The key `layout` may be a
    Patch, or an array of positions, metres, shape (n_taxels, 3), or of positions and axes, shape (n_taxels, 6).
    """

    def __init__(
        self,
        frames: Array | Mapping[str, Array],
        labels: Array | None = None,
        groups: Array | None = None,
        order: str | Mapping[str, str] | None = None,
        lengths: Array | Mapping[str, Array] | None = None,
        keys: Mapping[str, Any] | None = None,
        touches: Array | None = None,
        splits: Iterable[tuple[ArrayLike, ArrayLike]] | None = None,
    ) -> None:
        self.frames = frames
        self.labels = labels
        self.groups = groups
        self.order = order
        self.lengths = lengths
        self.touches = touches
        self.splits = None if splits is None else list(splits)
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
        shared = {"labels": self.labels, "groups": self.groups, "splits": self.splits}
        if not isinstance(self.frames, Mapping):
            own = {"frames": self.frames, "order": self.order, "lengths": self.lengths, **shared, **self.keys}
            return {name: value for name, value in own.items() if value is not None}
        orders, lengths = (of if isinstance(of, Mapping) else dict.fromkeys(self.frames, of) for of in (self.order, self.lengths))
        sensors = []
        for name, frames in self.frames.items():
            own = {"name": name, "frames": frames, "order": orders.get(name), "lengths": lengths.get(name), **self.keys.get(name, {})}
            sensors.append({key: value for key, value in own.items() if value is not None})
        others = {key: value for key, value in self.keys.items() if key not in self.frames}
        return {"sensors": sensors} | {name: value for name, value in {**shared, **others}.items() if value is not None}


def with_files(table: Mapping[str, Any], folder: Path, files: dict[str, str], place: str = "recorded") -> dict[str, Any]:
    """Returns a table `[recorded]` with files in place of arrays, given the keys and values of the table. Each file is named after its content and is written into the folder; its path is added to
    `files` with the key of the array.
    """
    written: dict[str, Any] = {}

    def stored(key: str, values: Array) -> None:
        written[key] = _file(folder, f"{place}.{key}", values)
        files[written[key]] = f"{place}.{key}"

    if place == "recorded":
        check_frames(dict(_arrays_of(table, place)))
    for key, value in table.items():
        if key == "sensors":
            if isinstance(value, str) or not all(isinstance(sensor, Mapping) for sensor in value):
                raise ValueError(f"{place}.sensors: {type(value).__name__}; a list of dicts, each with name and frames")
            written[key] = [with_files(sensor, folder, files, f"{place}.sensors[{number}]") for number, sensor in enumerate(value, 1)]
        elif isinstance(value, str | PathLike):
            written[key] = value
        elif key in _FRAMES and (isinstance(value, list | tuple) or getattr(value, "dtype", None) == object):
            frames, lengths = padded(f"{place}.{key}", list(value))
            stored(key, frames)
            if lengths is not None:
                stored(key.replace("frames", "lengths"), lengths)
        elif key in _ARRAYS and value is not None and (key != "zero" or np.ndim(value) > 0):
            stored(key, as_array(f"{place}.{key}", value))
        elif key in ("splits", "layout") and value is not None:
            written[key] = (_splits if key == "splits" else _layout)(folder, f"{place}.{key}", value)
            files[written[key]] = f"{place}.{key}"
        elif value is not None:
            written[key] = value
    return written


def _arrays_of(table: Mapping[str, Any], place: str) -> Iterator[tuple[str, Any]]:
    """Returns the keys and the values of the arrays, sensor after sensor."""
    sensors = table.get("sensors", ())
    for number, sensor in enumerate(() if isinstance(sensors, str) else sensors, 1):
        if isinstance(sensor, Mapping):
            yield from _arrays_of(sensor, f"{place}.sensors[{number}]")
    yield from ((f"{place}.{key}", value) for key, value in table.items() if key in _ARRAYS)


def with_paths(table: Mapping[str, Any], paths: Mapping[str, str]) -> dict[str, Any]:
    """Returns a table `[recorded]` in which paths are replaced by other paths."""
    def moved(value: Any) -> Any:
        if isinstance(value, list):
            return [with_paths(sensor, paths) if isinstance(sensor, Mapping) else sensor for sensor in value]
        return paths.get(value, value) if isinstance(value, str) else value

    return {key: moved(value) for key, value in table.items()}


def _layout(folder: Path, key: str, value: Any) -> str:
    """Writes a layout file of a patch, of positions or of positions and axes, and returns its path."""
    taxels = np.hstack([value.centers, value.axes]) if isinstance(value, Patch) else np.asarray(value)
    if taxels.dtype.kind not in "fiu" or taxels.ndim != 2 or taxels.shape[1] not in (3, 6):
        allowed = "a Patch, or positions (n, 3) in metres, or positions and axes (n, 6)"
        raise ValueError(f"{key}: shape {taxels.shape} of {taxels.dtype}; {allowed}")
    # Positions alone are taxels whose axes point along +z.
    axes = taxels[:, 3:] if taxels.shape[1] == 6 else np.tile([0.0, 0.0, 1.0], (len(taxels), 1))
    content = io.BytesIO()
    np.savez(content, positions=taxels[:, :3].astype(np.float64), normals=axes.astype(np.float64))
    return _written(folder, "layout", ".npz", content.getvalue())


def _splits(folder: Path, key: str, value: Iterable[tuple[ArrayLike, ArrayLike]]) -> str:
    """Writes the arrays `train_t` and `test_t` of each split t, and returns the path of the file."""
    arrays: dict[str, Any] = {}
    for number, pair in enumerate(value):
        if len(pair) != 2:
            raise ValueError(f"{key}: {len(pair)} arrays in split {number}; a pair (train, test) of arrays of touch numbers")
        arrays |= {f"{name}_{number}": np.asarray(rows) for name, rows in zip(("train", "test"), pair, strict=True)}
    content = io.BytesIO()
    np.savez(content, **arrays)
    return _written(folder, "splits", ".npz", content.getvalue())


def named(error: ValueError, files: Mapping[str, str]) -> ValueError:
    """Returns an error with the keys of arrays in memory in place of the paths of their files."""
    text = str(error)
    for path, key in files.items():
        text = text.replace(path, key)
    found = ValueError(text)
    found.__cause__ = error.__cause__
    return found


def _file(folder: Path, key: str, values: Array) -> str:
    """Writes an array into the folder, and returns its path."""
    name = key.rpartition(".")[2]
    if name in _KEYS and values.dtype.kind in "OSTM":
        values = as_keys(key, values)
    elif name not in _KEYS:
        values = as_numbers(key, values)
    if values.dtype.kind not in "fiubU":
        raise ValueError(f"{key}: elements of type {values.dtype}; integers or texts")
    content = io.BytesIO()
    np.save(content, values, allow_pickle=False)
    return _written(folder, name, ".npy", content.getvalue())


def _written(folder: Path, name: str, suffix: str, data: bytes) -> str:
    """Writes a file that is named after its content, unless it exists, and returns its path."""
    path = folder / f"{name}-{hashlib.sha256(data).hexdigest()[:16]}{suffix}"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        part.write_bytes(data)
        part.replace(path)
    return str(path.resolve())
