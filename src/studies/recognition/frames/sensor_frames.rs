//! Frames of one sensor of a recording: its files, masked taxels, zeros and full scale.

use crate::calibration::plateau;
use crate::inputs::arrays::ElementKind;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::RecordedArray;
use crate::studies::recognition::spec::ZeroSpec;
use ndarray::{Array2, Axis, concatenate};

/// Fraction of missing (NaN) readings, 0 to 1, above which a taxel is masked. With a larger value, recordings with an intermittently failing taxel are
/// rejected; with a smaller value, a few missing readings mask a taxel.
const MASKED: f64 = 0.1;

/// Minimum number of frames from which a taxel with one reading counts as one without a sensor. With fewer frames, an untouched taxel may read one number by
/// chance.
const MIN_CONSTANT: usize = 20;

/// Largest distance of readings from their zero, in multiples of their change. Frames are kept in single precision, with a relative error of 6e-8. With a larger
/// value, changes are rounded by more than 0.6 %; with a smaller value, exact recordings with an offset are refused.
const MAX_OFFSET: f64 = 1e5;

/// Frames that one sensor recorded.
pub struct SensorFrames {
    /// Name of the sensor.
    pub name: String,
    /// Time between the frames of each touch relative to the time between recorded frames, 1 without resampling; the test set comes last.
    pub steps: Vec<f64>,
    spec: RecordedSpec,
    /// Training touches (or all touches), followed by the separate test set if there is one.
    sets: Vec<RecordedArray>,
}

/// Zeros and full scale of one sensor.
pub struct SensorScale {
    /// Whether each value of a frame belongs to a masked taxel.
    pub is_masked: Vec<bool>,
    /// Reading of each untouched taxel; 0 for a masked taxel.
    pub zeros: Vec<f64>,
    /// Reading of a taxel whose deflection equals its stroke.
    pub full_scale: f64,
    /// Reading from which on a taxel counts as saturated.
    pub saturation: f64,
}

impl SensorFrames {
    /// Reads the frames of a sensor. If `ceiling` is given, the frames must fit into this number of bytes.
    ///
    /// # Errors
    /// If a file cannot be read, or the test set has other axes than the training touches.
    pub fn read(name: String, spec: RecordedSpec, ceiling: Option<u64>) -> Result<Self> {
        let (mut sets, mut steps) = (Vec::<RecordedArray>::new(), Vec::new());
        for array in spec.frame_arrays() {
            let recorded = spec.read_frames(array, sets.first(), ceiling)?;
            let (set, own_steps) = recorded.resampled(spec.resampled_frames)?;
            if let Some(first) = sets.first() {
                set.shape
                    .check_alike(&set.place, (&first.shape, &first.place))?;
            }
            sets.push(set);
            steps.extend(own_steps);
        }
        Ok(Self {
            name,
            steps,
            spec,
            sets,
        })
    }

    /// Returns the numbers of touches: training touches (or all touches), and touches of the test set.
    pub fn n_touches(&self) -> [usize; 2] {
        [0, 1].map(|set| self.sets.get(set).map_or(0, |set| set.shape.n_touches))
    }

    /// Returns the memory of the readings, bytes.
    pub fn n_bytes(&self) -> u64 {
        let sizes = self.sets.iter().map(|set| set.readings.len());
        8 * sizes.sum::<usize>() as u64
    }

    /// Returns the number of frames of each touch.
    pub fn n_frames(&self) -> usize {
        self.sets[0].shape.n_frames
    }

    /// Determines masked taxels, zeros and the full scale of the sensor.
    ///
    /// # Errors
    /// If a reading is not finite although its taxel is not masked, or the zeros do not fit the readings.
    pub fn scale(&self, are_depths_known: bool) -> Result<SensorScale> {
        let RecordedArray { shape, columns, .. } = &self.sets[0];
        let mut is_masked = self.masked(shape.n_taxels)?;
        let mut zeros = self.spec.zeros(shape, columns.as_deref())?;
        self.mask_placeholders(&zeros, &mut is_masked);
        for (taxel, zero) in zeros.iter_mut().enumerate() {
            if is_masked[taxel] {
                *zero = 0.0;
            } else if !zero.is_finite()
                && let ZeroSpec::Each(path) = &self.spec.zero
            {
                let place = format!("{}, taxel {taxel}", path.display());
                let allowed = "a finite number (only a taxel that is masked may be without one)";
                return Err(Error::input(place, *zero, allowed));
            }
        }
        self.check_precision(&zeros, &is_masked)?;
        let [full_scale, saturation] = self.full_scale(&zeros, &is_masked, are_depths_known)?;
        Ok(SensorScale {
            is_masked,
            zeros,
            full_scale,
            saturation,
        })
    }

