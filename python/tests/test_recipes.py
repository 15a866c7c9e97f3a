"""Tests of the recipes in guide/recipes, with stubs of the schedulers: every shard runs, and the merged tables have the bytes of one run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import bubbletouch as bt
import pytest

from conftest import Command
from test_own_classifiers import STUDY

RECIPES = Path(__file__).resolve().parents[2] / "guide" / "recipes"
Shell = Callable[..., None]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns a folder with study.toml, and with the results of one run in `whole`."""
    folder = tmp_path_factory.mktemp("recipes")
    (folder / "study.toml").write_text(bt._core.toml_of(bt.study._json(STUDY)))
    bt.run(folder / "study.toml", folder / "whole")
    return folder


@pytest.fixture
def shell(folder: Path, command: Command, tmp_path: Path) -> Shell:
    """Returns a function that runs a program in the folder, with the command `bubbletouch` on its path."""
    command("--version")
    path = os.environ.get("BUBBLETOUCH_COMMAND") or str(Path(__file__).resolve().parents[2] / "target" / "release" / "bubbletouch")
    (tmp_path / "bubbletouch").symlink_to(path)

    def run(*words: object, **environment: object) -> None:
        known = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
        subprocess.run(list(map(str, words)), check=True, cwd=folder, env=known | {key: str(value) for key, value in environment.items()})

    return run


def check(folder: Path, results: str, n: int) -> None:
    assert len(list((folder / results).glob(f"journal.*-of-{n}.jsonl"))) == n
    for table in ("accuracy", "summary", "confusion"):
        assert (folder / results / f"{table}.csv").read_bytes() == (folder / "whole" / f"{table}.csv").read_bytes()


def test_slurm_array(folder: Path, shell: Shell) -> None:
    script = RECIPES / "slurm_array.sh"
    n = int(re.findall(r"#SBATCH --array=1-(\d+)", script.read_text())[0])
    for number in range(n, 0, -1):
        assert not (folder / "slurm" / "summary.csv").exists()
        shell("sh", script, "study.toml", "slurm", SLURM_ARRAY_TASK_ID=number, SLURM_ARRAY_TASK_COUNT=n, SLURM_CPUS_PER_TASK=1)
    check(folder, "slurm", n)
    assert not list((folder / "slurm").glob("*.done")) and not (folder / "slurm" / "merging").exists()


def test_snakemake(folder: Path, shell: Shell) -> None:
    lines = re.findall(r'^    shell: "(.*)"$', (RECIPES / "Snakefile").read_text(), re.MULTILINE)
    merge, shard = lines
    for number in (1, 2, 3):
        values = {"{STUDY}": "study.toml", "{RESULTS}": "snake", "{wildcards.i}": str(number), "{N}": "3", "{threads}": "1"}
        shell("sh", "-c", re.sub(r"\{[\w.]+\}", lambda found: values[found[0]], shard))
    shell("sh", "-c", merge.replace("{STUDY}", "study.toml").replace("{RESULTS}", "snake"))
    check(folder, "snake", 3)


def test_kubernetes(folder: Path, shell: Shell) -> None:
    yaml = pytest.importorskip("yaml")
    text = (RECIPES / "kubernetes.yaml").read_text()
    job = yaml.safe_load(text)["spec"]
    container = job["template"]["spec"]["containers"][0]
    merge = re.findall(r"bubbletouch merge .*", text)[0]
    for number in range(job["completions"]):
        words = [*container["command"], container["args"][0].replace("/data/results", "pods").replace("/data/", "")]
        shell(*words, JOB_COMPLETION_INDEX=number)
    shell("sh", "-c", merge.replace("/data/results", "pods").replace("/data/", ""))
    check(folder, "pods", job["completions"])


STUB = """
from distributed import LocalCluster
class SLURMCluster(LocalCluster):
    def __init__(self, cores, memory, walltime):
        super().__init__(n_workers=0, threads_per_worker=cores, processes=True, dashboard_address=None)
    def scale(self, jobs):
        super().scale(jobs)
"""


def test_dask_on_slurm(folder: Path, shell: Shell, tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    (tmp_path / "dask_jobqueue.py").write_text(STUB)
    known = os.pathsep.join([str(tmp_path), str(Path(bt.__file__).parents[1])])
    shell(sys.executable, RECIPES / "dask_slurm.py", "study.toml", "dask", "2", PYTHONPATH=known)
    check(folder, "dask", 8)
