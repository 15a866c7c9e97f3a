//! Recordings with several values per taxel on a grid, such as three axes of force.

use super::sensors::rows_with_errors;
use super::{
    COUPLED, IMAGES, N, NOISE, RAW, SKIN, label, list, of_file, permuted, recordings, sensors,
};
use crate::command::{Case, says};
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::study::progress::Silent;
use bubbletouch::world::ImageShape;
use ndarray::{Array2, Array3, Array4, Axis, s};

/// Writes the frames with two values of 4 × 8 taxels in several orders of the axes, and a file for each value.
pub fn with_values() -> Case {
    let case = recordings();
    let frames = list().into_shape_with_order((N, 2, 4, 8)).unwrap();
    let last = permuted(&frames, [0, 2, 3, 1]);
    case.write_array("first.npy", &frames);
    case.write_array("last.npy", &last);
    case.write_array("columns.npy", &permuted(&frames, [3, 1, 0, 2]));
    let flat = last.into_shape_with_order((N, 4 * 8, 2)).unwrap();
    case.write_array("flat.npy", &flat);
    case.write_array("left.npy", &frames.index_axis(Axis(1), 0));
    case.write_array("right.npy", &frames.index_axis(Axis(1), 1));
    let test = frames.slice(s![..;4, .., .., ..]).to_owned();
    case.write_array("first_test.npy", &test);
    case.write_array("swapped_test.npy", &permuted(&test, [0, 2, 1, 3]));
    let labels = (0..N).step_by(4).map(label);
    case.write_integers("labels_test.npy", labels);
    case
}

/// Orders of the axes of the files of [`with_values`].
const FIRST: &str = "order = \"n c y x\"\nfull_scale = 2.0\n";
const LAST: &str = "order = \"n y x c\"\nfull_scale = 2.0\n";

fn keys(file: &str, order: &str) -> String {
    of_file(&format!("{file}.npy")) + order
}

/// Law: the values of each kind are an image of their own, as if another sensor had recorded them. The order of the axes does not matter.
#[test]
fn each_value_of_a_taxel_has_an_image() {
    let case = with_values();
    let sensors = sensors("full_scale = 2.0", "full_scale = 2.0");
    for rest in [[NOISE, RAW], [COUPLED, IMAGES]] {
        let rest = format!("{SKIN}{}", rest.concat());
        let expected = rows_with_errors(&case, &sensors, &rest);
        for (file, order) in [
            ("first", FIRST),
            ("last", LAST),
            ("columns", "order = \"x c n y\"\nfull_scale = 2.0"),
            ("flat", "order = \"n c c\"\ngrid = [4, 8]\nfull_scale = 2.0"),
        ] {
            let found = case.scored_rows(&keys(file, order), &rest);
            assert_eq!(found, expected, "{file}");
        }
    }
    let study = case.recorded(&keys("last", LAST), &format!("{SKIN}{IMAGES}"));
    let study = study.unwrap();
    let array = &study.first().plan.array;
    assert_eq!(array.image_shapes(), [ImageShape { ny: 4, nx: 8 }; 2]);
    says(&array.describe_taxels(), &["skin, value 2 32"]);
}

/// Law: an ensemble of rows and columns measures each kind of value as it measures a recording of this kind alone. The measurements of a nested ensemble
/// alternate between the kinds; other ensembles measure kind after kind.
#[test]
fn each_value_of_a_taxel_is_measured_as_an_image() {
    let case = with_values();
    for (ensemble, is_nested, step) in [
        ("block_average", false, 1),
        ("adaptive", false, 1),
        ("adaptive_learned", false, 1),
        ("fourier", true, 2),
    ] {
        let measured = |file: &str, order: &str, m: usize| {
            let sensing = format!("measurements = {m}\nensemble = \"{ensemble}\"");
            let rest = format!("{SKIN}{}", RAW.replace("measurements = 8", &sensing));
            let study = case.recorded(&keys(file, order), &rest).unwrap();
            let features = study.first().features((0, 0), &Silent).unwrap();
            features.data.records
        };
        let alone = |file: &str, m: usize| measured(file, "order = \"n y x\"\nfull_scale = 2.0", m);
        let is_same = |own: &Array2<f64>, alone: &Array2<f64>| {
            let mut differences = (own - alone).into_iter();
            differences.all(|difference| difference.abs() < 1e-15)
        };
        let whole = measured("last", LAST, 16);
        for (value, file) in ["left", "right"].into_iter().enumerate() {
            let alone = alone(file, 8);
            let first = value * if is_nested { 1 } else { alone.ncols() };
            let own = whole.slice(s![.., first..; step]);
            let own = own.slice(s![.., ..alone.ncols()]).to_owned();
            assert!(is_same(&own, &alone), "{ensemble} of {file}");
            assert!(alone.iter().any(|value| *value > 1e-4), "{ensemble}");
        }
        // With an odd number, the first kind has one measurement more.
        let (odd, more) = (measured("last", LAST, 7), alone("left", 4));
        let own = odd.slice(s![.., ..; step]);
        let own = own.slice(s![.., ..more.ncols()]).to_owned();
        assert!(is_same(&own, &more), "{ensemble}");
    }
}

