//! Start and end of a run of a study, which the commands `run` and `merge` share.

use crate::command::classify::word;
use crate::command::options::study_args::{MemoryLimit, StudyArgs};
use crate::command::terminal::{say, terminal_width, write_out};
use bubbletouch::kinds::{self, AnyStudy, Outcome, Source};
use bubbletouch::report::csv_tables::FAILURES_FILE;
use bubbletouch::report::progress::{json_lines, to_stderr};
use bubbletouch::report::study_folder::ChartFormat;
use bubbletouch::study::journal::check_set_aside;
use bubbletouch::study::progress::{Progress, Silent};
use bubbletouch::study::provenance::Manifest;
use bubbletouch::table::Table;
use bubbletouch::{Error, Result};
use std::io::stdout;
use std::path::PathBuf;
use std::time::SystemTime;

/// Arguments that `run`, `merge` and `slurm` share: the study and the folder of its results.
#[derive(clap::Args)]
pub struct ResultsArgs {
    #[command(flatten)]
    pub study: StudyArgs,
    /// Write results to this folder [default: results/ and the study's name]
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    pub out: Option<PathBuf>,
}

impl ResultsArgs {
    /// Where results go.
    pub fn folder(&self) -> Result<PathBuf> {
        let given = self.out.clone();
        given.map_or_else(|| self.study.default_results(), Ok)
    }
}

#[derive(clap::Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub results: ResultsArgs,
    #[command(flatten)]
    memory: MemoryLimit,
    /// Print errors only
    #[arg(long, conflicts_with = "json", help_heading = "Output")]
    quiet: bool,
    /// Write progress as JSON lines to standard output
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Write charts as svg, png or both
    #[arg(long, value_name = "FORMAT", default_value = "svg", value_parser = word::<ChartFormat>, help_heading = "Output")]
    chart_format: ChartFormat,
}

impl RunArgs {
    /// Returns the progress listener: bars on a terminal, JSON events for a program, or none.
    fn progress(&self) -> Box<dyn Progress> {
        match (self.quiet, self.json) {
            (true, _) => Box::new(Silent),
            (_, true) => json_lines(stdout()),
            _ => to_stderr(),
        }
    }
}

/// Study that is loaded, with the folder of its results.
pub struct StudyRun<'a> {
    pub study: Box<dyn AnyStudy>,
    pub folder: PathBuf,
    /// Receiver of progress reports; a message that does not end a stage is a remark.
    pub progress: Box<dyn Progress>,
    args: &'a RunArgs,
    started: SystemTime,
}

impl<'a> StudyRun<'a> {
    /// Reads and checks the study and loads its objects; does not write any files. A `fresh` run sets the old folder aside.
    pub fn begin(args: &'a RunArgs, fresh: bool) -> Result<Self> {
        let started = SystemTime::now();
        let folder = args.results.folder()?;
        let source = Source {
            memory: args.memory.bytes()?,
            ..args.results.study.source(&folder)?
        };
        match fresh {
            true => check_set_aside(&folder)?,
            false => kinds::check_folder(&source.text, &folder)?,
        }
        let study = kinds::load(&source)?;
        Ok(Self {
            study,
            folder,
            progress: args.progress(),
            args,
            started,
        })
    }

    /// Returns the time since the start of the run, seconds.
    pub fn elapsed_s(&self) -> f64 {
        self.started.elapsed().unwrap_or_default().as_secs_f64()
    }

    /// Writes the result folder and prints the findings; returns an error if some work items failed.
    pub fn end(&self, outcome: &Outcome, n_before: usize, what: &str) -> Result<()> {
        let (study, folder) = (self.study.as_ref(), &self.folder);
        let of_study = &self.args.results.study;
        self.progress.stage("report", 1);
        let manifest = Manifest {
            study: of_study.name()?,
            command: of_study.command("run", Some(folder)),
            paths_from: of_study.folder(),
            n_finished_before: n_before,
            ..Manifest::ended(study.identity(), self.started)
        };
        study.write(folder, outcome, manifest, self.args.chart_format)?;
        self.progress.advance(1);
        let elapsed_s = self.elapsed_s();
        self.progress.finish(&format!("{what}{elapsed_s:.1} s"));
        if self.args.json {
            say(serde_json::json!({
                "event": "finished",
                "folder": folder,
                "work_items": study.n_all(),
                "finished_before": n_before,
                "failed": outcome.n_failed,
                "elapsed_s": elapsed_s,
            }))?;
        } else if !self.args.quiet {
            write_out(study.words(outcome, terminal_width()).as_bytes())?;
            let page = folder.join("report.html");
            let (folder, page) = (folder.display(), page.display());
            say(format_args!("Results in {folder}; open {page}"))?;
        }
        self.failures(outcome)
    }

    /// Returns an error if some work items failed.
    pub fn failures(&self, outcome: &Outcome) -> Result<()> {
        match outcome.n_failed {
            0 => Ok(()),
            n_failed => Err(Error::WorkItems {
                path: self.folder.join(FAILURES_FILE),
                n_failed,
                n_all: self.study.n_all(),
                first: first_reason(&outcome.tables),
            }),
        }
    }
}

/// Returns the cause of the first failed work item; empty if the tables contain none.
fn first_reason(tables: &[Table]) -> String {
    let failures = tables.iter().find(|table| table.file == FAILURES_FILE);
    let first = failures.filter(|table| table.n_rows > 0);
    first.map_or_else(String::new, |table| table.word("error", 0).to_owned())
}
