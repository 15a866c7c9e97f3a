//! Feature files of one configuration, with which other programs can train on exactly the rows that a run uses.
//!
//! | file | content |
//! |---|---|
//! | `features.npy` | n × m, f64: the measurements of every touch, before scaling; with several readings, the first reading of every touch, then the second, … |
//! | `labels.npy` | n, i64: the object's number (another object's for mislabelled training touches) |
//! | `train.npy` | i64: training rows of the trial, in drawing order; a prefix is a smaller training set (measurements that are fitted use all of them) |
//! | `test.npy` | i64: test rows of the trial, ascending |
//! | `groups.npy` | n, i64: the group of every row, if the split does not divide groups |
//! | `objects.csv` | one row per object: number, name |
//! | `configuration.toml` | the settings of the configuration and the trial |
//! | `manifest.json` | the files of the folder; only files listed in it may be replaced |

use crate::files::{CsvFile, DataFolder, write_bytes};
use crate::inputs::arrays::{
    ClassLabels, ColumnNames, KeyValue, OneForEach, check_names, group_keys, is_member,
    read_matrix, read_rows,
};
use crate::inputs::npy::{write_integers, write_npy};
use crate::note::note;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::Frames;
use crate::studies::recognition::measurements::{MeasuredTrial, Measurements, measure_group};
use crate::studies::recognition::spec::RecognitionSpec;
use crate::studies::recognition::sweep::{StudyPart, Sweep, TrainingRows};
use crate::studies::recognition::training::{FamilyInputs, learned_rows};
use bubbletouch_svm::dataset::{Dataset, dataset, rows};
use ndarray::{Array1, Array2, Axis};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Names of all exported feature files, except the manifest.
pub const FEATURE_FILES: [&str; 7] = [
    "features.npy",
    "labels.npy",
    "train.npy",
    "test.npy",
    "groups.npy",
    "objects.csv",
    "configuration.toml",
];

/// Labelled feature rows of touches, with the training and test rows of one trial.
#[derive(Clone, Debug)]
pub struct FeatureSet {
    /// Measurements of every touch before scaling, shape (n_touches, m), and the object numbers as labels.
    pub data: Dataset,
    /// Row numbers of the trial's training and test touches.
    pub split: Split,
    /// Group number of every row; `None` if a split into training and test rows may divide groups.
    pub groups: Option<Array1<usize>>,
    /// Label of each class, as it is written in the label file.
    pub classes: Vec<KeyValue>,
    /// Names of the features, if they are from a table with a header.
    pub columns: ColumnNames,
}

#[derive(Serialize)]
struct ObjectRow<'a> {
    label: usize,
    object: &'a str,
}

/// Content of the file `configuration.toml`: the trial number and the settings of the configuration.
#[derive(Serialize)]
struct Settings<'a> {
    question: &'a str,
    seed: u64,
    trial: usize,
    n_train: usize,
    n_test: usize,
    configuration: &'a Configuration,
    recognition: &'a RecognitionSpec,
}

impl StudyPart {
    /// Computes the measurements of one configuration in one trial, exactly as its classifier receives them.
    ///
    /// # Errors
    /// If the study does not have the configuration or the trial, or a signal step or projection is invalid.
    pub fn features(
        &self,
        (configuration, trial): (usize, usize),
        progress: &dyn Progress,
    ) -> Result<FeatureSet> {
        let (plan, sweep) = (&self.plan, &self.sweep);
        let (group, configuration) = find(sweep, configuration)?;
        let inputs = sweep.trial(plan, trial)?;
        let family = FamilyInputs::new(plan, sweep, std::slice::from_ref(configuration));
        let (split, labels) = inputs.training(&family.training_rows)?;
        // As in a run, nested measurements are the first m of the largest set.
        let of_group = group.inputs(plan);
        let n_projected = match group.ensemble.is_prefix_nested() {
            true => of_group.projected[0],
            false => configuration.measurements,
        };
        let fitted = of_group.fitted_rows(plan, group, configuration);
        let of = (group, fitted, n_projected);
        let measured = self.measured(of, trial, ("touch", progress))?;
        let (trained, trained_labels) =
            learned_rows(&measured, &family.rows, &split.train, &labels);
        // All readings of all touches, followed by copies of the training touches.
        let touches: Vec<usize> = (0..labels.len()).collect();
        let read = measured.readings(&touches);
        let n_trained = measured.readings(&split.train).len();
        let (trained, copies) = trained.split_at(n_trained);
        let of_read = read.iter().map(|row| labels[row % labels.len()]);
        let of_copies = trained_labels.iter().skip(n_trained).copied();
        let rows = [&read[..], copies].concat();
        let copied = split.train.iter().cycle().take(copies.len()).copied();
        let touched = read.iter().map(|row| row % labels.len()).chain(copied);
        let touched: Vec<usize> = touched.collect();
        let groups = sweep.group_keys.as_ref();
        let n_classes = self.touched.classes().len() as i64;
        Ok(FeatureSet {
            classes: (0..n_classes).map(KeyValue::Integer).collect(),
            columns: None,
            groups: groups.map(|groups| groups.select(Axis(0), &touched)),
            data: dataset(
                measured.features(&family.rows, &rows)?,
                of_read.chain(of_copies).collect(),
            )?,
            split: Split {
                train: [trained, &Vec::from_iter(read.len()..rows.len())].concat(),
                test: split.test,
            },
        })
    }

