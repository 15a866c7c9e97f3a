//! Recorded frames of a study, which replace simulated touches; the files are read once.
//!
//! A reading v corresponds to the deflection `stroke · (v − zero) / (full_scale − zero)`. Noise and sensor errors of a study are fractions of the full scale,
//! so they have the same effect as on a simulated skin. A full scale below the zero belongs to readings that fall under pressure. Readings of tangential forces are in newtons. The readings of several sensors are joined to one frame.

use crate::contact::saturation_limit;
use crate::inputs::object_files::file_content;
use crate::learning::data::split::Side;
use crate::report::pictures::snapshots::Snapshots;
use crate::signal::Quantity;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{
    Frames, RecordedContent, Samples, SensorFrames, SensorScale, TouchSet, TouchToRead,
    check_alike, joined_readings, spread_samples, touches_to_read,
};
use crate::studies::recognition::plan::MeasurementGroup;
use crate::studies::recognition::spec::PreviousTouch;
use ndarray::{Array1, Array2, ArrayView1, ArrayViewMut2};
use rand::Rng;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Touches that a real skin recorded.
#[derive(Clone, Debug)]
pub struct RecordedFrames {
    /// Specification of the recording, from the table `[recorded]`.
    pub spec: RecordedSpec,
    /// Contents of the files.
    content: RecordedContent,
    /// Names of the classes, in the order of their labels.
    names: Vec<String>,
    /// Names from which the seeds of the random numbers of each class are derived.
    streams: Vec<String>,
    /// Number of touches of each class.
    counts: Vec<usize>,
    /// Recorded frames in two arrays: training touches (or all touches), and the separate test set.
    readings: [Array2<f64>; 2],
    /// Row index of each touch in the two arrays of frames; the touches are ordered by class.
    order: Vec<usize>,
    /// Whether each value of a frame belongs to a masked taxel.
    is_masked: Vec<bool>,
    /// Reading of each untouched taxel; 0 for a masked taxel.
    zeros: Vec<f64>,
    /// Reading of each taxel at which its deflection equals its stroke; below its zero if readings fall under pressure.
    full_scales: Vec<f64>,
    /// Reading from which on each taxel counts as saturated.
    saturations: Vec<f64>,
    /// Time between the frames of each touch relative to the time between recorded frames, in the order of the field `order`; 1 without resampling.
    steps: Vec<f64>,
    /// Names of the sensors, with their numbers of taxels.
    sensors: Vec<(String, usize)>,
    /// Number F of frames per touch.
    n_frames: usize,
    /// Number of taxels of the skin; a frame may contain several values per taxel.
    n_taxels: usize,
    /// Group of each touch, in the order of the field `order`; `None` if the recording defines no groups.
    groups: Option<Array1<usize>>,
    /// Names of the groups by their numbers; empty if the numbers are the names.
    group_names: Vec<String>,
    /// Side (training or test) of each touch: in all trials for a test set, or in each split; empty if the data do not define splits.
    sides: Vec<Vec<Side>>,
    /// Press depth of each touch, metres; `None` if unknown.
    depths: Option<Vec<f64>>,
}

impl RecordedFrames {
    /// Reads the files of a recording. If `ceiling` is given, the frames must fit into this number of bytes.
    ///
    /// # Errors
    /// If a file cannot be read or does not fit the others, or a reading is infinite, or NaN although its taxel is not masked.
    pub fn read(spec: &RecordedSpec, ceiling: Option<u64>) -> Result<Self> {
        spec.check_files()?;
        let (mut sensors, mut ceiling) = (Vec::new(), ceiling);
        for (name, spec) in spec.used_sensors() {
            let sensor = SensorFrames::read(name, spec, ceiling)?;
            ceiling = ceiling.map(|bytes| bytes.saturating_sub(sensor.n_bytes()));
            sensors.push(sensor);
        }
        check_alike(&sensors)?;
        let n = sensors[0].n_touches();
        let labels = spec.class_labels(n)?;
        let classes = spec.classes(&labels)?;
        let mut order: Vec<usize> = (0..n[0] + n[1]).collect();
        order.sort_by_key(|&touch| labels.labels[touch]);
        let groups = spec.groups_of_sets(n)?.map(|groups| {
            let keys: Array1<usize> = order.iter().map(|&touch| groups.keys[touch]).collect();
            (keys, groups.names)
        });
        let (groups, group_names) = groups.unzip();
        let mut sides = spec.read_splits(&order, groups.as_ref())?;
        if spec.has_test_set() {
            let side = |&touch: &usize| match touch < n[0] {
                true => Side::Train,
                false => Side::Test,
            };
            sides.push(order.iter().map(side).collect());
            spec.check_test_set(&classes.names, &order, &sides[0], &labels)?;
        }
        let depths = spec.read_depths(order.len())?;
        let depths = depths.map(|depths| order.iter().map(|&touch| depths[touch]).collect());
        let scales = sensors.iter().map(|sensor| sensor.scale(depths.is_some()));
        let scales = scales.collect::<Result<Vec<SensorScale>>>()?;
        let mut recording = Self {
            spec: spec.clone(),
            content: spec.content()?,
            names: classes.names,
            streams: classes.streams,
            counts: classes.counts,
            is_masked: Vec::new(),
            zeros: Vec::new(),
            full_scales: Vec::new(),
            saturations: Vec::new(),
            steps: order.iter().map(|&touch| sensors[0].steps[touch]).collect(),
            sensors: Vec::new(),
            n_frames: sensors[0].n_frames(),
            n_taxels: 0,
            groups,
            group_names: group_names.unwrap_or_default(),
            sides,
            depths,
            order,
            readings: Default::default(),
        };
        for (sensor, scale) in sensors.iter().zip(scales) {
            recording.add_scale(&sensor.name, scale);
        }
        recording.readings = joined_readings(sensors);
        Ok(recording)
    }

