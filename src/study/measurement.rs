//! Frames → signal → measurements, for one setting of noise, smoothing, ensemble and trial.

use super::simulation::TouchedObject;
use crate::random::Seed;
use crate::sensing::Projection;
use crate::signal::{Chain, Scratch};
use crate::world::Taxel;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis};
use rayon::prelude::*;
use std::time::Instant;

/// Touches measured together: one matrix product. Fixed, so that results do not depend on the number of threads.
const BLOCK: usize = 128;

/// Measurements of all touches of a group of cells.
#[derive(Clone, Debug)]
pub struct Measurements {
    /// n_touches × m.
    pub values: Array2<f64>,
    /// Processor-seconds, summed over threads.
    pub cpu_s: f64,
}

/// What a reading is made with, the same for all touches.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// Signal steps.
    pub chain: &'a Chain,
    /// The ensemble's matrix.
    pub projection: &'a Projection,
    /// The taxels that were pressed.
    pub taxel: Taxel,
    /// Approach speed at the moment of reading, m/s.
    pub speed: f64,
}

/// One name a touch, by object and number within it: what its noise is drawn from.
pub fn touch_seeds(touched: &[TouchedObject], seed: &Seed) -> Vec<Seed> {
    touched
        .iter()
        .flat_map(|t| {
            let object = seed.named(&t.object.name);
            (0..t.touches.len() as u64).map(move |touch| object.numbered(touch))
        })
        .collect()
}

/// Reads every frame (n_touches × n_taxels, metres of deflection); `seeds` has one name a touch.
pub fn measure(reading: Reading, deflection: ArrayView2<f32>, seeds: &[Seed]) -> Measurements {
    let n_measurements = reading.projection.n_measurements();
    let mut values = Array2::zeros((deflection.nrows(), n_measurements));
    let cpu_s = values
        .axis_chunks_iter_mut(Axis(0), BLOCK)
        .into_par_iter()
        .zip(deflection.axis_chunks_iter(Axis(0), BLOCK))
        .zip(seeds.par_chunks(BLOCK))
        .map_init(Scratch::default, |scratch, ((out, frames), seeds)| {
            let start = Instant::now();
            measure_block(reading, frames, seeds, scratch, out);
            start.elapsed().as_secs_f64()
        })
        .collect::<Vec<_>>()
        .iter()
        .sum();
    Measurements { values, cpu_s }
}

fn measure_block(
    reading: Reading,
    deflection: ArrayView2<f32>,
    seeds: &[Seed],
    scratch: &mut Scratch,
    out: ArrayViewMut2<f64>,
) {
    let mut frames = deflection.mapv(f64::from);
    let mut rates = Vec::new();
    for (mut frame, seed) in frames.outer_iter_mut().zip(seeds) {
        let frame = frame
            .as_slice_mut()
            .expect("rows of a new array are contiguous");
        let rate = rates_of(frame, &reading.taxel, reading.speed, &mut rates);
        reading.chain.apply(frame, rate, seed, scratch);
    }
    reading.projection.measure_into(frames.view(), out);
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
