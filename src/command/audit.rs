//! `bubbletouch audit`: checks whether recorded frames with labels can carry a claim about recognition.

use crate::command::options::recorded_args::{RecordedArgs, range};
use crate::command::options::study_args::set_threads;
use crate::command::program;
use crate::command::terminal::{say, terminal_width, write_out};
use bubbletouch::audit::{
    AUDIT_FILES, AuditFiles, AuditOptions, audit as audited, audit_files, audit_text, has_fault,
};
use bubbletouch::files::{DataFolder, check_output};
use bubbletouch::report::folder::write_files;
use bubbletouch::shell_line::shell_line;
use bubbletouch::study::RecordedSpec;
use bubbletouch::{Error, Result};
use std::borrow::Cow;
use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Check whether recorded data can carry a claim about recognition
///
/// The page answers three questions: what does the split of the claim measure, can the class be read from what should not name it, and are the readings
/// sound? Each finding has a number, a sentence and advice.
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
    #[command(flatten)]
    recorded: RecordedArgs,
    /// Take these frames of each touch as before contact
    ///
    /// Frames are counted from 0. The range excludes its end. If the class can be read from them, this is a fault.
    #[arg(long, value_name = "FROM..TO", value_parser = range::<usize>, help_heading = "Claim")]
    before_contact: Option<Range<usize>>,
    /// Name the taxels that nothing touches, such as 0,5,10..14
    ///
    /// Taxels are counted from 0, row by row. If the class can be read from them, this is a fault.
    #[arg(long, value_name = "TAXELS", value_delimiter = ',', value_parser = taxels, help_heading = "Claim")]
    untouched: Vec<Range<usize>>,
    /// Name the split of the claim [default: all that the data allow]
    #[arg(long, value_name = "SPLIT", value_parser = ["group", "session", "time", "given"], help_heading = "Claim")]
    split: Option<String>,
    /// List the sources that should not name the class [default: order,session,padding,before_contact,untouched]
    ///
    /// Further sources: mean, noise, place, single_taxel. If the class can be read from a listed source, this is a fault; otherwise it is a note.
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        help_heading = "Claim"
    )]
    not_claimed: Option<Vec<String>>,
    /// End with exit code 1 if there is a fault
    #[arg(long, value_name = "VERDICT", value_parser = ["fault"], help_heading = "Run")]
    fail_on: Option<String>,
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

/// Runs the audit; `words` is the command line without the program, for the page. Returns the exit code: 1 if `--fail-on` asks for it, otherwise 0.
pub fn audit(args: &Args, words: &[OsString]) -> Result<u8> {
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
        given: RecordedSpec {
            labels: args.labels.clone().unwrap_or_default(),
            groups: args.groups.clone(),
            order: args.recorded.order.clone(),
            columns: args.recorded.columns.clone(),
            grid: args.recorded.grid,
            full_scale: args.recorded.full_scale,
            ..RecordedSpec::default()
        },
        sessions: args.sessions.clone(),
        times: args.times.clone(),
    };
    let data = files.read()?;
    let options = AuditOptions {
        seed: args.seed,
        n_permutations: args.permutations,
        before_contact: args.before_contact.clone(),
        untouched: args.untouched.iter().cloned().flatten().collect(),
        not_claimed: args.not_claimed.clone(),
        split: args.split.clone(),
    };
    options.check(&data, |name| format!("--{}", name.replace('_', "-")))?;
    // Known only now: the files that the audit reads.
    let claimed = DataFolder::claim(&out, "audit", AUDIT_FILES.iter().copied())?;
    for file in AUDIT_FILES {
        check_output(&out.join(file))?;
    }
    let found = audited(data, options)?;
    let text = audit_text(&found, terminal_width());
    let is_failure = args.fail_on.is_some() && has_fault(&found.findings);
    let words = words.iter().map(|word| word.to_string_lossy());
    let words: Vec<_> = [Cow::from(program())].into_iter().chain(words).collect();
    let command = shell_line(&words);
    let files = audit_files(found, &name, &command)?;
    std::fs::create_dir_all(&out).map_err(|error| Error::io(&out, "create folder", error))?;
    claimed.write_manifest()?;
    write_files(&out, files)?;
    write_out(text.as_bytes())?;
    say(format_args!("Page: {}", out.join("report.html").display()))?;
    Ok(u8::from(is_failure))
}

/// A taxel, or a range of taxels FROM..TO without its end.
fn taxels(text: &str) -> std::result::Result<Range<usize>, String> {
    match text.trim().parse() {
        Ok(taxel) => Ok(taxel..taxel + 1),
        Err(_) => range(text).map_err(|_| "numbers of taxels, or FROM..TO".to_owned()),
    }
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
