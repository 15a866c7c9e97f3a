//! Kinds of human touch.

use serde::{Deserialize, Serialize};

/// Gesture of a hand on a forearm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TouchKind {
    /// One short touch.
    Tap,
    /// One long touch.
    Hold,
    /// Slides along the arm.
    Stroke,
    /// Presses with the flat hand, and presses deeper while it pushes along the skin.
    Shove,
    /// Touches several times.
    Pat,
    /// Closes the fingers around the arm.
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
    /// Returns the name of the kind in files, one word.
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
