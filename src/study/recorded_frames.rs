//! Recorded frames of a study: read once, in the place of touches that are simulated.
//!
//! A reading v stands for the deflection `(v − zero) / (full_scale − zero)` of a stroke, so that noise and sensor errors that a study adds, which
//! are shares of the full scale, mean the same as on a simulated skin.

use super::frames::{FramePlace, Frames};
use super::measurement::{TouchToRead, touches_to_read};
use super::memory::check_memory;
use super::npy_numbers::{read_frames, read_labels, read_whole_numbers};
use super::object_files::file_content;
use super::plan::Plan;
use super::progress::Progress;
use super::samples::{Samples, Snapshots, spread_samples};
use super::spec::RecordedSpec;
use super::sweep::Sweep;
use super::taxel_array::TaxelArray;
use super::touch_set::TouchSet;
use crate::contact::saturation_limit;
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::signal::Quantity;
use ndarray::{Array1, Array2, ArrayViewMut2, s};
use std::collections::BTreeMap;

/// Touches that a skin has read.
#[derive(Clone, Debug)]
pub struct RecordedFrames {
    /// Where they are from.
    pub spec: RecordedSpec,
    /// Of the classes, by their labels.
    names: Vec<String>,
    /// Touches of each class.
    counts: Vec<usize>,
    /// (n · F) × n_taxels, as they were read: class by class, in the order of the file within each.
    readings: Array2<f32>,
    /// The reading of a taxel at its stroke.
    full_scale: f64,
    /// F, frames a touch.
    n_frames: usize,
    /// Of each touch, in the same order.
    groups: Option<Array1<usize>>,
}

impl RecordedFrames {
    /// Reads the files, unless the frames take more bytes than `ceiling` (`None`: no limit).
    ///
    /// # Errors
    /// A file that cannot be read, or does not fit the others; a reading that is no number; a class without touches.
    pub fn read(spec: &RecordedSpec, ceiling: Option<u64>) -> Result<Self> {
        let [n, n_frames, rows, columns] = spec.shape()?;
        let n_taxels = rows * columns;
        // As they are read, and as they are kept.
        let bytes = 12.0 * (n * n_frames * n_taxels) as f64;
        check_memory(bytes, ceiling, "frames").map_err(|allowed| {
            Error::input(spec.frames.display(), format!("{n} touches"), allowed)
        })?;
        let labels = read_labels(&spec.labels, n)?;
        let one_each = |path: &std::path::Path, n_given: usize| {
            let given = format!("{n_given} numbers");
            let allowed = format!("{n}, one a touch of {}", spec.frames.display());
            (n_given == n)
                .then_some(())
                .ok_or_else(|| Error::input(path.display(), given, allowed))
        };
        one_each(&spec.labels, labels.len())?;
        let (names, counts) = spec.classes(&labels)?;
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by_key(|&touch| labels[touch]);
        let groups = match &spec.groups {
            None => None,
            Some(path) => {
                let groups = read_whole_numbers(path)?;
                one_each(path, groups.len())?;
                Some(order.iter().map(|&touch| groups[touch]).collect())
            }
        };
        let readings = read_frames(&spec.frames, (n * n_frames, n_taxels))?;
        let full_scale = spec.full_scale_of(&readings)?;
        let mut sorted = Array2::zeros(readings.raw_dim());
        for (place, &touch) in order.iter().enumerate() {
            let of = |touch: usize| s![touch * n_frames..(touch + 1) * n_frames, ..];
            let its = readings.slice(of(touch)).mapv(|reading| reading as f32);
            sorted.slice_mut(of(place)).assign(&its);
        }
        Ok(Self {
            spec: spec.clone(),
            names,
            counts,
            readings: sorted,
            full_scale,
            n_frames,
            groups,
        })
    }

    /// A frame of a touch, metres of deflection.
    fn deflections(&self, (touch, frame): (usize, usize), stroke: f64) -> Array1<f64> {
        let (zero, full_scale) = (self.spec.zero, self.full_scale);
        let readings = self.readings.row(touch * self.n_frames + frame);
        readings.mapv(|reading| (f64::from(reading) - zero) / (full_scale - zero) * stroke)
    }
}

impl RecordedSpec {
    /// SHA-256 of each file, by its path.
    ///
    /// # Errors
    /// One that cannot be read.
    pub fn content(&self) -> Result<BTreeMap<String, String>> {
        let files = [Some(&self.frames), Some(&self.labels), self.groups.as_ref()];
        let files = files.into_iter().flatten();
        let content = files.map(|path| Ok((path.display().to_string(), file_content(path)?)));
        content.collect()
    }

