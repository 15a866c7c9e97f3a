//! Studies of public recordings run on simulated recordings of the shapes, types and files that `experiments/convert_*.py` write.

use crate::command::Case;
use bubbletouch::random::Seed;
use bubbletouch::study::{write_integers, write_npy, write_texts};
use ndarray::{Array2, Array3, s};
use rand::Rng;
use rand_distr::StandardNormal;
use std::collections::BTreeMap;
use std::path::Path;

/// Simulated sequence of a contact: its place and size depend on the class, and a pattern of its own repeats in all frames of the sequence.
struct Sequence {
    class: usize,
    group: usize,
}

/// Returns frames of `n_frames` for each sequence, shape (n, rows · columns). The contact is a cap that is cut at zero; readings are fractions of `full_scale`.
fn simulated(
    sequences: &[Sequence],
    n_frames: usize,
    (rows, columns): (usize, usize),
    full_scale: f64,
) -> Array2<f64> {
    let mut rng = Seed::new(11).named("public sets").rng();
    let mut frames = Array2::zeros((sequences.len() * n_frames, rows * columns));
    for (number, &Sequence { class, .. }) in sequences.iter().enumerate() {
        let place = (class as f64 * 2.4).sin_cos();
        let at = |share: f64, n: usize| (0.5 + 0.3 * share) * n as f64;
        let (y, x) = (at(place.0, rows), at(place.1, columns));
        let radius = 0.2 * rows.max(columns) as f64;
        let own = (0..rows * columns).map(|_| rng.sample(StandardNormal));
        let own: Vec<f64> = own.collect();
        for frame in 0..n_frames {
            let readings = frames.row_mut(number * n_frames + frame);
            for (taxel, reading) in readings.into_iter().enumerate() {
                let away = ((taxel / columns) as f64 - y).hypot((taxel % columns) as f64 - x);
                let cap = (1.0 - away / radius).max(0.0);
                let noise: f64 = rng.sample(StandardNormal);
                let share = 0.2 + 0.1 * cap + 0.12 * own[taxel] + 0.01 * noise;
                *reading = (full_scale * share).clamp(0.0, full_scale).round();
            }
        }
    }
    frames
}

fn texts(path: &Path, of: impl Fn(&Sequence) -> String, sequences: &[Sequence], n_frames: usize) {
    let texts = sequences.iter().flat_map(|one| vec![of(one); n_frames]);
    write_texts(path, &texts.collect::<Vec<_>>()).unwrap();
}

fn postures(folder: &Path) {
    const N_FRAMES: usize = 6;
    let sequence = |k: usize| Sequence {
        class: 1 + k % 17,
        group: 1 + k / 17,
    };
    let sequences: Vec<Sequence> = (0..5 * 17).map(sequence).collect();
    let frames = simulated(&sequences, N_FRAMES, (64, 32), 1200.0).mapv(|x| x as u16);
    let n = frames.nrows();
    let frames = frames.into_shape_with_order((n, 64, 32)).unwrap();
    write_npy(&folder.join("frames.npy"), &frames).unwrap();
    let category = |one: &Sequence| match one.class {
        2 | 4 | 5 | 13 => "right".to_owned(),
        3 | 6 | 7 | 14 => "left".to_owned(),
        _ => "supine".to_owned(),
    };
    let write = |name: &str, of: &dyn Fn(&Sequence) -> String| {
        texts(&folder.join(name), of, &sequences, N_FRAMES);
    };
    write("categories.npy", &category);
    write("postures.npy", &|one| format!("p{:02}", one.class));
    write("subjects.npy", &|one| format!("S{}", one.group));
    write_integers(&folder.join("touches.npy"), 0..n).unwrap();
}

fn grasps(folder: &Path) {
    const N_FRAMES: usize = 4;
    for (end, n_objects) in [("", 10), ("_test", 4)] {
        let sequence = |k: usize| Sequence {
            class: k % 2,
            group: k / 2,
        };
        let sequences: Vec<Sequence> = (0..2 * n_objects).map(sequence).collect();
        let frames = simulated(&sequences, N_FRAMES, (3, 24), 4095.0).mapv(|x| x as u16);
        let file = |name: &str| folder.join(format!("{name}{end}.npy"));
        write_npy(&file("frames"), &frames).unwrap();
        for (finger, name) in ["ff", "mf", "th"].into_iter().enumerate() {
            let electrodes = frames.slice(s![.., 24 * finger..24 * (finger + 1)]);
            write_npy(&file(name), &electrodes.to_owned()).unwrap();
        }
        let label = |one: &Sequence| ["stable", "slipped"][one.class].to_owned();
        texts(&file("labels"), label, &sequences, N_FRAMES);
        let object = |one: &Sequence| format!("object{end}_{}", one.group);
        texts(&file("objects"), object, &sequences, N_FRAMES);
        write_integers(&file("grasps"), 0..frames.nrows()).unwrap();
    }
}

