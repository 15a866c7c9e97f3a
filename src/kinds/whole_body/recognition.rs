//! Which object is it? A linear SVM for each compression, learned from simulated touches and tested on others.

use super::drive::{Drive, PosedBody};
use super::objects::built_in;
use super::path::Path;
use super::plan::WholeBodyPlan;
use super::rows::BodyRecognition;
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::SphereUnion;
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::classifier::{Classifier, TrainedClassifier};
use crate::recognition::dataset::{Dataset, dataset};
use crate::recognition::interval::Interval;
use crate::sensing::{Columns, Ensemble, Projection};
use crate::study::progress::Progress;
use crate::study::{CONFIDENCE, MM};
use glam::{DQuat, DVec3};
use ndarray::{Array1, Array2, Axis, concatenate};
use rand::Rng;
use rayon::prelude::*;
use std::ops::Range;

/// Touches simulated by one thread at a time: each block has a state of the body of its own.
const BLOCK: usize = 16;

/// A compression and what has learned from it.
pub(super) struct Compression {
    pub columns: Columns,
    pub classifier: TrainedClassifier,
    pub score: BodyRecognition,
}

/// Draws every compression of a body, and learns from touches of it.
pub(super) fn learn(
    plan: &WholeBodyPlan,
    posed: &PosedBody,
    world_from_links: &[Pose],
    progress: &dyn Progress,
) -> Result<Vec<Compression>> {
    let wanted = plan.recognition();
    let columns = plan
        .compressions
        .par_iter()
        .map(|&compression| columns(plan, posed, compression))
        .collect::<Result<Vec<_>>>()?;
    let unions = wanted
        .objects
        .par_iter()
        .map(|name| built_in(name, plan.surface_error))
        .collect::<Result<Vec<_>>>()?;
    let n_touches = wanted.training_touches + wanted.test_touches;
    progress.stage("touch", (unions.len() * n_touches) as u64);
    let touches = Touches {
        plan,
        posed,
        world_from_link: world_from_links[plan.aim.link],
        columns: &columns,
        seed: Seed::new(plan.spec.seed).named("whole_body").named("touch"),
    };
    let blocks: Vec<(usize, Range<usize>)> = (0..unions.len())
        .flat_map(|object| {
            let starts = (0..n_touches).step_by(BLOCK);
            starts.map(move |start| (object, start..(start + BLOCK).min(n_touches)))
        })
        .collect();
    let rows = blocks
        .into_par_iter()
        .map(|(object, numbers)| {
            let n = numbers.len() as u64;
            let rows = touches.measure(object, &unions[object], numbers);
            progress.advance(n);
            rows
        })
        .collect::<Result<Vec<_>>>()?;
    progress.stage("train", columns.len() as u64);
    let n_objects = unions.len();
    let mut compressions = Vec::new();
    for (number, (columns, &(ensemble, block))) in
        columns.into_iter().zip(&plan.compressions).enumerate()
    {
        let of_this: Vec<_> = rows.iter().map(|blocks| blocks[number].view()).collect();
        let features = concatenate(Axis(0), &of_this).expect("every block has m columns");
        let name = name_of(ensemble, block);
        // Each is a piece of its own, which advances once it is kept.
        compressions.push(train(plan, name, columns, &features, n_objects)?);
    }
    Ok(compressions)
}

/// `sbhe_32`, `sparse`.
pub(super) fn name_of(ensemble: Ensemble, block: Option<usize>) -> String {
    match (ensemble, block) {
        (Ensemble::Sbhe, Some(block)) => format!("sbhe_{block}"),
        _ => "sparse".to_owned(),
    }
}

fn columns(
    plan: &WholeBodyPlan,
    posed: &PosedBody,
    (ensemble, block): (Ensemble, Option<usize>),
) -> Result<Columns> {
    let size = (posed.body.n_taxels(), 1);
    let m = plan.spec.whole_body.sensing.measurements;
    let seed = Seed::new(plan.spec.seed).named("projection");
    let projection = match block {
        Some(block) => Projection::sbhe(size, m, block, &seed)?,
        None => Projection::new(ensemble, size, m, &seed)?,
    };
    Ok(projection.columns())
}

/// How objects touch, and how that is measured.
struct Touches<'a> {
    plan: &'a WholeBodyPlan,
    posed: &'a PosedBody<'a>,
    world_from_link: Pose,
    columns: &'a [Columns],
    seed: Seed,
}

