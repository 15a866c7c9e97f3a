//! Encoded frames in memory.

use bubbletouch_sim::frame_coding::decode;
use ndarray::{Array2, Axis};
use rayon::prelude::*;

/// (n_touches · F) frames of an array, n_values each (a metre of deflection a taxel, or more channels), and what happened while they were made: object by object, touch by
/// touch, the deepest frame of a touch last. Only touched taxels are kept.
#[derive(Debug)]
pub struct Frames {
    /// What happened.
    pub facts: FrameFacts,
    /// Numbers of each.
    pub n_values: usize,
    encoded: Vec<Box<[u8]>>,
}

impl Frames {
    /// Creates an empty set of frames with `n_frames` frames per touch.
    pub fn new((n_values, n_frames): (usize, usize)) -> Self {
        let facts = FrameFacts {
            n_frames,
            ..FrameFacts::default()
        };
        Self {
            facts,
            n_values,
            encoded: Vec::new(),
        }
    }

    /// Appends encoded frames.
    pub(crate) fn put(&mut self, encoded: Vec<Box<[u8]>>) {
        self.encoded.extend(encoded);
    }

    /// How many.
    pub fn n(&self) -> usize {
        self.encoded.len()
    }

    /// Writes frame `number` into `frame` (n_values); several threads read.
    ///
    /// # Panics
    /// If there is no such frame, or `frame` has another length.
    pub fn read(&self, number: usize, frame: &mut [f64]) {
        assert_eq!(frame.len(), self.n_values, "all values");
        decode(&self.encoded[number], frame);
    }

    /// Returns all frames, shape (n, n_values).
    pub fn to_array(&self) -> Array2<f64> {
        let mut array = Array2::zeros((self.n(), self.n_values));
        let rows = array.axis_iter_mut(Axis(0)).into_par_iter().enumerate();
        rows.for_each(|(number, mut row)| {
            self.read(number, row.as_slice_mut().expect("rows of a new array"));
        });
        array
    }
}

/// What happened while frames were made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameFacts {
    /// F, frames a touch.
    pub n_frames: usize,
    /// Touches that met nothing: no taxel is deflected when they are deepest.
    pub n_missed: usize,
    /// Touches with at least one taxel at its stroke when they are deepest.
    pub n_saturated: usize,
    /// Processor-seconds, summed over threads.
    pub cpu_s: f64,
}
