//! Simulation of all touches on an array, whose result all configurations share.

use crate::contact::Contact;
use crate::engine::progress::Progress;
use crate::studies::recognition::frames::array_press::ArrayWorkspace;
use crate::studies::recognition::frames::frame_store::Frames;
use crate::studies::recognition::frames::touch_set::TouchSet;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use crate::studies::recognition::touches::drawn_touches::TouchedObject;
use crate::world::Touch;
use ndarray::ArrayViewMut2;

/// Simulates all touches on an array and stores their frames in memory.
pub fn simulate_array(
    touched: &dyn TouchSet,
    array: &TaxelArray,
    n_frames: usize,
    progress: &dyn Progress,
) -> Frames {
    touched.simulate((array, n_frames), progress)
}

/// Presses one array on every object, touch by touch; the results do not depend on the number of threads.
///
/// A touch to depth d consists of F = `n_frames` frames, read at the depths d/F, 2d/F, …, d. If the array slides, the frames are read at F points of its path.
/// Each frame is simulated as a separate touch, because a taxel at rest has no memory. At most `n_touches` touches of each object are simulated.
pub(crate) fn press_objects(
    touched: &[TouchedObject],
    (array, n_frames): (&TaxelArray, usize),
    n_touches: usize,
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
            |touch: &&Touch, workspace: &mut ArrayWorkspace, mut rows: ArrayViewMut2<f32>| {
                let pose = touch.patch_from_object(&rests[touch.rest]);
                let mut last = None;
                for (frame, row) in rows.outer_iter_mut().enumerate() {
                    let part = (frame + 1) as f64 / n_frames as f64;
                    last = press.touch(pose, (touch.depth, part), workspace);
                    press.write_values(workspace, row.into_slice().expect("rows are whole"));
                }
                let reads_any = |count: fn(Contact) -> usize| last.is_some_and(|c| count(c) > 0);
                (!reads_any(|c| c.n_touched), reads_any(|c| c.n_saturated))
            };
        let step = touches.len().div_ceil(n_touches).max(1);
        let touches: Vec<&Touch> = touches.iter().step_by(step).collect();
        frames.make(&touches, ArrayWorkspace::default, press, progress);
    }
    frames
}
