//! Temporal features of a touch, computed from its sequence of measured frames.
//!
//! A touch is a sequence of F frames y_t of m measurements each. Random measurements approximately preserve distances between frames (Johnson and
//! Lindenstrauss). The strength, duration, number and steadiness of contacts can therefore be computed from measurements, without reconstructing taxels. The
//! **level** of a frame is ‖y_t‖.
//!
//! The **course** of a touch consists of ten numbers for any m. A frame is in contact if its level is above the midpoint between the lowest and highest level
//! of the touch. The pattern of a frame is `ŷ = y / ‖y‖`.
//!
//! | number | definition |
//! |---|---|
//! | 1 | highest level |
//! | 2 | mean level of the frames in contact, divided by the highest level |
//! | 3 | number of frames in contact, divided by F |
//! | 4 | number of contacts: runs of frames in contact |
//! | 5 | length of the longest contact, divided by F |
//! | 6, 7 | frames from the first contact to the highest level, and from there to the last contact, divided by F |
//! | 8 | Σ of absolute changes of level between successive frames, divided by the highest level |
//! | 9 | Σ ‖ŷ_{t+1} − ŷ_t‖ over successive frames in contact: path length of the pattern |
//! | 10 | ‖ŷ_last − ŷ_first‖ of the frames in contact: net change of the pattern |
//!
//! If all frames have one level, there is no contact, and numbers 2 to 10 are 0.

use crate::error::{Error, Result};
use crate::inputs::params::Described;
use ndarray::{ArrayView2, ArrayViewMut1, Axis};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Temporal features that are computed from the frames of a touch, before scaling and training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum TemporalFeatures {
    /// Measurements of the frame with the highest contact strength (the first if several are equal): m numbers for m measurements per frame.
    Deepest,
    /// Measurements of k evenly spaced frames, including the first and the last (for k = 1, the middle frame). With m measurements per frame, these are k · m
    /// numbers.
    Stacked(usize),
    /// Mean, standard deviation and largest absolute value of each of the m measurements over time: 3 m numbers.
    Moments,
    /// Ten numbers that describe the touch over time: contact strength, duration and change.
    Course,
    /// Features of `Moments`, followed by the features of `Course`: 3 m + 10 numbers for m measurements per frame.
    Summarised,
}

/// Number of features that describe the course of a touch.
const N_COURSE: usize = 10;

/// Contact strength above which a frame counts as in contact, as a fraction of the range from the lowest to the highest strength. With a smaller value, noise
/// counts as contact; with a larger value, weak contacts are missed.
const CONTACT_LEVEL: f64 = 0.5;

impl TemporalFeatures {
    /// Returns the number of temporal features for `n_frames` frames of m measurements each.
    pub fn n_features(self, n_frames: usize, m: usize) -> usize {
        match self {
            Self::Deepest => m,
            Self::Stacked(k) => k.min(n_frames) * m,
            Self::Moments => 3 * m,
            Self::Course => N_COURSE,
            Self::Summarised => 3 * m + N_COURSE,
        }
    }

    /// Writes the temporal features of one touch into `row`. The array `frames` has shape F × m, with F at least 1.
    ///
    /// # Panics
    /// If the length of `row` differs from the number of features.
    pub fn write(self, frames: ArrayView2<f64>, mut row: ArrayViewMut1<f64>) {
        let (n_frames, m) = frames.dim();
        assert_eq!(row.len(), self.n_features(n_frames, m));
        match self {
            Self::Deepest => row.assign(&frames.row(highest(&levels(frames)))),
            Self::Stacked(k) => {
                let k = k.min(n_frames);
                for (part, mut to) in row.exact_chunks_mut(m).into_iter().enumerate() {
                    to.assign(&frames.row(evenly(part, k, n_frames)));
                }
            }
            Self::Moments => write_moments(frames, row),
            Self::Course => write_course(frames, row),
            Self::Summarised => {
                let (moments, course) = row.view_mut().split_at(Axis(0), 3 * m);
                write_moments(frames, moments);
                write_course(frames, course);
            }
        }
    }
}

