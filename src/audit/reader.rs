//! Files of an audit: recorded frames with labels and groups as studies read them, and their sessions and times.

use crate::audit::data::AuditData;
use crate::error::{Error, Result};
use crate::inputs::arrays::axis_order::FrameShape;
use crate::inputs::arrays::{
    ClassLabels, KeyValue, group_keys, is_member, read_class_values, read_group_values,
};
use crate::studies::recognition::frames::touch_lengths::{
    lengths_of_file, numbers_of, one_each, touch_of,
};
use crate::studies::recognition::spec::recorded::RecordedSpec;
use ndarray::{Array2, Axis, concatenate, s};
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

/// Arrays of one recording: all touches, or the training touches followed by the test set.
struct Part {
    spec: RecordedSpec,
    shape: FrameShape,
    frames: Vec<Array2<f64>>,
    /// Whether each touch belongs to the test set.
    is_test: Vec<bool>,
    /// Class, group and session of each touch.
    lists: [Option<Vec<KeyValue>>; 3],
    times: Option<Vec<f64>>,
}

/// Function that reads one value for each of some touches from an array of a file.
type ReadValues = fn(&Path, &str, usize) -> Result<Vec<KeyValue>>;

impl AuditFiles {
    /// Reads the data. Touches with times are sorted by time.
    ///
    /// # Errors
    /// If a file cannot be read or does not fit the others; the error names it.
    pub fn read(&self) -> Result<AuditData> {
        let recorded = self.data.join("recorded.toml");
        let of_frames = |frames: &Path| RecordedSpec::of_frames(frames, [&None, &None], None);
        if recorded.is_file() {
            return assembled(vec![self.part(&self.spec_of(&recorded)?)?]);
        }
        let frames = match self.data.is_dir() {
            true => file_in(&self.data, "frames"),
            false => Some(self.data.clone()),
        };
        match frames {
            Some(frames) => assembled(vec![self.part(&of_frames(&frames))?]),
            None => self.of_sessions(of_frames),
        }
    }

    /// Reads the table `[recorded]` of a file, which describes one sensor.
    fn spec_of(&self, path: &Path) -> Result<RecordedSpec> {
        let allowed = "a study with a table [recorded]";
        let text = crate::files::read_to_string(path)
            .map_err(|error| Error::unreadable(path, allowed, error))?;
        let refuse = |error: toml::de::Error| {
            Error::input(path.display(), error.message().to_owned(), allowed)
        };
        let read = || toml::from_str::<RecordedToml>(&text);
        let spec = crate::files::with_folder(self.data.clone(), read).map_err(refuse)?;
        let mut spec = spec.recorded;
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
    fn of_sessions(&self, of_frames: impl Fn(&Path) -> RecordedSpec) -> Result<AuditData> {
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
            let mut part = self.part(&of_frames(path))?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let session = vec![KeyValue::Text(name.into_owned()); part.is_test.len()];
            part.lists[2].get_or_insert(session);
            Ok(part)
        });
        assembled(parts.collect::<Result<_>>()?)
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
            ..spec.clone()
        };
        let is_given = given.order.is_some() || given.columns.is_some() || given.grid.is_some();
        spec.place.is_of_command |= is_given;
        let shape = spec.shape_of("frames")?;
        let (mut frames, mut is_test, mut lists) = (Vec::new(), Vec::new(), [None, None, None]);
        let mut columns = None;
        for end in ["", "_test"] {
            let is_set = !end.is_empty();
            if is_set && spec.frames_test.is_none() {
                continue;
            }
            let key = |name: &str| format!("{name}{end}");
            let place = spec.file_of(&key("frames")).unwrap_or(&spec.frames);
            let own = spec.shape_of(&key("frames"))?;
            check_shape((&own, place), (&shape, &spec.frames))?;
            let array = spec.read_array(&key("frames"))?;
            array.check_columns_of(columns.as_deref(), &spec.frames.display().to_string())?;
            columns.clone_from(&array.columns);
            let mut readings = own.arrange(array.into_numbers()?);
            if let Some(path) = spec.file_of(&key("lengths")) {
                let lengths = lengths_of_file((path, &key("lengths")), &own, place)?;
                // Frames after the end of a touch are padding.
                for (touch, length) in lengths.into_iter().enumerate() {
                    let padding = touch * own.n_frames + length..(touch + 1) * own.n_frames;
                    readings.slice_mut(s![padding, ..]).fill(f64::NAN);
                }
            }
            frames.push(readings);
            is_test.extend(vec![is_set; own.n_touches]);
            let reads: [(&str, ReadValues); 2] =
                [("labels", read_class_values), ("groups", read_group_values)];
            for (list, (name, read)) in lists.iter_mut().zip(reads) {
                let path = spec.file_of(&key(name));
                if is_set && list.is_some() != path.is_some() {
                    let frames = spec.frames.display();
                    let allowed =
                        format!("labels_test and groups_test, if {frames} has labels and groups");
                    return Err(Error::input(place.display(), "a test set", allowed));
                }
                if let Some(path) = path {
                    let values = read(path, &key(name), own.n_touches)?;
                    one_each(
                        (path, &key(name)),
                        (values.len(), own.n_touches),
                        touch_of(place),
                    )?;
                    list.get_or_insert_with(Vec::new).extend(values);
                }
            }
        }
        let n = is_test.len();
        let beside = |given: &Option<PathBuf>, name: &str| {
            let within = || is_member(&spec.frames, name).then(|| spec.frames.clone());
            let given = given.clone().or_else(within);
            given.or_else(|| file_in(&self.data, name))
        };
        if let Some(path) = beside(&self.sessions, "sessions") {
            let sessions = read_group_values(&path, "sessions", n)?;
            one_each(
                (&path, "sessions"),
                (sessions.len(), n),
                touch_of(&spec.frames),
            )?;
            lists[2] = Some(sessions);
        }
        let times = beside(&self.times, "times");
        let times = times.map(|path| {
            let each = (n, "touch".to_owned());
            numbers_of((&path, "times"), each, f64::is_finite, "finite numbers")
        });
        Ok(Part {
            times: times.transpose()?,
            spec,
            shape,
            frames,
            is_test,
            lists,
        })
    }
}

