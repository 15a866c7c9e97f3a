"""Reader of touches in LeRobot folders of the formats v2 (a file for each episode) and v3 (many episodes in a file)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from bubbletouch._array_files import is_hidden, natural, of_column, optional_package
from bubbletouch._arrays import Array, as_keys, as_numbers
from bubbletouch._touch_sets import by_touch, joined
from bubbletouch.recorded import Recorded


def of_lerobot(
    folder: Path,
    frames: str | Sequence[str] | Mapping[str, str | Sequence[str]] | None,
    names: tuple[str | None, str | None, str | None, str | Mapping[str, str] | None],
    has_labels_by_position: bool,
) -> Recorded:
    """Reads a LeRobot folder of format v2 (a file for each episode) or v3 (many episodes in a file). Other labels and groups may be joined by positions."""
    parquet = optional_package("pyarrow.parquet", folder)
    pyarrow = optional_package("pyarrow", folder)
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
    found = [file for file in (folder / "data").rglob("*.parquet") if not is_hidden(file, folder)]
    files = sorted(found, key=lambda file: natural(file.relative_to(folder).as_posix()))
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

    def column(name: str) -> Array:
        try:
            return of_column(table.column(name))
        except (ValueError, pyarrow.ArrowException) as error:
            raise ValueError(f"{folder}, feature `{name}`: {error}") from None

    sensors: dict[str, list[Array] | Array] = {}
    for name, feature in wanted.items():
        values = as_numbers(f"{folder}, feature `{feature}`", column(feature))
        shape = tuple(features[feature].get("shape") or values.shape[1:])
        if values.size != len(values) * int(np.prod(shape)):
            raise ValueError(f"{folder}, feature `{feature}`: rows of shape {values.shape[1:]}; {shape}, as {info_file} says")
        values = values.reshape(len(values), *shape)
        # A row of `write_lerobot` has a window of touch frames, newest last, beside the points of the taxels.
        points = features.get(feature.replace("observation.touch.", "observation.points."), {}).get("shape")
        is_window = feature.startswith("observation.touch.") and len(shape) == 2 and list(points or ()) == [shape[1], 6]
        sensors[name] = values[:, -1] if is_window else values
    numbers = as_keys(f"{folder}, feature `{touches or 'episode_index'}`", column(touches or "episode_index"))
    if "frame_index" in table.column_names:
        # Rows of an episode are in order of time, whatever the order of the files.
        in_time = np.lexsort((column("frame_index").ravel(), column("episode_index").ravel()))
    else:
        in_time = np.argsort(column("episode_index").ravel(), kind="stable")

    def keys(name: str | None, default: str | None) -> tuple[Array | None, str | None]:
        name = name or default
        if name is None or name not in table.column_names:
            return None, None
        values = as_keys(f"{folder}, feature `{name}`", column(name))[in_time]
        return (_tasks(folder, values) if name == "task_index" else values), name

    of_labels, label = keys(labels, "task_index")
    of_groups, group = keys(groups, None if touches is None else "episode_index")
    rows = {name: np.asarray(values)[in_time] for name, values in sensors.items()}
    named = (touches or "episode_index", label, group)
    part = by_touch(str(folder), rows, (numbers[in_time], of_labels, of_groups), named, has_labels_by_position)
    return joined([part], (isinstance(frames, Mapping), order))


def _tasks(folder: Path, numbers: Array) -> Array:
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
            columns = optional_package("pyarrow.parquet", folder).read_table(table).to_pydict()
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
