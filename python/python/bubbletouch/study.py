"""Studies and scenes: run() and advise() for studies described in TOML, and simulate() for scenes."""

from __future__ import annotations

import base64
import html
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bubbletouch import _core
from bubbletouch._core import Mesh, Simulation, SphereUnion
from bubbletouch._foreign import Host, Hosted, hosted, identified
from bubbletouch.recorded import Recorded, named, with_files

Callback = Callable[[str, int, int], object]

# Maximum number of table rows shown in a notebook.
_SHOWN = 20


@dataclass(frozen=True)
class Table:
    """Table of results.

    file: name of the file in the folder.
    title: title of the table.
    note: explanation of the table.
    columns: float64 arrays (NaN if a value is absent) and lists of strings, by name.
    """

    file: str
    title: str
    note: str
    columns: dict[str, NDArray[np.float64] | list[str]]

    def __len__(self) -> int:
        return max((len(column) for column in self.columns.values()), default=0)

    def __getitem__(self, column: str) -> NDArray[np.float64] | list[str]:
        """Returns a column. Raises ValueError, which lists the columns, if it does not exist."""
        if column not in self.columns:
            raise ValueError(f"column: `{column}`; {', '.join(self.columns)}")
        return self.columns[column]

    def frame(self) -> Any:
        """Returns the table as a pandas.DataFrame. Raises ImportError without pandas."""
        import pandas

        return pandas.DataFrame(self.columns)

    def polars(self) -> Any:
        """Returns the table as a polars.DataFrame. Raises ImportError without polars."""
        import polars

        return polars.DataFrame(self.columns)

    def _repr_html_(self) -> str:
        """Returns the table as HTML for notebooks, with at most 20 rows."""
        rows = [f"<th>{html.escape(name)}</th>" for name in self.columns]
        lines = [f"<tr>{''.join(rows)}</tr>"]
        for values in zip(*(column[:_SHOWN] for column in self.columns.values()), strict=True):
            cells = (f"{value:.5g}" if isinstance(value, float) else value for value in values)
            lines.append("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>")
        more = f"<p>… {len(self) - _SHOWN} more rows</p>" if len(self) > _SHOWN else ""
        return f"<h4>{html.escape(self.title)}</h4><table>{''.join(lines)}</table>{more}"


class Study(Mapping[str, Table]):
    """Results of a study: a mapping from names to tables ("summary" is summary.csv), and the folder with the charts and report.html."""

    def __init__(
        self,
        folder: Path,
        tables: list[tuple[str, str, str, dict[str, Any]]],
        kept: tempfile.TemporaryDirectory[str] | None = None,
    ) -> None:
        self.folder = folder
        self._tables = {Path(table[0]).stem: Table(*table) for table in tables}
        self._kept = kept

    def __getitem__(self, name: str) -> Table:
        """Returns a table. Raises ValueError, which lists the tables, if it does not exist."""
        if name not in self._tables:
            raise ValueError(f"table: `{name}`; {', '.join(self._tables)}")
        return self._tables[name]

    def get(self, name: str, default: Any = None) -> Any:
        """Returns the table of this name, or the default if it does not exist."""
        return self._tables.get(name, default)

    def __contains__(self, name: object) -> bool:
        return name in self._tables

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    @property
    def charts(self) -> list[Path]:
        """Paths of the chart files (SVG)."""
        return sorted(self.folder.glob("*.svg"))

    def __repr__(self) -> str:
        return f"<bubbletouch.Study in {self.folder}: {', '.join(self._tables)}>"

    def _repr_html_(self) -> str:
        """Returns the summary table and the charts as HTML for notebooks."""
        first = next((name for name in ("summary", *self._tables) if name in self._tables), None)
        shown = "" if first is None else self._tables[first]._repr_html_()
        for chart in self.charts:
            data = base64.b64encode(chart.read_bytes()).decode()
            shown += f'<img alt="{html.escape(chart.stem)}" src="data:image/svg+xml;base64,{data}">'
        return shown


