//! Store of frames in memory, in a compressed encoding.

use bubbletouch_sim::frame_coding::decode;
use ndarray::{Array2, Axis};
use rayon::prelude::*;

/// Frames of all touches on an array, with F frames per touch and n_values values per frame. Frames are ordered by object and touch; the last frame of a touch
/// is the deepest. Only touched taxels are stored.
#[derive(Debug)]
pub struct Frames {
    /// Counts of missed and saturated touches, and processor time of the simulation.
    pub facts: FrameFacts,
    /// Number of values per frame.
    pub n_values: usize,
    encoded: Vec<Box<[u8]>>,
}

impl Frames {
    /// Creates an empty store for frames, with `n_frames` frames per touch.
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

    /// Appends encoded frames to the store.
    pub(crate) fn put(&mut self, encoded: Vec<Box<[u8]>>) {
        self.encoded.extend(encoded);
    }

    /// Returns the number of frames in the store.
    pub fn n(&self) -> usize {
        self.encoded.len()
    }

    /// Returns the mean size of an encoded frame, bytes; 0 without frames.
    pub(crate) fn mean_bytes(&self) -> f64 {
        let sizes = self.encoded.iter().map(|frame| frame.len());
        sizes.sum::<usize>() as f64 / self.n().max(1) as f64
    }

    /// Decodes frame `number` into `frame`, shape (n_values,). Several threads may read at the same time.
    ///
    /// # Panics
    /// If there is no such frame, or `frame` has another length.
    pub fn read(&self, number: usize, frame: &mut [f64]) {
        assert_eq!(frame.len(), self.n_values, "all values");
        decode(&self.encoded[number], frame);
    }

    /// Decodes all frames and returns them as an array, shape (n, n_values).
    pub fn to_array(&self) -> Array2<f64> {
        let mut array = Array2::zeros((self.n(), self.n_values));
        let rows = array.axis_iter_mut(Axis(0)).into_par_iter().enumerate();
        rows.for_each(|(number, mut row)| {
            self.read(number, row.as_slice_mut().expect("rows of a new array"));
        });
        array
    }
}

/// Counts of missed and saturated touches, and processor time, of a simulation of frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameFacts {
    /// Number F of frames per touch.
    pub n_frames: usize,
    /// Number of touches that deflect no taxel at their deepest point.
    pub n_missed: usize,
    /// Number of touches in which at least one taxel reaches its stroke at the deepest point.
    pub n_saturated: usize,
    /// Processor time of the simulation, summed over threads, s.
    pub cpu_s: f64,
}