    /// Returns whether each value of a frame belongs to a masked taxel, which has too many NaN readings.
    fn masked(&self, n_taxels: usize) -> Result<Vec<bool>> {
        let n_values = self.sets[0].readings.ncols();
        let n_frames: usize = self.sets.iter().map(|set| set.readings.nrows()).sum();
        let mut n_missing = vec![0_usize; n_values];
        for frame in self.sets.iter().flat_map(|set| set.readings.outer_iter()) {
            for (n, reading) in n_missing.iter_mut().zip(frame) {
                *n += usize::from(reading.is_nan());
            }
        }
        let of_taxel = |taxel: usize| n_missing.iter().skip(taxel).step_by(n_taxels);
        let most = |taxel: usize| of_taxel(taxel).copied().max().unwrap_or(0);
        let is_masked = (0..n_values).map(|place| {
            let n = most(place % n_taxels);
            n > 0 && n as f64 >= MASKED * n_frames as f64
        });
        let is_masked: Vec<bool> = is_masked.collect();
        for set in &self.sets {
            for ((row, place), &reading) in set.readings.indexed_iter() {
                if reading.is_finite() || is_masked[place] {
                    continue;
                }
                let taxel = place % n_taxels;
                let of_shear = set.shear_place.as_ref().filter(|_| place >= n_taxels);
                let file = of_shear.unwrap_or(&set.place);
                let at = format!("{file}, frame {row}, taxel {taxel}");
                let allowed = match reading.is_nan() {
                    true => format!(
                        "a finite number (a taxel that is NaN in at least {:.0} % of the frames is masked; this one is in {} of {n_frames})",
                        100.0 * MASKED,
                        most(taxel)
                    ),
                    false => "a finite number".to_owned(),
                };
                return Err(Error::input(at, reading, allowed));
            }
        }
        match is_masked.contains(&false) {
            true => Ok(is_masked),
            false => {
                let place = &self.sets[0].place;
                Err(Error::input(place, "no taxel with readings", "numbers"))
            }
        }
    }

    /// Masks taxels that read one number other than their zero in all frames, such as −1 at places of a rectangle without a sensor, if another taxel changes.
    fn mask_placeholders(&self, zeros: &[f64], is_masked: &mut [bool]) {
        let frames = || self.sets.iter().flat_map(|set| set.readings.outer_iter());
        if frames().count() < MIN_CONSTANT {
            return;
        }
        let first: Vec<f64> = frames().next().into_iter().flatten().copied().collect();
        let mut is_constant = vec![true; first.len()];
        for frame in frames() {
            let readings = frame.iter().zip(&first);
            for (is_constant, (reading, first)) in is_constant.iter_mut().zip(readings) {
                *is_constant &= reading == first;
            }
        }
        if (0..first.len()).all(|place| is_masked[place] || is_constant[place]) {
            return;
        }
        let n_taxels = zeros.len();
        for taxel in (0..n_taxels).filter(|&taxel| first[taxel] != zeros[taxel]) {
            let values = (taxel..first.len()).step_by(n_taxels);
            if values.clone().all(|place| is_constant[place]) {
                values.for_each(|place| is_masked[place] = true);
            }
        }
    }

    /// Checks that the readings minus their zeros keep their changes in single precision.
    ///
    /// # Errors
    /// If the changes of most taxels are too small beside their distance from the zero.
    fn check_precision(&self, zeros: &[f64], is_masked: &[bool]) -> Result<()> {
        let (mut n_rounded, mut n_changing, mut example) = (0, 0, None);
        for taxel in (0..zeros.len()).filter(|&taxel| !is_masked[taxel]) {
            let readings = self.sets.iter().flat_map(|set| set.readings.column(taxel));
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for &reading in readings {
                (low, high) = (low.min(reading), high.max(reading));
            }
            let change = high - low;
            let away = [low, high].map(|reading| (reading - zeros[taxel]).abs());
            n_changing += usize::from(change > 0.0);
            if change > 0.0 && away[0].min(away[1]) > MAX_OFFSET * change {
                n_rounded += 1;
                example.get_or_insert((low, high));
            }
        }
        let Some((low, high)) = example.filter(|_| 2 * n_rounded > n_changing) else {
            return Ok(());
        };
        let given = format!(
            "readings from {low} to {high}, far from recorded.zero: single precision would round their changes off"
        );
        let allowed = "recorded.zero = the reading of an untouched taxel";
        Err(Error::input(&self.sets[0].place, given, allowed))
    }

