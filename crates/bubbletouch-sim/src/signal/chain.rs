//! Signal chain: prepared signal steps, applied in the order in which the study lists them.

use super::force::Force;
use super::noise::NoiseOfFrames;
use super::step::seed_of_repetition;
use super::surface_smoothing::SurfaceSmoothing;
use super::{Effect, Quantity, SignalStep, Skin, Smoothing, TouchRead};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::world::{Patch, Taxel};
use std::sync::Arc;

/// Checked signal steps (force, noise, sensor errors, smoothing), prepared for one patch of any layout. An empty chain leaves deflections unchanged.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::signal::{Chain, Noise, NoiseUnit, SignalWorkspace, SignalStep};
/// use bubbletouch_sim::world::{Grid, Patch, Taxel};
///
/// let grid = Grid { nx: 8, ny: 8, pitch: 2e-3 };
/// let taxel = Taxel { radius: 1e-3, stiffness: 200.0, damping: 0.0, stroke: 5e-3 };
/// let noise = Noise { std: 0.1, unit: NoiseUnit::FullScale };
/// let steps = [SignalStep::Noise(noise), SignalStep::Smoothing { width: 4e-3 }];
/// let chain = Chain::new(&steps, &Patch::grid(grid, taxel)?)?;
///
/// let mut frame = vec![1e-3; 64];
/// chain.apply(&mut frame, None, &Seed::new(2018).named("mug").numbered(17), &mut SignalWorkspace::default());
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Chain {
    steps: Vec<Prepared>,
    /// Number of leading signal steps that also process the frames before a touch. The last of these steps depends on earlier frames. 0 if no step depends on
    /// earlier frames.
    n_remembering: usize,
    n_taxels: usize,
    taxel: Taxel,
    quantity: Quantity,
    scratch_len: usize,
}

/// Input of a signal chain: the deflections of one touch, and the metadata that the signal steps need.
#[derive(Debug)]
pub struct Recording<'a> {
    /// Deflections, metres, shape (n_frames, n_taxels), frames in the order of time. The chain replaces them by the readings.
    pub frames: &'a mut [f64],
    /// Rates of deflection δ̇, m/s, one per deflection; `None` if the patch does not move. Only the force step uses the rates.
    pub rates: Option<&'a [f64]>,
    /// Number of leading frames recorded before the touch. If the chain depends on history, these frames change the readings of the touch. Their own values
    /// have no meaning after the chain.
    pub n_before: usize,
    /// Time between frames, seconds; `None` if the press stops at each frame until all taxels are read.
    pub interval: Option<f64>,
    /// Time of the touch, as a fraction of the recording session from 0 to 1. If `None`, the time is random and depends on the seed of the touch.
    pub time: Option<f64>,
}

/// Scratch memory of a chain: one per thread, usable with any chain. The memory grows to the size that the largest chain needs.
#[derive(Clone, Debug, Default)]
pub struct SignalWorkspace(Vec<f64>);

/// Signal step, prepared for one patch: units are resolved and weights are computed.
#[derive(Clone, Debug)]
struct Prepared {
    effect: Arc<dyn Effect>,
    /// Number of earlier steps of the same sensor error; `None` for force and noise.
    repetition: Option<u64>,
}

impl Chain {
    /// Checks the signal steps in their order and prepares them for the layout and the taxels of a patch.
    ///
    /// # Errors
    /// If force is listed twice, or a noise level or its unit does not fit the frame at this step. Also if a strength is out of range, the taxels differ in
    /// stroke, stiffness or damping, or the layout does not support a step.
    pub fn new(steps: &[SignalStep], patch: &Patch) -> Result<Self> {
        Self::with_quantity(steps, patch, Quantity::Deflection)
    }

    /// Prepares a chain for frames that initially contain `quantity` instead of deflections.
    ///
    /// # Errors
    /// If the arguments are invalid, as for `new`.
    pub fn with_quantity(steps: &[SignalStep], patch: &Patch, quantity: Quantity) -> Result<Self> {
        Self::prepared(steps, patch, quantity, false)
    }

