//! Execution of studies as in `bubbletouch run`, with the tables in memory.

use crate::arrays::whole_number;
use crate::errors::{bad_input, exception, guarded};
use crate::foreign::{Given, Raised, provide};
use crate::threads::{Stop, aside};
use bubbletouch::Error;
use bubbletouch::Result;
use bubbletouch::kinds::{Source, about, check_folder, load, read_tables};
use bubbletouch::report::advice::{self, Candidates, Requirement, answers, answers_json};
use bubbletouch::report::study_folder::ChartFormat;
use bubbletouch::shell_line::shell_line;
use bubbletouch::study::Shard;
use bubbletouch::study::journal::{JOURNAL_FILE, Journal};
use bubbletouch::study::progress::Progress;
use bubbletouch::study::provenance::Manifest;
use bubbletouch::study::work_items::{Part, RunOptions};
use bubbletouch::table::{Data, Table};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPoolBuilder;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime};

/// Minimum time between two calls of a callback. If shorter, worker threads wait for the Python interpreter more often.
const BETWEEN_CALLS: Duration = Duration::from_millis(50);

/// Progress listener that calls a Python callback, and stops the study if the callback raises an exception.
struct CallbackProgress {
    stop: Stop,
    callback: Option<Py<PyAny>>,
    stage: Mutex<Stage>,
    /// Exception from the callback, if any.
    raised: Raised,
}

struct Stage {
    name: String,
    done: u64,
    total: u64,
    told: Instant,
}

impl Stage {
    fn new(name: &str, total: u64) -> Self {
        let (name, done, told) = (name.to_owned(), 0, Instant::now());
        Self {
            name,
            done,
            total,
            told,
        }
    }
}

impl CallbackProgress {
    fn tell(&self, (name, done, total): (String, u64, u64)) {
        let Some(callback) = &self.callback else {
            return;
        };
        let called = Python::attach(|py| callback.call1(py, (name, done, total)).map(drop));
        if let Err(error) = called {
            self.raised.keep(error);
            self.stop.tell();
        }
        self.stop.end_if_told();
    }
}

impl Progress for CallbackProgress {
    fn stage(&self, name: &str, total: u64) {
        self.stop.end_if_told();
        if let Ok(mut stage) = self.stage.lock() {
            *stage = Stage::new(name, total);
        }
        self.tell((name.to_owned(), 0, total));
    }

    fn advance(&self, n: u64) {
        self.stop.end_if_told();
        let Ok(mut stage) = self.stage.lock() else {
            return;
        };
        stage.done += n;
        let is_end = stage.done >= stage.total;
        if !is_end && stage.told.elapsed() < BETWEEN_CALLS {
            return;
        }
        stage.told = Instant::now();
        let said = (stage.name.clone(), stage.done, stage.total);
        drop(stage);
        self.tell(said);
    }

    fn finish(&self, _message: &str) {}
}

/// File name, title, note and columns of a table.
pub type ColumnsOfTable<'py> = (String, String, String, Bound<'py, PyDict>);

/// Study to run, by the keys of the dict that Python gives.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct StudyArguments {
    /// TOML text of the study.
    text: String,
    /// Name of the study in error messages.
    place: String,
    /// Name of the study in the manifest of its results.
    name: String,
    /// Folder to which paths in the study are relative.
    folder: PathBuf,
    /// Result folder.
    out: PathBuf,
    /// Seed in place of the seed of the study.
    seed: Option<i128>,
    classifiers: Vec<Given>,
    features: Vec<Given>,
    /// Shard to compute, such as `3/8`; its results are in its journal alone.
    shard: Option<String>,
    /// Whether the journals of shards in the result folder are merged first.
    merges: bool,
    /// Number of threads; 0 for the threads of the pool.
    threads: usize,
}