    /// Names of the classes, and how many touches each has.
    fn classes(&self, labels: &[usize]) -> Result<(Vec<String>, Vec<usize>)> {
        let n_classes = labels.iter().max().map_or(0, |last| last + 1);
        let mut counts = vec![0; n_classes];
        for &label in labels {
            counts[label] += 1;
        }
        if let Some(label) = counts.iter().position(|&count| count == 0) {
            let given = format!("no touch of class {label}");
            let allowed = format!("touches of each class from 0 to {}", n_classes - 1);
            return Err(Error::input(self.labels.display(), given, allowed));
        }
        let names = match &self.names {
            None => (0..n_classes)
                .map(|label| format!("class {label}"))
                .collect(),
            Some(names) if names.len() == n_classes => names.clone(),
            Some(names) => {
                let given = format!("{} names", names.len());
                let allowed = format!("{n_classes}, one a class of {}", self.labels.display());
                return Err(Error::input("key recorded.names", given, allowed));
            }
        };
        if let Some(name) = (1..names.len()).find(|&k| names[..k].contains(&names[k])) {
            let given = format!("{:?} twice", names[name]);
            return Err(Error::input("key recorded.names", given, "each name once"));
        }
        Ok((names, counts))
    }

    /// The reading of a taxel at its full scale.
    fn full_scale_of(&self, readings: &Array2<f64>) -> Result<f64> {
        let mut largest = f64::NEG_INFINITY;
        for ((row, taxel), &reading) in readings.indexed_iter() {
            if !reading.is_finite() {
                let place = format!("{}, frame {row}, taxel {taxel}", self.frames.display());
                return Err(Error::input(place, reading, "a finite number"));
            }
            largest = largest.max(reading);
        }
        match self.full_scale {
            Some(full_scale) => Ok(full_scale),
            None if largest > self.zero => Ok(largest),
            None => {
                let given = format!("no reading above recorded.zero, {}", self.zero);
                Err(Error::input(self.frames.display(), given, "touches"))
            }
        }
    }
}

impl TouchSet for RecordedFrames {
    fn classes(&self) -> Vec<(&str, usize)> {
        let names = self.names.iter().map(String::as_str);
        names.zip(self.counts.iter().copied()).collect()
    }

    fn own_groups(&self) -> Option<Array1<usize>> {
        self.groups.clone()
    }

    fn simulate(
        &self,
        (array, n_frames): (&TaxelArray, usize),
        place: &FramePlace,
        progress: &dyn Progress,
    ) -> Result<Frames> {
        let stroke = array.taxel().stroke;
        let mut frames = Frames::new((array.n_taxels(), n_frames), place)?;
        let touches: Vec<usize> = (0..self.counts.iter().sum()).collect();
        let copy = |&touch: &usize, _: &mut (), mut rows: ArrayViewMut2<f32>| {
            for (frame, row) in rows.outer_iter_mut().enumerate() {
                let deflections = self.deflections((touch, frame), stroke);
                for (to, from) in row.into_iter().zip(deflections) {
                    *to = from as f32;
                }
            }
            let deepest = self.deflections((touch, n_frames - 1), stroke);
            let largest = deepest.fold(f64::NEG_INFINITY, |a, &b| a.max(b));
            (largest <= 0.0, largest > saturation_limit(stroke))
        };
        frames.make(&touches, || (), copy, progress)?;
        Ok(frames)
    }

    fn to_read(&self, _speed: f64, _n_frames: usize, seed: &Seed) -> Vec<TouchToRead> {
        touches_to_read(self.classes(), seed)
    }

    /// The last frame of the first touch of each class.
    fn samples(&self, plan: &Plan, _sweep: &Sweep) -> Result<Samples> {
        let array = &plan.arrays[0];
        let (shape, stroke) = (array.shape(), array.taxel().stroke);
        let mut first = 0;
        let frames = self.classes().into_iter().map(|(name, count)| {
            let frame = self.deflections((first, self.n_frames - 1), stroke);
            first += count;
            let frame = frame
                .into_shape_with_order(shape)
                .expect("one value a taxel");
            (name.replace('_', " "), frame)
        });
        let frames: Vec<(String, Array2<f64>)> = frames.collect();
        let set = |frames| Snapshots {
            frames,
            pitch_mm: array.picture_pitch_mm(),
            quantity: Quantity::Deflection,
            caption: format!("One recorded touch each on {}", array.describe_taxels()),
        };
        let chosen = spread_samples(plan, &self.class_names())?;
        let shown = chosen.into_iter().map(|label| frames[label].clone());
        Ok(Samples {
            shown: set(shown.collect()),
            each: Some(set(frames)),
        })
    }

    fn place_s(&self) -> f64 {
        0.0
    }

    fn settings(&self) -> Vec<(String, String)> {
        let row = |name: &str, value: String| (name.to_owned(), value);
        let names = self.class_names();
        vec![
            row(
                "Recorded classes",
                format!("{}: {}", names.len(), names.join(", ")),
            ),
            row("Frames a touch", self.n_frames.to_string()),
            row("Recorded in", self.spec.frames.display().to_string()),
        ]
    }
}
