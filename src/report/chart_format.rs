//! File formats of charts.

use serde::Deserialize;

/// File formats of charts. Pictures of frames and objects are PNG files in every case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChartFormat {
    /// SVG files, about a fifth of the size of PNG files.
    #[default]
    Svg,
    /// PNG files with two pixels per unit of the SVG file.
    Png,
    /// An SVG file and a PNG file for each chart.
    Both,
}
