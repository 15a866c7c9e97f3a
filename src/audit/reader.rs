//! Files of an audit: recorded frames with labels and groups as studies read them, and their sessions and times.

use crate::audit::data::AuditData;
use crate::error::{Error, Result};
use crate::inputs::arrays::{ClassLabels, KeyValue, OneForEach, group_keys, is_member};
use crate::studies::recognition::frames::{RecordedArray, touch_of};
use crate::studies::recognition::spec::recorded::RecordedSpec;
use crate::toml_text;
use ndarray::{Array2, Axis, concatenate};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Paths and options of the data of an audit.
#[derive(Clone, Debug, Default)]
pub struct AuditFiles {
    /// File with the frames; or a folder with `recorded.toml`, with a file `frames`, or with one archive for each session.
    pub data: PathBuf,
    /// Given keys of `[recorded]`, except `frames`. Each replaces the key of `recorded.toml`, and the array or file of its name beside the frames.
    pub given: RecordedSpec,
    /// File with the session of each touch; `None` for an array or file `sessions` beside the frames, if there is one. The test set comes last.
    pub sessions: Option<PathBuf>,
    /// File with the time of each touch, a number; `None` for an array or file `times` beside the frames, if there is one. The test set comes last.
    pub times: Option<PathBuf>,
}

/// Table `[recorded]` of a study; other tables are ignored.
#[derive(Deserialize)]
struct RecordedToml {
    recorded: RecordedSpec,
}

/// Arrays of one recording.
struct Part {
    spec: RecordedSpec,
    /// All touches, or the training touches followed by the test set.
    sets: Vec<RecordedArray>,
    labels: Option<Vec<KeyValue>>,
    groups: Option<Vec<KeyValue>>,
    sessions: Option<Vec<KeyValue>>,
    times: Option<Vec<f64>>,
}

impl AuditFiles {
    /// Reads the data. Touches with times are sorted by time.
    ///
    /// # Errors
    /// If a file cannot be read or does not fit the others; the error names it.
    pub fn read(&self) -> Result<AuditData> {
        let recorded = self.data.join("recorded.toml");
        if recorded.is_file() {
            return assembled(vec![self.part(&self.spec_of(&recorded)?)?]);
        }
        let frames = match self.data.is_dir() {
            true => file_in(&self.data, "frames"),
            false => Some(self.data.clone()),
        };
        match frames {
            Some(frames) => assembled(vec![self.part(&spec_of_frames(&frames))?]),
            None => assembled(self.parts_of_sessions()?),
        }
    }

    /// Reads the table `[recorded]` of a file, which describes one sensor.
    fn spec_of(&self, path: &Path) -> Result<RecordedSpec> {
        let allowed = "a study with a table [recorded]";
        let text = crate::files::read_to_string(path)
            .map_err(|error| Error::unreadable(path, allowed, error))?;
        let place = path.display().to_string();
        let read = || toml_text::read::<RecordedToml>(&place, &text);
        let mut spec = crate::files::with_folder(self.data.clone(), read)?.recorded;
        spec.change_files(|_, file| *file = self.data.join(&*file));
        // Checks compare the readings of taxels, so each sensor has an audit of its own.
        let mut sensors = spec.used_sensors();
        match (sensors.len(), sensors.pop()) {
            (1, Some((_, sensor))) => Ok(sensor),
            (n, _) => {
                let place = format!("{}, key recorded.sensors", path.display());
                let allowed = "one sensor: its name in recorded.sensor, or the file of its frames";
                Err(Error::input(place, format!("{n} sensors"), allowed))
            }
        }
    }

