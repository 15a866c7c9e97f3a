//! Own objects: the example of the guide can be built, its page lists every shape and key, and holes of meshes are closed only on demand.

use crate::command::{Case, says};
use bubbletouch::mesh::LengthUnit;
use bubbletouch::objects::{Catalogue, Solid, surface_error};
use bubbletouch::study::{ModelSpec, ObjectsSpec, load_objects};

const MM: f64 = 1e-3;

/// The page about own objects.
const GUIDE: &str = include_str!("../../guide/objects.md");

#[test]
fn the_nut_of_the_guide_is_built() {
    let example = GUIDE.split("```toml\n").nth(1).unwrap();
    let example = example.split("```").next().unwrap();
    let catalogue = Catalogue::parse("hardware", "hardware.toml", example).unwrap();
    let nut = catalogue.object("nut").unwrap();
    let size = nut.solid.bounds().size();
    assert!((size.y - 13. * MM).abs() < 1e-12 && (size.z - 6.8 * MM).abs() < 1e-12);
    for entry in catalogue.entries() {
        let model = entry.build(0.1 * MM).unwrap().model;
        let error = surface_error(&entry.solid, model.spheres().unwrap(), 0.2 * MM);
        let is_fine = error.protrusion <= 0.05 * MM && error.gap <= 0.1 * MM;
        assert!(is_fine, "{error:?}");
    }
    // A pin along the hole touches nothing.
    let model = nut.build(0.1 * MM).unwrap().model;
    let spheres = model.spheres().unwrap().spheres();
    let mut free = spheres
        .iter()
        .map(|s| s.center.truncate().length() - s.radius);
    assert!(free.all(|gap| gap >= 0.0));
    let wrong = example.replacen("height_mm = 6.8", "height_mm = -2", 1);
    let error = Catalogue::parse("hardware", "hardware.toml", &wrong).unwrap_err();
    assert!(GUIDE.contains(&format!("{error}\n")), "{error}");
}

#[test]
fn the_guide_has_every_shape_and_every_key() {
    let listed = |text: &str| -> Vec<String> {
        let error = Catalogue::parse("own", "own.toml", text).unwrap_err();
        let error = error.to_string();
        let names = error.split('`').skip(1).step_by(2);
        names.map(str::to_owned).collect()
    };
    // The error lists all valid names after the wrong one.
    let part = "[[object]]\nname = \"a\"\nsource = \"b\"\n[[object.part]]\nshape = \"ball\"\n";
    let mut keys = listed(&format!("{part}none = 1\n"))[1..].to_vec();
    let lengths = Solid::written_shapes().flat_map(|(_, lengths)| lengths);
    keys.extend(lengths.map(|key| key.to_string()));
    let of_object = listed("[[object]]\nnone = 1\n");
    assert!(keys.len() > 18 && of_object.len() > 4);
    let is_missing = |name: &&String| {
        let written = [format!("`{name}`"), format!("`{name} =")];
        *name != "none" && !written.iter().any(|text| GUIDE.contains(text))
    };
    let missing: Vec<&String> = keys.iter().chain(&of_object).filter(is_missing).collect();
    assert!(missing.is_empty(), "{missing:?}");
    for (shape, _) in Solid::written_shapes() {
        assert!(GUIDE.contains(&format!("| `\"{shape}\"` |")), "{shape}");
    }
}

#[test]
fn a_study_closes_holes_only_where_it_is_told_to() {
    let hole = include_str!("../fixtures/texts/cube_with_hole.obj");
    let case = Case::with("meshes/cube.obj", hole);
    let load = |model, close_holes_mm| {
        let spec = ObjectsSpec {
            meshes: Some(case.path("meshes").into()),
            model: Some(model),
            unit: Some(LengthUnit::Millimetre),
            surface_error_mm: Some(1.0),
            close_holes_mm,
            ..ObjectsSpec::default()
        };
        load_objects(&spec, None).map(|objects| objects[0].model.clone())
    };
    let closed = load(ModelSpec::Packed, Some(1.0)).unwrap();
    assert!(closed.n_spheres() > 10);
    assert_eq!(load(ModelSpec::Mesh, Some(1.0)).unwrap().n_triangles(), 20);
    assert_eq!(load(ModelSpec::Mesh, None).unwrap().n_triangles(), 17);
    let said = |model, close_holes_mm| load(model, close_holes_mm).unwrap_err().to_string();
    for too_narrow in [None, Some(0.8)] {
        let words = ["cube.obj: a hole 0.90 mm wide", "objects.close_holes_mm"];
        says(&said(ModelSpec::Packed, too_narrow), &words);
    }
    let vertices = said(ModelSpec::VertexSpheres, Some(1.0));
    says(&vertices, &["close_holes_mm"]);
}
