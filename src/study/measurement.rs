//! Frames → signal → measurements, for one condition of the signal, ensemble and trial.

use super::frames::Frames;
use super::images::{FeaturesOfImages, Images};
use super::measurement_inputs::MeasurementInputs;
use super::repeats::projection_of;
use super::sensed::of_channel;
use super::sensor_errors::{TestedOn, skin};
use super::table::Cell;
use super::tilted_copies::TiltedCopies;
use super::touch_set::TouchSet;
use crate::error::Result;
use crate::random::Seed;
use crate::sensing::{Ensemble, Projection, Readings};
use crate::signal::{Chain, Recording, Scratch};
use crate::world::Taxel;
use ndarray::{Array1, Array2, ArrayView2, ArrayViewMut2, Axis, s};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// Frames measured together: one matrix product. Fixed, so that results do not depend on the number of threads.
const BLOCK: usize = 128;

/// Measurements of all touches of a group of cells. Where each is read several times, the first readings of all touches come first, then the second ones
/// of all: reading r of a touch has the number r · n_touches + touch.
#[derive(Clone, Debug)]
pub struct Measurements {
    /// (n_readings · n_touches · F) × m: the frames of a touch follow each other, the deepest last.
    pub values: Array2<f64>,
    /// How many touches there are.
    pub n_touches: usize,
    /// F, frames a touch.
    pub n_frames: usize,
    /// Φ1 (m): what a frame of ones measures.
    pub of_ones: Array1<f64>,
    /// Φ, and how images are made of measurements.
    pub sensed: Arc<SensedBy>,
    /// Features of images, n_touches × F·k each; below them those of tilted copies.
    pub of_images: Vec<(FeaturesOfImages, Array2<f64>)>,
    /// What was copied.
    pub copies: Option<TiltedCopies>,
    /// Processor-seconds, summed over threads.
    pub cpu_s: f64,
}

/// What measures a group in a trial, with all that is learned of training touches for it.
#[derive(Clone, Debug)]
pub struct SensedBy {
    /// The ensemble's matrix.
    pub projection: Projection,
    /// Images of what is measured, where any cell's features are of images.
    pub images: Option<Images>,
}

/// What a reading is made with, the same for all frames.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// The signal of each channel, of each skin that touches are made with.
    pub chains: &'a [Vec<Chain>],
    /// The ensemble's matrix.
    pub projection: &'a Projection,
    /// The taxels that were pressed.
    pub taxel: Taxel,
    /// Approach speed at the moment of reading, m/s.
    pub speed: f64,
}

impl Measurements {
    /// The numbers of all readings of some touches: the first of each, in their order, then the second of each.
    pub fn readings(&self, touches: &[usize]) -> Vec<usize> {
        let n_read = self.values.nrows() / (self.n_touches * self.n_frames);
        let readings = (0..n_read).map(|reading| reading * self.n_touches);
        let numbers = readings.flat_map(|first| touches.iter().map(move |touch| first + touch));
        numbers.collect()
    }

    /// What a cell learns from these touches (by number): n × F·m, the leading m measurements of each frame, made into
    /// the cell's features; or what the cell makes of them over time.
    pub fn features(&self, cell: &Cell, touches: &[usize]) -> Array2<f64> {
        let mut rows = Array2::zeros((touches.len(), cell.n_features()));
        let Some(over_time) = cell.over_time else {
            self.read_into(cell, touches, rows.view_mut());
            return rows;
        };
        // One touch at a time, since all frames of all touches may be many.
        let m = cell.n_frame_features();
        let mut frames = Array2::zeros((1, self.n_frames * m));
        for (row, touch) in rows.outer_iter_mut().zip(touches) {
            self.read_into(cell, &[*touch], frames.view_mut());
            let frames = frames.view().into_shape_with_order((self.n_frames, m));
            over_time.write(frames.expect("F frames of m"), row);
        }
        rows
    }

    /// What a cell learns from beside these training touches: the numbers of their tilted copies, which follow those of all readings. The
    /// first copy of each touch, then the second of each.
    pub fn copies(&self, cell: &Cell, train: &[usize]) -> Vec<usize> {
        let (Some(copies), Some(n_copies)) = (&self.copies, cell.tilted_copies) else {
            return Vec::new();
        };
        let n_read = self.values.nrows() / self.n_frames.max(1);
        let rows = copies.rows(train, n_copies);
        rows.map(|row| n_read + row).collect()
    }

