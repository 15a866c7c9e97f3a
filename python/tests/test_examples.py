"""Tests that the examples and the Python code of the README pages run."""

from __future__ import annotations

import csv
import re
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import Command

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLES = sorted((PACKAGE / "examples").glob("*.py"))
PAGES = [PACKAGE / "README.md", PACKAGE.parent / "README.md"]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example(example: Path, tmp_path: Path) -> None:
    source = example.read_text()
    for needed in ("sklearn", "gymnasium", "mujoco", "torch", "rerun"):
        if re.search(rf"^(import|from) {needed}", source, re.M):
            pytest.importorskip(needed)
    if "-v5" in source:
        pytest.importorskip("imageio")  # of gymnasium[mujoco]
    done = subprocess.run(
        [sys.executable, str(example)], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip(), "an example says what it found"


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.parent.name or "root")
def test_page(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S)
    assert blocks, f"no Python in {page}"
    for block in blocks:
        if "sklearn" in block:
            pytest.importorskip("sklearn")
        exec(compile(block, str(page), "exec"), {})
    assert (tmp_path / "mug.png").read_bytes().startswith(b"\x89PNG")


def test_the_guide_s_programs_for_simulators(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mujoco")
    page = PACKAGE.parent / "guide" / "simulators.md"
    monkeypatch.chdir(PACKAGE.parent)
    for block in re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S):
        exec(compile(block, str(page), "exec"), {})
    first, second = capsys.readouterr().out.splitlines()
    assert re.match(r"(19|20)\.\d\d N on \d\d taxels of the left pad", first), first
    assert second == "(1024, 64) [2. 2. 2.]", second


def test_the_guide_s_program_for_layouts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    page = PACKAGE.parent / "guide" / "scenes.md"
    monkeypatch.chdir(tmp_path)
    [block] = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S)
    exec(compile(block, str(page), "exec"), {})
    assert capsys.readouterr().out == "(3, 3) 9\n"


def test_the_minimal_study_of_recorded_frames(
    tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (PACKAGE.parent / "guide" / "recorded_frames.md").read_text()
    blocks = dict(re.findall(r"^```(?:python|toml),(\S+)\n(.*?)^```", text, re.M | re.S))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "minimal.toml").write_text(blocks["minimal.toml"])
    exec(compile(blocks["frames.py"], "frames.py", "exec"), {})
    assert "\nbubbletouch run minimal.toml\n" in text
    command("run", "minimal.toml")
    lines = (tmp_path / "results" / "minimal" / "summary.csv").read_text().splitlines()
    [row] = csv.DictReader(lines)
    exec(compile(blocks["minimal.py"], "minimal.py", "exec"), {})
    assert capsys.readouterr().out == f"[{float(row['accuracy']):g}]\n".replace("[1]", "[1.]")
    assert float(row["accuracy"]) > 0.9
