//! Image features: features of frame images that are estimated from measurements, also of tilted copies of training touches.

use crate::sensing::{ImageEstimate, ImagePrior, Readings};
use crate::studies::prelude::*;
use crate::studies::recognition::measurements::CopyInputs;
use crate::studies::recognition::plan::SensorImage;
use crate::studies::recognition::rows::{FeaturesOfImages, join_values};
use crate::studies::recognition::sweep::{LEARNED_FRAMES, WITH_COPIES};
use bubbletouch_sim::features::{Cut, FeatureWorkspace, ImageFeatures, tilt_frame};
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, s};
use rand::Rng;
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// Number of frames that are estimated together by one matrix product. A fixed number makes results independent of the number of threads.
const BLOCK: usize = 64;

/// Estimators that compute images of frames from measurements: one for each number of measurements that a group of configurations uses.
#[derive(Clone, Debug)]
pub struct Images {
    /// Images of a frame: one for each sensor.
    sensors: Vec<SensorImage>,
    full_scale: f64,
    /// Image estimators, each with its number m of measurements.
    estimates: Vec<(usize, ImageEstimate)>,
}

impl Images {
    /// Fits one image estimator for each projection (measurement matrix) of an array.
    ///
    /// # Errors
    /// If an estimator cannot be fitted.
    pub fn new(
        projections: &[Projection],
        (array, full_scale): (&TaxelArray, f64),
        readings: Readings,
        seed: &Seed,
    ) -> Result<Self> {
        let is_whole =
            |projection: &Projection| projection.ensemble().is_some_and(Ensemble::gives_frames);
        let (sensors, n_training) = (array.images(), readings.training.nrows());
        // Shifting an image by rows and columns gives additional training images.
        let n_frames = match (array.is_image(), n_training < LEARNED_FRAMES) {
            (false, _) => n_training,
            (true, true) => WITH_COPIES,
            (true, false) => LEARNED_FRAMES,
        };
        let prior = match projections.iter().all(is_whole) {
            true => None,
            false => {
                let shape = array.frame_shape();
                Some(ImagePrior::learned(shape, readings, n_frames, seed)?)
            }
        };
        let estimates = projections.iter().map(|projection| {
            let estimate = match prior.as_ref().filter(|_| !is_whole(projection)) {
                None => ImageEstimate::of_frames(projection.measure(readings.untouched).view()),
                Some(prior) => ImageEstimate::new(projection, prior)?,
            };
            Ok((projection.n_measurements(), estimate))
        });
        Ok(Self {
            sensors,
            full_scale,
            estimates: estimates.collect::<Result<_>>()?,
        })
    }

    /// Returns whether images can be estimated from the given number of measurements.
    pub fn has_estimate(&self, measurements: usize) -> bool {
        self.estimates.iter().any(|(m, _)| *m == measurements)
    }

    /// Returns the image features of all frames: one array for each requested kind. A row contains the k values of each of the F frames of a touch, shape
    /// (n_touches, F·k). The rows of all tilted copies follow in the same order. Each image is estimated once and then used for all kinds of features.
    ///
    /// # Panics
    /// If there is no estimator for the number of measurements.
    pub fn features(
        &self,
        (values, n_frames): (ArrayView2<f64>, usize),
        wanted: &[FeaturesOfImages],
        copies: Option<&TiltedCopies>,
    ) -> Vec<Array2<f64>> {
        let n_touches = values.nrows() / n_frames.max(1);
        let n_rows = n_touches + copies.map_or(0, |copies| copies.slopes.len());
        let shapes: Vec<_> = self.sensors.iter().map(|sensor| sensor.shape).collect();
        let n_values = |w: &FeaturesOfImages| join_values(w.join, &shapes);
        let empty = |w: &FeaturesOfImages| Array2::zeros((n_rows, n_frames * n_values(w)));
        let mut all: Vec<Array2<f64>> = wanted.iter().map(empty).collect();
        for (m, estimate) in &self.estimates {
            let of_m = wanted.iter().zip(&mut all);
            let of_m = of_m.filter(|(w, _)| w.measurements == *m);
            let (features, rows): (Vec<_>, Vec<_>) = of_m
                .map(|(w, rows)| (self.prepared(w, estimate), rows.view_mut()))
                .unzip();
            let parts = rows.into_iter().map(|r| r.split_at(Axis(0), n_touches));
            let (rows, of_copies): (Vec<_>, Vec<_>) = parts.unzip();
            let blocks_of_touches = blocks(rows, n_touches, 1).into_par_iter();
            blocks_of_touches.for_each_init(
                FeatureWorkspace::default,
                |workspace, (touches, mut rows)| {
                    let frames = touches.start * n_frames..touches.end * n_frames;
                    let images = self.images(estimate, values.slice(s![frames, ..*m]));
                    for row in 0..touches.len() {
                        let images = of_touch(&images, row, n_frames);
                        write(&features, &images, workspace, (&mut rows, row));
                    }
                },
            );
            let Some(TiltedCopies {
                touches,
                n_copies,
                slopes,
                ..
            }) = copies
            else {
                continue;
            };
            let blocks_of_copies = blocks(of_copies, touches.len(), *n_copies).into_par_iter();
            blocks_of_copies.for_each_init(
                FeatureWorkspace::default,
                |workspace, (places, mut rows)| {
                    let slopes = &slopes[places.start * n_copies..places.end * n_copies];
                    let frames = touches[places].iter();
                    let frames = frames.flat_map(|touch| touch * n_frames..(touch + 1) * n_frames);
                    let measured = values.select(Axis(0), &frames.collect::<Vec<usize>>());
                    let images = self.images(estimate, measured.slice(s![.., ..*m]));
                    for (row, &slope) in slopes.iter().enumerate() {
                        let images = of_touch(&images, row / n_copies, n_frames);
                        let tilted = self.tilted(&images, slope, estimate);
                        let tilted: Vec<_> = tilted.iter().map(Array2::view).collect();
                        write(&features, &tilted, workspace, (&mut rows, row));
                    }
                },
            );
        }
        all
    }

