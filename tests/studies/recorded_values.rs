//! Recordings with several values per taxel on a grid, such as three axes of force.

use crate::command::{Case, says};
use crate::recorded_sensors::{
    COUPLED, IMAGES, LABELS, N, NOISE, RAW, SKIN, error, planned, rows, written,
};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::write_npy;
use bubbletouch::world::ImageShape;
use ndarray::{Array2, Array3, Array4, Axis, s};
use ndarray_npy::read_npy;

/// Numbers of values, rows and columns of a frame.
const SIDES: [usize; 3] = [2, 4, 8];

/// Writes the frames with two values of 4 × 8 taxels in several orders of the axes, and a file for each value.
fn with_values() -> Case {
    let case = written();
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    let [n_values, ny, nx] = SIDES;
    let frames = list.into_shape_with_order((N, n_values, ny, nx)).unwrap();
    write_npy(&case.path("first.npy"), &frames).unwrap();
    let write = |name: &str, axes: [usize; 4]| {
        let moved = frames.view().permuted_axes(axes);
        let moved: Array4<f64> = moved.as_standard_layout().into_owned();
        write_npy(&case.path(name), &moved).unwrap();
        moved
    };
    let last = write("last.npy", [0, 2, 3, 1]);
    write("columns.npy", [3, 1, 0, 2]);
    let flat: Array3<f64> = last.into_shape_with_order((N, ny * nx, n_values)).unwrap();
    write_npy(&case.path("flat.npy"), &flat).unwrap();
    for (value, name) in ["left", "right"].into_iter().enumerate() {
        write_npy(
            &case.path(&format!("{name}.npy")),
            &frames.index_axis(Axis(1), value).to_owned(),
        )
        .unwrap();
    }
    let mut test = frames.slice(s![..;4, .., .., ..]).to_owned();
    write_npy(&case.path("first_test.npy"), &test).unwrap();
    test.swap_axes(1, 2);
    write_npy(&case.path("swapped_test.npy"), &test).unwrap();
    case
}

fn keys(file: &str, order: &str) -> String {
    format!("{LABELS}frames = \"FOLDER/{file}.npy\"\n{order}\nfull_scale = 2.0\n")
}

/// Law: the values of each kind are an image of their own, as if another sensor had recorded them. The order of the axes does not matter.
#[test]
fn each_value_of_a_taxel_has_an_image() {
    let case = with_values();
    let sensors = ["left", "right"].map(|name| {
        format!("[[recorded.sensors]]\nname = \"{name}\"\nframes = \"FOLDER/{name}.npy\"\nfull_scale = 2.0\n")
    });
    let sensors = format!("{LABELS}{}", sensors.concat());
    for rest in [
        format!("{SKIN}{NOISE}{RAW}"),
        format!("{SKIN}{COUPLED}{IMAGES}"),
    ] {
        let expected = rows(&case, &sensors, &rest);
        assert!(
            expected
                .iter()
                .any(|(_, score)| score.n_correct < score.n_test)
        );
        for (file, order) in [
            ("first", "order = \"n c y x\""),
            ("last", "order = \"n y x c\""),
            ("columns", "order = \"x c n y\""),
            ("flat", "order = \"n c c\"\ngrid = [4, 8]"),
        ] {
            assert_eq!(rows(&case, &keys(file, order), &rest), expected, "{file}");
        }
    }
    let study = planned(
        &case,
        &keys("last", "order = \"n y x c\""),
        &format!("{SKIN}{IMAGES}"),
    );
    let study = study.unwrap();
    let array = &study.first().plan.arrays[0];
    assert_eq!(array.image_shapes(), [ImageShape { ny: 4, nx: 8 }; 2]);
    assert!(
        array.describe_taxels().contains("skin, value 2 32"),
        "{}",
        array.describe_taxels()
    );
}

fn measured_by(ensemble: &str, m: usize) -> String {
    format!(
        "{SKIN}[sensing]\nmeasurements = {m}\nensemble = \"{ensemble}\"\n[recognition]\nclassifier = \"linear_svm\"\n"
    )
}

