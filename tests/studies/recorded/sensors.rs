//! Recordings whose taxels have positions in a layout file, several sensors that are read together, and touches of unequal length.

use super::{
    COUPLED, IMAGES, LABELS, N, NOISE, RAW, SKIN, has_errors, label, layout, list, n_correct,
    of_file, permuted, recordings, sensors,
};
use crate::command::{Case, says};
use crate::study::scores_of_variant;
use bubbletouch::study::table::{Configuration, TrialScore};
use bubbletouch::world::ImageShape;
use ndarray::{Array1, Array2, Array3, Array4, Axis, s};
use std::collections::HashSet;
use std::fmt::Write as _;

/// Study of three balls, whose simulated touches are recordings.
const PRESSED: &str = "question = \"?\"\ntrials = 2\n[objects]\nsets = [\"balls\"]\nnames = [\"golf\", \"tennis\", \"baseball\"]\n[touches]\nper_object = 12\noffset_x_mm = { uniform = [-6.0, 6.0] }\noffset_y_mm = { uniform = [-6.0, 6.0] }\ndepth_mm = { uniform = [1.0, 7.0] }\n";

const PRESSED_LABELS: &str =
    "labels = \"touches/labels.npy\"\nnames = [\"golf\", \"tennis\", \"baseball\"]\n";

/// Returns the rows of a study in which some decisions are wrong.
pub fn rows_with_errors(
    case: &Case,
    recorded: &str,
    rest: &str,
) -> Vec<(Configuration, TrialScore)> {
    let rows = case.scored_rows(recorded, rest);
    assert!(rows.iter().any(|(_, score)| score.n_correct < score.n_test));
    rows
}

/// Returns places of `n` taxels in oblique rows of eight, which are no grid, millimetres.
fn oblique(n: u32) -> impl Iterator<Item = (f64, f64)> {
    (0..n)
        .map(|k| (f64::from(k % 8), f64::from(k / 8)))
        .map(|(x, y)| (4.0 * x + y, 3.8 * y))
}

#[test]
fn a_layout_file_of_a_grid_gives_the_rows_of_the_grid() {
    let case = recordings();
    let grid = of_file("frames.npy");
    let layout = "layout = \"grid.csv\"\n";
    let blocks = "ratio = 4\nensemble = \"block_average\"";
    let blocks = RAW.replace("measurements = 8", blocks);
    for rest in [IMAGES, &blocks] {
        let rest = format!("{SKIN}{COUPLED}{rest}");
        let expected = rows_with_errors(&case, &grid, &rest);
        for recorded in [of_file("list.npy"), grid.clone()] {
            assert_eq!(case.scored_rows(&(recorded + layout), &rest), expected);
        }
    }
}

#[test]
fn a_layout_file_of_hexagonal_taxels_gives_the_rows_of_the_layout() {
    let case = recordings();
    let skin = format!("{SKIN}taxels = 8\nlayout = \"hexagonal\"\n");
    let rest = format!("{COUPLED}{RAW}");
    case.file("study.toml", format!("{PRESSED}{skin}{rest}"));
    case.succeeds("touches study.toml --out touches");
    let taxels: Array2<f64> = case.read_array("touches/taxels.npy");
    let frames: Array3<f32> = case.read_array("touches/frames.npy");
    let columns = frames.dim().2;
    let mut text = String::from("x_mm,y_mm,z_mm,nx,ny,nz,row,column\n");
    for (taxel, values) in taxels.outer_iter().enumerate() {
        let [x, y, z] = [0, 1, 2].map(|k| 1e3 * values[k]);
        let (row, column) = (taxel / columns, taxel % columns);
        writeln!(text, "{x},{y},{z},0,0,1,{row},{column}").unwrap();
    }
    case.file("hexagonal.csv", text);
    let recorded = format!("{PRESSED_LABELS}frames = \"touches/frames.npy\"\nfull_scale = 5e-3\n");
    let expected = case.scores(&recorded, &format!("{skin}{rest}"));
    assert!(has_errors(&expected));
    let listed = format!("{recorded}layout = \"hexagonal.csv\"\n");
    assert_eq!(case.scores(&listed, &format!("{SKIN}{rest}")), expected);
}

