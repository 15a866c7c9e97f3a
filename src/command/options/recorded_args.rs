//! Options for recorded frames, which `calibrate` and `audit` share.

use std::ops::Range;
use std::str::FromStr;

#[derive(clap::Args)]
#[command(next_help_heading = "Input")]
pub struct RecordedArgs {
    /// Name the axes of the frames [default: "n y x" or "n t y x"]
    ///
    /// One letter for each axis: n touches, t frames, y rows, x columns, c taxels.
    #[arg(long, value_name = "ORDER")]
    pub order: Option<String>,
    /// Take these columns of a table as readings, such as "taxel_*"
    ///
    /// Names or patterns, separated by commas: * stands for any text, # for a number.
    #[arg(long, value_name = "NAMES")]
    pub columns: Option<String>,
    /// Set rows and columns of frames that are flat lists
    #[arg(long, value_name = "ROWS,COLUMNS", value_parser = grid)]
    pub grid: Option<[usize; 2]>,
    /// Set the reading at full scale [default: estimated from the frames]
    #[arg(long, value_name = "READING", allow_negative_numbers = true)]
    pub full_scale: Option<f64>,
}

/// Parses `ROWS,COLUMNS`.
fn grid(text: &str) -> std::result::Result<[usize; 2], String> {
    let sides = text.split_once([',', 'x', '×']);
    let sides = sides.map(|(rows, columns)| (rows.trim().parse(), columns.trim().parse()));
    match sides {
        Some((Ok(rows), Ok(columns))) => Ok([rows, columns]),
        _ => Err("ROWS,COLUMNS in whole numbers".to_owned()),
    }
}

/// Parses `FROM..TO`.
pub fn range<T: FromStr>(text: &str) -> std::result::Result<Range<T>, String> {
    let ends = text
        .split_once("..")
        .map(|(from, to)| (from.trim().parse(), to.trim().parse()));
    match ends {
        Some((Ok(from), Ok(to))) => Ok(from..to),
        _ => Err("FROM..TO in numbers".to_owned()),
    }
}
