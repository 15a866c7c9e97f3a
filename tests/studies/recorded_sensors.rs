//! Recordings whose taxels have positions in a layout file, several sensors that are read together, and touches of unequal length.

use crate::command::{Case, says};
use crate::study::laid_out;
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::{Configuration, TrialScore};
use bubbletouch::study::{write_integers, write_npy};
use bubbletouch::world::ImageShape;
use ndarray::{Array2, Array3, Axis, s};
use ndarray_npy::read_npy;
use std::fmt::Write as _;

pub const N: usize = 60;

/// Returns frames of three classes, 8 × 8, of which an SVM misclassifies some.
fn frames() -> Array3<f64> {
    Array3::from_shape_fn((N, 8, 8), |(touch, row, column)| {
        let (class, k) = (touch / 20, touch * 64 + row * 8 + column);
        let noise = ((k * k * 31 + k * 17) % 997) as f64 / 997.0;
        let away = (row as f64 - 3.5).powi(2) + (column as f64 - 2.0 - 0.5 * class as f64).powi(2);
        (64.0 * ((-away / 4.0).exp() + 0.9 * noise)).round() / 128.0
    })
}

pub fn written() -> Case {
    let case = Case::new();
    let frames = frames();
    let list = frames.clone().into_shape_with_order((N, 64)).unwrap();
    write_npy(&case.path("frames.npy"), &frames).unwrap();
    write_npy(&case.path("list.npy"), &list).unwrap();
    write_npy(&case.path("left.npy"), &list.slice(s![.., ..24]).to_owned()).unwrap();
    write_npy(
        &case.path("right.npy"),
        &list.slice(s![.., 24..]).to_owned(),
    )
    .unwrap();
    write_integers(&case.path("labels.npy"), (0..N).map(|touch| touch / 20)).unwrap();
    case.file(
        "grid.csv",
        layout((0..64).map(|k| (4.0 * (k % 8) as f64, 4.0 * (k / 8) as f64))),
    );
    case
}

/// Returns the text of a layout file of taxels in a plane, at positions in millimetres.
fn layout(places: impl Iterator<Item = (f64, f64)>) -> String {
    let mut text = String::from("x_mm,y_mm,z_mm,nx,ny,nz\n");
    for (x, y) in places {
        writeln!(text, "{x},{y},0,0,0,1").unwrap();
    }
    text
}

pub const SKIN: &str = "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n";
pub const NOISE: &str =
    "[signal]\nsteps = [\"gain\", \"noise\"]\ngain_std = 0.1\nnoise_std_full_scale = 0.05\n";
pub const COUPLED: &str = "[signal]\nsteps = [\"crosstalk\", \"noise\", \"smoothing\"]\ncrosstalk = 0.2\nnoise_std_full_scale = 0.05\nsmoothing_mm = 3.0\n";
pub const RAW: &str = "[sensing]\nmeasurements = 8\n[recognition]\nclassifier = \"linear_svm\"\n";
pub const IMAGES: &str = "[sensing]\nensemble = \"identity\"\n[recognition]\nclassifier = \"linear_svm\"\nfeatures = [\"fourier_magnitude\", \"descriptors\"]\n";

pub fn planned(case: &Case, recorded: &str, rest: &str) -> bubbletouch::Result<RecognitionStudy> {
    let folder = case.folder().display().to_string();
    let recorded = recorded.replace("FOLDER/", &format!("{folder}/"));
    laid_out(&format!(
        "question = \"?\"\ntrials = 2\n[recorded]\n{recorded}\n{rest}"
    ))
}

pub fn rows(case: &Case, recorded: &str, rest: &str) -> Vec<(Configuration, TrialScore)> {
    let study = planned(case, recorded, rest).unwrap_or_else(|error| panic!("{recorded}\n{error}"));
    study.run(&Silent).unwrap().accuracy
}

pub fn scores(case: &Case, recorded: &str, rest: &str) -> Vec<TrialScore> {
    let rows = rows(case, recorded, rest).into_iter();
    rows.map(|(_, score)| score).collect()
}

pub fn error(case: &Case, recorded: &str, rest: &str) -> String {
    let planned = planned(case, recorded, rest);
    planned.err().expect(recorded).to_string()
}

pub const LABELS: &str = "labels = \"FOLDER/labels.npy\"\n";

