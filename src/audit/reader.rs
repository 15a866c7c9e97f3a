//! Files of an audit: frames with labels, groups and sessions in the formats that studies with recorded frames read.

use crate::audit::data::AuditData;
use crate::error::{Error, Result};
use crate::inputs::arrays::file_array::FileArray;
use crate::inputs::arrays::{
    ClassLabels, KeyValue, TableContent, group_keys, is_member, read_class_values,
    read_group_values,
};
use crate::studies::recognition::frames::touch_lengths::lengths_of_file;
use crate::studies::recognition::spec::recorded::RecordedSpec;
use ndarray::{Array2, Axis, concatenate, s};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Endings of files with arrays.
const ENDINGS: [&str; 5] = ["npy", "npz", "csv", "tsv", "txt"];
/// Name of a folder's file that lists the files of a recording.
const RECORDED: &str = "recorded.toml";

/// Paths and options of the data of an audit.
#[derive(Clone, Debug, Default)]
pub struct AuditFiles {
    /// File with the frames; or a folder with `recorded.toml`, with a file `frames`, or with one archive for each session.
    pub data: PathBuf,
    /// File with the class of each touch; `None` for an array or file `labels` beside the frames.
    pub labels: Option<PathBuf>,
    /// File with the group of each touch; `None` for an array or file `groups` beside the frames, if there is one.
    pub groups: Option<PathBuf>,
    /// File with the session of each touch; `None` for an array or file `sessions` beside the frames, if there is one.
    pub sessions: Option<PathBuf>,
    /// File with the time of each touch, a number; `None` for an array or file `times` beside the frames, if there is one.
    pub times: Option<PathBuf>,
    /// File with the number of frames of each touch; `None` for an array or file `lengths` beside the frames, if there is one.
    pub lengths: Option<PathBuf>,
    /// File with the number of frames of each touch of the test set; `None` for an array or file `lengths_test` beside the frames, if there is one.
    pub lengths_test: Option<PathBuf>,
    /// File with the frames of a given test set; `None` for an array or file `frames_test` beside the frames, if there is one.
    pub frames_test: Option<PathBuf>,
    /// File with the class of each touch of the test set; `None` for an array or file `labels_test` beside the frames.
    pub labels_test: Option<PathBuf>,
    /// File with the group of each touch of the test set; `None` for an array or file `groups_test` beside the frames, if there is one.
    pub groups_test: Option<PathBuf>,
    /// Order of the axes of the frames, one letter per axis, as in `recorded.order`; `None` for the default order.
    pub order: Option<String>,
    /// Columns of a table of frames that are readings, as in `recorded.columns`; `None` for all columns.
    pub columns: Option<String>,
    /// Numbers of rows and columns of the skin, if the axis `c` of the frames lists its taxels row by row.
    pub grid: Option<[usize; 2]>,
    /// Reading at full scale; `None` if unknown.
    pub full_scale: Option<f64>,
    /// Name of the sensor whose array is read from an archive of several sensors; `None` for the array `frames`.
    pub sensor: Option<String>,
}

/// Table `[recorded]` of a study; other tables are ignored.
#[derive(Deserialize)]
struct RecordedToml {
    recorded: RecordedSpec,
}

/// Arrays of one file or session.
struct Part {
    frames: Array2<f64>,
    n_frames: usize,
    grid: Option<(usize, usize)>,
    /// Class, group and session of each touch.
    lists: [Option<Vec<KeyValue>>; 3],
    times: Option<Vec<f64>>,
}

impl AuditFiles {
    /// Reads the data. Touches with times are sorted by time.
    ///
    /// # Errors
    /// If a file cannot be read or does not fit the others; the error names it.
    pub fn read(&self) -> Result<AuditData> {
        if let Some(full_scale) = self.full_scale.filter(|full| !full.is_finite()) {
            return Err(Error::input("full scale", full_scale, "a finite number"));
        }
        if !self.data.is_dir() {
            return self.with_test_set(&self.data, None);
        }
        let recorded = self.data.join(RECORDED);
        if recorded.is_file() {
            return self.with_recorded(&recorded);
        }
        let frames = ENDINGS.map(|ending| self.data.join(format!("frames.{ending}")));
        if let Some(frames) = frames.iter().find(|path| path.is_file()) {
            return self.with_test_set(frames, Some(&self.data));
        }
        self.of_sessions()
    }

    /// Reads the recording that `recorded.toml` of the folder describes.
    fn with_recorded(&self, path: &Path) -> Result<AuditData> {
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
        let sensors = spec.used_sensors();
        let [(_, spec)] = &sensors[..] else {
            let place = format!("{}, key recorded.sensors", path.display());
            let given = format!("{} sensors", sensors.len());
            let allowed = "one sensor: its name in recorded.sensor, or the file of its frames";
            return Err(Error::input(place, given, allowed));
        };
        let given = |name: &str| spec.file_of(name).map(Path::to_owned);
        let files = Self {
            data: spec.frames.clone(),
            labels: self.labels.clone().or_else(|| given("labels")),
            groups: self.groups.clone().or_else(|| given("groups")),
            lengths: given("lengths"),
            lengths_test: given("lengths_test"),
            frames_test: given("frames_test"),
            labels_test: given("labels_test"),
            groups_test: given("groups_test"),
            order: self.order.clone().or_else(|| spec.order.clone()),
            columns: self.columns.clone().or_else(|| spec.columns.clone()),
            grid: self.grid.or(spec.grid),
            full_scale: self.full_scale.or(spec.full_scale),
            sensor: spec.place.name.clone(),
            ..self.clone()
        };
        files.with_test_set(&files.data, Some(&self.data))
    }

