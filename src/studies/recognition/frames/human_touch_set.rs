//! Implementation of [`TouchSet`] for human touches.

use crate::contact::Workspace;
use crate::engine::progress::{Progress, Silent};
use crate::error::Result;
use crate::random::Seed;
use crate::studies::recognition::frames::frame_store::Frames;
use crate::studies::recognition::frames::human_samples::human_samples;
use crate::studies::recognition::frames::human_touches::{HumanTouches, record_touch};
use crate::studies::recognition::frames::pressed_objects::SAMPLED_TOUCHES;
use crate::studies::recognition::frames::reading::{TouchToRead, touches_to_read};
use crate::studies::recognition::frames::touch_set::{Samples, TouchSet};
use crate::studies::recognition::plan::group::MeasurementGroup;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use ndarray::ArrayViewMut2;

impl HumanTouches {
    /// Simulates at most `n_touches` touches of each kind.
    fn simulated(
        &self,
        (array, n_frames): (&TaxelArray, usize),
        n_touches: usize,
        progress: &dyn Progress,
    ) -> Frames {
        let skin = self.spec.skin(array);
        let skin = skin.expect("the plan has checked that it fits");
        let interval = self.spec.interval();
        let mut frames = Frames::new((array.n_taxels(), n_frames));
        let record = |touch: &&_, workspace: &mut _, rows: ArrayViewMut2<f32>| {
            record_touch(&skin, touch, interval, rows, workspace)
        };
        let step = self.spec.per_kind.div_ceil(n_touches).max(1);
        let touches: Vec<_> = self.touches.iter().step_by(step).collect();
        frames.make(&touches, Workspace::new, record, progress);
        frames
    }
}

impl TouchSet for HumanTouches {
    fn classes(&self) -> Vec<(&str, usize)> {
        let kinds = self.spec.kinds.iter();
        kinds
            .map(|kind| (kind.name(), self.spec.per_kind))
            .collect()
    }

    fn simulate(&self, on: (&TaxelArray, usize), progress: &dyn Progress) -> Frames {
        self.simulated(on, usize::MAX, progress)
    }

    fn frame_bytes(&self, on: (&TaxelArray, usize)) -> f64 {
        self.simulated(on, SAMPLED_TOUCHES, &Silent).mean_bytes()
    }

    fn to_read(&self, _speed: f64, _n_frames: usize, seed: &Seed) -> Vec<TouchToRead> {
        let mut touches = touches_to_read(self.classes(), seed);
        for touch in &mut touches {
            touch.interval = Some(self.spec.interval());
        }
        touches
    }

    fn samples(&self, plan: &Plan, _groups: &[MeasurementGroup]) -> Result<Samples> {
        human_samples(plan, self)
    }

    fn settings(&self) -> Vec<(String, String)> {
        let row = |name: &str, value: String| (name.to_owned(), value);
        let names = self.class_names();
        let hz = 1.0 / self.spec.interval();
        let kinds = format!("{}: {}", names.len(), names.join(", "));
        let frames = format!("{} at {hz:.0} Hz", self.spec.n_frames());
        let arm = format!("{:.0} mm across", 2e3 * self.spec.surface());
        vec![
            row("Kinds of touch", kinds),
            row("Frames a touch", frames),
            row("Arm", arm),
        ]
    }
}