    /// Checks whether the study has the configuration and the trial, and whether the running program provides the features of the configuration.
    ///
    /// # Errors
    /// If one of these conditions is not met.
    pub fn check_features(&self, (configuration, trial): (usize, usize)) -> Result<()> {
        let (_, configuration) = find(&self.sweep, configuration)?;
        self.sweep.trial(&self.plan, trial)?;
        configuration.check_features()
    }

    /// Simulates the touches of a group of configurations, and computes their measurements in one trial.
    pub(crate) fn measured(
        &self,
        (group, rows, n_measurements): (&MeasurementGroup, TrainingRows, usize),
        trial: usize,
        (stage, progress): (&str, &dyn Progress),
    ) -> Result<Measurements> {
        let array = &self.plan.array;
        let n_touches = self.sweep.labels.len() as u64;
        progress.stage(&format!("{stage} {}", array.describe()), n_touches);
        let frames = self.touched.simulate((array, group.frames), progress);
        let tested = self
            .plan
            .tested
            .as_ref()
            .map(|plan| self.tested.simulate((&plan.array, group.frames), &Silent));
        let tested = tested.as_ref().unwrap_or(&frames);
        self.measure((group, rows), [&frames, tested], (trial, n_measurements))
    }

    /// Computes the measurements of the training and test touches of a group of configurations in one trial. Runs and exports share this function. Projections
    /// and image estimators are fitted to the training touches that `rows` leaves.
    pub(crate) fn measure(
        &self,
        (group, rows): (&MeasurementGroup, TrainingRows),
        [frames, tested]: [&Frames; 2],
        (trial, n_measurements): (usize, usize),
    ) -> Result<Measurements> {
        let inputs = group.inputs(&self.plan);
        let fitted = match inputs.is_fitted() {
            true => Some(self.sweep.trial(&self.plan, trial)?.training(&rows)?),
            false => None,
        };
        let trial = MeasuredTrial {
            fitted: fitted.as_ref(),
            ..inputs.trial(&self.sweep, trial)
        };
        let touches = (self.touched.as_ref() as _, frames);
        let tested = (self.tested.as_ref() as _, tested);
        measure_group(&inputs, touches, tested, (trial, n_measurements))
    }

    /// Writes the measurements of one configuration in one trial to a folder. The folder must exist and be claimed for [`FEATURE_FILES`].
    ///
    /// # Errors
    /// If the study does not have the configuration or the trial, or a file cannot be written.
    pub fn write_features(
        &self,
        (folder, claimed): (&Path, &DataFolder),
        (configuration, trial): (usize, usize),
        progress: &dyn Progress,
    ) -> Result<FeatureSet> {
        let spec = &self.plan.spec;
        let set = self.features((configuration, trial), progress)?;
        let Split { train, test } = &set.split;
        claimed.write_manifest()?;
        write_npy(&folder.join("features.npy"), &set.data.records)?;
        write_integers(&folder.join("labels.npy"), set.data.targets.to_vec())?;
        write_integers(&folder.join("train.npy"), train.clone())?;
        write_integers(&folder.join("test.npy"), test.clone())?;
        if let Some(groups) = &set.groups {
            write_integers(&folder.join("groups.npy"), groups.to_vec())?;
        }
        let mut objects = CsvFile::create(&folder.join("objects.csv"))?;
        for (label, object) in self.touched.class_names().into_iter().enumerate() {
            objects.row(ObjectRow { label, object })?;
        }
        objects.commit()?;
        let settings = Settings {
            question: &spec.question,
            seed: spec.seed,
            trial,
            n_train: train.len(),
            n_test: test.len(),
            configuration: find(&self.sweep, configuration)?.1,
            recognition: &spec.recognition,
        };
        let text =
            toml::to_string(&settings).expect("every setting of a configuration has a TOML form");
        write_bytes(&folder.join("configuration.toml"), text.as_bytes())?;
        Ok(set)
    }
}

