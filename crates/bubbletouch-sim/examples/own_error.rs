//! An own sensor error behind the steps of a signal chain, and an own measurement matrix.
//!
//! `cargo run --release --example own_error`

use bubbletouch_sim::random::Seed;
use bubbletouch_sim::sensing::{Operator, Projection};
use bubbletouch_sim::signal::{
    Chain, Effect, Noise, NoiseUnit, SignalStep, SignalWorkspace, TouchRead,
};
use bubbletouch_sim::world::{Grid, Patch, Taxel};
use ndarray::{Array2, ArrayView2, ArrayViewMut2};

/// Readings below a threshold, metres, are 0.
#[derive(Debug)]
struct DeadZone(f64);

impl Effect for DeadZone {
    fn apply(&self, frames: &mut [f64], _: &TouchRead, _: &mut [f64]) {
        for value in frames.iter_mut().filter(|value| **value < self.0) {
            *value = 0.0;
        }
    }
}

/// Sums of the rows of an array with this number of columns.
#[derive(Debug)]
struct RowSums(usize);

impl Operator for RowSums {
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        for (frame, mut out) in frames.rows().into_iter().zip(out.rows_mut()) {
            let rows = frame.exact_chunks(self.0).into_iter();
            out.iter_mut()
                .zip(rows)
                .for_each(|(out, row)| *out = row.sum());
        }
    }

    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        (0..self.0 * self.0).for_each(|taxel| visit(taxel / self.0, taxel, 1.0));
    }

    fn row_norm(&self) -> f64 {
        (self.0 as f64).sqrt()
    }
}

fn main() -> Result<(), bubbletouch_sim::Error> {
    let grid = Grid {
        nx: 8,
        ny: 8,
        pitch: 2e-3,
    };
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    let noise = Noise {
        std: 0.05,
        unit: NoiseUnit::FullScale,
    };
    let chain = Chain::new(&[SignalStep::Noise(noise)], &Patch::grid(grid, taxel)?)?;
    let chain = chain.then(DeadZone(0.4e-3));

    // A touch of the first two rows.
    let mut frame: Vec<f64> = (0..64)
        .map(|taxel| if taxel < 16 { 2e-3 } else { 0.0 })
        .collect();
    let seed = Seed::new(2018).named("touch");
    chain.apply(&mut frame, None, &seed, &mut SignalWorkspace::default());
    println!(
        "{} taxels read more than the dead zone",
        frame.iter().filter(|&&x| x > 0.0).count()
    );

    let projection = Projection::from_operator(RowSums(8), 64, 8)?;
    let frames = Array2::from_shape_vec((1, 64), frame).expect("64 taxels");
    println!(
        "sums of the rows, mm: {:.2}",
        1e3 * projection.measure(frames.view())
    );
    Ok(())
}
