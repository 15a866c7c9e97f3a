//! Signal steps in the order in which the study lists them.

use super::surface_smoothing::SurfaceSmoothing;
use super::{Effect, Quantity, SignalStep, Skin, Smoothing, TouchRead, force, noise};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::world::{Patch, Taxel};
use std::sync::Arc;

/// Checked signal steps, prepared for one patch of any layout. The empty chain leaves deflections as they are.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::signal::{Chain, Noise, NoiseUnit, Scratch, SignalStep};
/// use bubbletouch_sim::world::{Grid, Patch, Taxel};
///
/// let grid = Grid { nx: 8, ny: 8, pitch: 2e-3 };
/// let taxel = Taxel { radius: 1e-3, stiffness: 200.0, damping: 0.0, stroke: 5e-3 };
/// let noise = Noise { std: 0.1, unit: NoiseUnit::FullScale };
/// let steps = [SignalStep::Noise(noise), SignalStep::Smoothing { width: 4e-3 }];
/// let chain = Chain::new(&steps, &Patch::grid(grid, taxel)?)?;
///
/// let mut frame = vec![1e-3; 64];
/// chain.apply(&mut frame, None, &Seed::new(2018).named("mug").numbered(17), &mut Scratch::default());
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Chain {
    steps: Vec<Prepared>,
    /// Leading steps that a touch's history passes through, the last of them one that remembers it; 0 if none does.
    n_remembering: usize,
    n_taxels: usize,
    taxel: Taxel,
    quantity: Quantity,
    /// Whether values are of either sign.
    is_signed: bool,
    scratch_len: usize,
}

/// What a patch feels during a touch, and what of it the chain can know.
#[derive(Debug)]
pub struct Recording<'a> {
    /// Deflections (metres), frame after frame in the order of time, ny × nx each; they become what is read.
    pub frames: &'a mut [f64],
    /// δ̇ in m/s, one for each deflection; `None` when the patch is at rest. Only force reads it.
    pub rates: Option<&'a [f64]>,
    /// Leading frames that came before the touch: they are remembered (if the chain [remembers](Chain::remembers)), but
    /// not read, and hold nothing of meaning afterwards.
    pub n_before: usize,
    /// Seconds between frames; `None` when the press waits at each frame until it is read.
    pub interval: Option<f64>,
    /// The share of the session that has gone, 0 to 1; `None` for a touch of a session whose touches come in any order: its name decides.
    pub time: Option<f64>,
}

/// Working memory of [`Chain::apply`]: one per thread, any chain; it grows to the largest frame it has seen.
#[derive(Clone, Debug, Default)]
pub struct Scratch(Vec<f64>);

/// A step with its units resolved and its weights computed.
#[derive(Clone, Debug)]
enum Prepared {
    Force,
    Noise {
        std: f64,
        place: u64,
    },
    /// A smoothing or a sensor error.
    Effect(Arc<dyn Effect>),
}

impl Chain {
    /// Checks the steps in their order and prepares them for the layout and the taxels of a patch.
    ///
    /// # Errors
    /// Force listed twice; a noise level or unit that the frame does not have by then (see [`Noise::std_of`](super::Noise::std_of)); a
    /// strength out of its step's range (see each step's own type); taxels that do not read alike; a step that this layout cannot have.
    pub fn new(steps: &[SignalStep], patch: &Patch) -> Result<Self> {
        Self::of(steps, patch, Quantity::Deflection)
    }