    /// All frames of some touches one after the other, as the cell's kind of features: n × F·m.
    fn read_into(&self, cell: &Cell, touches: &[usize], mut rows: ArrayViewMut2<f64>) {
        let m = cell.measurements;
        if let Some(wanted) = cell.of_images() {
            let mut made = self.of_images.iter();
            let made = made.find(|(known, _)| *known == wanted);
            let (_, made) = made.expect("features of all cells of the group");
            for (mut row, touch) in rows.outer_iter_mut().zip(touches) {
                row.assign(&made.row(*touch));
            }
            return;
        }
        for (mut row, touch) in rows.outer_iter_mut().zip(touches) {
            for (frame, mut part) in row.exact_chunks_mut(m).into_iter().enumerate() {
                let place = touch * self.n_frames + frame;
                part.assign(&self.values.slice(s![place, ..m]));
            }
        }
        let of_ones = self.of_ones.slice(s![..m]);
        cell.features.apply(rows, of_ones);
    }
}

/// A touch to read.
#[derive(Clone, Copy, Debug)]
pub struct TouchToRead {
    /// Its number: its frames are those from `number · F` on.
    pub number: usize,
    /// Its name: what its own randomness is drawn from.
    pub seed: Seed,
    /// Seconds between its frames; `None` when the press waits at each.
    pub interval: Option<f64>,
    /// The number of the touch that came before it; `None` for a fresh skin.
    pub before: Option<usize>,
    /// The number of its skin among the reading's chains.
    pub skin: usize,
}

/// All touches of some classes, named by their class and their number within it; each at rest while it is read, on a fresh skin.
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

/// Reads and projects all frames of a group in one trial, to a number of measurements among those of the inputs. Φ and all that is learned for
/// features is the trial's own, or `sensed` by another.
///
/// # Errors
/// What a signal step or the projection refuses.
pub fn measure_group(
    inputs: &MeasurementInputs,
    (touched, frames): (&dyn TouchSet, &Frames),
    trial: usize,
    (n_measurements, sensed): (usize, Option<&Arc<SensedBy>>),
) -> Result<Measurements> {
    let array = inputs.array;
    let seed = Seed::new(inputs.seed);
    let skins = skins(inputs, trial as u64);
    let chains = |skin| array.chains(skin, |skin| inputs.signal.steps(skin));
    let chains = skins.iter().map(chains).collect::<Result<Vec<_>>>()?;
    let signal = seed.named("signal").numbered(trial as u64);
    let n_frames = frames.facts.n_frames;
    let mut touches = touched.to_read(inputs.speed, n_frames, &signal);
    if skins.len() > 1 {
        for &touch in &inputs.split(trial).test {
            touches[touch].skin = skins.len() - 1;
        }
    }
    let n_touches = touches.len();
    for reading in 1..inputs.n_readings {
        touches.extend_from_within(..n_touches);
        for touch in &mut touches[reading * n_touches..] {
            touch.seed = touch.seed.named("reading").numbered(reading as u64);
        }
    }
    let whole = Projection::new(
        Ensemble::Identity,
        array.frame_shape(),
        array.n_values(),
        &seed,
    )?;
    let reading = Reading {
        chains: &chains,
        projection: &whole,
        taxel: *array.taxel(),
        speed: inputs.speed,
    };
    let sensed = match sensed {
        Some(sensed) => Arc::clone(sensed),
        None => {
            let read = (reading, frames, &touches[..]);
            Arc::new(sensed_by(inputs, read, trial, n_measurements)?)
        }
    };
    let reading = Reading {
        projection: &sensed.projection,
        ..reading
    };
    let (values, cpu_s) = measure(reading, frames, &touches)?;
    let mut copies = None;
    let of_images = match &sensed.images {
        None => Vec::new(),
        Some(images) => {
            let train = (&inputs.split(trial).train[..], touched.classes().len());
            copies = tilted_copies(inputs, train, chains[0][0].full_scale(), trial);
            let mut wanted = inputs.of_images.clone();
            wanted.retain(|one| images.is_of(one.measurements));
            let made = images.features((values.view(), n_frames), &wanted, copies.as_ref());
            wanted.into_iter().zip(made).collect()
        }
    };
    let ones = Array2::ones((1, array.n_values()));
    Ok(Measurements {
        values,
        n_touches,
        n_frames,
        of_ones: sensed.projection.measure(ones.view()).row(0).to_owned(),
        sensed,
        of_images,
        copies,
        cpu_s,
    })
}

