"""Studies on many machines: each shard of a study is a task of Dask, Ray or any executor."""

from __future__ import annotations

import os
import pickle
import tempfile
import warnings
from collections.abc import Mapping
from concurrent.futures import Executor, Future, as_completed
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

from bubbletouch import _core
from bubbletouch._foreign import Host, Hosted, hosted, identified, pickler
from bubbletouch.recorded import Recorded, named, with_paths
from bubbletouch.study import Study, StudySource

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

    def shared(self, value: Any) -> Any:
        """Returns a reference to a value, which is an argument of many tasks."""
        return self._ray.put(value)

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
    recorded: Recorded | Mapping[str, Any] | None = None,
    classifiers: Mapping[str, Any] | None = None,
    features: Mapping[str, Any] | None = None,
    threads: int = 1,
) -> Study:
    """Runs the shards of a study as tasks, merges them in the calling process, and returns the results. The tables are bitwise
    equal to the tables of `bubbletouch.run`.

    study: path of a TOML file, or a dict with its tables. Files that the study names exist under the same absolute paths on all machines.
    client: dask.distributed.Client, a RayExecutor, or another concurrent.futures.Executor. Dask and Ray run the shard of a lost worker again.
    n_shards: number of tasks. Default: the number of threads of all workers, or of processors of this machine for another executor. Each shard simulates
    the touches that it needs, so many shards repeat simulations.
    out: result folder. Journals of finished shards are kept there; the same call continues an interrupted run with the same n_shards. Default: a temporary
    folder that is deleted with the Study.
    seed, recorded: as for bubbletouch.run. Arrays in memory are sent to the workers.
    classifiers, features: as for bubbletouch.run. They are sent to the workers by cloudpickle, or by pickle if cloudpickle is not installed. A worker
    imports the modules of their code, except `__main__`.
    threads: threads of each task.

    Raises the exceptions of bubbletouch.run; the first shard that fails ends the run.
    """
    for key, number in (("n_shards", n_shards), ("threads", threads)):
        if number is not None and number < 1:
            raise ValueError(f"{key}: {number}; at least 1")
    is_dask = hasattr(client, "get_executor")
    if not (is_dask or hasattr(client, "submit")):
        raise TypeError(f"client: {client!r}; a dask.distributed.Client, a RayExecutor, or another executor")
    if n_shards is None:
        n_shards = max(1, sum(client.nthreads().values()) if is_dask else getattr(client, "n_threads", os.cpu_count() or 1))
    given = identified(classifiers, features)
    code = _pickled(given)
    source, kept = StudySource.of(study, recorded, out, seed)
    source = replace(source, folder=source.folder.resolve())
    results = source.results
    executor = client.get_executor(pure=False) if is_dask else client
    files = _shared(client, {path: Path(path).read_bytes() for path in source.files})
    shards: dict[Future[bytes], Path] = {}
    for number in range(1, n_shards + 1):
        journal = results / f"journal.{number}-of-{n_shards}.jsonl"
        begun = journal.read_bytes() if journal.exists() else b""
        shards[executor.submit(bubbletouch_shard, source, files, code, f"{number}/{n_shards}", begun, threads)] = journal
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
    tables = _core.run_study(source.call(results, hosted(Host(), given), merges=True))
    return Study(results, tables, kept)


def bubbletouch_shard(source: StudySource, files: Mapping[str, bytes], code: bytes, shard: str, begun: bytes, threads: int) -> bytes:
    """Computes a shard of a study in a temporary folder, and returns its journal. `files` contains the recorded arrays by their paths in the calling process."""
    try:
        given = pickle.loads(code)
    except Exception as error:
        allowed = "code that all workers can import, or that is defined in the main script"
        raise ValueError(f"classifiers, features: cannot be loaded on a worker ({type(error).__name__}: {error}); {allowed}") from None
    file = f"journal.{shard.replace('/', '-of-')}.jsonl"
    with tempfile.TemporaryDirectory(prefix="bubbletouch-") as kept:
        out = Path(kept) / "shard"
        out.mkdir()
        if begun:
            (out / file).write_bytes(begun)
        paths = {path: str(Path(kept) / Path(path).name) for path in files}
        for path, content in files.items():
            Path(paths[path]).write_bytes(content)
        moved = replace(source, recorded=with_paths(source.recorded, paths))
        try:
            _core.run_study(moved.call(out, hosted(Host(), given), shard=shard, threads=threads))
        except ValueError as error:
            raise named(error, {paths[path]: key for path, key in source.files.items()}) from error.__cause__
        return (out / file).read_bytes()


def _shared(client: Any, files: dict[str, bytes]) -> Any:
    """Returns files as an argument of many tasks, which a cluster stores once."""
    if hasattr(client, "get_executor") and files:
        with warnings.catch_warnings():
            # Dask warns of tasks with much data. A scattered value would be lost with its worker; the result of a task is computed again.
            warnings.simplefilter("ignore")
            return client.submit(_same, files, pure=False)
    return client.shared(files) if hasattr(client, "shared") else files


def _same(files: dict[str, bytes]) -> dict[str, bytes]:
    return files


def _pickled(given: Hosted) -> bytes:
    """Returns classifiers and features for the workers."""
    for what, things in zip(("classifier", "features"), given, strict=True):
        for name, _, thing in things:
            try:
                pickler().dumps(thing)
            except Exception as error:
                allowed = "an object that cloudpickle can send to a worker"
                raise ValueError(f"{what} {name}: cannot be sent to the workers ({type(error).__name__}: {error}); {allowed}") from error
    code: bytes = pickler().dumps(given)
    return code
