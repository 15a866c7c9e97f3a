//! The kinds of touch.

use serde::{Deserialize, Serialize};

/// What a hand does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TouchKind {
    /// Touches once, shortly.
    Tap,
    /// The same for longer.
    Hold,
    /// Slides along the arm.
    Stroke,
    /// Presses with the flat hand, and deeper while it pushes along the skin.
    Shove,
    /// Touches several times.
    Pat,
    /// Closes its fingers around the arm.
    Grab,
}

/// All kinds, in the order of their labels.
pub const TOUCH_KINDS: [TouchKind; 6] = [
    TouchKind::Tap,
    TouchKind::Hold,
    TouchKind::Stroke,
    TouchKind::Shove,
    TouchKind::Pat,
    TouchKind::Grab,
];

impl TouchKind {
    /// One word, as in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tap => "tap",
            Self::Hold => "hold",
            Self::Stroke => "stroke",
            Self::Shove => "shove",
            Self::Pat => "pat",
            Self::Grab => "grab",
        }
    }
}