/// Copies of training touches, of n classes, for cells that learn from some: full scale is what a taxel reads at its stroke.
fn tilted_copies(
    inputs: &MeasurementInputs,
    train: (&[usize], usize),
    full_scale: f64,
    trial: usize,
) -> Option<TiltedCopies> {
    let copies = inputs.copies?;
    let array = inputs.array;
    let steepest = copies.tilt.tan();
    let a_pixel = steepest * array.image().1 / array.taxel().stroke * full_scale;
    let seed = Seed::new(inputs.seed).named("tilted copies");
    let seed = seed.numbered(trial as u64);
    Some(TiltedCopies::of(copies, train, a_pixel, &seed))
}

/// Draws Φ in a trial, or learns it, and what makes images of measurements, from training touches.
fn sensed_by(
    inputs: &MeasurementInputs,
    (whole, frames, touches): (Reading, &Frames, &[TouchToRead]),
    trial: usize,
    n_measurements: usize,
) -> Result<SensedBy> {
    let array = inputs.array;
    let shape = array.frame_shape();
    let drawn = projection_of(inputs.projections_per_split, trial) as u64;
    let drawn = Seed::new(inputs.seed).named("projection").numbered(drawn);
    if !inputs.learns() {
        let projection = Projection::new(inputs.ensemble, shape, n_measurements, &drawn)?;
        return Ok(SensedBy {
            projection,
            images: None,
        });
    }
    // Of whole touches, so many that their frames are enough; the split has one of each object in turn.
    let n_touches = learned_touches(frames.facts.n_frames);
    let learned = inputs.split(trial).train.iter().take(n_touches);
    let learned: Vec<TouchToRead> = learned.map(|&touch| touches[touch]).collect();
    let (training, _) = measure(whole, frames, &learned)?;
    let learn = |m| Projection::learned(inputs.ensemble, shape, m, (training.view(), &drawn));
    let projection = learn(n_measurements)?;
    let mut images = None;
    if !inputs.of_images.is_empty() {
        let untouched = untouched(whole, trial, inputs.seed);
        let readings = Readings {
            training: training.view(),
            untouched: untouched.view(),
        };
        let is_served =
            |m: &usize| projection.ensemble().is_prefix_nested() || *m == n_measurements;
        let counts = inputs.counts_of_images().into_iter().filter(is_served);
        let projections = counts.map(|m| match m == n_measurements {
            true => Ok(projection.clone()),
            false => learn(m),
        });
        let projections = projections.collect::<Result<Vec<_>>>()?;
        let full_scale = whole.chains[0][0].full_scale();
        images = Some(Images::new(
            &projections,
            (array, full_scale),
            readings,
            &drawn,
        )?);
    }
    Ok(SensedBy { projection, images })
}

/// Training touches of F frames that something is learned from before touches are measured, at most.
pub(super) fn learned_touches(n_frames: usize) -> usize {
    LEARNED_FRAMES.div_ceil(n_frames.max(1))
}

/// Frames that images are learned from, at most: with fewer the estimate has less to go by than it has components, and more take longer.
pub const LEARNED_FRAMES: usize = 4096;
/// Those of fewer with copies of them, about: a copy says less than a frame of its own. On 880 frames of a real skin accuracy from block averages at
/// 16:1 rises from 0.922 with half as many to 0.930, and stays there with twice as many, which take twice as long.
pub const WITH_COPIES: usize = 2 * LEARNED_FRAMES;
/// Readings of the untouched skin: noise along a component is known to √(2 / 256) = 9 %.
pub const UNTOUCHED: usize = 256;

/// What the skin of training touches reads when nothing touches it (readings × n).
fn untouched(whole: Reading, trial: usize, seed: u64) -> Array2<f64> {
    let seed = Seed::new(seed).named("untouched").numbered(trial as u64);
    let mut readings = Array2::zeros((UNTOUCHED, whole.projection.n_taxels()));
    let mut scratch = Scratch::default();
    for (number, mut row) in readings.outer_iter_mut().enumerate() {
        let frame = row.as_slice_mut().expect("rows are whole");
        let named = seed.numbered(number as u64);
        whole.chains[0][0].apply(frame, None, &named, &mut scratch);
    }
    readings
}

/// The skin of training touches, and that of test touches if it is another.
fn skins(inputs: &MeasurementInputs, trial: u64) -> Vec<Seed> {
    let first = skin(&Seed::new(inputs.seed), inputs.array);
    match inputs.tested_on {
        TestedOn::SameSkin => vec![first],
        TestedOn::AnotherSkin => vec![first, first.named("another").numbered(trial)],
    }
}