impl StudyArguments {
    /// Returns the source of the study, and the part of the study to run.
    fn source(&self) -> PyResult<(Source, Part<'static>)> {
        let seed = self.seed.map(|seed| whole_number("seed", seed));
        let shard: Option<Shard> = self
            .shard
            .as_deref()
            .map(str::parse)
            .transpose()
            .map_err(exception)?;
        let source = Source {
            folder: self.folder.clone(),
            seed: seed.transpose()?,
            packings: Some(self.out.parent().unwrap_or(Path::new("")).join("packings")),
            results: self.out.clone(),
            ..Source::of_text(&self.place, &self.text)
        };
        Ok((source, shard.map_or(Part::All, Part::Shard)))
    }
}

/// Runs a study or a shard of it. Returns no tables for a shard.
fn run(
    asked: StudyArguments,
    (source, part): (&Source, Part),
    told: &CallbackProgress,
    raised: &Raised,
) -> Result<Vec<Table>> {
    let started = SystemTime::now();
    let Source { results, place, .. } = source;
    let is_foreign = !(asked.classifiers.is_empty() && asked.features.is_empty());
    if is_foreign
        && let Some(about) = about(&asked.text)
        && about.table != "recognition"
    {
        let allowed = "classifiers and features of the program for a study that recognises objects";
        return Err(Error::input(place, about.words, allowed));
    }
    let _provided = provide([asked.classifiers, asked.features], raised)?;
    check_folder(&asked.text, results)?;
    let study = load(source)?;
    let path = results.join(match part {
        Part::Shard(shard) => shard.file_name(JOURNAL_FILE),
        _ => JOURNAL_FILE.to_owned(),
    });
    // The results of shards are known only after their journals are merged.
    if !asked.merges {
        study.check(part, &Journal::read_records(&path)?)?;
    }
    std::fs::create_dir_all(results).map_err(|e| Error::io(results, "create folder", e))?;
    let mut journal = Journal::open(&path, study.identity())?;
    if asked.merges {
        journal.take_from_shards(study.identity(), [results.as_path()])?;
    }
    let n_before = study.n_all() - study.n_pending(Part::All, &journal);
    let outcome = study.run(&RunOptions {
        journal: &journal,
        fail_fast: true,
        retries: true,
        part,
        progress: told,
    });
    journal.sync()?;
    let outcome = outcome.map_err(|error| match is_foreign {
        true => error.under(format!("{place}, ")),
        false => error,
    })?;
    if matches!(part, Part::Shard(_)) {
        return Ok(Vec::new());
    }
    let manifest = Manifest {
        study: asked.name,
        command: shell_line(&[
            "bubbletouch",
            "run",
            place,
            "--out",
            &results.display().to_string(),
        ]),
        paths_from: asked.folder,
        n_finished_before: n_before,
        ..Manifest::ended(study.identity(), started)
    };
    told.stage("report", 1);
    study.write(results, &outcome, manifest, ChartFormat::default())?;
    told.advance(1);
    Ok(outcome.tables)
}

/// Renames a result folder to FOLDER.1, FOLDER.2, …; does nothing if it does not exist.
#[pyfunction]
pub fn rename_old_results(folder: PathBuf) -> PyResult<()> {
    bubbletouch::study::journal::rename_old_results(&folder)
        .map(drop)
        .map_err(exception)
}

/// Runs a study and writes its results into a folder. Returns the file name, title, note and columns of each table. The study is a dict of text (TOML), place,
/// name, folder, out, seed, classifiers, features, shard, merges and threads. Classifiers and features are tuples of name, version and object. A shard, such as
/// `3/8`, writes its journal alone and returns no tables.
#[pyfunction]
#[pyo3(signature = (study, callback=None))]
pub fn run_study<'py>(
    py: Python<'py>,
    study: StudyArguments,
    callback: Option<Py<PyAny>>,
) -> PyResult<Vec<ColumnsOfTable<'py>>> {
    guarded(|| {
        let (source, part) = study.source()?;
        let foreign = Raised::default();
        let of_foreign = foreign.clone();
        let raised = Raised::default();
        let of_callback = raised.clone();
        let ran = aside(py, move |stop| {
            let told = CallbackProgress {
                stop: stop.clone(),
                callback,
                raised: of_callback,
                stage: Mutex::new(Stage::new("", 0)),
            };
            let threads = study.threads;
            let run = || run(study, (&source, part), &told, &of_foreign);
            if threads == 0 {
                return run();
            }
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.map_err(|error| Error::input("threads", threads, error))?;
            pool.install(run)
        });
        if let Some(error) = raised.take() {
            return Err(error);
        }
        let tables = ran?.map_err(|error| {
            let error = exception(error);
            error.set_cause(py, foreign.take());
            error
        })?;
        tables.iter().map(|table| columns(py, table)).collect()
    })
}

