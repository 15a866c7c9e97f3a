//! Touches of objects, drawn from a placement (the distribution of touch poses).

use crate::error::Result;
use crate::objects::Object;
use crate::random::Seed;
use crate::world::{Placement, RestPose, Touch, touches};
use ndarray::Array1;
use rayon::prelude::*;

/// Object with its resting poses and the touches that are drawn for it.
#[derive(Clone, Debug)]
pub struct TouchedObject {
    /// Object that is touched.
    pub object: Object,
    /// Resting poses of the object; each touch contains the index of one.
    pub rests: Vec<RestPose>,
    /// Touches of the object in drawing order.
    pub touches: Vec<Touch>,
}

/// Draws the touches of every object. Each object has its own random stream, so its touches do not depend on the other objects.
///
/// # Errors
/// If a placement is invalid or gives too many touches.
pub fn draw_touches(
    objects: Vec<Object>,
    placement: &Placement,
    seed: &Seed,
) -> Result<Vec<TouchedObject>> {
    let touched = objects.into_par_iter().map(|object| {
        let rests = placement.rest.poses(&object.model);
        let touches = touches(placement, &rests, &touch_stream(seed, &object))?;
        Ok(TouchedObject {
            object,
            rests,
            touches,
        })
    });
    touched.collect()
}

/// Returns the label of each touch, which is the number of its class. The argument contains the name and the number of touches of each class.
pub fn touch_labels(classes: &[(&str, usize)]) -> Array1<usize> {
    let classes = classes.iter().enumerate();
    let labels = classes.flat_map(|(label, (_, n))| std::iter::repeat_n(label, *n));
    labels.collect()
}

/// Returns the seed of the random stream from which the touches of an object are drawn.
pub fn touch_stream(seed: &Seed, object: &Object) -> Seed {
    seed.named("touches").named(&object.name)
}
