//! Laws of the built-in objects (dimensions, rest positions and accuracy of their spheres), and errors of invalid catalogue files.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Catalogue, Entry, Shape, Solid, SphereUnion, surface_error};
use bubbletouch_sim::random::Seed;
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;
use rayon::prelude::*;
use std::sync::Mutex;

use crate::cases::each_change;

const MM: f64 = 1e-3;

#[test]
fn the_sets_hold_the_published_numbers_of_objects() {
    let catalogue = Catalogue::builtin().unwrap();
    let sets = ["balls", "boxes", "cans", "household", "hands"];
    assert_eq!(catalogue.sets(), sets);
    let n = |set| catalogue.set(set).unwrap().len();
    assert_eq!([n("balls"), n("boxes"), n("cans")], [16, 16, 9]);
    assert!(n("household") >= 24);
}

#[test]
fn balls_boxes_and_cans_have_the_published_dimensions() {
    let catalogue = Catalogue::builtin().unwrap();
    let shapes = |set| {
        let entries = catalogue.set(set).unwrap().into_iter();
        entries.map(|e| e.solid.parts()[0].shape().clone())
    };
    let list = |text: &str| -> Vec<f64> { text.split(' ').map(|n| n.parse().unwrap()).collect() };
    let balls = "39.5 42.67 57 63.5 65.41 71.3 73 92 97.1 107 110 185 207 216 226 238.8";
    let balls = list(balls)
        .into_iter()
        .map(|d| Shape::Ball { diameter: d * MM });
    assert!(balls.eq(shapes("balls")));
    let boxes = "158 60 210, 89 38 175, 110 28 89, 85 50 73, 197 51 304, 197 63 304, 141 100 252, 82 33 140, \
                 80 49 116, 152 57 195, 135 44 197, 154 16 78, 158 51 108, 133 63 196, 143 38 193, 168 65 144";
    let boxes = boxes.split(", ").map(|size| Shape::Box {
        size: DVec3::from_slice(&list(size)) * MM,
        rounding: 0.0,
    });
    assert!(boxes.eq(shapes("boxes")));
    let cans = "54 57.2, 68.3 39.7, 76.2 39.7, 77.8 34.9, 81 111.1, 87.3 46, 103.2 119.1, 108 87.3, 157.2 109.5";
    let cans = cans.split(", ").map(|size| Shape::Cylinder {
        diameter: list(size)[0] * MM,
        height: list(size)[1] * MM,
    });
    assert!(cans.eq(shapes("cans")));
}

#[test]
fn every_object_rests_on_the_table_in_the_middle() {
    let tolerance = 0.5 * MM;
    for entry in Catalogue::builtin().unwrap().entries() {
        let exact = entry.solid.bounds();
        assert!(exact.min.z.abs() < 1e-12, "{}", entry.name);
        assert!(exact.center().truncate().length() < 1e-12, "{}", entry.name);
        let spheres = entry.build(tolerance).unwrap().model.bounds();
        for apart in [spheres.min - exact.min, spheres.max - exact.max] {
            let apart = apart.abs().max_element();
            assert!(apart <= tolerance, "{}: {apart}", entry.name);
        }
    }
}

/// Returns the spheres of an object at two surface errors, metres.
fn packed(entry: &Entry) -> [(f64, SphereUnion); 2] {
    [0.5 * MM, 0.25 * MM].map(|tolerance| {
        let model = entry.build(tolerance).unwrap().model;
        (tolerance, model.spheres().unwrap().clone())
    })
}

#[test]
fn sizes_after_the_word_here_are_the_sizes_of_the_object() {
    let mut n_stated = 0;
    for entry in Catalogue::builtin().unwrap().entries() {
        let Some((_, here)) = entry.source.split_once("; here ") else {
            continue;
        };
        let (sizes, _) = here.split_once(" mm").unwrap();
        let sizes = sizes.split(" × ").map(|size| size.parse().unwrap());
        let found = entry.solid.bounds().size() / MM;
        let apart = (found - DVec3::from_slice(&sizes.collect::<Vec<f64>>())).abs();
        assert!(apart.max_element() <= 0.55, "{}: {found}", entry.name);
        n_stated += 1;
    }
    assert_eq!(n_stated, 8);
}