/// Returns the frame index of selected frame number `part` (from 0) if k of `n_frames` frames are selected at even intervals.
fn evenly(part: usize, k: usize, n_frames: usize) -> usize {
    match k {
        1 => (n_frames - 1) / 2,
        _ => (part * (n_frames - 1) + (k - 1) / 2) / (k - 1),
    }
}

fn levels(frames: ArrayView2<f64>) -> Vec<f64> {
    let rows = frames.outer_iter();
    rows.map(|frame| frame.dot(&frame).sqrt()).collect()
}

/// Returns the index of the highest contact strength; the first index if several are equal.
fn highest(levels: &[f64]) -> usize {
    let mut best = 0;
    for (frame, &level) in levels.iter().enumerate() {
        if level > levels[best] {
            best = frame;
        }
    }
    best
}

fn write_moments(frames: ArrayView2<f64>, mut row: ArrayViewMut1<f64>) {
    let (n_frames, m) = frames.dim();
    for (k, values) in frames.axis_iter(Axis(1)).enumerate() {
        let mean = values.sum() / n_frames as f64;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        row[k] = mean;
        row[m + k] = (squares / n_frames as f64).sqrt();
        row[2 * m + k] = values.iter().fold(0.0, |most, v| v.abs().max(most));
    }
}

fn write_course(frames: ArrayView2<f64>, mut row: ArrayViewMut1<f64>) {
    let levels = levels(frames);
    let n_frames = levels.len() as f64;
    let top = highest(&levels);
    let (low, high) = (
        levels.iter().copied().fold(f64::INFINITY, f64::min),
        levels[top],
    );
    row.fill(0.0);
    row[0] = high;
    let is_contact = |level: f64| level > low + CONTACT_LEVEL * (high - low);
    let touched: Vec<usize> = (0..levels.len())
        .filter(|&t| is_contact(levels[t]))
        .collect();
    let (Some(&first), Some(&last)) = (touched.first(), touched.last()) else {
        return;
    };
    let runs = || touched.chunk_by(|a, b| a + 1 == *b);
    let longest = runs().map(<[usize]>::len).max().unwrap_or(0);
    let pattern_change = |a: usize, b: usize| {
        let (a, b) = (&frames.row(a) / levels[a], &frames.row(b) / levels[b]);
        (&a - &b).mapv(|d| d * d).sum().sqrt()
    };
    let neighbours = touched.windows(2).filter(|pair| pair[0] + 1 == pair[1]);
    let changes = levels.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mean = touched.iter().map(|&t| levels[t]).sum::<f64>() / touched.len() as f64;
    row[1] = mean / high;
    row[2] = touched.len() as f64 / n_frames;
    row[3] = runs().count() as f64;
    row[4] = longest as f64 / n_frames;
    row[5] = (top - first) as f64 / n_frames;
    row[6] = (last - top) as f64 / n_frames;
    row[7] = changes.sum::<f64>() / high;
    row[8] = neighbours
        .map(|pair| pattern_change(pair[0], pair[1]))
        .sum();
    row[9] = pattern_change(first, last);
}

impl TryFrom<String> for TemporalFeatures {
    type Error = Error;

    fn try_from(word: String) -> Result<Self> {
        let allowed =
            "deepest, stacked_8 (or another number of frames), moments, course or summarised";
        let wrong = || Error::input("temporal_features", &word, allowed);
        Ok(match &word[..] {
            "deepest" => Self::Deepest,
            "moments" => Self::Moments,
            "course" => Self::Course,
            "summarised" => Self::Summarised,
            _ => {
                let count = word.strip_prefix("stacked_").ok_or_else(wrong)?;
                match count.parse() {
                    Ok(k) if k > 0 => Self::Stacked(k),
                    _ => return Err(wrong()),
                }
            }
        })
    }
}

impl Described for TemporalFeatures {
    fn schema() -> Value {
        json!({
            "anyOf": [
                { "type": "string", "enum": ["deepest", "moments", "course", "summarised"] },
                { "title": "`stacked_` and a number", "type": "string", "pattern": "^stacked_\\+?0*[1-9][0-9]*$" },
            ]
        })
    }
}