    /// The same of frames that are something else than deflections when they come.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn of(steps: &[SignalStep], patch: &Patch, quantity: Quantity) -> Result<Self> {
        Self::prepared(steps, patch, quantity, false)
    }

    /// The same of forces across the axes of taxels that read these too: newtons of either sign, with the full scale of those along the axes.
    /// They are forces from the first step on, so [`Force`](SignalStep::Force) leaves them as they are.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn of_shear(steps: &[SignalStep], patch: &Patch) -> Result<Self> {
        let mut steps = steps.to_vec();
        steps.retain(|step| *step != SignalStep::Force);
        Self::prepared(&steps, patch, Quantity::Force, true)
    }

    /// The most that a taxel reads: its stroke, or the force at it; of what the frames are when the chain has read them.
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
            is_signed,
            scratch_len: 0,
        };
        let mut n_noises = 0;
        for step in steps {
            n_noises += u64::from(matches!(step, SignalStep::Noise(_)));
            let n_before = chain.steps.len();
            let prepared = chain.prepare(step, n_noises, patch)?;
            chain.steps.extend(prepared);
            if chain.steps.len() > n_before && step.remembers() {
                chain.n_remembering = chain.steps.len();
            }
        }
        Ok(chain)
    }

    /// What the frames are after the chain.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Whether what came before a touch changes what is read of it.
    pub fn remembers(&self) -> bool {
        self.n_remembering > 0
    }

    /// Turns the deflections of a touch that is read once, at rest or at one moment, into its frame, in place.
    ///
    /// As [`apply_recording`](Self::apply_recording) of the one frame (metres, ny × nx, row after row), with nothing before it.
    ///
    /// # Panics
    /// When the frame or the rates do not have one number for each taxel.
    pub fn apply(
        &self,
        frame: &mut [f64],
        rates: Option<&[f64]>,
        touch: &Seed,
        scratch: &mut Scratch,
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

    /// Turns the deflections of a touch into its frames, in place.
    ///
    /// `touch` names the touch's own streams: its last frame has its name, and those before it have names of their own, so
    /// the last reading's noise is the same however many come before. Nothing is allocated once `scratch` has seen a
    /// frame of this size.
    ///
    /// # Panics
    /// When the frames are not whole, or none is left after those that came before, or there is not one rate for each value.
    pub fn apply_recording(&self, recording: Recording, touch: &Seed, scratch: &mut Scratch) {
        let Recording { frames, rates, .. } = recording;
        let first = recording.n_before * self.n_taxels();
        assert!(
            frames.len() > first && frames.len().is_multiple_of(self.n_taxels()),
            "one value for each taxel"
        );
        if scratch.0.len() < self.scratch_len {
            scratch.0.resize(self.scratch_len, 0.0);
        }
        for (place, step) in self.steps.iter().enumerate() {
            // Nobody remembers the history after the last step that does.
            let from = if place < self.n_remembering { 0 } else { first };
            let rates = rates.map(|rates| &rates[from..]);
            let n_before = (first - from) / self.n_taxels();
            let recording = Recording {
                frames: &mut frames[from..],
                rates,
                n_before,
                ..recording
            };
            self.apply_step(step, recording, touch, &mut scratch.0);
        }
    }

    fn apply_step(&self, step: &Prepared, recording: Recording, touch: &Seed, scratch: &mut [f64]) {
        let n_taxels = self.n_taxels();
        let frames = recording.frames;
        match step {
            Prepared::Force => force(frames, recording.rates, &self.taxel),
            Prepared::Noise { std, place } => {
                let frames = &mut frames[recording.n_before * n_taxels..];
                let n_frames = frames.len() / n_taxels;
                for (frame, values) in frames.chunks_exact_mut(n_taxels).enumerate() {
                    let seed = frame_seed(touch, frame, n_frames);
                    noise::add_normal(values, *std, &seed.named("noise").numbered(*place));
                }
            }
            Prepared::Effect(effect) => {
                let touch = TouchRead {
                    n_taxels,
                    n_before: recording.n_before,
                    interval: recording.interval,
                    time: recording.time,
                    seed: touch,
                };
                effect.apply(frames, &touch, scratch);
            }
        }
    }

    /// Values of a frame.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }

    /// The step for frames as they are by now; none if it has no strength.
    fn prepare(
        &mut self,
        step: &SignalStep,
        n_noises: u64,
        patch: &Patch,
    ) -> Result<Option<Prepared>> {
        Ok(Some(match step {
            SignalStep::Force => self.prepare_force()?,
            SignalStep::Noise(noise) => Prepared::Noise {
                std: noise.std_of(self.quantity, &self.taxel)?,
                place: n_noises,
            },
            SignalStep::Smoothing { width } => self.prepare_smoothing(*width, patch)?,
            SignalStep::Error { strengths, .. } if strengths.iter().all(|&s| s == 0.0) => {
                return Ok(None);
            }
            SignalStep::Error {
                error,
                strengths,
                skin: name,
            } => {
                let full_scale = self.quantity.full_scale(&self.taxel);
                let skin = Skin {
                    patch,
                    full_scale,
                    least: if self.is_signed { -full_scale } else { 0.0 },
                    name: *name,
                };
                self.prepare_effect((error.about().prepare)(strengths, &skin)?)
            }
        }))
    }

    fn prepare_force(&mut self) -> Result<Prepared> {
        if self.quantity == Quantity::Force {
            return Err(Error::input(
                "signal steps",
                "force twice",
                "force at most once",
            ));
        }
        self.quantity = Quantity::Force;
        Ok(Prepared::Force)
    }

    fn prepare_smoothing(&mut self, width: f64, patch: &Patch) -> Result<Prepared> {
        let smoothing: Box<dyn Effect> = match patch.layout().as_grid() {
            Some(grid) => Box::new(Smoothing::new(width, grid)?),
            None => Box::new(SurfaceSmoothing::new(width, patch)?),
        };
        Ok(self.prepare_effect(smoothing))
    }

    fn prepare_effect(&mut self, effect: Box<dyn Effect>) -> Prepared {
        self.scratch_len = self.scratch_len.max(effect.scratch_len());
        Prepared::Effect(effect.into())
    }
}

/// What every taxel of a patch is, but for its radius.
///
/// # Errors
/// Taxels that differ in stroke, stiffness or damping: a share of the full scale would be another one of each.
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

/// What a frame of a touch is named: the last one as the touch.
fn frame_seed(touch: &Seed, frame: usize, n_frames: usize) -> Seed {
    match frame + 1 == n_frames {
        true => *touch,
        false => touch.named("frame").numbered(frame as u64 + 1),
    }
}