#[test]
fn taxels_that_are_no_grid_have_images_and_neighbours_by_their_layout() {
    let case = recordings();
    // Positions of a grid in another order are no grid, but have nearly the same image.
    let swapped: Vec<usize> = (0..64).map(|k| (37 * k) % 64).collect();
    case.write_array("swapped.npy", &list().select(Axis(1), &swapped));
    let place = |k: &usize| (4.0 * (k % 8) as f64, 4.0 * (k / 8) as f64);
    case.file("swapped.csv", layout(swapped.iter().map(place)));
    let alone = of_file("swapped.npy");
    let recorded = format!("{alone}layout = \"swapped.csv\"\n");
    let rest = format!("{SKIN}{IMAGES}");
    let [swapped, grid] = [&recorded, &of_file("frames.npy")].map(|keys| case.scores(keys, &rest));
    assert_eq!(n_correct(&swapped), n_correct(&grid));
    let rest = format!("{SKIN}{COUPLED}{RAW}");
    let noise = "[signal]\nsteps = [\"noise\"]\nnoise_std_full_scale = 0.05\n";
    let uncoupled = case.scores(&alone, &format!("{SKIN}{noise}{RAW}"));
    assert_ne!(case.scores(&recorded, &rest), uncoupled);
    // The sample picture has three cells per pitch, and shows each taxel.
    let study = case.recorded(&recorded, &rest).unwrap();
    let cells = study.first().plan.array.picture_cells();
    assert_eq!(cells.dim(), (24, 24));
    let shown: HashSet<_> = cells.iter().flatten().collect();
    assert_eq!(shown.len(), 64);
}

/// Replaces the files of two sensors by an archive.
fn in_archive(recorded: &str) -> String {
    recorded
        .replace("left.npy", "all.npz")
        .replace("right.npy", "all.npz")
}

/// Writes an archive with an array for each of two sensors.
fn write_archive(case: &Case) {
    let list = list();
    let mut archive = case.archive("all.npz");
    for (name, taxels) in [("left", s![.., ..24]), ("right", s![.., 24..])] {
        archive.add_array(name, &list.slice(taxels)).unwrap();
    }
    archive.finish().unwrap();
}

#[test]
fn two_sensors_with_the_taxels_of_one_give_its_rows() {
    let case = recordings();
    let rest = format!("{SKIN}{NOISE}{RAW}");
    let scale = "full_scale = 2.0";
    let expected = rows_with_errors(&case, &(of_file("list.npy") + scale), &rest);
    let both = sensors(scale, scale);
    assert_eq!(case.scored_rows(&both, &rest), expected);
    write_archive(&case);
    assert_eq!(case.scored_rows(&in_archive(&both), &rest), expected);
    // Readings of another zero and scale are the same fractions of the full scale.
    let right: Array2<f64> = case.read_array("right.npy");
    case.write_array("right.npy", &(8.0 * right + 64.0));
    let scaled = sensors(scale, "zero = 64.0\nfull_scale = 80.0");
    assert_eq!(case.scored_rows(&scaled, &rest), expected);
}

#[test]
fn each_sensor_alone_is_a_value_of_an_axis() {
    let case = recordings();
    let (left, right) = ("grid = [3, 8]", "grid = [5, 8]\npitch_mm = 4.0");
    let recorded = sensors(left, right);
    let coupled = "[signal]\nsteps = [\"crosstalk\"]\ncrosstalk = 0.2\n";
    for rest in [[NOISE, RAW], [coupled, IMAGES]] {
        let rest = format!("{SKIN}{}", rest.concat());
        let axis = "[axes]\n\"recorded.sensor\" = [\"all\", \"left\", \"right\"]\n";
        let found = case.scored_rows(&recorded, &format!("{rest}{axis}"));
        let left = of_file("left.npy") + "grid = [3, 8]\n";
        let right = of_file("right.npy") + "grid = [5, 8]\n";
        for (number, alone) in [&recorded, &left, &right].into_iter().enumerate() {
            let expected = case.scores(alone, &rest);
            assert_eq!(scores_of_variant(&found, number), expected, "{alone}");
        }
    }
    // Each sensor has an image of its own, and a frame has the features of all images.
    let study = case.recorded(&recorded, &format!("{SKIN}{IMAGES}"));
    let study = study.unwrap();
    let array = &study.first().plan.array;
    let shapes = [3, 5].map(|ny| ImageShape { ny, nx: 8 });
    assert_eq!(array.image_shapes(), shapes);
    assert_eq!(array.n_taxels(), 64);
    // In the picture, the sensors are side by side, two pitches apart.
    assert_eq!(array.picture_cells().dim(), (15, 3 * (8 + 2 + 8)));
    let settings = format!("{:?}", study.first().touched.settings());
    says(&settings, &["left (24 taxels), right (40 taxels)"]);
}

