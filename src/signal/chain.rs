//! Signal steps in the order in which the study lists them.

use super::{Noise, Quantity, Smoothing, force, noise};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::world::{Grid, Patch, Taxel};

/// One step from deflections to frames, as a study names it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SignalStep {
    /// Deflections become forces.
    Force,
    /// Gaussian noise is added.
    Noise(Noise),
    /// The frame is smoothed.
    Smoothing {
        /// σ of the Gaussian, metres, zero or positive.
        width: f64,
    },
}

/// Checked signal steps, prepared for one patch. The empty chain leaves deflections as they are.
///
/// ```
/// use bubbletouch::random::Seed;
/// use bubbletouch::signal::{Chain, Noise, NoiseUnit, Scratch, SignalStep};
/// use bubbletouch::world::{Grid, Patch, Taxel};
///
/// let grid = Grid { nx: 8, ny: 8, pitch: 2e-3 };
/// let taxel = Taxel { radius: 1e-3, stiffness: 200.0, damping: 0.0, stroke: 5e-3 };
/// let noise = Noise { std: 0.1, unit: NoiseUnit::FullScale };
/// let steps = [SignalStep::Noise(noise), SignalStep::Smoothing { width: 4e-3 }];
/// let chain = Chain::new(&steps, &Patch::new(grid, taxel)?)?;
///
/// let mut frame = vec![1e-3; 64];
/// chain.apply(&mut frame, None, &Seed::new(2018).named("mug").numbered(17), &mut Scratch::default());
/// # Ok::<(), bubbletouch::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Chain {
    steps: Vec<Prepared>,
    taxel: Taxel,
    quantity: Quantity,
    n_taxels: usize,
    scratch_len: usize,
}

/// Working memory of [`Chain::apply`]: one per thread, any chain; it grows to the largest frame it has seen.
#[derive(Clone, Debug, Default)]
pub struct Scratch(Vec<f64>);

/// A step with its units resolved and its weights computed.
#[derive(Clone, Debug)]
enum Prepared {
    Force,
    Noise { std: f64, place: u64 },
    Smoothing(Smoothing),
}

impl Chain {
    /// Checks the steps in their order and prepares them for the patch's grid and taxels.
    ///
    /// # Errors
    /// Force listed twice; a noise level or unit that the frame does not have by then (see [`Noise::std_of`]); a
    /// smoothing width out of range (see [`Smoothing::new`]).
    pub fn new(steps: &[SignalStep], patch: &Patch) -> Result<Self> {
        let mut chain = Self {
            steps: Vec::with_capacity(steps.len()),
            taxel: patch.taxel,
            quantity: Quantity::Deflection,
            n_taxels: patch.grid.n_taxels(),
            scratch_len: 0,
        };
        let mut n_noises = 0;
        for step in steps {
            let prepared = match step {
                SignalStep::Force => chain.prepare_force()?,
                SignalStep::Noise(noise) => {
                    n_noises += 1;
                    chain.prepare_noise(noise, n_noises)?
                }
                SignalStep::Smoothing { width } => chain.prepare_smoothing(*width, &patch.grid)?,
            };
            chain.steps.push(prepared);
        }
        Ok(chain)
    }

    /// What the frames are after the chain.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Turns a touch's deflections (metres, ny × nx, row after row) into its frame, in place.
    ///
    /// `rate` is δ̇ in m/s for each taxel, `None` when the patch is at rest; only force reads it. `touch` names the
    /// touch's own streams. Nothing is allocated once `scratch` has seen a frame of this size.
    ///
    /// # Panics
    /// When the frame or the rates do not have one number for each taxel.
    pub fn apply(
        &self,
        frame: &mut [f64],
        rate: Option<&[f64]>,
        touch: &Seed,
        scratch: &mut Scratch,
    ) {
        assert_eq!(frame.len(), self.n_taxels, "one value for each taxel");
        if scratch.0.len() < self.scratch_len {
            scratch.0.resize(self.scratch_len, 0.0);
        }
        for step in &self.steps {
            match step {
                Prepared::Force => force(frame, rate, &self.taxel),
                Prepared::Noise { std, place } => {
                    noise::add_normal(frame, *std, &touch.named("noise").numbered(*place));
                }
                Prepared::Smoothing(smoothing) => smoothing.apply(frame, &mut scratch.0),
            }
        }
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

    fn prepare_noise(&self, noise: &Noise, place: u64) -> Result<Prepared> {
        let std = noise.std_of(self.quantity, &self.taxel)?;
        Ok(Prepared::Noise { std, place })
    }

    fn prepare_smoothing(&mut self, width: f64, grid: &Grid) -> Result<Prepared> {
        let smoothing = Smoothing::new(width, grid)?;
        self.scratch_len = self.scratch_len.max(smoothing.scratch_len());
        Ok(Prepared::Smoothing(smoothing))
    }
}
