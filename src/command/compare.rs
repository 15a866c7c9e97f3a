//! `bubbletouch compare`: two folders of results side by side.

use super::output::{check_ending, terminal_width};
use bubbletouch::Result;
use bubbletouch::files::CsvFile;
use bubbletouch::report::csv_tables::read_tables;
use bubbletouch::report::run_differences::differences_text;
use bubbletouch::study::compare_runs;
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
}

pub fn compare(args: &Args) -> Result<()> {
    if let Some(out) = &args.out {
        check_ending(out, "csv")?;
    }
    let (first, second) = (read_tables(&args.first)?, read_tables(&args.second)?);
    let place = format!("{} and {}: ", args.first.display(), args.second.display());
    let comparison =
        compare_runs(&first.accuracy, &second.accuracy).map_err(|error| error.under(place))?;
    println!(
        "First: {}; second: {}.",
        args.first.display(),
        args.second.display()
    );
    print!("{}", differences_text(&comparison, terminal_width()));
    if let Some(out) = &args.out {
        let mut file = CsvFile::create(out)?;
        for row in &comparison.both {
            file.row(row)?;
        }
        file.commit()?;
    }
    Ok(())
}