    /// Reads the frames of a file, followed by those of the given test set if there is one.
    fn with_test_set(&self, frames: &Path, folder: Option<&Path>) -> Result<AuditData> {
        let mut parts = vec![self.part(frames, folder, "")?];
        if let Some(path) = beside((frames, folder), &self.frames_test, "frames_test") {
            let of_test = Self {
                labels: self.labels_test.clone(),
                groups: self.groups_test.clone(),
                lengths: self.lengths_test.clone(),
                sessions: None,
                times: None,
                ..self.clone()
            };
            parts.push(of_test.part(&path, folder, "_test")?);
            check_shape((&parts[1], &path), (&parts[0], frames))?;
            let has = |part: &Part| [0, 1].map(|list| part.lists[list].is_some());
            if has(&parts[0]) != has(&parts[1]) {
                let allowed = format!(
                    "labels_test and groups_test, if {} has labels and groups",
                    frames.display()
                );
                return Err(Error::input(path.display(), "a test set", allowed));
            }
        }
        let n_train = parts[0].frames.nrows() / parts[0].n_frames;
        let has_test = parts.len() > 1;
        let mut data = assembled(parts, self.full_scale)?;
        if has_test {
            let n = data.n_touches();
            data.is_test = Some((0..n).map(|touch| touch >= n_train).collect());
        }
        Ok(data)
    }

    /// Reads all archives of the folder, each as a session.
    fn of_sessions(&self) -> Result<AuditData> {
        let entries = std::fs::read_dir(&self.data);
        let entries = entries.map_err(|error| Error::io(&self.data, "read", error))?;
        let mut archives: Vec<PathBuf> = entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.extension().is_some_and(|ending| ending == "npz"))
            .filter(|path| !is_hidden(path))
            .collect();
        archives.sort();
        if archives.is_empty() {
            let allowed = "recorded.toml, a file frames.npy (.npz, .csv), or one .npz archive for each session";
            return Err(Error::input(
                self.data.display(),
                "a folder without frames",
                allowed,
            ));
        }
        let given = [
            ("labels", &self.labels),
            ("groups", &self.groups),
            ("sessions", &self.sessions),
            ("times", &self.times),
        ];
        if let Some((name, Some(path))) = given.into_iter().find(|(_, path)| path.is_some()) {
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
            let mut part = self.part(path, None, "")?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let n = part.frames.nrows() / part.n_frames;
            let session = vec![KeyValue::Text(name.into_owned()); n];
            part.lists[2].get_or_insert(session);
            Ok(part)
        });
        let parts = parts.collect::<Result<Vec<Part>>>()?;
        for (part, path) in parts.iter().zip(&archives).skip(1) {
            check_shape((part, path), (&parts[0], &archives[0]))?;
        }
        assembled(parts, self.full_scale)
    }

    /// Reads the frames of a file, and the arrays that belong to them. If `folder` is given, files beside the frames are found by their names, which have the
    /// ending `end`.
    fn part(&self, frames: &Path, folder: Option<&Path>, end: &str) -> Result<Part> {
        let key_of_frames = format!("frames{end}");
        let mut spec = RecordedSpec::of_frames(frames, [&self.order, &self.columns], self.grid);
        spec.place.name.clone_from(&self.sensor);
        spec.frames_test = (!end.is_empty()).then(|| frames.to_owned());
        let shape = spec.shape_of(&key_of_frames)?;
        let mut readings = shape.arrange(spec.read_array(&key_of_frames)?.into_numbers()?);
        let n = shape.n_touches;
        let file = |given: &Option<PathBuf>, name: &str| {
            beside((frames, folder), given, &format!("{name}{end}"))
        };
        if let Some(path) = file(&self.lengths, "lengths") {
            let lengths = lengths_of_file((&path, &format!("lengths{end}")), &shape, frames)?;
            // Frames after the end of a touch are padding.
            for (touch, length) in lengths.into_iter().enumerate() {
                let first = touch * shape.n_frames;
                let padding = first + length..first + shape.n_frames;
                readings.slice_mut(s![padding, ..]).fill(f64::NAN);
            }
        }
        let one_each = |path: &Path, n_values: usize, what: &str| match n_values == n {
            true => Ok(()),
            false => {
                let allowed = format!("{n}, one for each touch of {}", frames.display());
                Err(Error::input(
                    path.display(),
                    format!("{n_values} {what}"),
                    allowed,
                ))
            }
        };
        let list = |given: &Option<PathBuf>, name: &str, read: ReadValues| -> Result<_> {
            let Some(path) = file(given, name) else {
                return Ok(None);
            };
            let values = read(&path, &format!("{name}{end}"), n)?;
            one_each(&path, values.len(), "values")?;
            Ok(Some(values))
        };
        let mut times = None;
        if let Some(path) = file(&self.times, "times") {
            let name = format!("times{end}");
            let read = FileArray::read_content(&path, &name, TableContent::Rows(n))?;
            let read = read.into_numbers()?;
            one_each(&path, read.len(), "times")?;
            if let Some(time) = read.iter().find(|time| !time.is_finite()) {
                return Err(Error::input(path.display(), time, "finite numbers"));
            }
            times = Some(read.into_iter().collect());
        }
        Ok(Part {
            n_frames: shape.n_frames,
            grid: shape.has_grid.then_some((shape.rows, shape.columns)),
            frames: readings,
            lists: [
                list(&self.labels, "labels", read_class_values)?,
                list(&self.groups, "groups", read_group_values)?,
                list(&self.sessions, "sessions", read_group_values)?,
            ],
            times,
        })
    }
}

