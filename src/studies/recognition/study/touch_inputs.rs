//! What the touches of a study depend on.

use crate::inputs::objects_spec::ObjectsSpec;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::spec::human::HumanTouchSpec;
use crate::studies::recognition::spec::recorded::RecordedSpec;
use crate::world::Placement;

/// Everything of a plan that its touches are drawn from, beside the array and the files of its objects. Plans with equal inputs share their touches.
#[derive(Debug)]
pub(crate) struct TouchInputs<'a> {
    pub(crate) objects: &'a ObjectsSpec,
    pub(crate) placement: &'a Placement,
    pub(crate) human_touch: Option<&'a HumanTouchSpec>,
    pub(crate) recorded: Option<&'a RecordedSpec>,
    pub(crate) seed: u64,
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

    /// Returns a text that is equal for equal touches only. The arrays' pitch and size decide which objects are refused or noted, and nothing of
    /// a touch: an axis of arrays may be extended.
    pub fn content(&self) -> String {
        let objects = ObjectsSpec {
            pitch: None,
            sizes: None,
            ..self.objects.clone()
        };
        let objects = &objects;
        TouchInputs { objects, ..*self }.key()
    }
}
