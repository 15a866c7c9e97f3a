//! Deflections on a model, and their comparison with the deflections on the exact mesh.

use crate::contact::{Press, Until, Workspace};
use crate::studies::prelude::*;
use crate::studies::shared_steps::median_s;

/// Summary of |δ − δ\*| over taxels, where δ is the deflection by a model and δ\* the deflection by the exact object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct DeflectionError {
    /// Mean of |δ − δ\*| over all touched taxels, mm, where δ is the deflection on the model and δ\* on the mesh.
    pub mean_mm: f64,
    /// 95th percentile of |δ − δ\*| over all touched taxels, mm, where δ is the deflection on the model and δ\* on the mesh.
    pub p95_mm: f64,
}

impl DeflectionError {
    /// Computes the mean and the 95th percentile of the errors of single taxels, given in metres. If there are no taxels, both statistics are 0.
    pub fn new(mut errors: Vec<f64>) -> Self {
        Self {
            mean_mm: in_mm(mean(&errors)),
            p95_mm: in_mm(quantile(&mut errors, 0.95)),
        }
    }
}

/// Converts metres to millimetres without rounding.
pub(super) fn in_mm(metres: f64) -> f64 {
    1e3 * metres
}

fn mean(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |sum, error| sum + error) / errors.len().max(1) as f64
}

/// Touches of the exact object with the deflections of their taxels, which serve as reference.
pub(super) struct Truth {
    array: TaxelArray,
    /// Touches that reached the exact object, each with the deflections of its taxels.
    pub readings: Vec<Reading>,
    /// Number of touches in which the array misses the object.
    pub n_missed: usize,
    /// Number of touched taxels, summed over all touches of the exact object.
    pub n_touched: usize,
}

/// Touch of the exact object, with the deflections of its taxels.
pub(super) struct Reading {
    patch_from_object: Pose,
    /// Distance that the patch travels past its first contact with the exact object, metres.
    pub depth: f64,
    travel: f64,
    deflections: Vec<f64>,
}

/// Number of patch offsets on the coarse grid from which the search for the best offset starts. With a smaller value, the search may end in a local minimum.
const N_OFFSETS: usize = 48;
/// Approximate number of golden-section steps that refine the best patch offset.
const N_STEPS: usize = 30;
/// Number of times that each touch is repeated to measure its computing time.
const N_REPEATS: usize = 3;

/// Reason why a press of a reading cannot fail: the touch of the exact model had the same numbers.
const CHECKED: &str = "poses and travels of readings are finite";

impl Truth {
    /// Computes the touches of the exact model of an object. The poses are those in which other studies touch an object of this name.
    pub fn new(
        (name, exact): (&str, Model),
        array: &TaxelArray,
        placement: &Placement,
        seed: &Seed,
    ) -> Result<Self> {
        let object = Object::of_one_part(name, exact);
        let touched = draw_touches(vec![object], placement, seed)?.swap_remove(0);
        let object = std::slice::from_ref(&touched.object.model);
        let mut workspace = Workspace::new();
        let mut truth = Self {
            array: array.clone(),
            readings: Vec::new(),
            n_missed: 0,
            n_touched: 0,
        };
        for touch in &touched.touches {
            let pose = touch.patch_from_object(&touched.rests[touch.rest]);
            let contact = Press::new(array.patch(), object, &[pose], Until::Depth(touch.depth))
                .run(&mut workspace)?;
            let Some(contact) = contact else {
                truth.n_missed += 1;
                continue;
            };
            truth.n_touched += contact.n_touched;
            truth.readings.push(Reading {
                patch_from_object: pose,
                depth: touch.depth,
                travel: contact.travel,
                deflections: workspace.deflections().to_vec(),
            });
        }
        Ok(truth)
    }

    /// Returns the deflection error of a model in the poses of the exact object's touches. The patch is retracted by `offset` metres along its axis.
    pub fn error(&self, model: &Model, offset: f64) -> DeflectionError {
        DeflectionError::new(self.errors(model, offset))
    }

    /// Returns the deflection error of a model for touches with equal depths past first contact on model and mesh. A study that contains only the model makes
    /// this error.
    pub fn error_past_own_contact(&self, model: &Model) -> DeflectionError {
        let (patch, object) = (self.array.patch(), std::slice::from_ref(model));
        DeflectionError::new(self.errors_of(|pose, reading, workspace| {
            Press::new(patch, object, pose, Until::Depth(reading.depth))
                .run(workspace)
                .map(drop)
        }))
    }

