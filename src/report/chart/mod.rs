//! Charts: a [`ChartSpec`] and a table are converted to a [`Drawing`].
//!
//! All charts have one renderer. `view` selects rows, lines and panels of the table. `scale` maps values to fractions of an axis. `layout` computes the pixel
//! positions of the panels. `series` and `tiles` draw the data. `declared` makes specifications of the constant charts of a kind of study. The page embeds the drawings: each mark is a group with its row number, so that the page's
//! script finds the row's values.

mod declared;
mod front;
mod layout;
mod legend;
mod rules;
mod scale;
mod series;
mod tiles;
mod view;

pub use declared::Chart;
pub use view::Place;

use crate::error::{Error, Result};
use crate::report::pictures::Drawing;
use crate::table::{ChartSpec, Table};
use view::View;

/// Draws a chart from one of the given tables.
///
/// # Errors
/// If the specification names a table or a column that does not exist, or no row has a place in the chart.
pub fn draw(spec: &ChartSpec, tables: &[Table]) -> Result<Drawing> {
    let view = View::new(spec, tables)?;
    if view.places.is_empty() {
        let given = format!("no row of {} with {} and {}", spec.table, spec.x, spec.y);
        return Err(Error::input(
            format!("chart {}", spec.name),
            given,
            "one at least",
        ));
    }
    match view.fill {
        Some(fill) => tiles::draw(&view, fill),
        None => series::draw(&view),
    }
}

/// Returns the positions of all drawn rows, as fractions of the panel's width (from the left) and height (from below).
///
/// # Errors
/// If the specification names a table or a column that does not exist.
pub fn places(spec: &ChartSpec, tables: &[Table]) -> Result<Vec<Place>> {
    let view = View::new(spec, tables)?;
    Ok(view.places)
}

/// Returns the text about table rows that a chart does not show: their number and the reasons. The text is empty if all rows are drawn.
///
/// # Errors
/// If the specification names a table or a column that does not exist.
pub fn omitted(spec: &ChartSpec, tables: &[Table]) -> Result<String> {
    Ok(View::new(spec, tables)?.omitted())
}
