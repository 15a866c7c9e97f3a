//! Tolerance of packings, measured on every kind of solid.

use bubbletouch_sim::objects::{Shape, Solid, pack, surface_error};
use bubbletouch_sim::random::Seed;
use glam::{DVec2, DVec3};
use rand::Rng;

const MM: f64 = 1e-3;

fn assert_packs(solid: &Solid, tolerance: f64, what: &str) -> usize {
    let union = pack(solid, tolerance).unwrap();
    let spacing = (solid.bounds().size().length() / 60.0).min(20.0 * tolerance);
    let error = surface_error(solid, &union, spacing);
    assert!(
        error.protrusion <= 0.5 * tolerance && error.gap <= tolerance,
        "{what} at {tolerance}: {error:?}, {} spheres",
        union.n_spheres()
    );
    union.n_spheres()
}

fn random_shape(rng: &mut impl Rng) -> Shape {
    // Lengths over four decades, for thin plates, needles, tiny and huge solids.
    let mut length = || MM * 10f64.powf(rng.gen_range(-1.0..2.5));
    let (a, b, c) = (length(), length(), length());
    match rng.gen_range(0..10) {
        0 => Shape::Ball { diameter: a },
        1 => Shape::Box {
            size: DVec3::new(a, b, c),
            rounding: 0.0,
        },
        2 => Shape::Box {
            size: DVec3::new(a, b, c),
            rounding: rng.gen_range(0.0..=0.5) * a.min(b).min(c),
        },
        3 => Shape::Cylinder {
            diameter: a,
            height: b,
        },
        4 => Shape::Capsule {
            diameter: a,
            length: a + b,
        },
        5 => Shape::ConeFrustum {
            bottom_diameter: a,
            top_diameter: if rng.gen_bool(0.3) { 0.0 } else { b },
            height: c,
        },
        6 => Shape::Torus {
            ring_diameter: a + b,
            tube_diameter: a,
        },
        7 => Shape::Tube {
            outer_diameter: a + b,
            inner_diameter: a,
            height: c,
        },
        8 => Shape::SphereSweep {
            points: vec![DVec3::ZERO, DVec3::new(a, b, c), DVec3::new(-b, c, a)],
            diameters: vec![c, a, b],
        },
        _ => Shape::Prism {
            outline: vec![
                DVec2::ZERO,
                DVec2::new(a, 0.1 * b),
                DVec2::new(0.5 * a, 0.3 * b),
                DVec2::new(0.6 * a, b),
            ],
            thickness: c,
        },
    }
}

#[test]
fn random_solids_pack_within_the_tolerance() {
    for case in 0..600 {
        let mut rng = Seed::new(2).named("packing").numbered(case).rng();
        let shape = random_shape(&mut rng);
        let solid = Solid::from_shape(shape.clone()).unwrap();
        let size = solid.bounds().size().max_element();
        let tolerance = size * 10f64.powf(rng.gen_range(-2.7..0.7));
        assert_packs(&solid, tolerance, &format!("case {case}: {shape:?}"));
    }
}