/// Returns `[recorded]` with the sensors left and right, each with further keys.
fn sensors(left: &str, right: &str) -> String {
    format!(
        "{LABELS}[[recorded.sensors]]\nname = \"left\"\nframes = \"FOLDER/left.npy\"\n{left}\n[[recorded.sensors]]\nname = \"right\"\nframes = \"FOLDER/right.npy\"\n{right}\n"
    )
}

#[test]
fn a_layout_file_of_a_grid_gives_the_rows_of_the_grid() {
    let case = written();
    let grid = format!("{LABELS}frames = \"FOLDER/frames.npy\"\n");
    let listed = format!("{LABELS}frames = \"FOLDER/list.npy\"\nlayout = \"FOLDER/grid.csv\"\n");
    let both = format!("{grid}layout = \"FOLDER/grid.csv\"\n");
    let blocks = format!(
        "{}{}",
        RAW.replace(
            "measurements = 8",
            "ratio = 4\nensemble = \"block_average\""
        ),
        ""
    );
    for rest in [
        format!("{SKIN}{COUPLED}{IMAGES}"),
        format!("{SKIN}{COUPLED}{blocks}"),
    ] {
        let expected = rows(&case, &grid, &rest);
        assert!(
            expected
                .iter()
                .any(|(_, score)| score.n_correct < score.n_test)
        );
        assert_eq!(rows(&case, &listed, &rest), expected);
        assert_eq!(rows(&case, &both, &rest), expected);
    }
}

#[test]
fn a_layout_file_of_hexagonal_taxels_gives_the_rows_of_the_layout() {
    let case = written();
    let skin = format!("{SKIN}taxels = 8\nlayout = \"hexagonal\"\n");
    let rest = format!("{COUPLED}{RAW}");
    let pressed = "question = \"?\"\ntrials = 2\n[objects]\nsets = [\"balls\"]\nnames = [\"golf\", \"tennis\", \"baseball\"]\n[touches]\nper_object = 12\noffset_x_mm = { uniform = [-6.0, 6.0] }\noffset_y_mm = { uniform = [-6.0, 6.0] }\ndepth_mm = { uniform = [1.0, 7.0] }\n";
    case.file("study.toml", format!("{pressed}{skin}{rest}"));
    case.succeeds(&["touches", "study.toml", "--out", "touches"]);
    let taxels: Array2<f64> = read_npy(case.path("touches/taxels.npy")).unwrap();
    let mut text = String::from("x_mm,y_mm,z_mm,nx,ny,nz,row,column\n");
    let columns = read_npy::<_, Array3<f32>>(case.path("touches/frames.npy"))
        .unwrap()
        .dim()
        .2;
    for (taxel, values) in taxels.outer_iter().enumerate() {
        let mm = |k: usize| 1e3 * values[k];
        let (row, column) = (taxel / columns, taxel % columns);
        writeln!(text, "{},{},{},0,0,1,{row},{column}", mm(0), mm(1), mm(2)).unwrap();
    }
    case.file("touches/hexagonal.csv", text);
    let recorded = "frames = \"FOLDER/touches/frames.npy\"\nlabels = \"FOLDER/touches/labels.npy\"\nfull_scale = 5e-3\nnames = [\"golf\", \"tennis\", \"baseball\"]\n";
    let expected = scores(&case, recorded, &format!("{skin}{rest}"));
    assert!(expected.iter().any(|score| score.n_correct < score.n_test));
    let listed = format!("{recorded}layout = \"FOLDER/touches/hexagonal.csv\"\n");
    assert_eq!(scores(&case, &listed, &format!("{SKIN}{rest}")), expected);
}

