//! Classifier that is a command: the program reads rows from files, trains, and writes the labels of test rows.
//!
//! | argument | file | content |
//! |---|---|---|
//! | 1 | `train.npz` | `features` (n × m, float64), `labels` (n, int64), `seed` (1, int64); `groups` (n, int64) if the split keeps groups |
//! | 2 | `test.npz` | `features` (n × m, float64) |
//! | 3 | `labels.npy` | written by the program: one label for each test row |

use crate::inputs::arrays::FileArray;
use crate::learning::classifiers::foreign::{ForeignClassifier, ForeignModel, ForeignParameters};
use bubbletouch_svm::dataset::Dataset;
use bubbletouch_svm::{Error, Result};
use ndarray::{Array1, Array2, ArrayView2};
use ndarray_npy::NpzWriter;
use std::env::consts::EXE_SUFFIX;
use std::fs::File;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Time between two checks whether the program has ended. With a longer time, short programs take longer; with a shorter time, the checks take processor time.
const BETWEEN_CHECKS: Duration = Duration::from_millis(2);

/// Maximum number of letters of the program's message in an error. Longer messages hide the rest of the error.
const MAX_LETTERS: usize = 300;

/// Classifier that is a command.
#[derive(Clone, Debug)]
pub struct CommandClassifier {
    /// Name of the classifier in errors.
    pub name: &'static str,
    /// Program and its first arguments, at least one word.
    pub command: Vec<String>,
    /// Maximum time of one call; `None` for no limit.
    pub time_limit: Option<Duration>,
}

/// Training rows, stored until the test rows are given, because one call of the program trains and predicts.
struct CommandModel {
    classifier: CommandClassifier,
    features: Array2<f64>,
    labels: Array1<usize>,
    groups: Option<Array1<usize>>,
    seed: u32,
}

impl ForeignClassifier for CommandClassifier {
    /// Puts each value in the place of `{name}` in the words of the command.
    fn with(&self, parameters: &ForeignParameters) -> Result<Arc<dyn ForeignClassifier>> {
        let mut changed = self.clone();
        for (name, value) in parameters {
            let place = format!("{{{name}}}");
            if !self.command.iter().any(|word| word.contains(&place)) {
                let allowed = format!("{place} in a word of its command, which the value replaces");
                return Err(Error::input(
                    self.place(),
                    format!("parameter {name}"),
                    allowed,
                ));
            }
            let text = value
                .as_str()
                .map_or_else(|| value.to_string(), str::to_owned);
            for word in &mut changed.command {
                *word = word.replace(&place, &text);
            }
        }
        Ok(Arc::new(changed))
    }

    fn check(&self) -> Result<()> {
        if let Some(name) = self.command.iter().find_map(|word| unset_parameter(word)) {
            let allowed = format!("a value of recognition.parameters.{}.{name}", self.name);
            return Err(Error::input(
                self.place(),
                format!("{{{name}}} without a value"),
                allowed,
            ));
        }
        let program = &self.command[0];
        if is_program(program) {
            return Ok(());
        }
        Err(Error::input(
            self.place(),
            format!("{program} cannot be run: no such program"),
            "a program in one of the folders of PATH, or the path of a program",
        ))
    }

    /// A program that is found by PATH may be installed elsewhere. The content of a program at a path is part of the version of the classifier.
    fn may_be_elsewhere(&self) -> bool {
        !has_path(&self.command[0])
    }

    fn fit(&self, rows: &Dataset, seed: u32) -> Result<Box<dyn ForeignModel>> {
        Ok(Box::new(self.model(rows, None, seed)))
    }

    fn fit_groups(
        &self,
        rows: &Dataset,
        groups: &[usize],
        seed: u32,
    ) -> Result<Box<dyn ForeignModel>> {
        let groups = Some(Array1::from(groups.to_vec()));
        Ok(Box::new(self.model(rows, groups, seed)))
    }
}

impl CommandClassifier {
    fn model(&self, rows: &Dataset, groups: Option<Array1<usize>>, seed: u32) -> CommandModel {
        CommandModel {
            classifier: self.clone(),
            features: rows.records.clone(),
            labels: rows.targets.clone(),
            groups,
            seed,
        }
    }

    fn error(&self, given: impl ToString) -> Error {
        let allowed = "exit code 0 and a file of one known label for each test row";
        Error::input(self.place(), given.to_string(), allowed)
    }

