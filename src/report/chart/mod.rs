//! Charts: what a [`ChartSpec`] says, of a table, as a [`Drawing`].
//!
//! One renderer for every chart: `view` finds rows, lines and panels in the table; `scale` says where values stand along an axis, as
//! parts of its length; `layout` gives panels their pixels; `marks` and `tiles` draw what stands in them. The page embeds the drawings:
//! each mark is a group with the number of its row, so that the script of the page finds the row's values.

mod front;
mod layout;
mod legend;
mod marks;
mod rules;
mod scale;
mod tiles;
mod view;

pub use view::Place;

use crate::error::{Error, Result};
use crate::report::pictures::drawing::Drawing;
use crate::table::{ChartSpec, Mark, Table};
use front::Front;
use view::View;

/// Draws a chart of one of these tables.
///
/// # Errors
/// A table or a column that the spec names and that is not there; no row that has a place in the chart.
pub fn draw(spec: &ChartSpec, tables: &[Table]) -> Result<Drawing> {
    let view = View::of(spec, tables)?;
    if view.places.is_empty() {
        let given = format!("no row of {} with {} and {}", spec.table, spec.x, spec.y);
        return Err(Error::input(
            format!("chart {}", spec.name),
            given,
            "one at least",
        ));
    }
    match &spec.mark {
        Mark::Tiles { fill, sign } => tiles::draw(&view, fill, sign.as_deref()),
        Mark::Line | Mark::Points => Ok(marks::draw(&view)),
    }
}

/// Where every row that a chart shows stands, as parts of the width and the height of its panel, from the left and from below.
///
/// # Errors
/// A table or a column that the spec names and that is not there.
pub fn places(spec: &ChartSpec, tables: &[Table]) -> Result<Vec<Place>> {
    let view = View::of(spec, tables)?;
    Ok(view.places)
}

/// How many rows of its table a chart does not draw, and why, as it stands on the chart; empty if it draws all.
///
/// # Errors
/// A table or a column that the spec names and that is not there.
pub fn omitted(spec: &ChartSpec, tables: &[Table]) -> Result<String> {
    Ok(View::of(spec, tables)?.omitted())
}

/// What the cheapest and the best point of a chart's first front are, in words; none without a front.
pub fn front_ends(spec: &ChartSpec, tables: &[Table]) -> Option<[String; 2]> {
    let view = View::of(spec, tables).ok()?;
    Front::of(&view).ends()
}