#[test]
fn every_object_packs_within_its_surface_error() {
    for entry in Catalogue::builtin().unwrap().entries() {
        for (tolerance, union) in packed(entry) {
            let spacing = entry.solid.bounds().size().max_element() / 40.0;
            let error = surface_error(&entry.solid, &union, spacing);
            assert!(
                error.protrusion <= 0.5 * tolerance && error.gap <= tolerance,
                "{} at {tolerance}: {error:?}",
                entry.name
            );
        }
    }
}

/// Returns the points where random lines first meet the solid, and where they first meet the spheres.
///
/// The only shared code with packing and its measurement is the solid's distance function.
fn first_hits(solid: &Solid, union: &SphereUnion, n_hits: usize) -> [Vec<DVec3>; 2] {
    let mut rng = Seed::new(9).named("lines").rng();
    let bounds = solid.bounds();
    let (middle, radius) = (bounds.center(), bounds.size().length());
    let mut hits = [Vec::new(), Vec::new()];
    while hits[0].len() < n_hits {
        let around = DVec2::from_angle(rng.gen_range(0.0..std::f64::consts::TAU));
        let z = rng.gen_range(-1.0..1.0f64);
        let across = DVec2::from_angle(rng.gen_range(0.0..std::f64::consts::TAU));
        let share = rng.r#gen::<f64>();
        // The line passes through a point of a disc across the direction.
        let along = ((1.0 - z * z).sqrt() * around).extend(z);
        let (side, other) = along.any_orthonormal_pair();
        let across = 0.6 * radius * share.sqrt() * (across.x * side + across.y * other);
        let start = middle + across - radius * along;
        let of_spheres = union.spheres().iter().filter_map(|sphere| {
            let to = sphere.center - start;
            let ahead = to.dot(along);
            let square = sphere.radius.powi(2) - (to.length_squared() - ahead * ahead);
            (square > 0.0).then(|| ahead - square.sqrt())
        });
        let nearest = of_spheres.fold(f64::INFINITY, f64::min);
        if nearest.is_finite() {
            hits[1].push(start + nearest * along);
        }
        let mut gone = 0.0;
        while gone < 2.0 * radius {
            let left = solid.distance(start + gone * along);
            if left < 1e-10 {
                hits[0].push(start + gone * along);
                break;
            }
            gone += left;
        }
    }
    hits
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn spheres_are_as_often_above_the_surface_as_below_it() {
    let means = Mutex::new(Vec::new());
    let catalogue = Catalogue::builtin().unwrap();
    catalogue.entries().par_iter().for_each(|entry| {
        for (tolerance, union) in packed(entry) {
            let what = format!("{} at {tolerance}", entry.name);
            let [of_solid, of_spheres] = first_hits(&entry.solid, &union, 300);
            // Heights of the spheres over the solid: at points of the solid, and at points of the spheres.
            let above = |point: &DVec3| {
                let spheres = union.spheres().iter();
                let depths = spheres.map(|s| s.radius - s.center.distance(*point));
                depths.fold(f64::NEG_INFINITY, f64::max)
            };
            let there: Vec<f64> = of_solid.iter().map(above).collect();
            let back = of_spheres.iter().map(|&p| entry.solid.distance(p));
            let back: Vec<f64> = back.collect();
            let [low, high] = [f64::min, f64::max].map(|of| there.iter().copied().fold(0.0, of));
            assert!(low >= -tolerance - 1e-9, "{what}: {low} below the surface");
            for heights in [&there, &back] {
                let (mean, highest) = (mean(heights), heights.iter().copied().fold(high, f64::max));
                assert!(highest <= 0.5 * tolerance + 1e-9, "{what}: up to {highest}");
                let allowed = if entry.set == "balls" { 1e-5 } else { 0.25 };
                assert!(
                    mean.abs() <= allowed * tolerance,
                    "{what}: {mean} on average"
                );
            }
            means.lock().unwrap().push(mean(&there) / tolerance);
        }
    });
    let means = means.into_inner().unwrap();
    assert!(mean(&means).abs() < 0.06, "{}", mean(&means));
}

#[test]
fn a_ball_is_one_exact_sphere() {
    let catalogue = Catalogue::builtin().unwrap();
    for entry in catalogue.set("balls").unwrap() {
        let &Shape::Ball { diameter } = entry.solid.parts()[0].shape() else {
            panic!("{} is no ball", entry.name);
        };
        for tolerance in [0.5 * MM, 0.25 * MM, 1e-6 * MM] {
            let model = entry.build(tolerance).unwrap().model;
            let [sphere] = model.spheres().unwrap().spheres() else {
                panic!("{}: more than one sphere", entry.name);
            };
            assert_eq!(sphere.radius, 0.5 * diameter, "{}", entry.name);
        }
    }
    let tennis = catalogue.object("tennis").unwrap().build(0.25 * MM);
    assert!((tennis.unwrap().model.bounds().size().z - 65.41 * MM).abs() < 1e-15);
}

#[test]
fn names_are_unique_over_all_sets() {
    let catalogue = Catalogue::builtin().unwrap();
    for entry in catalogue.entries() {
        let found = catalogue.object(&entry.name).unwrap();
        assert_eq!(found.set, entry.set, "{}", entry.name);
        assert!(!entry.source.is_empty());
    }
}

#[test]
fn rotations_turn_about_the_fixed_x_then_y_then_z_axis() {
    let text = r#"
        [[object]]
        name = "rod"
        source = "test"
        [[object.part]]
        shape = "box"
        size_mm = [1, 2, 30]
        rotation_deg = [20, 30, 40]
        position_mm = [5, 6, 7]
    "#;
    let catalogue = Catalogue::parse("own", "own.toml", text).unwrap();
    let solid = &catalogue.entries()[0].solid;
    let [x, y, z] = [20f64, 30., 40.].map(f64::to_radians);
    let turned = DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x);
    let middle = solid.bounds().center();
    let tip = Pose::new(turned, middle).transform_point(DVec3::new(0.0, 0.0, 15.0 * MM));
    assert!(solid.distance(tip).abs() < 1e-12);
    assert!((solid.distance(middle) + 0.5 * MM).abs() < 1e-12);
}

