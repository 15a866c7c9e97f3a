//! Readings of the taxels of a whole body, computed taxel by taxel; the cost is proportional to the number of taxels read.
//!
//! A `Chain` draws the noise of a frame taxel after taxel, so two million taxels cost two million normal numbers per frame. A [`BodyReadout`] computes noise,
//! zero offsets, gains and faults with counter-based random numbers. These are functions of the skin's name, the taxel, the frame and the time. A taxel
//! therefore reads the same value alone, among the touched taxels, or with its whole patch.
//!
//! Steps and strengths have the same meaning and distributions as in a chain, but different random draws. A sensor error is supported
//! if its description has `by_taxel`.

use super::noise;
use super::step::seed_of_repetition;
use super::taxel_effect::{CHUNK, Chunk, TaxelEffect};
use super::{Moment, Quantity, SensorError, SignalStep};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::whole_body::{BodyState, WholeBody};
use crate::world::Taxel;
use rayon::prelude::*;

/// Minimum number of taxels for which several threads compute a reading. With fewer taxels, starting a second thread takes longer than the computation.
pub const WORTH_THREADS: usize = 4 * CHUNK;

/// Signal steps for the taxels of a whole body. The constructor checks the steps and prepares them for each patch.
///
/// ```
/// use bubbletouch_sim::geometry::Pose;
/// use bubbletouch_sim::objects::{Sphere, SphereClusters, SphereUnion};
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::signal::{BodyReading, BodyReadout, Moment, Noise, NoiseUnit, SensorError, SignalStep};
/// use bubbletouch_sim::whole_body::{BodyState, WholeBody};
/// use bubbletouch_sim::world::{Grid, Patch, Taxel};
/// use glam::DVec3;
///
/// let taxel = Taxel { radius: 1e-3, stiffness: 100.0, damping: 0.0, stroke: 2e-3 };
/// let palm = Patch::grid(Grid { nx: 40, ny: 40, pitch: 2e-3 }, taxel)?;
/// let body = WholeBody::new(&[palm])?;
/// let mut state = BodyState::at_rest(&body);
/// let ball = SphereUnion::new(vec![Sphere { center: DVec3::ZERO, radius: 0.03 }])?;
/// let at = [Pose::from_translation(DVec3::new(0.0, 0.0, 0.0305))];
/// state.press(&body, &[SphereClusters::new(&ball)], &at, 1e-3)?;
///
/// // Noise of 1 % of full scale, and one taxel in a hundred is dead.
/// let skin = Seed::new(2018).named("skin");
/// let noise = SignalStep::Noise(Noise { std: 0.01, unit: NoiseUnit::FullScale });
/// let steps = [noise, SensorError::Faults.step(&[0.01], skin)?];
/// let readout = BodyReadout::new(&steps, &body, &skin)?;
///
/// // Frame 7, in the middle of a session: the touched taxels, and all of a patch.
/// let moment = Moment { frame: 7, time: 0.5 };
/// let mut reading = BodyReading::default();
/// readout.read_touched(&body, &state, moment, &mut reading);
/// let mut palm = vec![0.0; 1600];
/// readout.read_patch(&body, &state, 0, moment, &mut palm);
/// for (number, value) in reading.iter() {
///     let (patch, taxel) = body.place_of(number);
///     assert!(patch == 0 && value == palm[taxel]);
/// }
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct BodyReadout {
    begins: Quantity,
    /// Prepared signal steps, one list per patch, in the order of application.
    steps: Vec<Vec<TaxelEffect>>,
    /// Index of the first taxel of each patch, followed by the total number of taxels.
    firsts: Vec<usize>,
}

/// Indices and readings of selected taxels of a body. A reused instance allocates no memory if no touch deflects more taxels than earlier touches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyReading {
    /// Indices of the selected taxels in the body, ascending.
    pub taxels: Vec<usize>,
    /// Readings of the taxels in `taxels`, metres or newtons.
    pub values: Vec<f64>,
}

impl BodyReading {
    /// Returns the pairs (index of a taxel, reading of this taxel), ascending by index.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f64)> {
        let values = self.values.iter().copied();
        self.taxels.iter().copied().zip(values)
    }
}

impl BodyReadout {
    /// Checks the signal steps in their order and prepares them for each patch. The force step must be the first step or absent; noise and sensor errors must
    /// be independent between taxels. `noise` seeds the noise of all frames.
    ///
    /// # Errors
    /// If a step depends on other taxels or other frames, if force is not the first step, or if a strength is out of range.
    /// If the unit of the noise does not fit the readings at this step.
    pub fn new(steps: &[SignalStep], body: &WholeBody, noise: &Seed) -> Result<Self> {
        let is_force = steps.first() == Some(&SignalStep::Force);
        let begins = match is_force {
            true => Quantity::Force,
            false => Quantity::Deflection,
        };
        let steps = &steps[usize::from(is_force)..];
        let patches = body.patches().iter();
        let of_patch = patches.map(|patch| prepare(steps, begins, patch.taxel(), noise));
        let firsts = body.firsts().iter().copied();
        Ok(Self {
            begins,
            steps: of_patch.collect::<Result<_>>()?,
            firsts: firsts.chain([body.n_taxels()]).collect(),
        })
    }

    /// Returns the physical quantity of the readings: deflection or force.
    pub fn quantity(&self) -> Quantity {
        self.begins
    }

