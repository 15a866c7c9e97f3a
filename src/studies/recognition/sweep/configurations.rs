//! Configurations of a study, grouped by the computations that they share.
//!
//! ```text
//! variant (array and all keys with one value) × frames per touch ── touches simulated once
//!   └─ condition of the signal × test skin × ensemble (a group), and trial ── frames read and projected once, at the largest m
//!        └─ m × over time × features × classifier × training rows (a family) ── rows computed once
//!             └─ C ── fit, score test touches
//!                  └─ fused touches × choice of the next touch (a configuration) ── decide
//! ```

use crate::inputs::content_hash::{Hashed, bytes_of_counts, bytes_of_numbers};
use crate::learning::evaluation::next_touch::{NextTouch, Poses};
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{TouchSet, named_samples};
use crate::studies::recognition::plan::skin;
use crate::studies::recognition::sweep::{
    TrainingRows, draw_split, first_equal, learned_touches, train_touches,
};
use crate::studies::recognition::touches::scaled_poses;
use ndarray::Array1;
use std::sync::Arc;

/// Runs nested loops over several variables; the last variable changes fastest.
macro_rules! nested {
    ($name:pat in $values:expr; $($rest:tt)*) => {
        for $name in $values {
            $crate::studies::recognition::sweep::configurations::nested!($($rest)*)
        }
    };
    ($body:expr) => {
        $body
    };
}

pub(crate) use nested;

/// Pushes a struct for each combination of the values of some fields. The other fields are given first; the last field changes fastest.
macro_rules! push_each {
    ($all:expr, $type:ident { $($given:ident: $value:expr,)* } $($field:ident in $values:expr;)*) => {
        nested! {
            $($field in $values;)*
            $all.push($type { $($given: $value,)* $($field,)* })
        }
    };
}

/// Splits and configurations of a study, determined before the first touch is simulated.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Groups of configurations.
    pub groups: Vec<MeasurementGroup>,
    /// Split of all touches into training and test touches for each trial.
    pub splits: Vec<Hashed<Split>>,
    /// Number of the first trial with an equal split, for each trial; the trial's own number if no earlier trial has an equal split.
    pub first_equal: Vec<usize>,
    /// Number of the touched object for each touch.
    pub labels: Hashed<Array1<usize>>,
    /// Number of the group of each touch; `None` if the split may divide groups.
    pub group_keys: Option<Hashed<Array1<usize>>>,
    /// Pose of each touch; `None` if the study does not select touches by their poses.
    pub poses: Option<Hashed<Poses>>,
}

/// Part of a study: the plan, touches and configurations for one combination of axis values in `[axes]`.
pub struct StudyPart {
    /// Plan of the study for this combination of axis values.
    pub plan: Plan,
    /// Training touches of the part; parts with equal touches share them.
    pub touched: Arc<dyn TouchSet + Send>,
    /// Test touches of the part, with the numbers of the training touches. Unless the study has `[test]`, they are the training touches themselves.
    pub tested: Arc<dyn TouchSet + Send>,
    /// Splits and configurations for this combination of axis values.
    pub sweep: Sweep,
}

