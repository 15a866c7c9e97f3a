//! Quantities that several checks of an audit need, computed once.

use crate::audit::data::AuditData;
use crate::audit::sources::SOURCES;
use crate::audit::splits::{AuditSplit, Tested, scores, splits, touches_of_classes};
use crate::error::{Error, Result};
use crate::random::Seed;
use bubbletouch_sim::audit::copies::N_NEAREST;
use bubbletouch_sim::audit::dependence::without_class_means;
use bubbletouch_sim::audit::missing::{count_missing, fill_missing, fill_padding};
use bubbletouch_sim::audit::pooled::{pooled, spans};
use bubbletouch_sim::audit::spectrum::log_spectra;
use bubbletouch_sim::audit::taxels::{TaxelReadings, taxel_readings};
use bubbletouch_svm::audit::{NearestRows, Readability, readability};
use ndarray::{Array2, ArrayView2, Axis};
use rand::seq::SliceRandom;
use std::collections::BTreeSet;
use std::ops::{Range, RangeInclusive};

/// Maximum number of touches in permutation tests. More touches find smaller effects and take time in proportion to the square.
const MAX_SAMPLE: usize = 800;
/// Maximum number of frames in statistics of taxels.
const MAX_FRAMES: usize = 2000;
/// Maximum number of block means of a touch. More means show smaller contacts and take time in proportion.
pub const MAX_BLOCKS: usize = 256;
/// Maximum number of blocks of taxels whose spectra are computed.
const MAX_CHANNELS: usize = 16;

/// Options of an audit.
#[derive(Clone, Debug, PartialEq)]
pub struct AuditOptions {
    /// Seed of splits and permutations.
    pub seed: u64,
    /// Number of permutations of each test. If none of them reaches the statistic, four times as many are made.
    pub n_permutations: usize,
    /// Frames of each touch that are known to precede the contact.
    pub before_contact: Option<Range<usize>>,
    /// Taxels that nothing touches.
    pub untouched: Vec<usize>,
    /// Names of the sources that are not part of the claim: a class that can be read from them is a fault. `None` for those of which
    /// [`Source::is_claimed`](super::sources::Source) is false.
    pub not_claimed: Option<Vec<String>>,
    /// Split of the claim: `group`, `session`, `time` or `given`; `None` for every split that the data allow.
    pub split: Option<String>,
}

impl Default for AuditOptions {
    fn default() -> Self {
        Self {
            seed: 2018,
            n_permutations: 999,
            before_contact: None,
            untouched: Vec::new(),
            not_claimed: None,
            split: None,
        }
    }
}

impl AuditOptions {
    /// Checks the options with the data. `place` returns the name of an option in messages.
    ///
    /// # Errors
    /// If an option does not fit the data; the error names it.
    pub fn check(&self, data: &AuditData, place: impl Fn(&str) -> String) -> Result<()> {
        let (n_frames, n_taxels) = (data.n_frames, data.frames.ncols());
        let refuse = |name: &str, given: String, allowed: String| {
            Err(Error::input(place(name), given, allowed))
        };
        if let Some(Range { start, end }) = &self.before_contact
            && (start >= end || *end > n_frames)
        {
            let allowed = format!("a first frame below the end, which is at most {n_frames}");
            return refuse("before_contact", format!("{start}..{end}"), allowed);
        }
        if let Some(taxel) = self.untouched.iter().find(|&&taxel| taxel >= n_taxels) {
            let allowed = format!("taxels from 0 to {}", n_taxels - 1);
            return refuse("untouched", taxel.to_string(), allowed);
        }
        let names = SOURCES.map(|source| source.name);
        let mut not_claimed = self.not_claimed.iter().flatten();
        if let Some(name) = not_claimed.find(|name| !names.contains(&&name[..])) {
            return refuse("not_claimed", name.clone(), names.join(", "));
        }
        let splits = [
            ("group", data.groups.is_some()),
            ("session", data.sessions.is_some()),
            ("time", true),
            ("given", data.is_test.is_some()),
        ];
        let splits = splits.into_iter().filter(|(_, has)| *has);
        let splits: Vec<&str> = splits.map(|(name, _)| name).collect();
        match &self.split {
            Some(split) if !splits.contains(&&split[..]) => {
                let allowed = format!("{} with these data", splits.join(", "));
                refuse("split", split.clone(), allowed)
            }
            _ => Ok(()),
        }
    }