#[test]
fn taxels_that_are_no_grid_have_images_and_neighbours_by_their_layout() {
    let case = written();
    // Positions of a grid in another order are no grid, but have nearly the same image.
    let swapped: Vec<usize> = (0..64).map(|k| (37 * k) % 64).collect();
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    write_npy(&case.path("swapped.npy"), &list.select(Axis(1), &swapped)).unwrap();
    let places = swapped
        .iter()
        .map(|k| (4.0 * (k % 8) as f64, 4.0 * (k / 8) as f64));
    case.file("swapped.csv", layout(places));
    let recorded =
        format!("{LABELS}frames = \"FOLDER/swapped.npy\"\nlayout = \"FOLDER/swapped.csv\"\n");
    let rest = format!("{SKIN}{IMAGES}");
    let grid = format!("{LABELS}frames = \"FOLDER/frames.npy\"\n");
    let correct = |rows: Vec<TrialScore>| rows.iter().map(|s| s.n_correct).collect::<Vec<_>>();
    assert_eq!(
        correct(scores(&case, &recorded, &rest)),
        correct(scores(&case, &grid, &rest))
    );
    let rest = format!("{SKIN}{COUPLED}{RAW}");
    assert_ne!(
        scores(&case, &recorded, &rest),
        scores(
            &case,
            &recorded.replace("layout", "#"),
            &rest
                .replace("\"crosstalk\", ", "")
                .replace(", \"smoothing\"", "")
                .replace("crosstalk = 0.2\n", "")
                .replace("smoothing_mm = 3.0\n", "")
        )
    );
    // Blocks need rows and columns.
    let blocks = format!(
        "{SKIN}[sensing]\nratio = 4\nensemble = \"block_average\"\n[recognition]\nclassifier = \"linear_svm\"\n"
    );
    assert!(error(&case, &recorded, &blocks).contains("layout of a file"));
    // The sample picture has three cells per pitch, and shows each taxel.
    let study = planned(&case, &recorded, &rest).unwrap();
    let cells = study.first().plan.arrays[0].picture_cells();
    assert_eq!(cells.dim(), (24, 24));
    let shown: std::collections::HashSet<_> = cells.iter().flatten().collect();
    assert_eq!(shown.len(), 64);
}

#[test]
fn two_sensors_with_the_taxels_of_one_give_its_rows() {
    let case = written();
    let rest = format!("{SKIN}{NOISE}{RAW}");
    let whole = format!("{LABELS}frames = \"FOLDER/list.npy\"\nfull_scale = 2.0\n");
    let expected = rows(&case, &whole, &rest);
    assert!(
        expected
            .iter()
            .any(|(_, score)| score.n_correct < score.n_test)
    );
    let scale = "full_scale = 2.0";
    assert_eq!(rows(&case, &sensors(scale, scale), &rest), expected);
    // Readings of another zero and scale are the same fractions of the full scale.
    let right: Array2<f64> = read_npy(case.path("right.npy")).unwrap();
    write_npy(&case.path("right.npy"), &(8.0 * right + 64.0)).unwrap();
    let scaled = sensors(scale, "zero = 64.0\nfull_scale = 80.0");
    assert_eq!(rows(&case, &scaled, &rest), expected);
    // An archive contains an array for each sensor.
    let mut archive =
        ndarray_npy::NpzWriter::new(std::fs::File::create(case.path("all.npz")).unwrap());
    for name in ["left", "right"] {
        let array: Array2<f64> = read_npy(case.path(&format!("{name}.npy"))).unwrap();
        archive.add_array(name, &array).unwrap();
    }
    archive.finish().unwrap();
    let archived = scaled
        .replace("left.npy", "all.npz")
        .replace("right.npy", "all.npz");
    assert_eq!(rows(&case, &archived, &rest), expected);
}

#[test]
fn each_sensor_alone_is_a_value_of_an_axis() {
    let case = written();
    let (left, right) = ("grid = [3, 8]", "grid = [5, 8]\npitch_mm = 4.0");
    let recorded = sensors(left, right);
    for rest in [
        format!("{SKIN}{NOISE}{RAW}"),
        format!("{SKIN}[signal]\nsteps = [\"crosstalk\"]\ncrosstalk = 0.2\n{IMAGES}"),
    ] {
        let axis = "[axes]\n\"recorded.sensor\" = [\"all\", \"left\", \"right\"]\n";
        let found = rows(&case, &recorded, &format!("{rest}{axis}"));
        let part = |number: usize| -> Vec<TrialScore> {
            let rows = found.iter().filter(|(of, _)| of.variant.number == number);
            rows.map(|(_, score)| score.clone()).collect()
        };
        assert_eq!(part(0), scores(&case, &recorded, &rest));
        for (number, name, keys) in [(1, "left", "grid = [3, 8]"), (2, "right", "grid = [5, 8]")] {
            let alone = format!("{LABELS}frames = \"FOLDER/{name}.npy\"\n{keys}\n");
            assert_eq!(part(number), scores(&case, &alone, &rest), "{name}");
        }
    }
    // Each sensor has an image of its own, and a frame has the features of all images.
    let study = planned(&case, &recorded, &format!("{SKIN}{IMAGES}")).unwrap();
    let array = &study.first().plan.arrays[0];
    assert_eq!(
        array.image_shapes(),
        [3, 5].map(|ny| ImageShape { ny, nx: 8 })
    );
    assert_eq!(array.n_taxels(), 64);
    // In the picture, the sensors are side by side, two pitches apart.
    assert_eq!(array.picture_cells().dim(), (15, 3 * (8 + 2 + 8)));
    let settings = format!("{:?}", study.first().touched.settings());
    says(&settings, &["left (24 taxels), right (40 taxels)"]);
}

