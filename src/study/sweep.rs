//! The cells of a study, grouped by what they can share.
//!
//! ```text
//! array × frames a touch ── touches simulated once
//!   └─ noise × smoothing × ensemble (a group), and trial ── frames read and projected once, at the largest m
//!        └─ m × features × classifier × training touches (a family) ── rows made once
//!             └─ C ── fit, score test touches
//!                  └─ fused touches (a cell) ── decide
//! ```

use super::plan::{Plan, SplitKind, millimetres};
use super::published::check_published;
use super::simulation::TouchedObject;
use super::spec::GroupSpec;
use super::table::Cell;
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::recognition::split::{
    Split, group_hold_out, group_k_fold, stratified_hold_out, stratified_k_fold,
};
use crate::sensing::Ensemble;
use crate::world::{Patch, TouchAxis};
use ndarray::Array1;
use std::collections::BTreeMap;

/// Everything that is decided before the first touch is simulated.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Groups, array by array.
    pub groups: Vec<Group>,
    /// One split a trial, of all touches.
    pub splits: Vec<Split>,
    /// The object of every touch, by its number.
    pub labels: Array1<usize>,
    /// The group of every touch, when the study keeps groups together.
    pub group_keys: Option<Array1<usize>>,
}

/// Cells that are read from the same measurements.
#[derive(Clone, Debug)]
pub struct Group {
    /// Index into the plan's arrays.
    pub array: usize,
    /// Frames a touch.
    pub frames: usize,
    /// Noise standard deviation, in the plan's unit.
    pub noise: f64,
    /// Standard deviation of the smoothing, metres.
    pub smoothing: f64,
    /// How measurements are made.
    pub ensemble: Ensemble,
    /// Its cells, family by family.
    pub cells: Vec<Cell>,
}

impl Group {
    /// Its cells by family. The cells of a family learn from the same rows of the same features: they differ only in C
    /// and in how many touches are fused, those with the same C following each other.
    pub fn families(&self) -> impl Iterator<Item = &[Cell]> {
        let family = |cell: &Cell| {
            let (m, kind) = (cell.measurements, cell.classifier);
            (m, cell.features, kind, cell.train_touches)
        };
        self.cells.chunk_by(move |a, b| family(a) == family(b))
    }

    /// The measurements that serve every cell: of the largest m if smaller ones are its prefixes, else one set per m.
    pub fn projected(&self) -> Vec<usize> {
        let mut counts: Vec<usize> = self.cells.iter().map(|c| c.measurements).collect();
        counts.sort_unstable();
        counts.dedup();
        if self.ensemble.is_prefix_nested() {
            counts.drain(..counts.len() - 1);
        }
        counts
    }
}

impl Sweep {
    /// Lays out splits and cells; the error says which objects or touches are too few.
    pub fn new(plan: &Plan, touched: &[TouchedObject]) -> Result<Self> {
        if touched.len() < 2 {
            return Err(Error::input(
                "objects",
                format!("{} object", touched.len()),
                "at least two, since recognition tells objects apart",
            ));
        }
        let labels = touched
            .iter()
            .enumerate()
            .flat_map(|(label, t)| std::iter::repeat_n(label, t.touches.len()))
            .collect();
        let keys = plan
            .split
            .keep_together
            .map(|kind| group_keys(touched, kind))
            .transpose()?;
        let splits = (0..plan.spec.trials)
            .map(|trial| split(plan, &labels, keys.as_ref(), trial))
            .collect::<Result<Vec<_>>>()?;
        let train_touches = train_touches(plan, &splits, &labels)?;
        check_fused_touches(plan, &splits, &labels)?;
        check_folds(plan, &train_touches)?;
        let mut sweep = Self {
            groups: Vec::new(),
            splits,
            labels,
            group_keys: keys,
        };
        for array in 0..plan.arrays.len() {
            for &frames in &plan.frames {
                sweep.add_groups(plan, (array, frames), &train_touches);
            }
        }
        let cells: Vec<&Cell> = sweep.cells().collect();
        check_published(&plan.spec.report.published, &cells)?;
        Ok(sweep)
    }

