//! Touches of objects, drawn from a placement.

use crate::error::Result;
use crate::objects::Object;
use crate::random::Seed;
use crate::world::{Placement, RestPose, Touch, touches};
use ndarray::Array1;
use rayon::prelude::*;

/// An object with its rest poses and its touches.
#[derive(Clone, Debug)]
pub struct TouchedObject {
    /// The touched object.
    pub object: Object,
    /// Rest poses of the object; each touch contains the index of one.
    pub rests: Vec<RestPose>,
    /// Touches of the object.
    pub touches: Vec<Touch>,
}

/// Draws the touches of every object.
///
/// # Errors
/// If [`touches`](crate::world::touches()) fails.
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

/// Returns the label of every touch, given the name and the number of touches of each class.
pub fn touch_labels(classes: &[(&str, usize)]) -> Array1<usize> {
    let classes = classes.iter().enumerate();
    let labels = classes.flat_map(|(label, (_, n))| std::iter::repeat_n(label, *n));
    labels.collect()
}

/// Returns the seed from which an object's touches are drawn.
pub fn touch_stream(seed: &Seed, object: &Object) -> Seed {
    seed.named("touches").named(&object.name)
}
