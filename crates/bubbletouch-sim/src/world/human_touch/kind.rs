//! Kinds of human touch.

use serde::{Deserialize, Serialize};

/// Gesture of a hand on a forearm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TouchKind {
    /// The hand touches the arm once, for a short time.
    Tap,
    /// The hand touches the arm once and stays for a while.
    Hold,
    /// The hand slides along the arm.
    Stroke,
    /// The flat hand presses, and presses deeper while it pushes along the skin.
    Shove,
    /// The hand touches the arm several times.
    Pat,
    /// The fingers close around the arm.
    Grab,
}

/// All kinds of touch, in the order of their class labels.
pub const TOUCH_KINDS: [TouchKind; 6] = [
    TouchKind::Tap,
    TouchKind::Hold,
    TouchKind::Stroke,
    TouchKind::Shove,
    TouchKind::Pat,
    TouchKind::Grab,
];

impl TouchKind {
    /// Returns the name of the kind of touch in files, a single word.
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
