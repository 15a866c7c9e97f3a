//! Marks of charts. Each file describes one mark; `table/marks.rs` lists the files.

use super::view::View;
use crate::error::Result;
use crate::report::pictures::drawing::{Drawing, Point};
use crate::table::{Mark, for_each_mark};

/// Function that returns the path of a line through given points, from left to right.
type LinePath = fn(&[Point]) -> Vec<Point>;

/// Descriptor of a mark type of charts, for example lines or tiles.
pub(in crate::report) struct MarkAbout {
    /// Function that draws a chart with marks of this type.
    pub(super) draw: fn(&View) -> Result<Drawing>,
    /// Function that returns the path of a line through the points; `None` if the points are not joined.
    pub path: Option<LinePath>,
    /// Whether each mark is a tile at the crossing of a row (y value) and a column (x value).
    pub is_tiled: bool,
}

macro_rules! declare_marks {
    ($($(#[$doc:meta])* $name:ident $({ $($columns:tt)* })? $file:ident;)*) => {
        $(mod $file;)*

        impl Mark {
            /// Returns the descriptor of the mark type.
            pub(in crate::report) fn about(&self) -> &'static MarkAbout {
                match self {
                    $(Self::$name { .. } => &$file::ABOUT,)*
                }
            }
        }
    };
}

for_each_mark!(declare_marks);
