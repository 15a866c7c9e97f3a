//! Law: test rows have no effect on anything that is fitted. If the test rows of one class are replaced by other numbers, the predictions for the test rows of
//! every other class stay the same.

use super::generator::{GeneratedStudy, Generator, n_studies};
use super::outcome::{Row, rows, run};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::{write_integers, write_npy};
use ndarray::{Array3, s};
use rand::Rng;
use std::path::Path;

const N_CLASSES: usize = 3;
const N_TOUCHES: usize = 48;
const SIDE: usize = 6;

/// Returns frames of blobs at a position of each class, shape (n, 6, 6), and the class of each frame.
fn recording(generator: &mut Generator) -> (Array3<f64>, Vec<usize>) {
    // Class by class, the order of exported rows.
    let class = |touch: usize| touch * N_CLASSES / N_TOUCHES;
    let labels: Vec<usize> = (0..N_TOUCHES).map(class).collect();
    let mut frames = Array3::zeros((N_TOUCHES, SIDE, SIDE));
    for (mut frame, label) in frames.outer_iter_mut().zip(&labels) {
        let centre = 1.0 + 1.5 * *label as f64 + generator.rng.gen_range(-1.0..1.0);
        for ((y, x), value) in frame.indexed_iter_mut() {
            let squares = (y as f64 - centre).powi(2) + (x as f64 - 2.5).powi(2);
            let noise = generator.rng.gen_range(0.0..0.05);
            *value = (0.8 * (-squares / 3.0).exp() + noise).min(1.0);
        }
    }
    (frames, labels)
}

/// Returns the study on the recording in `folder`, which replaces objects and touches. One trial has one set of test rows.
fn recorded(study: &GeneratedStudy, folder: &Path) -> GeneratedStudy {
    let path = |name: &str| folder.join(name).display().to_string();
    let mut study = study.clone();
    for table in ["objects", "touches", "skin"] {
        study.table.remove(table);
    }
    study
        .with("skin.pitch_mm", 4.0)
        .with("skin.stroke_mm", 5.0)
        .with("recorded.frames", path("frames.npy"))
        .with("recorded.labels", path("labels.npy"))
        .with("recorded.full_scale", 1.0)
        .with("recorded.zero", 0.0)
        .with("trials", 1)
}

/// Returns the rows of `confusion.csv` for all objects except `changed`.
fn answers_to_others(csv: &[u8], changed: &str) -> Vec<Row> {
    let rows = rows(csv).into_iter();
    rows.filter(|row| row["object"] != changed).collect()
}

#[test]
fn changed_test_rows_change_no_answer_to_other_rows() {
    let folder = tempfile::tempdir().unwrap();
    let mut n_changed = 0;
    let mut n_checked = 0;
    for number in 0..n_studies() {
        let mut generator = Generator::new("leaks", number);
        let (frames, labels) = recording(&mut generator);
        let write = |frames: &Array3<f64>| {
            write_npy(&folder.path().join("frames.npy"), frames).unwrap();
            write_integers(&folder.path().join("labels.npy"), labels.clone()).unwrap();
        };
        write(&frames);
        let drawn = generator.study(|study| {
            let study = recorded(study, folder.path());
            // A touch that follows another contains a trace of it, whichever of the two is a training touch.
            let remembers = study.get("signal.hysteresis_full_scale").is_some();
            let is_fused = study.get("recognition.touches_per_decision").is_some();
            !remembers && !is_fused && study.load().is_ok()
        });
        let drawn = recorded(&drawn, folder.path());
        let before_study = drawn.load().unwrap();
        let Ok(before) = run(&before_study) else {
            continue;
        };
        let before = before["confusion.csv"].clone();
        let configuration = before_study.all_cells().next().unwrap().configuration;
        let part = before_study.part_of(configuration);
        let set = part.features((configuration, 0), &Silent).unwrap();
        let mut other = frames.clone();
        let tested = set.split.test.iter();
        for &row in tested.filter(|&&row| row < N_TOUCHES && labels[row] == 0) {
            let mut frame = other.slice_mut(s![row, .., ..]);
            frame.mapv_inplace(|_| generator.rng.gen_range(0.0..1.0));
        }
        write(&other);
        let after = run(&drawn.load().unwrap()).unwrap()["confusion.csv"].clone();
        let changed = before_study.first().touched.class_names()[0].to_owned();
        let [own, others] = [&before, &after].map(|csv| answers_to_others(csv, &changed));
        assert_eq!(own, others, "{}", drawn.text());
        n_changed += u64::from(before != after);
        n_checked += 1;
    }
    // Other numbers give other answers.
    assert!(n_changed * 4 > n_checked, "{n_changed} of {n_checked}");
}
