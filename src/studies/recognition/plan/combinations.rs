//! Combinations of keys that a recognition study refuses.

use crate::signal::SensorError;
use crate::studies::prelude::*;
use crate::world::RestPoses;

/// Combination of keys that a study refuses.
pub(crate) struct Refusal {
    key: &'static str,
    /// Function that returns what is given and what is allowed, if the study has the combination.
    refused: fn(&StudySpec) -> Option<[String; 2]>,
}

/// Declares combinations of keys that are refused: the key that the error names, the condition, what is given and what is allowed.
macro_rules! refusals {
    ($(#[$about:meta])* $name:ident: $($key:literal if |$spec:ident| $is_refused:expr => $given:expr, $allowed:expr;)*) => {
        $(#[$about])*
        pub(crate) const $name: &[Refusal] = &[$(Refusal {
            key: $key,
            refused: |$spec| ($is_refused).then(|| [$given.to_string(), $allowed.to_string()]),
        }),*];
    };
}

refusals! {
    /// Refused combinations of `[skin]`, `[touches]`, `[human_touch]` and `[signal]`.
    OF_TOUCHES:
    "skin.layout" if |spec| spec.is_curved() && spec.skin.curvature_radius_mm.is_none()
        => spec.skin.layout.unwrap_or_default().words(), "skin.curvature_radius_mm beside a cylinder or a cap";
    "touches.speed_mm_per_s" if |spec| spec.is_curved() && spec.touches.speed_mm_per_s > 0.0
        => spec.touches.speed_mm_per_s, "0: taxels of a curved layout move at speeds of their own";
    "signal.steps" if |spec| spec.senses_force() && spec.signal.steps.contains(&StepSpec::Force)
        => "force", "no such step where skin.sensed is a force from the first step on";
    "touches.speed_mm_per_s" if |spec| spec.touches.speed_mm_per_s > 0.0 && (spec.slides() || spec.reads_shear())
        => spec.touches.speed_mm_per_s, "0 where skin.sensed is shear, and where touches slide";
    "touches" if |spec| spec.places_objects() && spec.touches == TouchesSpec::default()
        => "no such table", "a table [touches]: how the objects are touched";
    "human_touch" if |spec| spec.human_touch.is_some() && (spec.objects != ObjectsSpec::default() || spec.touches != TouchesSpec::default())
        => "beside [objects] or [touches]", "it alone: it is what touches, and how";
}

refusals! {
    /// Refused combinations of `[recognition]`, the trials and the test touches.
    OF_LEARNING:
    "signal.test_sensor" if |spec| has_other_skin(spec) && !spec.signal.steps.iter().any(is_of_skin)
        => "given for skins without a difference", format!("{} among signal.steps beside it", errors_of_skins());
    // If C or γ is chosen, the rarest objects may have too few rows for the inner folds.
    "recognition.class_imbalance" if |spec| spec.recognition.is_open() && is_imbalanced(spec)
        => "given beside c_grid or gamma_grid", "a given c and gamma: folds need touches of every object";
    "recognition.class_imbalance" if |spec| spec.recognition.is_informed() && is_imbalanced(spec)
        => "given beside next_touch = \"most_informative\"", "another next_touch: folds need touches of every object";
    "recognition.split" if |spec| spec.splits_by_pose() && !spec.places_objects()
        => spec.recognition.split.word(), "\"random\": only touches that a study places have a known pose";
    "recognition.next_touch" if |spec| chooses_touches(spec) && !spec.places_objects()
        => first_chosen(spec), "\"random\": only touches that a study places have a known pose";
    "recognition.next_touch" if |spec| chooses_touches(spec) && spec.touches.rest != RestPoses::AsModelled
        => format!("{} beside touches.rest = \"stable\"", first_chosen(spec)), "rest = \"as_modelled\", or \"random\": how an unknown object lies cannot be commanded";
    "test.touches" if |spec| chooses_touches(spec) && spec.test.contains_key("touches")
        => "given where touches are chosen by their poses (recognition.next_touch)", "other tables of [test]";
    "trials" if |spec| !spec.trials.is_multiple_of(n_folds(spec))
        => spec.trials, format!("a multiple of recognition.folds = {}", n_folds(spec));
    "projections_per_split" if |spec| spec.projections_per_split.is_some_and(|n| n < 2)
        => n_projections(spec), "at least 2, or no such key: a projection of its own for each trial";
    "trials" if |spec| spec.projections_per_split.is_some_and(|n| !spec.trials.is_multiple_of(n) || spec.trials / n < 2)
        => spec.trials, format!("a multiple of projections_per_split = {}, for at least 2 splits", n_projections(spec));
    "trials" if |spec| !(spec.trials / n_projections(spec)).is_multiple_of(n_folds(spec))
        => format!("{} splits of {} projections each", spec.trials / n_projections(spec), n_projections(spec)),
           format!("a multiple of recognition.folds = {} splits", n_folds(spec));
    "skin.sensed" if |spec| spec.recorded.is_none() && spec.reads_shear() && spec.rubs() && spec.skin.friction.is_none()
        => "shear", "skin.friction beside it";
}

/// Returns whether the test touches are read by another skin.
fn has_other_skin(spec: &StudySpec) -> bool {
    let mut skins = spec.signal.test_sensor.iter().flat_map(Axis::values);
    skins.any(|skin| skin != TestSensor::SameSkin)
}

/// Returns whether a step is a sensor error that differs between skins.
fn is_of_skin(step: &StepSpec) -> bool {
    matches!(step, StepSpec::Error(error) if error.about().is_of_skin)
}

/// Returns the names of all sensor errors that differ between skins.
fn errors_of_skins() -> String {
    let errors = SensorError::all().map(StepSpec::Error).filter(is_of_skin);
    errors.map(StepSpec::word).collect::<Vec<_>>().join(" or ")
}

fn is_imbalanced(spec: &StudySpec) -> bool {
    let mut ratios = spec
        .recognition
        .class_imbalance
        .iter()
        .flat_map(Axis::values);
    ratios.any(|ratio| ratio != 1.0)
}

fn chooses_touches(spec: &StudySpec) -> bool {
    spec.recognition.chosen_next().next().is_some()
}

/// Returns the first rule that chooses touches by their poses, as in a study file.
fn first_chosen(spec: &StudySpec) -> String {
    let chosen = spec.recognition.chosen_next().next();
    chosen.map_or(String::new(), |next| format!("{:?}", next.word()))
}

fn n_folds(spec: &StudySpec) -> usize {
    spec.recognition.folds.unwrap_or(1)
}

fn n_projections(spec: &StudySpec) -> usize {
    spec.projections_per_split.unwrap_or(1)
}

impl Check<'_> {
    /// Returns an error if the study has a refused combination of keys.
    pub(crate) fn combinations(&self, refusals: &[Refusal], spec: &StudySpec) -> Result<()> {
        let mut refused = refusals.iter();
        let refused = refused.find_map(|one| Some((one.key, (one.refused)(spec)?)));
        refused.map_or(Ok(()), |(key, [given, allowed])| {
            Err(self.error(key, given, allowed))
        })
    }
}
