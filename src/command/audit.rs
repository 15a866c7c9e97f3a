//! `bubbletouch audit`: checks whether recorded frames with labels can carry a claim about recognition.

use crate::command::options::study_args::set_threads;
use crate::command::terminal::output::terminal_width;
use crate::command::terminal::streams::{say, write_out};
use bubbletouch::audit::{
    AUDIT_FILES, AuditFiles, AuditOptions, audit as audited, audit_files, audit_text,
};
use bubbletouch::files::{DataFolder, check_output};
use bubbletouch::report::folder::write_files;
use bubbletouch::shell_line::shell_line;
use bubbletouch::{Error, Result};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Check whether recorded data can carry a claim about recognition
///
/// The page lists each finding with a number, a chart and advice: near-duplicates, accuracy by split, confounds, faulty taxels, drift, saturation,
/// class balance, wrong labels, effective sample size.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch audit recording.npz --groups grasps.npy --out results/recording_audit"
)]
pub struct Args {
    /// File of frames, or a folder of a recording
    ///
    /// A file is .npy, .npz or .csv. A folder contains recorded.toml, a file named frames, or one .npz archive for each session. Arrays or files named
    /// labels, groups, sessions and times beside the frames are read too.
    data: PathBuf,
    /// Read the class of each touch from this file
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    labels: Option<PathBuf>,
    /// Read the group of each touch (grasp, pose, subject, …)
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    groups: Option<PathBuf>,
    /// Read the session of each touch (file, day, mounting, …)
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    sessions: Option<PathBuf>,
    /// Read the time of each touch, a number
    ///
    /// Without times, the order in the file is taken as the order in time.
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    times: Option<PathBuf>,
    /// Name the axes of the frames [default: "n y x" or "n t y x"]
    ///
    /// One letter for each axis: n touches, t frames, y rows, x columns, c taxels.
    #[arg(long, value_name = "ORDER", help_heading = "Input")]
    order: Option<String>,
    /// Take these columns of a table as readings, such as "taxel_*"
    ///
    /// Names or patterns, separated by commas: * stands for any text, # for a number.
    #[arg(long, value_name = "NAMES", help_heading = "Input")]
    columns: Option<String>,
    /// Set rows and columns of frames that are flat lists
    #[arg(long, value_name = "ROWS,COLUMNS", value_parser = super::calibrate::grid, help_heading = "Input")]
    grid: Option<[usize; 2]>,
    /// Set the reading at full scale [default: find a plateau]
    #[arg(
        long,
        value_name = "READING",
        allow_negative_numbers = true,
        help_heading = "Input"
    )]
    full_scale: Option<f64>,
    /// Take these frames of each touch as before contact
    ///
    /// Frames are counted from 0. The range excludes its end. By default, frames without contact are found.
    #[arg(long, value_name = "FROM..TO", value_parser = super::calibrate::range::<usize>, help_heading = "Input")]
    before_contact: Option<Range<usize>>,
    /// Write page, tables and charts here [default: results/NAME_audit]
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Set the seed of splits and permutations
    #[arg(long, value_name = "N", default_value_t = 2018, help_heading = "Run")]
    seed: u64,
    /// Permute labels N times for each test
    #[arg(long, value_name = "N", default_value_t = 999, help_heading = "Run")]
    permutations: usize,
    /// Use N threads; results do not depend on N [default: all cores]
    #[arg(long, value_name = "N", help_heading = "Run")]
    threads: Option<usize>,
}

pub fn audit(args: &Args) -> Result<()> {
    set_threads(args.threads)?;
    if !(399..=100_000).contains(&args.permutations) {
        return Err(Error::input(
            "--permutations",
            args.permutations,
            "399 to 100000",
        ));
    }
    let name = name_of(&args.data);
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("results").join(format!("{name}_audit")));
    if out.exists() && !out.is_dir() {
        let allowed = "a folder, or a name that is free";
        return Err(Error::input(out.display(), "is not a folder", allowed));
    }
    DataFolder::claim(&out, "audit", AUDIT_FILES.iter().copied())?;
    let files = AuditFiles {
        data: args.data.clone(),
        labels: args.labels.clone(),
        groups: args.groups.clone(),
        sessions: args.sessions.clone(),
        times: args.times.clone(),
        order: args.order.clone(),
        columns: args.columns.clone(),
        grid: args.grid,
        full_scale: args.full_scale,
        ..AuditFiles::default()
    };
    let data = files.read()?;
    if let Some(range) = &args.before_contact
        && (range.is_empty() || range.end > data.n_frames)
    {
        let given = format!("{}..{}", range.start, range.end);
        let allowed = format!("FROM..TO with FROM below TO, at most {}", data.n_frames);
        return Err(Error::input("--before-contact", given, allowed));
    }
    // Known only now: the files that the audit reads.
    let claimed = DataFolder::claim(&out, "audit", AUDIT_FILES.iter().copied())?;
    for file in AUDIT_FILES {
        check_output(&out.join(file))?;
    }
    let found = audited(
        data,
        AuditOptions {
            seed: args.seed,
            n_permutations: args.permutations,
            before_contact: args.before_contact.clone(),
        },
    )?;
    let text = audit_text(&found.findings, terminal_width());
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let command = shell_line(&[&["bubbletouch"][..], &words].concat());
    let files = audit_files(found, &name, &command)?;
    std::fs::create_dir_all(&out).map_err(|error| Error::io(&out, "create folder", error))?;
    claimed.write_manifest()?;
    write_files(&out, files)?;
    write_out(text.as_bytes())?;
    say(format_args!("Page: {}", out.join("report.html").display()))
}

/// Returns the name of the data: the file name without ending, or the name of the folder.
fn name_of(path: &Path) -> String {
    let whole = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let name = match whole.is_dir() {
        true => whole.file_name(),
        false => whole.file_stem(),
    };
    name.map_or_else(
        || "data".to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}
