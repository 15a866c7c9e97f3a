//! A study that can run: every key of its [`StudySpec`] checked, every unit SI.
//!
//! This is the only place where millimetres, degrees and fractions become metres, radians and absolute values.

use super::axes::{AxisValues, Variant};
use super::check::Check;
use super::plan_human::{HumanTouchPlan, no_placement};
use super::pose_groups::KeepTogether;
use super::repeats::Repeats;
use super::sensor_errors::TestedOn;
use super::spec::{CombineSpec, StepSpec, StudySpec};
use super::training::ChoicePlan;
use crate::error::Result;
use crate::recognition::ClassifierKind;
use crate::recognition::features::Features;
use crate::recognition::over_time::OverTime;
use crate::sensing::Ensemble;
use crate::signal::{NoiseUnit, Strength};
use crate::world::{Patch, Placement};
use std::collections::HashSet;

/// Metres in a millimetre.
pub(crate) const MM: f64 = 1e-3;

/// Trials of a study, at most: each has its split in memory before the first runs.
pub(crate) const MOST_TRIALS: usize = 100_000;
/// Frames a touch, at most: more is a rate or a number in the wrong unit.
pub(super) const MOST_FRAMES: usize = 10_000;

/// Millimetres as people write them: 2, not 2.0000000000000004.
pub fn millimetres(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e6
}

/// Axes and settings of a study, ready to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// As it was written; recognition and object keys are used as they are.
    pub spec: StudySpec,
    /// One patch per value of the resolution axis and the size axis.
    pub arrays: Vec<Patch>,
    /// How touches are drawn; of nothing in a study of human touches.
    pub placement: Placement,
    /// Human touches in place of objects.
    pub human_touch: Option<HumanTouchPlan>,
    /// Approach speed at the moment of reading, m/s.
    pub speed: f64,
    /// Steps of the signal, in order.
    pub steps: Vec<StepSpec>,
    /// What the noise axis is measured in.
    pub noise_unit: NoiseUnit,
    /// The noise axis, in `noise_unit`.
    pub noise: Vec<f64>,
    /// The smoothing axis, metres.
    pub smoothing: Vec<f64>,
    /// The axes of the strengths of sensor errors, in the units of their keys.
    pub sensor_errors: Vec<(&'static Strength, Vec<f64>)>,
    /// How the axes of the signal are combined.
    pub combine: CombineSpec,
    /// The axis of skins that test touches are made with.
    pub tested_on: Vec<TestedOn>,
    /// The ensemble axis.
    pub ensembles: Vec<Ensemble>,
    /// The axis of measurements.
    pub amounts: Vec<Amount>,
    /// The axis of frames a touch.
    pub frames: Vec<usize>,
    /// The axis of what is made of the frames of a touch; `None` is all of them.
    pub over_time: Vec<Option<OverTime>>,
    /// The axis of features.
    pub features: Vec<Features>,
    /// The axis of classifiers.
    pub classifiers: Vec<ClassifierKind>,
    /// The C axis, for classifiers that have one; `None` is a C chosen by cross-validation.
    pub penalties: Vec<Option<f64>>,
    /// The axis of training touches an object; `None` is all of them.
    pub train_touches: Vec<Option<usize>>,
    /// The axis of training touches with another object's label, as a fraction; `None` without the key.
    pub mislabelled: Vec<Option<f64>>,
    /// The axis of class imbalance; `None` without the key.
    pub class_imbalance: Vec<Option<f64>>,
    /// The axis of test touches that are decided on together.
    pub fused_touches: Vec<usize>,
    /// How C and γ are chosen where they are.
    pub choice: ChoicePlan,
    /// How touches are split.
    pub split: SplitPlan,
    /// What trials draw anew.
    pub repeats: Repeats,
}

/// How many measurements: absolute, or as a fraction of the taxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// n / m.
    Ratio(f64),
    /// m.
    Measurements(usize),
}

/// How touches are split into training and test rows, trial by trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitPlan {
    /// Hold-out or folds.
    pub kind: SplitKind,
    /// What stays together.
    pub keep_together: Option<KeepTogether>,
}

/// The kind of a split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SplitKind {
    /// This fraction is for testing, drawn anew each trial.
    HoldOut(f64),
    /// Trial t tests fold t mod k of division t / k.
    Folds(usize),
}

impl Amount {
    /// m on an array of `n_taxels`, at least 1.
    pub fn measurements(&self, n_taxels: usize) -> usize {
        match *self {
            Self::Measurements(m) => m,
            Self::Ratio(ratio) => ((n_taxels as f64 / ratio).round() as usize).max(1),
        }
    }
}