def run(
    study: str | PathLike[str] | Mapping[str, Any],
    out: str | PathLike[str] | None = None,
    *,
    seed: int | None = None,
    callback: Callback | None = None,
    recorded: Recorded | Mapping[str, Any] | None = None,
    classifiers: Mapping[str, Any] | None = None,
    features: Mapping[str, Any] | None = None,
    processes: int = 0,
    fresh: bool = False,
) -> Study:
    """Runs a study on all cores. The tables are bitwise equal to the tables of `bubbletouch run`.

    study: path of a TOML file, or a dict with its tables.
    out: result folder; an interrupted run in this folder is continued. Default: a temporary folder that is deleted with the Study.
    seed: replaces the seed of the study.
    callback: function that is called as callback(stage, n_done, n_total), from any thread, at most 20 times per second. If the callback raises an
    exception, the run ends and the exception is passed on.
    recorded: recorded touches: a Recorded, or a dict with keys of `[recorded]` whose files may be arrays, such as {"frames": frames, "labels": labels}.
    These keys replace the keys of the study. The arrays are stored in the result folder. A list of frames contains touches of unequal length. The key
    `layout` may be a Patch, or positions of taxels, metres, shape (n_taxels, 3), or positions and axes, shape (n_taxels, 6).
    classifiers: estimators with fit(X, y) and predict(X) as in scikit-learn, by name; a tuple (estimator, version) sets the version. The study trains each of
    them beside its own classifiers, on its splits and scaled features. A `random_state` that is None becomes the seed of the trial. If there is a
    predict_proba, decisions on several touches add log-probabilities; otherwise they count votes. One touch is decided by predict. The study's key
    `recognition.parameters.NAME.PARAMETER`, also in `axes`, sets a parameter of a classifier by set_params, and of features as a keyword argument.
    features: functions by name, or tuples (function, version). A function converts frames of m measurements, shape (n, m), to features, shape (n, k). Without
    compression, a frame contains the taxels in rows: frames.reshape(-1, ny, nx).
    processes: number of processes in which estimators and functions run. 0: one call at a time in this process. Results have the same bytes.

    fresh: computes all work items again; the old result folder is renamed to OUT.1, OUT.2, …

    The default version of an estimator or a function is a hash of its source code, its parameters, and the functions and variables of the user's modules
    that it names. Work items of another version are computed again.

    Raises ValueError, which names the key, if the study is invalid; OSError if a file cannot be read or written; KeyboardInterrupt after Ctrl-C.
    The first work item that fails ends the run. Finished work items are kept in `out`.
    """
    if fresh and out is not None:
        _core.rename_old_results(Path(out))
    source, kept = StudySource.of(study, recorded, out, seed)
    host = Host(processes)
    given = hosted(host, identified(classifiers, features))
    try:
        tables = _core.run_study(source.call(source.results, given), callback)
    except ValueError as error:
        raise named(error, source.files) from error.__cause__
    finally:
        host.close()
    return Study(source.results, tables, kept)


@dataclass(frozen=True)
class StudySource:
    """Study to run.

    text, place, name, folder: TOML text of the study, its place in errors, its name, and the folder of its paths.
    seed: replaces the seed of the study; None keeps it.
    results: result folder.
    recorded: keys that replace keys of `[recorded]`.
    files: keys of the arrays in memory, by the paths of their files in the result folder.
    """

    text: str
    place: str
    name: str
    folder: Path
    seed: int | None
    results: Path
    recorded: dict[str, Any]
    files: dict[str, str]

    @classmethod
    def of(
        cls,
        study: str | PathLike[str] | Mapping[str, Any],
        recorded: Recorded | Mapping[str, Any] | None,
        out: str | PathLike[str] | None,
        seed: int | None,
    ) -> tuple[StudySource, tempfile.TemporaryDirectory[str] | None]:
        """Returns a study whose recorded arrays are stored in the result folder, and the temporary folder of its results, if any."""
        kept = tempfile.TemporaryDirectory(prefix="bubbletouch-") if out is None else None
        table = recorded.table() if isinstance(recorded, Recorded) else dict(recorded or {})
        if isinstance(study, Mapping) and isinstance(study.get("recorded"), Mapping):
            # The table of a dict may contain arrays, too.
            table = {**study["recorded"], **table}
            study = {key: value for key, value in study.items() if key != "recorded"}
        text, place, name, folder = _text(study)
        results = Path(kept.name) / name if kept is not None else Path(out or "")
        files: dict[str, str] = {}
        table = with_files(table, results / "recorded", files)
        return cls(text, place, name, folder, seed, results, table, files), kept

    def call(self, out: Path, given: Hosted, *, shard: str | None = None, merges: bool = False, threads: int = 0) -> dict[str, Any]:
        """Returns the argument of run_study, given the result folder, and the classifiers and features."""
        text = _core.with_recorded(self.text, self.place, _json(self.recorded)) if self.recorded else self.text
        study = {"text": text, "place": self.place, "name": self.name, "folder": self.folder, "seed": self.seed, "out": out}
        return study | {"classifiers": given[0], "features": given[1], "shard": shard, "merges": merges, "threads": threads}


