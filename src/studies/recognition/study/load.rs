//! Loading of a recognition study: its plans, objects and touches. All combinations of axis values that share objects or touches use one copy of them.

use crate::files::with_folder;
use crate::inputs::memory::check_memory;
use crate::learning::classifiers::foreign::Foreign;
use crate::note::note;
use crate::studies::check_recognition;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{
    HumanTouches, RecordedFrames, TouchSet, note_shear_ripple,
};
use crate::studies::recognition::study::{RecognitionStudy, recognition_scale};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;
use std::sync::Arc;

/// Reads and checks a study file; returns one plan for each combination of the values in `[axes]`.
///
/// # Errors
/// If the study is of another kind, or a key is unknown or out of its range.
pub fn read_plans(source: &Source) -> Result<Vec<(AxisValues, Plan)>> {
    check_recognition(source)?;
    let parse = || StudySpec::parse(&source.place, &source.text);
    // With `--objects`, the files of the study are in another folder.
    let mut folder = source.objects.is_none().then(|| source.folder.clone());
    let mut spec = with_folder(folder.clone(), parse)?;
    let replaced = ["objects.sets", "objects.meshes"];
    if let Some(key) = replaced.into_iter().find(|key| spec.axes.has(key)) {
        source.refuse_objects(&format!("{key} is an axis of the study"))?;
    }
    spec.seed = source.seed(spec.seed)?;
    match &mut spec.recorded {
        Some(recorded) => folder = source.replace_recorded(recorded).or(folder),
        None => source.replace_objects(&mut spec.objects),
    }
    if !Foreign::given().is_empty() && spec.axes.has("recognition.classifier") {
        let allowed =
            "the classifiers of the program named in [axes], too, or varied in [recognition]";
        return Err(Error::input(
            "axes.\"recognition.classifier\"",
            "an axis",
            allowed,
        ));
    }
    spec.recognition.add_given();
    spec.recognition.install_commands();
    // Axis values may be paths.
    with_folder(folder, || Plan::variants(&source.place, spec))
}

/// Reads and checks a study file, builds its objects, and draws its touches if they fit into memory.
///
/// # Errors
/// If [`read_plans`] fails, an object cannot be read, or the touches do not fit into memory.
pub fn load_study(source: &Source) -> Result<RecognitionStudy> {
    let plans = read_plans(source)?;
    let (packings, place) = (source.packings.as_deref(), &source.place);
    let mut study = RecognitionStudy::load(place, plans, packings, source.memory)?;
    study.scale = recognition_scale(&study);
    Ok(study)
}

impl RecognitionStudy {
    /// Builds the objects of all plans and draws their touches. The touches must fit into `ceiling` bytes; `None` sets no limit. Packed objects (sphere models)
    /// are cached in the folder `packings`.
    ///
    /// # Errors
    /// If an object cannot be built, or there are too many or too few touches; the error names `place` (the file).
    pub fn load(
        place: &str,
        plans: Vec<(AxisValues, Plan)>,
        packings: Option<&Path>,
        ceiling: Option<u64>,
    ) -> Result<Self> {
        let (mut objects, mut has_noted) = (HashMap::new(), false);
        let mut drawn: HashMap<String, Arc<dyn TouchSet + Send>> = HashMap::new();
        let mut draw = |plan: &Plan| -> Result<Arc<dyn TouchSet + Send>> {
            let (content, spec) = (touch_content(plan), &plan.spec);
            let seed = Seed::new(spec.seed);
            let touched: Arc<dyn TouchSet + Send> = if let Some(known) = drawn.get(&content) {
                known.clone()
            } else if let Some(human) = &spec.human_touch {
                check_touches(plan, human.kinds.len(), ceiling)?;
                Arc::new(HumanTouches::draw(human, &seed)?)
            } else if let Some(recorded) = &spec.recorded {
                Arc::new(RecordedFrames::read(recorded, ceiling)?)
            } else {
                let objects = match objects.entry(identity(&objects_inputs(plan))) {
                    Entry::Occupied(known) => known.into_mut(),
                    Entry::Vacant(new) => new.insert(load_objects(&spec.objects, packings)?),
                };
                if !has_noted {
                    has_noted = note_shear_ripple(plan, objects)?;
                }
                check_touches(plan, objects.len(), ceiling)?;
                let n_touches = plan.placement.n_touches() * objects.len() as f64;
                if let Some(slow) = slow_splits(n_touches, spec.trials) {
                    note(format_args!("{place}: {slow}"));
                }
                let drawn = draw_touches(objects.clone(), &plan.placement, &seed);
                Arc::new(drawn.map_err(|error| error.under(format!("{place}, ")))?)
            };
            drawn.insert(content, touched.clone());
            Ok(touched)
        };
        let variants = plans.into_iter().map(|(variant, plan)| {
            let touched = draw(&plan)?;
            let tested = plan
                .tested
                .as_deref()
                .map_or(Ok(touched.clone()), &mut draw)?;
            let plan = plan.without_taxels(touched.absent());
            Ok((variant, plan, [touched, tested]))
        });
        let variants = variants.collect::<Result<Vec<_>>>()?;
        Self::of_variants(variants).map_err(|error| error.under(format!("{place}, ")))
    }
}

