//! Implementation of [`TouchSet`] for touches of pressed objects.

use crate::contact::saturation_limit;
use crate::engine::progress::{Progress, Silent};
use crate::error::Result;
use crate::objects::Model;
use crate::random::Seed;
use crate::studies::recognition::frames::frame_store::Frames;
use crate::studies::recognition::frames::reading::{TouchToRead, touches_to_read};
use crate::studies::recognition::frames::samples::sample_frames;
use crate::studies::recognition::frames::simulation::press_objects;
use crate::studies::recognition::frames::touch_set::{Samples, TouchSet};
use crate::studies::recognition::plan::group::MeasurementGroup;
use crate::studies::recognition::plan::pose_groups::KeepTogether;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use crate::studies::recognition::touches::drawn_touches::TouchedObject;
use crate::world::Touch;
use ndarray::Array1;
use rand::Rng;
use rayon::prelude::*;

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

    fn samples(&self, plan: &Plan, groups: &[MeasurementGroup]) -> Result<Samples> {
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
