"""Studies: a question in TOML, tables and charts as answer; and scenes."""

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

Callback = Callable[[str, int, int], object]

# Rows that a notebook shows of a table.
_SHOWN = 20


@dataclass(frozen=True)
class Table:
    """A table of results.

    file: its name in the folder; title, note: what it holds, and how to read it; columns: float64 arrays (NaN where absent) and lists of words.
    """

    file: str
    title: str
    note: str
    columns: dict[str, NDArray[np.float64] | list[str]]

    def __len__(self) -> int:
        return max((len(column) for column in self.columns.values()), default=0)

    def __getitem__(self, column: str) -> NDArray[np.float64] | list[str]:
        """A column. Raises ValueError, which lists them."""
        if column not in self.columns:
            raise ValueError(f"column: `{column}`; {', '.join(self.columns)}")
        return self.columns[column]

    def frame(self) -> Any:
        """As a pandas.DataFrame. Raises ImportError without pandas."""
        import pandas

        return pandas.DataFrame(self.columns)

    def polars(self) -> Any:
        """As a polars.DataFrame. Raises ImportError without polars."""
        import polars

        return polars.DataFrame(self.columns)

    def _repr_html_(self) -> str:
        rows = [f"<th>{html.escape(name)}</th>" for name in self.columns]
        lines = [f"<tr>{''.join(rows)}</tr>"]
        for values in zip(*(column[:_SHOWN] for column in self.columns.values()), strict=True):
            cells = (f"{value:.5g}" if isinstance(value, float) else value for value in values)
            lines.append("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>")
        more = f"<p>… {len(self) - _SHOWN} more rows</p>" if len(self) > _SHOWN else ""
        return f"<h4>{html.escape(self.title)}</h4><table>{''.join(lines)}</table>{more}"


class Study(Mapping[str, Table]):
    """What came of a study: its tables by name ("summary" is that of summary.csv), and the folder with charts and report.html."""

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
        """A table. Raises ValueError, which lists them."""
        if name not in self._tables:
            raise ValueError(f"table: `{name}`; {', '.join(self._tables)}")
        return self._tables[name]

    def get(self, name: str, default: Any = None) -> Any:
        """A table, or the default where there is none of that name."""
        return self._tables.get(name, default)

    def __contains__(self, name: object) -> bool:
        return name in self._tables

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    @property
    def charts(self) -> list[Path]:
        """Files of charts as SVG."""
        return sorted(self.folder.glob("*.svg"))

    def __repr__(self) -> str:
        return f"<bubbletouch.Study in {self.folder}: {', '.join(self._tables)}>"

    def _repr_html_(self) -> str:
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
) -> Study:
    """Runs a study, on all cores: the same tables, bit by bit, as `bubbletouch run`.

    study: a TOML file, or its tables as a dict. out: the folder of results, where an interrupted run goes on (None: a temporary one, which
    goes with the Study). seed: replaces the study's. callback: is told the stage, how many of its steps are done, and of how many, from
    any thread and at most 20 times a second; what it raises ends the run.

    Raises ValueError for what cannot be run, by key; OSError for files; what a callback raises; KeyboardInterrupt for Ctrl-C, and what is
    finished by then is kept in `out`. The first work item that fails ends the run.
    """
    if isinstance(study, Mapping):
        text, name, folder = _core.toml_of(_json(study)), "study", Path()
        place = name
    else:
        path = Path(study)
        text, name, folder, place = path.read_text(encoding="utf-8"), path.stem, path.parent, str(path)
    kept = tempfile.TemporaryDirectory(prefix="bubbletouch-") if out is None else None
    results = Path(kept.name) / name if kept is not None else Path(out or "")
    tables = _core.run_study(text, place, name, folder, results, seed, callback)
    return Study(results, tables, kept)


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
    """Which setting of a study to take, as `bubbletouch advise --json` says: the cheapest that is good enough, or the best that is cheap enough.

    results: a Study, or a folder of results. One of accuracy (a share), reach (of another value, in its unit) and budget (the most that it may
    cost, in the unit of its column). value, cost, table: columns and a table's file, if not the usual ones. given: conditions, such as
    {"noise": 0.05}. worst: one answer for all conditions. limits: the largest values of columns of costs, such as {"measurements": 64,
    "decision_time": 500}; with limits alone, the answer is the best that they allow.

    A dict: table, value, cost, and answers, each with a condition and choice, certain and next_up (rows by column, or None), or refused.
    Raises ValueError where no choice is, and where there are no results; OSError for files that cannot be read.
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
    """A scene, ready for its first frame: a TOML file, or its tables as a dict (paths in it are then relative to the working folder).

    The "object" of one of a dict's objects may be a Mesh or a SphereUnion in place of a name; it is touched as it is.

    Raises ValueError for what cannot be simulated, by key; OSError for a file that cannot be read. Warns (UserWarning) of what is not read of a
    robot's file.
    """
    if isinstance(scene, Mapping):
        tables, models = _in_memory(scene)
        return Simulation(_core.toml_of(_json(tables)), "scene", Path(), models)
    path = Path(scene)
    return Simulation(path.read_text(encoding="utf-8"), str(path), path.parent, {})


def _in_memory(scene: Mapping[str, Any]) -> tuple[Mapping[str, Any], dict[str, Mesh | SphereUnion]]:
    """A scene without its objects in memory, and these by their names in it."""
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