#[test]
fn neighbours_are_taxels_of_the_same_sensor() {
    let case = recordings();
    case.file("left.csv", layout(oblique(24)));
    case.file("right.csv", layout(oblique(40)));
    let recorded = sensors("layout = \"left.csv\"", "layout = \"right.csv\"");
    let signal =
        "[signal]\nsteps = [\"crosstalk\", \"smoothing\"]\ncrosstalk = 0.2\nsmoothing_mm = 20.0\n";
    let identity = RAW.replace("measurements = 8", "ensemble = \"identity\"");
    let rest = format!("{SKIN}{signal}{identity}");
    let alone = case.scores(&format!("sensor = \"left\"\n{recorded}"), &rest);
    assert_ne!(case.scores(&recorded, &rest), alone);
    // The right sensor reads the same in all touches, so the left sensor decides as if it were alone.
    case.write_array("right.npy", &Array2::<f64>::ones((N, 40)));
    let together = case.scores(&recorded, &rest);
    assert_eq!(n_correct(&together), n_correct(&alone));
}

/// Returns frames of taxels whose readings rise evenly to those of the list.
fn rising(n_frames: usize) -> Array3<f64> {
    let list = list();
    Array3::from_shape_fn((N, n_frames, 64), |(touch, frame, taxel)| {
        list[[touch, taxel]] * frame as f64 / (n_frames - 1) as f64
    })
}

/// Writes recordings of touches with 4 to 7 frames, padded with NaN and padded with numbers, and of touches with 4 frames.
fn write_unequal(case: &Case) {
    let list = list();
    let n_frames = |touch: usize| 4 + touch % 4;
    let padded = |padding: f64| {
        Array3::from_shape_fn((N, 7, 64), |(touch, frame, taxel)| {
            let part = frame as f64 / (n_frames(touch) - 1) as f64;
            match part <= 1.0 {
                true => list[[touch, taxel]] * part,
                false => padding,
            }
        })
    };
    case.write_array("nan.npy", &padded(f64::NAN));
    case.write_array("number.npy", &padded(0.3));
    case.write_integers("lengths.npy", (0..N).map(n_frames));
    case.write_array("even.npy", &rising(4));
}

/// Order of frames of taxels without places, with the full scale.
const IN_TIME: &str = "order = \"n t c\"\nfull_scale = 2.0\n";

#[test]
fn touches_of_unequal_length_are_resampled() {
    let case = recordings();
    write_unequal(&case);
    let rest = format!("{SKIN}{RAW}");
    let over_time = format!("{rest}temporal_features = [\"summarised\", \"deepest\"]\n");
    let scores = |file: &str, more: &str, rest: &str| {
        case.scores(&format!("{}{IN_TIME}{more}\n", of_file(file)), rest)
    };
    let padded = scores("nan.npy", "resampled_frames = 4", &over_time);
    let counted = "lengths = \"lengths.npy\"\nresampled_frames = 4";
    assert_eq!(scores("number.npy", counted, &over_time), padded);
    // Readings that are linear in time stay the same, up to rounding.
    let even = scores("even.npy", "", &over_time);
    assert_eq!(n_correct(&even), n_correct(&padded));
    let resampled = scores("even.npy", "resampled_frames = 4", &over_time);
    assert_eq!(resampled, even);
    // One frame is the last frame of each touch.
    let one = scores("nan.npy", "resampled_frames = 1", &rest);
    let last = case.scores(&(of_file("list.npy") + "full_scale = 2.0"), &rest);
    assert_eq!(n_correct(&one), n_correct(&last));
}

#[test]
fn sensors_of_other_rates_are_resampled_to_the_same_frames() {
    let case = recordings();
    write_unequal(&case);
    write_rates(&case, ["left.npy", "right.npy"]);
    let rest = format!("{SKIN}{RAW}");
    let recorded = format!("resampled_frames = 4\n{}", sensors(IN_TIME, IN_TIME));
    let whole = of_file("even.npy") + IN_TIME;
    let [found, expected] = [recorded, whole].map(|keys| case.scores(&keys, &rest));
    assert_eq!(n_correct(&found), n_correct(&expected));
}

