"""Studies on many machines: each shard of a study is a task of Dask, Ray or any executor."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from concurrent.futures import Executor, Future, as_completed
from os import PathLike
from pathlib import Path
from typing import Any

from bubbletouch import _core
from bubbletouch._foreign import Given, Host, hosted, identified
from bubbletouch.study import Study, _text

__all__ = ["RayExecutor", "run"]


class RayExecutor(Executor):
    """An executor whose tasks run on the Ray cluster of this process. Call ray.init before, or let Ray start one on this machine.

    options: options of ray.remote for each task, such as num_cpus=4. Ray runs the task of a lost worker again, max_retries times (3 by default).
    """

    def __init__(self, **options: Any) -> None:
        import ray

        self._ray: Any = ray
        self._options = options
        if not ray.is_initialized():
            ray.init()

    @property
    def n_threads(self) -> int:
        """Number of processors of the cluster."""
        return max(1, int(self._ray.cluster_resources().get("CPU", 1)))

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        task = self._ray.remote(fn).options(**self._options).remote(*args, **kwargs)
        ended: Future[Any] = Future()
        task.future().add_done_callback(lambda done: self._end(ended, done))
        ended.add_done_callback(lambda future: self._ray.cancel(task) if future.cancelled() else None)
        return ended

    def _end(self, ended: Future[Any], done: Future[Any]) -> None:
        if not ended.set_running_or_notify_cancel():
            return
        error = done.exception()
        if error is None:
            ended.set_result(done.result())
        else:
            # Ray wraps an exception of the task in one of its own.
            ended.set_exception(getattr(error, "cause", None) or error)


def run(
    study: str | PathLike[str] | Mapping[str, Any],
    client: Any,
    n_shards: int | None = None,
    out: str | PathLike[str] | None = None,
    *,
    seed: int | None = None,
    classifiers: Mapping[str, Any] | None = None,
    features: Mapping[str, Any] | None = None,
    threads: int = 1,
) -> Study:
    """Runs the shards of a study as tasks, merges them in the calling process, and returns the results. The tables are bitwise
    equal to the tables of `bubbletouch.run`.

    study: path of a TOML file, or a dict with its tables. Files that the study names exist under the same absolute paths on all machines.
    client: dask.distributed.Client, a RayExecutor, or another concurrent.futures.Executor. Dask and Ray run the shard of a lost worker again.
    n_shards: number of tasks. None: the number of threads of all workers, or of processors of this machine for another executor. Each shard simulates
    the touches that it needs, so many shards repeat simulations.
    out: result folder. Journals of finished shards are kept there; the same call continues an interrupted run with the same n_shards. None: a temporary
    folder that is deleted with the Study.
    seed, classifiers, features: as for bubbletouch.run.
    threads: threads of each task.

    Raises the exceptions of bubbletouch.run; the first shard that fails ends the run.
    """
    text, place, name, folder = _text(study)
    folder = folder.resolve()
    for key, number in (("n_shards", n_shards), ("threads", threads)):
        if number is not None and number < 1:
            raise ValueError(f"{key}: {number}; at least 1")
    is_dask = hasattr(client, "get_executor")
    if n_shards is None:
        n_shards = max(1, sum(client.nthreads().values()) if is_dask else getattr(client, "n_threads", os.cpu_count() or 1))
    kept = tempfile.TemporaryDirectory(prefix="bubbletouch-") if out is None else None
    results = Path(kept.name) / name if kept is not None else Path(out or "")
    given = identified(classifiers, features)
    call: dict[str, Any] = {"text": text, "place": place, "name": name, "folder": folder, "seed": seed}
    executor = client.get_executor(pure=False) if is_dask else client
    shards: dict[Future[bytes], Path] = {}
    for number in range(1, n_shards + 1):
        journal = results / f"journal.{number}-of-{n_shards}.jsonl"
        begun = journal.read_bytes() if journal.exists() else b""
        shards[executor.submit(bubbletouch_shard, call, given, f"{number}/{n_shards}", begun, threads)] = journal
    try:
        for done in as_completed(shards):
            journal = shards[done]
            lines = done.result()
            results.mkdir(parents=True, exist_ok=True)
            part = journal.with_suffix(".part")
            part.write_bytes(lines)
            part.replace(journal)
    finally:
        for task in shards:
            task.cancel()
    host = Host()
    tables = _core.run_study(out=results, callback=None, **call, **_hosted(host, given), merges=True)
    return Study(results, tables, kept)


def bubbletouch_shard(call: dict[str, Any], given: tuple[list[Given], list[Given]], shard: str, begun: bytes, threads: int) -> bytes:
    """Computes a shard of a study in a temporary folder, and returns its journal."""
    file = f"journal.{shard.replace('/', '-of-')}.jsonl"
    with tempfile.TemporaryDirectory(prefix="bubbletouch-") as kept:
        out = Path(kept) / "shard"
        out.mkdir()
        if begun:
            (out / file).write_bytes(begun)
        _core.run_study(out=out, callback=None, **call, **_hosted(Host(), given), shard=shard, threads=threads)
        return (out / file).read_bytes()


def _hosted(host: Host, given: tuple[list[Given], list[Given]]) -> dict[str, Any]:
    classifiers, features = hosted(host, given)
    return {"classifiers": classifiers, "features": features}