    /// Reads all archives of the folder, each as a session.
    fn parts_of_sessions(&self) -> Result<Vec<Part>> {
        let entries = std::fs::read_dir(&self.data);
        let entries = entries.map_err(|error| Error::io(&self.data, "read", error))?;
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        // Hidden files, such as `._NAME`, which macOS writes beside others, are no archives.
        let is_archive = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            path.extension().is_some_and(|ending| ending == "npz") && !name.starts_with('.')
        };
        let mut archives: Vec<PathBuf> = paths.filter(is_archive).collect();
        archives.sort();
        if archives.is_empty() {
            let allowed = "recorded.toml, a file frames.npy (.npz, .csv), or one .npz archive for each session";
            let given = "a folder without frames";
            return Err(Error::input(self.data.display(), given, allowed));
        }
        let given = [
            ("labels", self.given.file_of("labels")),
            ("groups", self.given.file_of("groups")),
            ("sessions", self.sessions.as_deref()),
            ("times", self.times.as_deref()),
        ];
        if let Some((name, path)) = given
            .into_iter()
            .find_map(|(name, path)| Some((name, path?)))
        {
            let allowed = format!(
                "an array `{name}` in each archive of {}",
                self.data.display()
            );
            return Err(Error::input(
                path.display(),
                "one file for several archives",
                allowed,
            ));
        }
        let parts = archives.iter().map(|path| {
            let mut part = self.part(&spec_of_frames(path))?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let session = vec![KeyValue::Text(name.into_owned()); part.n_touches()];
            part.sessions.get_or_insert(session);
            Ok(part)
        });
        parts.collect()
    }

    /// Reads the arrays of a recording.
    fn part(&self, spec: &RecordedSpec) -> Result<Part> {
        let given = &self.given;
        // A given file, or else a file or array of the recording, or else a file of this name in the folder.
        let file = |key: &str| {
            let keys = [given, spec].into_iter().find_map(|spec| spec.file_of(key));
            keys.map(Path::to_owned)
                .or_else(|| file_in(&self.data, key))
        };
        let mut spec = RecordedSpec {
            labels: file("labels").unwrap_or_default(),
            groups: file("groups"),
            lengths: file("lengths"),
            frames_test: file("frames_test"),
            labels_test: file("labels_test"),
            groups_test: file("groups_test"),
            lengths_test: file("lengths_test"),
            order: given.order.clone().or_else(|| spec.order.clone()),
            columns: given.columns.clone().or_else(|| spec.columns.clone()),
            grid: given.grid.or(spec.grid),
            full_scale: given.full_scale.or(spec.full_scale),
            shear: None,
            shear_test: None,
            ..spec.clone()
        };
        let is_given = given.order.is_some() || given.columns.is_some() || given.grid.is_some();
        spec.place.is_of_command |= is_given;
        let mut sets: Vec<RecordedArray> = Vec::new();
        for array in spec.frame_arrays() {
            let mut set = spec.read_frames(array, sets.first(), None)?;
            if let Some(first) = sets.first() {
                set.shape
                    .check_alike(&set.place, (&first.shape, &first.place))?;
            }
            set.fill_padding(f64::NAN);
            sets.push(set);
        }
        let n = [0, 1].map(|set| sets.get(set).map_or(0, |set| set.shape.n_touches));
        let of_sets = |name: &str| match spec.values_of_sets(name, n)? {
            [train, test] if n[1] > 0 && train.is_some() != test.is_some() => {
                let frames = spec.frames.display();
                let allowed =
                    format!("labels_test and groups_test, if {frames} has labels and groups");
                let place = spec.frames_file("frames_test").display();
                Err(Error::input(place, "a test set", allowed))
            }
            [train, test] => {
                let test = test.unwrap_or_default();
                Ok(train.map(|train| [train, test].concat()))
            }
        };
        let beside = |given: &Option<PathBuf>, name: &str| {
            let within = || is_member(&spec.frames, name).then(|| spec.frames.clone());
            let given = given.clone().or_else(within);
            given.or_else(|| file_in(&self.data, name))
        };
        let sessions = beside(&self.sessions, "sessions");
        let times = beside(&self.times, "times");
        let of_touches =
            |path, name| OneForEach::new(path, name, n[0] + n[1], touch_of(&spec.frames));
        let sessions = sessions
            .as_ref()
            .map(|path| of_touches(path, "sessions").groups());
        let times = times
            .as_ref()
            .map(|path| of_touches(path, "times").numbers(f64::is_finite, "finite numbers"));
        Ok(Part {
            labels: of_sets("labels")?,
            groups: of_sets("groups")?,
            sessions: sessions.transpose()?,
            times: times.transpose()?,
            spec,
            sets,
        })
    }
}

