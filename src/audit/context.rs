//! Quantities that several checks of an audit need, computed once.

use crate::audit::data::AuditData;
use crate::audit::deep_touches::DeepTouches;
use crate::audit::duplicate_pairs::DuplicatePairs;
use crate::audit::scores::{Features, Scores, Tested, scores};
use crate::audit::splits::{AuditSplit, splits, touches_of_classes};
use crate::calibration::{RecordedSkin, plateau};
use crate::error::Result;
use crate::quantile::quantile;
use crate::random::Seed;
use bubbletouch_sim::audit::dependence::{max_permutations, permutes_again};
use bubbletouch_sim::audit::missing::{count_missing, fill_missing, fill_padding};
use bubbletouch_sim::audit::pooled::{blocks_of, pooled, spans};
use bubbletouch_sim::audit::surroundings::Surroundings;
use bubbletouch_sim::audit::taxels::{
    TaxelReadings, active_std, constant_contact, contact_sums, taxel_readings, untouched_taxels,
    without_class_means,
};
use bubbletouch_sim::features::{Cut, ImageFeature, ImageFeatures, Join, Workspace};
use bubbletouch_svm::audit::{Readability, readability};
use ndarray::{Array1, Array2, ArrayView2, Axis};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::OnceLock;

/// Maximum number of touches in permutation tests and in statistics of taxels. More touches find smaller effects and take time in proportion to the square.
const MAX_SAMPLE: usize = 1000;
/// Maximum numbers of block means of a touch: for touches of a single frame, and for touches of several frames.
const MAX_BLOCKS: [usize; 2] = [256, 512];
/// Maximum number of pixels of the image from which shift-invariant features are computed.
const MAX_PIXELS: usize = 1024;

/// Number of permutations for a source without a p-value: they resolve the 95 % quantile of the accuracy.
const N_UNTESTED: usize = 99;

/// Options of an audit.
#[derive(Clone, Debug, PartialEq)]
pub struct AuditOptions {
    /// Seed of splits and permutations.
    pub seed: u64,
    /// Number of permutations of each test. If none of them reaches the observed value, four times as many, at least 4,000, are made.
    pub n_permutations: usize,
    /// Frames of each touch that are known to precede the contact; `None` to find them.
    pub before_contact: Option<Range<usize>>,
}

impl Default for AuditOptions {
    fn default() -> Self {
        Self {
            seed: 2018,
            n_permutations: 999,
            before_contact: None,
        }
    }
}

/// Data of an audit, and quantities that several checks need.
pub struct Context {
    /// Data set; missing readings are replaced.
    pub data: AuditData,
    /// Options of the audit.
    pub options: AuditOptions,
    /// Number of padded frames at the end of each touch; their readings are replaced by other frames of the touch.
    pub n_padded: Vec<usize>,
    /// Number of missing readings of each taxel, without padded frames.
    pub n_missing: Vec<usize>,
    /// Class of each touch; 0 without labels.
    pub labels: Vec<usize>,
    /// Number of classes that have touches.
    pub n_classes: usize,
    /// Randomly drawn touches, in the order of recording.
    pub sample: Vec<usize>,
    /// Class of each sampled touch.
    pub sample_labels: Vec<usize>,
    /// Mean frame of each sampled touch, shape (n_sample, n_taxels).
    pub sample_rows: Array2<f64>,
    /// Mean frames of sampled touches less the means of their classes.
    pub residuals: Array2<f64>,
    /// Standard deviation of the readings of active taxels within a class.
    pub active_std: f64,
    /// Sum of the readings of active taxels for each sampled touch.
    pub contact: Vec<f64>,
    /// Whether each taxel is never touched.
    pub is_untouched: Vec<bool>,
    /// Mean, spread and range of each taxel over sampled frames.
    pub taxels: Vec<TaxelReadings>,
    /// Sampled frames as fractions of the full scale.
    pub skin: RecordedSkin,
    /// Class of each sampled frame.
    pub frame_labels: Vec<usize>,
    /// Unit of each sampled frame: its group, or the touches of one class that follow each other. Contacts within a unit can be alike.
    pub frame_units: Vec<usize>,
    /// Taxels around each taxel; `None` for taxels without rows and columns whose readings contact may change in both directions.
    pub around: Option<Surroundings>,
    /// Reading of an untouched taxel, and the reading at full scale. The reading at full scale is smaller if contact reduces the readings.
    pub scale: (f64, f64),
    /// Largest reading if several taxels share it in many frames, as a fraction of the full scale; otherwise `None`.
    pub plateau: Option<f64>,
    /// Features of all touches.
    pub features: Features,
    /// Splits; empty without labels.
    pub splits: Vec<AuditSplit>,
    /// Results of the classifiers; `None` without labels.
    pub scores: Option<Scores>,
    /// Readability of the labels from sources other than the contact, by name of the source.
    pub readable: BTreeMap<&'static str, Readability>,
    /// Near-duplicates, once they have been searched.
    pub near_duplicates: OnceLock<Option<DuplicatePairs>>,
    /// Touches that lie deep in a class, once they have been searched.
    pub deep_touches: OnceLock<Option<DeepTouches>>,
}