    /// Returns two readings: the reading of a taxel at full scale, and the reading from which on a taxel counts as saturated. A taxel counts as saturated from
    /// the given full scale on, or from a smaller largest reading that many frames share. If the depths are known, a shared largest reading is ignored, because
    /// equal depths may cause it. If the full scale is below the zeros, readings fall under pressure, and the smallest reading counts as the largest one.
    fn full_scale(
        &self,
        zeros: &[f64],
        is_masked: &[bool],
        are_depths_known: bool,
    ) -> Result<[f64; 2]> {
        let present = || (0..zeros.len()).filter(|&taxel| !is_masked[taxel]);
        let present_zeros = || present().map(|taxel| zeros[taxel]);
        let highest = present_zeros().fold(f64::NEG_INFINITY, f64::max);
        let lowest = present_zeros().fold(f64::INFINITY, f64::min);
        let given = self.spec.full_scale;
        // Zero that is the nearest one to the readings of pressed taxels.
        let (sign, zero) = match given {
            Some(full_scale) if full_scale < lowest => (-1.0, lowest),
            _ => (1.0, highest),
        };
        let frames = || self.sets.iter().flat_map(|set| set.readings.outer_iter());
        let pushes = || {
            frames().map(|frame| {
                let taxels = frame.into_iter().zip(is_masked).take(zeros.len());
                taxels.map(|(&reading, &is_masked)| match is_masked {
                    true => f64::NAN,
                    false => sign * reading,
                })
            })
        };
        let largest = pushes().flatten().filter(|reading| !reading.is_nan());
        let largest = largest.fold(f64::NEG_INFINITY, f64::max);
        let full_scale = given.unwrap_or(largest);
        if sign * (full_scale - zero) <= 0.0 {
            return Err(match &self.spec.zero {
                ZeroSpec::One(zero) => {
                    let given = format!("no reading above recorded.zero, {zero}");
                    let allowed =
                        "touches (readings that fall under pressure need recorded.full_scale)";
                    Error::input(self.spec.frames.display(), given, allowed)
                }
                ZeroSpec::Each(path) => {
                    let taxel = present().find(|&taxel| zeros[taxel] == highest);
                    let place = format!("{}, taxel {}", path.display(), taxel.unwrap_or(0));
                    let allowed = match given {
                        Some(full_scale) => format!(
                            "below recorded.full_scale, {full_scale} (or all zeros above it, if readings fall under pressure)"
                        ),
                        None => format!(
                            "below the largest reading, {largest}, which stands for the full scale"
                        ),
                    };
                    Error::input(place, highest, allowed)
                }
            });
        }
        let spacing = match self.sets[0].kind {
            ElementKind::Float(spacing) => spacing,
            _ => 0.0,
        };
        let given = given.map(|full_scale| sign * full_scale - spacing * full_scale.abs());
        let shared = match are_depths_known {
            true => None,
            false => plateau(pushes).filter(|&level| level > sign * zero),
        };
        let levels = [given, shared].into_iter().flatten();
        Ok([full_scale, sign * levels.fold(f64::INFINITY, f64::min)])
    }
}

/// Checks that all sensors recorded the same number of touches, each with the same number of frames.
///
/// # Errors
/// If a sensor differs from the first one.
pub fn check_alike(sensors: &[SensorFrames]) -> Result<()> {
    for sensor in sensors {
        for (own, first) in sensor.sets.iter().zip(&sensors[0].sets) {
            let (n_touches, n_frames) = (first.shape.n_touches, first.shape.n_frames);
            if own.shape.n_touches != n_touches {
                let given = format!("{} touches", own.shape.n_touches);
                let allowed = format!("{n_touches}, as {} has", first.place);
                return Err(Error::input(&own.place, given, allowed));
            }
            if own.shape.n_frames != n_frames {
                let given = format!("touches of {} frames", own.shape.n_frames);
                let place = &first.place;
                let allowed = format!("{n_frames}, as {place} has, or recorded.resampled_frames");
                return Err(Error::input(&own.place, given, allowed));
            }
        }
    }
    Ok(())
}

/// Joins the readings of all sensors to frames, sensor after sensor: training touches (or all touches), and the separate test set.
pub fn joined_readings(mut sensors: Vec<SensorFrames>) -> [Array2<f64>; 2] {
    [0, 1].map(|set| {
        let mut parts: Vec<Array2<f64>> = Vec::new();
        for sensor in &mut sensors {
            let array = sensor.sets.get_mut(set);
            parts.extend(array.map(|array| std::mem::take(&mut array.readings)));
        }
        match parts.len() {
            0 => Array2::zeros((0, 0)),
            1 => parts.swap_remove(0),
            _ => {
                let parts: Vec<_> = parts.iter().map(Array2::view).collect();
                concatenate(Axis(1), &parts).expect("the sensors have the same touches")
            }
        }
    })
}