/// Reads touches. With the measurements (n_touches · F) × m come processor-seconds.
///
/// # Errors
/// Frames that are in a file cannot be read.
pub fn measure(
    reading: Reading,
    frames: &Frames,
    touches: &[TouchToRead],
) -> Result<(Array2<f64>, f64)> {
    let (n_touches, n_frames) = (touches.len(), frames.facts.n_frames);
    let block = (BLOCK / n_frames.max(1)).max(1);
    let n_measurements = reading.projection.n_measurements();
    let mut values = Array2::zeros((n_touches * n_frames, n_measurements));
    let cpu_s = values
        .axis_chunks_iter_mut(Axis(0), block * n_frames.max(1))
        .into_par_iter()
        .zip(touches.par_chunks(block))
        .map_init(Working::default, |working, (out, touches)| {
            let start = Instant::now();
            measure_block(reading, frames, touches, working, out)?;
            Ok(start.elapsed().as_secs_f64())
        })
        .collect::<Result<Vec<_>>>()?
        .iter()
        .sum();
    Ok((values, cpu_s))
}

/// What a thread works in, for one block after the other.
#[derive(Debug, Default)]
struct Working {
    /// Frames of a block.
    frames: Vec<f64>,
    /// Those of a channel of a touch, behind two that may have come before it.
    with_history: Vec<f64>,
    /// A frame of the touch before.
    deepest: Vec<f64>,
    rates: Vec<f64>,
    scratch: Scratch,
}

/// Reads some touches, F frames each.
fn measure_block(
    reading: Reading,
    kept: &Frames,
    touches: &[TouchToRead],
    working: &mut Working,
    out: ArrayViewMut2<f64>,
) -> Result<()> {
    let (n_frames, n_values) = (kept.facts.n_frames, kept.n_values);
    let mut frames = std::mem::take(&mut working.frames);
    // Whatever is there of another block is read over.
    frames.resize(touches.len() * n_frames * n_values, 0.0);
    let of_touches = frames.chunks_exact_mut(n_frames * n_values);
    for (touch, frames) in touches.iter().zip(of_touches) {
        for (frame, row) in frames.chunks_exact_mut(n_values).enumerate() {
            kept.read(touch.number * n_frames + frame, row);
        }
        let before = touch.before.filter(|_| remembers(&reading, touch));
        if let Some(before) = before {
            working.deepest.resize(n_values, 0.0);
            kept.read((before + 1) * n_frames - 1, &mut working.deepest);
        }
        let touch = TouchToRead { before, ..*touch };
        match (before, &reading.chains[touch.skin][..]) {
            (None, [chain]) => {
                let rates = rates_of(frames, &reading.taxel, reading.speed, &mut working.rates);
                let recording = recording(frames, (rates, 0), &touch);
                chain.apply_recording(recording, &touch.seed, &mut working.scratch);
            }
            (_, chains) => {
                for channel in 0..chains.len() {
                    read_channel(&reading, (&touch, channel), frames, working);
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

/// Whether what came before a touch changes what is read of it.
fn remembers(reading: &Reading, touch: &TouchToRead) -> bool {
    reading.chains[touch.skin].iter().any(Chain::remembers)
}

/// Reads one channel of a touch's frames, in place.
fn read_channel(
    reading: &Reading,
    (touch, channel): (&TouchToRead, usize),
    frames: &mut [f64],
    working: &mut Working,
) {
    let chains = &reading.chains[touch.skin];
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
        // The deepest frame of the touch before, and the skin let go.
        with_history.extend_from_slice(&deepest[taxels.clone()]);
        with_history.resize(2 * n_taxels, 0.0);
    }
    let n_before = with_history.len() / n_taxels;
    let n_values = chains.len() * n_taxels;
    for frame in frames.chunks_exact(n_values) {
        with_history.extend_from_slice(&frame[taxels.clone()]);
    }
    let rates = rates_of(with_history, &reading.taxel, reading.speed, rates);
    let recording = recording(with_history, (rates, n_before), touch);
    let named = of_channel(&touch.seed, channel);
    chains[channel].apply_recording(recording, &named, scratch);
    let read = with_history[n_before * n_taxels..].chunks_exact(n_taxels);
    for (frame, read) in frames.chunks_exact_mut(n_values).zip(read) {
        frame[taxels.clone()].copy_from_slice(read);
    }
}

/// δ̇ of every taxel: the approach speed (m/s) where the object pushes a taxel that can still move; `None` at rest.
pub fn rates_of<'a>(
    frame: &[f64],
    taxel: &Taxel,
    speed: f64,
    rates: &'a mut Vec<f64>,
) -> Option<&'a [f64]> {
    if speed == 0.0 {
        return None;
    }
    // Frames are kept in f32, where a saturated taxel holds the rounded stroke, which may be the smaller one.
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