impl Sweep {
    /// Draws the splits of all trials and lists the configurations of a study.
    ///
    /// # Errors
    /// If there are too few objects or touches, or a sample object does not exist.
    pub fn new(plan: &Plan, touched: &dyn TouchSet) -> Result<Self> {
        let classes = touched.class_names();
        // Checked before the run, because samples are drawn at its end.
        named_samples(plan, &classes)?;
        let n_classes = classes.len();
        if n_classes < 2 {
            let (place, given, allowed) = match (&plan.spec.human_touch, &plan.spec.recorded) {
                (Some(_), _) => ("key human_touch.kinds", "kind", "kinds"),
                (_, Some(_)) => ("key recorded.labels", "class", "classes"),
                _ => ("objects", "object", "objects"),
            };
            let given = format!("{n_classes} {given}");
            let allowed = format!("at least two, since recognition tells {allowed} apart");
            return Err(Error::input(place, given, allowed));
        }
        let labels = touched.labels();
        let poses = touched.poses();
        plan.spec.recognition.split.check(&poses)?;
        let together = plan.group_by.as_ref();
        let keys = together.map(|together| touched.group_keys(together));
        let keys = keys.transpose()?.or_else(|| touched.own_groups());
        let split = |trial| {
            let sides = touched.given_sides(plan.spec.split_of(trial))?;
            draw_split(plan, &labels, (&poses[..], keys.as_ref(), sides), trial)
        };
        let splits = (0..plan.spec.trials).map(split);
        let splits = splits.collect::<Result<Vec<_>>>()?;
        let train_touches = train_touches(plan, &splits, &labels)?;
        let is_chosen = plan.spec.recognition.chosen_next().next().is_some();
        let mut sweep = Self {
            groups: Vec::new(),
            first_equal: first_equal(&splits),
            splits: splits.into_iter().map(hashed_split).collect(),
            labels: hashed_numbers(labels),
            group_keys: keys.map(hashed_numbers),
            poses: is_chosen.then(|| hashed_poses(scaled_poses(&plan.placement, &poses))),
        };
        nested! {
            frames in plan.frames.iter().copied();
            condition in plan.conditions();
            test_sensor in Axis::optional_values(&plan.spec.signal.test_sensor);
            ensemble in plan.spec.sensing.ensemble.values();
            selection in plan.spec.sensing.selections(ensemble);
            {
                let group = MeasurementGroup {
                    frames,
                    condition: condition.clone(),
                    test_sensor: test_sensor.unwrap_or_default(),
                    ensemble,
                    selection,
                    configurations: Vec::new(),
                };
                sweep.add_group(plan, group, &train_touches)?;
            }
        }
        sweep.check_training(plan)?;
        Ok(sweep)
    }

    /// Assigns the configurations to the combination `variant` of axis values in `[axes]`, and numbers them from `first`.
    pub(crate) fn place(&mut self, first: usize, variant: &AxisValues) {
        let groups = self.groups.iter_mut();
        for configuration in groups.flat_map(|group| &mut group.configurations) {
            configuration.configuration += first;
            configuration.variant.clone_from(variant);
        }
    }

    /// Returns all configurations of the sweep in the order of their numbers.
    pub fn configurations(&self) -> impl Iterator<Item = &Configuration> {
        self.groups.iter().flat_map(|group| &group.configurations)
    }

    /// Returns the number of configurations in the sweep.
    pub fn n_configurations(&self) -> usize {
        self.configurations().count()
    }

    /// Checks that a learned ensemble has enough training frames: their variations must span more directions than there are measurements.
    fn check_learned(&self, plan: &Plan, group: &MeasurementGroup) -> Result<()> {
        // The numbers of principal components are bounded; any number of taxels can be selected otherwise.
        let is_of_components = matches!(group.selection, None | Some(Selection::PivotedQr));
        let counts = group.configurations.iter().map(|c| c.measurements);
        let Some(m) = counts.max() else {
            return Ok(());
        };
        if !group.ensemble.is_learned() || group.ensemble.gives_frames() || !is_of_components {
            return Ok(());
        }
        let mut checked: Vec<TrainingRows> = Vec::new();
        for configuration in &group.configurations {
            let rows = TrainingRows::new(plan, configuration);
            if checked.contains(&rows) {
                continue;
            }
            checked.push(rows);
            let n_train = |trial| Ok(self.trial(plan, trial)?.training(&rows)?.0.train.len());
            let n_train = (0..self.splits.len()).map(n_train);
            let n_train = n_train.collect::<Result<Vec<usize>>>()?.into_iter().min();
            let n_touches = n_train.unwrap_or(0).min(learned_touches(group.frames));
            let n_frames = n_touches * group.frames;
            if m >= n_frames {
                let key = format!("key {}", plan.spec.sensing.count_key());
                let given = format!("{m} {}", group.ensemble.about().words);
                let mut allowed = format!(
                    "at most {}, one fewer than the frames of the {n_touches} training touches of configuration {}",
                    n_frames.saturating_sub(1),
                    configuration.configuration
                );
                if group.selection.is_some() {
                    allowed += "; or sensing.selection = \"greedy\" or \"random\"";
                }
                return Err(Error::input(key, given, allowed));
            }
        }
        Ok(())
    }

