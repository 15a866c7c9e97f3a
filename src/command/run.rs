//! `bubbletouch run`: a study from its file to its folder of results.

use super::output::{output_folder, packings_beside, terminal_width};
use super::run_object_detail::run_object_detail;
use super::run_reconstruction::run_reconstruction;
use super::run_stability::run_stability;
use super::study_args::{LoadedStudy, StudyArgs};
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::report::html::{Limit, ReportPage, Snapshots};
use bubbletouch::report::{headlines, progress, results, terminal};
use bubbletouch::study::{Outcome, StudyKind, run as run_study};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Where to write tables, charts and report.html [default: results/ and the study's name]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

impl Args {
    /// What a bare `bubbletouch` runs.
    pub fn quickstart() -> Self {
        Self {
            study: StudyArgs::quickstart(),
            out: None,
        }
    }
}

pub fn run(args: &Args) -> Result<()> {
    let start = Instant::now();
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("results").join(args.study.name()?),
    };
    match args.study.kind()? {
        StudyKind::Recognition => run_recognition(args, &folder, start),
        StudyKind::Reconstruction => run_reconstruction(&args.study, &folder),
        StudyKind::ObjectDetail => run_object_detail(&args.study, &folder),
        StudyKind::Stability => run_stability(&args.study, &folder),
    }
}

fn run_recognition(args: &Args, folder: &Path, start: Instant) -> Result<()> {
    let loaded = args.study.load(Some(&packings_beside(folder)))?;
    output_folder(folder)?;
    let progress = progress::to_stderr();
    let outcome = run_study(
        &loaded.plan,
        &loaded.sweep,
        loaded.touched.as_ref(),
        progress.as_ref(),
    )?;
    progress.stage("report", 1);
    let page = report_page(&loaded, &outcome, args, start.elapsed().as_secs_f64())?;
    results::write_all(folder, &outcome.tables, &page)?;
    write_bytes(
        &folder.join("study.toml"),
        loaded.plan.spec.to_toml().as_bytes(),
    )?;
    progress.advance(1);
    progress.finish(&format!("{:.1} s", start.elapsed().as_secs_f64()));
    let table = folder.join("summary.csv").display().to_string();
    println!(
        "{}",
        terminal::summary_table(&outcome.tables, terminal_width(), &table)
    );
    print!("{}", headlines::text(&outcome.tables, terminal_width()));
    println!(
        "Results in {}; open {}",
        folder.display(),
        folder.join("report.html").display()
    );
    Ok(())
}

fn report_page(
    loaded: &LoadedStudy,
    outcome: &Outcome,
    args: &Args,
    wall_s: f64,
) -> Result<ReportPage> {
    let spec = &loaded.plan.spec;
    let sample = loaded.touched.samples(&loaded.plan, &loaded.sweep)?;
    Ok(ReportPage {
        name: loaded.name.clone(),
        question: spec.question.clone(),
        expected: spec.expected.clone(),
        settings: settings(loaded),
        limits: limits(loaded, outcome),
        snapshots: Some(Snapshots {
            frames: sample.frames,
            pitch_mm: sample.pitch_mm,
            quantity: sample.quantity,
            caption: sample.caption,
        }),
        pareto: spec.report.pareto,
        wall_s: Some(wall_s),
        command: command_line(args),
        program: concat!("bubbletouch ", env!("CARGO_PKG_VERSION")).to_owned(),
    })
}

fn settings(loaded: &LoadedStudy) -> Vec<(String, String)> {
    let spec = &loaded.plan.spec;
    let row = |name: &str, value: String| (name.to_owned(), value);
    let mut rows = loaded.touched.settings();
    rows.extend([
        row("Touches", loaded.sweep.labels.len().to_string()),
        row("Stroke", format!("{} mm", spec.skin.stroke_mm)),
        row("Trials", spec.trials.to_string()),
        row("Seed", spec.seed.to_string()),
    ]);
    rows
}

fn limits(loaded: &LoadedStudy, outcome: &Outcome) -> Vec<Limit> {
    let sum = |count: fn(&bubbletouch::study::ArrayOutcome) -> usize| -> u64 {
        outcome.arrays.iter().map(|array| count(array) as u64).sum()
    };
    let n_touches = sum(|a| a.n_touches);
    let n_capped = outcome
        .tables
        .accuracy
        .iter()
        .filter(|(_, score)| score.n_capped > 0)
        .count();
    let limit = |what: &str, count, of, meaning: &str| Limit {
        what: what.to_owned(),
        count,
        of,
        meaning: meaning.to_owned(),
    };
    vec![
        limit(
            "touches that met nothing",
            sum(|a| a.n_missed),
            n_touches,
            match loaded.plan.human_touch {
                Some(_) => {
                    "the hand was beyond the array or between its taxels; their frames hold no contact"
                }
                None => "no part of the object was over the array; their frames hold no contact",
            },
        ),
        limit(
            "touches with a saturated taxel",
            sum(|a| a.n_saturated),
            n_touches,
            "a taxel was at its stroke, where it cannot tell how much further the object pushes",
        ),
        limit(
            "fits stopped at the solver's iteration cap",
            n_capped as u64,
            outcome.tables.accuracy.len() as u64,
            "at least one of their SVMs is short of its tolerance",
        ),
    ]
}

fn command_line(args: &Args) -> String {
    let mut command = format!("bubbletouch run {}", args.study.study.display());
    if let Some(objects) = &args.study.objects {
        command += &format!(" --objects {}", objects.display());
    }
    if let Some(seed) = args.study.seed {
        command += &format!(" --seed {seed}");
    }
    command
}