    fn place(&self) -> String {
        format!("classifier {}", self.name)
    }

    /// Runs the program with three files as its last arguments.
    fn run(&self, files: [&Path; 3], said: &Path) -> Result<()> {
        let program = &self.command[0];
        let failed =
            |error: std::io::Error| self.error(format!("{program} cannot be run: {error}"));
        let mut command = Command::new(program);
        command.args(&self.command[1..]).args(files);
        command.stdin(Stdio::null()).stdout(Stdio::null());
        command.stderr(File::create(said).map_err(failed)?);
        let mut child = command.spawn().map_err(failed)?;
        let start = Instant::now();
        let status: ExitStatus = loop {
            if let Some(status) = child.try_wait().map_err(failed)? {
                break status;
            }
            if let Some(limit) = self.time_limit.filter(|limit| start.elapsed() > *limit) {
                child.kill().and_then(|()| child.wait()).map_err(failed)?;
                let limit = limit.as_secs_f64();
                return Err(self.error(format!(
                    "{program} ran longer than its time limit, {limit} s"
                )));
            }
            sleep(BETWEEN_CHECKS);
        };
        if status.success() {
            return Ok(());
        }
        // The last line of an exception or a message contains the cause.
        let text = std::fs::read(said).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        let mut lines = text.lines().rev().map(str::trim);
        let last = lines.find(|line| !line.is_empty()).unwrap_or("no message");
        let last: String = last.chars().take(MAX_LETTERS).collect();
        Err(self.error(format!("{program} ended with {status}: {last}")))
    }
}

/// Returns the name of a parameter if a word of a command is `{name}` or ends with `={name}`.
fn unset_parameter(word: &str) -> Option<&str> {
    let last = word.rsplit('=').next()?;
    let name = last.strip_prefix('{')?.strip_suffix('}')?;
    let is_letter = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    (!name.is_empty() && name.chars().all(is_letter)).then_some(name)
}

/// Returns whether the name of a program contains a folder, so that it is not searched in the folders of PATH.
fn has_path(program: &str) -> bool {
    Path::new(program).components().count() != 1 || program.starts_with('.')
}

/// Returns whether a program exists: at its path, or in a folder of PATH if its name contains no folder.
fn is_program(program: &str) -> bool {
    if has_path(program) {
        return Path::new(program).is_file();
    }
    let names = [program.to_owned(), format!("{program}{EXE_SUFFIX}")];
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| names.iter().any(|name| folder.join(name).is_file()))
}

impl ForeignModel for CommandModel {
    /// Returns true: the program trains and predicts in one call.
    fn trains_in_predictions(&self) -> bool {
        true
    }

    fn predict(&self, rows: ArrayView2<f64>) -> Result<Vec<usize>> {
        let of = &self.classifier;
        let unwritten = |error: &dyn std::fmt::Display| {
            of.error(format!("its files cannot be written: {error}"))
        };
        let folder = tempfile::tempdir().map_err(|error| unwritten(&error))?;
        let path = |name: &str| folder.path().join(name);
        let (train, test, labels) = (path("train.npz"), path("test.npz"), path("labels.npy"));
        let write = || -> std::result::Result<(), Box<dyn std::error::Error>> {
            let mut file = NpzWriter::new(File::create(&train)?);
            file.add_array("features", &self.features)?;
            file.add_array("labels", &self.labels.mapv(|label| label as i64))?;
            if let Some(groups) = &self.groups {
                file.add_array("groups", &groups.mapv(|group| group as i64))?;
            }
            file.add_array("seed", &Array1::from_elem(1, i64::from(self.seed)))?;
            file.finish()?;
            let mut file = NpzWriter::new(File::create(&test)?);
            file.add_array("features", &rows)?;
            file.finish()?;
            Ok(())
        };
        write().map_err(|error| unwritten(&error))?;
        of.run([&train, &test, &labels], &path("stderr.txt"))?;
        let read = FileArray::read(&labels, "labels").and_then(FileArray::into_numbers);
        let read = read.map_err(|error| of.error(error))?;
        let label = |number: &f64| match number.fract() == 0.0 && (0.0..1e15).contains(number) {
            true => Ok(*number as usize),
            false => Err(of.error(format!("the label {number}"))),
        };
        read.iter().map(label).collect()
    }
}
