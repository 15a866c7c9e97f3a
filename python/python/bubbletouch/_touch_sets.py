"""Touches of several files, joined to one recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os.path import commonpath
from pathlib import Path
from typing import Any

import numpy as np

from bubbletouch._arrays import Array, padded
from bubbletouch.recorded import Recorded


# Order of the axes of touches that are joined from their frames, by the number of axes.
_ORDERS = {3: "n t c", 4: "n t y x"}


@dataclass
class Part:
    """Touches of one file: for each sensor a list of touches, or an array whose first axis is the touch; and the names of the touches in the file."""

    sensors: dict[str, list[Array] | Array]
    labels: Array | None
    groups: Array | None
    place: str
    touches: list[str]


def by_touch(
    place: str,
    sensors: Mapping[str, list[Array] | Array],
    columns: tuple[Array, Array | None, Array | None],
    names: tuple[str, str | None, str | None],
    has_labels_by_position: bool,
) -> Part:
    """Divides rows into touches, in the order of the rows. The first of the columns has the touch of each row, or the end of each touch. Labels and groups have
    a value for each row or for each touch; other labels and groups may be joined to the touches by their positions.
    """
    n_rows = len(next(iter(sensors.values())))
    of_rows = columns[0]
    if len(of_rows) != n_rows:
        ends = of_rows
        if ends.dtype.kind not in "iu" or not len(ends) or ends[-1] != n_rows or np.any(np.diff(ends, prepend=0) <= 0):
            raise ValueError(f"{place}, touches: shape {ends.shape}; the touch of each of {n_rows} rows, or the ascending ends of the touches")
        of_rows = np.repeat(np.arange(len(ends)), np.diff(ends, prepend=0))
    # Adjacent rows of one number are a touch.
    first = np.flatnonzero(np.concatenate([[True], of_rows[1:] != of_rows[:-1]]))
    rows = np.split(np.arange(n_rows), first[1:])
    touches = of_rows[first]

    def of_touches(values: Array | None, name: str | None) -> Array | None:
        if values is None:
            return None
        if len(values) == len(rows) != n_rows:
            check_ascending(name)
            return values
        if len(values) != n_rows:
            raise ValueError(f"{place}, `{name}`: shape {values.shape}; a value for each of {n_rows} rows or {len(rows)} touches")
        for touch, own in zip(touches, rows, strict=True):
            if len(np.unique(values[own])) > 1:
                given = ", ".join(map(str, np.unique(values[own])[:3]))
                raise ValueError(f"{place}, `{name}`: {given} in touch {touch}; one value for all rows of a touch")
        return values[first]

    def check_ascending(name: str | None) -> None:
        if touches.dtype.kind in "iu" and np.any(np.diff(touches) <= 0):
            at = int(np.flatnonzero(np.diff(touches) <= 0)[0])
            given = f"a value for each touch, but touch {touches[at]} comes before touch {touches[at + 1]}"
            raise ValueError(f"{place}, `{name}`: {given}; a value for each row, or ascending numbers of touches")

    labels, groups = of_touches(columns[1], names[1]), of_touches(columns[2], names[2])
    if has_labels_by_position:
        check_ascending(names[0])
    # Touches of one number are different touches if their labels or groups differ, such as those of two sessions.
    known: dict[tuple[Any, ...], Array] = {}
    for number, own in enumerate(rows):
        key = tuple(values[number] for values in (touches, labels, groups) if values is not None)
        other = known.setdefault(key, own)
        if other is not own:
            given = f"touch {touches[number]} in rows {other[0]} to {other[-1]} and again in rows {own[0]} to {own[-1]}"
            raise ValueError(f"{place}, `{names[0]}`: {given}; adjacent rows for each touch, or groups that differ, such as the session of each row")
    divided: dict[str, list[Array] | Array] = {name: [np.asarray(frames)[own] for own in rows] for name, frames in sensors.items()}
    return Part(divided, labels, groups, place, [str(touch) for touch in touches])


def joined(parts: list[Part], how: tuple[bool, str | Mapping[str, str] | None]) -> Recorded:
    """Joins the touches of all files."""
    are_sensors, order = how
    frames: dict[str, Array] = {}
    lengths: dict[str, Array] = {}
    orders: dict[str, str] = dict(order) if isinstance(order, Mapping) else {}
    places = [part.place for part in parts]
    for name in parts[0].sensors:
        own = [part.sensors[name] for part in parts]
        frames[name], lengths_of = _padded(places, own, name)
        if lengths_of is not None:
            lengths[name] = lengths_of
        # The first axes of frames that were joined to touches are touch and time.
        if isinstance(own[0], list) and frames[name].ndim in _ORDERS and order is None:
            orders[name] = _ORDERS[frames[name].ndim]
    if order is None and orders:
        order = orders if are_sensors else next(iter(orders.values()))
    n_of = [len(part.touches) for part in parts]

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
        # Files of several folders may have one name.
        folder = Path(commonpath([Path(place).parent for place in places]))
        groups = np.repeat([Path(place).relative_to(folder).as_posix() for place in places], n_of)
    # The name of a touch that is a file is the path of the file.
    named = [[touch if len(parts) == 1 else f"{part.place}/{touch}" if touch else part.place for touch in part.touches] for part in parts]
    touches = np.array([name for own in named for name in own])
    said = frames if are_sensors else next(iter(frames.values()))
    of_touches = (lengths if are_sensors else next(iter(lengths.values()))) if lengths else None
    return Recorded(said, values(lambda part: part.labels), groups, order, of_touches, touches=touches)


def _padded(places: list[str], parts: Sequence[list[Array] | Array], name: str) -> tuple[Array, Array | None]:
    """Returns the touches as one array, padded with NaN to the longest touch, and the lengths of touches if they differ."""
    frames = f"frames {name}".rstrip()
    if all(isinstance(part, np.ndarray) for part in parts):
        for place, part in zip(places, parts, strict=True):
            _same_shape(place, frames, np.shape(part)[1:], np.shape(parts[0])[1:])
        return np.concatenate([np.asarray(part) for part in parts]), None
    touches = [(place, np.asarray(touch)) for place, part in zip(places, parts, strict=True) for touch in part]
    for place, touch in touches:
        if touch.ndim < 2:
            raise ValueError(f"{place}, {frames}: shape {touch.shape} of a touch; frames × taxels, or frames × rows × columns")
        _same_shape(place, frames, touch.shape[1:], touches[0][1].shape[1:])
    return padded(f"{places[0]}, {frames}", [touch for _, touch in touches])


def _same_shape(place: str, frames: str, given: tuple[int, ...], allowed: tuple[int, ...]) -> None:
    if given != allowed:
        raise ValueError(f"{place}, {frames}: frames of shape {given}; {allowed}, as other touches have")
