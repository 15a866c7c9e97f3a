//! Reading of touches: frames pass through the signal chain and are compressed into measurements.

use crate::error::Result;
use crate::random::Seed;
use crate::sensing::Projection;
use crate::signal::{Chain, Recording, SignalWorkspace};
use crate::studies::recognition::frames::Frames;
use crate::studies::recognition::plan::{TaxelArray, of_channel};
use crate::world::Taxel;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis};
use rayon::prelude::*;
use std::time::Instant;

/// Number of frames that are measured together by one matrix product. A fixed number makes results independent of the number of threads.
const BLOCK: usize = 128;

/// Skins whose frames are read, with the measurement matrix that compresses the frames.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// Skins that are touched; their frames have equal shapes.
    pub skins: &'a [ReadSkin<'a>],
    /// Measurement matrix Φ, by which each frame is multiplied.
    pub projection: &'a Projection,
}

/// Skin with all data to read its touches: signal chains, array and frames of the touches.
#[derive(Clone, Debug)]
pub struct ReadSkin<'a> {
    /// Signal chain for each channel of the skin. A skin that reads shear has three channels, any other skin one.
    pub chains: Vec<Chain>,
    /// Array of taxels, with the keys of `[skin]`.
    pub array: &'a TaxelArray,
    /// Speed at which the array approaches the object when the taxels are read, m/s.
    pub speed: f64,
    /// Frames of all touches on this skin.
    pub frames: &'a Frames,
}

impl ReadSkin<'_> {
    /// Reads a frame of the touches before the signal chain: the deflections of all taxels, metres, then their shear forces (if read), newtons.
    fn read(&self, frame: usize, out: &mut [f64]) {
        self.frames.read(frame, out);
    }
}

/// Touch to be read by a skin: its number, random seed, timing and preceding touch.
#[derive(Clone, Copy, Debug)]
pub struct TouchToRead {
    /// Number of the touch among all touches of the study. In the frames of the skin, its first frame has the index `number · F`, where F is the number of
    /// frames per touch.
    pub number: usize,
    /// Seed of the random numbers of one reading, derived from the touch's name.
    pub seed: Seed,
    /// Time between two frames of a touch, s; `None` if the press stops for each frame.
    pub interval: Option<f64>,
    /// Number of the preceding touch, for sensor errors with memory; `None` if no touch precedes it.
    pub before: Option<usize>,
    /// Index of the touched skin among the skins of [`Reading`].
    pub skin: usize,
}

/// Returns all touches of several classes, each class given by its name and its number of touches. Each touch is read at rest and has no preceding touch.
pub fn touches_to_read<'a>(
    classes: impl IntoIterator<Item = (&'a str, usize)>,
    seed: &Seed,
) -> Vec<TouchToRead> {
    let mut touches = Vec::new();
    for (name, n_touches) in classes {
        let class = seed.named(name);
        for touch in 0..n_touches as u64 {
            touches.push(TouchToRead {
                number: touches.len(),
                seed: class.numbered(touch),
                interval: None,
                before: None,
                skin: 0,
            });
        }
    }
    touches
}

/// Applies the signal chain and the measurement matrix to all touches. Returns the measurements, shape (n_touches · F, m), and the processor time, s. Here F is
/// the number of frames per touch.
///
/// # Errors
/// If a signal step fails.
pub fn measure(reading: Reading, touches: &[TouchToRead]) -> Result<(Array2<f64>, f64)> {
    let (n_touches, n_frames) = (touches.len(), reading.skins[0].frames.facts.n_frames);
    let block = (BLOCK / n_frames.max(1)).max(1);
    let n_measurements = reading.projection.n_measurements();
    let mut values = Array2::zeros((n_touches * n_frames, n_measurements));
    let cpu_s = values
        .axis_chunks_iter_mut(Axis(0), block * n_frames.max(1))
        .into_par_iter()
        .zip(touches.par_chunks(block))
        .map_init(Working::default, |working, (out, touches)| {
            let start = Instant::now();
            measure_block(reading, touches, working, out)?;
            Ok(start.elapsed().as_secs_f64())
        })
        .collect::<Result<Vec<_>>>()?
        .iter()
        .sum();
    Ok((values, cpu_s))
}

/// Memory that a thread reuses for each block of touches.
#[derive(Debug, Default)]
struct Working {
    /// Frames of the current block of touches, stored one after the other.
    frames: Vec<f64>,
    /// Frames of one channel of a touch, preceded by up to two frames of the preceding touch and of the released skin.
    with_history: Vec<f64>,
    /// Deepest frame of the preceding touch, which sensor errors with memory need.
    deepest: Vec<f64>,
    rates: Vec<f64>,
    scratch: SignalWorkspace,
}