#[test]
fn neighbours_are_taxels_of_the_same_sensor() {
    let case = written();
    let rows = |n: u32| {
        layout((0..n).map(|k| {
            (
                4.0 * f64::from(k % 8) + f64::from(k / 8),
                3.8 * f64::from(k / 8),
            )
        }))
    };
    case.file("left.csv", rows(24));
    case.file("right.csv", rows(40));
    let layouts = ["left", "right"].map(|name| format!("layout = \"FOLDER/{name}.csv\""));
    let recorded = sensors(&layouts[0], &layouts[1]);
    let rest = format!(
        "{SKIN}[signal]\nsteps = [\"crosstalk\", \"smoothing\"]\ncrosstalk = 0.2\nsmoothing_mm = 20.0\n[sensing]\nensemble = \"identity\"\n[recognition]\nclassifier = \"linear_svm\"\n"
    );
    let alone = format!("sensor = \"left\"\n{recorded}");
    let alone = scores(&case, &alone, &rest);
    assert_ne!(scores(&case, &recorded, &rest), alone);
    // The right sensor reads the same in all touches, so the left sensor decides as if it were alone.
    let even = Array2::<f64>::from_elem((N, 40), 1.0);
    write_npy(&case.path("right.npy"), &even).unwrap();
    let correct = |rows: &[TrialScore]| rows.iter().map(|s| s.n_correct).collect::<Vec<_>>();
    let together = scores(&case, &recorded, &rest);
    assert_eq!(correct(&together), correct(&alone));
}

/// Writes recordings of touches with 4 to 7 frames, padded with NaN and padded with numbers.
fn unequal(case: &Case) -> Vec<usize> {
    let lengths: Vec<usize> = (0..N).map(|touch| 4 + touch % 4).collect();
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    let padded = |padding: f64| {
        Array3::from_shape_fn((N, 7, 64), |(touch, frame, taxel)| {
            let part = frame as f64 / (lengths[touch] - 1) as f64;
            if part <= 1.0 {
                list[[touch, taxel]] * part
            } else {
                padding
            }
        })
    };
    write_npy(&case.path("nan.npy"), &padded(f64::NAN)).unwrap();
    write_npy(&case.path("number.npy"), &padded(0.3)).unwrap();
    write_integers(&case.path("lengths.npy"), lengths.iter().copied()).unwrap();
    let even = Array3::from_shape_fn((N, 4, 64), |(touch, frame, taxel)| {
        list[[touch, taxel]] * frame as f64 / 3.0
    });
    write_npy(&case.path("even.npy"), &even).unwrap();
    lengths
}

#[test]
fn touches_of_unequal_length_are_resampled() {
    let case = written();
    unequal(&case);
    let keys = |file: &str, more: &str| {
        format!(
            "{LABELS}frames = \"FOLDER/{file}.npy\"\norder = \"n t c\"\nfull_scale = 2.0\n{more}\n"
        )
    };
    let rest = format!("{SKIN}{RAW}temporal_features = [\"summarised\", \"deepest\"]\n");
    let padded = scores(&case, &keys("nan", "resampled_frames = 4"), &rest);
    let counted = keys(
        "number",
        "lengths = \"FOLDER/lengths.npy\"\nresampled_frames = 4",
    );
    assert_eq!(scores(&case, &counted, &rest), padded);
    // Readings that are linear in time stay the same, up to rounding.
    let correct = |rows: &[TrialScore]| rows.iter().map(|s| s.n_correct).collect::<Vec<_>>();
    let even = scores(&case, &keys("even", ""), &rest);
    assert_eq!(correct(&even), correct(&padded));
    assert_eq!(
        scores(&case, &keys("even", "resampled_frames = 4"), &rest),
        even
    );
    // One frame is the last frame of each touch.
    let one = scores(
        &case,
        &keys("nan", "resampled_frames = 1"),
        &format!("{SKIN}{RAW}"),
    );
    let last = format!("{LABELS}frames = \"FOLDER/list.npy\"\nfull_scale = 2.0\n");
    assert_eq!(
        correct(&one),
        correct(&scores(&case, &last, &format!("{SKIN}{RAW}")))
    );
    let refused = error(&case, &keys("nan", ""), &rest);
    says(
        &refused,
        &[
            "nan.npy: touches of 4 to 7 of 7 frames; ",
            "recorded.resampled_frames",
        ],
    );
}