    /// Adds the taxels of a sensor.
    fn add_scale(&mut self, name: &str, scale: SensorScale) {
        let n = scale.zeros.len();
        self.sensors.push((name.to_owned(), n));
        self.n_taxels += n;
        self.full_scales.extend(vec![scale.full_scale; n]);
        self.saturations.extend(vec![scale.saturation; n]);
        self.is_masked.extend(scale.is_masked);
        self.zeros.extend(scale.zeros);
    }

    /// Returns the recorded readings of one frame of a touch.
    fn frame(&self, touch: usize, frame: usize) -> ArrayView1<'_, f64> {
        let row = self.order[touch] * self.n_frames + frame;
        let [train, test] = &self.readings;
        match row.checked_sub(train.nrows()) {
            None => train.row(row),
            Some(row) => test.row(row),
        }
    }

    /// Returns the number of a taxel, with the name of its sensor if there are several sensors.
    fn taxel_name(&self, taxel: usize) -> String {
        let mut first = 0;
        for (name, n_taxels) in &self.sensors {
            if self.sensors.len() > 1 && taxel < first + n_taxels {
                return format!("{name} {}", taxel - first);
            }
            first += n_taxels;
        }
        taxel.to_string()
    }

    /// Returns the values of one frame of a touch: deflections in metres, and tangential forces in newtons.
    fn values(&self, (touch, frame): (usize, usize), stroke: f64) -> Array1<f64> {
        let readings = self.frame(touch, frame);
        let values = readings.iter().zip(&self.is_masked).enumerate();
        let values = values.map(
            |(place, (&reading, &is_masked))| match place < self.n_taxels {
                _ if is_masked => 0.0,
                true => {
                    let (zero, full_scale) = (self.zeros[place], self.full_scales[place]);
                    (reading - zero) / (full_scale - zero) * stroke
                }
                false => reading,
            },
        );
        values.collect()
    }

    /// Returns whether a condition holds for a reading along the axis of an unmasked taxel during the touch, given the taxel and the reading.
    fn any_reading(&self, touch: usize, holds: impl Fn(usize, f64) -> bool) -> bool {
        let mut frames = (0..self.n_frames).map(|frame| self.frame(touch, frame));
        frames.any(|frame| {
            let mut taxels = frame.iter().take(self.n_taxels).enumerate();
            taxels.any(|(taxel, &reading)| !self.is_masked[taxel] && holds(taxel, reading))
        })
    }
}

impl RecordedSpec {
    /// Returns the identity of the recording, which depends on the contents of the files.
    fn content(&self) -> Result<RecordedContent> {
        let (mut spec, mut hashes) = (self.clone(), BTreeMap::new());
        let mut read: BTreeMap<PathBuf, Result<String>> = BTreeMap::new();
        spec.change_files(|key, path| {
            let hash = read
                .entry(path.clone())
                .or_insert_with(|| file_content(path));
            if let Ok(hash) = hash {
                hashes.insert(key.to_owned(), hash.clone());
                *path = PathBuf::from(&*hash);
            }
        });
        read.into_values().collect::<Result<Vec<_>>>()?;
        Ok(RecordedContent {
            hashes,
            identity: identity(&spec),
        })
    }
}

impl TouchSet for RecordedFrames {
    fn classes(&self) -> Vec<(&str, usize)> {
        let names = self.names.iter().map(String::as_str);
        names.zip(self.counts.iter().copied()).collect()
    }

    fn touch_names(&self) -> Vec<String> {
        self.order.iter().map(usize::to_string).collect()
    }

    fn own_groups(&self) -> Option<Array1<usize>> {
        self.groups.clone()
    }

    fn group_names(&self) -> &[String] {
        &self.group_names
    }