    /// Returns the range of the numbers of permutations of a test.
    pub fn permutations(&self) -> RangeInclusive<usize> {
        self.n_permutations..=4 * self.n_permutations
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
    /// Whether the labels contain at least two classes.
    pub has_classes: bool,
    /// Randomly drawn touches, in the order of recording.
    pub sample: Vec<usize>,
    /// Class of each sampled touch.
    pub sample_labels: Vec<usize>,
    /// Mean frame of each touch, shape (n, n_taxels).
    pub means: Array2<f64>,
    /// Sampled frames, shape (at most 2,000, n_taxels).
    pub frames: Array2<f64>,
    /// Touch of each sampled frame.
    pub frame_touches: Vec<usize>,
    /// Mean, spread and range of each taxel over sampled frames.
    pub taxels: Vec<TaxelReadings>,
    /// Representations of all touches: means of blocks of taxels and spans of frames, and spectra of touches of many frames.
    pub representations: Vec<Array2<f64>>,
    /// Splits; empty without classes.
    pub splits: Vec<AuditSplit>,
    /// Results of the classifiers; empty without classes.
    pub tested: Vec<Tested>,
    /// Nearest touches of each touch by means of blocks.
    pub near: NearestRows,
    /// Units that are independent: groups, or else sessions.
    pub units: Option<Vec<usize>>,
}

impl Context {
    /// Computes the common quantities of all checks.
    ///
    /// # Errors
    /// If the data are inconsistent, or an option does not fit them.
    pub fn new(mut data: AuditData, options: AuditOptions) -> Result<Self> {
        data.check()?;
        options.check(&data, str::to_owned)?;
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
        let has_classes = touches_of_classes(&labels).len() > 1;
        let sample = drawn(n, MAX_SAMPLE, &seed.named("sample"));
        let chosen = drawn(data.frames.nrows(), MAX_FRAMES, &seed.named("frames"));
        let frames = data.frames.select(Axis(0), &chosen);
        let frame_touches = chosen.iter().map(|frame| frame / data.n_frames).collect();
        let view = data.frames.view();
        let mut representations = vec![pooled(view, data.n_frames, data.grid, MAX_BLOCKS)];
        let channels = pooled(view, 1, data.grid, MAX_CHANNELS);
        representations.extend(log_spectra(channels.view(), data.n_frames));
        let splits = match has_classes {
            true => splits(&data, &labels, options.split.as_deref(), &seed),
            false => Vec::new(),
        };
        let nearest = (N_NEAREST, &seed);
        let (tested, near) = scores(&representations, &labels, &splits, nearest)?;
        Ok(Self {
            units: data.groups.clone().or_else(|| data.sessions.clone()),
            n_padded,
            n_missing,
            sample_labels: sample.iter().map(|&touch| labels[touch]).collect(),
            labels,
            has_classes,
            sample,
            means: spans(view, data.n_frames, 1),
            taxels: taxel_readings(frames.view()),
            frames,
            frame_touches,
            representations,
            splits,
            tested,
            near,
            data,
            options,
        })
    }

    /// Returns the random stream of a check.
    pub fn seed(&self, name: &str) -> Seed {
        Seed::new(self.options.seed).named("audit").named(name)
    }

    /// Tests whether the labels of sampled touches can be read from some features. `places` are the places of the touches in the sample, one for each row. A
    /// touch is read from other units, unless each class has a single unit or `has_units` is false.
    pub fn readability(
        &self,
        rows: ArrayView2<f64>,
        places: &[usize],
        has_units: bool,
        (name, range): (&str, &RangeInclusive<usize>),
    ) -> Option<Readability> {
        let labels = places.iter().map(|&place| self.sample_labels[place]);
        let labels: Vec<usize> = labels.collect();
        let units = self.units.as_ref().filter(|_| has_units);
        let units = units.map(|units| {
            let of_places = places.iter().map(|&place| units[self.sample[place]]);
            of_places.collect::<Vec<usize>>()
        });
        readability(rows, &labels, units.as_deref(), range, &self.seed(name))
    }

    /// Returns whether there are several groups, and each class has touches of one group alone, so that class and group cannot be told apart.
    pub fn has_one_group_each(&self) -> bool {
        let Some(units) = self.units.as_ref().filter(|_| self.has_classes) else {
            return false;
        };
        let pairs: BTreeSet<_> = self.labels.iter().zip(units).collect();
        let n_units = units.iter().collect::<BTreeSet<_>>().len();
        n_units > 1 && pairs.len() == touches_of_classes(&self.labels).len()
    }

    /// Returns the results of one arm of a split.
    pub fn arm(&self, split: usize, is_held_out: bool) -> impl Iterator<Item = &Tested> {
        let is_own =
            move |tested: &&Tested| tested.split == split && tested.is_held_out == is_held_out;
        self.tested.iter().filter(is_own)
    }

    /// Returns the most accurate classifier of an arm of a split; `None` without classes.
    pub fn best(&self, split: usize, is_held_out: bool) -> Option<&Tested> {
        let arm = self.arm(split, is_held_out);
        arm.max_by(|a, b| a.accuracy().total_cmp(&b.accuracy()))
    }

    /// Returns the accuracy of a classifier that always predicts the most frequent class.
    pub fn chance(&self) -> f64 {
        let classes = touches_of_classes(&self.labels);
        let largest = classes.values().map(Vec::len).max();
        largest.unwrap_or(0) as f64 / self.labels.len() as f64
    }

    /// Returns the difference of the largest and the smallest reading.
    pub fn range(&self) -> f64 {
        let taxels = self.taxels.iter();
        let least = taxels
            .clone()
            .map(|taxel| taxel.least)
            .fold(f64::INFINITY, f64::min);
        let largest = taxels.map(|taxel| taxel.largest).fold(least, f64::max);
        (largest - least).max(f64::MIN_POSITIVE)
    }

    /// Returns the means of blocks of all touches less the means of their classes.
    pub fn residuals(&self) -> Array2<f64> {
        without_class_means(self.representations[0].view(), &self.labels)
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