/// Law: an ensemble of rows and columns measures each kind of value as it measures a recording of this kind alone. The measurements of a nested ensemble
/// alternate between the kinds; other ensembles measure kind after kind.
#[test]
fn each_value_of_a_taxel_is_measured_as_an_image() {
    let case = with_values();
    let measured = |file: &str, order: &str, rest: &str| {
        let study = planned(&case, &keys(file, order), rest).unwrap();
        study
            .first()
            .features((0, 0), &Silent)
            .unwrap()
            .data
            .records
    };
    for (ensemble, is_nested, step) in [
        ("block_average", false, 1),
        ("adaptive", false, 1),
        ("adaptive_learned", false, 1),
        ("fourier", true, 2),
    ] {
        let whole = measured("last", "order = \"n y x c\"", &measured_by(ensemble, 16));
        for (value, file) in ["left", "right"].into_iter().enumerate() {
            let alone = measured(file, "order = \"n y x\"", &measured_by(ensemble, 8));
            let first = if is_nested {
                value
            } else {
                value * alone.ncols()
            };
            let own = whole.slice(s![.., first..; step]);
            let own = own.slice(s![.., ..alone.ncols()]);
            let difference = (&own - &alone)
                .mapv(f64::abs)
                .fold(0.0, |a: f64, b| a.max(*b));
            assert!(difference < 1e-15, "{ensemble} of {file}: {difference}");
            assert!(alone.iter().any(|value| *value > 1e-4), "{ensemble}");
        }
        // With an odd number, the first kind has one measurement more.
        let odd = measured("last", "order = \"n y x c\"", &measured_by(ensemble, 7));
        let more = measured("left", "order = \"n y x\"", &measured_by(ensemble, 4));
        let own = odd.slice(s![.., ..; step]);
        let own = own.slice(s![.., ..more.ncols()]);
        assert!(
            (&own - &more).iter().all(|value| value.abs() < 1e-15),
            "{ensemble}"
        );
    }
}

/// Zeros may be an array with the axes of a frame, in which each value of a taxel has a zero.
#[test]
fn each_value_of_a_taxel_has_a_zero() {
    let case = with_values();
    let last: Array4<f64> = read_npy(case.path("last.npy")).unwrap();
    let zeros = Array3::from_shape_fn((4, 8, 2), |(y, x, c)| (y + 2 * x) as f64 + 16.0 * c as f64);
    write_npy(&case.path("zeros.npy"), &zeros).unwrap();
    write_npy(&case.path("raised.npy"), &(0.5 * last.clone() + &zeros)).unwrap();
    let rest = format!(
        "{SKIN}[sensing]\nensemble = \"identity\"\n[recognition]\nclassifier = \"nearest_centroid\"\n"
    );
    let raised =
        keys("raised", "order = \"n y x c\"\nzero = \"FOLDER/zeros.npy\"").replace("2.0", "40.0");
    let study = planned(&case, &raised, &rest).unwrap();
    let plain = planned(&case, &keys("last", "order = \"n y x c\""), &rest).unwrap();
    let frame = |study: &bubbletouch::kinds::recognition::RecognitionStudy| {
        let part = study.first();
        let frames = part.touched.simulate(
            (&part.plan.arrays[0], 1),
            &bubbletouch::study::progress::Silent,
        );
        frames.to_array().row(7).to_vec()
    };
    // A reading of value c at row y and column x stands at (c, y, x) of the frame.
    let (found, stroke) = (frame(&plain), 5e-3);
    for (place, value) in found.iter().enumerate() {
        let expected = last[[7, place % 32 / 8, place % 8, place / 32]] / 2.0 * stroke;
        assert!((*value - expected).abs() < 1e-8, "{place}");
    }
    for (place, value) in frame(&study).iter().enumerate() {
        let zero = zeros[[place % 32 / 8, place % 8, place / 32]];
        let expected =
            0.5 * last[[7, place % 32 / 8, place % 8, place / 32]] / (40.0 - zero) * stroke;
        assert!((*value - expected).abs() < 1e-8, "{place}");
    }
}

