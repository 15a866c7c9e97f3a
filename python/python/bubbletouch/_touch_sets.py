"""Touches of several files, joined to one recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bubbletouch._arrays import Array, padded
from bubbletouch.recorded import Recorded


# Order of the axes of touches that are joined from their frames, by the number of axes.
_ORDERS = {3: "n t c", 4: "n t y x"}


@dataclass
class Part:
    """Touches of one file: for each sensor a list of touches, or an array whose first axis is the touch."""

    sensors: dict[str, list[Array] | Array]
    labels: Array | None
    groups: Array | None
    place: str


def by_touch(
    place: str,
    sensors: Mapping[str, list[Array] | Array],
    columns: tuple[Array, Array | None, Array | None],
    names: tuple[str | None, str | None],
) -> Part:
    """Divides rows into touches, in the order of their first rows. The first of the columns has the touch of each row, or the end of each touch. Labels and
    groups have a value for each row or for each touch.
    """
    n_rows = len(next(iter(sensors.values())))
    of_rows = columns[0]
    if len(of_rows) != n_rows:
        ends = of_rows
        if ends.dtype.kind not in "iu" or not len(ends) or ends[-1] != n_rows or np.any(np.diff(ends, prepend=0) <= 0):
            raise ValueError(f"{place}, touches: shape {ends.shape}; the touch of each of {n_rows} rows, or the ascending ends of the touches")
        of_rows = np.repeat(np.arange(len(ends)), np.diff(ends, prepend=0))
    touches, first, numbers = np.unique(of_rows, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rows = [np.flatnonzero(numbers == touch) for touch in order]

    def of_touches(values: Array | None, name: str | None) -> Array | None:
        if values is None or len(values) == len(touches) != n_rows:
            return values
        if len(values) != n_rows:
            raise ValueError(f"{place}, `{name}`: shape {values.shape}; a value for each of {n_rows} rows or {len(touches)} touches")
        for touch, own in zip(order, rows, strict=True):
            if len(np.unique(values[own])) > 1:
                given = ", ".join(map(str, np.unique(values[own])[:3]))
                raise ValueError(f"{place}, `{name}`: {given} in touch {touches[touch]}; one value for all rows of a touch")
        return values[np.sort(first)]

    divided: dict[str, list[Array] | Array] = {name: [np.asarray(frames)[own] for own in rows] for name, frames in sensors.items()}
    return Part(divided, of_touches(columns[1], names[0]), of_touches(columns[2], names[1]), place)


def joined(places: list[str], parts: list[Part], how: tuple[bool, str | Mapping[str, str] | None]) -> Recorded:
    """Joins the touches of all files."""
    are_sensors, order = how
    frames: dict[str, Array] = {}
    lengths: Array | None = None
    orders: dict[str, str] = dict(order) if isinstance(order, Mapping) else {}
    for name in parts[0].sensors:
        own = [part.sensors[name] for part in parts]
        frames[name], lengths_of = _padded(places, own, name)
        lengths = lengths if lengths_of is None else lengths_of
        # The first axes of frames that were joined to touches are touch and time.
        if isinstance(own[0], list) and frames[name].ndim in _ORDERS and order is None:
            orders[name] = _ORDERS[frames[name].ndim]
    if order is None and orders:
        order = orders if are_sensors else next(iter(orders.values()))
    n_of = [len(next(iter(part.sensors.values()))) for part in parts]

    def values(of: Callable[[Part], Array | None]) -> Array | None:
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


def _padded(places: list[str], parts: Sequence[list[Array] | Array], name: str) -> tuple[Array, Array | None]:
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
    return padded(f"{places[0]}, frames {name}", [touch for _, touch in touches])


def _same_shape(place: str, name: str, given: tuple[int, ...], allowed: tuple[int, ...]) -> None:
    if given != allowed:
        raise ValueError(f"{place}, frames {name}: frames of shape {given}; {allowed}, as other touches have")
