"""Arrays of readings, labels and groups: their types, and touches of unequal length."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]


def as_numbers(place: str, values: Array) -> Array:
    """Returns readings as numbers. Raises ValueError for texts and objects."""
    if values.dtype.kind not in "fiub":
        raise ValueError(f"{place}: elements of type {values.dtype}; numbers")
    if values.size == 0:
        raise ValueError(f"{place}: shape {values.shape}; at least one reading")
    return values


def as_keys(place: str, values: ArrayLike, n: int | None = None) -> Array:
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


def padded(touches: Sequence[ArrayLike]) -> tuple[Array, Array | None]:
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