impl Part {
    /// Returns the number of touches of both sets.
    fn n_touches(&self) -> usize {
        self.sets.iter().map(|set| set.shape.n_touches).sum()
    }
}

/// Returns the keys of a recording of which only the file of the frames is known.
fn spec_of_frames(frames: &Path) -> RecordedSpec {
    RecordedSpec::of_frames(frames, [&None, &None], None)
}

/// Returns the file of an array in a folder, if there is one.
fn file_in(folder: &Path, name: &str) -> Option<PathBuf> {
    let endings = ["npy", "npz", "csv", "tsv", "txt"].into_iter();
    let mut paths = endings.map(|ending| folder.join(format!("{name}.{ending}")));
    paths.find(|path| path.is_file())
}

/// Joins a list of all parts. Returns `None` if a part has no such list.
///
/// # Errors
/// If the lists contain texts and numbers.
fn joined(
    name: &str,
    parts: &[Part],
    list: fn(&Part) -> &Option<Vec<KeyValue>>,
) -> Result<Option<Vec<KeyValue>>> {
    let lists = parts.iter().map(|part| list(part).as_deref());
    let values = lists
        .collect::<Option<Vec<_>>>()
        .map(|lists| lists.concat());
    let is_text = |value: &KeyValue| value.is_text();
    match &values {
        Some(values) if values.iter().any(is_text) && !values.iter().all(is_text) => {
            let given = "texts in one array and numbers in another";
            Err(Error::input(name, given, "texts or numbers in all"))
        }
        _ => Ok(values),
    }
}

/// Joins the arrays of all parts, one after the other, and sorts the touches by time if all parts have times.
fn assembled(parts: Vec<Part>) -> Result<AuditData> {
    let first = &parts[0].sets[0];
    let mut is_test = Vec::new();
    for part in &parts {
        let own = &part.sets[0];
        own.shape
            .check_alike(&own.place, (&first.shape, &first.place))?;
        for (number, set) in part.sets.iter().enumerate() {
            is_test.extend(vec![number > 0; set.shape.n_touches]);
        }
    }
    let shape = &first.shape;
    let grid = shape.grid().map(|[rows, columns]| (rows, columns));
    let n_frames = shape.n_frames;
    let labels = joined("labels", &parts, |part| &part.labels)?;
    let labels = labels.map(|values| ClassLabels::new(&values));
    let mut spec = parts[0].spec.clone();
    // Texts are their own names.
    if labels
        .as_ref()
        .is_some_and(|labels| labels.classes[0].is_text())
    {
        spec.names = None;
    }
    let classes = labels.as_ref().map(|labels| spec.classes(labels));
    let groups = joined("groups", &parts, |part| &part.groups)?;
    let sessions = joined("sessions", &parts, |part| &part.sessions)?;
    let times: Option<Vec<Vec<f64>>> = parts.iter().map(|part| part.times.clone()).collect();
    let sets = parts.into_iter().flat_map(|part| part.sets);
    let mut all: Vec<Array2<f64>> = sets.map(|set| set.readings).collect();
    let frames = match all.len() {
        1 => all.remove(0),
        _ => {
            let views: Vec<_> = all.iter().map(Array2::view).collect();
            concatenate(Axis(0), &views).expect("the shapes are checked")
        }
    };
    let mut data = AuditData {
        frames,
        n_frames,
        grid,
        classes: classes
            .transpose()?
            .map_or(Vec::new(), |classes| classes.names),
        labels: labels.map(|labels| labels.labels),
        groups: groups.map(|values| group_keys(&values)),
        sessions: sessions.map(|values| group_keys(&values)),
        is_test: is_test.contains(&true).then_some(is_test),
        full_scale: spec.full_scale,
        ..AuditData::default()
    };
    if let Some(times) = times {
        data.sort_by_time(&times.concat());
    }
    Ok(data)
}