    fn add_group(
        &mut self,
        plan: &Plan,
        mut group: MeasurementGroup,
        train_touches: &[usize],
    ) -> Result<()> {
        let array = &plan.array;
        let ImageShape {
            ny: n_rows,
            nx: n_columns,
        } = array.shape();
        if !array.is_plain() {
            // A step that the layout does not support is detected before the run.
            let skin = skin(&Seed::new(plan.spec.seed), array);
            array.chains(&skin, |skin| group.signal(plan).steps(skin))?;
        }
        let learned = &plan.spec.recognition;
        let penalties = |classifier: ClassifierKind| match classifier.has_c() {
            true => learned.penalties(),
            false => vec![None],
        };
        // The last group gives the number of configurations; counting all of them would take quadratic time.
        let last = self
            .groups
            .last()
            .and_then(|group| group.configurations.last());
        let first = last.map_or(0, |configuration| configuration.configuration + 1);
        push_each! {
            group.configurations, Configuration {
                configuration: first + group.configurations.len(),
                pitch_mm: millimetres(array.pitch()),
                nx: n_columns,
                ny: n_rows,
                frame_values: array.n_values(),
                image_shapes: array.image_shapes(),
                size_mm: millimetres(array.pitch() * array.grid().nx as f64),
                noise_std: group.condition.noise,
                noise_unit: plan.noise_unit,
                smoothing_mm: millimetres(group.condition.smoothing),
                strengths: group.condition.strengths.clone(),
                test_sensor: plan.spec.signal.test_sensor.as_ref().map(|_| group.test_sensor),
                ensemble: group.ensemble,
                selection: plan.spec.sensing.selection.as_ref().map(|_| group.selection),
                ratio: array.n_values() as f64 / measurements as f64,
                readout_ms: plan.spec.sensing.readings_per_s.map(|rate| 1e3 * measurements as f64 / rate),
                frames: group.frames,
                variant: AxisValues::default(),
            }
            measurements in plan.measurement_counts(group.ensemble);
            temporal_features in Axis::optional_values(&learned.temporal_features);
            features in learned.all_features();
            depth_window_full_scale in Axis::active_values(&learned.depth_window_full_scale, features.of_image().is_some(), 1.0);
            tilt_augmentation in Axis::active_values(&learned.tilt_augmentation, features.of_image().is_some(), 0);
            classifier in learned.kinds();
            train_touches in train_touches.iter().copied();
            class_imbalance in Axis::optional_values(&learned.class_imbalance);
            mislabelled_fraction in Axis::optional_values(&learned.mislabelled_fraction);
            c in penalties(classifier);
            touches_per_decision in learned.touches_per_decision.values();
            next_touch in Axis::active_values(&learned.next_touch, touches_per_decision > 1, NextTouch::Random);
        }
        // With many small groups, unused capacity would take most of the memory.
        group.configurations.shrink_to_fit();
        self.check_learned(plan, &group)?;
        self.groups.push(group);
        Ok(())
    }
}

fn hashed_split(split: Split) -> Hashed<Split> {
    Hashed::new(split, |split| {
        let sides = [&split.train, &split.test];
        sides.map(|rows| bytes_of_counts(rows.iter())).concat()
    })
}

fn hashed_numbers(numbers: Array1<usize>) -> Hashed<Array1<usize>> {
    Hashed::new(numbers, |numbers| bytes_of_counts(numbers.iter()))
}

fn hashed_poses(poses: Poses) -> Hashed<Poses> {
    Hashed::new(poses, |poses| {
        let turns = format!("{:?} {:?}", poses.turns, poses.coordinates.dim());
        let coordinates = bytes_of_numbers(poses.coordinates.iter().copied());
        [turns.into_bytes(), coordinates].concat()
    })
}
