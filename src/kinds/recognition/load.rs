//! A recognition study from its text.

use super::scale::recognition_scale;
use super::study::RecognitionStudy;
use crate::error::{Error, Result};
use crate::kinds::{self, Source};
use crate::random::Seed;
use crate::study::memory::check_touches;
use crate::study::touch_set::TouchSet;
use crate::study::{HumanTouches, Plan, StudySpec, draw_touches, load_objects};

/// Reads and checks a study.
///
/// # Errors
/// A study of another kind; a key that is not known or out of its range.
pub fn read_plan(source: &Source) -> Result<Plan> {
    if let Some(about) = kinds::about(&source.text)
        && about.table != super::RECOGNITION.table
    {
        let allowed = format!(
            "{} (bubbletouch run runs all kinds)",
            super::RECOGNITION.words
        );
        return Err(Error::input(&source.place, about.words, allowed));
    }
    let mut spec = StudySpec::parse(&source.place, &source.text)?;
    spec.seed = source.seed(spec.seed);
    source.replace_objects(&mut spec.objects);
    Plan::new(&source.place, spec)
}

/// The same, builds its objects and draws its touches, unless these take more memory than there is.
///
/// # Errors
/// Those of [`read_plan`]; an object that cannot be read; touches that memory cannot hold.
pub fn load_study(source: &Source) -> Result<RecognitionStudy> {
    let plan = read_plan(source)?;
    let seed = Seed::new(plan.spec.seed);
    let touched: Box<dyn TouchSet + Send> = match &plan.human_touch {
        Some(human) => {
            check_touches(&plan, human.kinds.len(), source.memory)?;
            Box::new(HumanTouches::draw(human, &seed)?)
        }
        None => {
            let objects = load_objects(&plan.spec.objects, source.packings())?;
            check_touches(&plan, objects.len(), source.memory)?;
            Box::new(draw_touches(objects, &plan.placement, &seed)?)
        }
    };
    let mut study = RecognitionStudy::new(plan, touched)?;
    (study.scale, study.place) = recognition_scale(&study, source.memory, &source.results);
    Ok(study)
}
