//! Plan of a recognition study: the keys of its [`StudySpec`], checked and converted to SI units.
//!
//! The checks are in `scene.rs` (arrays, taxels, placement, human touches), `sensed.rs`, `signal.rs`, `learning.rs`, `combinations.rs` and `recorded.rs`. The checks also convert
//! millimetres, degrees and fractions into metres, radians and absolute values. Later stages use SI units only.

use crate::studies::prelude::*;
use crate::studies::recognition::plan::combinations::{OF_LEARNING, OF_TOUCHES};
use crate::studies::recognition::plan::{Condition, KeepTogether};
use crate::studies::recognition::spec::{SpreadSpec, recognition_keys};
use std::any::Any;
use std::collections::HashSet;
use std::sync::Arc;

/// Rounds a converted number to the decimal number in the study file, for example 29.999999999999996 to 30. A number that is no decimal of nine places stays
/// unchanged.
pub fn as_written(value: f64) -> f64 {
    let decimal = (value * 1e9).round() / 1e9;
    match (decimal - value).abs() <= 4.0 * f64::EPSILON * value.abs() {
        true => decimal,
        false => value,
    }
}

/// Checked study: its specification, and its values in SI units.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Specification of the study, with the keys, values and units of the study file.
    pub spec: StudySpec,
    /// Array of taxels that touches the objects.
    pub array: TaxelArray,
    /// Distribution from which the poses of touches are drawn; not used in studies of human touches.
    pub placement: Placement,
    /// Speed at which the array approaches the object when the taxels are read, m/s.
    pub speed: f64,
    /// Unit in which noise standard deviations are given.
    pub noise_unit: NoiseUnit,
    /// Numbers of frames per touch that the study compares (axis `touches.frames`).
    pub frames: Vec<usize>,
    /// Rule that forms groups of touches, which are never divided by a split; `None` if touches are not grouped.
    pub group_by: Option<KeepTogether>,
    /// Plan that contains the keys of `[test]` and gives the test touches and their signal; `None` without a table `[test]`.
    pub tested: Option<Arc<Plan>>,
}

impl Plan {
    /// Creates the plan of a study and checks all its keys.
    ///
    /// # Errors
    /// If a key is out of its range; the error names `place` (the file) and the first such key.
    pub fn new(place: &str, spec: StudySpec) -> Result<Self> {
        let mut plan = Self::with_any_keys(place, spec)?;
        Self::settle_objects(vec![&mut plan]);
        let unused = Check { place }.unused_key([&plan]);
        unused.map_or(Ok(plan), |(_, error)| Err(error))
    }

    /// Creates the plan of a study. In contrast to `new`, keys without effect are accepted.
    ///
    /// # Errors
    /// If a key is out of its range; the error names `place` (the file) and the first such key.
    pub(crate) fn with_any_keys(place: &str, mut spec: StudySpec) -> Result<Self> {
        let check = Check { place };
        check.number("trials", spec.trials as f64)?;
        check.combinations(OF_TOUCHES, &spec)?;
        if let Some(recorded) = &mut spec.recorded {
            recorded.settle_values(&spec.skin);
        }
        let array = match &spec.recorded {
            Some(recorded) => check.recorded(recorded, &spec)?,
            None => check.touching_array(&spec.skin, &spec.touches)?,
        };
        let mut seen: Vec<&dyn Any> = vec![&spec];
        seen.extend(spec.recorded.iter().map(|recorded| recorded as &dyn Any));
        seen.extend(spec.human_touch.iter().map(|human| human as &dyn Any));
        check.acting(&spec, recognition_keys(), &seen)?;
        check.human_touch(&spec, &array)?;
        let placement = match spec.places_objects() {
            false => check.placed(&TouchesSpec {
                depth_mm: SpreadSpec::One(1.0),
                ..TouchesSpec::default()
            })?,
            true => {
                check.objects(&spec.objects)?;
                check.placed(&spec.touches)?
            }
        };
        let (noise_unit, _) = check.noise(&spec.signal, spec.skin.sensed)?;
        let of_recorded = spec.recorded.as_ref().map(RecordedSpec::as_touches);
        let touches = of_recorded.transpose()?;
        let touches = touches.as_ref().unwrap_or(&spec.touches);
        check.sensor_errors(&spec.signal, touches)?;
        let speed = match &spec.recorded {
            Some(recorded) => recorded.speed_mm_per_s * MM,
            None => spec.touches.speed_mm_per_s * MM,
        };
        check.steps(&spec.signal)?;
        check.sensing(&spec.sensing, &array)?;
        let frames = match (&spec.human_touch, &spec.recorded) {
            (Some(human), _) => vec![human.n_frames()],
            (_, Some(_)) => touches.frames.values(),
            _ => spec.touches.frames.values(),
        };
        check.recognition(&spec.recognition)?;
        check.images(&spec.recognition, &array)?;
        check.over_time(&spec.recognition, &frames)?;
        check.combinations(OF_LEARNING, &spec)?;
        let mut plan = Self {
            speed,
            tested: None,
            group_by: spec.recognition.kept_together(),
            array,
            placement,
            noise_unit,
            frames,
            spec,
        };
        check.configurations(plan.n_configurations())?;
        plan.tested = check.tested(&plan)?;
        Ok(plan)
    }

