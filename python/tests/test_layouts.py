"""Tests of layouts: from points, projected on meshes, in files of all formats, and drawn."""

from __future__ import annotations

import json
import subprocess
import warnings
from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import refused

Floats = NDArray[np.float64]
FORMATS = [("csv", "csv"), ("npz", "npz"), ("dex-01", "npz"), ("icub", "txt"), ("paxini", "json"), ("urdf", "urdf")]


def on_ball(n: int, radius: float, seed: int = 0) -> tuple[Floats, Floats]:
    """Returns n points on a ball about the origin and their unit normals."""
    normals = np.random.default_rng(seed).normal(size=(n, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return radius * normals, normals


def test_points_have_normals_of_any_length_and_a_default_radius() -> None:
    points, normals = on_ball(40, 0.02)
    patch = bt.Patch.from_points(points, 3.7 * normals, 2e-3)
    np.testing.assert_array_equal(patch.centers, points)
    np.testing.assert_allclose(patch.axes, normals, atol=1e-15)
    apart = np.linalg.norm(points[:, None] - points, axis=2) + np.eye(40)
    assert patch.taxel_radius == pytest.approx(0.5 * np.sort(apart.min(axis=1))[20])
    assert (patch.shape, patch.stroke, patch.stiffness, patch.pixels) == ((40,), 2e-3, 100.0, None)
    image = bt.Patch.from_points(points, normals, 2e-3, taxel_radius=1e-3, shape=(8, 5), stiffness=30.0)
    assert (image.shape, image.taxel_radius, image.stiffness) == ((8, 5), 1e-3, 30.0)


def test_points_take_normals_of_a_surface(box: bt.Mesh) -> None:
    points = [[0, 0, 0.0201], [0.0202, 0.001, 0.01], [0.003, -0.0149, 0.011]]
    patch = bt.Patch.from_points(points, box, 2e-3)
    np.testing.assert_allclose(patch.axes, [[0, 0, 1], [1, 0, 0], [0, -1, 0]], atol=1e-15)
    refused("positions, row 2: a point 30.0 mm from the mesh; .*within 5 mm", lambda: bt.Patch.from_points([[0, 0, 0], [0, 0, 0.05]], box, 2e-3))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"positions": np.full((40, 3), np.nan)}, "from_points, row 1: a number that is not finite"),
        ({"normals": np.zeros((40, 3))}, "from_points, row 1: normal .* of length 0; a vector with a direction"),
        ({"normals": np.ones((39, 3))}, "from_points: 40 positions, 39 normals; one normal a position"),
        ({"positions": np.zeros((0, 3)), "normals": np.zeros((0, 3))}, "from_points: no taxel"),
        ({"positions": np.zeros((40, 2))}, r"positions: shape \(40, 2\); \(n, 3\)"),
        ({"shape": (6, 6)}, "layout sides: 6 × 6 for 40 taxels"),
        ({"stroke": -1.0}, "stroke: -1 m"),
        ({"taxel_radius": 0.0}, "taxel radius: 0 m"),
    ],
)
def test_what_are_no_points_is_refused(change: dict[str, Any], said: str) -> None:
    points, normals = on_ball(40, 0.02)
    refused(said, lambda: bt.Patch.from_points(**{"positions": points, "normals": normals, "stroke": 2e-3} | change))


