//! The signal of skins that are no grid: what a grid's is where both can be asked, and what symmetry says elsewhere.

use bubbletouch::random::Seed;
use bubbletouch::signal::{
    Chain, Noise, NoiseUnit, SENSOR_ERRORS, Scratch, SensorError, SignalStep,
};
use bubbletouch::world::{Grid, Layout, Patch, Taxel, Taxels};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

const PITCH: f64 = 2e-3;
const TAXEL: Taxel = Taxel {
    radius: 1e-3,
    stiffness: 200.0,
    damping: 0.0,
    stroke: 5e-3,
};

fn skin(layout: Layout) -> Patch {
    Patch::new("palm", layout, Taxels::Equal(TAXEL)).unwrap()
}

fn grid(nx: usize, ny: usize) -> Patch {
    let pitch = PITCH;
    Patch::grid(Grid { nx, ny, pitch }, TAXEL).unwrap()
}

/// The taxels of a grid in a layout that does not know that it is one.
fn scattered(patch: &Patch) -> Patch {
    let layout = patch.layout();
    skin(Layout::new(layout.centers().to_vec(), layout.axes().to_vec()).unwrap())
}

fn read(steps: &[SignalStep], skin: &Patch, frame: &[f64]) -> Vec<f64> {
    let chain = Chain::new(steps, skin).unwrap();
    let mut out = frame.to_vec();
    let touch = Seed::new(2018).numbered(3);
    chain.apply(&mut out, None, &touch, &mut Scratch::default());
    out
}

fn refused(steps: &[SignalStep], skin: &Patch) -> String {
    Chain::new(steps, skin).unwrap_err().to_string()
}

/// Any deflections, metres.
fn frame(n: usize) -> Vec<f64> {
    (0..n)
        .map(|k| 2e-3 * (1.0 + (3.7 * k as f64).sin()))
        .collect()
}

fn smoothing(width_pitches: f64) -> SignalStep {
    SignalStep::Smoothing {
        width: width_pitches * PITCH,
    }
}

fn crosstalk(leak: f64) -> SignalStep {
    SensorError::Crosstalk.step(&[leak], Seed::new(1))
}

#[test]
fn a_skin_that_is_a_grid_reads_the_bits_of_the_grid() {
    let patch = grid(9, 7);
    let noise = SignalStep::Noise(Noise {
        std: 0.05,
        unit: NoiseUnit::FullScale,
    });
    let mut steps = vec![noise, smoothing(1.5), SignalStep::Force];
    for error in SENSOR_ERRORS {
        let strength = if *error == SensorError::Quantisation {
            6.0
        } else {
            0.1
        };
        steps.push(error.step(&[strength], Seed::new(1)));
    }
    let of_grid = read(&steps, &patch, &frame(63));
    assert_eq!(read(&steps, &patch.clone(), &frame(63)), of_grid);
}

#[test]
fn crosstalk_over_neighbours_is_that_of_the_grid() {
    for (nx, ny) in [(1, 6), (8, 1), (9, 7)] {
        let (patch, frame) = (grid(nx, ny), frame(nx * ny));
        let of_grid = read(&[crosstalk(0.3)], &patch, &frame);
        let found = read(&[crosstalk(0.3)], &scattered(&patch), &frame);
        let sums: [f64; 2] = [&of_grid, &found].map(|values| values.iter().sum());
        assert!((sums[0] - sums[1]).abs() < 1e-15);
        // A line has two neighbours: each gets half of the leak and not a quarter.
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
            // What is beyond four widths has a weight of 3e-4.
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
    for error in SENSOR_ERRORS {
        let knows = [SensorError::Crosstalk, SensorError::MatrixReadout];
        if knows.contains(error) {
            continue;
        }
        let strength = if *error == SensorError::Quantisation {
            6.0
        } else {
            0.1
        };
        let steps = [SignalStep::Force, error.step(&[strength], Seed::new(1))];
        let (found, expected) = (read(&steps, &cap, &frame(n)), read(&steps, &row, &frame(n)));
        assert_eq!(found, expected, "{error:?}");
    }
}

#[test]
fn what_a_layout_or_unlike_taxels_cannot_read_is_refused() {
    let layout = || Layout::disc(6e-3, PITCH).unwrap();
    let matrix = SensorError::MatrixReadout.step(&[0.1], Seed::new(1));
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