#[test]
fn a_wrong_catalogue_names_file_line_and_object() {
    let good = "[[object]]\nname = \"mug\"\nsource = \"us\"\n[[object.part]]\nshape = \"cylinder\"\ndiameter_mm = 80\nheight_mm = 90\n";
    let parse = |text: &str| Catalogue::parse("own", "own.toml", text);
    assert_eq!(parse(good).unwrap().entries().len(), 1);
    let refuse = |text: &str, expected: &str| {
        let error = parse(text).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        let shown = error.to_string();
        let is_expected = shown.starts_with(expected) && !shown.contains('\n');
        assert!(is_expected, "expected `{expected}` in: {shown}");
    };
    refuse("", "own.toml: no objects");
    refuse(
        &good.repeat(2),
        "own.toml, line 9, object `mug`: a name that an earlier object has",
    );
    let no_parts = good[..good.find("[[object.part]]").unwrap()].to_owned() + "part = []\n";
    refuse(&no_parts, "own.toml, line 2, object `mug`: solid: no parts");
    // A text of the file, what replaces it, and the beginning of the error.
    let changes = r#"= 80 | =  | own.toml:6:
        height_mm | hieght_mm | own.toml, line 7, object `mug`, part 1 (cylinder): hieght_mm: given for a cylinder; perhaps `height_mm`
        80 | "wide" | own.toml, line 6, object `mug`, part 1 (cylinder): diameter_mm: "wide"; a number
        80 | [1, 2] | own.toml, line 6, object `mug`, part 1 (cylinder): diameter_mm: [1, 2]; a number
        "cylinder" | "cilinder" | own.toml, line 5, object `mug`, part 1 (cilinder): shape: `cilinder`; perhaps `cylinder`
        "cylinder" | 3 | own.toml, line 5, object `mug`, part 1: shape: missing
        "cylinder"\ndiameter_mm = 80\nheight_mm = 90 | "box"\nsize_mm = [1, 2] | own.toml, line 6, object `mug`, part 1 (box): size_mm: [1, 2]; three numbers
        "cylinder"\ndiameter_mm = 80\nheight_mm = 90 | "lathe"\nprofile_mm = [[1, 2], [3]] | own.toml, line 6, object `mug`, part 1 (lathe): profile_mm: [[1, 2], [3]]; a list of pairs of numbers
        source = "us"\n |  | own.toml:1:1: missing field `source`
        80 | -80 | own.toml, line 6, object `mug`, part 1 (cylinder): diameter_mm = -80; a finite length of at least 1e-6
        80 | nan | own.toml:6, key object.mug.part[1].diameter_mm: NaN; a finite number
        height_mm = 90 | height_mm = -2 | own.toml, line 7, object `mug`, part 1 (cylinder): height_mm = -2; a finite length of at least 1e-6
        80 | 0 | own.toml, line 6, object `mug`, part 1 (cylinder): diameter_mm = 0; a finite length of at least 1e-6
        height_mm = 90\n |  | own.toml, line 5, object `mug`, part 1 (cylinder): height_mm: missing
        "mug" | " " | own.toml, line 2, object ` `: an empty name
        90\n | 90\nlength_mm = 3\n | own.toml, line 8, object `mug`, part 1 (cylinder): length_mm: given for a cylinder
        90\n | 90\nposition_mm = [0, 0, inf]\n | own.toml:8, key object.mug.part[1].position_mm: inf; a finite number
        90\n | 90\nposition_mm = [0, 0]\n | own.toml, line 8, object `mug`, part 1 (cylinder): position_mm: [0, 0]; three finite numbers
        90\n | 90\n[[object.subtract]]\nshape = "ball"\ndiameter_mm = -42.67\n | own.toml, line 10, object `mug`, subtract 1 (ball): diameter_mm = -42.67; a finite length of at least 1e-6
        90\n | 90\n[[object.subtract]]\nshape = "ball"\ndiameter_mm = 900\n | own.toml, line 2, object `mug`: subtract: shapes that take away all parts
        "cylinder"\ndiameter_mm = 80 | "tube"\ninner_diameter_mm = 9\nouter_diameter_mm = 8 | own.toml, line 6, object `mug`, part 1 (tube): inner_diameter_mm = 9; less than the outer diameter of 8
        "cylinder"\ndiameter_mm = 80\nheight_mm = 90 | "prism"\noutline_mm = [[0, 0], [9, 9], [9, 0], [0, 9]]\nthickness_mm = 2 | own.toml, line 6, object `mug`, part 1 (prism): outline_mm: side 1 crosses side 3"#;
    each_change(good, changes, refuse);
}

#[test]
fn an_unknown_name_is_answered_with_names_that_resemble_it() {
    let catalogue = Catalogue::builtin().unwrap();
    let error = catalogue.object("drill").unwrap_err().to_string();
    assert_eq!(error, "object: `drill`; perhaps power_drill");
    let error = catalogue.set("bottles").unwrap_err().to_string();
    let sets = "balls, boxes, cans, household, hands";
    assert_eq!(error, format!("object set: `bottles`; one of {sets}"));
}

#[test]
fn an_unusable_surface_error_is_refused() {
    let catalogue = Catalogue::builtin().unwrap();
    for name in ["soup_can", "cracker_box", "scissors", "banana", "plate"] {
        let entry = catalogue.object(name).unwrap();
        for tolerance in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
            let error = entry.build(tolerance).unwrap_err().to_string();
            assert!(error.starts_with("surface error: "), "{error}");
        }
    }
    for name in ["soup_can", "scissors"] {
        let error = catalogue.object(name).unwrap().build(1e-8).unwrap_err();
        let said = error.to_string();
        assert!(said.contains("more than 2000000 spheres"), "{name}: {said}");
    }
}