/// Computes the measurements of a block of touches, each with F frames.
fn measure_block(
    reading: Reading,
    touches: &[TouchToRead],
    working: &mut Working,
    out: ArrayViewMut2<f64>,
) -> Result<()> {
    let first = reading.skins[0].frames;
    let (n_frames, n_values) = (first.facts.n_frames, first.n_values);
    let mut frames = std::mem::take(&mut working.frames);
    // Values of an earlier block are overwritten.
    frames.resize(touches.len() * n_frames * n_values, 0.0);
    let of_touches = frames.chunks_exact_mut(n_frames * n_values);
    for (touch, frames) in touches.iter().zip(of_touches) {
        let skin = &reading.skins[touch.skin];
        for (frame, row) in frames.chunks_exact_mut(n_values).enumerate() {
            skin.read(touch.number * n_frames + frame, row);
        }
        let remembers = skin.chains.iter().any(Chain::remembers);
        let before = touch.before.filter(|_| remembers);
        if let Some(before) = before {
            working.deepest.resize(n_values, 0.0);
            let last = (before + 1) * n_frames - 1;
            skin.read(last, &mut working.deepest);
        }
        let touch = TouchToRead { before, ..*touch };
        match (before, &skin.chains[..]) {
            (None, [chain]) => {
                let rates = rates_of(frames, skin.array.taxel(), skin.speed, &mut working.rates);
                let recording = recording(frames, (rates, 0), &touch);
                chain.apply_recording(recording, &touch.seed, &mut working.scratch);
            }
            (_, chains) => {
                for channel in 0..chains.len() {
                    read_channel(skin, (&touch, channel), frames, working);
                }
            }
        }
    }
    let shape = (touches.len() * n_frames, n_values);
    let read = ArrayView2::from_shape(shape, &frames).expect("whole frames");
    reading.projection.measure_into(read, out);
    working.frames = frames;
    Ok(())
}

fn recording<'a>(
    frames: &'a mut [f64],
    (rates, n_before): (Option<&'a [f64]>, usize),
    touch: &TouchToRead,
) -> Recording<'a> {
    Recording {
        frames,
        rates,
        n_before,
        interval: touch.interval,
        time: None,
    }
}

/// Applies the signal chain of one channel to the frames of a touch, in place.
fn read_channel(
    skin: &ReadSkin,
    (touch, channel): (&TouchToRead, usize),
    frames: &mut [f64],
    working: &mut Working,
) {
    let chains = &skin.chains;
    let n_taxels = chains[channel].n_taxels();
    let taxels = channel * n_taxels..(channel + 1) * n_taxels;
    let Working {
        with_history,
        deepest,
        rates,
        scratch,
        ..
    } = working;
    with_history.clear();
    if touch.before.is_some() {
        // The history consists of the deepest frame of the preceding touch and a frame of the released skin.
        with_history.extend_from_slice(&deepest[taxels.clone()]);
        with_history.resize(2 * n_taxels, 0.0);
    }
    let n_before = with_history.len() / n_taxels;
    let n_values = chains.len() * n_taxels;
    for frame in frames.chunks_exact(n_values) {
        with_history.extend_from_slice(&frame[taxels.clone()]);
    }
    let rates = rates_of(with_history, skin.array.taxel(), skin.speed, rates);
    let recording = recording(with_history, (rates, n_before), touch);
    let named = of_channel(&touch.seed, channel);
    chains[channel].apply_recording(recording, &named, scratch);
    let read = with_history[n_before * n_taxels..].chunks_exact(n_taxels);
    for (frame, read) in frames.chunks_exact_mut(n_values).zip(read) {
        frame[taxels.clone()].copy_from_slice(read);
    }
}

/// Returns the deflection rate δ̇ of every taxel, m/s. The rate of a taxel is the approach speed if the object pushes the taxel and its deflection is below the
/// stroke, otherwise 0. Returns `None` if the press is at rest.
pub fn rates_of<'a>(
    frame: &[f64],
    taxel: &Taxel,
    speed: f64,
    rates: &'a mut Vec<f64>,
) -> Option<&'a [f64]> {
    if speed == 0.0 {
        return None;
    }
    // Frames are stored in f32, where a saturated taxel has the rounded stroke, which may be smaller than the stroke.
    let stroke = taxel.stroke as f32;
    let moves = |deflection: f64| deflection > 0.0 && (deflection as f32) < stroke;
    rates.clear();
    rates.extend(frame.iter().map(|&d| if moves(d) { speed } else { 0.0 }));
    Some(rates)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_damper_feels_taxels_that_move_and_none_that_is_free_or_saturated() {
        // 5 mm is smaller in f32 than in f64, 3 mm is larger.
        for stroke in [5e-3, 3e-3] {
            let taxel = Taxel {
                radius: 1e-3,
                stiffness: 100.0,
                damping: 1.0,
                stroke,
            };
            let kept = |d: f64| f64::from(d as f32);
            let frame = [0.0, kept(1e-3), kept(stroke), stroke];
            let mut rates = Vec::new();
            let given = rates_of(&frame, &taxel, 0.01, &mut rates);
            assert_eq!(given, Some(&[0.0, 0.01, 0.0, 0.0][..]), "stroke {stroke}");
            assert_eq!(rates_of(&frame, &taxel, 0.0, &mut rates), None);
        }
    }
}
