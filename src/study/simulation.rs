//! Touches of an array: made once, shared by all cells.

use super::frames::{FramePlace, Frames};
use super::plan::millimetres;
use super::progress::Progress;
use super::touch_set::TouchSet;
use crate::contact::{Contact, Workspace, press_to_depth};
use crate::error::Result;
use crate::objects::Object;
use crate::random::Seed;
use crate::world::{Patch, Placement, RestPose, Scene, Touch, touches};
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

/// An array in words: `64×64 at 2 mm`.
pub(crate) fn describe(patch: &Patch) -> String {
    let grid = &patch.grid;
    format!("{}×{} at {} mm", grid.nx, grid.ny, millimetres(grid.pitch))
}

/// What an object's touches are drawn from.
pub fn touch_stream(seed: &Seed, object: &Object) -> Seed {
    seed.named("touches").named(&object.name)
}

/// Makes all touches on an array and keeps the frames in memory.
pub fn simulate_array(
    touched: &dyn TouchSet,
    patch: &Patch,
    n_frames: usize,
    progress: &dyn Progress,
) -> Frames {
    let frames = touched.simulate((patch, n_frames), &FramePlace::Memory, progress);
    frames.expect("memory takes all frames")
}

/// Presses one array on every object, touch by touch; the same bytes at any number of threads.
///
/// A touch to a depth d is read at `n_frames` ≥ 1 depths, d/F, 2d/F … d: each is a direct press of its own, since a taxel at
/// rest does not remember how it came there.
pub(super) fn press_objects(
    touched: &[TouchedObject],
    (patch, n_frames): (&Patch, usize),
    place: &FramePlace,
    progress: &dyn Progress,
) -> Result<Frames> {
    let mut frames = Frames::new((patch.grid.n_taxels(), n_frames), place)?;
    for TouchedObject {
        object,
        rests,
        touches,
    } in touched
    {
        let scene = Scene::of_one(patch, &object.model);
        let press = |touch: &Touch, workspace: &mut Workspace, mut rows: ArrayViewMut2<f32>| {
            let pose = touch.patch_from_object(&rests[touch.rest]);
            let mut contact = None;
            for (frame, row) in rows.outer_iter_mut().enumerate() {
                let part = (frame + 1) as f64 / n_frames as f64;
                contact = press_to_depth(&scene, &[pose], touch.depth * part, workspace);
                for (to, &from) in row.into_iter().zip(workspace.deflections()) {
                    *to = from as f32;
                }
            }
            let reads_any = |count: fn(Contact) -> usize| contact.is_some_and(|c| count(c) > 0);
            (!reads_any(|c| c.n_touched), reads_any(|c| c.n_saturated))
        };
        frames.make(touches, Workspace::new, press, progress)?;
    }
    Ok(frames)
}