/// Returns the file of an array in a folder, if there is one.
fn file_in(folder: &Path, name: &str) -> Option<PathBuf> {
    let endings = ["npy", "npz", "csv", "tsv", "txt"].into_iter();
    let mut paths = endings.map(|ending| folder.join(format!("{name}.{ending}")));
    paths.find(|path| path.is_file())
}

/// Checks that frames have the taxels and the number of frames of the first file.
fn check_shape((own, path): (&FrameShape, &Path), first: (&FrameShape, &Path)) -> Result<()> {
    let sides = |shape: &FrameShape| shape.has_grid.then_some((shape.rows, shape.columns));
    let counts = |shape: &FrameShape| (shape.n_frames, shape.n_frame_values());
    if (sides(own), counts(own)) == (sides(first.0), counts(first.0)) {
        return Ok(());
    }
    let words = |shape: &FrameShape| {
        let (n_frames, n_taxels) = counts(shape);
        format!("{n_frames} frames of {n_taxels} taxels a touch")
    };
    let allowed = format!("{}, as {}", words(first.0), first.1.display());
    Err(Error::input(path.display(), words(own), allowed))
}

/// Joins the arrays of all parts, one after the other, and sorts the touches by time if all parts have times.
fn assembled(parts: Vec<Part>) -> Result<AuditData> {
    let first = &parts[0];
    for part in &parts {
        check_shape(
            (&part.shape, &part.spec.frames),
            (&first.shape, &first.spec.frames),
        )?;
    }
    let joined = |name: &str, list: usize| {
        let lists = parts.iter().map(|part| part.lists[list].clone());
        let lists: Option<Vec<Vec<KeyValue>>> = lists.collect();
        let values = lists.map(|lists| lists.concat()).unwrap_or_default();
        let n_texts = values.iter().filter(|value| value.is_text()).count();
        match n_texts == 0 || n_texts == values.len() {
            true => Ok(Some(values).filter(|values| !values.is_empty())),
            false => {
                let given = "texts in one array and numbers in another";
                Err(Error::input(name, given, "texts or numbers in all"))
            }
        }
    };
    let mut spec = first.spec.clone();
    let labels = joined("labels", 0)?.map(|values| ClassLabels::new(&values));
    // Texts are their own names.
    let is_text = |labels: &ClassLabels| labels.classes[0].is_text();
    if labels.as_ref().is_some_and(is_text) {
        spec.names = None;
    }
    let classes = labels.as_ref().map(|labels| spec.classes(labels));
    let (groups, sessions) = (joined("groups", 1)?, joined("sessions", 2)?);
    let times: Option<Vec<Vec<f64>>> = parts.iter().map(|part| part.times.clone()).collect();
    let is_test: Vec<bool> = parts.iter().flat_map(|part| part.is_test.clone()).collect();
    let n_frames = first.shape.n_frames;
    let grid = first
        .shape
        .has_grid
        .then_some((first.shape.rows, first.shape.columns));
    let mut all: Vec<Array2<f64>> = parts.into_iter().flat_map(|part| part.frames).collect();
    let frames = match all.len() {
        1 => all.remove(0),
        _ => {
            let views: Vec<_> = all.iter().map(Array2::view).collect();
            concatenate(Axis(0), &views)
                .map_err(|error| Error::input("frames", error, "frames of equal shape"))?
        }
    };
    let mut data = AuditData {
        frames,
        n_frames,
        grid,
        classes: classes.transpose()?.map_or(Vec::new(), |classes| classes.0),
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