impl Context {
    /// Computes the common quantities of all checks.
    ///
    /// # Errors
    /// If the data are inconsistent.
    pub fn new(mut data: AuditData, options: AuditOptions) -> Result<Self> {
        data.check()?;
        let seed = Seed::new(options.seed).named("audit");
        let mut n_missing = count_missing(data.frames.view());
        let n_padded = fill_padding(&mut data.frames, data.n_frames);
        let n_frames_of_padding: usize = n_padded.iter().sum();
        for count in &mut n_missing {
            *count -= n_frames_of_padding;
        }
        fill_missing(&mut data.frames, &n_missing);
        let n = data.n_touches();
        let labels = data.labels.clone().unwrap_or_else(|| vec![0; n]);
        let classes = labels.iter().collect::<BTreeSet<_>>();
        let n_classes = classes.len();
        let sample = drawn(n, MAX_SAMPLE, &seed.named("sample"));
        let sample_labels: Vec<usize> = sample.iter().map(|&touch| labels[touch]).collect();
        let frames_of = |touch: &usize| touch * data.n_frames..(touch + 1) * data.n_frames;
        let sampled: Vec<usize> = sample.iter().flat_map(frames_of).collect();
        let sampled = data.frames.select(Axis(0), &sampled);
        let sample_rows = spans(sampled.view(), data.n_frames, 1);
        let residuals = without_class_means(sample_rows.view(), &sample_labels);
        let active_std = active_std(residuals.view());
        let contact = contact_sums(residuals.view(), active_std);
        let mut is_untouched = untouched_taxels(
            (sample_rows.view(), residuals.view()),
            None,
            &contact,
            active_std,
        );
        let is_pressed =
            constant_contact(sample_rows.view(), &sample_labels, data.grid, active_std);
        // Touches of many frames need no more frames than touches of one. Equal steps could omit the same frames of all touches.
        let some = drawn(sampled.nrows(), 2 * MAX_SAMPLE, &seed.named("frames"));
        let touch_of = |frame: &usize| frame / data.n_frames;
        let frame_labels = some.iter().map(|frame| sample_labels[touch_of(frame)]);
        let frame_labels: Vec<usize> = frame_labels.collect();
        let units = units(data.groups.as_deref(), &sample, &sample_labels);
        let frame_units = some.iter().map(|frame| units[touch_of(frame)]).collect();
        let some = sampled.select(Axis(0), &some);
        let taxels = taxel_readings(some.view());
        let active = (0..taxels.len())
            .filter(|&taxel| residuals.column(taxel).std(0.0) > 0.25 * active_std)
            .collect::<Vec<_>>();
        let direction = direction(some.view(), &taxels, &active);
        let (scale, skin) = skin(&data, &some, &taxels, direction.is_increasing);
        let around = match data.grid {
            Some(grid) => Some(Surroundings::of_grid(grid)),
            None => (direction.is_one_sided).then(|| Surroundings::of_list(skin.touched.view())),
        };
        // A taxel above half of the full scale in most frames is in contact.
        let level = scale.0 + 0.5 * (scale.1 - scale.0);
        for (taxel, is_untouched) in is_untouched.iter_mut().enumerate() {
            let is_varying = !taxels[taxel].is_constant();
            let is_in_contact = (taxels[taxel].median > level) == direction.is_increasing;
            *is_untouched &= !(is_pressed[taxel] || is_varying && is_in_contact);
        }
        let features = features(&data, &taxels);
        let has_classes = data.labels.is_some() && n_classes > 1;
        let (groups, sessions) = (data.groups.as_deref(), data.sessions.as_deref());
        let splits = match has_classes {
            true => splits(&labels, groups, sessions, data.is_test.as_deref(), &seed),
            false => Vec::new(),
        };
        let n_labels = data.classes.len().max(1);
        let scores = match has_classes {
            true => Some(scores(&features, (&labels, n_labels), &splits, &seed)?),
            false => None,
        };
        let plateau = plateau_of(&skin, &taxels);
        Ok(Self {
            n_padded,
            n_missing,
            labels,
            n_classes,
            sample,
            sample_labels,
            sample_rows,
            residuals,
            active_std,
            contact,
            is_untouched,
            taxels,
            skin,
            frame_labels,
            frame_units,
            around,
            scale,
            plateau,
            features,
            splits,
            scores,
            readable: BTreeMap::new(),
            near_duplicates: OnceLock::new(),
            deep_touches: OnceLock::new(),
            data,
            options,
        })
    }

