//! `bubbletouch calibrate` writes a table that studies read, and its errors state what is wrong.

use crate::command::{Case, says};
use bubbletouch::random::Seed;
use bubbletouch::study::write_npy;
use ndarray::{Array1, Array3};
use rand::Rng;
use rand_distr::StandardNormal;

const SIDE: usize = 12;

/// Returns readings of a skin with the zero 100 and noise of 4 counts; in every other run of 50 frames its middle is pressed by 200 counts.
fn frames() -> Array3<f32> {
    let mut rng = Seed::new(3).rng();
    Array3::from_shape_fn((600, SIDE, SIDE), |(frame, y, x)| {
        let is_pressed = frame / 50 % 2 == 1 && (4..8).contains(&y) && (4..8).contains(&x);
        let pressed = if is_pressed { 200.0 } else { 0.0 };
        let noise: f32 = rng.sample(StandardNormal);
        100.0 + pressed + 4.0 * noise
    })
}

const UNTOUCHED: &str = "0..50,100..150,200..250,300..350,400..450,500..550";

const STUDY: &str = include_str!("../fixtures/texts/calibrate.toml");

/// Creates a folder with readings.
fn folder() -> Case {
    let case = Case::new();
    write_npy(&case.path("frames.npy"), &frames()).unwrap();
    case
}

/// Runs the command with these options; returns the table that it writes, as text and as numbers.
fn calibrated(case: &Case, options: &str) -> (String, toml::Table) {
    let (text, _) = case.succeeds(&format!("calibrate frames.npy {options}"));
    let table = text.parse().unwrap();
    (text, table)
}

fn number(table: &toml::Table, group: &str, key: &str) -> f64 {
    match &table[group][key] {
        toml::Value::Integer(number) => *number as f64,
        other => other.as_float().unwrap(),
    }
}

#[test]
fn what_it_writes_is_the_signal_of_a_study() {
    let case = folder();
    let options = format!("--untouched-frames {UNTOUCHED} --zero 100 --full-scale 500");
    let (text, table) = calibrated(&case, &options);
    let noise = number(&table, "signal", "noise_std_full_scale");
    assert!((noise - 0.01).abs() < 0.0005, "{text}");
    assert_eq!(number(&table, "signal", "adc_bits"), 0.0, "{text}");
    says(&text, &["# gain_std: not identifiable: "]);
    case.file("study.toml", format!("{STUDY}{text}"));
    case.succeeds("plan study.toml");
    // With `--output`, the command writes the table to a file.
    let (said, _) = calibrated(&case, &format!("{options} --output signal.toml"));
    assert_eq!((said, case.read("signal.toml")), (String::new(), text));
}

#[test]
fn forces_tell_how_stiff_taxels_are() {
    let case = folder();
    // 16 taxels are deflected by 200 of 400 counts of 2 mm, with 150 N/m.
    let force = |frame: usize| (frame / 50 % 2) as f64 * 16.0 * 1e-3 * 150.0;
    write_npy(&case.path("forces.npy"), &Array1::from_shape_fn(600, force)).unwrap();
    let options = format!("--untouched-frames {UNTOUCHED} --zero 100 --full-scale 500");
    let options = format!("{options} --forces forces.npy --stroke-mm 2");
    let (text, table) = calibrated(&case, &options);
    let stiffness = number(&table, "skin", "stiffness_n_per_m");
    assert!((stiffness / 150.0 - 1.0).abs() < 0.03, "{text}");
}

#[test]
fn frames_that_tell_nothing_are_refused_or_say_so() {
    let case = folder();
    write_npy(&case.path("other.npy"), &Array3::<f32>::zeros((60, 3, 4))).unwrap();
    write_npy(&case.path("line.npy"), &Array1::<f32>::zeros(60)).unwrap();
    let mut broken = frames();
    broken[(7, 2, 1)] = f32::NAN;
    write_npy(&case.path("broken.npy"), &broken).unwrap();
    let refused = |options: &str, words: &str| {
        says(&case.refuses(&format!("calibrate {options}")), &[words]);
    };
    refused("missing.npy", "missing.npy");
    refused("line.npy", "line.npy");
    refused("broken.npy", "NaN; finite numbers");
    let changing = "untouched frames: 16 taxels change by more than";
    let pressed = "untouched frames: 16 taxels read more than in the other frames";
    let without = "--untouched: other.npy without --untouched-times";
    let shape = "other.npy: frames of 3 × 4 taxels; 12 × 12";
    let zero = "full scale: 0; a number other than the zero, 0";
    for (options, words) in [
        ("--untouched-frames 30..130", changing),
        ("--untouched-frames 50..100,150..200", pressed),
        ("--untouched-frames 590..610", "590..610"),
        ("--untouched-frames 9..9", "9..9"),
        ("--untouched-frames x", "FROM..TO"),
        ("--untouched other.npy", without),
        ("--untouched other.npy --untouched-times 0..1", shape),
        ("--full-scale 0", zero),
        ("--pitch-mm 0", "--pitch-mm: 0; a positive number"),
        ("--forces line.npy --stroke-mm 1", "line.npy"),
        ("--output signal.txt", "signal.txt"),
    ] {
        refused(&format!("frames.npy {options}"), words);
    }
    let options = "--untouched frames.npy --untouched-times 0.5..0.2";
    let times = "times of untouched frames: 0.5..0.2";
    refused(&format!("frames.npy {options}"), times);
    let (text, _) = calibrated(&case, "--zero 100");
    let few = "# noise_std_full_scale: not identifiable: there are too few untouched frames";
    says(&text, &[few]);
}

/// Law: the zero of readings that are all positive is the median of the untouched ones, and such readings are not clipped.
#[test]
fn counts_with_an_offset_have_a_zero_and_no_drift() {
    let case = Case::new();
    write_npy(&case.path("frames.npy"), &frames().mapv(f32::round)).unwrap();
    let options = format!("--untouched-frames {UNTOUCHED} --full-scale 500");
    let (text, table) = calibrated(&case, &options);
    says(&text, &["The zero is 100."]);
    let [drift, noise] =
        ["drift_std_full_scale", "noise_std_full_scale"].map(|key| number(&table, "signal", key));
    assert!(drift < 0.002 && (noise - 0.01).abs() < 0.0005, "{text}");
}

/// Law: untouched frames of a file have the times that are given, so those before the first frame determine no drift.
#[test]
fn a_file_of_untouched_frames_has_times() {
    let case = folder();
    let untouched = frames().slice(ndarray::s![..50, .., ..]).to_owned();
    write_npy(&case.path("untouched.npy"), &untouched).unwrap();
    let once = "# drift_std_full_scale: not identifiable: untouched frames are from one time";
    let twice = "\ndrift_std_full_scale = 0";
    for (times, words) in [("0..0", once), ("0..0.1,0.9..1", twice)] {
        let options = format!("--untouched untouched.npy --untouched-times {times}");
        says(&calibrated(&case, &options).0, &[words]);
    }
}
