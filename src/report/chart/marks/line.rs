//! Points joined by straight lines.

use super::MarkAbout;
use crate::report::chart::series;

pub(super) const ABOUT: MarkAbout = MarkAbout {
    draw: series::draw,
    path: Some(|points| points.to_vec()),
    is_tiled: false,
};