def test_a_projected_grid_lies_on_the_surface_below_it(box: bt.Mesh) -> None:
    ball = bt.Mesh.ellipsoid([0.03, 0.03, 0.03], tolerance=1e-6)
    turn = np.array([np.cos(0.4), 0.0, np.sin(0.4), 0.0])
    axis = np.array([np.sin(0.8), 0.0, np.cos(0.8)])
    patch = bt.Patch.projected(ball, [*(0.05 * axis), *turn], 6, 5, 4e-3, 2e-3)
    assert (patch.shape, patch.n_left_out, patch.taxel_radius) == ((6, 5), 0, 2e-3)
    np.testing.assert_allclose(np.linalg.norm(patch.centers, axis=1), 0.03, atol=2e-6)
    np.testing.assert_allclose(patch.axes, patch.centers / 0.03, atol=0.02)
    # Seen along the axis of the pose, the taxels keep their places.
    across = np.array([[np.cos(0.8), 0.0, -np.sin(0.8)], [0.0, 1.0, 0.0]])
    flat = bt.Patch.grid(6, 5, 4e-3, 2e-3)
    np.testing.assert_allclose(patch.centers @ across.T, flat.centers[:, :2], atol=1e-15)
    np.testing.assert_array_equal(patch.pixels, [[taxel // 5, taxel % 5] for taxel in range(30)])
    pressed = patch.moved([0, 0, 0, np.cos(0.4), 0, -np.sin(0.4), 0]).press(
        bt.SphereUnion([[0, 0, 0]], 0.02), [0, 0, 0.1, 1, 0, 0, 0], depth=1e-3
    )
    assert pressed.shape == (6, 5) and pressed.max() == pytest.approx(1e-3, rel=0.2)


def test_taxels_that_miss_the_mesh_are_refused_or_dropped(box: bt.Mesh) -> None:
    over = [0.015, 0.0, 0.03, 1.0, 0.0, 0.0, 0.0]
    refused("the taxel in row 0, column 3 meets no outer face", lambda: bt.Patch.projected(box, over, 4, 4, 4e-3, 2e-3))
    patch = bt.Patch.projected(box, over, 4, 4, 4e-3, 2e-3, missing="drop")
    assert (patch.shape, patch.n_left_out) == ((12,), 4)
    np.testing.assert_array_equal(patch.pixels, [[row, column] for row in range(4) for column in range(3)])
    np.testing.assert_array_equal(patch.axes, np.tile([0.0, 0.0, 1.0], (12, 1)))
    for pose, said in [
        ([0, 0, 0.01, 1, 0, 0, 0], "no taxel meets an outer face"),
        ([0, 0, -0.01, 1, 0, 0, 0], "no taxel meets an outer face"),
        ([0, 0, 1, 1, 0, 0, 1], "pose: "),
        ([[0, 0, 1, 1, 0, 0, 0]] * 2, "pose: 2 poses; one pose"),
    ]:
        refused(said, lambda: bt.Patch.projected(box, pose, 4, 4, 4e-3, 2e-3, missing="drop"))
    refused('missing: `skip`; error or drop', lambda: bt.Patch.projected(box, over, 4, 4, 4e-3, 2e-3, missing="skip"))  # type: ignore[arg-type]


def read(path: Path, **options: Any) -> bt.Patch:
    """Reads a layout file without any warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return bt.Patch.read(path, stroke=2e-3, **options)


@pytest.mark.parametrize(("name", "ending"), FORMATS)
def test_a_written_layout_is_read_as_the_same_layout(tmp_path: Path, name: str, ending: str) -> None:
    points, normals = on_ball(60, 0.02, seed=5)
    radii = np.linspace(0.8e-3, 1.2e-3, 60)
    pixels = np.stack([np.arange(60) % 7, np.arange(60)], axis=1)
    original = bt.Patch.from_arrays(points, normals, stroke=2e-3, taxel_radius=radii, pixels=pixels)
    path = tmp_path / f"skin.{ending}"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        original.write(path, format=name)  # type: ignore[arg-type]
    said = " ".join(str(warning.message) for warning in caught)
    again = read(path)
    if name in ("csv", "npz", "dex-01", "icub"):
        np.testing.assert_array_equal(again.centers, original.centers)
        np.testing.assert_array_equal(again.axes, original.axes)
    else:
        np.testing.assert_allclose(again.centers, original.centers, rtol=1e-15)
        np.testing.assert_allclose(again.axes, original.axes, atol=1e-15)
    if name in ("csv", "npz", "dex-01", "urdf"):
        np.testing.assert_array_equal(again.taxel_radius, radii)
        assert "radii" not in said
    else:
        assert "the format has no radii" in said
    if name in ("csv", "npz", "dex-01"):
        np.testing.assert_array_equal(again.pixels, pixels)
        assert said == ""
    else:
        assert "the format has no image" in said and again.pixels is None
    if name != "dex-01":
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            original.write(path)  # The format of the extension.
        np.testing.assert_array_equal(read(path).centers, again.centers)


def test_a_grid_keeps_the_shape_of_its_frames_in_files(tmp_path: Path) -> None:
    grid = bt.Patch.grid(4, 6, 2e-3, 2e-3)
    for patch in (grid, grid.moved([0.1, 0, 0, 1, 0, 0, 0])):
        for ending in ("csv", "npz"):
            patch.write(tmp_path / f"grid.{ending}")
            assert read(tmp_path / f"grid.{ending}").shape == (4, 6)


def test_numpy_and_json_read_what_is_written(tmp_path: Path) -> None:
    points, normals = on_ball(9, 0.02)
    patch = bt.Patch.from_points(points, normals, 2e-3, pixels=[[0, taxel] for taxel in range(9)])
    patch.write(tmp_path / "dex.npz", format="dex-01")
    with np.load(tmp_path / "dex.npz") as archive:
        poses, pixels = archive["poses"], archive["taxel2pixel"]
    assert poses.shape == (9, 3, 4) and pixels.dtype == np.int64
    np.testing.assert_array_equal(poses[:, :, 3], points)
    np.testing.assert_array_equal(poses[:, :, 2], patch.axes)
    np.testing.assert_allclose(poses[:, :, :3] @ poses[:, :, :3].transpose(0, 2, 1), np.tile(np.eye(3), (9, 1, 1)), atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(poses[:, :, :3]), 1.0)
    with pytest.warns(UserWarning, match="no image"):
        patch.write(tmp_path / "tip.json")
    tip = json.loads((tmp_path / "tip.json").read_text())
    assert tip["units"] == "mm"
    np.testing.assert_allclose(tip["taxels_mm"], 1e3 * points, rtol=1e-15)
    np.testing.assert_array_equal(np.array(tip["rotation"])[:, 6:9], patch.axes)


def test_layouts_are_drawn(tmp_path: Path) -> None:
    cap = bt.Patch.sphere_cap(9e-3, 1.4, 2e-3, 2e-3)
    cap.draw(tmp_path / "cap.svg", title="A fingertip")
    svg = (tmp_path / "cap.svg").read_text()
    assert all(f">{taxel}</text>" in svg for taxel in range(cap.n_taxels)) and "A fingertip" in svg
    cap.draw(tmp_path / "cap.png")
    assert (tmp_path / "cap.png").read_bytes().startswith(b"\x89PNG")
    refused("a name that ends in .svg or .png", lambda: cap.draw(tmp_path / "cap.jpg"))
    refused("nowhere", lambda: cap.draw(tmp_path / "nowhere" / "cap.png"), OSError)


UNIT = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
HEADER = "x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,1\n"
SENSOR = "<robot name='r'><link name='l'/><sensor name='s'><parent link='l'/><tactile>\n{}\n</tactile></sensor></robot>"


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.csv", HEADER + "1,2,3,0", "line 3: 4 columns; 6 columns"),
        ("a.csv", HEADER + "1,2,nan,0,0,1\n", "line 3, column z_mm: `nan`"),
        ("a.csv", HEADER + "1,2,3,0,0,0\n", "row 2: normal .* of length 0"),
        ("a.txt", "[calibration]\n0 0 0 0 0 1\n0 0 0 0", "row 3: 4 numbers; six numbers"),
        ("a.txt", "[calibration]\n0 0 0 0 0 1\n0 0 inf 0 0 1\n", "row 3: a number that is not finite"),
        ("a.ini", "[calibration]\n0 0 0 0 0 1\n1 0 0 0 0 0\n", "row 3: normal .* of length 0"),
        ("a.json", '{"taxels_mm": [[0, 0, 0], [0, 0', "EOF"),
        ("a.json", '{"taxels_mm": [[0, 0, 0], [0, null, 0]]}', "row 2: .*three numbers"),
        ("a.json", json.dumps({"taxels_mm": [[0, 0, 0]], "rotation": []}), "rotation: 0 matrices for 1 taxels"),
        ("a.json", json.dumps({"taxels_mm": [[0, 0, 0]], "rotation": [[-1.0, *UNIT[1:]]]}), "rotation, row 1: a left-handed frame"),
        ("a.json", json.dumps({"taxels_mm": [[0, 0, 0]], "rotation": [[0.0] * 9]}), "rotation, row 1: a matrix that is no rotation"),
        ("a.urdf", SENSOR.format("<taxel xyz='0 0 nan'/>"), "line 2: `xyz` .*3 finite numbers"),
        ("a.urdf", SENSOR.format("<array rows='2' cols='0' size='1 1'/>"), "line 2: `cols` 0"),
        ("a.urdf", SENSOR.format("<taxel xyz='0 0 0'/>")[:-20], "line [0-9]"),
        ("a.npz", {"positions": np.zeros((3, 3)), "normals": np.zeros((2, 3))}, r"normals: an array of shape \[2, 3\]; 3 × 3"),
        ("a.npz", {"positions": np.zeros((3, 3)), "normals": np.zeros((3, 3))}, "all 3 normals have length zero; .*or a mesh beside it"),
        ("a.npz", {"positions": np.full((3, 3), np.nan), "normals": np.ones((3, 3))}, "row 1: a number that is not finite"),
        ("a.npz", {"poses": np.tile(np.diag([-1.0, 1, 1])[:, [0, 1, 2, 2]], (2, 1, 1))}, "poses, row 1: a left-handed frame"),
        ("a.npz", {"poses": np.zeros((2, 3, 4))}, "poses, row 1: a matrix that is no rotation"),
        ("a.npz", {"poses": np.zeros((2, 4, 4))}, "poses: an array of shape"),
    ],
)  # fmt: skip
def test_a_damaged_file_is_refused_with_its_row(tmp_path: Path, name: str, content: Any, said: str) -> None:
    path = tmp_path / name
    if isinstance(content, str):
        path.write_text(content)
    else:
        np.savez(path, **content)
    with pytest.raises(ValueError, match=said) as caught:
        bt.Patch.read(path, stroke=2e-3)
    assert name in str(caught.value)


def test_other_errors_of_layout_files(tmp_path: Path) -> None:
    patch = bt.Patch.grid(2, 2, 1e-3, 1e-3)
    refused("layout format: `obj`; csv, npz, dex-01, icub, paxini, urdf", lambda: patch.write(tmp_path / "a.csv", format="obj"))  # type: ignore[arg-type]
    refused("the format urdf; the format of this extension", lambda: patch.write(tmp_path / "a.csv", format="urdf"))
    refused("nowhere", lambda: patch.write(tmp_path / "nowhere" / "a.csv"), OSError)
    assert list(tmp_path.iterdir()) == []


def test_the_command_draws_and_converts(tmp_path: Path, command: Any) -> None:
    points, normals = on_ball(12, 0.02)
    bt.Patch.from_points(points, normals, 2e-3).write(tmp_path / "skin.csv")
    assert command("layout", tmp_path / "skin.csv", "--out", tmp_path / "skin.svg").startswith("12 taxels within")
    assert (tmp_path / "skin.svg").read_text().startswith("<")
    command("layout", tmp_path / "skin.csv", "--out", tmp_path / "skin.npz", "--format", "dex-01")
    np.testing.assert_array_equal(read(tmp_path / "skin.npz").centers, points)
    (tmp_path / "bad.csv").write_text(HEADER + "1,2,3,0,0,0\n")
    with pytest.raises(subprocess.CalledProcessError) as caught:
        command("layout", tmp_path / "bad.csv", "--out", tmp_path / "bad.svg")
    assert caught.value.returncode == 2 and "bad.csv, row 2" in caught.value.stderr
    assert not (tmp_path / "bad.svg").exists()


def test_the_default_stroke_is_the_diameter_of_a_taxel(tmp_path: Path, box: bt.Mesh) -> None:
    points, normals = on_ball(9, 0.02)
    assert bt.Patch.from_points(points, normals, taxel_radius=1e-3).stroke == 2e-3
    assert bt.Patch.projected(box, [0, 0, 0.03, 1, 0, 0, 0], 3, 3, 4e-3).stroke == 4e-3
    radii = np.linspace(0.8e-3, 1.2e-3, 9)
    bt.Patch.from_arrays(points, normals, stroke=5e-3, taxel_radius=radii).write(tmp_path / "skin.csv")
    np.testing.assert_array_equal(bt.Patch.read(tmp_path / "skin.csv").stroke, 2 * radii)
    for name in ("no.csv", "no.npz", "no.urdf"):
        refused(name, lambda: bt.Patch.read(tmp_path / name), FileNotFoundError)
