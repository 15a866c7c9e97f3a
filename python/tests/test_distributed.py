"""Tests of studies whose shards are tasks of Dask, Ray or an executor."""

from __future__ import annotations

import os
import pickle
import sys
from concurrent.futures import Executor, ProcessPoolExecutor
from multiprocessing import get_context
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bubbletouch as bt
import bubbletouch.distributed
import numpy as np
import pytest

from conftest import refused
from test_own_classifiers import STUDY, Nearest, noisy

TABLES = ("accuracy", "summary", "confusion", "comparison")


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    cluster = distributed.LocalCluster(n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None)
    with cluster, distributed.Client(cluster) as client:
        # Workers import the classes of these tests.
        client.run(sys.path.insert, 0, str(Path(__file__).parent))
        yield client


RECORDED: dict[str, Any] = {
    "question": "?",
    "trials": 2,
    "skin": {"pitch_mm": 4.0, "stroke_mm": 5.0},
    "signal": {"steps": ["noise"], "noise_std_full_scale": 0.05},
    "sensing": {"measurements": [4, 8]},
    "recognition": {"classifier": ["linear_svm", "nearest_centroid"]},
}


def sensors() -> dict[str, Any]:
    """Returns the table of a recording of two sensors with touches of unequal length."""
    rng = np.random.default_rng(3)
    labels = np.repeat(["cup", "ball", "pen"], 20)
    shift = np.repeat(np.arange(3.0), 20)[:, None, None]
    palm = [frames + shift[touch] for touch, frames in enumerate([rng.normal(0.0, 1.5, (3 + touch % 2, 12)) for touch in range(60)])]
    thumb = rng.normal(0.0, 1.5, (60, 4, 8)) + shift
    parts: list[dict[str, Any]] = [{"name": "palm", "frames": palm, "order": "n t c"}, {"name": "thumb", "frames": thumb, "order": "n t c"}]
    return {"labels": labels, "groups": np.arange(60) // 4, "sensors": parts, "resampled_frames": 2}


def is_same(one: bt.Study, other: bt.Study) -> bool:
    return all((one.folder / f"{table}.csv").read_bytes() == (other.folder / f"{table}.csv").read_bytes() for table in TABLES)


def test_three_workers_give_the_bytes_of_one_process(client: Any, tmp_path: Path) -> None:
    whole = bt.run(STUDY)
    assert is_same(bt.distributed.run(STUDY, client), whole)
    assert is_same(bt.distributed.run(STUDY, client, 7, tmp_path / "out", threads=2), whole)
    assert len(list((tmp_path / "out").glob("journal.*-of-7.jsonl"))) == 7
    assert (tmp_path / "out" / "report.html").exists()
    again = bt.distributed.run(STUDY, client, 7, tmp_path / "out")
    assert is_same(again, whole)


def test_the_shard_of_a_lost_worker_runs_again(client: Any, tmp_path: Path) -> None:
    log = tmp_path / "log"
    # The process of the worker ends at the fourth fit.
    mine = {"mine": (Nearest(log, 4), "1")}
    before = set(client.scheduler_info(n_workers=-1)["workers"])
    found = bt.distributed.run(STUDY, client, 3, classifiers=mine, features={"noisy": noisy})
    assert len(log.read_text().splitlines()) > 3 * 2 * 2 * 2, "some fits ran twice"
    client.wait_for_workers(3, timeout=60)
    assert set(client.scheduler_info(n_workers=-1)["workers"]) != before
    assert is_same(found, bt.run(STUDY, classifiers={"mine": (Nearest(), "1")}, features={"noisy": noisy}))


def test_arrays_are_sent_to_the_workers(client: Any, tmp_path: Path) -> None:
    recorded = sensors()
    # Studies in a file and in a dict; the file has a key that the arrays do not replace.
    file = tmp_path / "study.toml"
    file.write_text(bt._core.toml_of(bt.study._json({**RECORDED, "recorded": {"previous_touch": "none", "sensor": "palm+thumb"}})))
    whole = bt.run(file, recorded=recorded)
    assert is_same(bt.distributed.run(file, client, 5, tmp_path / "out", recorded=recorded), whole)
    assert is_same(bt.distributed.run({**RECORDED, "recorded": recorded}, client, 2), bt.run(RECORDED, recorded=recorded))
    # The same call takes all results from the journals of the shards.
    journals = {path: path.read_bytes() for path in (tmp_path / "out").glob("journal.*-of-5.jsonl")}
    assert len(journals) == 5 and is_same(bt.distributed.run(file, client, 5, tmp_path / "out", recorded=recorded), whole)
    assert journals == {path: path.read_bytes() for path in journals}


def test_arrays_of_a_lost_worker_are_sent_again(client: Any, tmp_path: Path) -> None:
    log = tmp_path / "log"
    recorded = bt.Recorded(np.random.default_rng(5).normal(np.arange(60)[:, None] // 20, 1.0, (60, 16)), np.arange(60) // 20)
    mine = {"mine": (Nearest(log, 2), "1")}
    found = bt.distributed.run(RECORDED, client, 3, recorded=recorded, classifiers=mine)
    assert len(log.read_text().splitlines()) > 2 * 2, "some fits ran twice"
    client.wait_for_workers(3, timeout=60)
    assert is_same(found, bt.run(RECORDED, recorded=recorded, classifiers={"mine": (Nearest(), "1")}))


def test_a_worker_needs_no_file_of_the_calling_process(tmp_path: Path) -> None:
    source, _ = bt.study.StudySource.of(RECORDED, sensors(), tmp_path / "out", None)
    files = {path: Path(path).read_bytes() for path in source.files}
    assert len(files) == 5
    for path in files:
        Path(path).unlink()
    assert bt.distributed.bubbletouch_shard(source, files, pickle.dumps(([], [])), "1/2", b"", 1).count(b"\n") > 1


class Unsendable(Nearest):
    def __reduce__(self) -> Any:
        raise TypeError("a socket")


def test_code_that_cannot_be_sent_to_a_worker_is_refused(client: Any, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="classifier mine: cannot be sent to the workers .TypeError: a socket.; an object"):
        bt.distributed.run(STUDY, client, 2, tmp_path / "out", classifiers={"mine": (Unsendable(), "1")})
    assert not (tmp_path / "out").exists()
    # Lambdas and closures are sent by value.
    factor = 3.0
    pytest.importorskip("cloudpickle")
    scaled = {"scaled": (lambda frames: factor * np.abs(frames), "1")}
    study = {**RECORDED, "trials": 1}
    recorded = {"frames": np.random.default_rng(5).normal(np.arange(60)[:, None] // 20, 1.0, (60, 16)), "labels": np.arange(60) // 20}
    assert is_same(bt.distributed.run(study, client, 2, recorded=recorded, features=scaled), bt.run(study, recorded=recorded, features=scaled))
    code = pickle.dumps(([], [])).replace(b".", b"cno_such_module\nthing\n.")
    source, _ = bt.study.StudySource.of(STUDY, None, tmp_path / "out", None)
    with pytest.raises(ValueError, match="cannot be loaded on a worker .ModuleNotFoundError: No module named 'no_such_module'.; code that all workers"):
        bt.distributed.bubbletouch_shard(source, {}, code, "1/1", b"", 1)


class Failing(Nearest):
    def fit(self, rows: Any, labels: Any) -> None:
        raise ArithmeticError("no convergence")


def test_an_error_of_a_task_is_the_error_of_the_run(client: Any, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="study, configuration .*, trial .*classifier mine: ArithmeticError: no convergence"):
        bt.distributed.run(STUDY, client, 2, tmp_path / "out", classifiers={"mine": Failing()})
    assert not (tmp_path / "out" / "summary.csv").exists()
    refused("n_shards: 0; at least 1", lambda: bt.distributed.run(STUDY, client, 0))
    refused("client: None; a dask.distributed.Client", lambda: bt.distributed.run(STUDY, None), TypeError)


def test_any_executor_runs_the_shards() -> None:
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as executor:
        assert isinstance(executor, Executor)
        assert is_same(bt.distributed.run(STUDY, executor, 3), bt.run(STUDY))
        assert is_same(bt.distributed.run(RECORDED, executor, 2, recorded=sensors()), bt.run(RECORDED, recorded=sensors()))


@pytest.fixture(scope="module")
def ray_executor() -> Iterator[Any]:
    ray = pytest.importorskip("ray")
    # Workers import the classes of these tests.
    paths = {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    ray.init(num_cpus=3, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": paths})
    yield bt.distributed.RayExecutor()
    ray.shutdown()


def test_three_workers_of_ray_give_the_bytes_of_one_process(ray_executor: Any, tmp_path: Path) -> None:
    assert ray_executor.n_threads == 3
    assert is_same(bt.distributed.run(STUDY, ray_executor, out=tmp_path / "out"), bt.run(STUDY))
    assert len(list((tmp_path / "out").glob("journal.*-of-3.jsonl"))) == 3


def test_arrays_are_sent_to_the_workers_of_ray(ray_executor: Any, tmp_path: Path) -> None:
    assert is_same(bt.distributed.run(RECORDED, ray_executor, 3, recorded=sensors()), bt.run(RECORDED, recorded=sensors()))


def test_ray_runs_the_shard_of_a_lost_worker_again(ray_executor: Any, tmp_path: Path) -> None:
    log = tmp_path / "log"
    mine = {"mine": (Nearest(log, 4), "1")}
    found = bt.distributed.run(STUDY, ray_executor, 3, classifiers=mine, features={"noisy": noisy})
    assert len(log.read_text().splitlines()) > 3 * 2 * 2 * 2, "some fits ran twice"
    assert is_same(found, bt.run(STUDY, classifiers={"mine": (Nearest(), "1")}, features={"noisy": noisy}))


def test_an_error_of_a_task_of_ray_is_the_error_of_the_run(ray_executor: Any) -> None:
    with pytest.raises(ValueError, match="study, configuration .*, trial .*classifier mine: ArithmeticError: no convergence"):
        bt.distributed.run(STUDY, ray_executor, 2, classifiers={"mine": Failing()})


def test_an_interrupted_run_goes_on_with_the_journals_of_its_shards(tmp_path: Path) -> None:
    log = tmp_path / "log"
    study = {**STUDY, "signal": {"noise_std_full_scale": 0.05}}
    n_all = 3 * 2

    def n_fits(begun: bytes) -> tuple[int, bytes]:
        log.write_text("")
        given = bt._foreign.identified({"mine": (Nearest(log), "1")}, None)
        source, _ = bt.study.StudySource.of(study, None, tmp_path / "out", None)
        journal = bt.distributed.bubbletouch_shard(source, {}, pickle.dumps(given), "1/1", begun, 1)
        return len(log.read_text().splitlines()), journal

    n, journal = n_fits(b"")
    assert n == n_all
    lines = journal.splitlines(keepends=True)
    assert 0 < n_fits(b"".join(lines[: len(lines) // 2]))[0] < n_all
    n, again = n_fits(journal)
    assert n == 0 and sorted(again.splitlines()) == sorted(journal.splitlines())
