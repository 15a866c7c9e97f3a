//! Laws of the signal of skins other than grids: comparison with grids, and symmetries.

use super::{PITCH, TAXEL, grid, smoothing};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::{Chain, SENSOR_ERRORS, SensorError, SignalStep};
use bubbletouch_sim::world::{Layout, Patch, Taxels};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

fn skin(layout: Layout) -> Patch {
    Patch::new("palm", layout, Taxels::Equal(TAXEL)).unwrap()
}

/// Returns the taxels of a grid in a layout without the rule of a grid.
fn scattered(patch: &Patch) -> Patch {
    let layout = patch.layout();
    skin(Layout::new(layout.centers().to_vec(), layout.axes().to_vec()).unwrap())
}

fn read(steps: &[SignalStep], skin: &Patch, frame: &[f64]) -> Vec<f64> {
    super::read(steps, skin, frame, 3)
}

fn refused(steps: &[SignalStep], skin: &Patch) -> String {
    Chain::new(steps, skin).unwrap_err().to_string()
}

/// Returns arbitrary deflections, metres.
fn frame(n: usize) -> Vec<f64> {
    (0..n)
        .map(|k| 2e-3 * (1.0 + (3.7 * k as f64).sin()))
        .collect()
}

fn crosstalk(leak: f64) -> SignalStep {
    SensorError::Crosstalk.step(&[leak], Seed::new(1)).unwrap()
}

#[test]
fn crosstalk_over_neighbours_is_that_of_the_grid() {
    for (nx, ny) in [(1, 6), (8, 1), (9, 7)] {
        let (patch, frame) = (grid(nx, ny), frame(nx * ny));
        let of_grid = read(&[crosstalk(0.3)], &patch, &frame);
        let found = read(&[crosstalk(0.3)], &scattered(&patch), &frame);
        let sums: [f64; 2] = [&of_grid, &found].map(|values| values.iter().sum());
        assert!((sums[0] - sums[1]).abs() < 1e-15);
        // On a line a taxel has two neighbours; each receives half of the leak instead of a quarter.
        if nx > 1 && ny > 1 {
            for (a, b) in found.iter().zip(&of_grid) {
                assert!((a - b).abs() < 1e-17);
            }
        }
    }
}

#[test]
fn smoothing_along_the_surface_is_that_of_the_grid_away_from_its_edges() {
    let (nx, ny) = (41, 37);
    let (patch, frame) = (grid(nx, ny), frame(nx * ny));
    let skin = scattered(&patch);
    for width in [0.6, 1.0, 2.0] {
        let steps = [smoothing(width)];
        let of_grid = read(&steps, &patch, &frame);
        let found = read(&steps, &skin, &frame);
        let edge = (4.0 * width + 1.0) as usize;
        for (taxel, (a, b)) in found.iter().zip(&of_grid).enumerate() {
            let (x, y) = (taxel % nx, taxel / nx);
            let is_inner = x.min(nx - 1 - x).min(y.min(ny - 1 - y)) >= edge;
            // Taxels beyond four widths have a total weight of 3e-4.
            assert!(!is_inner || (a - b).abs() < 2e-3 * 4e-3, "{width}: {a} {b}");
        }
    }
}

#[test]
fn an_even_frame_stays_and_a_turn_of_a_cylinder_turns_what_is_read() {
    let around = Layout::cylinder(0.02, 0.03, TAU, PITCH).unwrap();
    let centers = around.centers().to_vec();
    let n = centers.len();
    let is_in_first_ring = |center: &&DVec3| (center.z - centers[0].z).abs() < 1e-9;
    let n_around = centers.iter().filter(is_in_first_ring).count();
    let turn = DQuat::from_rotation_z(TAU / n_around as f64);
    let turned = |taxel: usize| {
        let place = turn * centers[taxel];
        let found = centers
            .iter()
            .position(|other| other.distance(place) < 1e-9);
        found.expect("a ring has the same taxels after a turn by one")
    };
    let turned: Vec<usize> = (0..n).map(turned).collect();
    let skin = skin(around);
    for step in [smoothing(1.7), crosstalk(0.4)] {
        for value in read(&[step], &skin, &vec![1e-3; n]) {
            assert!((value - 1e-3).abs() < 1e-17);
        }
        let pressed = frame(n);
        let mut elsewhere = vec![0.0; n];
        for (taxel, &value) in pressed.iter().enumerate() {
            elsewhere[turned[taxel]] = value;
        }
        let (here, there) = (
            read(&[step], &skin, &pressed),
            read(&[step], &skin, &elsewhere),
        );
        for (taxel, value) in here.iter().enumerate() {
            assert!((there[turned[taxel]] - value).abs() < 1e-15, "{step:?}");
        }
    }
}