impl Plan {
    /// Checks a study; the error names `place` (the file) and the first key that is out of its range.
    pub fn new(place: &str, mut spec: StudySpec) -> Result<Self> {
        let check = Check { place };
        check.count("trials", spec.trials, MOST_TRIALS)?;
        if spec.human_touch.is_none() {
            check.objects(&spec.objects)?;
        }
        let arrays = check.arrays(&spec.skin)?;
        let human_touch = check.human_touch(&spec, &arrays)?;
        let placement = match human_touch {
            Some(_) => no_placement(),
            None => {
                spec.objects.settle_surface_error(&arrays);
                check.placement(&spec.touches)?
            }
        };
        let (noise_unit, noise) = check.noise(&spec.signal)?;
        let smoothing = check.smoothing(&spec.signal)?;
        let sensor_errors = check.sensor_errors(&spec.signal, &spec.touches)?;
        check.steps(&spec.signal)?;
        let tested_on = check.tested_on(&spec.signal)?;
        let ensembles = check.list("sensing.ensemble", spec.sensing.ensemble.values())?;
        let amounts = check.amounts(&spec.sensing, &arrays)?;
        let frames = match &human_touch {
            Some(human) => vec![human.n_frames],
            None => check.counts("touches.frames", &spec.touches.frames)?,
        };
        for &count in &frames {
            check.count("touches.frames", count, MOST_FRAMES)?;
        }
        let over_time = check.over_time(&spec.recognition, &frames)?;
        check.kinds(&spec)?;
        let features = check.list("recognition.features", spec.recognition.features.values())?;
        let classifiers = check.list(
            "recognition.classifier",
            spec.recognition.classifier.values(),
        )?;
        let penalties = check.penalties(&spec)?;
        let choice = check.choice(&spec)?;
        let fused_touches =
            check.counts("recognition.fused_touches", &spec.recognition.fused_touches)?;
        let train_touches = check.train_touches(&spec)?;
        let mislabelled = check.mislabelled(&spec)?;
        let class_imbalance = check.class_imbalance(&spec)?;
        let split = check.split(&spec)?;
        let repeats = check.repeats(&spec)?;
        let speed = check.speed(&spec.touches)?;
        let plan = Self {
            arrays,
            placement,
            human_touch,
            speed,
            steps: spec.signal.steps.clone(),
            noise_unit,
            noise,
            smoothing,
            sensor_errors,
            combine: spec.signal.combine,
            tested_on,
            ensembles,
            amounts,
            frames,
            over_time,
            features,
            classifiers,
            penalties,
            train_touches,
            mislabelled,
            class_imbalance,
            fused_touches,
            choice,
            split,
            repeats,
            spec,
        };
        check.configurations(plan.n_cells())?;
        Ok(plan)
    }

    /// A plan for each combination of a study's own axes, the first alone where it has none; each says the whole study.
    ///
    /// # Errors
    /// Those of [`Plan::new`], which name the axis.
    pub fn variants(place: &str, spec: StudySpec) -> Result<Vec<(AxisValues, Self)>> {
        if spec.axes.is_empty() {
            return Ok(vec![(AxisValues::default(), Self::new(place, spec)?)]);
        }
        let check = Check { place };
        check.configurations(spec.axes.n_combinations())?;
        let (axes, columns) = (spec.axes.clone(), spec.axis_columns());
        let variants = axes.variants(place, &spec)?.into_iter().enumerate();
        let plans = variants.map(|(number, Variant { values, study })| {
            let study = StudySpec {
                axes: axes.clone(),
                ..study
            };
            let plan = Self::new(place, study);
            let plan = plan.map_err(|error| axes.refused(place, &values, &error.to_string()))?;
            Ok((axes.point(&columns, (number, &values)), plan))
        });
        let plans = plans.collect::<Result<Vec<_>>>()?;
        check.configurations(plans.iter().map(|(_, plan)| plan.n_cells()).sum())?;
        Ok(plans)
    }

    /// How many cells the study has, counted without laying any out.
    pub fn n_cells(&self) -> f64 {
        let product = |lengths: &[usize]| lengths.iter().map(|&n| n as f64).product::<f64>();
        let conditions = self.n_conditions() * self.tested_on.len() as f64;
        let sensed = self.n_sensed();
        let penalties = |kind: &ClassifierKind| match kind.has_c() {
            true => self.penalties.len(),
            false => 1,
        };
        let fits: usize = self.classifiers.iter().map(penalties).sum();
        let others = product(&[
            self.frames.len(),
            self.over_time.len(),
            self.features.len(),
            self.train_touches.len(),
            self.class_imbalance.len(),
            self.mislabelled.len(),
            self.fused_touches.len(),
        ]);
        conditions * sensed * fits as f64 * others
    }

    /// Arrays × ensembles × m; of more than a million, also those are counted that name the same m twice.
    fn n_sensed(&self) -> f64 {
        let lengths = [self.arrays.len(), self.ensembles.len(), self.amounts.len()];
        let most: f64 = lengths.iter().map(|&n| n as f64).product();
        if most > 1e6 {
            return most;
        }
        let on_array = |patch: &Patch| -> usize {
            let counts = self.ensembles.iter();
            counts
                .map(|&ensemble| self.measurement_counts(patch, ensemble).len())
                .sum()
        };
        self.arrays.iter().map(on_array).sum::<usize>() as f64
    }

    /// The m axis on an array; a ratio axis can name the same m twice on a small one.
    pub(super) fn measurement_counts(&self, patch: &Patch, ensemble: Ensemble) -> Vec<usize> {
        let n_taxels = patch.grid.n_taxels();
        if ensemble.about().is_whole_frame {
            return vec![n_taxels];
        }
        let mut named = HashSet::new();
        let counts = self
            .amounts
            .iter()
            .map(|amount| amount.measurements(n_taxels));
        counts.filter(|&m| named.insert(m)).collect()
    }
}

impl Plan {
    /// A noise level in words: `5 % of full scale`.
    pub fn describe_noise(&self, level: f64) -> String {
        match self.noise_unit {
            NoiseUnit::FullScale => format!("{} % of full scale", (level * 1e8).round() / 1e6),
            NoiseUnit::Mm => format!("{level} mm"),
            NoiseUnit::N => format!("{level} N"),
        }
    }
}
