"""Writer of LeRobot datasets, format v3.0, from recordings.

Touch is recorded at a higher rate than video. A row of the dataset is an instant of the video clock and contains the latest touch frames up to this
instant. The features of each patch are:

- observation.touch.NAME: (window, m), the quantity measured by the taxels, newest frame last; `read_recorded` reads the newest frame;
- observation.points.NAME: (m, 6), for each taxel its position x, y, z in metres and the force Fx, Fy, Fz on it in newtons, in the world frame;
- observation.pose.NAME: (7,), pose of the patch in the world.

Needs pyarrow and pandas.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bubbletouch._numbers import whole
from bubbletouch.recording import Recording

__all__ = ["write_lerobot"]

# Tolerance for a touch frame that is later than its row, seconds: times are sums of steps and contain rounding errors.
_LATE = 1e-6
_FILE = "chunk-000/file-000.parquet"
_PLACE = {"chunk_index": 0, "file_index": 0}


def write_lerobot(
    folder: str | PathLike[str],
    episodes: Sequence[Recording],
    *,
    fps: int,
    window: int = 5,
    quantity: Literal["deflection", "force", "signal"] = "force",
    robot: str = "unknown",
) -> None:
    """Writes recordings of the same patches as a dataset, one episode per recording. The titles of the recordings are the tasks.

    folder: folder of the new dataset.
    fps: rows per second, usually the frame rate of the video. Recordings must have at least this frame rate.
    window: number of touch frames per row. Before the start of an episode, the first frame is repeated.
    quantity: quantity of observation.touch: deflection, force or signal.
    robot: type of the robot, for the metadata.

    Raises ValueError for invalid arguments and recordings, FileExistsError if the folder already contains a dataset, and ImportError without
    pyarrow and pandas.
    """
    import pandas as pd
    import pyarrow as pa
    import pyarrow.parquet as pq

    if not episodes:
        raise ValueError("episodes: none; at least one")
    fps, window = whole("fps", fps, least=1), whole("window", window, least=1)
    shapes = {name: felt.patch.n_taxels for name, felt in episodes[0].patches.items()}
    tasks = list(dict.fromkeys(episode.title for episode in episodes))
    parts: list[dict[str, NDArray[Any]]] = []
    for number, episode in enumerate(episodes):
        if {name: felt.patch.n_taxels for name, felt in episode.patches.items()} != shapes:
            raise ValueError(f"episodes[{number}]: other patches; those of the first: {shapes}")
        columns = _columns(number, episode, (fps, window, quantity))
        n_rows = len(columns["timestamp"])
        n_before = sum(len(part["timestamp"]) for part in parts)
        numbers = {"episode_index": number, "task_index": tasks.index(episode.title)}
        columns |= {name: np.full(n_rows, value) for name, value in numbers.items()}
        columns |= {"frame_index": np.arange(n_rows), "index": n_before + np.arange(n_rows)}
        parts.append(columns)
    rows = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    ends = np.cumsum([len(part["timestamp"]) for part in parts])

    root = Path(folder)
    for place in ("data/chunk-000", "meta/episodes/chunk-000"):
        (root / place).mkdir(parents=True, exist_ok=place != "data/chunk-000")
    pq.write_table(pa.table({name: _lists(values) for name, values in rows.items()}), root / "data" / _FILE)
    about = {
        "episode_index": range(len(episodes)),
        "tasks": [[episode.title] for episode in episodes],
        "length": np.diff(ends, prepend=0),
        "dataset_from_index": np.concatenate([[0], ends[:-1]]),
        "dataset_to_index": ends,
    } | {f"{where}/{key}": np.zeros(len(episodes), int) for where in ("data", "meta/episodes") for key in _PLACE}
    pq.write_table(pa.table(about), root / "meta" / "episodes" / _FILE)
    named = pd.DataFrame({"task_index": range(len(tasks))}, index=pd.Index(tasks, name="task"))
    named.to_parquet(root / "meta" / "tasks.parquet")
    _write_json(root / "meta" / "info.json", _info(rows, (fps, robot), (len(episodes), len(tasks))))
    _write_json(root / "meta" / "stats.json", {name: _stats(values) for name, values in rows.items()})


def _columns(
    number: int, episode: Recording, given: tuple[int, int, Literal["deflection", "force", "signal"]]
) -> dict[str, NDArray[Any]]:
    """Returns the features of all rows of an episode, by name. given: fps, window and quantity."""
    fps, window, quantity = given
    time = episode.time - episode.time[0]
    if len(time) > 1 and (longest := np.diff(time).max()) > 1 / fps + _LATE:
        raise ValueError(f"episodes[{number}]: a frame {longest:.4g} s after the last; at least {fps} frames a second")
    at = np.arange(int(time[-1] * fps + _LATE) + 1) / fps
    newest = np.searchsorted(time, at + _LATE, side="right") - 1
    windows = np.maximum(newest[:, None] + np.arange(1 - window, 1), 0)
    columns: dict[str, NDArray[Any]] = {"timestamp": at.astype(np.float32)}
    for name, felt in episode.patches.items():
        values = {"deflection": felt.deflection, "force": felt.force, "signal": felt.signal}.get(quantity)
        if values is None:
            raise ValueError(f"quantity: {quantity}, which patch `{name}` has not; deflection or force")
        columns[f"observation.touch.{name}"] = values.reshape(len(time), -1)[windows].astype(np.float32)
        columns[f"observation.points.{name}"] = felt.points()[newest].astype(np.float32)
        columns[f"observation.pose.{name}"] = felt.pose[newest].astype(np.float32)
    return columns


def _lists(values: NDArray[Any]) -> Any:
    """Returns the values as a pyarrow column; rows with several dimensions become nested fixed-size lists."""
    import pyarrow as pa

    column = pa.array(values.ravel())
    for side in reversed(values.shape[1:]):
        column = pa.FixedSizeListArray.from_arrays(column, side)
    return column


def _info(rows: Mapping[str, NDArray[Any]], clock: tuple[int, str], counts: tuple[int, int]) -> dict[str, Any]:
    """Returns the content of meta/info.json. clock: fps and robot. counts: numbers of episodes and tasks."""
    (fps, robot), (n_episodes, n_tasks) = clock, counts

    def feature(name: str, values: NDArray[Any]) -> dict[str, Any]:
        axes = ["x", "y", "z", "qw", "qx", "qy", "qz"] if name.startswith("observation.pose.") else None
        return {"dtype": values.dtype.name, "shape": list(values.shape[1:]) or [1], "names": axes}

    return {
        "codebase_version": "v3.0",
        "robot_type": robot,
        "total_episodes": n_episodes,
        "total_frames": len(rows["index"]),
        "total_tasks": n_tasks,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": fps,
        "splits": {"train": f"0:{n_episodes}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": None,
        "features": {name: feature(name, values) for name, values in rows.items()},
    }


def _stats(values: NDArray[Any]) -> dict[str, Any]:
    """Returns the minimum, maximum, mean and standard deviation of each component of a feature over all rows, and the number of rows."""
    rows = values.reshape(len(values), -1) if values.ndim == 1 else values
    measures: dict[str, Callable[..., Any]] = {"min": np.min, "max": np.max, "mean": np.mean, "std": np.std}
    return {name: measure(rows, axis=0).tolist() for name, measure in measures.items()} | {"count": [len(rows)]}


def _write_json(path: Path, value: Mapping[str, Any]) -> None:
    path.write_text(json.dumps(value, indent=4, ensure_ascii=False), encoding="utf-8")
