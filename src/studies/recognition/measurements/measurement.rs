//! Measurement of frames after the signal chain, for one signal condition, ensemble and trial.

use crate::sensing::{Readings, TrainingFrames};
use crate::signal::SignalWorkspace;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{
    Frames, ReadSkin, Reading, TouchSet, TouchToRead, measure,
};
use crate::studies::recognition::measurements::{
    Images, MeasuredTrial, MeasurementInputs, TestInputs, TiltedCopies,
};
use crate::studies::recognition::plan::{projection_of, skin};
use crate::studies::recognition::rows::{FeaturesOfImages, RowInputs};
use crate::studies::recognition::sweep::learned_touches;
use ndarray::{Array1, Array2, ArrayViewMut2, Axis, s};
use std::iter::repeat_n;

/// Measurements of all touches of a group of configurations. If touches are read several times, the first readings of all touches come first, followed by the
/// second readings. Reading r of a touch has the number r · n_touches + touch.
#[derive(Clone, Debug)]
pub struct Measurements {
    /// Measurements, shape (n_readings · n_touches · F, m), where F is the number of frames per touch. The frames of a touch are adjacent, the deepest last.
    pub values: Array2<f64>,
    /// Number of touches that were measured.
    pub n_touches: usize,
    /// Number F of frames per touch.
    pub n_frames: usize,
    /// Measurements of a frame in which every value is 1, shape (m,).
    pub of_ones: Array1<f64>,
    /// Image features of all touches, one array for each kind of features. Each array has the shape (n_touches, F·k) for F frames of k features, and is
    /// followed by the rows of tilted copies.
    pub of_images: Vec<(FeaturesOfImages, Array2<f64>)>,
    /// Indices of the selected taxels, in the order of their selection; empty if the ensemble selects no taxels.
    pub selected: Vec<usize>,
    /// Tilted copies of the training touches; `None` if the group uses no copies.
    pub copies: Option<TiltedCopies>,
    /// Processor time of the measurement, summed over threads, s.
    pub cpu_s: f64,
}

/// Measurement matrix of a group of configurations in a trial, and the image estimators fitted to its training touches.
#[derive(Clone, Debug)]
pub struct SensedBy {
    /// Measurement matrix Φ, by which each frame is multiplied.
    pub projection: Projection,
    /// Image estimators; `None` if no configuration uses image features.
    pub images: Option<Images>,
}

impl Measurements {
    /// Drops the measurements and keeps the features of images.
    pub(crate) fn drop_values(&mut self) {
        self.values = Array2::zeros((self.values.nrows(), 0));
    }

    /// Returns the numbers of all readings of the given touches, ordered by reading, then by touch.
    pub fn readings(&self, touches: &[usize]) -> Vec<usize> {
        let n_read = self.values.nrows() / (self.n_touches * self.n_frames);
        let readings = (0..n_read).map(|reading| reading * self.n_touches);
        let numbers = readings.flat_map(|first| touches.iter().map(move |touch| first + touch));
        numbers.collect()
    }

    /// Returns the features of the given touches, shape (n, F·m): the first m measurements of each of their F frames. If the inputs require it, the frames of a
    /// touch are combined.
    ///
    /// # Errors
    /// If foreign features cannot be computed.
    pub fn features(&self, inputs: &RowInputs, touches: &[usize]) -> Result<Array2<f64>> {
        let mut rows = Array2::zeros((touches.len(), inputs.n_features()));
        let Some(temporal_features) = inputs.temporal_features else {
            self.read_into(inputs, touches, rows.view_mut())?;
            return Ok(rows);
        };
        // Touches are processed one at a time, because all frames of all touches may exceed the memory.
        let m = inputs.n_frame_features();
        let mut frames = Array2::zeros((1, self.n_frames * m));
        for (row, touch) in rows.outer_iter_mut().zip(touches) {
            self.read_into(inputs, &[*touch], frames.view_mut())?;
            let frames = frames.view().into_shape_with_order((self.n_frames, m));
            temporal_features.write(frames.expect("F frames of m"), row);
        }
        Ok(rows)
    }

    /// Returns the numbers of the tilted copies of the given training touches; the numbers of copies follow the numbers of all readings. The first copy of each
    /// touch comes first, followed by the second copy of each.
    pub fn copies(&self, inputs: &RowInputs, train: &[usize]) -> Vec<usize> {
        let Some(copies) = &self.copies else {
            return Vec::new();
        };
        let n_read = self.values.nrows() / self.n_frames.max(1);
        let rows = copies.rows(train, inputs.n_copies);
        rows.map(|row| n_read + row).collect()
    }