    /// Sets the keys of the objects that depend on the arrays of all given variants.
    fn settle_objects(variants: Vec<&mut Self>) {
        let arrays = |array: fn(&Self) -> Option<&TaxelArray>| -> Vec<TaxelArray> {
            let arrays = variants.iter().filter_map(|plan| array(plan));
            let mut arrays: Vec<TaxelArray> = arrays.cloned().collect();
            let shape = |array: &TaxelArray| (*array.grid(), *array.taxel());
            arrays.dedup_by(|a, b| shape(a) == shape(b));
            arrays
        };
        let learned = arrays(|plan| Some(&plan.array));
        let tested = arrays(|plan| Some(&plan.tested.as_ref()?.array));
        let variants = variants.into_iter();
        for plan in variants.filter(|plan| plan.spec.places_objects()) {
            let own = &mut plan.spec.objects;
            own.settle_surface_error(&learned);
            if let Some(of_tests) = &mut plan.tested {
                let of_tests = &mut Arc::make_mut(of_tests).spec.objects;
                of_tests.model = of_tests.model.or(own.model);
                of_tests.surface_error_mm = of_tests.surface_error_mm.or(own.surface_error_mm);
                of_tests.settle_surface_error(&tested);
            }
        }
    }

    /// Removes taxels that read nothing from the array. The list has one value for each taxel, or none if all taxels read.
    pub(crate) fn without_taxels(mut self, is_absent: &[bool]) -> Self {
        if is_absent.contains(&true) {
            self.array = self.array.without(is_absent);
            let tested = self.tested.map(Arc::unwrap_or_clone);
            self.tested = tested.map(|plan| Arc::new(plan.without_taxels(is_absent)));
        }
        self
    }

    /// Returns one plan for each combination of values in the table `[axes]`, or a single plan if there are no axes. Each plan contains the specification of
    /// the whole study.
    ///
    /// # Errors
    /// If a key is out of its range for some combination; the error names the axis.
    pub fn variants(place: &str, spec: StudySpec) -> Result<Vec<(AxisValues, Self)>> {
        if spec.axes.is_empty() {
            return Ok(vec![(AxisValues::default(), Self::new(place, spec)?)]);
        }
        let check = Check { place };
        check.configurations(spec.axes.n_combinations())?;
        let (axes, columns) = (spec.axes.clone(), spec.axis_columns());
        let refused = |values: &[_], error: Error| match axes.has_own_table() {
            true => axes.refused(place, values, &error.to_string()),
            false => error,
        };
        let variants = axes.variants(place, &spec)?.into_iter();
        let plans = variants.map(|(values, study)| {
            let study = StudySpec {
                axes: axes.clone(),
                ..study
            };
            let plan = Self::with_any_keys(place, study);
            let plan = plan.map_err(|error| refused(&values, error))?;
            Ok((values, plan))
        });
        let mut plans = plans.collect::<Result<Vec<_>>>()?;
        for alike in plans.chunks_mut(axes.n_of_tables()) {
            let alike = alike.iter_mut().map(|(_, plan)| plan);
            Self::settle_objects(alike.collect());
        }
        if let Some((number, error)) = check.unused_key(plans.iter().map(|(_, plan)| plan)) {
            return Err(refused(&plans[number].0, error));
        }
        check.configurations(plans.iter().map(|(_, plan)| plan.n_configurations()).sum())?;
        let plans = plans.into_iter().enumerate();
        let plans = plans.map(|(number, (values, plan))| {
            let values = AxisValues::new(number, (&axes, &columns), &values);
            (values, plan)
        });
        Ok(plans.collect())
    }

    /// Returns an upper bound of the number of configurations. The actual number is smaller if values of m are equal, or if several values of C are given for a
    /// classifier without C.
    pub fn n_configurations(&self) -> f64 {
        self.spec.signal.n_conditions() * self.spec.n_combinations()
    }

    /// Returns the numbers m of measurements for an ensemble. On a small array, different ratios may give equal m.
    pub(crate) fn measurement_counts(&self, ensemble: Ensemble) -> Vec<usize> {
        let n_values = self.array.n_values();
        if ensemble.about().is_whole_frame {
            return vec![n_values];
        }
        let mut named = HashSet::new();
        let mut counts = self.spec.sensing.measurements_on(n_values);
        counts.retain(|&m| named.insert(m));
        counts
    }
}