    /// Returns the retraction of the patch that minimises a model's deflection error over all touches, metres. The error there is at most the error without
    /// retraction.
    pub fn best_offset(&self, model: &Model) -> f64 {
        let cost = |offset| mean(&self.errors(model, offset));
        let Some((low, high)) = self.offset_range(model) else {
            return 0.0;
        };
        let step = (high - low) / (N_OFFSETS - 1) as f64;
        let tried = (0..N_OFFSETS).map(|k| low + k as f64 * step);
        let costs = tried.map(|offset| (offset, cost(offset)));
        let least = |best: (f64, f64), next: (f64, f64)| if next.1 < best.1 { next } else { best };
        let start = costs.fold((0.0, cost(0.0)), least);
        let refined = golden_section(start.0 - step, start.0 + step, cost);
        least(start, (refined, cost(refined))).0
    }

    /// Returns the median computing time of a touch on one thread, s; 0 if there are no touches.
    pub fn seconds_per_touch(&self, model: &Model) -> f64 {
        let (patch, object) = (self.array.patch(), std::slice::from_ref(model));
        let mut workspace = Workspace::new();
        let mut press = |reading: &Reading| {
            let pose = [reading.patch_from_object];
            Press::new(patch, object, &pose, Until::Depth(reading.depth))
                .run(&mut workspace)
                .expect(CHECKED);
        };
        // One run before the measurement allocates the workspace and fills the caches.
        self.readings.iter().for_each(&mut press);
        median_s((0..N_REPEATS).flat_map(|_| &self.readings), press)
    }

    /// Returns |δ − δ\*| in metres for each touched taxel of all touches, where δ is the deflection by the model and δ\* by the mesh. The patch is retracted by
    /// `offset` metres.
    fn errors(&self, model: &Model, offset: f64) -> Vec<f64> {
        let (patch, object) = (self.array.patch(), std::slice::from_ref(model));
        self.errors_of(|pose, reading, workspace| {
            Press::new(patch, object, pose, Until::Travel(reading.travel - offset))
                .run(workspace)
                .map(drop)
        })
    }

    /// Returns |δ − δ\*| in metres for each touched taxel, where δ is the deflection by the model and δ\* by the mesh. The function `press` computes the
    /// deflections on the model.
    fn errors_of(
        &self,
        press: impl Fn(&[Pose], &Reading, &mut Workspace) -> Result<()>,
    ) -> Vec<f64> {
        let mut workspace = Workspace::new();
        let mut errors = Vec::new();
        for reading in &self.readings {
            press(&[reading.patch_from_object], reading, &mut workspace).expect(CHECKED);
            errors.extend(reading.errors(workspace.deflections()));
        }
        errors
    }

    /// Returns the smallest and the largest patch retraction that can reduce the error of a model, metres. Outside of this range, every touch misses the model,
    /// or is deeper on the model than on the mesh at every taxel.
    fn offset_range(&self, model: &Model) -> Option<(f64, f64)> {
        let (patch, object) = (self.array.patch(), std::slice::from_ref(model));
        let mut workspace = Workspace::new();
        let ahead = self.readings.iter().filter_map(|reading| {
            let pose = [reading.patch_from_object];
            let touch = Press::new(patch, object, &pose, Until::Depth(0.0)).run(&mut workspace);
            let first_contact = touch.expect(CHECKED)?.travel;
            let ahead = reading.travel - reading.depth - first_contact;
            Some((ahead - reading.depth, ahead + reading.depth))
        });
        ahead.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

impl Reading {
    /// Returns |δ − δ\*| in metres for each touched taxel, where δ is the deflection by the model and δ\* by the mesh. The slice `deflection` contains the
    /// deflections δ, metres, shape (n_taxels,).
    pub fn errors<'a>(&'a self, deflection: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let pairs = deflection.iter().zip(&self.deflections);
        let touched = pairs.filter(|(model, mesh)| **model > 0.0 || **mesh > 0.0);
        touched.map(|(model, mesh)| (model - mesh).abs())
    }
}

/// Returns an approximate minimiser of a unimodal function on an interval (golden-section search).
fn golden_section(mut low: f64, mut high: f64, cost: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5_f64.sqrt() - 1.0);
    let (mut left, mut right) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut left_cost, mut right_cost) = (cost(left), cost(right));
    for _ in 0..N_STEPS {
        if left_cost <= right_cost {
            (high, right, right_cost) = (right, left, left_cost);
            left = high - ratio * (high - low);
            left_cost = cost(left);
        } else {
            (low, left, left_cost) = (left, right, right_cost);
            right = low + ratio * (high - low);
            right_cost = cost(right);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_section_finds_the_bottom_of_a_valley() {
        let found = golden_section(-1.0, 2.0, |x| (x - 0.7).abs());
        assert!((found - 0.7).abs() < 1e-5, "{found}");
    }
}
