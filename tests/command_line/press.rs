//! `bubbletouch press`: one reading as numbers, as arrays, as a picture, and as text in the terminal.

use crate::command::{Case, says};
use ndarray::{Array1, Array2, Axis, s};
use ndarray_npy::NpzReader;
use std::fs::File;

/// Reads a frame from a CSV file; also returns the numbers of significant digits.
fn read_csv(case: &Case, name: &str) -> (Array2<f64>, Vec<usize>) {
    let text = case.read(name);
    let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
    let digits = |number: &&str| {
        let mantissa = number.split('e').next().unwrap();
        mantissa.chars().filter(char::is_ascii_digit).count()
    };
    let digits = rows.iter().flatten().map(digits).collect();
    let values = rows.iter().flatten().map(|v| v.parse().unwrap()).collect();
    let frame = Array2::from_shape_vec((rows.len(), rows[0].len()), values).unwrap();
    (frame, digits)
}

/// Runs `press` with these arguments and reads the frame.
fn pressed(arguments: &str) -> Array2<f64> {
    let case = Case::new();
    case.succeeds(&format!("press --out frame.csv {arguments}"));
    read_csv(&case, "frame.csv").0
}

fn deepest(frame: &Array2<f64>) -> f64 {
    frame.iter().copied().fold(0.0, f64::max)
}

fn largest_difference(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    (a - b).iter().fold(0.0, |largest, d| d.abs().max(largest))
}

/// Sphere of 30 mm radius, 29 mm in front of 24 × 10 taxels with 1.5 mm radius and 2.5 mm pitch.
const SPHERE: &str = "x,y,z,r\n0.004,-0.003,0.029,0.03\n";
const ARRAY: &str =
    "press --spheres sphere.csv --taxels 24x10 --pitch-mm=2.5 --taxel-radius-mm=1.5 --stroke-mm=2";

/// Returns the closed form δ = min(s, max(0, √(S² − b²) − h)).
fn closed_form() -> Array2<f64> {
    Array2::from_shape_fn((10, 24), |(row, column)| {
        let x = (column as f64 - 11.5) * 2.5e-3;
        let y = (row as f64 - 4.5) * 2.5e-3;
        let reach: f64 = 0.03 + 1.5e-3;
        let b2 = (x - 0.004).powi(2) + (y + 0.003).powi(2);
        let height = (reach * reach - b2).max(0.0).sqrt();
        (height - 0.029).clamp(0.0, 2e-3)
    })
}

#[test]
fn the_csv_of_one_sphere_is_the_closed_form_with_17_digits() {
    let case = Case::with("sphere.csv", SPHERE);
    let (_, said) = case.succeeds(&format!("{ARRAY} --out frame.csv"));
    let (frame, digits) = read_csv(&case, "frame.csv");
    assert_eq!(frame.dim(), (10, 24), "ny rows of nx columns");
    assert!(digits.iter().all(|&n| n == 17), "{digits:?}");
    let expected = closed_form();
    let difference = largest_difference(&frame, &expected);
    assert!(difference < 1e-15, "{difference} m");
    let n_touched = expected.iter().filter(|&&d| d > 0.0).count();
    let n_saturated = expected.iter().filter(|&&d| d == 2e-3).count();
    assert!(n_touched > n_saturated && n_saturated > 0);
    let sentence =
        format!("{n_touched} of 240 taxels touched, {n_saturated} saturated; deepest 2.000 mm");
    assert!(said.contains(&sentence), "'{sentence}' is not in: {said}");
}

/// The arrays of the positions are those of the library (`page/pictures.rs`).
#[test]
fn the_npz_holds_the_numbers_of_the_csv() {
    let case = Case::with("sphere.csv", SPHERE);
    case.succeeds(&format!("{ARRAY} --out frame.csv"));
    case.succeeds(&format!("{ARRAY} --out frame.npz"));
    let mut npz = NpzReader::new(File::open(case.path("frame.npz")).unwrap()).unwrap();
    let deflection: Array2<f64> = npz.by_name("deflection").unwrap();
    assert_eq!(deflection, read_csv(&case, "frame.csv").0);
    let [x, y]: [Array1<f64>; 2] = ["x", "y"].map(|name| npz.by_name(name).unwrap());
    assert_eq!((x.len(), y.len()), (24, 10));
}

