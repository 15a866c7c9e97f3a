//! Inputs that determine the touches of a study.

use crate::inputs::objects_spec::ObjectsSpec;
use crate::studies::recognition::frames::touch_set::TouchSet;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::spec::human::HumanTouchSpec;
use crate::studies::recognition::spec::recorded::RecordedSpec;
use crate::world::Placement;

/// Inputs that determine the touches of a plan, without the array and the object files. Plans with equal inputs share their touches.
#[derive(Debug)]
pub(crate) struct TouchInputs<'a> {
    pub(crate) objects: &'a ObjectsSpec,
    pub(crate) placement: &'a Placement,
    pub(crate) human_touch: Option<&'a HumanTouchSpec>,
    pub(crate) recorded: Option<&'a RecordedSpec>,
    pub(crate) seed: u64,
}

impl<'a> TouchInputs<'a> {
    /// Returns the inputs that determine the touches of a plan.
    pub fn new(plan: &'a Plan) -> Self {
        let spec = &plan.spec;
        Self {
            objects: &spec.objects,
            placement: &plan.placement,
            human_touch: spec.human_touch.as_ref(),
            recorded: spec.recorded.as_ref(),
            seed: spec.seed,
        }
    }

    /// Returns a text that identifies the inputs; the texts are equal exactly if the inputs are equal.
    pub fn key(&self) -> String {
        format!("{self:?}")
    }

    /// Returns a text that identifies the set of touches. The text does not contain the pitch and size of the arrays, because they only affect which objects
    /// are rejected or noted. An axis of arrays may therefore be extended. Files of a recording are identified by their contents.
    pub fn content(&self, touched: &dyn TouchSet) -> String {
        let objects = ObjectsSpec {
            pitch: None,
            sizes: None,
            ..self.objects.clone()
        };
        let objects = &objects;
        match touched.recorded_content() {
            None => TouchInputs { objects, ..*self }.key(),
            Some(content) => {
                let recorded = None;
                let others = TouchInputs {
                    objects,
                    recorded,
                    ..*self
                };
                format!("{} {}", others.key(), content.identity)
            }
        }
    }
}
