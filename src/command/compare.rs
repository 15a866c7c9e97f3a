//! `bubbletouch compare`: compares two result folders.

use crate::command::terminal::{check_ending, say, terminal_width, write_out};
use bubbletouch::files::{CsvFile, check_output, write_bytes};
use bubbletouch::report::comparison::compared::Comparison;
use bubbletouch::report::comparison::differences::differences;
use bubbletouch::report::comparison::rank_agreement::rank_agreement;
use bubbletouch::{Error, Result, kinds};
use std::path::PathBuf;

/// Compare two results folders: differences, significance, rank correlation
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch compare results/first results/second --html differences.html"
)]
pub struct Args {
    /// First results folder
    first: PathBuf,
    /// Second results folder, of a study of the same kind
    second: PathBuf,
    /// Write all values and costs that both contain to a CSV file
    ///
    /// The text lists all other entries that differ.
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Write sentences, charts and tables to an HTML page
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    html: Option<PathBuf>,
}

pub fn compare(args: &Args) -> Result<()> {
    check_ending(args.out.as_deref(), "csv")?;
    check_ending(args.html.as_deref(), "html")?;
    let (kind, mut first) = kinds::read_tables(&args.first)?;
    let (other, mut second) = kinds::read_tables(&args.second)?;
    first.extend(kinds::read_failures(&args.first)?);
    second.extend(kinds::read_failures(&args.second)?);
    let [first_name, second_name] =
        [&args.first, &args.second].map(|path| path.display().to_string());
    if kind.table != other.table {
        let allowed = format!("a folder of {}, as {first_name} is", kind.words);
        return Err(Error::input(second_name, other.words, allowed));
    }
    let place = format!("{first_name} and {second_name}: ");
    let ranks = rank_agreement(&first, &second);
    let found = match differences(&first, &second) {
        // A simulated and a recorded study have no common setting, but their rankings of designs can be compared.
        Err(_) if ranks.is_some() && args.out.is_none() => Vec::new(),
        found => found.map_err(|error| error.under(place))?,
    };
    let names = [&first_name[..], &second_name];
    let comparison = Comparison::new([&first, &second], (found, ranks))?;
    let mut outputs = args.out.iter().chain(&args.html);
    outputs.try_for_each(|path| check_output(path))?;
    if let Some(out) = &args.out {
        let mut file = CsvFile::create(out)?;
        for row in &comparison.differences {
            file.row(row)?;
        }
        file.commit()?;
    }
    if let Some(html) = &args.html {
        write_bytes(html, &comparison.page(names)?)?;
    }
    say(format_args!("First: {first_name}; second: {second_name}."))?;
    write_out(comparison.text(terminal_width()).as_bytes())
}
