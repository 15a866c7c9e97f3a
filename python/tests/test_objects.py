"""Tests of objects: meshes, spheres and the catalogue."""

from __future__ import annotations

import pickle
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest

from conftest import refused


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
    refused("50.* m wide, if its unit is the metre", lambda: bt.Mesh.read(path))
    refused("unit: `foot`; m, cm, mm or in", lambda: bt.Mesh.read(path, unit="foot"))  # type: ignore[arg-type]


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
    refused("object: `mugg`; perhaps mug", lambda: catalogue.object("mugg"))
    refused("object set: `fruit`; one of balls", lambda: catalogue.set("fruit"))


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


def test_primitive_shapes_have_their_volumes_and_taxels_touch_the_exact_capsule() -> None:
    x, y, z = 0.02, 0.03, 0.05
    volumes = [
        (bt.Mesh.box([x, y, z]), x * y * z),
        (bt.Mesh.cylinder(x, y), np.pi * x**2 * y),
        (bt.Mesh.ellipsoid((x, y, z)), 4 / 3 * np.pi * x * y * z),
        (bt.Mesh.capsule(x, y), np.pi * x**2 * (y + 4 / 3 * x)),
    ]
    for mesh, volume in volumes:
        assert mesh.volume == pytest.approx(volume, rel=2e-3)
        np.testing.assert_allclose(mesh.centroid, 0, atol=1e-12)
        assert "mm>" in repr(mesh)
    coarse = bt.Mesh.cylinder(x, y, tolerance=1e-3)
    assert len(coarse) < len(bt.Mesh.cylinder(x, y))
    capsule = bt.Mesh.capsule(0.01, 0.03, tolerance=1e-3)
    np.testing.assert_allclose(capsule.bounds, [[-0.01, -0.01, -0.025], [0.01, 0.01, 0.025]], atol=1e-15)
    patch = bt.Patch.grid(1, 9, 5e-3, stroke=3e-3, taxel_radius=1e-3)
    lying = [0, 0, 0.01, np.sqrt(0.5), 0, np.sqrt(0.5), 0]
    beyond = np.maximum(np.abs(patch.centers[:, 0]) - 0.015, 0)
    exact = np.maximum(np.sqrt(np.maximum(0.011**2 - beyond**2, 0)) - 0.01, 0)
    np.testing.assert_allclose(patch.press(capsule, lying)[0], exact, atol=1e-15)
    for again in (pickle.loads(pickle.dumps(capsule)), capsule.mirrored("y")):
        np.testing.assert_array_equal(again.vertices, capsule.vertices)
        np.testing.assert_array_equal(patch.press(again, lying), patch.press(capsule, lying))
    packed = capsule.pack(1e-3)
    np.testing.assert_allclose(packed.bounds, capsule.bounds, atol=1.5e-3)
    assert bt.Patch.draped(capsule, 4e-3, 2e-3).n_taxels > 50


def test_a_mirrored_mesh_is_the_mirror_image(box: bt.Mesh) -> None:
    again = pickle.loads(pickle.dumps(box))
    np.testing.assert_array_equal(again.triangles, box.triangles)
    low, high = box.mirrored("z").bounds
    np.testing.assert_allclose([low, high], [[-0.02, -0.015, -0.02], [0.02, 0.015, 0]])
    assert box.mirrored("x").volume == pytest.approx(box.volume)
    refused('axis: `w`; x, y or z', lambda: box.mirrored("w"))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: bt.Mesh.box([1, 2]), "size: shape"),
        (lambda: bt.Mesh.box([1, 2, 0]), "size: "),
        (lambda: bt.Mesh.ellipsoid([1, 2, np.nan]), "radii: "),
        (lambda: bt.Mesh.cylinder(-1.0, 1.0), "cylinder: radius: -1 m; a finite positive number"),
        (lambda: bt.Mesh.cylinder(1.0, 1.0, 1e-9), "cylinder: tolerance: "),
        (lambda: bt.Mesh.capsule(1.0, -1.0), "capsule: length: -1 m; zero or a positive number"),
    ],
)
def test_sizes_of_no_shape_are_refused(make, message: str) -> None:  # type: ignore[no-untyped-def]
    refused(message, lambda: make())


def test_packings_are_cached_in_the_files_of_studies(tmp_path: Path, box: bt.Mesh) -> None:
    cache = tmp_path / "new" / "packings"
    made = box.pack(1e-3, cache=cache)
    (path,) = cache.iterdir()
    bytes_of_file = path.read_bytes()
    np.testing.assert_array_equal(made.centers, box.pack(1e-3).centers)
    # The spheres of the file are returned, not packed again: another valid file of the same name is read.
    again = box.pack(1e-3, cache=cache)
    np.testing.assert_array_equal(again.centers, made.centers)
    np.testing.assert_array_equal(again.radii, made.radii)
    box.pack(1e-3, sheet=True, cache=cache)
    box.pack(2e-3, cache=cache)
    assert len(list(cache.iterdir())) == 3
    path.write_bytes(bytes_of_file[:-100])
    np.testing.assert_array_equal(box.pack(1e-3, cache=cache).radii, made.radii)
    assert path.read_bytes() == bytes_of_file
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda _: box.pack(1.5e-3, cache=cache), range(8)))
    assert all(np.array_equal(one.centers, together[0].centers) for one in together)
    assert len(list(cache.iterdir())) == 4
    refused("packings", lambda: box.pack(3e-3, cache=path), OSError)


def test_a_study_reads_the_packings_of_python_and_python_those_of_a_study(tmp_path: Path, box: bt.Mesh) -> None:
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    for name, scale in [("small", 1.0), ("large", 1.3)]:
        corners = "".join(f"v {x} {y} {z}\n" for x, y, z in (scale * box.vertices).tolist())
        faces = "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in box.triangles.tolist())
        (meshes / f"{name}.obj").write_text(corners + faces)
    cache = tmp_path / "packings"
    small = bt.Mesh.read(meshes / "small.obj").pack(1e-3, cache=cache)
    (first,) = cache.iterdir()
    written = first.stat().st_mtime_ns
    study = {
        "question": "Which box?",
        "objects": {"meshes": str(meshes), "surface_error_mm": 1.0, "model": "packed"},
        "skin": {"pitch_mm": 4.0, "taxels": 8, "stroke_mm": 5.0},
        "touches": {"per_object": 8, "depth_mm": 2.0, "yaw_deg": {"uniform": [0.0, 90.0]}},
        "sensing": {"ratio": 4},
        "recognition": {"classifier": "linear_svm"},
    }
    bt.run(study, out=tmp_path / "results")
    assert len(list(cache.iterdir())) == 2 and first.stat().st_mtime_ns == written
    large = bt.Mesh.read(meshes / "large.obj").pack(1e-3, cache=cache)
    assert len(list(cache.iterdir())) == 2 and len(large) > 1
    np.testing.assert_array_equal(small.centers, bt.Mesh.read(meshes / "small.obj").pack(1e-3, cache=cache).centers)