#[test]
fn sensors_of_other_rates_are_resampled_to_the_same_frames() {
    let case = written();
    unequal(&case);
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    for (name, columns, n_frames) in [("left", 0..24, 4), ("right", 24..64, 7)] {
        let own = Array3::from_shape_fn((N, n_frames, columns.len()), |(touch, frame, taxel)| {
            list[[touch, columns.start + taxel]] * frame as f64 / (n_frames - 1) as f64
        });
        write_npy(&case.path(&format!("{name}.npy")), &own).unwrap();
    }
    let order = "order = \"n t c\"\nfull_scale = 2.0";
    let rest = format!("{SKIN}{RAW}");
    let refused = error(&case, &sensors(order, order), &rest);
    says(
        &refused,
        &["right.npy: touches of 7 frames; 4, as ", "resampled_frames"],
    );
    let recorded = format!("resampled_frames = 4\n{}", sensors(order, order));
    let whole =
        format!("{LABELS}frames = \"FOLDER/even.npy\"\norder = \"n t c\"\nfull_scale = 2.0\n");
    let correct = |rows: Vec<TrialScore>| rows.iter().map(|s| s.n_correct).collect::<Vec<_>>();
    assert_eq!(
        correct(scores(&case, &recorded, &rest)),
        correct(scores(&case, &whole, &rest))
    );
}

/// Each invalid recording gives one sentence with the file or the key.
/// Creates a folder of recordings, with files that contradict them.
pub fn contradictory() -> Case {
    let case = written();
    unequal(&case);
    let write = |name: &str, numbers: Vec<f64>| {
        write_npy(&case.path(name), &ndarray::Array1::from(numbers)).unwrap();
    };
    write("short.npy", vec![4.0; N - 1]);
    write("zero.npy", vec![0.0; N]);
    write("half.npy", vec![3.5; N]);
    write("long.npy", vec![8.0; N]);
    let mut empty: Array3<f64> = read_npy(case.path("nan.npy")).unwrap();
    empty.slice_mut(s![5, .., ..]).fill(f64::NAN);
    write_npy(&case.path("empty.npy"), &empty).unwrap();
    write_npy(&case.path("fewer.npy"), &Array2::<f64>::ones((N - 1, 40))).unwrap();
    case.file("few.csv", layout((0..63).map(|k| (f64::from(k), 0.0))));
    case.file(
        "metres.csv",
        layout((0..64).map(|k| (f64::from(k % 8) * 4e-3, f64::from(k / 8) * 4.1e-3))),
    );
    case.file(
        "wide.csv",
        layout((0..64).map(|k| (f64::from(k % 8) * 5.0, f64::from(k / 8) * 5.0))),
    );
    case.file("truncated.csv", "x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3\n");
    case.file(
        "truncated.npy",
        &std::fs::read(case.path("left.npy")).unwrap()[..200],
    );
    case.file("texts.csv", "a\n".repeat(N));
    let mut one_nan: Array2<f64> = read_npy(case.path("left.npy")).unwrap();
    one_nan[[7, 3]] = f64::NAN;
    write_npy(&case.path("one_nan.npy"), &one_nan).unwrap();
    write("nan_length.npy", vec![f64::NAN; N]);
    let header = "x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,1\n";
    case.file("nan.csv", format!("{header}nan,2,3,0,0,1\n"));
    case.file("no_normal.csv", format!("{header}1,2,3,0,0,0\n"));
    case.file("no_column.csv", "x_mm,y_mm,z_mm,nx,ny\n");
    case.file("broken.npz", "PK no archive");
    case
}

