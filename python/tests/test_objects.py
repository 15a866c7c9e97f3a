"""Tests of objects: meshes, spheres and the catalogue."""

from __future__ import annotations

import pickle
import warnings
from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest


def test_a_mesh_measures_what_it_is(box: bt.Mesh) -> None:
    assert len(box) == 12
    np.testing.assert_allclose(box.bounds, [[-0.02, -0.015, 0], [0.02, 0.015, 0.02]])
    assert box.volume == pytest.approx(24e-6)
    assert box.area == pytest.approx(2 * (40 * 30 + 40 * 20 + 30 * 20) * 1e-6)
    np.testing.assert_allclose(box.centroid, [0, 0, 0.01], atol=1e-15)
    assert "12 triangles, 40.0 × 30.0 × 20.0 mm" in repr(box)


def test_a_packing_keeps_its_promise(box: bt.Mesh) -> None:
    tolerance = 1e-3
    packed = box.pack(tolerance)
    low, high = packed.bounds
    assert (low >= box.bounds[0] - tolerance / 2).all()
    assert (high <= box.bounds[1] + tolerance / 2).all()
    surface = np.random.default_rng(0).uniform(*box.bounds, (2000, 3))
    surface[np.arange(2000), np.arange(2000) % 3] = box.bounds[1][np.arange(2000) % 3]
    gap = np.linalg.norm(surface[:, None] - packed.centers, axis=2) - packed.radii
    assert gap.min(axis=1).max() <= tolerance


def test_a_mesh_that_faces_inwards_is_turned_outwards_with_a_warning(box: bt.Mesh, tmp_path: Path) -> None:
    said = "12 of 12 triangles faced inwards and were turned outwards"
    inwards = bt.Mesh(box.vertices, box.triangles[:, ::-1])
    with pytest.warns(UserWarning, match=f"mesh: {said}"):
        packed = inwards.pack(1e-3)
    np.testing.assert_allclose(packed.bounds, box.pack(1e-3).bounds, atol=1e-3)
    with pytest.warns(UserWarning, match=f"mesh: {said}"):
        patch = bt.Patch.draped(inwards, 4e-3, 2e-3)
    assert (((patch.centers - [0, 0, 0.01]) * patch.axes).sum(1) > 0).all()
    path = tmp_path / "box.obj"
    corners = [f"v {x} {y} {z}" for x, y, z in inwards.vertices]
    path.write_text("\n".join([*corners, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in inwards.triangles)]))
    with pytest.warns(UserWarning, match=f"box.obj: {said}"):
        read = bt.Mesh.read(path)
    assert read.volume == pytest.approx(24e-6)


def test_a_mesh_that_faces_outwards_or_is_a_sheet_is_not_turned(box: bt.Mesh, tmp_path: Path) -> None:
    path = tmp_path / "corner.obj"
    path.write_text("v 0 0 0\nv 5 0 0\nv 0 5 0\nf 1 3 2\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        box.pack(1e-3)
        bt.Patch.draped(box, 4e-3, 2e-3)
        bt.Mesh(box.vertices, box.triangles[:, ::-1]).pack(1e-3, sheet=True)
        sheet = bt.Mesh.read(path, unit="mm")
    a, b, c = sheet.vertices[sheet.triangles[0]]
    assert np.cross(b - a, c - a)[2] < 0


def test_vertex_spheres_are_one_a_vertex(box: bt.Mesh) -> None:
    spheres = box.vertex_spheres()
    np.testing.assert_array_equal(spheres.centers, box.vertices)
    np.testing.assert_allclose(spheres.radii, 2 * 0.02)


def test_files_are_read_in_their_unit(tmp_path: Path) -> None:
    path = tmp_path / "corner.obj"
    path.write_text("v 0 0 0\nv 50 0 0\nv 0 50 0\nf 1 2 3\n")
    np.testing.assert_allclose(bt.Mesh.read(path, unit="mm").bounds[1], [0.05, 0.05, 0])
    with pytest.raises(ValueError, match="50.* m wide, if its unit is the metre"):
        bt.Mesh.read(path)
    with pytest.raises(ValueError, match="unit: `foot`; m, cm, mm or in"):
        bt.Mesh.read(path, unit="foot")  # type: ignore[arg-type]


def test_spheres_go_to_a_file_and_back_bit_by_bit(tmp_path: Path, mug: bt.SphereUnion) -> None:
    path = tmp_path / "mug.csv"
    mug.write(path)
    read = bt.SphereUnion.read(path)
    np.testing.assert_array_equal(read.centers, mug.centers)
    np.testing.assert_array_equal(read.radii, mug.radii)


def test_one_radius_serves_all_spheres() -> None:
    spheres = bt.SphereUnion([[0, 0, 0], [0, 0, 1]], 0.5)
    np.testing.assert_array_equal(spheres.radii, [0.5, 0.5])
    assert len(spheres) == 2


def test_the_catalogue_has_objects_by_name_and_by_set() -> None:
    catalogue = bt.Catalogue.builtin()
    assert {"balls", "boxes", "cans", "household", "hands"} == set(catalogue.sets)
    assert len(catalogue.names) == len(catalogue)
    mug = catalogue.object("mug")
    assert mug.name == "mug" and mug.set == "household" and mug.source
    assert [solid.name for solid in catalogue.set("balls")] == catalogue.names[:16]
    with pytest.raises(ValueError, match="object: `mugg`; perhaps mug"):
        catalogue.object("mugg")
    with pytest.raises(ValueError, match="object set: `fruit`; one of balls"):
        catalogue.set("fruit")


def test_a_catalogue_of_ones_own_is_read(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text(
        '[[object]]\nname = "marble"\nsource = "ruler"\n'
        '[[object.part]]\nshape = "ball"\ndiameter_mm = 16\n'
    )
    marble = bt.Catalogue.read(path).object("marble").pack(1e-4)
    np.testing.assert_allclose(marble.bounds, [[-8e-3, -8e-3, 0], [8e-3, 8e-3, 16e-3]], atol=1e-4)


@pytest.mark.parametrize("protocol", [2, 5])
def test_objects_are_pickled_bit_by_bit(box: bt.Mesh, mug: bt.SphereUnion, protocol: int) -> None:
    mesh = pickle.loads(pickle.dumps(box, protocol))
    np.testing.assert_array_equal(mesh.vertices, box.vertices)
    np.testing.assert_array_equal(mesh.triangles, box.triangles)
    spheres = pickle.loads(pickle.dumps(mug, protocol))
    np.testing.assert_array_equal(spheres.centers, mug.centers)
    np.testing.assert_array_equal(spheres.radii, mug.radii)
