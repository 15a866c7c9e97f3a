//! Inputs that determine the touches of a study.

use crate::inputs::content_hash::identity;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::mesh::SizeLimits;
use crate::studies::recognition::frames::touch_set::TouchSet;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::spec::human::HumanTouchSpec;
use crate::studies::recognition::spec::recorded::RecordedSpec;
use crate::world::Placement;
use serde::Serialize;

/// Inputs that determine the touches of a plan, without the array and the object files. Plans with equal inputs share their touches.
#[derive(Serialize)]
pub(crate) struct TouchInputs<'a> {
    pub(crate) objects: ObjectInputs<'a>,
    pub(crate) placement: &'a Placement,
    pub(crate) human_touch: Option<&'a HumanTouchSpec>,
    /// Keys of the recording, and the number of values per taxel in its frames.
    pub(crate) recorded: Option<(&'a RecordedSpec, usize)>,
    pub(crate) seed: u64,
}

/// Inputs that determine the objects of a plan, without their files. The pitch and the sizes of the arrays only affect which objects are rejected or noted.
#[derive(Clone, Copy, Serialize)]
pub(crate) struct ObjectInputs<'a> {
    pub(crate) keys: &'a ObjectsSpec,
    pitch: Option<f64>,
    sizes: Option<SizeLimits>,
}

impl<'a> TouchInputs<'a> {
    /// Returns the inputs that determine the touches of a plan.
    pub fn new(plan: &'a Plan) -> Self {
        let spec = &plan.spec;
        let recorded = spec.recorded.as_ref();
        Self {
            objects: ObjectInputs {
                keys: &spec.objects,
                pitch: spec.objects.pitch,
                sizes: spec.objects.sizes,
            },
            placement: &plan.placement,
            human_touch: spec.human_touch.as_ref(),
            recorded: recorded.map(|recorded| (recorded, recorded.n_values)),
            seed: spec.seed,
        }
    }

    /// Returns the identity of the set of touches. It does not depend on the pitch and the sizes of the arrays, so that an axis of arrays may be extended. Files
    /// of a recording are identified by their contents.
    pub fn content(&self, touched: &dyn TouchSet) -> String {
        let content = touched.recorded_content();
        let objects = ObjectInputs {
            pitch: None,
            sizes: None,
            ..self.objects
        };
        let recorded = self.recorded.filter(|_| content.is_none());
        let touches = TouchInputs {
            objects,
            recorded,
            ..*self
        };
        identity(&(touches, content.map(|content| &content.identity)))
    }
}
