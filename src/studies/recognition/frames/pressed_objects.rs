//! Touches of pressed objects: an array is pressed on an object and slides along it. All configurations share the frames.

use crate::contact::{Contact, FrictionState, Press, Until, Workspace, saturation_limit};
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{
    Frames, Samples, TouchSet, TouchToRead, sample_frames, touches_to_read,
};
use crate::studies::recognition::plan::{KeepTogether, Sensed};
use crate::world::Shears;
use bubbletouch_sim::frame_coding::round_to_single;
use glam::{DVec2, DVec3};
use ndarray::{Array1, ArrayViewMut2};
use rand::Rng;
use rayon::prelude::*;

/// Memory that a thread reuses for every touch that it simulates.
#[derive(Debug, Default)]
pub struct ArrayWorkspace {
    press: Workspace,
    /// Friction state of the array's taxels; `None` if the array has no friction.
    friction: Option<FrictionState>,
}

impl ArrayWorkspace {
    /// Returns the force vector on each taxel in the last touch, newtons; empty if the array does not read shear forces.
    pub fn shear_forces(&self) -> &[DVec3] {
        let friction = self.friction.as_ref();
        friction.map_or(&[], FrictionState::force3)
    }
}

/// Array that is prepared for touches of one object.
pub struct ArrayPress<'a> {
    array: &'a TaxelArray,
    object: [Model; 1],
}

impl TaxelArray {
    /// Prepares the array for touches of one object.
    pub fn press<'a>(&'a self, object: &Model) -> ArrayPress<'a> {
        ArrayPress {
            array: self,
            object: [object.clone()],
        }
    }
}

/// Reason why a press of a study cannot fail.
const CHECKED: &str = "the plan has checked poses and depths";

impl ArrayPress<'_> {
    /// Presses the array by a distance past first contact, metres, and then slides it along the object. Only the first part of this path is simulated; `part`
    /// is its fraction of the whole path. Returns `None` if the path misses the object.
    ///
    /// # Panics
    /// If a number of the pose or of the depth is not finite; the plan of a study has checked them.
    pub fn touch(
        &self,
        pose: Pose,
        (depth, part): (f64, f64),
        workspace: &mut ArrayWorkspace,
    ) -> Option<Contact> {
        let (patch, slide) = (self.array.patch(), self.array.slide());
        let way = part * (depth + slide.length());
        let ArrayWorkspace { press, friction } = workspace;
        if let Sensed::Shear(shear) = *self.array.sensed() {
            let at_rest = || FrictionState::at_rest(patch, Shears::Equal(shear));
            friction.get_or_insert_with(|| at_rest().expect("checked shear springs"));
        } else if slide == DVec2::ZERO {
            return Press::new(patch, &self.object, &[pose], Until::Depth(way))
                .run(press)
                .expect(CHECKED);
        }
        let slid = (way - depth).max(0.0) * slide.normalize_or_zero();
        let pressed = Press::new(patch, &self.object, &[pose], Until::Depth(way.min(depth))).slide(
            slid.extend(0.0),
            friction.as_mut(),
            press,
        );
        pressed.expect(CHECKED)
    }

    /// Simulates the frames of a touch, shape (F, n_values), which are read at even parts of its path. Returns the contact at its end.
    pub(crate) fn write_frames(
        &self,
        pose: Pose,
        depth: f64,
        mut rows: ArrayViewMut2<f32>,
        workspace: &mut ArrayWorkspace,
    ) -> Option<Contact> {
        let n_frames = rows.nrows();
        let mut last = None;
        for (frame, row) in rows.outer_iter_mut().enumerate() {
            let part = (frame + 1) as f64 / n_frames as f64;
            last = self.touch(pose, (depth, part), workspace);
            self.write_values(workspace, row.into_slice().expect("rows are whole"));
        }
        last
    }

    /// Returns the pose of the object, in the patch frame, at the end of a touch that starts at `pose`.
    pub fn end(&self, mut pose: Pose, contact: Option<Contact>) -> Pose {
        if let Some(contact) = contact {
            pose.translation -= self.array.slide().extend(contact.travel);
        }
        pose
    }

    /// Returns the number of values that are read per frame of a touch: deflections and shear forces of all taxels.
    pub fn n_values(&self) -> usize {
        self.array.n_values()
    }

    /// Writes the readings of the last touch in f32: [`n_values`](TaxelArray::n_values) deflections in metres, then the shear forces (if read) in newtons.
    pub fn write_values(&self, workspace: &ArrayWorkspace, out: &mut [f32]) {
        let (deflections, shear) = out.split_at_mut(self.array.patch().n_taxels());
        round_to_single(workspace.press.deflections(), deflections);
        if let Some(forces) = &workspace.friction {
            forces.write_lateral(shear);
        }
    }
}

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
        let press = |touch: &&Touch, workspace: &mut ArrayWorkspace, rows: ArrayViewMut2<f32>| {
            let pose = touch.patch_from_object(&rests[touch.rest]);
            let last = press.write_frames(pose, touch.depth, rows, workspace);
            let reads_any = |count: fn(Contact) -> usize| last.is_some_and(|c| count(c) > 0);
            (!reads_any(|c| c.n_touched), reads_any(|c| c.n_saturated))
        };
        let step = touches.len().div_ceil(n_touches).max(1);
        let touches: Vec<&Touch> = touches.iter().step_by(step).collect();
        frames.make(&touches, ArrayWorkspace::default, press, progress);
    }
    frames
}

