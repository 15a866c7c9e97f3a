//! `bubbletouch cache`: the touches that studies keep beside their results.

use super::memory_args::bytes;
use super::streams::say;
use bubbletouch::Result;
use bubbletouch::study::memory::Bytes;
use bubbletouch::study::{CachedTouches, FrameFacts, TouchCache};
use comfy_table::{Table, presets::NOTHING};
use std::path::PathBuf;
use std::time::SystemTime;

#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(clap::Subcommand)]
enum Action {
    /// What is kept, what was used last first
    List {
        #[command(flatten)]
        place: Place,
        /// Read every byte, and say which files are damaged
        #[arg(long)]
        check: bool,
    },
    /// Remove what was used longest ago; damaged files too
    Prune {
        #[command(flatten)]
        place: Place,
        /// Keep this much, in GiB; nothing when left out
        #[arg(long, value_name = "GIB")]
        keep_gib: Option<f64>,
    },
}

#[derive(clap::Args)]
struct Place {
    /// The folder beside whose results they are kept
    #[arg(default_value = "results")]
    results: PathBuf,
}

impl Place {
    fn cache(&self) -> TouchCache {
        TouchCache::new(self.results.join("touches"), u64::MAX)
    }
}

pub fn cache(args: &Args) -> Result<()> {
    match &args.action {
        Action::List { place, check } => list(place, reading(*check)),
        Action::Prune { place, keep_gib } => prune(place, *keep_gib),
    }
}

/// How it is found out what a file holds.
type Reading = fn(&CachedTouches) -> Result<FrameFacts>;

fn reading(is_checked: bool) -> Reading {
    match is_checked {
        true => CachedTouches::checked_facts,
        false => CachedTouches::facts,
    }
}

fn list(place: &Place, facts: Reading) -> Result<()> {
    let all = place.cache().list()?;
    if all.is_empty() {
        return say(format_args!(
            "{}: no touches are kept",
            place.results.display()
        ));
    }
    let mut table = Table::new();
    table.load_preset(NOTHING);
    table.set_header(["name", "what", "size", "took", "last used"]);
    for touches in &all {
        let (what, cost) = match facts(touches) {
            Ok(facts) => (facts.what, format!("{:.0} s", facts.cpu_s)),
            Err(_) => ("damaged".to_owned(), String::new()),
        };
        let name = touches.path.file_stem().unwrap_or_default();
        let name = name.to_string_lossy();
        table.add_row([
            name.chars().take(12).collect(),
            what,
            size([touches]),
            cost,
            ago(touches.used),
        ]);
    }
    say(table)?;
    say(format_args!(
        "{} in {}",
        size(&all),
        place.results.join("touches").display()
    ))
}

fn prune(place: &Place, keep_gib: Option<f64>) -> Result<()> {
    let keep = match keep_gib {
        None | Some(0.0) => 0,
        Some(gib) => bytes("--keep-gib", gib)?,
    };
    let gone = place.cache().prune(keep)?;
    say(format_args!(
        "removed {} files, {}",
        gone.len(),
        size(&gone)
    ))
}

/// The size of some of them in words.
fn size<'a>(touches: impl IntoIterator<Item = &'a CachedTouches>) -> String {
    let n_bytes: u64 = touches.into_iter().map(|touches| touches.n_bytes).sum();
    Bytes(n_bytes as f64).to_string()
}

/// How long ago, in words.
fn ago(time: SystemTime) -> String {
    let seconds = time.elapsed().unwrap_or_default().as_secs();
    match seconds {
        0..120 => "just now".to_owned(),
        120..7200 => format!("{} min ago", seconds / 60),
        7200..172_800 => format!("{} h ago", seconds / 3600),
        _ => format!("{} days ago", seconds / 86_400),
    }
}
