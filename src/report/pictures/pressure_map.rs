//! Pressure map of one frame as text for the terminal.

use crate::error::Result;
use crate::report::pictures::{ColourScale, check_frame, grid_sentence, heat, largest_of_blocks};
use crate::report::terminal::Ink;
use crate::signal::Quantity;
use crate::table::short_number;
use ndarray::Array2;

/// Characters of a pressure map without colours, in order from zero to the largest value.
const RAMP: &[u8] = b" .:-=+*#%@";

/// Draws a frame as text with at most `width` columns; the top line has the highest y.
///
/// With colours, half-block characters show two rows of taxels in each line. Without colours, ten ASCII characters from blank to `@` show the values. If the
/// array is too wide, each character shows the largest value of a block of taxels, and the text states the block size.
///
/// # Errors
/// If the frame has no taxels, or a value that is not finite.
pub fn pressure_text(
    frame: &Array2<f64>,
    pitch_mm: f64,
    quantity: Quantity,
    ink: Ink,
    width: usize,
) -> Result<String> {
    check_frame(frame)?;
    let (ny, nx) = frame.dim();
    let inside = width.saturating_sub(2).max(8);
    let block = nx.div_ceil(inside);
    let scale = ColourScale::over(frame, quantity);
    let mut text = String::new();
    let (wide, lines) = match ink {
        Ink::Plain => {
            // A character is about twice as high as wide. A line shows two rows, or each taxel takes two characters if they fit.
            let (wide, down) = match 2 * nx <= inside {
                true => (2, 1),
                false => (1, 2 * block),
            };
            let shown = largest_of_blocks(frame, (down, block));
            (wide, ascii_lines(&shown, scale, wide))
        }
        Ink::Colours256 | Ink::TrueColour => {
            let shown = largest_of_blocks(frame, (block, block));
            (1, half_block_lines(&shown, scale, ink))
        }
    };
    let border = format!("+{}+\n", "-".repeat(wide * nx.div_ceil(block)));
    text += &border;
    for line in lines {
        text += &format!("|{line}|\n");
    }
    text += &border;
    text += &format!(
        "{}; {}\n",
        grid_sentence((nx, ny), pitch_mm),
        peak_sentence(frame, pitch_mm, quantity)
    );
    text += &scale_sentence(scale, ink);
    if block > 1 {
        text += &format!("each place shows the largest of {block} × {block} taxels\n");
    }
    Ok(text)
}

/// Returns a sentence about a frame: the position of its largest value, and the number of its positive values.
pub(crate) fn peak_sentence(frame: &Array2<f64>, pitch_mm: f64, quantity: Quantity) -> String {
    let (ny, nx) = frame.dim();
    let touched = frame.iter().filter(|&&value| value > 0.0).count();
    if touched == 0 {
        return "no taxel is touched".to_owned();
    }
    let first_peak = frame.indexed_iter().min_by(|a, b| b.1.total_cmp(a.1));
    let ((row, column), value) = first_peak.unwrap_or(((0, 0), &0.0));
    format!(
        "peak {} {} {} at x {} mm, y {} mm; {touched} of {} taxels above zero",
        quantity.name(),
        short_number(value * quantity.factor()),
        quantity.unit(),
        short_number((column as f64 - 0.5 * (nx as f64 - 1.0)) * pitch_mm),
        short_number((row as f64 - 0.5 * (ny as f64 - 1.0)) * pitch_mm),
        nx * ny
    )
}

fn scale_sentence(scale: ColourScale, ink: Ink) -> String {
    let (low, high) = (short_number(scale.low), short_number(scale.high));
    let unit = scale.quantity.unit();
    match ink {
        Ink::Plain => {
            let ramp = String::from_utf8_lossy(RAMP);
            format!("scale \"{ramp}\" from {low} to {high} {unit}\n")
        }
        Ink::Colours256 | Ink::TrueColour => {
            let ramp: String = (0..20)
                .map(|step| format!("{} ", ink.ground(heat(f64::from(step) / 19.0))))
                .collect();
            format!("{low} {ramp}{} {high} {unit}\n", ink.reset())
        }
    }
}

fn ascii_lines(shown: &Array2<f64>, scale: ColourScale, wide: usize) -> Vec<String> {
    let character = |value: &f64| {
        let place = scale.place(*value);
        let step = (place * RAMP.len() as f64) as usize;
        // Every value above the lowest one is visible: a light touch differs from no touch.
        let step = if place > 0.0 { step.max(1) } else { 0 };
        char::from(RAMP[step.min(RAMP.len() - 1)])
    };
    let line = |row: ndarray::ArrayView1<f64>| {
        let characters = row.iter().map(character);
        characters
            .flat_map(|c| std::iter::repeat_n(c, wide))
            .collect()
    };
    shown.outer_iter().rev().map(line).collect()
}

fn half_block_lines(shown: &Array2<f64>, scale: ColourScale, ink: Ink) -> Vec<String> {
    let colour = |row, column| scale.colour(shown[(row, column)]);
    let rows: Vec<usize> = (0..shown.nrows()).rev().collect();
    let line = |pair: &[usize]| {
        let mut line = String::new();
        for column in 0..shown.ncols() {
            line += &ink.letter(colour(pair[0], column));
            if let Some(&lower) = pair.get(1) {
                line += &ink.ground(colour(lower, column));
            }
            line.push('▀');
        }
        line + ink.reset()
    };
    rows.chunks(2).map(line).collect()
}