    /// Returns the random stream of a check.
    pub fn seed(&self, name: &str) -> Seed {
        Seed::new(self.options.seed).named("audit").named(name)
    }

    /// Returns whether a test needs another permutation after `n_done` permutations, of which `at_least` reach the observed value. If none of them does, more
    /// permutations resolve smaller p-values.
    pub fn permutes_again(&self, n_done: usize, at_least: usize) -> bool {
        permutes_again(self.options.n_permutations, n_done, at_least)
    }

    /// Returns whether the labels contain at least two classes.
    pub fn has_classes(&self) -> bool {
        self.scores.is_some()
    }

    /// Tests whether the labels of the sampled touches can be read from some features. With `holds_out_groups`, the label of a touch is read from the touches
    /// of other groups, if at least two classes have touches in several groups. Rows that begin with NaN are omitted. If `is_tested` is
    /// false, few permutations are made, which do not resolve a p-value.
    pub fn readability(
        &self,
        rows: ArrayView2<f64>,
        name: &str,
        holds_out_groups: bool,
        is_tested: bool,
    ) -> Option<Readability> {
        let seed = self.seed(name);
        let places = (0..rows.nrows()).filter(|&place| !rows[(place, 0)].is_nan());
        let places: Vec<usize> = places.collect();
        let labels: Vec<usize> = places
            .iter()
            .map(|&place| self.sample_labels[place])
            .collect();
        let groups = self.data.groups.as_ref();
        let groups = groups.filter(|_| holds_out_groups);
        let groups = groups.map(|groups| {
            let of_places = places.iter().map(|&place| groups[self.sample[place]]);
            of_places.collect::<Vec<usize>>()
        });
        let is_held_out = |groups: &Vec<usize>| {
            let cells: BTreeSet<_> = labels.iter().zip(groups).collect();
            let mut n_groups = BTreeMap::<usize, usize>::new();
            for (&label, _) in cells {
                *n_groups.entry(label).or_default() += 1;
            }
            n_groups.into_values().filter(|&n| n > 1).count() > 1
        };
        let n_permutations = self.options.n_permutations;
        let n_permutations = match is_tested {
            true => n_permutations..=max_permutations(n_permutations),
            false => N_UNTESTED..=N_UNTESTED,
        };
        readability(
            rows.select(Axis(0), &places).view(),
            &labels,
            groups.filter(is_held_out).as_deref(),
            n_permutations,
            &seed,
        )
    }

