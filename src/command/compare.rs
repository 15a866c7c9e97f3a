//! `bubbletouch compare`: two folders of results side by side.

use super::output::{check_ending, terminal_width};
use super::streams::{say, write_out};
use bubbletouch::Result;
use bubbletouch::files::{CsvFile, write_bytes};
use bubbletouch::report::csv_tables::read_tables;
use bubbletouch::report::run_differences::{differences_page, differences_text};
use bubbletouch::study::compare_runs;
use bubbletouch::study::provenance::PROGRAM;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct Args {
    /// A folder that `bubbletouch run` wrote
    first: PathBuf,
    /// Another one
    second: PathBuf,
    /// Write every cell that both have to a CSV file
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    /// Write sentences, a chart and the cells to a page
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
}

pub fn compare(args: &Args) -> Result<()> {
    if let Some(out) = &args.out {
        check_ending(out, "csv")?;
    }
    if let Some(html) = &args.html {
        check_ending(html, "html")?;
    }
    let (first, second) = (read_tables(&args.first)?, read_tables(&args.second)?);
    let place = format!("{} and {}: ", args.first.display(), args.second.display());
    let comparison =
        compare_runs(&first.accuracy, &second.accuracy).map_err(|error| error.under(place))?;
    if let Some(out) = &args.out {
        let mut file = CsvFile::create(out)?;
        for row in &comparison.both {
            file.row(row)?;
        }
        file.commit()?;
    }
    if let Some(html) = &args.html {
        let [first, second] = [&args.first, &args.second].map(|path| path.display().to_string());
        let page = differences_page(&comparison, (&first, &second), PROGRAM)?;
        write_bytes(html, page.as_bytes())?;
    }
    say(format_args!(
        "First: {}; second: {}.",
        args.first.display(),
        args.second.display()
    ))?;
    write_out(differences_text(&comparison, terminal_width())?.as_bytes())
}