#[test]
fn presses_and_objects_become_pictures() {
    let case = Case::with("sphere.csv", SPHERE);
    let (said, _) = case.succeeds(&format!("{ARRAY} --out frame.png"));
    assert_eq!(said, "");
    case.succeeds("objects mug --out mug.png");
    case.succeeds("objects mug banana key --out sheet.png");
    for name in ["frame.png", "mug.png", "sheet.png"] {
        let file = std::io::BufReader::new(File::open(case.path(name)).unwrap());
        let mut picture = png::Decoder::new(file).read_info().unwrap();
        let mut pixels = vec![0; picture.output_buffer_size().unwrap()];
        picture.next_frame(&mut pixels).unwrap();
        assert!(pixels.iter().any(|&p| p != pixels[0]), "{name} is empty");
    }
}

#[test]
fn without_a_file_a_map_is_drawn_in_plain_characters_when_piped() {
    let case = Case::with("sphere.csv", SPHERE);
    let (said, _) = case.succeeds(&ARRAY);
    assert!(said.lines().count() >= 5, "{said}");
    assert!(said.contains('@'), "the darkest character: {said}");
    assert!(!said.contains('\u{1b}'), "no escape codes: {said:?}");
    assert_eq!(case.names(), ["sphere.csv"], "nothing is written");
}

#[test]
fn a_built_in_object_is_pressed_to_its_depth() {
    for depth_mm in [0.5, 3.0, 4.5] {
        let frame = pressed(&format!("--object mug --depth-mm {depth_mm}"));
        assert_eq!(frame.dim(), (64, 64));
        assert!((deepest(&frame) - 1e-3 * depth_mm).abs() < 1e-12);
    }
    let usual = pressed("--object mug --depth-mm 3");
    assert_eq!(pressed("--object mug"), usual);
    let (_, said) = Case::new().succeeds("press --object mug --depth-mm 3");
    says(&said, &["deepest 3.000 mm"]);
    let stopped = pressed("--object mug --depth-mm 3 --stroke-mm 2");
    assert_eq!(deepest(&stopped), 2e-3);
}

#[test]
fn an_object_that_is_pressed_beyond_the_stroke_stays_felt_and_it_is_said_once() {
    let stroke = 5e-3;
    for (object, depths) in [("golf", [5, 20, 30]), ("mug", [5, 10, 150])] {
        let frames = depths.map(|mm| pressed(&format!("--object {object} --depth-mm {mm}")));
        for pair in frames.windows(2) {
            let mut taxels = pair[0].iter().zip(&pair[1]);
            assert!(taxels.all(|(before, now)| now >= before), "{object}");
        }
        let n_saturated = frames[2].iter().filter(|&&d| d == stroke).count();
        assert!(n_saturated > 300, "{object}: {n_saturated}");
    }
    let case = Case::with("sphere.csv", SPHERE);
    let poses = "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n0,0,0.1,1,0,0,0\n";
    case.file("poses.csv", poses);
    let note = "note: a depth of 3 mm is beyond the stroke of 2 mm: taxels that would go further than it are saturated\n";
    for (more, is_noted) in [
        ("--depth-mm=3", true),
        ("--depth-mm=3 --poses=poses.csv", true),
        ("--depth-mm=2", false),
        ("", false),
    ] {
        let (_, said) = case.succeeds(&format!("{ARRAY} {more}"));
        let n_notes = [note, "beyond"].map(|words| said.matches(words).count());
        assert_eq!(n_notes, [usize::from(is_noted); 2], "{more}: {said}");
    }
}

#[test]
fn spheres_are_read_where_they_are_unless_a_depth_is_asked_for() {
    let case = Case::with("sphere.csv", SPHERE);
    case.succeeds(&format!("{ARRAY} --depth-mm=1 --out deep.csv"));
    let (frame, _) = read_csv(&case, "deep.csv");
    assert!((deepest(&frame) - 1e-3).abs() < 1e-15);
    let clear = "x,y,z,r\n0,0,0.05,0.03\n";
    case.file("sphere.csv", clear);
    case.succeeds(&format!("{ARRAY} --out clear.csv"));
    assert_eq!(deepest(&read_csv(&case, "clear.csv").0), 0.0);
}

/// Arguments for a small object well inside 40 × 40 taxels of 2 mm.
const PADLOCK: &str = "--object padlock --taxels 40x40 --depth-mm 2";

/// Returns whether a frame equals another frame that is shifted by whole taxels.
fn is_moved(frame: &Array2<f64>, by: (isize, isize), original: &Array2<f64>) -> bool {
    let (rows, columns) = frame.dim();
    frame.indexed_iter().all(|((row, column), &value)| {
        let from = (row as isize - by.0, column as isize - by.1);
        let inside =
            (0..rows as isize).contains(&from.0) && (0..columns as isize).contains(&from.1);
        let expected = match inside {
            true => original[[from.0 as usize, from.1 as usize]],
            false => 0.0,
        };
        (value - expected).abs() < 1e-12
    })
}

