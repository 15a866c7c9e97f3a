//! Object recognition from the measurements of a whole skin: one linear SVM per compression, trained and tested on simulated touches.

use crate::learning::classifiers::classifier::Classifier;
use crate::learning::classifiers::trained_classifier::TrainedClassifier;
use crate::sensing::Columns;
use crate::studies::prelude::*;
use crate::studies::shared_steps::{accuracy, touches_of};
use crate::studies::whole_body::drive::{Drive, Posture, built_in};
use crate::studies::whole_body::plan::*;
use crate::studies::whole_body::rows::*;
use glam::DQuat;
use ndarray::{Array2, ArrayView2, Axis};
use rand::Rng;
use rayon::prelude::*;

/// Compression (measurement matrix) with its trained classifier.
pub(super) struct Compression {
    pub columns: Columns,
    pub classifier: TrainedClassifier,
    pub score: BodyRecognition,
}

/// Draws the measurement matrix of every compression of a robot's skin. For each matrix, trains a classifier on simulated touches.
pub(super) fn learn(
    plan: &WholeBodyPlan,
    posture: &Posture,
    progress: &dyn Progress,
) -> Result<Vec<Compression>> {
    let m = plan.spec.whole_body.sensing.measurements;
    let blocks = plan.compressions.par_iter();
    let columns = blocks.map(|&(_, block)| columns(plan, posture, block));
    let columns = columns.collect::<Result<Vec<_>>>()?;
    let features = measure(plan, posture, &columns, progress)?;
    progress.stage("train", columns.len() as u64);
    let of_each = features.axis_chunks_iter(Axis(1), m);
    let named = plan.compressions.iter().zip(columns).zip(of_each);
    // Each compression is a work item; it advances the progress when it is stored.
    named
        .map(|(((name, _), columns), features)| train(plan, name, columns, features))
        .collect()
}

/// Returns a measurement matrix for the whole skin. The ensemble is SBHE with Hadamard blocks of `block` taxels, or the sparse ensemble if `block` is `None`.
fn columns(plan: &WholeBodyPlan, posture: &Posture, block: Option<usize>) -> Result<Columns> {
    let size = ImageShape::row(posture.body.n_taxels());
    let m = plan.spec.whole_body.sensing.measurements;
    let seed = Seed::new(plan.spec.seed).named("projection");
    let projection = match block {
        Some(block) => Projection::sbhe(size, m, block, &seed)?,
        None => Projection::new(Ensemble::Sparse, size, m, &seed)?,
    };
    Ok(projection.columns())
}

/// Returns the measurements of all touches with each compression, one row per touch, ordered by object. In a row, the measurements of the compressions follow
/// each other.
fn measure(
    plan: &WholeBodyPlan,
    posture: &Posture,
    columns: &[Columns],
    progress: &dyn Progress,
) -> Result<Array2<f64>> {
    let wanted = plan.recognition();
    let m = plan.spec.whole_body.sensing.measurements;
    let surface_error = MM * plan.spec.whole_body.surface_error_mm;
    let objects = wanted.objects.par_iter();
    let unions = objects.map(|name| built_in(name, surface_error));
    let unions = unions.collect::<Result<Vec<_>>>()?;
    progress.stage("touch", wanted.n_touches() as u64);
    let mut features = Array2::zeros((wanted.n_touches(), columns.len() * m));
    let rows = features.axis_iter_mut(Axis(0)).into_par_iter().enumerate();
    // Each thread keeps the state of the skin and the object for its next touch of the same object.
    rows.try_for_each_init(
        || None,
        |kept: &mut Option<(usize, Drive)>, (number, mut row)| -> Result<()> {
            let object = number / wanted.of_each();
            let (_, drive) = match kept {
                Some(of) if of.0 == object => of,
                _ => kept.insert((object, Drive::new(posture, &unions[object], &plan.aim)?)),
            };
            let (start, depth) = draw(plan, object, number % wanted.of_each());
            drive.path = drive.path.starting_at(start);
            drive.approach(plan.aim.from, depth)?;
            drive.probe(drive.path)?;
            let row = row.as_slice_mut().expect("rows are whole");
            for (columns, row) in columns.iter().zip(row.chunks_exact_mut(m)) {
                drive.state.measure(drive.body, columns, row);
            }
            progress.advance(1);
            Ok(())
        },
    )?;
    Ok(features)
}

/// Draws the random pose `link_from_object` of an object at a touch, and its travel past first contact in metres.
fn draw(plan: &WholeBodyPlan, object: usize, touch: usize) -> (Pose, f64) {
    let wanted = plan.recognition();
    let seed = Seed::new(plan.spec.seed).named("whole_body").named("touch");
    let seed = seed.named(&wanted.objects[object]);
    let mut rng = seed.numbered(touch as u64).rng();
    let mut within = |half: f64| half * (2.0 * rng.r#gen::<f64>() - 1.0);
    let (across, beside) = plan.aim.from.any_orthonormal_pair();
    let half = MM * wanted.offset_mm;
    let offset = within(half) * across + within(half) * beside;
    let turn = DQuat::from_rotation_z(within(wanted.yaw_deg.to_radians()));
    let [least, most] = wanted.depth_mm.map(|depth| MM * depth);
    let depth = 0.5 * (least + most) + within(0.5 * (most - least));
    (
        Pose::new(turn, plan.aim.motion.start.translation + offset),
        depth,
    )
}

/// Trains a classifier on the first touches of each object, and tests it on the remaining touches.
fn train(
    plan: &WholeBodyPlan,
    name: &str,
    columns: Columns,
    features: ArrayView2<f64>,
) -> Result<Compression> {
    let wanted = plan.recognition();
    let of_each = || features.axis_chunks_iter(Axis(0), wanted.of_each());
    let training = touches_of(of_each(), 0..wanted.training_touches)?;
    let test = touches_of(of_each(), wanted.training_touches..wanted.of_each())?;
    let seed = Seed::new(plan.spec.seed).named("whole_body").named("train");
    let classifier = Classifier::new(ClassifierKind::LinearSvm).train(&training, &seed)?;
    let (share, interval) = accuracy(&classifier, &test)?;
    let per_taxel = |count: usize| count as f64 / columns.n_taxels() as f64;
    Ok(Compression {
        score: BodyRecognition {
            compression: name.to_owned(),
            n_measurements: columns.n_measurements(),
            entries_per_taxel: per_taxel(columns.n_entries()),
            read_fraction: per_taxel(columns.n_read()),
            bytes_per_taxel: per_taxel(columns.n_bytes()),
            n_objects: wanted.objects.len(),
            n_training: training.targets.len(),
            n_test: test.targets.len(),
            accuracy: share,
            accuracy_low: interval.low,
            accuracy_high: interval.high,
            n_capped: classifier.n_capped(),
        },
        columns,
        classifier,
    })
}