    /// Estimates the images of frames from their measurements: one array for each sensor. Each image (ny × nx pixels) is one row of an array.
    fn images(&self, estimate: &ImageEstimate, measured: ArrayView2<f64>) -> Vec<Array2<f64>> {
        let frames = estimate.images(measured);
        if let [SensorImage { chart: None, .. }] = &self.sensors[..] {
            return vec![frames];
        }
        let image = |sensor: &SensorImage| {
            let own = frames.slice(s![.., sensor.taxels.clone()]);
            match &sensor.chart {
                Some(chart) => chart.images(own),
                None => own.to_owned(),
            }
        };
        self.sensors.iter().map(image).collect()
    }

    /// Returns the images of a touch, tilted by a slope along x and y: for each sensor an array of shape (F, ny · nx).
    fn tilted(
        &self,
        images: &[ArrayView2<f64>],
        slope: (f64, f64),
        estimate: &ImageEstimate,
    ) -> Vec<Array2<f64>> {
        let tilt = |(sensor, images): (&SensorImage, &ArrayView2<f64>)| {
            let level = level(sensor, estimate);
            let mut tilted = Array2::zeros(images.raw_dim());
            for (image, mut out) in images.outer_iter().zip(tilted.outer_iter_mut()) {
                let image = image.as_standard_layout();
                let image = image.as_slice().expect("rows are whole");
                let out = out.as_slice_mut().expect("rows are whole");
                tilt_frame(image, sensor.shape.nx, slope, level, out);
            }
            tilted
        };
        self.sensors.iter().zip(images).map(tilt).collect()
    }

    /// Returns the image features of each sensor with their numbers of values, prepared for the shape and the noise of its images.
    fn prepared(&self, wanted: &FeaturesOfImages, estimate: &ImageEstimate) -> Vec<Prepared> {
        let foremost = wanted.foremost.map(|share| share * self.full_scale);
        let prepare = |sensor: &SensorImage| {
            let level = level(sensor, estimate);
            let cut = Cut { level, foremost };
            let n_values = wanted.join.n_values(sensor.shape);
            let features = ImageFeatures::new(wanted.join, sensor.shape, self.full_scale, cut);
            (features, n_values)
        };
        self.sensors.iter().map(prepare).collect()
    }
}

/// Image features of one sensor, with their number of values.
type Prepared = (ImageFeatures, usize);

/// Returns the images of one touch with F frames: for each sensor a view of shape (F, ny · nx).
fn of_touch(images: &[Array2<f64>], touch: usize, n_frames: usize) -> Vec<ArrayView2<'_, f64>> {
    let frames = touch * n_frames..(touch + 1) * n_frames;
    let own = images.iter();
    own.map(|images| images.slice(s![frames.clone(), ..]))
        .collect()
}

/// Returns the reading above which a pixel of an estimated image counts as in contact.
fn level(sensor: &SensorImage, estimate: &ImageEstimate) -> f64 {
    noise_level(estimate.noise_std(), sensor.shape.n_values())
}