/// Function that reads one value for each of some touches from an array of a file.
type ReadValues = fn(&Path, &str, usize) -> Result<Vec<KeyValue>>;

/// Returns whether a file is hidden, such as the files `._NAME` that macOS writes beside others.
fn is_hidden(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().starts_with('.')
}

/// Returns the file of an array: `given`, or else the file of the frames if it contains an array `name`, or else a file of this name in the folder.
fn beside(
    (frames, folder): (&Path, Option<&Path>),
    given: &Option<PathBuf>,
    name: &str,
) -> Option<PathBuf> {
    let in_folder = || {
        let folder = folder?;
        let paths = ENDINGS.map(|ending| folder.join(format!("{name}.{ending}")));
        paths.into_iter().find(|path| path.is_file())
    };
    let within = || is_member(frames, name).then(|| frames.to_owned());
    given.clone().or_else(within).or_else(in_folder)
}

/// Checks that a part has the taxels and frames of the first part.
///
/// # Errors
/// If the part has another grid, or another number of taxels or frames.
fn check_shape((part, path): (&Part, &Path), (first, of_first): (&Part, &Path)) -> Result<()> {
    let shape = |part: &Part| (part.frames.ncols(), part.n_frames);
    if shape(part) == shape(first) && part.grid == first.grid {
        return Ok(());
    }
    let given = format!(
        "{} frames of {} taxels a touch",
        part.n_frames,
        part.frames.ncols()
    );
    let (n_taxels, n_frames) = shape(first);
    let allowed = format!("{n_frames} of {n_taxels}, as {}", of_first.display());
    Err(Error::input(path.display(), given, allowed))
}

/// Joins the arrays of all parts, one after the other, and sorts the touches by time if all parts have times.
fn assembled(parts: Vec<Part>, full_scale: Option<f64>) -> Result<AuditData> {
    let joined = |name: &str, list: usize| {
        let lists = parts.iter().map(|part| part.lists[list].clone());
        let lists: Option<Vec<Vec<KeyValue>>> = lists.collect();
        let values = lists.map(|lists| lists.concat()).unwrap_or_default();
        let is_text = |value: &KeyValue| matches!(value, KeyValue::Text(_));
        let n_texts = values.iter().filter(|value| is_text(value)).count();
        match n_texts == 0 || n_texts == values.len() {
            true => Ok(Some(values).filter(|values| !values.is_empty())),
            false => {
                let given = "texts in one array and numbers in another";
                Err(Error::input(name, given, "texts or numbers in all"))
            }
        }
    };
    let labels = joined("labels", 0)?.map(|values| ClassLabels::new(&values));
    let groups = joined("groups", 1)?.map(|values| group_keys(&values));
    let sessions = joined("sessions", 2)?.map(|values| group_keys(&values));
    let times = parts.iter().map(|part| part.times.clone());
    let times: Option<Vec<Vec<f64>>> = times.collect();
    let times: Option<Vec<f64>> = times.map(|times| times.concat());
    let (n_frames, grid) = (parts[0].n_frames, parts[0].grid);
    let mut all: Vec<Array2<f64>> = parts.into_iter().map(|part| part.frames).collect();
    let frames = match all.len() {
        1 => all.remove(0),
        _ => {
            let views: Vec<_> = all.iter().map(Array2::view).collect();
            concatenate(Axis(0), &views)
                .map_err(|error| Error::input("frames", error, "frames of equal shape"))?
        }
    };
    let name = |class: &KeyValue| match class {
        KeyValue::Integer(number) => format!("class {number}"),
        KeyValue::Text(text) => text.clone(),
    };
    let mut data = AuditData {
        frames,
        n_frames,
        grid,
        classes: labels
            .iter()
            .flat_map(|labels| &labels.classes)
            .map(name)
            .collect(),
        labels: labels.map(|labels| labels.labels),
        groups,
        sessions,
        full_scale,
        is_in_order_of_time: times.is_some(),
        ..AuditData::default()
    };
    if let Some(times) = times {
        data.sort_by_time(&times);
    }
    Ok(data)
}