    fn add_groups(&mut self, plan: &Plan, (array, frames): (usize, usize), train: &[usize]) {
        for &noise in &plan.noise {
            for &smoothing in &plan.smoothing {
                for &ensemble in &plan.ensembles {
                    let group = Group {
                        array,
                        frames,
                        noise,
                        smoothing,
                        ensemble,
                        cells: Vec::new(),
                    };
                    self.add_group(plan, group, train);
                }
            }
        }
    }

    /// All cells, in their order.
    pub fn cells(&self) -> impl Iterator<Item = &Cell> {
        self.groups.iter().flat_map(|group| &group.cells)
    }

    /// How many cells.
    pub fn n_cells(&self) -> usize {
        self.groups.iter().map(|group| group.cells.len()).sum()
    }

    fn add_group(&mut self, plan: &Plan, mut group: Group, train_touches: &[usize]) {
        let patch = &plan.arrays[group.array];
        let first = self.n_cells();
        for measurements in measurement_counts(plan, patch, group.ensemble) {
            for &features in &plan.features {
                for &classifier in &plan.classifiers {
                    for &train_touches in train_touches {
                        let family = Cell {
                            features,
                            classifier,
                            train_touches,
                            ..group_cell(plan, &group, measurements)
                        };
                        group.cells.extend(family_cells(plan, &family));
                    }
                }
            }
        }
        for (number, cell) in group.cells.iter_mut().enumerate() {
            cell.cell = first + number;
        }
        self.groups.push(group);
    }
}

/// The m axis on an array; a ratio axis can name the same m twice on a small one.
fn measurement_counts(plan: &Plan, patch: &Patch, ensemble: Ensemble) -> Vec<usize> {
    let n_taxels = patch.grid.n_taxels();
    if ensemble == Ensemble::Identity {
        return vec![n_taxels];
    }
    let mut counts = Vec::new();
    for amount in &plan.amounts {
        let m = amount.measurements(n_taxels);
        if !counts.contains(&m) {
            counts.push(m);
        }
    }
    counts
}

/// The cells of a family: every C that its classifier has a use for, with every number of fused touches.
fn family_cells(plan: &Plan, family: &Cell) -> Vec<Cell> {
    let penalties = match family.classifier.has_c() {
        true => &plan.penalties[..],
        false => &[None],
    };
    let of_penalty = |&c: &Option<f64>| {
        plan.fused_touches.iter().map(move |&fused_touches| Cell {
            c,
            fused_touches,
            ..family.clone()
        })
    };
    penalties.iter().flat_map(of_penalty).collect()
}

/// A cell of a group, with m and with the first value of each axis that the group leaves open.
fn group_cell(plan: &Plan, group: &Group, measurements: usize) -> Cell {
    let grid = &plan.arrays[group.array].grid;
    Cell {
        cell: 0,
        pitch_mm: millimetres(grid.pitch),
        nx: grid.nx,
        ny: grid.ny,
        size_mm: millimetres(grid.pitch * grid.nx as f64),
        noise_std: group.noise,
        noise_unit: plan.noise_unit,
        smoothing_mm: millimetres(group.smoothing),
        ensemble: group.ensemble,
        measurements,
        ratio: grid.n_taxels() as f64 / measurements as f64,
        frames: group.frames,
        features: plan.features[0],
        classifier: plan.classifiers[0],
        c: None,
        train_touches: 0,
        fused_touches: plan.fused_touches[0],
    }
}

