//! Touches of an array: made once, shared by all cells.

use super::progress::Progress;
use crate::contact::{Workspace, press_to_depth};
use crate::error::Result;
use crate::objects::Object;
use crate::random::Seed;
use crate::world::{Patch, Placement, RestPose, Scene, Touch, touches};
use ndarray::{Array1, Array2, ArrayViewMut2, Axis, s};
use rayon::prelude::*;
use std::time::Instant;

/// Touches simulated by one thread at a time: large enough to hide the hand-over, small enough to share out evenly.
const BLOCK: usize = 32;

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

/// Frames of an array and what happened while they were made.
#[derive(Clone, Debug)]
pub struct Frames {
    /// (n_touches · F) × n_taxels, metres of deflection; object by object, touch by touch, the deepest frame of a touch last.
    pub deflection: Array2<f32>,
    /// F, frames a touch.
    pub n_frames: usize,
    /// Touches that met nothing: their frames are zero.
    pub n_missed: usize,
    /// Touches with at least one taxel at its stroke when they are deepest.
    pub n_saturated: usize,
    /// Processor-seconds, summed over threads.
    pub cpu_s: f64,
}

/// Draws the touches of every object.
pub fn draw_touches(
    objects: Vec<Object>,
    placement: &Placement,
    seed: &Seed,
) -> Result<Vec<TouchedObject>> {
    objects
        .into_par_iter()
        .map(|object| {
            let rests = placement.rest.of(&object.model);
            let touches = touches(placement, &rests, &touch_stream(seed, &object))?;
            Ok(TouchedObject {
                object,
                rests,
                touches,
            })
        })
        .collect()
}

/// The object of every touch, by its number.
pub fn touch_labels(touched: &[TouchedObject]) -> Array1<usize> {
    let objects = touched.iter().enumerate();
    let labels = objects.flat_map(|(label, t)| std::iter::repeat_n(label, t.touches.len()));
    labels.collect()
}

/// What an object's touches are drawn from.
pub fn touch_stream(seed: &Seed, object: &Object) -> Seed {
    seed.named("touches").named(&object.name)
}

/// Presses one array on every object, touch by touch; the same bytes at any number of threads.
///
/// A touch to a depth d is read at `n_frames` ≥ 1 depths, d/F, 2d/F … d: each is a direct press of its own, since a taxel at
/// rest does not remember how it came there.
pub fn simulate_array(
    touched: &[TouchedObject],
    patch: &Patch,
    n_frames: usize,
    progress: &dyn Progress,
) -> Frames {
    let n_touches: usize = touched.iter().map(|t| t.touches.len()).sum();
    let mut deflection = Array2::zeros((n_touches * n_frames, patch.grid.n_taxels()));
    let (mut n_missed, mut n_saturated, mut cpu_s) = (0, 0, 0.0);
    let mut first = 0;
    for TouchedObject {
        object,
        rests,
        touches,
    } in touched
    {
        let scene = Scene::of_one(patch, &object.model);
        let n_rows = touches.len() * n_frames;
        let mut frames = deflection.slice_mut(s![first..first + n_rows, ..]);
        let blocks: Vec<_> = frames
            .axis_chunks_iter_mut(Axis(0), BLOCK * n_frames)
            .into_par_iter()
            .zip(touches.par_chunks(BLOCK))
            .map_init(Workspace::new, |workspace, (mut rows, touches)| {
                let start = Instant::now();
                let mut counts = (0, 0);
                let rows = rows.axis_chunks_iter_mut(Axis(0), n_frames);
                for (rows, touch) in rows.zip(touches) {
                    let (missed, saturated) =
                        press_into(&scene, &rests[touch.rest], touch, workspace, rows);
                    counts.0 += usize::from(missed);
                    counts.1 += usize::from(saturated);
                }
                progress.advance(touches.len() as u64);
                (counts, start.elapsed().as_secs_f64())
            })
            .collect();
        for ((missed, saturated), seconds) in blocks {
            n_missed += missed;
            n_saturated += saturated;
            cpu_s += seconds;
        }
        first += n_rows;
    }
    Frames {
        deflection,
        n_frames,
        n_missed,
        n_saturated,
        cpu_s,
    }
}

/// One touch into its frames; whether it met nothing, and whether it saturated a taxel when it was deepest.
fn press_into(
    scene: &Scene,
    rest: &RestPose,
    touch: &Touch,
    workspace: &mut Workspace,
    mut rows: ArrayViewMut2<f32>,
) -> (bool, bool) {
    let pose = touch.patch_from_object(rest);
    let n_frames = rows.nrows();
    let mut contact = None;
    for (frame, row) in rows.outer_iter_mut().enumerate() {
        let part = (frame + 1) as f64 / n_frames as f64;
        contact = press_to_depth(scene, &[pose], touch.depth * part, workspace);
        for (to, &from) in row.into_iter().zip(workspace.deflections()) {
            *to = from as f32;
        }
    }
    (
        contact.is_none(),
        contact.is_some_and(|c| c.n_saturated > 0),
    )
}