/// Maximum number of touches of each object, or of each kind of human touch, that are simulated to estimate the size of a frame. With a larger value, plans take
/// longer; with a smaller value, the estimate of the memory is less accurate.
pub(super) const SAMPLED_TOUCHES: usize = 4;

impl TouchSet for Vec<TouchedObject> {
    fn classes(&self) -> Vec<(&str, usize)> {
        let classes = self.iter();
        let classes = classes.map(|t| (t.object.name.as_str(), t.touches.len()));
        classes.collect()
    }

    fn group_keys(&self, together: &KeepTogether) -> Result<Array1<usize>> {
        let touches: Vec<&[Touch]> = self.iter().map(|t| &t.touches[..]).collect();
        together.groups(&touches)
    }

    fn poses(&self) -> Vec<&Touch> {
        self.iter().flat_map(|touched| &touched.touches).collect()
    }

    fn prepare(&self) {
        self.par_iter().for_each(|t| t.object.model.prepare());
    }

    fn simulate(&self, on: (&TaxelArray, usize), progress: &dyn Progress) -> Frames {
        press_objects(self, on, usize::MAX, progress)
    }

    fn frame_bytes(&self, on: (&TaxelArray, usize)) -> f64 {
        press_objects(self, on, SAMPLED_TOUCHES, &Silent).mean_bytes()
    }

    fn to_read(&self, speed: f64, n_frames: usize, seed: &Seed) -> Vec<TouchToRead> {
        let mut touches = touches_to_read(self.classes(), seed);
        let n_touches = touches.len();
        let depths = self.iter().flat_map(|t| &t.touches).map(|t| t.depth);
        for (touch, depth) in touches.iter_mut().zip(depths) {
            touch.interval = (speed > 0.0).then(|| depth / (n_frames as f64 * speed));
            let mut rng = touch.seed.named("before").rng();
            touch.before = Some(rng.gen_range(0..n_touches));
        }
        touches
    }

    fn samples(&self, parts: &[(&Plan, &[MeasurementGroup])]) -> Result<Samples> {
        let finest = parts.iter().max_by_key(|(plan, _)| plan.array.n_taxels());
        let (plan, groups) = finest.expect("at least one part");
        sample_frames(plan, groups, self)
    }

    fn n_deeper_than(&self, stroke: f64) -> usize {
        let touches = self.iter().flat_map(|t| &t.touches);
        let limit = saturation_limit(stroke);
        touches.filter(|touch| touch.depth > limit).count()
    }

    fn settings(&self) -> Vec<(String, String)> {
        let names = self.class_names();
        let row = |name: &str, value: String| (name.to_owned(), value);
        let objects = format!("{}: {}", names.len(), names.join(", "));
        let mut rows = vec![row("Objects", objects)];
        type Count = fn(&Model) -> usize;
        let counted: [(&str, Count); 2] = [
            ("Spheres an object", Model::n_spheres),
            ("Triangles an object", Model::n_triangles),
        ];
        for (name, count) in counted {
            let counts = || self.iter().map(|t| count(&t.object.model));
            let counts = || counts().filter(|&n| n > 0);
            if let (Some(least), Some(most)) = (counts().min(), counts().max()) {
                rows.push(row(name, format!("{least} to {most}")));
            }
        }
        rows
    }
}
