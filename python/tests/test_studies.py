"""Tests of studies."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest

from conftest import Command, refused

STUDY: dict[str, Any] = {
    "question": "How many measurements tell cans apart?",
    "trials": 2,
    "objects": {"sets": ["cans"], "surface_error_mm": 1.0},
    "skin": {"pitch_mm": 4.0, "size_mm": 64.0, "stroke_mm": 5.0},
    "touches": {"per_object": 8, "offset_x_mm": {"uniform": [-8.0, 8.0]}, "depth_mm": 3.0},
    "signal": {"noise_std_full_scale": [0.0, 0.05]},
    "sensing": {"ensemble": "sbhe", "ratio": np.array([4, 16])},
    "recognition": {"classifier": "linear_svm"},
}


def text_of(study: dict[str, Any]) -> str:
    return bt._core.toml_of(bt.study._json(study))


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> bt.Study:
    return bt.run(STUDY, tmp_path_factory.mktemp("study") / "cans")


def test_a_study_has_tables_charts_and_a_page(study: bt.Study) -> None:
    assert {"accuracy", "summary", "confusion"} <= set(study)
    summary = study["summary"]
    assert len(summary) == 4 and set(summary["ratio"]) == {4.0, 16.0}
    accuracy = np.asarray(summary["accuracy_mean"] if "accuracy_mean" in summary.columns else summary["accuracy"])
    assert ((accuracy > 1 / 9) & (accuracy <= 1)).all()
    assert study.charts and (study.folder / "report.html").exists()
    page = study._repr_html_()
    assert "<table>" in page and "data:image/svg+xml;base64," in page
    assert study.get("costs") is None and study.get("summary") is summary
    refused("table: `costs`; .*summary", lambda: study["costs"])
    refused("column: `price`; ", lambda: summary["price"])


def test_tables_become_data_frames(study: bt.Study) -> None:
    pandas = pytest.importorskip("pandas")
    frame = study["accuracy"].frame()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == len(study["accuracy"]) == 8
    assert set(frame["object" if "object" in frame else "ensemble"])


def test_tables_become_polars_frames(study: bt.Study) -> None:
    polars = pytest.importorskip("polars")
    table = study["accuracy"]
    frame = table.polars()
    assert isinstance(frame, polars.DataFrame) and frame.columns == list(table.columns) and len(frame) == len(table)
    for name, column in table.columns.items():
        assert np.array_equal(frame[name].to_numpy(), column, equal_nan=isinstance(column, np.ndarray)), name


def test_the_same_tables_as_the_commands(study: bt.Study, tmp_path: Path, command: Command) -> None:
    path = tmp_path / "cans.toml"
    path.write_text(text_of(STUDY))
    command("run", path, "--out", tmp_path / "out")
    again = bt.run(path, tmp_path / "again")
    for name in ("accuracy", "summary", "confusion"):
        expected = (tmp_path / "out" / f"{name}.csv").read_bytes()
        assert (study.folder / f"{name}.csv").read_bytes() == expected
        assert (again.folder / f"{name}.csv").read_bytes() == expected
    assert (tmp_path / "out" / "study.toml").read_bytes() == (again.folder / "study.toml").read_bytes()


def test_advice_is_the_cheapest_that_is_good_enough(study: bt.Study) -> None:
    advice = bt.advise(study, accuracy=0.5)
    rows = study[Path(advice["table"]).stem]
    accuracy, cost = (np.asarray(rows[advice[key]], float) for key in ("value", "cost"))
    # Each choice is the cheapest configuration of its condition; the cheapest choice is the cheapest sufficient row of the table.
    choices = [answer["choice"] for answer in advice["answers"] if "choice" in answer]
    assert min(choice[advice["cost"]] for choice in choices) == cost[accuracy >= 0.5].min()
    assert all(choice[advice["value"]] >= 0.5 for choice in choices)
    answers = bt.advise(study.folder, budget=cost.max())["answers"]
    assert max(answer["choice"][advice["value"]] for answer in answers) == accuracy.max()
    (worst,) = bt.advise(study, budget=cost.max(), worst=True)["answers"]
    assert worst["choice"][advice["value"]] <= accuracy.max()
    refused("one of accuracy, reach and budget", lambda: bt.advise(study))
    refused("at most 1", lambda: bt.advise(study, accuracy=1.5))
    refused("wind", lambda: bt.advise(study, accuracy=0.5, given={"wind": 3}))
    refused("nowhere", lambda: bt.advise(study.folder / "nowhere", accuracy=0.5))


def test_a_run_goes_on_where_it_was(study: bt.Study) -> None:
    start = time.perf_counter()
    again = bt.run(STUDY, study.folder)
    assert time.perf_counter() - start < 20
    np.testing.assert_array_equal(again["summary"]["ratio"], study["summary"]["ratio"])
    other = STUDY | {"trials": 3}
    other["objects"] = {"sets": ["balls"], "surface_error_mm": 1.0}
    refused("journal", lambda: bt.run(other, study.folder))


def test_a_temporary_folder_goes_with_the_study() -> None:
    study = bt.run(STUDY, seed=5)
    folder = study.folder
    assert (folder / "summary.csv").exists()
    del study
    assert not folder.exists()


def test_a_callback_hears_how_far_it_is_and_may_end_it(tmp_path: Path) -> None:
    heard: list[tuple[str, int, int]] = []
    bt.run(STUDY, tmp_path / "heard", callback=lambda *said: heard.append(said))
    stages = {stage for stage, _, _ in heard}
    assert "report" in stages and len(stages) > 1
    assert all(0 <= done <= total for _, done, total in heard)

    def refuse(stage: str, done: int, total: int) -> None:
        raise LookupError("enough")

    refused("enough", lambda: bt.run(STUDY, tmp_path / "refused", callback=refuse), LookupError)


def test_ctrl_c_ends_a_study_and_the_next_run_goes_on(tmp_path: Path) -> None:
    import os
    import signal

    long = STUDY | {"trials": 60, "touches": STUDY["touches"] | {"per_object": 200}}
    sent: list[float] = []

    def press_ctrl_c() -> None:
        time.sleep(1.0)
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=press_ctrl_c)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        bt.run(long, tmp_path / "long")
        time.sleep(5)
    # Ctrl-C takes 0.2 s on an idle machine; the whole study would take much longer.
    assert time.perf_counter() - sent[0] < 5
    thread.join()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"skin": STUDY["skin"] | {"pitch_mm": -1.0}}, "skin.pitch_mm"),
        ({"sensing": {"ensemble": "wavelet"}}, "wavelet"),
        ({"extra": 1}, "extra"),
        ({"trials": float("nan")}, "tables: .*; what TOML can say"),
        ({"trials": {1, 2}}, "tables: "),
        ({"trials": None}, "study: "),
    ],
)
def test_what_cannot_be_run_is_refused_by_its_key(
    tmp_path: Path, change: dict[str, Any], said: str
) -> None:
    refused(said, lambda: bt.run(STUDY | change, tmp_path / "refused"))


def test_files_that_are_not_there_are_oserrors(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        bt.run(tmp_path / "missing.toml")
    (tmp_path / "latin.toml").write_bytes("question = 'größe'".encode("latin-1"))
    for read in (bt.run, bt.simulate):
        refused(r"latin\.toml: 'utf-8' codec can't decode .*; a TOML file in UTF-8", lambda read=read: read(tmp_path / "latin.toml"))
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(OSError):
        bt.run(STUDY, file / "below")