/// Reads a feature folder written by this or by another program. Only the four arrays are required, each as `.npy`, `.npz` or `.csv`,
/// or all in `features.npz`. Features may be of any numeric type or bool. Labels are integers, texts, or n × classes of 0 and 1. Rows are integers of any type,
/// or a mask with a bool for each row of features.
///
/// # Errors
/// If a file is missing or has another number of dimensions or element type than the table above. If a feature is NaN or infinite (the error gives row and
/// column). If there is not one non-negative label per row. If training or test rows are empty, beyond the features, or listed twice in one or both lists.
pub fn read_features(folder: &Path) -> Result<FeatureSet> {
    let file = |name: &str| array_file(folder, name);
    let (features, columns) = read_matrix(&file("features"), "features")?;
    let n_rows = features.nrows();
    let labels = of_rows(&file("labels"), "labels", n_rows).class_labels()?;
    let split = Split {
        train: read_rows(&file("train"), "train", n_rows)?,
        test: read_rows(&file("test"), "test", n_rows)?,
    };
    check_split(folder, &split, n_rows)?;
    note_class_columns(folder, &features, &labels);
    let features = features.as_standard_layout().into_owned();
    let data = dataset(features, Array1::from(labels.labels));
    let data = data.map_err(|error| Error::from(error).under(format!("{}: ", folder.display())))?;
    Ok(FeatureSet {
        data,
        split,
        groups: None,
        classes: labels.classes,
        columns,
    })
}

/// Writes a note for each column of features that has one value for each class, as a column of labels has. A class has two rows or more on average.
fn note_class_columns(folder: &Path, features: &Array2<f64>, labels: &ClassLabels) {
    for (number, column) in features.columns().into_iter().enumerate() {
        let mut values = vec![f64::NAN; labels.classes.len()];
        let mut rows = labels.labels.iter().zip(column);
        let is_of_class = rows.all(|(&label, &value)| {
            let known = &mut values[label];
            *known = if known.is_nan() { value } else { *known };
            *known == value
        });
        values.sort_by(f64::total_cmp);
        values.dedup();
        let n_classes = labels.classes.len();
        if is_of_class && values.len() == n_classes && features.nrows() >= 2 * n_classes {
            note(format_args!(
                "{}: column {} of the features has one value for each class; remove it if it is the label",
                folder.display(),
                number + 1
            ));
        }
    }
}

/// Rows to which a trained classifier is applied.
#[derive(Clone, Debug)]
pub struct NewRows {
    /// Features, shape (n, m).
    pub features: Array2<f64>,
    /// Label of each row, as in the label file; `None` without labels.
    pub labels: Option<Vec<KeyValue>>,
}

/// Reads the rows of a feature folder to which a trained classifier is applied: its test rows, or all rows if the folder has no `test`. The names of the features
/// of the training rows are `trained`.
///
/// # Errors
/// If a file cannot be read, labels or test rows do not fit the features, or a feature has another name than in the training rows.
pub fn read_new_rows(folder: &Path, trained: Option<&[String]>) -> Result<NewRows> {
    let file = |name: &str| array_file(folder, name);
    let has = |name: &str| {
        let path = file(name);
        path.exists() && (path.file_stem() == Some(name.as_ref()) || is_member(&path, name))
    };
    let path = file("features");
    let (features, columns) = read_matrix(&path, "features")?;
    let names = [columns.as_deref(), trained];
    check_names(&path.display().to_string(), names, "the training rows")?;
    let n_rows = features.nrows();
    let rows = match has("test") {
        true => read_rows(&file("test"), "test", n_rows)?,
        false => (0..n_rows).collect(),
    };
    let mut labels = None;
    if has("labels") {
        let read = of_rows(&file("labels"), "labels", n_rows).class_labels()?;
        let label = |row: &usize| read.classes[read.labels[*row]].clone();
        labels = Some(rows.iter().map(label).collect());
    }
    let features = features.select(Axis(0), &rows);
    Ok(NewRows { features, labels })
}