/// Product of the numbers of touches and trials above which [`slow_splits`] returns a message. With a larger value, commands are silent for longer; with a
/// smaller value, short waits are announced.
const MANY_SPLITS: f64 = 7e7;

/// Returns a message if splitting the touches into training and test touches takes a noticeable time.
fn slow_splits(n_touches: f64, n_trials: usize) -> Option<String> {
    (n_touches * n_trials as f64 >= MANY_SPLITS)
        .then(|| format!("splitting {n_touches} touches in {n_trials} trials"))
}

/// Returns a text that identifies the touches of a plan, independently of the object files. The pitch and the sizes of the arrays only affect which objects are
/// rejected or noted.
pub fn touch_content(plan: &Plan) -> String {
    let recorded = plan.spec.recorded.as_ref();
    let recorded = recorded.map(|recorded| (recorded, recorded.n_values));
    identity(&(recorded, objects_inputs(plan), touch_inputs(plan)))
}

/// Returns the inputs that determine the objects of a plan, without their files.
fn objects_inputs(plan: &Plan) -> impl Serialize + '_ {
    let objects = &plan.spec.objects;
    (objects, objects.pitch, objects.sizes)
}

/// Memory that a touch occupies, bytes: its pose, its label and its reading parameters.
const TOUCH_BYTES: f64 = 400.0;

/// Memory of one touch in the split of one trial, bytes.
const SPLIT_BYTES: f64 = 8.0;

/// Checks whether the touches of `n_classes` classes, with one split per trial, fit into `ceiling` bytes (`None`: no limit).
///
/// # Errors
/// If the touches need more memory; the error names the key that sets their number.
fn check_touches(plan: &Plan, n_classes: usize, ceiling: Option<u64>) -> Result<()> {
    let (key, n_each) = match &plan.spec.human_touch {
        Some(human) => ("human_touch.per_kind", human.per_kind as f64),
        None => ("touches.per_object", plan.placement.n_touches()),
    };
    let n_touches = n_each * n_classes as f64;
    let bytes = n_touches * (TOUCH_BYTES + SPLIT_BYTES * plan.spec.trials as f64);
    let what = format!("{n_touches} touches and their splits");
    check_memory(bytes, ceiling, &what)
        .map_err(|allowed| Error::input(format!("key {key}"), n_each, allowed))
}

/// Returns the identity of a plan's set of touches. It does not depend on the pitch and the sizes of the arrays, so that an axis of arrays may be extended.
/// Files of a recording are identified by their contents.
pub(crate) fn set_content(plan: &Plan, touched: &dyn TouchSet) -> String {
    let recorded = touched.recorded_content();
    let recorded = recorded.map(|content| &content.identity);
    identity(&(recorded, touch_inputs(plan)))
}

/// Returns the inputs that determine the touches of a plan, without the array, the object files and the recording.
fn touch_inputs(plan: &Plan) -> impl Serialize + '_ {
    let spec = &plan.spec;
    (&spec.objects, &plan.placement, &spec.human_touch, spec.seed)
}

#[cfg(test)]
mod tests {
    use crate::studies::recognition::study::load::slow_splits;

    #[test]
    fn many_touches_in_many_trials_are_announced() {
        assert_eq!(
            slow_splits(6e5, 1000).as_deref(),
            Some("splitting 600000 touches in 1000 trials")
        );
        assert_eq!(slow_splits(37_152.0, 4), None);
    }
}
