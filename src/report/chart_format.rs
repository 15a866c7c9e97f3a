//! File formats of charts.

use serde::Deserialize;

/// File formats in which charts are written. Pictures of frames and objects are always PNG files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChartFormat {
    /// SVG files only, about a fifth of the size of PNG files.
    #[default]
    Svg,
    /// PNG files only, with two pixels per unit of the SVG file.
    Png,
    /// Two files per chart, in the formats SVG and PNG.
    Both,
}