/// Returns an array with one value for each row of features.
fn of_rows<'a>(path: &'a Path, name: &'a str, n_rows: usize) -> OneForEach<'a> {
    OneForEach::new(path, name, n_rows, "row of features")
}

/// Returns the path of the file that contains an array of a feature folder. If several files exist, the order is `.npy`, `.npz`, `.csv`, and the archive
/// `features.npz`.
fn array_file(folder: &Path, name: &str) -> PathBuf {
    let usual = folder.join(format!("{name}.npy"));
    let others = [
        format!("{name}.npz"),
        format!("{name}.csv"),
        "features.npz".to_owned(),
    ];
    let mut others = others.into_iter().map(|other| folder.join(other));
    match usual.exists() {
        true => usual,
        false => others.find(|other| other.exists()).unwrap_or(usual),
    }
}

impl FeatureSet {
    /// Reads the group of every row from a file: non-negative integers of any type, or texts.
    ///
    /// # Errors
    /// If the file is missing or has another type. If there is not one group per row, or a group has rows on both sides of the split.
    pub fn with_groups(self, path: &Path) -> Result<Self> {
        let n_rows = self.data.records.nrows();
        let groups = of_rows(path, "groups", n_rows).groups()?;
        let groups = Array1::from(group_keys(&groups));
        let Split { train, test } = &self.split;
        let trained: HashMap<usize, usize> = train.iter().map(|&row| (groups[row], row)).collect();
        let both = test
            .iter()
            .find_map(|&row| Some((row, trained.get(&groups[row])?)));
        if let Some((tested, learned)) = both {
            let group = groups[tested];
            let given =
                format!("group {group} of row {learned} in train.npy and row {tested} in test.npy");
            let allowed = "groups that train.npy and test.npy leave whole on one side (as GroupShuffleSplit and GroupKFold of scikit-learn do)";
            return Err(Error::input(path.display(), given, allowed));
        }
        Ok(Self {
            groups: Some(groups),
            ..self
        })
    }

    /// Returns the training rows as a data set; if `n` is given, only the first `n` rows.
    ///
    /// # Errors
    /// If `n` is zero or larger than the number of training rows.
    pub fn training(&self, n: Option<usize>) -> Result<Dataset> {
        let train = &self.split.train;
        let n = n.unwrap_or(train.len());
        if n == 0 || n > train.len() {
            let allowed = format!("1 to {}, the training rows of the split", train.len());
            return Err(Error::input("training rows", n, allowed));
        }
        Ok(rows(&self.data, &train[..n])?)
    }

    /// Returns the test rows as a data set.
    ///
    /// # Errors
    /// If there are no test rows.
    pub fn test(&self) -> Result<Dataset> {
        Ok(rows(&self.data, &self.split.test)?)
    }
}

/// Returns an error if a row number occurs twice among the training and test rows.
fn check_split(folder: &Path, split: &Split, n_rows: usize) -> Result<()> {
    let mut named_in = vec![None; n_rows];
    for (file, rows) in [("train.npy", &split.train), ("test.npy", &split.test)] {
        for &row in rows {
            if let Some(earlier) = named_in[row].replace(file) {
                let given = match earlier == file {
                    true => format!("row {row} twice"),
                    false => format!("row {row}, which {earlier} names too"),
                };
                let allowed = "every row at most once, to train on or to test";
                return Err(Error::input(folder.join(file).display(), given, allowed));
            }
        }
    }
    Ok(())
}

/// Returns the configuration with a given number, and the group of configurations that contains it.
pub(crate) fn find(sweep: &Sweep, number: usize) -> Result<(&MeasurementGroup, &Configuration)> {
    let groups = sweep.groups.iter();
    let mut configurations = groups.flat_map(|group| {
        group
            .configurations
            .iter()
            .map(move |configuration| (group, configuration))
    });
    let found = configurations.find(|(_, configuration)| configuration.configuration == number);
    found.ok_or_else(|| {
        let allowed = format!(
            "0 to {}, the configurations of the study",
            sweep.n_configurations() - 1
        );
        Error::input("configuration", number, allowed)
    })
}
