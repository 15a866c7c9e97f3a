//! Recorded frames of a study, which replace simulated touches; the files are read once.
//!
//! A reading v corresponds to the deflection `stroke · (v − zero) / (full_scale − zero)`. Noise and sensor errors of a study are fractions of the full scale,
//! so they have the same effect as on a simulated skin. A full scale below the zero belongs to readings that fall under pressure. Readings of tangential forces are in newtons. The readings of several sensors are joined to one frame.

use crate::contact::saturation_limit;
use crate::inputs::arrays::is_member;
use crate::inputs::arrays::whole_numbers::{
    ClassLabels, KeyValue, group_keys, note_spellings, read_class_values, read_group_values,
    read_rows,
};
use crate::inputs::object_files::file_content;
use crate::learning::data::split::Side;
use crate::report::pictures::snapshots::Snapshots;
use crate::signal::Quantity;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{
    Frames, RecordedContent, Samples, SensorFrames, SensorScale, TouchSet, TouchToRead,
    check_alike, joined_readings, numbers_of, one_each, spread_samples, touch_of, touches_to_read,
};
use crate::studies::recognition::plan::MeasurementGroup;
use crate::studies::recognition::spec::PreviousTouch;
use ndarray::{Array1, Array2, ArrayView1, ArrayViewMut2};
use rand::Rng;
use std::collections::{BTreeMap, HashSet};
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
        let [n_train, n_test] = sensors[0].n_touches();
        let labels = spec.class_labels([n_train, n_test])?;
        let (names, streams, counts) = spec.classes(&labels)?;
        let mut order: Vec<usize> = (0..n_train + n_test).collect();
        order.sort_by_key(|&touch| labels.labels[touch]);
        let groups = spec.group_keys([n_train, n_test])?;
        let (groups, group_names) = groups.unzip();
        let groups =
            groups.map(|groups: Vec<usize>| order.iter().map(|&touch| groups[touch]).collect());
        let side = |&touch: &usize| match touch < n_train {
            true => Side::Train,
            false => Side::Test,
        };
        let groups: Option<Array1<usize>> = groups;
        let mut sides = spec.read_splits((&order, groups.as_ref()))?;
        if spec.has_test_set() {
            sides.push(order.iter().map(side).collect());
            spec.check_test_set(&names, &order, &sides[0], &labels)?;
        }
        let depths = spec.read_depths(n_train + n_test)?;
        let depths = depths.map(|depths| order.iter().map(|&touch| depths[touch]).collect());
        let n_frames = sensors[0].n_frames();
        let steps = sensors[0].steps();
        let steps = order.iter().map(|&touch| steps[touch]).collect();
        let scales = sensors.iter().map(|sensor| sensor.scale(depths.is_some()));
        let scales = scales.collect::<Result<Vec<SensorScale>>>()?;
        let names_of = sensors.iter().zip(&scales);
        let names_of = names_of.map(|(sensor, scale)| (sensor.name.clone(), scale.zeros.len()));
        let sensors_of: Vec<(String, usize)> = names_of.collect();
        let each = |of: fn(&SensorScale) -> f64| -> Vec<f64> {
            let values = scales
                .iter()
                .map(|s| std::iter::repeat_n(of(s), s.zeros.len()));
            values.flatten().collect()
        };
        Ok(Self {
            spec: spec.clone(),
            content: spec.content()?,
            names,
            streams,
            counts,
            order,
            full_scales: each(|scale| scale.full_scale),
            saturations: each(|scale| scale.saturation),
            is_masked: scales.iter().flat_map(|s| s.is_masked.clone()).collect(),
            zeros: scales.iter().flat_map(|s| s.zeros.clone()).collect(),
            steps,
            n_frames,
            n_taxels: sensors_of.iter().map(|(_, n)| n).sum(),
            sensors: sensors_of,
            groups,
            group_names: group_names.unwrap_or_default(),
            sides,
            depths,
            readings: joined_readings(sensors),
        })
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