/// An audit checks one sensor, because its checks compare the readings of taxels.
#[test]
fn an_audit_is_of_one_sensor() {
    let case = written();
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    let file = std::fs::File::create(case.path("all.npz")).unwrap();
    let mut archive = ndarray_npy::NpzWriter::new(file);
    archive
        .add_array("left", &list.slice(s![.., ..24]))
        .unwrap();
    archive
        .add_array("right", &list.slice(s![.., 24..]))
        .unwrap();
    archive.finish().unwrap();
    let recorded = |sensor: &str| {
        let sensors = sensors("", "")
            .replace("left.npy", "all.npz")
            .replace("right.npy", "all.npz");
        format!("[recorded]\n{sensor}\n{sensors}").replace("FOLDER/", "")
    };
    let audit = ["audit", ".", "--out", "checked", "--permutations", "399"];
    case.file("recorded.toml", recorded(""));
    let said = case.refuses(&audit);
    says(
        &said,
        &[
            "recorded.toml, key recorded.sensors: 2 sensors; one sensor: its name in recorded.sensor",
        ],
    );
    case.file("recorded.toml", recorded("sensor = \"right\""));
    let (said, _) = case.succeeds(&audit);
    let alone = [
        "audit",
        "right.npy",
        "--labels",
        "labels.npy",
        "--out",
        "alone",
        "--permutations",
        "399",
    ];
    let (expected, _) = case.succeeds(&alone);
    assert_eq!(said, expected.replace("alone", "checked"));
}

/// Events of two signs at each position, in any order of the axes, are values of one position.
#[test]
fn several_values_at_a_position_have_an_image_each() {
    let case = written();
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    let n = 32;
    // The first half of the list has the positive events of 32 positions, the second half the negative ones.
    let first = Array3::from_shape_fn((N, 2, n), |(touch, sign, place)| {
        list[[touch, sign * n + place]]
    });
    let last = first
        .view()
        .permuted_axes([0, 2, 1])
        .as_standard_layout()
        .into_owned();
    write_npy(&case.path("first.npy"), &first).unwrap();
    write_npy(&case.path("last.npy"), &last).unwrap();
    let places = || {
        (0..n as u32).map(|k| {
            (
                4.0 * f64::from(k % 8) + f64::from(k / 8),
                3.8 * f64::from(k / 8),
            )
        })
    };
    case.file("places.csv", layout(places()));
    case.file("few.csv", layout(places().take(31)));
    let keys = |file: &str| {
        format!(
            "{LABELS}frames = \"FOLDER/{file}.npy\"\norder = \"n c c\"\nlayout = \"FOLDER/places.csv\"\nfull_scale = 2.0\n"
        )
    };
    let rest = format!("{SKIN}{COUPLED}{IMAGES}");
    let expected = rows(&case, &keys("first"), &rest);
    assert_eq!(rows(&case, &keys("last"), &rest), expected);
    let study = planned(&case, &keys("last"), &rest).unwrap();
    assert_eq!(study.first().plan.arrays[0].image_shapes().len(), 2);
    // The values of each sign are like a sensor of their own.
    write_npy(&case.path("left.npy"), &list.slice(s![.., ..n]).to_owned()).unwrap();
    write_npy(&case.path("right.npy"), &list.slice(s![.., n..]).to_owned()).unwrap();
    let own = "layout = \"FOLDER/places.csv\"\nfull_scale = 2.0";
    let scores_of = |rows: &[(Configuration, TrialScore)]| -> Vec<TrialScore> {
        rows.iter().map(|(_, score)| score.clone()).collect()
    };
    assert_eq!(
        scores(&case, &sensors(own, own), &rest),
        scores_of(&expected)
    );
    let wrong = keys("last").replace("places.csv", "few.csv");
    let said = error(&case, &wrong, &rest);
    says(&said, &["few.csv: 31 taxels; 64, as "]);
}