    /// Writes the features of the given touches, shape (n, F·m): the first m measurements of each of their F frames.
    fn read_into(
        &self,
        inputs: &RowInputs,
        touches: &[usize],
        mut rows: ArrayViewMut2<f64>,
    ) -> Result<()> {
        let m = inputs.measurements;
        if let Some(wanted) = inputs.of_images() {
            let mut made = self.of_images.iter();
            let made = made.find(|(known, _)| *known == wanted);
            let (_, made) = made.expect("features of all configurations of the group");
            rows.assign(&made.select(Axis(0), touches));
            return Ok(());
        }
        if let Some(foreign) = inputs.features.foreign() {
            let places = touches.iter().flat_map(|touch| {
                let first = touch * self.n_frames;
                first..first + self.n_frames
            });
            let measured = self.values.slice(s![.., ..m]);
            let frames = measured.select(Axis(0), &places.collect::<Vec<_>>());
            let made = foreign.compute(frames.view())?;
            let made = made.to_shape(rows.raw_dim());
            rows.assign(&made.expect("one row of features for each frame"));
            return Ok(());
        }
        for (mut row, touch) in rows.outer_iter_mut().zip(touches) {
            for (frame, mut part) in row.exact_chunks_mut(m).into_iter().enumerate() {
                let place = touch * self.n_frames + frame;
                part.assign(&self.values.slice(s![place, ..m]));
            }
        }
        let of_ones = self.of_ones.slice(s![..m]);
        inputs.features.apply(rows, of_ones);
        Ok(())
    }
}

/// Set of touches with their simulated frames.
pub type MadeTouches<'a> = (&'a dyn TouchSet, &'a Frames);

