"""The JSON Schemas of study and scene files, checked with a validator that is not ours."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest

from conftest import Command

jsonschema = pytest.importorskip("jsonschema")
# Part of Python since 3.11.
tomllib = pytest.importorskip("tomllib")

ROOT = Path(__file__).resolve().parents[2]
# Folders with files that the command accepts.
FOLDERS = ["experiments", "experiments/scenes", "tests/fixtures/kinds", *ROOT.glob("results/*")]
FILES = sorted(path for folder in FOLDERS for path in (ROOT / folder).glob("*.toml"))
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "guide").glob("*.md"))]

STUDY = """
question = "How many measurements tell cans apart?"
[objects]
sets = ["cans"]
surface_error_mm = 1.0
[skin]
pitch_mm = 4.0
size_mm = 64.0
stroke_mm = 5.0
[touches]
per_object = 8
offset_x_mm = { uniform = [-8.0, 8.0] }
depth_mm = 3.0
[sensing]
ratio = 16.0
[recognition]
classifier = "linear_svm"
"""

SCENE = """
title = "A ball"
duration_s = 0.01
[[patches]]
name = "palm"
layout = { grid = { nx = 4, ny = 4, pitch_mm = 4.0 } }
stroke_mm = 5.0
"""


@pytest.fixture(scope="module")
def validators(command: Command) -> dict[str, Any]:
    schemas = {kind: json.loads(command("schema", kind)) for kind in ("study", "scene")}
    for schema in schemas.values():
        jsonschema.Draft202012Validator.check_schema(schema)
    return {kind: jsonschema.Draft202012Validator(schema) for kind, schema in schemas.items()}


def faults(validators: dict[str, Any], table: dict[str, Any]) -> list[str]:
    kind = "scene" if "patches" in table or "title" in table else "study"
    found = validators[kind].iter_errors(table)
    return [f"{'.'.join(map(str, fault.absolute_path))}: {fault.message[:300]}" for fault in found]


def partial(schema: Any) -> Any:
    """Returns the schema without required keys, for a part of a file."""
    if isinstance(schema, dict):
        keep = {key: partial(value) for key, value in schema.items() if key != "required" or isinstance(value, dict)}
        return {key: value for key, value in keep.items() if key != "allOf"}
    return [partial(value) for value in schema] if isinstance(schema, list) else schema


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_that_the_command_accepts_are_valid(validators: dict[str, Any], path: Path) -> None:
    assert not faults(validators, tomllib.loads(path.read_text()))


def test_there_are_files_and_examples() -> None:
    assert len(FILES) > 60 and len(examples()) > 10


def examples() -> list[Any]:
    """Returns the TOML blocks of the pages that are studies, scenes or parts of them."""
    found = []
    for page in PAGES:
        for block in re.findall(r"```toml\n(.*?)```", page.read_text(), re.DOTALL):
            found.append(pytest.param(block, id=f"{page.name}: {block.splitlines()[0][:40]}"))
    return found


@pytest.mark.parametrize("block", examples())
def test_examples_of_the_guide_are_valid(validators: dict[str, Any], block: str) -> None:
    table = tomllib.loads(block)
    if len(table) > 1 and ("question" in table or "patches" in table and "title" in table):
        assert not faults(validators, table)
        return
    if "object" in table:
        pytest.skip("a file of objects")
    # A part of a file, or of one of its tables.
    found = []
    for whole in validators.values():
        schema = partial(whole.schema)
        tables = [name for name, key in schema["properties"].items() if "properties" in key]
        for file in [table, *({name: table} for name in tables)]:
            found.append([fault.message for fault in jsonschema.Draft202012Validator(schema).iter_errors(file)])
    assert not all(found), found


BROKEN = [
    ("study", "pitch_mm = 4.0", "pitch_mn = 4.0"),
    ("study", "pitch_mm = 4.0", 'pitch_mm = "4 mm"'),
    ("study", "pitch_mm = 4.0", "pitch_mm = -4.0"),
    ("study", "pitch_mm = 4.0", "pitch_mm = [4.0, 0.0]"),
    ("study", "pitch_mm = 4.0", "pitch_mm = [4.0, 4.0]"),
    ("study", "stroke_mm = 5.0", ""),
    ("study", "per_object = 8", "per_object = 8.5"),
    ("study", "per_object = 8", "per_object = 0"),
    ("study", "depth_mm = 3.0", "depth_mm = { grid = [1.0, 3.0] }"),
    ("study", "ratio = 16.0", "ratio = 0.5"),
    ("study", '"linear_svm"', '"linear"'),
    ("study", '"linear_svm"', '["linear_svm", "forest"]'),
    ("study", '"linear_svm"', '"linear_svm"\ndegree = 21'),
    ("study", '"linear_svm"', '"linear_svm"\nfeatures = "raw+descriptors"'),
    ("study", "[sensing]", "[signal]\nnoise_std_full_scale = -0.1\n[sensing]"),
    ("study", "[sensing]", '[signal]\nsteps = ["nois"]\n[sensing]'),
    ("study", "[sensing]", "[signal]\ndead_fraction = 2.0\n[sensing]"),
    ("study", "[sensing]", "[reconstruction]\n[sensing]"),
    ("study", "[sensing]", '[axes]\n"skin.stroke" = [1.0]\n[sensing]'),
    ("study", "[sensing]", '[axes]\n"touches.speed_mm_per_s" = 1.0\n[sensing]'),
    ("study", "[sensing]", "[test]\nskin.pitch = 1.0\n[sensing]"),
    ("scene", "stroke_mm = 5.0", "stroke_mm = 0.0"),
    ("scene", "stroke_mm = 5.0", "stroke = 5.0"),
    ("scene", "nx = 4", "nx = 0"),
    ("scene", "nx = 4", "nx = 4, n_z = 1"),
    ("scene", "{ grid =", "{ square ="),
    ("scene", "duration_s = 0.01", "dt_ms = -1.0"),
]


@pytest.mark.parametrize(("kind", "before", "after"), BROKEN)
def test_broken_files_are_refused_by_the_schema_and_by_the_command(
    validators: dict[str, Any], command: Command, tmp_path: Path, kind: str, before: str, after: str
) -> None:
    whole = STUDY if kind == "study" else SCENE
    subcommand = ("plan",) if kind == "study" else ("simulate", "--out", tmp_path / "out")
    path = tmp_path / "file.toml"
    path.write_text(whole)
    assert not faults(validators, tomllib.loads(whole))
    command(subcommand[0], path, *subcommand[1:])
    broken = whole.replace(before, after, 1)
    assert broken != whole
    path.write_text(broken)
    assert faults(validators, tomllib.loads(broken)), "the schema accepts the file"
    with pytest.raises(subprocess.CalledProcessError) as refused:
        command(subcommand[0], path, *subcommand[1:])
    assert refused.value.returncode == 2, refused.value.stderr