/// Writes touches of 4 frames for the left sensor and of 7 frames for the right one.
fn write_rates(case: &Case, [left, right]: [&str; 2]) {
    case.write_array(left, &rising(4).slice(s![.., .., ..24]));
    case.write_array(right, &rising(7).slice(s![.., .., 24..]));
}

/// Creates a folder of recordings, with files that contradict them.
pub fn contradictory() -> Case {
    let case = recordings();
    write_unequal(&case);
    write_rates(&case, ["slow.npy", "fast.npy"]);
    let write = |name: &str, number: f64, n: usize| {
        case.write_array(name, &Array1::from_elem(n, number));
    };
    write("short.npy", 4.0, N - 1);
    write("zero.npy", 0.0, N);
    write("half.npy", 3.5, N);
    write("long.npy", 8.0, N);
    write("nan_length.npy", f64::NAN, N);
    let mut empty: Array3<f64> = case.read_array("nan.npy");
    empty.slice_mut(s![5, .., ..]).fill(f64::NAN);
    case.write_array("empty.npy", &empty);
    case.write_array("fewer.npy", &Array2::<f64>::ones((N - 1, 40)));
    case.file("few.csv", layout((0..63).map(|k| (f64::from(k), 0.0))));
    let grid =
        |x: f64, y: f64| layout((0..64).map(|k| (f64::from(k % 8) * x, f64::from(k / 8) * y)));
    case.file("metres.csv", grid(4e-3, 4.1e-3));
    case.file("wide.csv", grid(5.0, 5.0));
    case.file("oblique.csv", layout(oblique(64)));
    case.file("truncated.csv", "x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3\n");
    let left = case.bytes("left.npy");
    case.file("truncated.npy", &left[..200]);
    case.file("texts.csv", "a\n".repeat(N));
    let mut one_nan: Array2<f64> = case.read_array("left.npy");
    one_nan[[7, 3]] = f64::NAN;
    case.write_array("one_nan.npy", &one_nan);
    let header = "x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,1\n";
    case.file("nan.csv", format!("{header}nan,2,3,0,0,1\n"));
    case.file("no_normal.csv", format!("{header}1,2,3,0,0,0\n"));
    case.file("no_column.csv", "x_mm,y_mm,z_mm,nx,ny\n");
    case.file("broken.npz", "PK no archive");
    write_signs(&case);
    case
}

/// An audit checks one sensor, because its checks compare the readings of taxels.
#[test]
fn an_audit_is_of_one_sensor() {
    let case = recordings();
    write_archive(&case);
    let recorded = |sensor: &str| format!("[recorded]\n{sensor}\n{}", in_archive(&sensors("", "")));
    let audit = ["audit", ".", "--out", "checked", "--permutations", "399"];
    case.file("recorded.toml", recorded(""));
    let said = case.refuses(&audit);
    let several =
        "recorded.toml, key recorded.sensors: 2 sensors; one sensor: its name in recorded.sensor";
    says(&said, &[several]);
    case.file("recorded.toml", recorded("sensor = \"right\""));
    let (said, _) = case.succeeds(&audit);
    let alone = "audit right.npy --labels labels.npy --out alone --permutations 399";
    let (expected, _) = case.succeeds(alone);
    assert_eq!(said, expected.replace("alone", "checked"));
}

/// Writes the positive and the negative events of 32 positions, in two orders of the axes, and the layout of the positions.
fn write_signs(case: &Case) {
    // The first half of the list has the positive events, the second half the negative ones.
    let first = list().into_shape_with_order((N, 2, 32)).unwrap();
    case.write_array("first.npy", &first);
    case.write_array("last.npy", &permuted(&first, [0, 2, 1]));
    case.file("places.csv", layout(oblique(32)));
    case.file("places_31.csv", layout(oblique(31)));
}