/// Computes the measurements of all touches of a group in one trial, for each number of measurements in the inputs. If test touches are simulated differently,
/// `tested` contains as many touches in the same order, and the trial's test touches are read from `tested`.
///
/// # Errors
/// If a signal step or the projection is invalid.
pub fn measure_group(
    inputs: &MeasurementInputs,
    (touched, frames): MadeTouches,
    tested: MadeTouches,
    (trial, n_measurements): (MeasuredTrial, usize),
) -> Result<Measurements> {
    let array = inputs.array;
    let seed = Seed::new(inputs.seed);
    let skins = skins(inputs, (frames, tested.1), trial.number as u64)?;
    let signal = seed.named("signal").numbered(trial.number as u64);
    let n_frames = frames.facts.n_frames;
    let mut touches = touched.to_read(inputs.speed, n_frames, &signal);
    if let [_, skin] = &skins[..] {
        let of_test = tested.0.to_read(skin.speed, n_frames, &signal);
        for &touch in &trial.split().test {
            touches[touch] = TouchToRead {
                skin: 1,
                ..of_test[touch]
            };
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
        skins: &skins,
        projection: &whole,
    };
    let sensed = sensed_by(inputs, (reading, &touches), trial, n_measurements)?;
    let reading = Reading {
        projection: &sensed.projection,
        ..reading
    };
    let (mut values, cpu_s) = measure(reading, &touches)?;
    let mut copies = None;
    let of_images = match &sensed.images {
        None => Vec::new(),
        Some(images) => {
            let full_scale = skins[0].chains[0].full_scale();
            copies = tilted_copies(inputs, (trial, touched.classes().len()), full_scale);
            let mut wanted = inputs.of_images.clone();
            wanted.retain(|one| images.has_estimate(one.measurements));
            let made = images.features((values.view(), n_frames), &wanted, copies.as_ref());
            wanted.into_iter().zip(made).collect()
        }
    };
    let is_absent = array.patch().absent();
    sensed.projection.average_present(is_absent, &mut values);
    let ones = Array2::ones((1, array.n_values()));
    let selected = sensed
        .projection
        .taxels()
        .filter(|_| inputs.selection.is_some());
    Ok(Measurements {
        values,
        selected: selected.map_or_else(Vec::new, <[usize]>::to_vec),
        n_touches,
        n_frames,
        of_ones: sensed.projection.measure(ones.view()).row(0).to_owned(),
        of_images,
        copies,
        cpu_s,
    })
}

/// Draws the random tilts of copies of the training touches of n classes.
fn tilted_copies(
    inputs: &MeasurementInputs,
    (trial, n_classes): (MeasuredTrial, usize),
    full_scale: f64,
) -> Option<TiltedCopies> {
    let copies = inputs.copies?;
    let array = inputs.array;
    let steepest = copies.tilt.tan();
    let a_pixel = steepest * array.pixel() / array.taxel().stroke * full_scale;
    let seed = Seed::new(inputs.seed).named("tilted copies");
    let seed = seed.numbered(trial.number as u64);
    let train = (&trial.split().train[..], n_classes);
    Some(TiltedCopies::new(copies, train, a_pixel, &seed))
}

/// Draws the measurement matrix Φ of a trial at random, or fits it to training touches; also fits the image estimators.
fn sensed_by(
    inputs: &MeasurementInputs,
    (whole, touches): (Reading, &[TouchToRead]),
    trial: MeasuredTrial,
    n_measurements: usize,
) -> Result<SensedBy> {
    let array = inputs.array;
    let images = array.measured_images(inputs.ensemble);
    let drawn = projection_of(inputs.projections_per_split, trial.number) as u64;
    let drawn = Seed::new(inputs.seed).named("projection").numbered(drawn);
    let (train, touch_labels) = match trial.fitted {
        Some((split, labels)) => (&split.train[..], labels.as_slice()),
        None => (&[][..], None),
    };
    let touch_labels = touch_labels.unwrap_or_default();
    // The number of whole touches that give enough frames; the split alternates between objects.
    let n_frames = whole.skins[0].frames.facts.n_frames;
    let n_touches = learned_touches(n_frames);
    let train = &train[..n_touches.min(train.len())];
    let learned: Vec<TouchToRead> = train.iter().map(|&touch| touches[touch]).collect();
    let (training, _) = measure(whole, &learned)?;
    // The frames of a touch have its class and its group.
    let of_frames = |of_touch: &dyn Fn(usize) -> usize| -> Vec<usize> {
        let values = train
            .iter()
            .map(|&touch| repeat_n(of_touch(touch), n_frames));
        values.flatten().collect()
    };
    let frames = TrainingFrames {
        frames: training.view(),
        labels: &of_frames(&|touch| touch_labels[touch]),
        groups: &of_frames(&|touch| trial.group_keys.map_or(touch, |keys| keys[touch])),
        selection: inputs.selection.unwrap_or_default(),
    };
    let learn = |m| Projection::of_images(inputs.ensemble, images, m, (frames, &drawn));
    let projection = learn(n_measurements)?;
    let mut images = None;
    if !inputs.of_images.is_empty() {
        let untouched = untouched(whole, trial.number, inputs.seed);
        let readings = Readings {
            training: training.view(),
            untouched: untouched.view(),
        };
        let n_values = projection.n_measurements();
        let is_served = |m: &usize| inputs.ensemble.is_prefix_nested() || *m == n_values;
        let counts = inputs.counts_of_images().into_iter().filter(is_served);
        let projections = counts.map(|m| match m == n_values {
            true => Ok(projection.clone()),
            false => learn(m),
        });
        let projections = projections.collect::<Result<Vec<_>>>()?;
        let full_scale = whole.skins[0].chains[0].full_scale();
        images = Some(Images::new(
            &projections,
            (array, full_scale),
            readings,
            &drawn,
        )?);
    }
    Ok(SensedBy { projection, images })
}

/// Number of readings of the untouched skin from which its noise is estimated. The standard deviation of the noise then has a relative error of √(2 / 256) = 9
/// %.
pub const UNTOUCHED: usize = 256;

/// Returns readings of the untouched skin that the training touches use, shape (n_readings, n_taxels).
fn untouched(whole: Reading, trial: usize, seed: u64) -> Array2<f64> {
    let seed = Seed::new(seed).named("untouched").numbered(trial as u64);
    let mut readings = Array2::zeros((UNTOUCHED, whole.projection.n_taxels()));
    let mut scratch = SignalWorkspace::default();
    for (number, mut row) in readings.outer_iter_mut().enumerate() {
        let frame = row.as_slice_mut().expect("rows are whole");
        let named = seed.numbered(number as u64);
        whole.skins[0].chains[0].apply(frame, None, &named, &mut scratch);
    }
    readings
}

/// Returns the skin of the training touches. If the test touches have another skin, it follows.
fn skins<'a>(
    inputs: &MeasurementInputs<'a>,
    (learned, tested): (&'a Frames, &'a Frames),
    trial: u64,
) -> Result<Vec<ReadSkin<'a>>> {
    let make = |seed: Seed, differing: Option<&TestInputs<'a>>, frames| -> Result<ReadSkin<'a>> {
        let (array, signal, speed) = match differing {
            Some(test) => (test.array, &test.signal, test.speed),
            None => (inputs.array, &inputs.signal, inputs.speed),
        };
        Ok(ReadSkin {
            chains: array.chains(&seed, |skin| signal.steps(skin))?,
            array,
            speed,
            frames,
        })
    };
    let first = skin(&Seed::new(inputs.seed), inputs.array);
    let of_test = match inputs.test_sensor {
        TestSensor::SameSkin => first,
        TestSensor::AnotherSkin => first.named("another").numbered(trial),
    };
    let mut skins = vec![make(first, None, learned)?];
    if inputs.has_own_test() {
        skins.push(make(of_test, inputs.test.as_ref(), tested)?);
    }
    Ok(skins)
}
