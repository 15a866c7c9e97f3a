"""Arrays of readings, labels and groups: their types, and touches of unequal length."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bubbletouch import _core

Array = NDArray[Any]


def check_frames(values: Mapping[str, Any]) -> None:
    """Checks data frames and series by the names of their keys. Those with a row for each touch have equal indexes, and the columns of frames are of one family.
    A name that ends with `_test` belongs to the test set. The zeros of taxels are named by the columns of the frames.
    """
    first: dict[str, tuple[str, Any]] = {}
    for name, value in values.items():
        index, columns = getattr(value, "index", None), getattr(value, "columns", None)
        *sensor, key = name.split(".")
        is_frames = key in ("frames", "frames_test")
        if is_frames and columns is not None and (families := _core.column_families([str(column) for column in columns])):
            given = f"columns of several kinds: {families[0]}"
            raise ValueError(f"{name}: {given}; a data frame of those that are readings, such as `{families[1]}`, or .to_numpy() for all")
        # The columns of all frames of a sensor have one order.
        of_taxels = columns if is_frames or columns is not None else index
        alike = [("other columns", ".".join(sensor), of_taxels)] if is_frames or key == "zero" else []
        if key != "zero":
            alike.append(("another index", "_test" if name.endswith("_test") else "", index))
        for what, group, own in alike:
            if not hasattr(own, "equals"):
                continue
            known, other = first.setdefault(f"{what} {group}", (name, own))
            if not other.equals(own):
                raise ValueError(f"{name}: {what} than {known}; equal ones, or .to_numpy() for values by their positions")


def as_array(place: str, values: Any) -> Array:
    """Returns an array of values in memory. Masked values become NaN; a tensor of PyTorch is copied from its device."""
    if isinstance(values, np.ma.MaskedArray) and values.dtype.kind in "fiub":
        missing = np.ma.getmaskarray(values)
        return np.where(missing, np.nan, values.data.astype(np.result_type(values.dtype, np.float32)))
    try:
        if hasattr(values, "detach"):
            values = values.detach().cpu()
            # NumPy has no type bfloat16.
            values = values.float() if "bfloat16" in str(values.dtype) else values
        # NumPy would convert the numbers of a list with texts to texts, also NaN.
        is_mixed = isinstance(values, list | tuple) and len({isinstance(value, str) for value in values}) > 1
        array = np.asarray(values, dtype=object if is_mixed else None)
    except (TypeError, ValueError, RuntimeError) as error:
        raise ValueError(f"{place}: {type(values).__name__} that cannot be converted to an array ({error}); an array") from None
    if array.ndim == 0:
        raise ValueError(f"{place}: {type(values).__name__}; an array, or the path of a file")
    return array


def as_numbers(place: str, values: Array) -> Array:
    """Returns readings as numbers. Raises ValueError for texts and objects."""
    if values.dtype.names:
        raise ValueError(f"{place}: fields {', '.join(values.dtype.names)}; an array of numbers, such as one field")
    if values.size == 0:
        raise ValueError(f"{place}: no readings, shape {values.shape}; at least one reading")
    if values.dtype.kind == "O":
        try:
            return values.astype(np.float64)
        except (TypeError, ValueError):
            pass
        kind = type(next(value for value in values.ravel().tolist() if not isinstance(value, float))).__name__
        many = "" if kind == "str" else ", in an array for each touch or in touches that are padded with NaN"
        raise ValueError(f"{place}: elements of type {kind}; numbers{many}")
    if values.dtype.kind not in "fiub":
        raise ValueError(f"{place}: elements of type {values.dtype}; numbers")
    return values


def as_keys(place: str, values: ArrayLike, n: int | None = None) -> Array:
    """Returns labels or groups as integers or texts, one for each touch."""
    array = as_array(place, values)
    if array.dtype.kind == "T":
        # Texts of any length, as Zarr stores them.
        array = np.asarray(array.tolist(), dtype=str)
    if array.dtype.kind == "M":
        # Dates, such as those of sessions.
        if np.isnat(array).any():
            raise ValueError(f"{place}, position {np.flatnonzero(np.isnat(array))[0]}: NaT; integers or texts")
        array = array.astype(str)
    if array.dtype.kind in "SO":
        decoded = [value.decode() if isinstance(value, bytes) else value for value in array.ravel().tolist()]
        if not all(isinstance(value, str | int) for value in decoded):
            at, missing = next((at, value) for at, value in enumerate(decoded) if not isinstance(value, str | int))
            raise ValueError(f"{place}, position {at}: {missing!r}; integers or texts")
        if len({isinstance(value, str) for value in decoded}) > 1:
            raise ValueError(f"{place}: texts and integers; one kind")
        array = np.asarray(decoded).reshape(array.shape)
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0]
    if array.ndim == 2 and array.dtype.kind in "fiub" and np.isin(array, [0, 1]).all() and (array.sum(axis=1) == 1).all():
        array = array.argmax(axis=1)
    if array.ndim != 1 or (n is not None and len(array) != n):
        raise ValueError(f"{place}: shape {array.shape}; ({'n' if n is None else n},), a value for each touch")
    if array.dtype.kind == "f":
        wrong = np.flatnonzero(~(np.isfinite(array) & (array == np.round(array))))
        if len(wrong):
            raise ValueError(f"{place}, position {wrong[0]}: {array[wrong[0]]}; integers or texts")
        array = array.astype(np.int64)
    if array.dtype.kind == "U" and not (array != "").all():
        raise ValueError(f"{place}, position {np.flatnonzero(array == '')[0]}: an empty text; integers or texts")
    if array.dtype.kind not in "iubU":
        raise ValueError(f"{place}: elements of type {array.dtype}; integers or texts")
    return array


def padded(place: str, touches: Sequence[ArrayLike]) -> tuple[Array, Array | None]:
    """Returns touches of unequal length, each with frames along the first axis, as one array padded with NaN; and their lengths if they differ."""
    if len(touches) == 0:
        raise ValueError(f"{place}: no touches; at least one")
    for number, touch in enumerate(touches):
        if hasattr(touch, "columns") and list(touch.columns) != list(getattr(touches[0], "columns", [])):
            raise ValueError(f"{place}, touch {number}: other columns than those of touch 0, or in another order; equal columns")
    arrays = [as_numbers(f"{place}, touch {number}", as_array(f"{place}, touch {number}", touch)) for number, touch in enumerate(touches)]
    # A touch is its frames, or a single frame.
    own = 0 if arrays[0].ndim == 1 else 1
    for number, array in enumerate(arrays):
        if array.ndim != arrays[0].ndim or array.shape[own:] != arrays[0].shape[own:]:
            given = f"shape {array.shape}; {('n_frames', *arrays[0].shape[1:]) if own else arrays[0].shape}, as touch 0 has"
            raise ValueError(f"{place}, touch {number}: {given}".replace("'", ""))
    lengths = np.array([len(touch) for touch in arrays])
    if len(set(lengths.tolist())) == 1:
        return np.stack(arrays), None
    kind = np.result_type(np.float32, *{array.dtype for array in arrays})
    frames = np.full((len(arrays), int(lengths.max()), *arrays[0].shape[1:]), np.nan, dtype=kind)
    for touch, array in zip(frames, arrays, strict=True):
        touch[: len(array)] = array
    return frames, lengths