/// Law: the taxels of a simulated recording, divided into two sensors and joined again, give the rows of the whole recording.
#[test]
fn a_simulated_recording_that_is_divided_and_joined_gives_its_rows() {
    let case = written();
    let pressed = "question = \"?\"\ntrials = 2\n[objects]\nsets = [\"balls\"]\nnames = [\"golf\", \"tennis\", \"baseball\"]\n[touches]\nper_object = 12\nframes = 3\noffset_x_mm = { uniform = [-6.0, 6.0] }\noffset_y_mm = { uniform = [-6.0, 6.0] }\ndepth_mm = { uniform = [1.0, 7.0] }\n";
    let rest = "[signal]\nsteps = [\"hysteresis\", \"gain\", \"noise\", \"quantisation\"]\nhysteresis_full_scale = 0.2\ngain_std = 0.1\nnoise_std_full_scale = 0.02\nadc_bits = 8\n[sensing]\nmeasurements = 12\nensemble = [\"gaussian\", \"selected\"]\n[recognition]\nclassifier = \"linear_svm\"\ntemporal_features = \"summarised\"\n";
    case.file("study.toml", format!("{pressed}{SKIN}taxels = 8\n{rest}"));
    case.succeeds(&["touches", "study.toml", "--out", "touches"]);
    let frames: ndarray::Array4<f32> = read_npy(case.path("touches/frames.npy")).unwrap();
    let list = frames.into_shape_with_order((36, 3, 64)).unwrap();
    write_npy(&case.path("whole.npy"), &list).unwrap();
    write_npy(
        &case.path("left.npy"),
        &list.slice(s![.., .., ..17]).to_owned(),
    )
    .unwrap();
    write_npy(
        &case.path("right.npy"),
        &list.slice(s![.., .., 17..]).to_owned(),
    )
    .unwrap();
    let labels =
        "labels = \"FOLDER/touches/labels.npy\"\nnames = [\"golf\", \"tennis\", \"baseball\"]\n";
    let own = "order = \"n t c\"\nfull_scale = 5e-3";
    let whole = format!("{labels}frames = \"FOLDER/whole.npy\"\n{own}\n");
    let rest = format!("{SKIN}{rest}");
    let expected = rows(&case, &whole, &rest);
    assert!(
        expected
            .iter()
            .any(|(_, score)| score.n_correct < score.n_test)
    );
    let divided = sensors(own, own).replace(LABELS, labels);
    assert_eq!(rows(&case, &divided, &rest), expected);
}

/// A given test set of several sensors, in files of its own and in one archive.
#[test]
fn sensors_may_have_a_given_test_set() {
    let case = written();
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    let side =
        |is_test: bool| -> Vec<usize> { (0..N).filter(|k| (k % 4 == 0) == is_test).collect() };
    let file = std::fs::File::create(case.path("all.npz")).unwrap();
    let mut archive = ndarray_npy::NpzWriter::new(file);
    for (end, is_test) in [("", false), ("_test", true)] {
        let touches = side(is_test);
        let own = list.select(Axis(0), &touches);
        write_npy(&case.path(&format!("whole{end}.npy")), &own).unwrap();
        write_integers(
            &case.path(&format!("labels{end}.npy")),
            touches.iter().map(|k| k / 20),
        )
        .unwrap();
        for (name, columns) in [("left", s![.., ..24]), ("right", s![.., 24..])] {
            let part = own.slice(columns).to_owned();
            write_npy(&case.path(&format!("{name}{end}.npy")), &part).unwrap();
            archive.add_array(format!("{name}{end}"), &part).unwrap();
        }
    }
    archive.finish().unwrap();
    let test = "labels_test = \"FOLDER/labels_test.npy\"\n";
    let whole = format!(
        "{LABELS}{test}frames = \"FOLDER/whole.npy\"\nframes_test = \"FOLDER/whole_test.npy\"\nfull_scale = 2.0\n"
    );
    let rest = format!("{SKIN}{NOISE}{RAW}");
    let expected = rows(&case, &whole, &rest);
    let own = |name: &str| format!("frames_test = \"FOLDER/{name}_test.npy\"\nfull_scale = 2.0");
    let recorded = format!("{test}{}", sensors(&own("left"), &own("right")));
    assert_eq!(rows(&case, &recorded, &rest), expected);
    let scale = "full_scale = 2.0";
    let archived = sensors(scale, scale)
        .replace("left.npy", "all.npz")
        .replace("right.npy", "all.npz");
    assert_eq!(rows(&case, &format!("{test}{archived}"), &rest), expected);
    let one = format!("{test}{}", sensors(&own("left"), scale));
    let said = error(&case, &one, &rest);
    says(
        &said,
        &["key recorded.sensors[2].frames_test: no such key; frames of the test set"],
    );
}