def _text(study: str | PathLike[str] | Mapping[str, Any]) -> tuple[str, str, str, Path]:
    """Returns the TOML text of a study, its place in errors, its name, and the folder of its paths."""
    if isinstance(study, Mapping):
        return _core.toml_of(_json(study)), "study", "study", Path()
    path = Path(study)
    return _content(path), str(path), path.stem, path.parent


def _content(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: {error}; a TOML file in UTF-8") from None


def advise(
    results: Study | str | PathLike[str],
    *,
    accuracy: float | None = None,
    reach: float | None = None,
    budget: float | None = None,
    value: str | None = None,
    cost: str | None = None,
    table: str | None = None,
    given: Mapping[str, Any] | None = None,
    worst: bool = False,
    limits: Mapping[str, float] | None = None,
) -> dict[str, Any]:
    """Returns the advised configuration of a study, as `bubbletouch advise --json` does: the cheapest one that is good enough, or the best one within
    a budget.

    results: a Study, or the path of a result folder.
    accuracy, reach, budget: the requirement; one of them. accuracy: minimum accuracy, 0 to 1. reach: required value of another column, in its unit.
    budget: maximum cost, in the unit of the cost column.
    value, cost: columns of the value and the cost; None: the default columns.
    table: file name of the table; None: the default table.
    given: conditions, such as {"noise": 0.05}.
    worst: whether to return one answer for all conditions.
    limits: maximum values of cost columns, such as {"measurements": 64, "decision_time": 500}. If only limits are given, the answer is the best
    configuration within the limits.

    Returns a dict: table, value, cost and answers. Each answer contains a condition and either `refused` or the rows choice, certain and next_up.
    Each row is a dict by column, or None. `certain` is the cheapest configuration whose whole confidence interval is sufficient. `next_up` is the
    cheapest configuration with a better value than `choice`.

    Raises ValueError if there is nothing to choose from or no result, and OSError if a file cannot be read.
    """
    if accuracy is not None:
        if reach is not None or value is not None:
            raise ValueError("accuracy: beside reach or value; one of them")
        reach, value = accuracy, "accuracy"
    folder = results.folder if isinstance(results, Study) else Path(results)
    conditions = [f"{name}={of}" for name, of in (given or {}).items()]
    said: dict[str, Any] = json.loads(_core.advise(folder, reach, budget, value, cost, table, conditions, worst, list((limits or {}).items())))
    return said


def simulate(scene: str | PathLike[str] | Mapping[str, Any]) -> Simulation:
    """Returns the simulation of a scene, before its first frame.

    scene: path of a TOML file, or a dict with its tables; paths in a dict are relative to the working folder. In a dict, the "object" of an object
    may be a Mesh or a SphereUnion instead of a name.

    Raises ValueError, which names the key, if the scene is invalid, and OSError if a file cannot be read. Issues a UserWarning for parts of a robot
    file that are ignored.
    """
    if isinstance(scene, Mapping):
        tables, models = _in_memory(scene)
        return Simulation(_core.toml_of(_json(tables)), "scene", Path(), models)
    path = Path(scene)
    return Simulation(_content(path), str(path), path.parent, {})


def _in_memory(scene: Mapping[str, Any]) -> tuple[Mapping[str, Any], dict[str, Mesh | SphereUnion]]:
    """Returns the scene without its Mesh and SphereUnion objects, and these objects by their names in the scene."""
    models: dict[str, Mesh | SphereUnion] = {}

    def named(given: Any) -> Any:
        if not isinstance(given, Mapping) or not isinstance(given.get("object"), Mesh | SphereUnion):
            return given
        models[str(given.get("name", ""))] = given["object"]
        return {key: value for key, value in given.items() if key != "object"}

    objects = scene.get("objects")
    if not isinstance(objects, list | tuple):
        return scene, models
    return {**scene, "objects": [named(given) for given in objects]}, models


def _json(study: Mapping[str, Any]) -> str:
    """Returns the tables of a study or scene as JSON. Raises ValueError for values that TOML cannot represent."""
    def plain(value: object) -> object:
        if isinstance(value, np.ndarray | np.generic):
            return value.tolist()
        if isinstance(value, Mapping):
            return dict(value)
        if isinstance(value, PathLike):
            return str(value)
        raise ValueError(f"{value!r}; tables, lists, words, numbers and truth values")

    try:
        return json.dumps(dict(study), default=plain, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise ValueError(f"tables: {error}; what TOML can say") from None
