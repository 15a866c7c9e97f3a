//! A recognition study from its text: objects that are built once and touches that are drawn once for all combinations that share them.

use super::scale::recognition_scale;
use super::study::RecognitionStudy;
use crate::error::{Error, Result};
use crate::files::with_folder;
use crate::kinds::{self, Kind, Source};
use crate::note::note;
use crate::random::Seed;
use crate::study::axes::AxisValues;
use crate::study::memory::check_touches;
use crate::study::object_files::load_objects;
use crate::study::plan::Plan;
use crate::study::shear_ripple::note_shear_ripple;
use crate::study::simulation::draw_touches;
use crate::study::spec::{HumanTouchSpec, ObjectsSpec, RecordedSpec, StudySpec};
use crate::study::touch_set::TouchSet;
use crate::study::{HumanTouches, RecordedFrames};
use crate::world::Placement;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;
use std::sync::Arc;

/// Reads and checks a study: a plan for each combination of its own axes.
///
/// # Errors
/// A study of another kind; a key that is not known or out of its range.
pub fn read_plans(source: &Source) -> Result<Vec<(AxisValues, Plan)>> {
    if let Some(about) = kinds::about(&source.text)
        && about.table != RecognitionStudy::ABOUT.table
    {
        let recognition = RecognitionStudy::ABOUT.words;
        let allowed = format!("{recognition} (bubbletouch run runs all kinds)");
        return Err(Error::input(&source.place, about.words, allowed));
    }
    let parse = || StudySpec::parse(&source.place, &source.text);
    // --objects says where the files of the study are.
    let folder = source.objects.is_none().then(|| source.folder.clone());
    let mut spec = with_folder(folder.clone(), parse)?;
    if let Some(seed) = source.seed
        && spec.axes.0.iter().any(|axis| axis.key == "seed")
    {
        let allowed = "no such option: the seed is an axis of the study";
        return Err(Error::input("--seed", seed, allowed));
    }
    spec.seed = source.seed(spec.seed);
    match &mut spec.recorded {
        Some(recorded) => source.replace_recorded(recorded),
        None => source.replace_objects(&mut spec.objects),
    }
    // Values on axes may be paths, too.
    with_folder(folder, || Plan::variants(&source.place, spec))
}

/// Reads and checks a study, builds its objects and draws its touches, unless these take more memory than there is.
///
/// # Errors
/// Those of [`read_plans`]; an object that cannot be read; touches that memory cannot hold.
pub fn load_study(source: &Source) -> Result<RecognitionStudy> {
    let plans = read_plans(source)?;
    let (packings, place) = (source.packings.as_deref(), &source.place);
    let mut study = RecognitionStudy::load(place, plans, packings, source.memory)?;
    study.scale = recognition_scale(&study);
    Ok(study)
}

impl RecognitionStudy {
    /// Builds the objects of [plans](Plan::variants) and draws their touches, unless these take more bytes than `ceiling` (`None`: no
    /// limit). Objects that are packed are kept in `packings`.
    ///
    /// # Errors
    /// An object that cannot be built; too many touches; those of [`of_variants`](Self::of_variants), after `place` (the file).
    pub fn load(
        place: &str,
        plans: Vec<(AxisValues, Plan)>,
        packings: Option<&Path>,
        ceiling: Option<u64>,
    ) -> Result<Self> {
        let (mut objects, mut has_noted) = (HashMap::new(), false);
        let mut drawn: HashMap<String, Arc<dyn TouchSet + Send>> = HashMap::new();
        let mut variants = Vec::with_capacity(plans.len());
        for (variant, plan) in plans {
            let inputs = TouchInputs::of(&plan);
            let (content, seed) = (inputs.key(), Seed::new(inputs.seed));
            let touched: Arc<dyn TouchSet + Send> = if let Some(known) = drawn.get(&content) {
                known.clone()
            } else if let Some(human) = inputs.human_touch {
                check_touches(&plan, human.kinds.len(), ceiling)?;
                Arc::new(HumanTouches::draw(human, &seed)?)
            } else if let Some(recorded) = inputs.recorded {
                Arc::new(RecordedFrames::read(recorded, ceiling)?)
            } else {
                let known = objects.entry(format!("{:?}", inputs.objects));
                let objects = match known {
                    Entry::Occupied(known) => known.into_mut(),
                    Entry::Vacant(new) => new.insert(load_objects(inputs.objects, packings)?),
                };
                if !has_noted {
                    has_noted = note_shear_ripple(&plan, objects)?;
                }
                check_touches(&plan, objects.len(), ceiling)?;
                let n_touches = inputs.placement.n_touches() * objects.len() as f64;
                if let Some(slow) = slow_splits(n_touches, plan.spec.trials) {
                    note(format_args!("{place}: {slow}"));
                }
                let drawn = draw_touches(objects.clone(), inputs.placement, &seed);
                Arc::new(drawn.map_err(|error| error.under(format!("{place}, ")))?)
            };
            drawn.insert(content, touched.clone());
            variants.push((variant, plan, touched));
        }
        Self::of_variants(variants).map_err(|error| error.under(format!("{place}, ")))
    }
}

/// Number of touches times trials from which on [`slow_splits`] returns a sentence: some seconds of splitting. Larger: a command is silent for
/// longer; smaller: short waits are announced.
const MANY_SPLITS: f64 = 7e7;

/// Returns a sentence if a command waits while it splits touches, before it begins.
fn slow_splits(n_touches: f64, n_trials: usize) -> Option<String> {
    (n_touches * n_trials as f64 >= MANY_SPLITS)
        .then(|| format!("splitting {n_touches} touches in {n_trials} trials"))
}

/// Everything of a plan that its touches are drawn from, beside the array and the files of its objects. Plans with equal inputs share their touches.
#[derive(Debug)]
pub(super) struct TouchInputs<'a> {
    objects: &'a ObjectsSpec,
    placement: &'a Placement,
    human_touch: Option<&'a HumanTouchSpec>,
    recorded: Option<&'a RecordedSpec>,
    seed: u64,
}

impl<'a> TouchInputs<'a> {
    /// Returns the inputs of a plan's touches.
    pub fn of(plan: &'a Plan) -> Self {
        let spec = &plan.spec;
        Self {
            objects: &spec.objects,
            placement: &plan.placement,
            human_touch: spec.human_touch.as_ref(),
            recorded: spec.recorded.as_ref(),
            seed: spec.seed,
        }
    }

    /// Returns a text that is equal for equal inputs only.
    pub fn key(&self) -> String {
        format!("{self:?}")
    }
}

/// Returns a text that is equal for plans with the same touches, beside the array and the files of their objects.
pub fn touch_content(plan: &Plan) -> String {
    TouchInputs::of(plan).key()
}

#[cfg(test)]
mod tests {
    use super::slow_splits;

    #[test]
    fn many_touches_in_many_trials_are_announced() {
        assert_eq!(
            slow_splits(6e5, 1000).as_deref(),
            Some("splitting 600000 touches in 1000 trials")
        );
        assert_eq!(slow_splits(37_152.0, 4), None);
    }
}