    /// Returns frame `frame` of each sampled touch, shape (n_sample, n_taxels).
    pub fn frame_of_touches(&self, frame: usize) -> Array2<f64> {
        let rows = self
            .sample
            .iter()
            .map(|touch| touch * self.data.n_frames + frame);
        self.data.frames.select(Axis(0), &rows.collect::<Vec<_>>())
    }

    /// Returns the results of a split by its index.
    pub fn tested(&self, split: usize) -> impl Iterator<Item = &Tested> {
        let tested = self.scores.iter().flat_map(|scores| &scores.tested);
        tested.filter(move |tested| tested.split == split)
    }

    /// Returns the most accurate classifier by the random split; `None` without labels.
    pub fn best_at_random(&self) -> Option<&Tested> {
        self.tested(0)
            .max_by(|a, b| a.accuracy().total_cmp(&b.accuracy()))
    }

    /// Returns the rows of block means of the sampled touches.
    pub fn sample_features(&self) -> Array2<f64> {
        self.features.blocks.select(Axis(0), &self.sample)
    }

    /// Returns the accuracy of a classifier that always predicts the most frequent class.
    pub fn chance(&self) -> f64 {
        let largest = touches_of_classes(&self.labels)
            .into_values()
            .map(|touches| touches.len())
            .max();
        largest.unwrap_or(0) as f64 / self.labels.len() as f64
    }
}

/// Draws at most `n_drawn` of the numbers 0..n at random, and returns them in ascending order.
fn drawn(n: usize, n_drawn: usize, seed: &Seed) -> Vec<usize> {
    let mut numbers: Vec<usize> = (0..n).collect();
    numbers.shuffle(&mut seed.rng());
    numbers.truncate(n_drawn);
    numbers.sort_unstable();
    numbers
}

/// Returns the unit of each sampled touch: its group, or the run of touches of one class to which it belongs.
fn units(groups: Option<&[usize]>, sample: &[usize], labels: &[usize]) -> Vec<usize> {
    if let Some(groups) = groups {
        return sample.iter().map(|&touch| groups[touch]).collect();
    }
    let mut unit = 0;
    let units = (0..labels.len()).map(|place| {
        unit += usize::from(place > 0 && labels[place] != labels[place - 1]);
        unit
    });
    units.collect()
}

/// Direction in which contact changes the readings.
struct Direction {
    /// Whether contact increases most readings.
    is_increasing: bool,
    /// Whether contact changes the readings of nearly all taxels in the same direction.
    is_one_sided: bool,
}

/// Minimum fraction of active taxels with the same sign of the skewness, from which contact is one-sided.
const MIN_ONE_SIDED: f64 = 0.9;

/// Finds the direction of contact by the skewness of the active taxels: contact is rarer or more variable than rest.
fn direction(frames: ArrayView2<f64>, taxels: &[TaxelReadings], active: &[usize]) -> Direction {
    let cubes = active.iter().map(|&taxel| {
        let (mean, readings) = (taxels[taxel].mean, frames.column(taxel));
        readings.iter().map(|x| (x - mean).powi(3)).sum::<f64>()
    });
    let cubes: Vec<f64> = cubes.collect();
    let n_positive = cubes.iter().filter(|&&cube| cube > 0.0).count() as f64;
    let share = n_positive / cubes.len().max(1) as f64;
    let mut medians: Vec<f64> = taxels.iter().map(|taxel| taxel.median).collect();
    let zero = quantile(&mut medians, 0.5);
    let ends = active.iter().map(|&taxel| &taxels[taxel]);
    let [below, above] = ends.fold([0.0_f64; 2], |[below, above], taxel| {
        [
            below.max(zero - taxel.least),
            above.max(taxel.largest - zero),
        ]
    });
    Direction {
        is_increasing: above >= below || share > 1.0 - MIN_ONE_SIDED,
        is_one_sided: !(1.0 - MIN_ONE_SIDED..=MIN_ONE_SIDED).contains(&share),
    }
}

