//! A recognition study from its plans: objects that are built once and touches that are drawn once for all that share them.

use super::study::RecognitionStudy;
use crate::error::Result;
use crate::random::Seed;
use crate::study::axes::AxisValues;
use crate::study::human_touches::HumanTouches;
use crate::study::memory::check_touches;
use crate::study::object_files::load_objects;
use crate::study::plan::Plan;
use crate::study::simulation::draw_touches;
use crate::study::touch_set::TouchSet;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

impl RecognitionStudy {
    /// Builds the objects of [plans](Plan::variants) and draws their touches, unless these take more bytes than `ceiling` (`None`: no
    /// limit). Objects that are packed are kept in `packings`.
    ///
    /// # Errors
    /// An object that cannot be built; too many touches; those of [`of_variants`](Self::of_variants).
    pub fn load(
        plans: Vec<(AxisValues, Plan)>,
        packings: Option<&Path>,
        ceiling: Option<u64>,
    ) -> Result<Self> {
        let mut objects = HashMap::new();
        let mut drawn: HashMap<String, Arc<dyn TouchSet + Send>> = HashMap::new();
        let mut variants = Vec::with_capacity(plans.len());
        for (variant, plan) in plans {
            let built = format!("{:?}", plan.spec.objects);
            let (key, seed) = (touch_content(&plan), plan.spec.seed);
            let touched = match (drawn.get(&key), &plan.human_touch) {
                (Some(known), _) => known.clone(),
                (None, Some(human)) => {
                    check_touches(&plan, human.kinds.len(), ceiling)?;
                    Arc::new(HumanTouches::draw(human, &Seed::new(seed))?)
                }
                (None, None) => {
                    if !objects.contains_key(&built) {
                        let loaded = load_objects(&plan.spec.objects, packings)?;
                        objects.insert(built.clone(), loaded);
                    }
                    let objects = &objects[&built];
                    check_touches(&plan, objects.len(), ceiling)?;
                    let seed = Seed::new(seed);
                    Arc::new(draw_touches(objects.clone(), &plan.placement, &seed)?)
                }
            };
            drawn.insert(key, touched.clone());
            variants.push((variant, plan, touched));
        }
        Self::of_variants(variants)
    }
}

/// All that the touches of a plan depend on, beside the array and the files of its objects.
pub(super) fn touch_content(plan: &Plan) -> String {
    let Plan {
        spec,
        placement,
        human_touch,
        ..
    } = plan;
    format!(
        "{:?} {placement:?} {human_touch:?} {}",
        spec.objects, spec.seed
    )
}