    /// Prepares a chain for shear forces: newtons of either sign. The full scale equals the full scale of the normal force. The frames are forces from the
    /// start, so the force step has no effect.
    ///
    /// # Errors
    /// If the arguments are invalid, as for `new`.
    pub fn of_shear(steps: &[SignalStep], patch: &Patch) -> Result<Self> {
        let mut steps = steps.to_vec();
        steps.retain(|step| *step != SignalStep::Force);
        Self::prepared(&steps, patch, Quantity::Force, true)
    }

    /// Adds an effect from outside of this crate, such as an own sensor error, as the last step.
    ///
    /// ```
    /// use bubbletouch_sim::random::Seed;
    /// use bubbletouch_sim::signal::{Chain, Effect, SignalWorkspace, TouchRead};
    /// use bubbletouch_sim::world::{Grid, Patch, Taxel};
    ///
    /// /// Readings below a threshold, metres, are 0.
    /// #[derive(Debug)]
    /// struct DeadZone(f64);
    ///
    /// impl Effect for DeadZone {
    ///     fn apply(&self, frames: &mut [f64], _: &TouchRead, _: &mut [f64]) {
    ///         frames.iter_mut().filter(|value| **value < self.0).for_each(|value| *value = 0.0);
    ///     }
    /// }
    ///
    /// let grid = Grid { nx: 2, ny: 1, pitch: 2e-3 };
    /// let taxel = Taxel { radius: 1e-3, stiffness: 200.0, damping: 0.0, stroke: 5e-3 };
    /// let chain = Chain::new(&[], &Patch::grid(grid, taxel)?)?.then(DeadZone(1e-4));
    /// let mut frame = vec![2e-3, 5e-5];
    /// chain.apply(&mut frame, None, &Seed::new(2018), &mut SignalWorkspace::default());
    /// assert_eq!(frame, [2e-3, 0.0]);
    /// # Ok::<(), bubbletouch_sim::Error>(())
    /// ```
    pub fn then(mut self, effect: impl Effect + 'static) -> Self {
        let is_error = |step: &&Prepared| step.repetition.is_some();
        let n_errors = self.steps.iter().filter(is_error).count() as u64;
        let remembers = effect.remembers();
        self.push(Box::new(effect), Some(n_errors), remembers);
        self
    }

    /// Returns the full scale of the output frames: the stroke in metres, or the force at the stroke in newtons.
    pub fn full_scale(&self) -> f64 {
        self.quantity.full_scale(&self.taxel)
    }

    fn prepared(
        steps: &[SignalStep],
        patch: &Patch,
        quantity: Quantity,
        is_signed: bool,
    ) -> Result<Self> {
        let mut chain = Self {
            steps: Vec::new(),
            n_remembering: 0,
            n_taxels: patch.n_taxels(),
            taxel: read_alike(patch)?,
            quantity,
            scratch_len: 0,
        };
        for (place, step) in steps.iter().enumerate() {
            let repetition = step.repetition(&steps[..place]);
            let remembers = step.remembers();
            match step {
                SignalStep::Force if chain.quantity == Quantity::Force => {
                    let allowed = "force at most once";
                    return Err(Error::input("signal steps", "force twice", allowed));
                }
                SignalStep::Force => {
                    chain.quantity = Quantity::Force;
                    chain.push(Box::new(Force(chain.taxel)), None, remembers);
                }
                SignalStep::Noise(noise) => {
                    let std = noise.std_of(chain.quantity, &chain.taxel)?;
                    let place = repetition + 1;
                    chain.push(Box::new(NoiseOfFrames { std, place }), None, remembers);
                }
                SignalStep::Smoothing { width } => {
                    chain.push(smoothing(*width, patch)?, Some(0), remembers);
                }
                SignalStep::Error { strengths, .. } if strengths.iter().all(|&s| s == 0.0) => {}
                SignalStep::Error {
                    error,
                    strengths,
                    skin: name,
                } => {
                    let full_scale = chain.full_scale();
                    let skin = Skin {
                        patch,
                        full_scale,
                        least: if is_signed { -full_scale } else { 0.0 },
                        name: seed_of_repetition(name, repetition),
                    };
                    let about = error.about();
                    about.check(strengths)?;
                    let effect = (about.prepare)(strengths, &skin)?;
                    chain.push(effect, Some(repetition), remembers);
                }
            }
        }
        Ok(chain)
    }