#[test]
fn an_offset_moves_the_print_by_whole_taxels_exactly_when_it_is_a_multiple_of_the_pitch() {
    let original = pressed(PADLOCK);
    let n_touched = original.iter().filter(|&&d| d > 0.0).count();
    assert!(n_touched > 20, "{n_touched} taxels");
    // If the patch moves along the table's x axis, the print moves in the opposite direction; the patch's y axis is opposite to the table's.
    for (offset, by) in [
        ("--offset-x-mm 6", (0, -3)),
        ("--offset-x-mm -4", (0, 2)),
        ("--offset-y-mm 6", (3, 0)),
        ("--offset-x-mm 2 --offset-y-mm -2", (-1, -1)),
    ] {
        let frame = pressed(&format!("{PADLOCK} {offset}"));
        assert!(is_moved(&frame, by, &original), "{offset} moves by {by:?}");
    }
    for offset in ["--offset-x-mm 1", "--offset-x-mm -2.5", "--offset-y-mm 0.7"] {
        let frame = pressed(&format!("{PADLOCK} {offset}"));
        let moves = (-4..=4).flat_map(|row| (-4..=4).map(move |column| (row, column)));
        for by in moves {
            assert!(!is_moved(&frame, by, &original), "{offset} moves by {by:?}");
        }
    }
}

#[test]
fn a_quarter_turn_of_the_object_is_a_quarter_turn_of_the_print() {
    let original = pressed(PADLOCK);
    let turned = pressed(&format!("{PADLOCK} --yaw-deg 90"));
    // Taxel (x, y) of the original is taxel (y, −x) of the rotated frame.
    let expected = Array2::from_shape_fn((40, 40), |(row, column)| original[[column, 39 - row]]);
    assert!(largest_difference(&turned, &expected) < 1e-12);
    // The padlock is no square.
    assert!(largest_difference(&turned, &original) > 1e-4);
    let back = pressed(&format!("{PADLOCK} --yaw-deg -270"));
    assert!(largest_difference(&turned, &back) < 1e-12);
}

#[test]
fn a_tilted_patch_goes_in_deepest_with_its_lower_side() {
    let box_under = "--object cracker_box --taxels 40x40 --depth-mm 3";
    let side = |frame: &Array2<f64>, axis: Axis| -> f64 {
        let sums = frame.sum_axis(axis);
        sums.slice(s![20..]).sum() - sums.slice(s![..20]).sum()
    };
    let level = pressed(box_under);
    assert!(side(&level, Axis(0)).abs() < 1e-9 && side(&level, Axis(1)).abs() < 1e-9);
    for (tilt, axis, sign) in [
        // For a patch that faces down, a rotation about x lowers the +y side, and a rotation about y the −x side.
        ("--tilt-x-deg 5", Axis(1), 1.0),
        ("--tilt-x-deg -5", Axis(1), -1.0),
        ("--tilt-y-deg 5", Axis(0), -1.0),
        ("--tilt-y-deg -5", Axis(0), 1.0),
    ] {
        let lower = side(&pressed(&format!("{box_under} {tilt}")), axis);
        assert!(sign * lower > 1e-3, "{tilt}: {lower}");
    }
}

#[test]
fn the_likeliest_rest_of_a_box_shows_its_largest_face() {
    let on_end = "--object box_158x60x210 --taxels 64x64 --pitch-mm 4 --depth-mm 3";
    let area = |frame: &Array2<f64>| frame.iter().filter(|&&d| d > 0.0).count() as f64 * 16.0;
    let (upright, lying) = (pressed(on_end), pressed(&format!("{on_end} --rest 0")));
    let tolerance = 0.1;
    for (frame, face) in [(upright, 158.0 * 60.0), (lying, 158.0 * 210.0)] {
        let ratio = area(&frame) / face;
        assert!((ratio - 1.0).abs() < tolerance, "{ratio} of {face} mm²");
    }
}

#[test]
fn a_press_to_a_force_carries_it() {
    for (force, stiffness) in [(5.0, 100.0), (0.02, 16.37)] {
        let options = format!("--force {force} --stiffness-n-per-m {stiffness}");
        let frame = pressed(&format!("--object mug {options}"));
        assert!((stiffness * frame.sum() - force).abs() < 1e-12 * force);
    }
}
