//! Frames in memory, encoded to save space.

use bubbletouch_sim::frame_coding::decode;
use ndarray::{Array2, Axis};
use rayon::prelude::*;

/// Frames of an array, n_touches · F of them with n_values each (deflections in metres, or more channels), and counts from their simulation. Frames are
/// ordered by object and touch; the deepest frame of a touch is the last. Only touched taxels are stored.
#[derive(Debug)]
pub struct Frames {
    /// Counts from the simulation of the frames.
    pub facts: FrameFacts,
    /// Number of values of a frame.
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

    /// Returns the number of frames.
    pub fn n(&self) -> usize {
        self.encoded.len()
    }

    /// Decodes frame `number` into `frame`, shape (n_values,). Several threads may read at the same time.
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

/// Counts from the simulation of frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameFacts {
    /// Number F of frames per touch.
    pub n_frames: usize,
    /// Number of touches without a deflected taxel at the deepest point.
    pub n_missed: usize,
    /// Number of touches with at least one taxel at its stroke at the deepest point.
    pub n_saturated: usize,
    /// Processor time, s, summed over threads.
    pub cpu_s: f64,
}