/// Number of the group of every touch, and the names of the groups by their numbers.
type NamedGroups = (Vec<usize>, Vec<String>);

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

    /// Returns the class labels of all touches; the separate test set comes last.
    fn class_labels(&self, n: [usize; 2]) -> Result<ClassLabels> {
        let mut values: Vec<KeyValue> = Vec::new();
        for (name, n) in ["labels", "labels_test"].into_iter().zip(n) {
            let Some(path) = self.file_of(name).filter(|_| n > 0) else {
                continue;
            };
            let own = read_class_values(path, name, n)?;
            one_each((path, name), (own.len(), n), touch_of(self.first_frames()))?;
            if let (Some(first), Some(other)) = (own.first(), values.first())
                && first.is_text() != other.is_text()
            {
                let labels = self.file_of("labels").unwrap_or(&self.labels);
                let allowed = format!("texts or numbers in both, as in {}", labels.display());
                let given = "numbers in one array of labels and texts in the other";
                return Err(Error::input(path.display(), given, allowed));
            }
            values.extend(own);
        }
        let labels = ClassLabels::new(&values);
        let (Some(names), Some(KeyValue::Text(_))) = (&self.names, values.first()) else {
            return Ok(labels);
        };
        // Texts are numbered in the order of `names`.
        let known: Vec<KeyValue> = names.iter().cloned().map(KeyValue::Text).collect();
        let number = |value: &KeyValue| {
            let number = known.iter().position(|name| name == value);
            number.ok_or_else(|| {
                let given = format!("no name {:?}", name_of(value));
                let labels = self.file_of("labels").unwrap_or(&self.labels);
                let allowed = format!("each text of {} once", labels.display());
                Error::input("key recorded.names", given, allowed)
            })
        };
        Ok(ClassLabels {
            labels: values.iter().map(number).collect::<Result<_>>()?,
            classes: known,
        })
    }

    /// Returns the name, the random-stream name and the number of touches of each class.
    pub(crate) fn classes(
        &self,
        labels: &ClassLabels,
    ) -> Result<(Vec<String>, Vec<String>, Vec<usize>)> {
        let n_classes = labels.classes.len();
        let mut counts = vec![0; n_classes];
        for &label in &labels.labels {
            counts[label] += 1;
        }
        let file = self.file_of("labels").unwrap_or(&self.labels);
        if let Some(label) = counts.iter().position(|&count| count == 0) {
            let given = format!("no touch of class {}", name_of(&labels.classes[label]));
            return Err(Error::input(file.display(), given, "touches of each class"));
        }
        let (names, streams): (Vec<String>, Vec<String>) = match &self.names {
            None => {
                let classes = labels.classes.iter().enumerate();
                let names = classes.map(|(number, class)| match class {
                    KeyValue::Integer(value) => {
                        (format!("class {value}"), format!("class {number}"))
                    }
                    KeyValue::Text(text) => (text.clone(), text.clone()),
                });
                names.unzip()
            }
            Some(names) if names.len() == n_classes => (names.clone(), names.clone()),
            Some(names) => {
                let given = format!("{} names", names.len());
                let allowed = format!("{n_classes}, one a class of {}", file.display());
                return Err(Error::input("key recorded.names", given, allowed));
            }
        };
        if let Some(name) = (1..names.len()).find(|&k| names[..k].contains(&names[k])) {
            let given = format!("{:?} twice", names[name]);
            return Err(Error::input("key recorded.names", given, "each name once"));
        }
        note_spellings("labels", names.iter().map(String::as_str));
        Ok((names, streams, counts))
    }

    /// Returns the group of every touch, and the names of groups that are texts; the touches of the separate test set come last. Returns `None` if the
    /// recording defines no groups.
    fn group_keys(&self, [n_train, n_test]: [usize; 2]) -> Result<Option<NamedGroups>> {
        let named = |values: &[KeyValue]| {
            let classes = ClassLabels::new(values).classes.into_iter();
            let names = classes.filter(KeyValue::is_text).map(|name| name_of(&name));
            (group_keys(values), names.collect())
        };
        let read = |name: &str, n: usize| -> Result<Option<Vec<KeyValue>>> {
            match self.file_of(name) {
                None => Ok(None),
                Some(path) => {
                    let groups = read_group_values(path, name, n)?;
                    one_each(
                        (path, name),
                        (groups.len(), n),
                        touch_of(self.first_frames()),
                    )?;
                    Ok(Some(groups))
                }
            }
        };
        let (train, test) = (read("groups", n_train)?, read("groups_test", n_test)?);
        if n_test == 0 {
            return Ok(train.map(|groups| named(&groups)));
        }
        match (train, test) {
            (None, None) => Ok(None),
            (Some(_), None) => {
                let allowed = "the groups of the test set beside groups, or neither of them";
                Err(Error::input(
                    "key recorded.groups_test",
                    "no such key",
                    allowed,
                ))
            }
            (None, Some(test)) => {
                // Each training touch is a group of its own.
                let (keys, names) = named(&test);
                let first = keys.iter().max().map_or(0, |last| last + 1);
                Ok(Some((
                    (first..first + n_train).chain(keys).collect(),
                    names,
                )))
            }
            (Some(train), Some(test)) => {
                let known: HashSet<&KeyValue> = train.iter().collect();
                if let Some(both) = test.iter().find(|group| known.contains(group)) {
                    let given = format!("group {} in both sets", name_of(both));
                    let allowed = "groups that either train or test";
                    return Err(Error::input("key recorded.groups_test", given, allowed));
                }
                Ok(Some(named(&[train, test].concat())))
            }
        }
    }

    /// Returns an error if a class has no training touches or no test touches.
    fn check_test_set(
        &self,
        names: &[String],
        order: &[usize],
        sides: &[Side],
        labels: &ClassLabels,
    ) -> Result<()> {
        let without = |side: Side| {
            let is_on =
                |(touch, own): (&usize, &Side)| (*own == side).then_some(labels.labels[*touch]);
            let found: HashSet<usize> = order.iter().zip(sides).filter_map(is_on).collect();
            (0..names.len()).find(|label| !found.contains(label))
        };
        let (given, allowed) = match (without(Side::Train), without(Side::Test)) {
            (Some(label), _) => (
                format!("{}, of which no touch trains", names[label]),
                "classes of recorded.labels",
            ),
            (None, Some(label)) => (
                format!("no touch of {}", names[label]),
                "touches of each class among those that train and in the test set",
            ),
            (None, None) => return Ok(()),
        };
        Err(Error::input("key recorded.labels_test", given, allowed))
    }

    /// Returns the side of each touch in each split of the file `splits`; the touches are in the order `order`. The list is empty without the file.
    fn read_splits(
        &self,
        (order, groups): (&[usize], Option<&Array1<usize>>),
    ) -> Result<Vec<Vec<Side>>> {
        let mut splits = Vec::new();
        let Some(path) = &self.splits else {
            return Ok(splits);
        };
        let refused = |given: String, allowed: &str| {
            Err(Error::input(
                format!("{} (key recorded.splits)", path.display()),
                given,
                allowed,
            ))
        };
        while is_member(path, &format!("train_{}", splits.len())) {
            let number = splits.len();
            let mut of_touch = vec![Side::LeftOut; order.len()];
            for (name, side) in [("train", Side::Train), ("test", Side::Test)] {
                for touch in read_rows(path, &format!("{name}_{number}"), order.len())? {
                    if std::mem::replace(&mut of_touch[touch], side) != Side::LeftOut {
                        let given =
                            format!("touch {touch} twice in train_{number} and test_{number}");
                        return refused(given, "each touch once, or not at all");
                    }
                }
            }
            let sides: Vec<Side> = order.iter().map(|&touch| of_touch[touch]).collect();
            if let Some(groups) = groups {
                let of = |wanted: Side| {
                    let sides = groups.iter().zip(&sides);
                    sides.filter_map(move |(group, side)| (*side == wanted).then_some(*group))
                };
                let trained: HashSet<usize> = of(Side::Train).collect();
                if let Some(both) = of(Side::Test).find(|group| trained.contains(group)) {
                    let given = format!("group {both} in train_{number} and test_{number}");
                    return refused(given, "groups of recorded.groups that either train or test");
                }
            }
            splits.push(sides);
        }
        match splits.is_empty() {
            true => refused(
                "no array train_0".to_owned(),
                "an archive .npz of train_0, test_0, train_1, test_1, …",
            ),
            false => Ok(splits),
        }
    }

    fn read_depths(&self, n: usize) -> Result<Option<Vec<f64>>> {
        let read = |path: &PathBuf| {
            let each = (n, touch_of(self.first_frames()));
            let is_depth = |depth: f64| depth.is_finite() && depth > 0.0;
            numbers_of(
                (path, "depths"),
                each,
                is_depth,
                "a positive number of metres",
            )
        };
        self.depths.as_ref().map(read).transpose()
    }
}

fn name_of(value: &KeyValue) -> String {
    match value {
        KeyValue::Integer(number) => number.to_string(),
        KeyValue::Text(text) => text.clone(),
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

    fn n_masked(&self) -> (usize, usize) {
        let of_taxels = &self.is_masked[..self.n_taxels];
        (of_taxels.iter().filter(|&&is| is).count(), self.n_taxels)
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
    fn samples(&self, plan: &Plan, _groups: &[MeasurementGroup]) -> Result<Samples> {
        let array = &plan.arrays[0];
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
