//! Laws of the built-in objects (dimensions, rest positions and accuracy of their spheres), and errors of invalid catalogue files.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Catalogue, Entry, Shape, Solid, SphereUnion, surface_error};
use bubbletouch_sim::random::Seed;
use glam::{DQuat, DVec3};
use rand::Rng;
use rayon::prelude::*;
use std::sync::Mutex;

const MM: f64 = 1e-3;

#[test]
fn the_sets_hold_the_published_numbers_of_objects() {
    let catalogue = Catalogue::builtin().unwrap();
    assert_eq!(
        catalogue.sets(),
        ["balls", "boxes", "cans", "household", "hands"]
    );
    let n = |set| catalogue.set(set).unwrap().len();
    assert_eq!([n("balls"), n("boxes"), n("cans")], [16, 16, 9]);
    assert!(n("household") >= 24);
}

#[test]
fn balls_boxes_and_cans_have_the_published_dimensions() {
    let catalogue = Catalogue::builtin().unwrap();
    let shapes = |set| {
        let entries = catalogue.set(set).unwrap().into_iter();
        entries
            .map(|e| e.solid.parts()[0].shape().clone())
            .collect::<Vec<_>>()
    };
    let diameters = [
        39.5, 42.67, 57., 63.5, 65.41, 71.3, 73., 92., 97.1, 107., 110., 185., 207., 216., 226.,
        238.8,
    ];
    let balls = diameters.map(|d| Shape::Ball { diameter: d * MM });
    assert_eq!(shapes("balls"), balls);
    let sizes = [
        [158, 60, 210],
        [89, 38, 175],
        [110, 28, 89],
        [85, 50, 73],
        [197, 51, 304],
        [197, 63, 304],
        [141, 100, 252],
        [82, 33, 140],
        [80, 49, 116],
        [152, 57, 195],
        [135, 44, 197],
        [154, 16, 78],
        [158, 51, 108],
        [133, 63, 196],
        [143, 38, 193],
        [168, 65, 144],
    ];
    let boxes = sizes.map(|size| Shape::Box {
        size: DVec3::from(size.map(f64::from)) * MM,
        rounding: 0.0,
    });
    assert_eq!(shapes("boxes"), boxes);
    let cans = [
        (54., 57.2),
        (68.3, 39.7),
        (76.2, 39.7),
        (77.8, 34.9),
        (81., 111.1),
        (87.3, 46.),
        (103.2, 119.1),
        (108., 87.3),
        (157.2, 109.5),
    ];
    let cans = cans.map(|(d, h)| Shape::Cylinder {
        diameter: d * MM,
        height: h * MM,
    });
    assert_eq!(shapes("cans"), cans);
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
            assert!(
                apart.abs().max_element() <= tolerance,
                "{}: {apart}",
                entry.name
            );
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
        let sizes: Vec<f64> = sizes
            .split(" × ")
            .map(|size| size.parse().unwrap())
            .collect();
        let found = entry.solid.bounds().size() / MM;
        assert!(
            (found - DVec3::from_slice(&sizes)).abs().max_element() <= 0.55,
            "{}: {found}",
            entry.name
        );
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
        let mut on_sphere = || {
            let (turn, z) = (
                rng.gen_range(0.0..std::f64::consts::TAU),
                rng.gen_range(-1.0..1.0f64),
            );
            let out = (1.0 - z * z).sqrt();
            DVec3::new(out * turn.cos(), out * turn.sin(), z)
        };
        // The line passes through a point of a disc across the direction.
        let along = on_sphere();
        let (side, other) = along.any_orthonormal_pair();
        let (turn, share) = (
            rng.gen_range(0.0..std::f64::consts::TAU),
            rng.r#gen::<f64>(),
        );
        let across = 0.6 * radius * share.sqrt() * (turn.cos() * side + turn.sin() * other);
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
            let back: Vec<f64> = of_spheres
                .iter()
                .map(|&p| entry.solid.distance(p))
                .collect();
            let [low, high] = [f64::min, f64::max].map(|of| there.iter().copied().fold(0.0, of));
            assert!(low >= -tolerance - 1e-9, "{what}: {low} below the surface");
            for heights in [&there, &back] {
                let (mean, highest) = (mean(heights), heights.iter().copied().fold(high, f64::max));
                assert!(
                    highest <= 0.5 * tolerance + 1e-9,
                    "{what}: {highest} above the surface"
                );
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
    let tennis = catalogue
        .object("tennis")
        .unwrap()
        .build(0.25 * MM)
        .unwrap();
    assert!((tennis.model.bounds().size().z - 65.41 * MM).abs() < 1e-15);
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
    assert_eq!(
        Catalogue::parse("own", "own.toml", good)
            .unwrap()
            .entries()
            .len(),
        1
    );
    let tube = good.replace("cylinder", "tube").replace(
        "diameter_mm = 80",
        "inner_diameter_mm = 9\nouter_diameter_mm = 8",
    );
    let bow_tie = good.replace("cylinder", "prism").replace(
        "diameter_mm = 80\nheight_mm = 90",
        "outline_mm = [[0, 0], [9, 9], [9, 0], [0, 9]]\nthickness_mm = 2",
    );
    let cases = [
        (String::new(), "own.toml: no objects"),
        (
            good.replace("= 80", "= "),
            "own.toml, line 6, object \"mug\": ",
        ),
        (
            good.replace("height_mm", "hieght_mm"),
            "own.toml, line 7, object `mug`, part 1 (cylinder): hieght_mm: given for a cylinder; perhaps `height_mm`",
        ),
        (
            good.replace("80", "\"wide\""),
            "own.toml, line 6, object `mug`, part 1 (cylinder): diameter_mm: invalid type: string",
        ),
        (
            good.replace("cylinder", "cilinder"),
            "own.toml, line 5, object `mug`, part 1 (cilinder): shape: `cilinder`; perhaps `cylinder`",
        ),
        (
            good.replace("source = \"us\"\n", ""),
            "own.toml, line 1, object \"mug\": missing field `source`",
        ),
        (
            good.replace("80", "-80"),
            "own.toml, line 6, object `mug`, part 1 (cylinder): diameter_mm = -80; a finite positive",
        ),
        (
            good.replace("80", "nan"),
            "own.toml:6, key object.mug.part[1].diameter_mm: NaN; a finite number",
        ),
        (
            good.replace("height_mm = 90", "height_mm = -2"),
            "own.toml, line 7, object `mug`, part 1 (cylinder): height_mm = -2; a finite positive",
        ),
        (
            good.to_string() + "[[object.subtract]]\nshape = \"ball\"\ndiameter_mm = -42.67\n",
            "own.toml, line 10, object `mug`, subtract 1 (ball): diameter_mm = -42.67; a finite positive",
        ),
        (
            good.to_string() + "[[object.subtract]]\nshape = \"ball\"\ndiameter_mm = 900\n",
            "own.toml, line 2, object `mug`: subtract: shapes that take away all parts",
        ),
        (
            good.replace("80", "0"),
            "own.toml, line 6, object `mug`, part 1 (cylinder): diameter_mm = 0; a finite positive",
        ),
        (
            good.replace("height_mm = 90\n", ""),
            "own.toml, line 5, object `mug`, part 1 (cylinder): height_mm: missing",
        ),
        (
            good.to_string() + "length_mm = 3\n",
            "own.toml, line 8, object `mug`, part 1 (cylinder): length_mm: given for a cylinder",
        ),
        (
            good.to_string() + "position_mm = [0, 0, inf]\n",
            "own.toml:8, key object.mug.part[1].position_mm: inf; a finite number",
        ),
        (
            good.repeat(2),
            "own.toml, line 9, object `mug`: a name that an earlier object has",
        ),
        (
            good.replace("\"mug\"", "\" \""),
            "own.toml, line 2, object ` `: an empty name",
        ),
        (
            tube,
            "own.toml, line 6, object `mug`, part 1 (tube): inner_diameter_mm = 9; less than the outer diameter of 8",
        ),
        (
            bow_tie,
            "own.toml, line 6, object `mug`, part 1 (prism): outline_mm: side 1 crosses side 3",
        ),
        (
            good[..good.find("[[object.part]]").unwrap()].to_string() + "part = []\n",
            "own.toml, line 2, object `mug`: solid: no parts",
        ),
    ];
    for (text, expected) in cases {
        let error = Catalogue::parse("own", "own.toml", &text).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        let shown = error.to_string();
        assert!(
            shown.starts_with(expected) && !shown.contains('\n'),
            "expected `{expected}` in: {shown}"
        );
    }
}

#[test]
fn an_unknown_name_is_answered_with_names_that_resemble_it() {
    let catalogue = Catalogue::builtin().unwrap();
    let error = catalogue.object("drill").unwrap_err().to_string();
    assert_eq!(error, "object: `drill`; perhaps power_drill");
    let error = catalogue.set("bottles").unwrap_err().to_string();
    assert_eq!(
        error,
        "object set: `bottles`; one of balls, boxes, cans, household, hands"
    );
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
        assert!(
            error.to_string().contains("more than 2000000 spheres"),
            "{name}: {error}"
        );
    }
}
