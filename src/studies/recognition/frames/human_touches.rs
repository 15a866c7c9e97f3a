//! Human touches of a study, which are drawn once and recorded with each array.

use crate::contact::{Workspace, press_with_contacts};
use crate::error::{Error, Result};
use crate::objects::{Hand, Model};
use crate::random::Seed;
use crate::studies::recognition::spec::human::HumanTouchSpec;
use crate::world::{HumanTouch, Patch, TouchRanges};
use bubbletouch_sim::frame_coding::round_to_single;
use ndarray::ArrayViewMut2;
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
        let contact = press_with_contacts(skin, hand, &[state.patch_from_hand], workspace);
        let contact = contact.expect("a hand has a finite pose");
        n_saturated += contact.map_or(0, |contact| contact.n_saturated);
        let row = row.into_slice().expect("rows are whole");
        round_to_single(workspace.deflections(), row);
        is_missed &= row.iter().all(|&deflection| deflection == 0.0);
    }
    (is_missed, n_saturated > 0)
}
