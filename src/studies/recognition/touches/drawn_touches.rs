//! Touches of objects, drawn from a placement.

use crate::error::Result;
use crate::objects::Object;
use crate::random::Seed;
use crate::world::{Placement, RestPose, Touch, touches};
use ndarray::Array1;
use rayon::prelude::*;

/// An object with its ways of lying on the table and its touches.
#[derive(Clone, Debug)]
pub struct TouchedObject {
    /// The object.
    pub object: Object,
    /// Rest poses; a touch names one by its index.
    pub rests: Vec<RestPose>,
    /// Its touches.
    pub touches: Vec<Touch>,
}

/// Draws the touches of every object.
///
/// # Errors
/// Those of [`touches`](crate::world::touches()).
pub fn draw_touches(
    objects: Vec<Object>,
    placement: &Placement,
    seed: &Seed,
) -> Result<Vec<TouchedObject>> {
    let touched = objects.into_par_iter().map(|object| {
        let rests = placement.rest.of(&object.model);
        let touches = touches(placement, &rests, &touch_stream(seed, &object))?;
        Ok(TouchedObject {
            object,
            rests,
            touches,
        })
    });
    touched.collect()
}

/// The label of every touch of some classes.
pub fn touch_labels(classes: &[(&str, usize)]) -> Array1<usize> {
    let classes = classes.iter().enumerate();
    let labels = classes.flat_map(|(label, (_, n))| std::iter::repeat_n(label, *n));
    labels.collect()
}

/// What an object's touches are drawn from.
pub fn touch_stream(seed: &Seed, object: &Object) -> Seed {
    seed.named("touches").named(&object.name)
}
