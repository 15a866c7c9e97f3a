"""Tests of studies whose shards are tasks of Dask, Ray or an executor."""

from __future__ import annotations

import os
import sys
from concurrent.futures import Executor, ProcessPoolExecutor
from multiprocessing import get_context
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bubbletouch as bt
import bubbletouch.distributed
import pytest

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


class Failing(Nearest):
    def fit(self, rows: Any, labels: Any) -> None:
        raise ArithmeticError("no convergence")


def test_an_error_of_a_task_is_the_error_of_the_run(client: Any, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="study, configuration .*, trial .*classifier mine: ArithmeticError: no convergence"):
        bt.distributed.run(STUDY, client, 2, tmp_path / "out", classifiers={"mine": Failing()})
    assert not (tmp_path / "out" / "summary.csv").exists()
    with pytest.raises(ValueError, match="n_shards: 0; at least 1"):
        bt.distributed.run(STUDY, client, 0)


def test_any_executor_runs_the_shards() -> None:
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as executor:
        assert isinstance(executor, Executor)
        assert is_same(bt.distributed.run(STUDY, executor, 3), bt.run(STUDY))


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
        text, place, name, folder = bt.study._text(study)
        call = {"text": text, "place": place, "name": name, "folder": folder, "seed": None}
        journal = bt.distributed.bubbletouch_shard(call, given, "1/1", begun, 1)
        return len(log.read_text().splitlines()), journal

    n, journal = n_fits(b"")
    assert n == n_all
    lines = journal.splitlines(keepends=True)
    assert 0 < n_fits(b"".join(lines[: len(lines) // 2]))[0] < n_all
    n, again = n_fits(journal)
    assert n == 0 and sorted(again.splitlines()) == sorted(journal.splitlines())
