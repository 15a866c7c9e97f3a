"""Tests that the stubs equal the compiled module, including the texts of help()."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import bubbletouch
import pytest
from bubbletouch import _core

STUB = Path(bubbletouch.__file__).parent / "_core.pyi"
EXAMPLES = sorted((Path(__file__).resolve().parents[1] / "examples").glob("*.py"))


def documented() -> Iterator[tuple[str, object, str]]:
    """Yields each docstring of the stub: its name, the documented object and the text."""
    for node in ast.parse(STUB.read_text()).body:
        if not isinstance(node, ast.ClassDef | ast.FunctionDef) or node.name.startswith("_"):
            continue
        there = getattr(_core, node.name)
        if text := ast.get_docstring(node):
            yield node.name, there, text
        for member in node.body:
            if isinstance(member, ast.FunctionDef) and (text := ast.get_docstring(member)):
                yield f"{node.name}.{member.name}", getattr(there, member.name), text


def test_help_says_what_the_stub_says() -> None:
    seen = 0
    for name, there, text in documented():
        if ".__" in name or name == "InternalError":
            continue
        assert inspect.getdoc(there) == text, name
        seen += 1
    assert seen > 50


def test_everything_public_is_documented() -> None:
    for name in bubbletouch.__all__:
        there = getattr(bubbletouch, name)
        assert inspect.getdoc(there), name
        for member, value in vars(there).items() if inspect.isclass(there) else ():
            if not member.startswith("_") and there.__module__.startswith("bubbletouch"):
                assert inspect.getdoc(value) or member in ("n_taxels", "name", "sets"), f"{name}.{member}"


def test_stubs_are_those_of_the_module() -> None:
    pytest.importorskip("mypy")
    module = ["--ignore-disjoint-bases", "bubbletouch._core"]
    checked = [sys.executable, "-m", "mypy.stubtest", *module]
    done = subprocess.run(checked, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_is_of_the_types_that_it_says() -> None:
    pytest.importorskip("mypy")
    sources = Path(__file__).resolve().parents[1] / "python" / "bubbletouch"
    checked = [sys.executable, "-m", "mypy", "--strict", str(sources)]
    done = subprocess.run(checked, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_examples_are_of_the_types_that_the_stubs_say() -> None:
    pytest.importorskip("mypy")
    checked = [sys.executable, "-m", "mypy", "--strict", *map(str, EXAMPLES)]
    done = subprocess.run(checked, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_pyright_agrees_on_the_examples() -> None:
    pytest.importorskip("pyright")
    pyright = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable]
    if subprocess.run([*pyright, "--version"], capture_output=True).returncode:
        pytest.skip("pyright cannot get its own program")
    done = subprocess.run([*pyright, *map(str, EXAMPLES)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