/// Events of two signs at each position, in any order of the axes, are values of one position.
#[test]
fn several_values_at_a_position_have_an_image_each() {
    let case = recordings();
    write_signs(&case);
    let own = "layout = \"places.csv\"\nfull_scale = 2.0\n";
    let keys = |file: &str| format!("{}order = \"n c c\"\n{own}", of_file(file));
    let rest = format!("{SKIN}{COUPLED}{IMAGES}");
    let expected = case.scored_rows(&keys("first.npy"), &rest);
    assert_eq!(case.scored_rows(&keys("last.npy"), &rest), expected);
    let study = case.recorded(&keys("last.npy"), &rest).unwrap();
    assert_eq!(study.first().plan.array.image_shapes().len(), 2);
    // The values of each sign are like a sensor of their own.
    case.write_array("left.npy", &list().slice(s![.., ..32]));
    case.write_array("right.npy", &list().slice(s![.., 32..]));
    let expected: Vec<TrialScore> = expected.into_iter().map(|(_, score)| score).collect();
    assert_eq!(case.scores(&sensors(own, own), &rest), expected);
}

/// Law: the taxels of a simulated recording, divided into two sensors and joined again, give the rows of the whole recording.
#[test]
fn a_simulated_recording_that_is_divided_and_joined_gives_its_rows() {
    let case = recordings();
    let pressed = PRESSED.replace("per_object = 12\n", "per_object = 12\nframes = 3\n");
    let rest = "[signal]\nsteps = [\"hysteresis\", \"gain\", \"noise\", \"quantisation\"]\nhysteresis_full_scale = 0.2\ngain_std = 0.1\nnoise_std_full_scale = 0.02\nadc_bits = 8\n[sensing]\nmeasurements = 12\nensemble = [\"gaussian\", \"selected\"]\n[recognition]\nclassifier = \"linear_svm\"\ntemporal_features = \"summarised\"\n";
    case.file("study.toml", format!("{pressed}{SKIN}taxels = 8\n{rest}"));
    case.succeeds("touches study.toml --out touches");
    let frames: Array4<f32> = case.read_array("touches/frames.npy");
    let list = frames.into_shape_with_order((36, 3, 64)).unwrap();
    case.write_array("whole.npy", &list);
    case.write_array("left.npy", &list.slice(s![.., .., ..17]));
    case.write_array("right.npy", &list.slice(s![.., .., 17..]));
    let own = "order = \"n t c\"\nfull_scale = 5e-3\n";
    let whole = format!("{PRESSED_LABELS}frames = \"whole.npy\"\n{own}");
    let rest = format!("{SKIN}{rest}");
    let expected = rows_with_errors(&case, &whole, &rest);
    let divided = sensors(own, own).replace(LABELS, PRESSED_LABELS);
    assert_eq!(case.scored_rows(&divided, &rest), expected);
}

/// A given test set of several sensors, in files of its own and in one archive.
#[test]
fn sensors_may_have_a_given_test_set() {
    let case = recordings();
    let mut archive = case.archive("all.npz");
    for (end, is_test) in [("", false), ("_test", true)] {
        let touches: Vec<usize> = (0..N).filter(|k| (k % 4 == 0) == is_test).collect();
        let own = list().select(Axis(0), &touches);
        case.write_array(&format!("whole{end}.npy"), &own);
        let labels = touches.iter().map(|&touch| label(touch));
        case.write_integers(&format!("labels{end}.npy"), labels);
        for (name, columns) in [("left", s![.., ..24]), ("right", s![.., 24..])] {
            let part = own.slice(columns);
            case.write_array(&format!("{name}{end}.npy"), &part);
            archive.add_array(format!("{name}{end}"), &part).unwrap();
        }
    }
    archive.finish().unwrap();
    let rest = format!("{SKIN}{NOISE}{RAW}");
    let test = "labels_test = \"labels_test.npy\"\n";
    let scale = "full_scale = 2.0";
    let own = |name: &str| format!("frames_test = \"{name}_test.npy\"\n{scale}\n");
    let whole = format!("{test}{}{}", of_file("whole.npy"), own("whole"));
    let expected = case.scored_rows(&whole, &rest);
    let files = sensors(&own("left"), &own("right"));
    for recorded in [files, in_archive(&sensors(scale, scale))] {
        let found = case.scored_rows(&format!("{test}{recorded}"), &rest);
        assert_eq!(found, expected, "{recorded}");
    }
    let one = format!("{test}{}", sensors(&own("left"), scale));
    let said = case.recorded(&one, &rest).err().unwrap().to_string();
    let wanted = "key recorded.sensors[2].frames_test: no such key; frames of the test set";
    says(&said, &[wanted]);
}