/// Zeros may be an array with the axes of a frame, in which each value of a taxel has a zero.
#[test]
fn each_value_of_a_taxel_has_a_zero() {
    let case = with_values();
    let last: Array4<f64> = case.read_array("last.npy");
    let zeros = Array3::from_shape_fn((4, 8, 2), |(y, x, c)| (y + 2 * x) as f64 + 16.0 * c as f64);
    case.write_array("zeros.npy", &zeros);
    case.write_array("raised.npy", &(0.5 * &last + &zeros));
    let rest =
        "[sensing]\nensemble = \"identity\"\n[recognition]\nclassifier = \"nearest_centroid\"\n";
    let study = |keys: &str| case.recorded(keys, &format!("{SKIN}{rest}")).unwrap();
    let raised = LAST.replace("2.0", "40.0") + "zero = \"zeros.npy\"\n";
    let raised = frame(&study(&keys("raised", &raised)));
    let plain = frame(&study(&keys("last", LAST)));
    // A reading of value c at row y and column x stands at (c, y, x) of the frame.
    for (at, (plain, raised)) in plain.iter().zip(&raised).enumerate() {
        let (y, x, c) = (at % 32 / 8, at % 8, at / 32);
        let (reading, stroke) = (last[[7, y, x, c]], 5e-3);
        assert!((plain - reading / 2.0 * stroke).abs() < 1e-8, "{at}");
        let expected = 0.5 * reading / (40.0 - zeros[[y, x, c]]) * stroke;
        assert!((raised - expected).abs() < 1e-8, "{at}");
    }
}

/// Returns the readings of the touch 7 of a study, metres.
fn frame(study: &RecognitionStudy) -> Vec<f64> {
    let part = study.first();
    let frames = part.touched.simulate((&part.plan.array, 1), &Silent);
    frames.to_array().row(7).to_vec()
}

/// Returns features of frames of 12 × 12 places, of which an ellipse has taxels, all pressed alike; the other places read `absent`.
fn foot(absent: f64, rest: &str) -> Array2<f64> {
    let case = recordings();
    let is_inside = |y: usize, x: usize| {
        ((x as f64 - 5.5) / 4.0).powi(2) + ((y as f64 - 5.5) / 6.0).powi(2) < 1.0
    };
    let frames = Array3::from_shape_fn((N, 12, 12), |(touch, y, x)| match is_inside(y, x) {
        true => 0.25 + 0.25 * (touch % 3) as f64,
        false => absent,
    });
    case.write_array("foot.npy", &frames);
    let study = case.recorded(&keys("foot", "full_scale = 1.0\n"), rest);
    let study = study.unwrap();
    let features = study.first().features((0, 0), &Silent).unwrap();
    features.data.records
}

/// Law: a place without a taxel is the neighbour of no taxel, so a uniform press stays uniform.
#[test]
fn absent_places_are_no_neighbours() {
    for signal in [
        "steps = [\"crosstalk\"]\ncrosstalk = 0.3",
        "steps = [\"smoothing\"]\nsmoothing_mm = 6.0",
        "steps = [\"crosstalk\", \"smoothing\"]\ncrosstalk = 0.3\nsmoothing_mm = 6.0",
    ] {
        let blocks = "ensemble = \"block_average\"\nmeasurements = 9";
        for sensing in ["ensemble = \"identity\"", blocks] {
            let rest = RAW.replace("measurements = 8", sensing);
            let rest = format!("{SKIN}[signal]\n{signal}\n{rest}");
            for absent in [f64::NAN, -1.0] {
                for (touch, row) in foot(absent, &rest).outer_iter().enumerate() {
                    let pressed = 5e-3 * (0.25 + 0.25 * (touch % 3) as f64);
                    let is_right =
                        |value: &f64| *value == 0.0 || (value / pressed - 1.0).abs() < 1e-6;
                    assert!(row.iter().all(is_right), "{signal} {sensing}: {row}");
                    assert!(row.iter().any(|value| *value > 0.0));
                }
            }
        }
    }
}

/// Law: readings that fall under pressure are recognised as those that rise.
#[test]
fn falling_readings_are_scaled_as_they_stand() {
    let case = with_values();
    let frames: Array4<f64> = case.read_array("first.npy");
    case.write_array("falling.npy", &(4000.0 - 1024.0 * frames));
    let falling = FIRST.replace("= 2.0", "= 1952.0") + "zero = 4000.0\n";
    for rest in [[NOISE, RAW], [COUPLED, IMAGES]] {
        let rest = format!("{SKIN}{}", rest.concat());
        let rising = case.scored_rows(&keys("first", FIRST), &rest);
        assert_eq!(case.scored_rows(&keys("falling", &falling), &rest), rising);
    }
}
