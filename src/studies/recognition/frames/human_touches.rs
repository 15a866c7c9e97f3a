//! Human touches of a study, which are drawn once and recorded with each array; their pictures are film strips.

use crate::contact::{Press, Until, Workspace};
use crate::objects::Hand;
use crate::report::pictures::snapshots::Snapshots;
use crate::signal::Quantity;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{
    Frames, SAMPLED_TOUCHES, Samples, TouchSet, TouchToRead, named_samples, touches_to_read,
};
use crate::studies::recognition::spec::HumanTouchSpec;
use crate::world::{HumanTouch, Patch, TouchRanges};
use bubbletouch_sim::frame_coding::round_to_single;
use ndarray::{Array2, ArrayViewMut2};
use rand::Rng;
use rayon::prelude::*;

/// Human touches of a study, sorted by kind of touch, such as a stroke.
#[derive(Clone, Debug)]
pub struct HumanTouches {
    /// Kinds of touch to distinguish, and settings of the recording.
    pub spec: HumanTouchSpec,
    /// Touches in the order of their kinds; every kind has the same number of touches.
    pub touches: Vec<RecordedTouch>,
}

/// Human touch, and the time at which its motion starts within the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedTouch {
    /// Motion of the hand that touches the skin.
    pub touch: HumanTouch,
    /// Time from the first frame of the recording to the start of the hand's motion, seconds.
    pub onset: f64,
}

impl HumanTouches {
    /// Draws the touches of a study, each from its own random stream.
    ///
    /// # Errors
    /// If a touch is longer than a recording.
    pub fn draw(spec: &HumanTouchSpec, seed: &Seed) -> Result<Self> {
        let seed = seed.named("human touches");
        let kinds = spec.kinds.iter();
        let all = kinds.flat_map(|&kind| (0..spec.per_kind as u64).map(move |k| (kind, k)));
        let all: Vec<_> = all.collect();
        let touches = all.into_par_iter().map(|(kind, number)| {
            let seed = seed.named(kind.name()).numbered(number);
            let ranges = TouchRanges::usual(kind);
            let touch = HumanTouch::draw(kind, &ranges, spec.surface(), &seed)?;
            let spare = spec.duration() - touch.duration();
            if spare < 0.0 {
                let given = format!("{} s", spec.duration());
                let allowed = format!("more: a {} of {:.2} s", kind.name(), touch.duration());
                return Err(Error::input("key human_touch.duration_s", given, allowed));
            }
            let onset = seed.named("onset").rng().gen_range(0.0..=spare);
            Ok(RecordedTouch { touch, onset })
        });
        // The first touch that is too long is named, at any number of threads.
        let touches: Vec<Result<RecordedTouch>> = touches.collect();
        Ok(Self {
            spec: spec.clone(),
            touches: touches.into_iter().collect::<Result<_>>()?,
        })
    }

    /// Returns all touches of a kind, given by its number `label`.
    pub fn with_label(&self, label: usize) -> &[RecordedTouch] {
        &self.touches[label * self.spec.per_kind..][..self.spec.per_kind]
    }
}

/// Simulates the recording of a human touch. Returns its frames (shape (n_frames, n_taxels), metres), whether the hand missed the skin, and whether it
/// saturated a taxel.
pub fn record_touch(
    skin: &Patch,
    touch: &RecordedTouch,
    interval: f64,
    mut rows: ArrayViewMut2<f32>,
    workspace: &mut Workspace,
) -> (bool, bool) {
    let (mut is_missed, mut n_saturated) = (true, 0);
    // Most hands only move and keep their shape, so their spheres are reused.
    let mut shape: Option<(Hand, [Model; 1])> = None;
    for (frame, row) in rows.outer_iter_mut().enumerate() {
        let state = touch.touch.at(frame as f64 * interval - touch.onset);
        let known = shape.take().filter(|(hand, _)| *hand == state.hand);
        let (_, hand) =
            shape.insert(known.unwrap_or_else(|| (state.hand, [state.spheres().into()])));
        let contact = Press::new(skin, hand, &[state.patch_from_hand], Until::Pose)
            .with_contacts()
            .run(workspace);
        let contact = contact.expect("a hand has a finite pose");
        n_saturated += contact.map_or(0, |contact| contact.n_saturated);
        let row = row.into_slice().expect("rows are whole");
        round_to_single(workspace.deflections(), row);
        is_missed &= row.iter().all(|&deflection| deflection == 0.0);
    }
    (is_missed, n_saturated > 0)
}

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

    fn samples(&self, parts: &[(&Plan, &[MeasurementGroup])]) -> Result<Samples> {
        // In a tie, the first array.
        let plans = parts.iter().map(|(plan, _)| plan).rev();
        let finest = plans.max_by_key(|plan| plan.array.n_taxels());
        human_samples(finest.expect("at least one part"), self)
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

/// Number of frames in a film strip; a film strip is one row of the picture.
const N_FRAMES: usize = 4;

/// Number of touches of each kind that are compared; the picture shows the touch with the largest force. If only one touch were considered, a flat hand could
/// be represented by a touch of one fingertip.
const N_LOOKED_AT: usize = 10;

/// Returns film strips of the kinds of touch that the study lists for its picture; of all kinds if it lists none. Each strip shows the strongest of the first
/// touches of its kind at four times, evenly spaced between its first and its last contact, without noise.
///
/// # Errors
/// If the study lists an unknown kind of touch, or has an invalid skin.
pub fn human_samples(plan: &Plan, touches: &HumanTouches) -> Result<Samples> {
    let grid = plan.array.grid();
    let skin = touches.spec.skin(&plan.array)?;
    let interval = touches.spec.interval();
    let mut frames = Vec::new();
    let chosen = named_samples(plan, &touches.class_names())?;
    for label in chosen.unwrap_or_else(|| (0..touches.spec.kinds.len()).collect()) {
        let first = touches.with_label(label).par_iter().take(N_LOOKED_AT);
        let recorded = first.map_init(Workspace::new, |room, touch| {
            let mut rows = Array2::zeros((touches.spec.n_frames(), grid.n_taxels()));
            record_touch(&skin, touch, interval, rows.view_mut(), room);
            rows
        });
        let recorded = recorded.collect::<Vec<_>>().into_iter();
        let firmest = recorded.max_by(|a, b| a.sum().total_cmp(&b.sum()));
        let Some(rows) = firmest else { continue };
        let is_touched = |frame: &usize| rows.row(*frame).iter().any(|&d| d > 0.0);
        let touched: Vec<usize> = (0..rows.nrows()).filter(is_touched).collect();
        let (Some(&first), Some(&last)) = (touched.first(), touched.last()) else {
            continue;
        };
        for part in 0..N_FRAMES {
            let frame = first + (part * (last - first) + N_FRAMES / 2) / (N_FRAMES - 1);
            let seconds = (frame - first) as f64 * interval;
            let name = format!("{} {seconds:.2} s", touches.spec.kinds[label].name());
            let row = rows.row(frame).mapv(f64::from);
            let frame = row.into_shape_with_order((grid.ny, grid.nx));
            let frame = frame.expect("one value a taxel");
            frames.push((name, frame));
        }
    }
    let pitch_mm = millimetres(grid.pitch);
    let shown = Snapshots {
        frames,
        pitch_mm,
        quantity: Quantity::Deflection,
        caption: format!(
            "One touch of each kind by a hand on {} × {} taxels at {pitch_mm} mm around a forearm (x around it, y along it), no noise",
            grid.nx, grid.ny
        ),
    };
    Ok(Samples { shown, each: None })
}