impl Touches<'_> {
    /// Of each compression the measurements of some touches of an object, a row each.
    fn measure(
        &self,
        object: usize,
        union: &SphereUnion,
        numbers: Range<usize>,
    ) -> Result<Vec<Array2<f64>>> {
        let shape = |columns: &Columns| (numbers.len(), columns.n_measurements());
        let mut rows: Vec<_> = self
            .columns
            .iter()
            .map(|columns| Array2::zeros(shape(columns)))
            .collect();
        let mut drive = Drive::new(self.posed, union, self.path(Pose::IDENTITY));
        for (row, number) in numbers.enumerate() {
            let (start, depth) = self.draw(object, number);
            drive.path = self.path(start);
            drive.approach(self.plan.aim.from, depth)?;
            let path = drive.path;
            drive.probe(&path);
            for (columns, rows) in self.columns.iter().zip(&mut rows) {
                let mut row = rows.row_mut(row);
                let row = row.as_slice_mut().expect("rows are whole");
                columns.measure_touched(drive.touched(), row);
            }
        }
        Ok(rows)
    }

    /// Where an object aims at a touch (`link_from_object`), and how far it goes past first contact, metres.
    fn draw(&self, object: usize, number: usize) -> (Pose, f64) {
        let wanted = self.plan.recognition();
        let seed = self.seed.named(&wanted.objects[object]);
        let mut rng = seed.numbered(number as u64).rng();
        let mut within = |half: f64| half * (2.0 * rng.r#gen::<f64>() - 1.0);
        let (across, beside) = self.plan.aim.from.any_orthonormal_pair();
        let half = MM * wanted.offset_mm;
        let offset = within(half) * across + within(half) * beside;
        let turn = DQuat::from_rotation_z(within(wanted.yaw_deg.to_radians()));
        let [least, most] = wanted.depth_mm.map(|depth| MM * depth);
        let depth = 0.5 * (least + most) + within(0.5 * (most - least));
        (Pose::new(turn, self.plan.aim.at + offset), depth)
    }

    fn path(&self, start: Pose) -> Path {
        Path {
            world_from_link: self.world_from_link,
            start,
            moves: DVec3::ZERO,
            swing: 0.0,
            period: 1.0,
        }
    }
}

/// Trains on the first touches of each object and tests on the others.
fn train(
    plan: &WholeBodyPlan,
    name: String,
    columns: Columns,
    features: &Array2<f64>,
    n_objects: usize,
) -> Result<Compression> {
    let n_training = plan.recognition().training_touches;
    let n_test = plan.recognition().test_touches;
    let n_touches = n_training + n_test;
    let part = |range: Range<usize>| -> Result<Dataset> {
        let rows = |object: usize| range.clone().map(move |touch| object * n_touches + touch);
        let numbers: Vec<usize> = (0..n_objects).flat_map(rows).collect();
        let labels: Array1<usize> = numbers.iter().map(|number| number / n_touches).collect();
        dataset(features.select(Axis(0), &numbers), labels)
    };
    let seed = Seed::new(plan.spec.seed).named("whole_body").named("train");
    let training = part(0..n_training)?;
    let classifier = Classifier::new(ClassifierKind::LinearSvm).train(&training, &seed)?;
    let test = part(n_training..n_touches)?;
    let predicted = classifier.labels(test.records.view())?;
    let answers = predicted.iter().zip(&test.targets);
    let n_right = answers.filter(|(label, truth)| label == truth).count();
    let n_tested = test.targets.len();
    let interval = Interval::wilson(n_right, n_tested, CONFIDENCE)?;
    let per_taxel = |count: usize| count as f64 / columns.n_taxels() as f64;
    Ok(Compression {
        score: BodyRecognition {
            compression: name,
            n_measurements: columns.n_measurements(),
            entries_per_taxel: per_taxel(columns.n_entries()),
            read_share: per_taxel(columns.n_read()),
            bytes_per_taxel: per_taxel(columns.n_bytes()),
            n_objects,
            n_training: training.targets.len(),
            n_test: n_tested,
            accuracy: n_right as f64 / n_tested as f64,
            accuracy_low: interval.low,
            accuracy_high: interval.high,
            n_capped: classifier.n_capped(),
        },
        columns,
        classifier,
    })
}