impl From<TemporalFeatures> for String {
    fn from(temporal_features: TemporalFeatures) -> Self {
        match temporal_features {
            TemporalFeatures::Deepest => "deepest".to_owned(),
            TemporalFeatures::Stacked(k) => format!("stacked_{k}"),
            TemporalFeatures::Moments => "moments".to_owned(),
            TemporalFeatures::Course => "course".to_owned(),
            TemporalFeatures::Summarised => "summarised".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array1, Array2, array};

    fn combined(temporal_features: TemporalFeatures, frames: &Array2<f64>) -> Vec<f64> {
        let n = temporal_features.n_features(frames.nrows(), frames.ncols());
        let mut row = Array1::zeros(n);
        temporal_features.write(frames.view(), row.view_mut());
        row.to_vec()
    }

    /// Returns a test touch: every frame has a single non-zero measurement, except the fourth frame.
    fn touch() -> Array2<f64> {
        array![
            [0.0, 0.0],
            [2.0, 0.0],
            [4.0, 0.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [3.0, 0.0],
            [0.0, 0.0],
            [0.0, 0.0]
        ]
    }

    #[test]
    fn the_deepest_frame_is_that_of_the_highest_level() {
        assert_eq!(combined(TemporalFeatures::Deepest, &touch()), [4.0, 0.0]);
    }

    #[test]
    fn stacked_frames_are_even_in_time_and_all_of_them_are_the_recording() {
        let all: Vec<f64> = touch().iter().copied().collect();
        assert_eq!(combined(TemporalFeatures::Stacked(8), &touch()), all);
        assert_eq!(combined(TemporalFeatures::Stacked(2), &touch()), [0.0; 4]);
        for k in 2..=8 {
            let frames: Vec<usize> = (0..k).map(|part| evenly(part, k, 8)).collect();
            assert_eq!((frames[0], frames[k - 1]), (0, 7));
            let gaps = frames.windows(2).map(|pair| pair[1] - pair[0]);
            let (least, most) = gaps.fold((8, 0), |(a, b), gap| (gap.min(a), gap.max(b)));
            assert!(least >= 1 && most - least <= 1, "{frames:?}");
        }
    }

    #[test]
    fn the_course_counts_contacts_and_measures_their_times_and_ways() {
        let row = combined(TemporalFeatures::Course, &touch());
        let root = 2.0_f64.sqrt();
        let expected = [
            4.0,
            10.0 / 12.0,
            3.0 / 8.0,
            2.0,
            2.0 / 8.0,
            0.0,
            3.0 / 8.0,
            (2.0 + 2.0 + 1.0 + 3.0 + 3.0 + 3.0) / 4.0,
            root,
            0.0,
        ];
        for (found, expected) in row.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{row:?}");
        }
    }

    #[test]
    fn a_summary_is_the_moments_and_the_course_and_nothing_stays_nothing() {
        let both = [
            combined(TemporalFeatures::Moments, &touch()),
            combined(TemporalFeatures::Course, &touch()),
        ]
        .concat();
        assert_eq!(combined(TemporalFeatures::Summarised, &touch()), both);
        assert_eq!(both[..2], [9.0 / 8.0, 3.0 / 8.0]);
        assert_eq!(both[4..6], [4.0, 3.0]);
        let nothing = Array2::zeros((5, 3));
        assert_eq!(
            combined(TemporalFeatures::Summarised, &nothing),
            vec![0.0; 19]
        );
    }

    #[test]
    fn names_are_read_as_they_are_written_and_others_refused() {
        for kind in [
            TemporalFeatures::Deepest,
            TemporalFeatures::Stacked(12),
            TemporalFeatures::Moments,
            TemporalFeatures::Course,
            TemporalFeatures::Summarised,
        ] {
            assert_eq!(
                TemporalFeatures::try_from(String::from(kind)).unwrap(),
                kind
            );
        }
        for wrong in ["stacked", "stacked_0", "stacked_x", "stacked_-1", "max"] {
            assert!(
                TemporalFeatures::try_from(wrong.to_owned()).is_err(),
                "{wrong}"
            );
        }
    }
}
