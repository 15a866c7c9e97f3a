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

#[test]
fn what_it_writes_is_the_signal_of_a_study() {
    let case = Case::new();
    write_npy(&case.path("frames.npy"), &frames()).unwrap();
    let scale = ["--zero", "100", "--full-scale", "500"];
    let given = [
        &["calibrate", "frames.npy", "--untouched-frames", UNTOUCHED],
        &scale[..],
    ]
    .concat();
    let (table, _) = case.succeeds(&given);
    let read: toml::Table = table.parse().unwrap();
    let signal = read["signal"].as_table().unwrap();
    let noise = signal["noise_std_full_scale"].as_float().unwrap();
    assert!((noise - 0.01).abs() < 0.0005, "{table}");
    assert_eq!(signal["adc_bits"].as_integer(), Some(0), "{table}");
    says(&table, &["# gain_std: not identifiable: "]);
    case.file("study.toml", format!("{STUDY}{table}"));
    case.succeeds(&["plan", "study.toml"]);
    // With `--output`, the command writes the table to a file.
    let to_file = [&given[..], &["--output", "signal.toml"]].concat();
    let (said, _) = case.succeeds(&to_file);
    assert_eq!(said, "");
    assert_eq!(
        std::fs::read_to_string(case.path("signal.toml")).unwrap(),
        table
    );
}

#[test]
fn forces_tell_how_stiff_taxels_are() {
    let case = Case::new();
    let frames = frames();
    write_npy(&case.path("frames.npy"), &frames).unwrap();
    // 16 taxels are deflected by 200 of 400 counts of 2 mm, with 150 N/m.
    let force = |frame: usize| {
        if frame / 50 % 2 == 1 {
            16.0 * 1e-3 * 150.0
        } else {
            0.0
        }
    };
    let forces = Array1::from_shape_fn(frames.dim().0, force);
    write_npy(&case.path("forces.npy"), &forces).unwrap();
    let (table, _) = case.succeeds(&[
        "calibrate",
        "frames.npy",
        "--untouched-frames",
        UNTOUCHED,
        "--zero",
        "100",
        "--full-scale",
        "500",
        "--forces",
        "forces.npy",
        "--stroke-mm",
        "2",
    ]);
    let read: toml::Table = table.parse().unwrap();
    let stiffness = &read["skin"]["stiffness_n_per_m"];
    let stiffness = stiffness
        .as_float()
        .or(stiffness.as_integer().map(|n| n as f64))
        .unwrap();
    assert!((stiffness / 150.0 - 1.0).abs() < 0.03, "{table}");
}

#[test]
fn frames_that_tell_nothing_are_refused_or_say_so() {
    let case = Case::new();
    write_npy(&case.path("frames.npy"), &frames()).unwrap();
    write_npy(&case.path("other.npy"), &Array3::<f32>::zeros((60, 3, 4))).unwrap();
    write_npy(&case.path("line.npy"), &Array1::<f32>::zeros(60)).unwrap();
    let mut broken = frames();
    broken[(7, 2, 1)] = f32::NAN;
    write_npy(&case.path("broken.npy"), &broken).unwrap();
    for (arguments, said) in [
        (&["missing.npy"][..], "missing.npy"),
        (&["line.npy"], "line.npy"),
        (&["broken.npy"], "NaN; finite numbers"),
        (
            &["frames.npy", "--untouched", "other.npy"],
            "--untouched: other.npy without --untouched-times",
        ),
        (
            &[
                "frames.npy",
                "--untouched",
                "frames.npy",
                "--untouched-times",
                "0.5..0.2",
            ],
            "times of untouched frames: 0.5..0.2",
        ),
        (
            &["frames.npy", "--untouched-frames", "30..130"],
            "untouched frames: 16 taxels change by more than",
        ),
        (
            &["frames.npy", "--untouched-frames", "50..100,150..200"],
            "untouched frames: 16 taxels read more than in the other frames",
        ),
        (
            &[
                "frames.npy",
                "--untouched",
                "other.npy",
                "--untouched-times",
                "0..1",
            ],
            "other.npy: frames of 3 × 4 taxels; 12 × 12",
        ),
        (
            &["frames.npy", "--untouched-frames", "590..610"],
            "590..610",
        ),
        (&["frames.npy", "--untouched-frames", "9..9"], "9..9"),
        (&["frames.npy", "--untouched-frames", "x"], "FROM..TO"),
        (
            &["frames.npy", "--full-scale", "0"],
            "full scale: 0; a number other than the zero, 0",
        ),
        (
            &["frames.npy", "--pitch-mm", "0"],
            "--pitch-mm: 0; a positive number",
        ),
        (
            &["frames.npy", "--forces", "line.npy", "--stroke-mm", "1"],
            "line.npy",
        ),
        (&["frames.npy", "--output", "signal.txt"], "signal.txt"),
    ] {
        let error = case.refuses(&[&["calibrate"], arguments].concat());
        assert!(error.contains(said), "{arguments:?}: {error}");
    }
    let (table, _) = case.succeeds(&["calibrate", "frames.npy", "--zero", "100"]);
    assert!(
        table.contains(
            "# noise_std_full_scale: not identifiable: there are too few untouched frames"
        )
    );
}

/// Law: the zero of readings that are all positive is the median of the untouched ones, and such readings are not clipped.
#[test]
fn counts_with_an_offset_have_a_zero_and_no_drift() {
    let case = Case::new();
    write_npy(&case.path("frames.npy"), &frames().mapv(f32::round)).unwrap();
    let given = [
        "calibrate",
        "frames.npy",
        "--untouched-frames",
        UNTOUCHED,
        "--full-scale",
        "500",
    ];
    let (table, _) = case.succeeds(&given);
    says(&table, &["The zero is 100."]);
    let read: toml::Table = table.parse().unwrap();
    let value = |key: &str| match &read["signal"][key] {
        toml::Value::Integer(number) => *number as f64,
        other => other.as_float().unwrap(),
    };
    assert!(value("drift_std_full_scale") < 0.002, "{table}");
    assert!(
        (value("noise_std_full_scale") - 0.01).abs() < 0.0005,
        "{table}"
    );
}

/// Law: untouched frames of a file have the times that are given, so those before the first frame determine no drift.
#[test]
fn a_file_of_untouched_frames_has_times() {
    let case = Case::new();
    write_npy(&case.path("frames.npy"), &frames()).unwrap();
    let untouched = frames().slice(ndarray::s![..50, .., ..]).to_owned();
    write_npy(&case.path("untouched.npy"), &untouched).unwrap();
    let given = |times: &str| {
        let words = [
            "calibrate",
            "frames.npy",
            "--untouched",
            "untouched.npy",
            "--untouched-times",
            times,
        ];
        case.succeeds(&words).0
    };
    let reason = "# drift_std_full_scale: not identifiable: untouched frames are from one time";
    assert!(given("0..0").contains(reason));
    assert!(given("0..0.1,0.9..1").contains("\ndrift_std_full_scale = 0"));
}