    /// Computes the readings of the taxels that the last press deflected, in ascending order. Other taxels also have noise, zero offsets and faults;
    /// `read_patch` and `read` return their readings.
    ///
    /// # Panics
    /// If `body` has another number of taxels, or the time is not from 0 to 1.
    pub fn read_touched(
        &self,
        body: &WholeBody,
        state: &BodyState,
        moment: Moment,
        reading: &mut BodyReading,
    ) {
        reading.taxels.clear();
        reading.values.clear();
        for (first, touched) in state.touched_of_patches(body) {
            let numbers = touched.iter().map(|&(taxel, _)| first + taxel as usize);
            reading.taxels.extend(numbers);
            if self.begins == Quantity::Deflection {
                let felt = touched.iter().map(|&(_, deflection)| deflection);
                reading.values.extend(felt);
            }
        }
        if self.begins == Quantity::Force {
            reading
                .values
                .extend(state.forces(body).map(|(_, force)| force));
        }
        self.read(&reading.taxels, moment, &mut reading.values);
    }

    /// Writes the readings of all taxels of a patch, shape (n_taxels,), in the order of the layout.
    ///
    /// # Panics
    /// If `body` has another number of taxels, the patch does not exist, or the number of values is wrong. Also if the time is not from 0 to 1.
    pub fn read_patch(
        &self,
        body: &WholeBody,
        state: &BodyState,
        patch: usize,
        moment: Moment,
        values: &mut [f64],
    ) {
        let numbers = self.firsts[patch]..self.firsts[patch + 1];
        match self.begins {
            Quantity::Deflection => values.copy_from_slice(state.deflections(patch)),
            Quantity::Force => {
                values.fill(0.0);
                let of_patch = state
                    .forces(body)
                    .filter(|(taxel, _)| numbers.contains(taxel));
                of_patch.for_each(|(taxel, force)| values[taxel - numbers.start] = force);
            }
        }
        self.read(&numbers.collect::<Vec<_>>(), moment, values);
    }

    /// Replaces the true values of the listed taxels (metres or newtons, 0 on untouched taxels) by readings. The taxels may have any order. The result does
    /// not depend on the number of threads.
    ///
    /// # Panics
    /// If there is not one value per taxel, if a taxel does not exist, or if the time is not from 0 to 1.
    pub fn read(&self, taxels: &[usize], moment: Moment, values: &mut [f64]) {
        assert_eq!(taxels.len(), values.len(), "one value for each taxel");
        assert!(
            (0.0..=1.0).contains(&moment.time),
            "a share of the session, 0 to 1"
        );
        if taxels.len() < WORTH_THREADS {
            let mut chunk = Chunk::default();
            let chunks = taxels.chunks(CHUNK).zip(values.chunks_mut(CHUNK));
            chunks.for_each(|(taxels, values)| self.read_chunk(&mut chunk, taxels, moment, values));
            return;
        }
        let chunks = taxels.par_chunks(CHUNK).zip(values.par_chunks_mut(CHUNK));
        chunks.for_each_init(Chunk::default, |chunk, (taxels, values)| {
            self.read_chunk(chunk, taxels, moment, values);
        });
    }

    fn read_chunk(
        &self,
        chunk: &mut Chunk,
        mut taxels: &[usize],
        moment: Moment,
        mut values: &mut [f64],
    ) {
        while let Some(&first) = taxels.first() {
            let patch = self.firsts.partition_point(|&of| of <= first) - 1;
            let numbers = self.firsts[patch]..self.firsts[patch + 1];
            let of_patch = taxels.iter().take_while(|taxel| numbers.contains(taxel));
            let n = of_patch.count();
            assert!(n > 0, "a taxel of this body");
            let (here, rest) = values.split_at_mut(n);
            chunk.lay(&taxels[..n]);
            for step in &self.steps[patch] {
                step.apply(chunk, moment, here);
            }
            (taxels, values) = (&taxels[n..], rest);
        }
    }
}

/// Prepares the signal steps in the units of one patch; steps of zero strength are omitted.
fn prepare(
    steps: &[SignalStep],
    quantity: Quantity,
    taxel: &Taxel,
    seed: &Seed,
) -> Result<Vec<TaxelEffect>> {
    let mut prepared = Vec::new();
    for (place, step) in steps.iter().enumerate() {
        let repetition = step.repetition(&steps[..place]);
        match step {
            SignalStep::Noise(of) => {
                let std = of.std_of(quantity, taxel)?;
                let key = seed.named("noise").numbered(repetition + 1).counter_key();
                if std > 0.0 {
                    prepared.push(noise::by_taxel(std, key));
                }
            }
            SignalStep::Error {
                error,
                strengths,
                skin,
            } => {
                if strengths.iter().any(|&strength| strength != 0.0) {
                    let full_scale = quantity.full_scale(taxel);
                    let skin = seed_of_repetition(skin, repetition);
                    let about = error.about();
                    about.check(strengths)?;
                    let by_taxel = about
                        .by_taxel
                        .ok_or_else(|| refused(about.step, OF_OTHERS))?;
                    let key = skin.named(about.step).counter_key();
                    prepared.push(by_taxel(strengths, full_scale, key));
                }
            }
            SignalStep::Force => return Err(refused("force", "after another step")),
            SignalStep::Smoothing { .. } => return Err(refused("smoothing", OF_OTHERS)),
        }
    }
    Ok(prepared)
}

/// Reason in the error message for a signal step whose result for one taxel depends on other taxels or other frames.
const OF_OTHERS: &str = "which needs other taxels or other frames";

fn refused(step: &str, why: &str) -> Error {
    let errors = SensorError::all().map(SensorError::about);
    let by_taxel = errors.filter(|about| about.by_taxel.is_some());
    let words: Vec<&str> = by_taxel.map(|about| about.step).collect();
    Error::input(
        "steps of a body's readout",
        format!("{step}, {why}"),
        format!("force first, then noise, {}", words.join(", ")),
    )
}