#[test]
fn recordings_with_several_values_that_do_not_fit_are_refused() {
    let case = with_values();
    let said = error(
        &case,
        &keys("last", "order = \"n y x c\""),
        &measured_by("block_average", 1),
    );
    says(
        &said,
        &[
            "key sensing.measurements: 1 measurements of 2 images; at least 2, one for each kind of value",
        ],
    );
    let rest = format!("{SKIN}{RAW}");
    let tested = |test: &str| {
        format!(
            "{}frames_test = \"FOLDER/{test}.npy\"\nlabels_test = \"FOLDER/labels_test.npy\"\n",
            keys("first", "order = \"n c y x\"")
        )
    };
    bubbletouch::study::write_integers(
        &case.path("labels_test.npy"),
        (0..N).step_by(4).map(|touch| touch / 20),
    )
    .unwrap();
    assert!(planned(&case, &tested("first_test"), &rest).is_ok());
    let said = error(&case, &tested("swapped_test"), &rest);
    says(
        &said,
        &[
            "touches of 1 frames of 2 × 8 taxels of 4 values; touches of 1 frames of 4 × 8 taxels of 2 values, as ",
        ],
    );
    let said = error(
        &case,
        &keys("flat", "order = \"n c c\"\ngrid = [5, 8]"),
        &rest,
    );
    says(
        &said,
        &["5 × 8 taxels; rows and columns of the 64 taxels of "],
    );
    let shear = format!("{SKIN}sensed = \"shear\"\n{RAW}");
    let said = error(&case, &keys("last", "order = \"n y x c\""), &shear);
    says(&said, &["with 2 values a taxel; 3, as skin.sensed says"]);
    let said = String::from_utf8(
        case.run(&[
            "calibrate",
            "last.npy",
            "--order",
            "n y x c",
            "--untouched-frames",
            "0..9",
            "--pitch-mm",
            "2",
        ])
        .stderr,
    )
    .unwrap();
    says(
        &said,
        &["last.npy: 2 values a taxel; frames of a grid of taxels with one value each"],
    );
}

/// Returns the study of frames of 12 × 12 places, of which an ellipse has taxels, all pressed alike; the other places read `absent`.
fn foot(absent: f64, rest: &str) -> Array2<f64> {
    let case = written();
    let is_inside = |y: usize, x: usize| {
        ((x as f64 - 5.5) / 4.0).powi(2) + ((y as f64 - 5.5) / 6.0).powi(2) < 1.0
    };
    let frames = Array3::from_shape_fn((N, 12, 12), |(touch, y, x)| match is_inside(y, x) {
        true => 0.25 + 0.25 * (touch % 3) as f64,
        false => absent,
    });
    write_npy(&case.path("foot.npy"), &frames).unwrap();
    let recorded = format!("{LABELS}frames = \"FOLDER/foot.npy\"\nfull_scale = 1.0\n");
    let study = planned(&case, &recorded, rest).unwrap();
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
        for sensing in [
            "ensemble = \"identity\"",
            "ensemble = \"block_average\"\nmeasurements = 9",
        ] {
            let rest = format!(
                "{SKIN}[signal]\n{signal}\n[sensing]\n{sensing}\n[recognition]\nclassifier = \"linear_svm\"\n"
            );
            for absent in [f64::NAN, -1.0] {
                let records = foot(absent, &rest);
                for (touch, row) in records.outer_iter().enumerate() {
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
    let list: Array4<f64> = read_npy(case.path("first.npy")).unwrap();
    write_npy(
        &case.path("falling.npy"),
        &list.mapv(|reading| 4000.0 - 1024.0 * reading),
    )
    .unwrap();
    let order = "order = \"n c y x\"";
    for rest in [
        format!("{SKIN}{NOISE}{RAW}"),
        format!("{SKIN}{COUPLED}{IMAGES}"),
    ] {
        let rising = rows(&case, &keys("first", order), &rest);
        let falling =
            keys("falling", &format!("{order}\nzero = 4000.0")).replace("= 2.0", "= 1952.0");
        assert_eq!(rows(&case, &falling, &rest), rising);
    }
}