#[test]
fn steps_that_know_no_neighbours_read_a_dome_as_any_row_of_as_many_taxels() {
    let cap = skin(Layout::sphere_cap(0.02, 1.0, PITCH).unwrap());
    let n = cap.n_taxels();
    let row = grid(n, 1);
    for error in SENSOR_ERRORS.iter().filter(|one| !one.about().needs_places) {
        let is_whole = error.about().strengths[0].is_whole;
        let strength = if is_whole { 6.0 } else { 0.1 };
        let step = error.step(&[strength], Seed::new(1)).unwrap();
        let read = |skin| read(&[SignalStep::Force, step], skin, &frame(n));
        let (found, expected) = (read(&cap), read(&row));
        assert_eq!(found, expected, "{error:?}");
    }
}

#[test]
fn what_a_layout_or_unlike_taxels_cannot_read_is_refused() {
    let layout = || Layout::disc(6e-3, PITCH).unwrap();
    let matrix = SensorError::MatrixReadout
        .step(&[0.1], Seed::new(1))
        .unwrap();
    assert_eq!(
        refused(&[matrix], &skin(layout())),
        "matrix readout: a skin that is no grid; a grid: a matrix has rows and columns"
    );
    let bad = SignalStep::Smoothing { width: -1e-3 };
    assert!(refused(&[bad], &skin(layout())).starts_with("smoothing width: -0.001 m"));
    let mut taxels = vec![TAXEL; layout().n_taxels()];
    taxels[3].radius = 0.5e-3;
    let wide = Patch::new("palm", layout(), Taxels::Each(taxels.clone())).unwrap();
    assert!(Chain::new(&[smoothing(1.0)], &wide).is_ok());
    taxels[3].stiffness = 100.0;
    let soft = Patch::new("palm", layout(), Taxels::Each(taxels)).unwrap();
    assert_eq!(
        refused(&[], &soft),
        "signal of skin patch palm: taxels of unlike stroke, stiffness or damping; taxels that read alike"
    );
}

/// Smooths a frame by the definition: weights by the distance along a plane, for every pair of taxels within four widths.
fn smoothed_by_definition(skin: &Patch, frame: &[f64], width: f64) -> Vec<f64> {
    let centers = skin.layout().centers();
    let of_taxel = |center: &DVec3| {
        let weights = centers.iter().map(|other| match other.distance(*center) {
            far if far > 4.0 * width => 0.0,
            near => (-0.5 * (near / width).powi(2)).exp(),
        });
        let (mut sum, mut total) = (0.0, 0.0);
        for (weight, value) in weights.zip(frame) {
            sum += weight * value;
            total += weight;
        }
        sum / total
    };
    centers.iter().map(of_taxel).collect()
}

#[test]
fn smoothing_reaches_as_far_as_its_width_whatever_the_spacing() {
    let flat = |places: Vec<DVec3>| {
        let axes = vec![DVec3::Z; places.len()];
        skin(Layout::new(places, axes).unwrap())
    };
    let rows = |across: f64| {
        let place = |k: usize| DVec3::new(1e-3 * (k % 21) as f64, across * (k / 21) as f64, 0.0);
        flat((0..63).map(place).collect())
    };
    let twice: Vec<DVec3> = (0..50)
        .map(|k| PITCH * DVec3::new((k / 2 % 5) as f64, (k / 10) as f64, 0.0))
        .collect();
    let pads = (0..32).map(|k| {
        let gap = if k < 16 { 0.0 } else { 9e-3 };
        DVec3::new(1e-3 * (k % 4) as f64 + gap, 1e-3 * (k / 4 % 4) as f64, 0.0)
    });
    let skins = [
        rows(2.9e-3),
        rows(3.1e-3),
        rows(15e-3),
        flat(twice),
        flat(pads.collect()),
    ];
    for (number, skin) in skins.iter().enumerate() {
        for width in [1e-3, 4e-3, 22e-3] {
            let frame = frame(skin.n_taxels());
            let found = read(&[SignalStep::Smoothing { width }], skin, &frame);
            let expected = smoothed_by_definition(skin, &frame, width);
            for (found, expected) in found.iter().zip(&expected) {
                assert!(
                    (found - expected).abs() < 1e-15,
                    "skin {number}, {width} m: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn crosstalk_reaches_other_rows_and_taxels_beside_coincident_ones() {
    let rows = |k: usize| DVec3::new(1e-3 * (k % 5) as f64, 3.1e-3 * (k / 5) as f64, 0.0);
    let twice = |k: usize| PITCH * DVec3::new((k / 2) as f64, 0.0, 0.0);
    let skins = [
        ((0..15).map(rows).collect(), 7, 2),
        ((0..10).map(twice).collect::<Vec<_>>(), 4, 2),
    ];
    for (places, pressed, beside) in skins {
        let n = places.len();
        let skin = skin(Layout::new(places, vec![DVec3::Z; n]).unwrap());
        let mut frame = vec![0.0; n];
        frame[pressed] = 1e-3;
        let read = read(&[crosstalk(0.4)], &skin, &frame);
        assert!(read[beside] > 0.0, "{read:?}");
        assert!((read.iter().sum::<f64>() - 1e-3).abs() < 1e-15);
    }
}