/// Converts a table to its file name, title, note and columns.
pub fn columns<'py>(py: Python<'py>, table: &Table) -> PyResult<ColumnsOfTable<'py>> {
    let values = PyDict::new(py);
    for (column, data) in table.columns.iter().zip(&table.data) {
        match data {
            Data::Numbers(numbers) => {
                values.set_item(&*column.name, numbers.clone().into_pyarray(py))?;
            }
            Data::Words { levels, codes } => {
                let words = codes.iter().map(|code| &levels[*code as usize]);
                values.set_item(&*column.name, words.collect::<Vec<_>>())?;
            }
        }
    }
    let (file, title) = (table.file.to_owned(), table.title.to_owned());
    Ok((file, title, table.note.clone(), values))
}

/// Converts a study from JSON to TOML.
#[pyfunction]
pub fn toml_of(json: &str) -> PyResult<String> {
    guarded(|| {
        let failed = |error: &dyn std::fmt::Display| {
            let allowed = "tables, lists, words, numbers and truth values, as TOML has them";
            bad_input("study", error, allowed)
        };
        let table: toml::Table = serde_json::from_str(json).map_err(|error| failed(&error))?;
        toml::to_string(&table).map_err(|error| failed(&error))
    })
}

/// Returns the TOML text of a study whose table `[recorded]` contains the keys of a JSON object. Keys of the study that the object lacks are kept. Raises
/// ValueError, which names `place`, if the text is no TOML.
#[pyfunction]
pub fn with_recorded(text: &str, place: &str, json: &str) -> PyResult<String> {
    guarded(|| {
        let allowed = "TOML as in experiments/";
        let failed = |error: &dyn std::fmt::Display| bad_input(place, error, allowed);
        let mut study: toml::Table = toml::from_str(text).map_err(|error| failed(&error))?;
        let keys: toml::Table = serde_json::from_str(json).map_err(|error| failed(&error))?;
        let recorded = study
            .entry("recorded")
            .or_insert_with(|| toml::Table::new().into());
        let Some(recorded) = recorded.as_table_mut() else {
            return Err(bad_input(place, "recorded is no table", allowed));
        };
        recorded.extend(keys);
        toml::to_string(&study).map_err(|error| failed(&error))
    })
}

/// Returns advice from the results in a folder, as JSON: the cheapest configuration with a minimum quality, or the best one within a cost. Raises
/// ValueError if there is no such configuration, or an argument is invalid.
#[pyfunction]
#[pyo3(signature = (results, reach, budget, value, cost, table, given, worst, limits))]
pub fn advise(
    results: PathBuf,
    reach: Option<f64>,
    budget: Option<f64>,
    value: Option<String>,
    cost: Option<String>,
    table: Option<String>,
    given: Vec<String>,
    worst: bool,
    limits: Vec<(String, f64)>,
) -> PyResult<String> {
    guarded(|| {
        let wish = match (reach, budget) {
            (Some(reach), None) => Requirement::Value(reach),
            (None, Some(most)) => Requirement::Budget(most),
            (None, None) if !limits.is_empty() => Requirement::Budget(f64::INFINITY),
            _ => {
                let given = "both or neither of what is needed and a budget";
                return Err(bad_input(
                    "advise",
                    given,
                    "one of accuracy, reach and budget",
                ));
            }
        };
        let (_, tables) = read_tables(&results).map_err(exception)?;
        let asked = advice::AdviceQuery {
            table,
            value,
            cost,
            given,
            limits,
        };
        let said = Candidates::new(&tables, &asked)
            .map_err(|error| error.under(format!("{}: ", results.display())))
            .and_then(|offers| Ok(answers_json(&offers, &answers(&offers, wish, worst)?)));
        said.map(|said| said.to_string()).map_err(exception)
    })
}