    fn given_sides(&self, split: usize) -> Result<Option<&[Side]>> {
        let place = if self.spec.splits.is_some() { split } else { 0 };
        match self.sides.get(place) {
            None if !self.sides.is_empty() => {
                let allowed = format!(
                    "at most {}, the splits of recorded.splits",
                    self.sides.len()
                );
                Err(Error::input("key trials", split + 1, allowed))
            }
            sides => Ok(sides.map(Vec::as_slice)),
        }
    }

    fn recorded_content(&self) -> Option<&RecordedContent> {
        Some(&self.content)
    }

    fn absent(&self) -> &[bool] {
        &self.is_masked[..self.n_taxels]
    }

    fn simulate(&self, (array, n_frames): (&TaxelArray, usize), progress: &dyn Progress) -> Frames {
        let stroke = array.taxel().stroke;
        let mut frames = Frames::new((array.n_values(), n_frames));
        let touches: Vec<usize> = (0..self.order.len()).collect();
        let copy = |&touch: &usize, _: &mut (), mut rows: ArrayViewMut2<f32>| {
            for (frame, row) in rows.outer_iter_mut().enumerate() {
                let values = self.values((touch, frame), stroke);
                for (to, from) in row.into_iter().zip(values) {
                    *to = from as f32;
                }
            }
            // Readings may fall under pressure.
            let above = |taxel: usize, reading: f64, level: f64| match self.full_scales[taxel]
                > self.zeros[taxel]
            {
                true => reading - level,
                false => level - reading,
            };
            let is_touched = self.any_reading(touch, |taxel, reading| {
                above(taxel, reading, self.zeros[taxel]) > 0.0
            });
            let is_full =
                |taxel: usize, reading| above(taxel, reading, self.saturations[taxel]) >= 0.0;
            (!is_touched, self.any_reading(touch, is_full))
        };
        frames.make(&touches, || (), copy, progress);
        frames
    }

    /// Returns the timing and the preceding touch of each touch. Touches are read at the study's speed or frame rate. Each touch follows a randomly drawn touch
    /// or no touch, depending on the study's keys.
    fn to_read(&self, speed: f64, n_frames: usize, seed: &Seed) -> Vec<TouchToRead> {
        let streams = self.streams.iter().map(String::as_str);
        let mut touches = touches_to_read(streams.zip(self.counts.iter().copied()), seed);
        let n_touches = touches.len();
        for (number, touch) in touches.iter_mut().enumerate() {
            let depth = self.depths.as_ref().map(|depths| depths[number]);
            let depth = depth.filter(|_| speed > 0.0);
            let at_speed = depth.map(|depth| depth / (n_frames as f64 * speed));
            let interval = self.spec.frame_interval_s;
            let interval = interval.map(|interval| interval * self.steps[number]);
            touch.interval = interval.or(at_speed);
            if self.spec.previous_touch == PreviousTouch::Random {
                let mut rng = touch.seed.named("before").rng();
                touch.before = Some(rng.gen_range(0..n_touches));
            }
        }
        touches
    }

    fn n_deeper_than(&self, stroke: f64) -> usize {
        let limit = saturation_limit(stroke);
        let depths = self.depths.iter().flatten();
        depths.filter(|&&depth| depth > limit).count()
    }

    /// Returns sample touches for pictures: for each class, the last frame of its first touch.
    fn samples(&self, parts: &[(&Plan, &[MeasurementGroup])]) -> Result<Samples> {
        let plan = parts[0].0;
        let array = &plan.array;
        let (configurations, stroke) = (array.picture_cells(), array.taxel().stroke);
        let mut first = 0;
        let frames = self.classes().into_iter().map(|(name, count)| {
            let values = self.values((first, self.n_frames - 1), stroke);
            first += count;
            let frame = configurations.mapv(|taxel| taxel.map_or(0.0, |taxel| values[taxel]));
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

    fn settings(&self) -> Vec<(String, String)> {
        let row = |name: &str, value: String| (name.to_owned(), value);
        let names = self.class_names();
        let mut rows = vec![
            row(
                "Recorded classes",
                format!("{}: {}", names.len(), names.join(", ")),
            ),
            row("Frames a touch", self.n_frames.to_string()),
            row(
                "Recorded in",
                self.spec.first_frames().display().to_string(),
            ),
        ];
        if let [_, _, ..] = &self.sensors[..] {
            let sensors = self.sensors.iter();
            let sensors = sensors.map(|(name, n_taxels)| format!("{name} ({n_taxels} taxels)"));
            let sensors: Vec<String> = sensors.collect();
            rows.push(row("Sensors", sensors.join(", ")));
        }
        let masked = self.is_masked[..self.n_taxels].iter().enumerate();
        let masked = masked
            .filter(|&(_, &is)| is)
            .map(|(taxel, _)| self.taxel_name(taxel));
        let masked: Vec<String> = masked.collect();
        if !masked.is_empty() {
            let taxels = format!(
                "{} of {}: {}",
                masked.len(),
                self.n_taxels,
                masked.join(", ")
            );
            rows.push(row("Masked taxels, from 0", taxels));
        }
        rows
    }
}