/// Divides the rows of all requested features into blocks of touches; returns the index and the rows of each block.
fn blocks(
    mut rows: Vec<ArrayViewMut2<f64>>,
    n_touches: usize,
    n_rows: usize,
) -> Vec<(Range<usize>, Vec<ArrayViewMut2<f64>>)> {
    let mut blocks = Vec::new();
    for start in (0..n_touches).step_by(BLOCK) {
        let n = BLOCK.min(n_touches - start);
        let cut = rows.into_iter().map(|r| r.split_at(Axis(0), n * n_rows));
        let (own, rest): (Vec<_>, Vec<_>) = cut.unzip();
        rows = rest;
        blocks.push((start..start + n, own));
    }
    blocks
}

/// Writes all image features of a touch with F frames into one row of each feature array. The features of a frame are those of its sensors, one after the
/// other.
fn write(
    features: &[Vec<Prepared>],
    images: &[ArrayView2<f64>],
    workspace: &mut FeatureWorkspace,
    (rows, row): (&mut [ArrayViewMut2<f64>], usize),
) {
    let n_frames = images[0].nrows();
    for (features, rows) in features.iter().zip(rows) {
        let k = rows.ncols() / n_frames;
        let mut row = rows.row_mut(row);
        let row = row.as_slice_mut().expect("rows are whole");
        for (frame, mut out) in row.chunks_exact_mut(k).enumerate() {
            for ((features, n_values), images) in features.iter().zip(images) {
                let (own, rest) = out.split_at_mut(*n_values);
                out = rest;
                let image = images.row(frame);
                let image = image.as_standard_layout();
                features.write(image.as_slice().expect("rows are whole"), workspace, own);
            }
        }
    }
}

/// Returns the expected maximum of noise with standard deviation σ on n taxels, σ √(2 ln n); readings above it count as contact. With a lower threshold,
/// untouched taxels would count; with a higher one, the rim of a contact would not. (Donoho and Johnstone 1994, Biometrika 81, 425: the universal threshold.)
fn noise_level(noise_std: f64, n_taxels: usize) -> f64 {
    noise_std * (2.0 * (n_taxels as f64).ln()).sqrt()
}

/// Tilted copies of touches: the copied touches, and the tilt of each copy.
#[derive(Clone, Debug)]
pub struct TiltedCopies {
    /// Numbers of the touches that are copied.
    pub touches: Vec<usize>,
    /// Number of tilted copies of each touch in `touches`.
    pub n_copies: usize,
    /// Slope of each copy of each touch along x and y: increase of the reading from one taxel to the next.
    pub slopes: Vec<(f64, f64)>,
    /// Position in `touches` of each copied touch.
    places: HashMap<usize, usize>,
}

impl TiltedCopies {
    /// Draws the tilts of copies of training touches. The touches are given in drawing order and alternate between n classes; each has its own random stream.
    /// `steepest` is the maximum increase of a reading from one taxel to the next.
    pub fn new(
        CopyInputs {
            n_copies,
            n_touches,
            tilt: _,
        }: CopyInputs,
        (train, n_classes): (&[usize], usize),
        steepest: f64,
        seed: &Seed,
    ) -> Self {
        // The order alternates between objects, so that configurations with fewer touches use a prefix.
        let n_touches = n_touches.map_or(train.len(), |n| n * n_classes);
        let touches = train[..n_touches.min(train.len())].to_vec();
        let mut slopes = Vec::with_capacity(touches.len() * n_copies);
        for &touch in &touches {
            let mut rng = seed.numbered(touch as u64).rng();
            let mut slope = || steepest * rng.gen_range(-1.0..=1.0);
            slopes.extend((0..n_copies).map(|_| (slope(), slope())));
        }
        let places = touches.iter().copied().zip(0..).collect();
        Self {
            touches,
            n_copies,
            slopes,
            places,
        }
    }

    /// Returns the row numbers of the first `n_copies` tilted copies of the given touches, ordered by copy, then by touch.
    ///
    /// # Panics
    /// If a touch was not copied, or if there are fewer copies.
    pub fn rows(&self, touches: &[usize], n_copies: usize) -> impl Iterator<Item = usize> {
        assert!(n_copies <= self.n_copies, "copies that there are");
        let all = (0..n_copies).flat_map(move |copy| touches.iter().map(move |t| (copy, t)));
        all.map(|(copy, touch)| self.places[touch] * self.n_copies + copy)
    }
}