fn events(folder: &Path) {
    for (end, per_class) in [("", 6), ("_test", 1)] {
        let n = 36 * per_class;
        let mut rng = Seed::new(12).named(end).rng();
        let frames = Array3::from_shape_fn((n, 25, 78), |(touch, window, channel)| {
            let rate = 0.3
                + 0.25 * ((touch % 36 + 1) as f64 * (channel as f64 + 0.1 * window as f64)).sin();
            (0..10).filter(|_| rng.gen_bool(rate)).count() as u8
        });
        write_npy(&folder.join(format!("frames{end}.npy")), &frames).unwrap();
        let labels = (0..n).map(|touch| touch % 36);
        write_integers(&folder.join(format!("labels{end}.npy")), labels).unwrap();
    }
}

/// Writes a simulated recording of the shape that the study `name` reads.
pub fn write_recording(name: &str, folder: &Path) {
    match name {
        "real_postures" | "real_readout" => postures(folder),
        "real_grasps" | "real_grasps_new_objects" => grasps(folder),
        "real_events" => events(folder),
        "real_skin" => {
            let frames = Array3::from_shape_fn((220, 28, 50), |(touch, row, column)| {
                ((touch * (row + 1) * (column + 1)) % 256) as u8
            });
            write_npy(&folder.join("frames.npy"), &frames).unwrap();
            write_integers(&folder.join("labels.npy"), (0..220).map(|touch| touch % 22)).unwrap();
        }
        other => panic!("no recording of the shape of {other}"),
    }
}

/// Row of a table: the text of each column.
type Row = BTreeMap<String, String>;

/// Runs a committed study on a simulated recording, and returns the rows of its table `accuracy.csv`.
fn rows(name: &str) -> Vec<Row> {
    let case = Case::new();
    write_recording(name, &case.create_folder("set"));
    let study = format!("{}/experiments/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    case.succeeds(&["run", &study, "--objects", "set", "--out", "out"]);
    case.rows("out/accuracy.csv")
}

/// Returns the mean accuracy of the rows with these values.
fn accuracy(rows: &[Row], wanted: &[(&str, &str)]) -> f64 {
    let is_wanted = |row: &&Row| wanted.iter().all(|(key, value)| row[*key] == *value);
    let found = rows.iter().filter(is_wanted);
    let found: Vec<f64> = found.map(|row| row["accuracy"].parse().unwrap()).collect();
    assert!(!found.is_empty(), "{wanted:?}");
    found.iter().sum::<f64>() / found.len() as f64
}

#[test]
fn postures_are_tested_with_frames_at_random_and_with_new_people() {
    let rows = rows("real_postures");
    // 2 groups × 2 labels × 3 features × 4 classifiers × 5 folds.
    assert_eq!(rows.len(), 240);
    let of = |groups| {
        let labels = ("labels", "postures.npy");
        let plain = [("classifier", "k_nearest"), ("features", "raw")];
        accuracy(&rows, &[&[("groups", groups), labels], &plain[..]].concat())
    };
    // The frames of a sequence share a pattern, which only a split by people keeps apart.
    assert_eq!(of("touches.npy"), 1.0);
    let by_people = of("subjects.npy");
    assert!(0.1 < by_people && by_people < 0.7, "{by_people}");
    let is_tested =
        |row: &&Row| row["groups"] == "subjects.npy" && row["labels"] == "categories.npy";
    let n_test = |row: &Row| row["n_test"].parse::<usize>().unwrap();
    let n: usize = rows.iter().filter(is_tested).map(n_test).sum();
    assert_eq!(n, 12 * 510);
}

#[test]
fn grasps_are_tested_at_random_by_object_and_on_the_given_objects() {
    let split = rows("real_grasps");
    // 2 groups × 4 choices of sensors × 4 classifiers × 5 folds.
    assert_eq!(split.len(), 160);
    let of = |groups| {
        let plain = [("sensor", "all"), ("classifier", "k_nearest")];
        accuracy(&split, &[&[("groups", groups)], &plain[..]].concat())
    };
    let [at_random, by_object] = ["grasps.npy", "objects.npy"].map(of);
    assert!(at_random > by_object + 0.1, "{at_random} {by_object}");
    let given = rows("real_grasps_new_objects");
    assert_eq!(given.len(), 4);
    for row in given {
        assert_eq!((&row["n_test"][..], &row["n_groups"][..]), ("32", "4"));
    }
}

#[test]
fn events_are_counted_in_windows_and_tested_on_the_given_set() {
    let rows = rows("real_events");
    assert_eq!(rows.len(), 16);
    assert!(rows.iter().all(|row| row["n_test"] == "36"));
    let stacked = ("temporal_features", "stacked_25");
    let stacked = accuracy(&rows, &[stacked, ("classifier", "linear_svm")]);
    assert!(stacked > 0.9, "{stacked}");
}