impl Plan {
    /// Returns a text that describes a noise standard deviation, such as `5 % of full scale`.
    pub fn describe_noise(&self, level: f64) -> String {
        match self.noise_unit {
            NoiseUnit::FullScale => format!("{} % of full scale", (level * 1e8).round() / 1e6),
            NoiseUnit::Mm => format!("{level} mm"),
            NoiseUnit::N => format!("{level} N"),
        }
    }
}

/// Methods that assign a split t and a projection (measurement matrix) t to each trial t. With P = `projections_per_split`, trial t has split t / P and
/// projection t mod P, so that each split is combined with P projections. All other random numbers are drawn anew in each trial.
impl StudySpec {
    /// Returns the number of the split into training and test touches that is used in a trial.
    pub fn split_of(&self, trial: usize) -> usize {
        trial / self.projections_per_split.unwrap_or(1)
    }

    /// Returns the number of the projection (measurement matrix) that is used in a trial.
    pub fn projection_of(&self, trial: usize) -> usize {
        projection_of(self.projections_per_split, trial)
    }
}

/// Returns the number of the projection (measurement matrix) that is used in a trial. Without `projections_per_split`, each trial has its own projection;
/// otherwise, all splits share that many projections.
pub(crate) fn projection_of(projections_per_split: Option<usize>, trial: usize) -> usize {
    projections_per_split.map_or(trial, |n| trial % n)
}

/// Group of configurations whose results are computed from the same measurements of touches.
#[derive(Clone, Debug)]
pub struct MeasurementGroup {
    /// Number F of frames per touch.
    pub frames: usize,
    /// Condition of the signal: the strengths of noise, smoothing and sensor errors.
    pub condition: Condition,
    /// Skin on which the test touches are simulated: the training skin or another one.
    pub test_sensor: TestSensor,
    /// Ensemble from which the measurement matrix is drawn.
    pub ensemble: Ensemble,
    /// Method that selects the taxels to read; `None` if the ensemble selects no taxels.
    pub selection: Option<Selection>,
    /// Configurations of the group, ordered by family.
    pub configurations: Vec<Configuration>,
}

impl MeasurementGroup {
    /// Returns the configurations of the group, divided into families. The configurations of a family use the same rows of features. Configurations of a family
    /// differ only in the penalty C, the number of touches per decision, and the choice of the next touch. Configurations with equal C are adjacent.
    pub fn families(&self) -> impl Iterator<Item = &[Configuration]> {
        let is_same = |a: &Configuration, b: &Configuration| {
            let alike = Configuration {
                configuration: a.configuration,
                c: a.c,
                touches_per_decision: a.touches_per_decision,
                next_touch: a.next_touch,
                ..b.clone()
            };
            alike == *a
        };
        self.configurations.chunk_by(is_same)
    }

    /// Returns the number of readings of each training touch.
    pub fn n_readings(&self, plan: &Plan) -> usize {
        let asked = plan.spec.recognition.readings_per_touch.unwrap_or(1);
        if self.condition.is_random_by_reading() {
            asked
        } else {
            1
        }
    }

    /// Returns the numbers m of measurements per frame that are computed for some configurations of the group. If smaller sets of measurements are prefixes of
    /// larger ones, this is only the largest number m; otherwise every m.
    pub fn projected(&self, configurations: &[Configuration]) -> Vec<usize> {
        let mut counts: Vec<usize> = configurations.iter().map(|c| c.measurements).collect();
        counts.sort_unstable();
        counts.dedup();
        if self.ensemble.is_prefix_nested() {
            counts.drain(..counts.len() - 1);
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn study(projections_per_split: Option<usize>) -> StudySpec {
        let text = "question = \"?\"\n[skin]\npitch_mm = 2.0\nstroke_mm = 5.0\n[sensing]\n[recognition]\nclassifier = \"linear_svm\"";
        StudySpec {
            projections_per_split,
            ..StudySpec::parse("study.toml", text).unwrap()
        }
    }

    #[test]
    fn crossed_trials_meet_every_projection_with_every_split_once() {
        let crossed = study(Some(3));
        let met: BTreeSet<_> = (0..12)
            .map(|t| (crossed.split_of(t), crossed.projection_of(t)))
            .collect();
        assert_eq!(met.len(), 12);
        assert!(
            met.iter()
                .all(|&(split, projection)| split < 4 && projection < 3)
        );
        let own = study(None);
        assert_eq!((own.split_of(7), own.projection_of(7)), (7, 7));
    }
}