fn split(
    plan: &Plan,
    labels: &Array1<usize>,
    keys: Option<&Array1<usize>>,
    trial: usize,
) -> Result<Split> {
    let seed = Seed::new(plan.spec.seed).named("split");
    match plan.split.kind {
        SplitKind::HoldOut(fraction) => {
            let seed = seed.numbered(trial as u64);
            match keys {
                None => stratified_hold_out(labels.view(), fraction, &seed),
                Some(keys) => group_hold_out(labels.view(), keys.view(), fraction, &seed),
            }
        }
        SplitKind::Folds(k) => {
            let seed = seed.numbered((trial / k) as u64);
            let mut folds = match keys {
                None => stratified_k_fold(labels.view(), k, &seed)?,
                Some(keys) => group_k_fold(labels.view(), keys.view(), k, &seed)?,
            };
            Ok(folds.swap_remove(trial % k))
        }
    }
}

/// The training-touches axis: what is asked for, or all that the smallest training split has for every object.
fn train_touches(plan: &Plan, splits: &[Split], labels: &Array1<usize>) -> Result<Vec<usize>> {
    let n_objects = labels.iter().max().map_or(0, |last| last + 1);
    let fewest = splits
        .iter()
        .map(|split| fewest_per_object(&split.train, labels, n_objects))
        .min()
        .unwrap_or(0);
    plan.train_touches
        .iter()
        .map(|asked| match *asked {
            None => Ok(fewest),
            Some(count) if count <= fewest => Ok(count),
            Some(count) => Err(Error::input(
                "key recognition.train_touches",
                count,
                format!("at most {fewest}, the training touches of every object in every trial"),
            )),
        })
        .collect()
}

/// Every object has test touches for at least one group in every trial.
fn check_fused_touches(plan: &Plan, splits: &[Split], labels: &Array1<usize>) -> Result<()> {
    let n_objects = labels.iter().max().map_or(0, |last| last + 1);
    let fewest = splits
        .iter()
        .map(|split| fewest_per_object(&split.test, labels, n_objects))
        .min()
        .unwrap_or(0);
    match plan.fused_touches.iter().find(|&&k| k > fewest) {
        None => Ok(()),
        Some(k) => Err(Error::input(
            "key recognition.fused_touches",
            k,
            format!("at most {fewest}, the test touches of every object in every trial"),
        )),
    }
}

/// Where C or γ is chosen, every object has a training touch for each fold.
fn check_folds(plan: &Plan, train_touches: &[usize]) -> Result<()> {
    let choice = &plan.choice;
    let fewest = train_touches.iter().min().copied().unwrap_or(0);
    let fewest = choice.touches.map_or(fewest, |most| fewest.min(most));
    let is_open = !(choice.c.is_empty() && choice.gamma_multiples.is_empty());
    if is_open && choice.folds > fewest {
        return Err(Error::input(
            "key recognition.choose_folds",
            choice.folds,
            format!("at most {fewest}, the training touches of every object that take part"),
        ));
    }
    Ok(())
}

fn fewest_per_object(rows: &[usize], labels: &Array1<usize>, n_objects: usize) -> usize {
    let mut counts = vec![0; n_objects];
    for &row in rows {
        counts[labels[row]] += 1;
    }
    counts.into_iter().min().unwrap_or(0)
}

/// One group number a touch: touches with the same values on the grouping axes share it, whatever their object.
fn group_keys(touched: &[TouchedObject], kind: GroupSpec) -> Result<Array1<usize>> {
    use TouchAxis::{Depth, OffsetX, OffsetY, Rest, TiltX, TiltY, Yaw};
    let axes: &[TouchAxis] = match kind {
        GroupSpec::Pose => &[Rest, OffsetX, OffsetY, Yaw, TiltX, TiltY],
        GroupSpec::Offset => &[OffsetX, OffsetY],
        GroupSpec::Yaw => &[Yaw],
        GroupSpec::Tilt => &[TiltX, TiltY],
        GroupSpec::Rest => &[Rest],
        GroupSpec::Depth => &[Depth],
    };
    let mut numbers = BTreeMap::new();
    touched
        .iter()
        .flat_map(|t| &t.touches)
        .map(|touch| {
            let next = numbers.len();
            Ok(*numbers.entry(touch.group(axes)?).or_insert(next))
        })
        .collect()
}