    /// Adds a step. `remembers` states whether the step also processes the frames before a touch.
    fn push(&mut self, effect: Box<dyn Effect>, repetition: Option<u64>, remembers: bool) {
        self.scratch_len = self.scratch_len.max(effect.scratch_len());
        self.steps.push(Prepared {
            effect: effect.into(),
            repetition,
        });
        if remembers {
            self.n_remembering = self.steps.len();
        }
    }

    /// Returns the physical quantity of the output frames: deflection or force.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Returns whether the frames before a touch change the readings of the touch.
    pub fn remembers(&self) -> bool {
        self.n_remembering > 0
    }

    /// Converts the deflections of a touch with a single frame to readings, in place.
    ///
    /// The function is equivalent to `apply_recording` with one frame (metres, one value per taxel) and no earlier frames.
    ///
    /// # Panics
    /// If the frame or the rates do not have one number per taxel.
    pub fn apply(
        &self,
        frame: &mut [f64],
        rates: Option<&[f64]>,
        touch: &Seed,
        scratch: &mut SignalWorkspace,
    ) {
        assert_eq!(frame.len(), self.n_taxels(), "one value for each taxel");
        let recording = Recording {
            frames: frame,
            rates,
            n_before: 0,
            interval: None,
            time: None,
        };
        self.apply_recording(recording, touch, scratch);
    }

    /// Converts the deflections of a touch to readings, in place.
    ///
    /// `touch` seeds the random streams of the touch. The last frame uses `touch` itself and earlier frames use derived seeds.
    /// The noise of the last frame therefore does not depend on the number of frames before it.
    /// The function allocates no memory if `scratch` has already been used with this chain.
    ///
    /// # Panics
    /// If a frame is incomplete, there are no frames after the leading `n_before`, or the number of rates differs from the number of values.
    pub fn apply_recording(
        &self,
        recording: Recording,
        touch: &Seed,
        scratch: &mut SignalWorkspace,
    ) {
        let Recording { frames, rates, .. } = recording;
        let n_taxels = self.n_taxels;
        let first = recording.n_before * n_taxels;
        assert!(
            frames.len() > first && frames.len().is_multiple_of(n_taxels),
            "one value for each taxel"
        );
        if scratch.0.len() < self.scratch_len {
            scratch.0.resize(self.scratch_len, 0.0);
        }
        for (place, step) in self.steps.iter().enumerate() {
            // The history is not needed after the last step that depends on it.
            let from = if place < self.n_remembering { 0 } else { first };
            let touch = TouchRead {
                n_taxels,
                rates: rates.map(|rates| &rates[from..]),
                n_before: (first - from) / n_taxels,
                interval: recording.interval,
                time: recording.time,
                seed: &seed_of_repetition(touch, step.repetition.unwrap_or(0)),
            };
            step.effect
                .apply(&mut frames[from..], &touch, &mut scratch.0);
        }
    }

    /// Returns the number of values in a frame, which is the number of taxels.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }
}

/// Prepares smoothing along the rows and columns of a grid, or along the surface of another layout.
fn smoothing(width: f64, patch: &Patch) -> Result<Box<dyn Effect>> {
    Ok(match patch.whole_grid() {
        Some(grid) => Box::new(Smoothing::new(width, grid)?),
        None => Box::new(SurfaceSmoothing::new(width, patch)?),
    })
}

/// Returns the stroke, stiffness and damping that all taxels of a patch have in common; the radii may differ.
///
/// # Errors
/// If taxels differ in stroke, stiffness or damping, because a fraction of the full scale would then differ between them.
fn read_alike(patch: &Patch) -> Result<Taxel> {
    let reads = |taxel: &Taxel| (taxel.stroke, taxel.stiffness, taxel.damping);
    let first = *patch.taxels().at(0);
    let mut others = patch.taxels().all().iter();
    match others.all(|other| reads(other) == reads(&first)) {
        true => Ok(first),
        false => Err(Error::input(
            format!("signal of skin patch {}", patch.name()),
            "taxels of unlike stroke, stiffness or damping",
            "taxels that read alike",
        )),
    }
}
