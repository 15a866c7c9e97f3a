//! Points without lines.

use super::MarkAbout;
use crate::report::chart::series;

pub(super) const ABOUT: MarkAbout = MarkAbout {
    draw: series::draw,
    path: None,
    is_tiled: false,
};
