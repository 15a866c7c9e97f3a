//! Touches of an array: made once, shared by all cells.

use super::array_press::ArrayWorkspace;
use super::frames::Frames;
use super::progress::Progress;
use super::taxel_array::TaxelArray;
use super::touch_set::TouchSet;
use crate::contact::Contact;
use crate::error::Result;
use crate::objects::Object;
use crate::random::Seed;
use crate::world::{Placement, RestPose, Touch, touches};
use ndarray::{Array1, ArrayViewMut2};
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

/// Makes all touches on an array and keeps the frames in memory.
pub fn simulate_array(
    touched: &dyn TouchSet,
    array: &TaxelArray,
    n_frames: usize,
    progress: &dyn Progress,
) -> Frames {
    touched.simulate((array, n_frames), progress)
}

/// Presses one array on every object, touch by touch; the same bytes at any number of threads.
///
/// A touch to a depth d is read at `n_frames` ≥ 1 depths, d/F, 2d/F … d, or at as many places of its way where it slides, too: each is a touch
/// of its own, since a taxel at rest does not remember how it came there.
pub(super) fn press_objects(
    touched: &[TouchedObject],
    (array, n_frames): (&TaxelArray, usize),
    progress: &dyn Progress,
) -> Frames {
    let mut frames = Frames::new((array.n_values(), n_frames));
    for TouchedObject {
        object,
        rests,
        touches,
    } in touched
    {
        let press = array.press(&object.model);
        let press =
            |touch: &Touch, workspace: &mut ArrayWorkspace, mut rows: ArrayViewMut2<f32>| {
                let pose = touch.patch_from_object(&rests[touch.rest]);
                let mut last = None;
                for (frame, row) in rows.outer_iter_mut().enumerate() {
                    let part = (frame + 1) as f64 / n_frames as f64;
                    last = press.touch(pose, (touch.depth, part), workspace);
                    for (to, from) in row.into_iter().zip(press.values(workspace)) {
                        *to = from as f32;
                    }
                }
                let reads_any = |count: fn(Contact) -> usize| last.is_some_and(|c| count(c) > 0);
                (!reads_any(|c| c.n_touched), reads_any(|c| c.n_saturated))
            };
        frames.make(touches, ArrayWorkspace::default, press, progress);
    }
    frames
}