/// Returns the readings at zero and at full scale, and the frames as fractions of the full scale. If contact reduces the readings, the full scale is the smallest
/// reading.
fn skin(
    data: &AuditData,
    frames: &Array2<f64>,
    taxels: &[TaxelReadings],
    is_increasing: bool,
) -> ((f64, f64), RecordedSkin) {
    // At least a quarter of the taxels is at rest in most frames.
    let mut medians: Vec<f64> = taxels.iter().map(|taxel| taxel.median).collect();
    let zero = quantile(&mut medians, if is_increasing { 0.25 } else { 0.75 });
    let end = match is_increasing {
        true => taxels
            .iter()
            .map(|taxel| taxel.largest)
            .fold(f64::NEG_INFINITY, f64::max),
        false => taxels
            .iter()
            .map(|taxel| taxel.least)
            .fold(f64::INFINITY, f64::min),
    };
    let is_beyond = |full: &f64| {
        if is_increasing {
            *full > zero
        } else {
            *full < zero
        }
    };
    let full_scale = data.full_scale.filter(is_beyond).unwrap_or(end);
    let range = match is_beyond(&full_scale) {
        true => full_scale - zero,
        false => 1.0,
    };
    let skin = RecordedSkin {
        shape: data.grid.unwrap_or((1, frames.ncols())),
        touched: frames.mapv(|reading| (reading - zero) / range),
        touched_times: Array1::linspace(0.0, 1.0, frames.nrows()),
        untouched: Array2::zeros((0, frames.ncols())),
        untouched_times: Array1::zeros(0),
        forces: None,
        stroke: None,
    };
    ((zero, full_scale), skin)
}

/// Returns the level at which readings are clipped: the full scale if it is known, otherwise a plateau of the largest readings. Constant taxels do not count.
fn plateau_of(skin: &RecordedSkin, taxels: &[TaxelReadings]) -> Option<f64> {
    let is_constant: Vec<bool> = taxels.iter().map(|taxel| taxel.is_constant()).collect();
    plateau(|| {
        skin.touched.outer_iter().map(|frame| {
            let readings = frame.into_iter().zip(&is_constant);
            readings.map(|(&reading, &is_constant)| if is_constant { f64::NAN } else { reading })
        })
    })
}

/// Computes the features of all touches.
fn features(data: &AuditData, taxels: &[TaxelReadings]) -> Features {
    let max_blocks = MAX_BLOCKS[usize::from(data.n_frames > 1)];
    let blocks = pooled(data.frames.view(), data.n_frames, data.grid, max_blocks);
    let is_image = |grid: &(usize, usize)| grid.0.min(grid.1) >= 4;
    let grid = data.grid.filter(is_image);
    let image = grid.map_or((0, 0), |grid| blocks_of(grid, MAX_PIXELS).0);
    let invariant = grid.map(|grid| {
        let mean = spans(data.frames.view(), data.n_frames, 1);
        let least: Array1<f64> = taxels.iter().map(|taxel| taxel.least).collect();
        let images = pooled((mean - &least).view(), 1, Some(grid), MAX_PIXELS);
        fourier_magnitudes(&images, image)
    });
    Features {
        blocks,
        invariant,
        image,
    }
}

/// Computes the Fourier magnitudes of images, one image per row.
fn fourier_magnitudes(images: &Array2<f64>, shape: (usize, usize)) -> Array2<f64> {
    let feature = ImageFeature::FourierMagnitude;
    let n_values = (feature.about().n_values)(shape);
    let full_scale = images.iter().copied().fold(0.0, f64::max);
    let join = Join::new(&[feature]).expect("a join of one feature");
    let prepared = ImageFeatures::new(join, shape, full_scale, Cut::default());
    let mut rows = Array2::zeros((images.nrows(), n_values));
    rows.axis_chunks_iter_mut(Axis(0), 64)
        .into_par_iter()
        .zip(images.axis_chunks_iter(Axis(0), 64).into_par_iter())
        .for_each_init(Workspace::default, |workspace, (mut rows, images)| {
            for (mut row, image) in rows.rows_mut().into_iter().zip(images.rows()) {
                let (image, row) = (image.to_vec(), row.as_slice_mut());
                prepared.write(&image, workspace, row.expect("rows of one array"));
            }
        });
    rows
}
