//! What one cell of a study learns from, as files: so that any program can train on exactly those rows.
//!
//! | file | holds |
//! |---|---|
//! | `features.npy` | n × m, f64: the measurements of every touch, before scaling |
//! | `labels.npy` | n, i64: the object's number |
//! | `train.npy` | i64: the rows that the trial trains on, in its order; a prefix is a smaller training set |
//! | `test.npy` | i64: the rows that it tests, ascending |
//! | `objects.csv` | one row an object: number, name |
//! | `cell.toml` | the settings of the cell and the trial |

use super::measurement::{Reading, measure, touch_seeds};
use super::plan::Plan;
use super::progress::Progress;
use super::runner::{describe, signal_steps};
use super::simulation::{TouchedObject, simulate_array};
use super::spec::RecognitionSpec;
use super::sweep::{Group, Sweep};
use super::table::Cell;
use crate::error::{Error, Result};
use crate::files::{write_bytes, write_whole};
use crate::random::Seed;
use crate::recognition::split::Split;
use crate::sensing::Projection;
use crate::signal::Chain;
use ndarray::{Array1, Array2, ArrayBase, Data, Dimension, s};
use ndarray_npy::{WritableElement, WriteNpyExt};
use serde::Serialize;
use std::io;
use std::path::Path;

/// Labelled measurements and the rows that one trial trains on and tests.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureSet {
    /// n_touches × m, before scaling.
    pub features: Array2<f64>,
    /// The object of every touch, by its number.
    pub labels: Array1<usize>,
    /// The trial's rows.
    pub split: Split,
}

#[derive(Serialize)]
struct ObjectRow<'a> {
    label: usize,
    object: &'a str,
}

/// `cell.toml`.
#[derive(Serialize)]
struct Settings<'a> {
    question: &'a str,
    seed: u64,
    trial: usize,
    n_train: usize,
    n_test: usize,
    cell: &'a Cell,
    recognition: &'a RecognitionSpec,
}

/// Makes the measurements of one cell in one trial: the numbers that [`run`](super::run) gives its classifier.
///
/// # Errors
/// A cell or a trial that the study does not have; what a signal step or a projection refuses.
pub fn cell_features(
    plan: &Plan,
    sweep: &Sweep,
    touched: &[TouchedObject],
    (cell, trial): (usize, usize),
    progress: &dyn Progress,
) -> Result<FeatureSet> {
    let (group, cell) = find(sweep, cell)?;
    let split = split(plan, sweep, cell, trial)?;
    let patch = &plan.arrays[group.array];
    progress.stage(
        &format!("touch {}", describe(patch)),
        sweep.labels.len() as u64,
    );
    let frames = simulate_array(touched, patch, progress);
    let seed = Seed::new(plan.spec.seed);
    // As the run does it: nested measurements are the leading ones of the largest m.
    let n_projected = group
        .projected()
        .into_iter()
        .find(|&m| group.ensemble.is_prefix_nested() || m == cell.measurements)
        .unwrap_or(cell.measurements);
    let projection = Projection::new(
        group.ensemble,
        (patch.grid.ny, patch.grid.nx),
        n_projected,
        &seed.named("projection").numbered(trial as u64),
    )?;
    let reading = Reading {
        chain: &Chain::new(&signal_steps(plan, group), patch)?,
        projection: &projection,
        taxel: patch.taxel,
        speed: plan.speed,
    };
    let seeds = touch_seeds(touched, &seed.named("signal").numbered(trial as u64));
    let measured = measure(reading, frames.deflection.view(), &seeds).values;
    Ok(FeatureSet {
        features: measured.slice(s![.., ..cell.measurements]).to_owned(),
        labels: sweep.labels.clone(),
        split,
    })
}

/// Writes the measurements of one cell in one trial into a folder that exists.
///
/// # Errors
/// As [`cell_features`]; a file that cannot be written.
pub fn write_features(
    folder: &Path,
    plan: &Plan,
    sweep: &Sweep,
    touched: &[TouchedObject],
    (cell, trial): (usize, usize),
    progress: &dyn Progress,
) -> Result<FeatureSet> {
    let set = cell_features(plan, sweep, touched, (cell, trial), progress)?;
    let Split { train, test } = &set.split;
    write_npy(&folder.join("features.npy"), &set.features)?;
    write_npy(&folder.join("labels.npy"), &whole_numbers(&set.labels))?;
    write_npy(&folder.join("train.npy"), &whole_numbers(train))?;
    write_npy(&folder.join("test.npy"), &whole_numbers(test))?;
    write_whole(&folder.join("objects.csv"), |writer| {
        let mut csv = csv::Writer::from_writer(writer);
        for (label, touched) in touched.iter().enumerate() {
            let object = touched.object.name.as_str();
            csv.serialize(ObjectRow { label, object })
                .map_err(io::Error::other)?;
        }
        csv.flush()
    })?;
    let settings = Settings {
        question: &plan.spec.question,
        seed: plan.spec.seed,
        trial,
        n_train: train.len(),
        n_test: test.len(),
        cell: find(sweep, cell)?.1,
        recognition: &plan.spec.recognition,
    };
    let text = toml::to_string(&settings).expect("every setting of a cell has a TOML form");
    write_bytes(&folder.join("cell.toml"), text.as_bytes())?;
    Ok(set)
}

/// Writes an array as a whole `.npy` file.
///
/// # Errors
/// A file that cannot be written.
pub fn write_npy<A, S, D>(path: &Path, array: &ArrayBase<S, D>) -> Result<()>
where
    A: WritableElement,
    S: Data<Elem = A>,
    D: Dimension,
{
    write_whole(path, |writer| {
        array.write_npy(writer).map_err(io::Error::other)
    })
}

fn whole_numbers<'a>(numbers: impl IntoIterator<Item = &'a usize>) -> Array1<i64> {
    numbers.into_iter().map(|&number| number as i64).collect()
}

fn find(sweep: &Sweep, number: usize) -> Result<(&Group, &Cell)> {
    sweep
        .groups
        .iter()
        .flat_map(|group| group.cells.iter().map(move |cell| (group, cell)))
        .find(|(_, cell)| cell.cell == number)
        .ok_or_else(|| {
            Error::input(
                "cell",
                number,
                format!("0 to {}, the cells of the study", sweep.n_cells() - 1),
            )
        })
}

fn split(plan: &Plan, sweep: &Sweep, cell: &Cell, trial: usize) -> Result<Split> {
    let split = sweep.splits.get(trial).ok_or_else(|| {
        let last = sweep.splits.len() - 1;
        Error::input("trial", trial, format!("0 to {last}, the study's trials"))
    })?;
    match plan.spec.recognition.train_touches {
        None => Ok(split.clone()),
        Some(_) => split.at_most(sweep.labels.view(), cell.train_touches),
    }
}
