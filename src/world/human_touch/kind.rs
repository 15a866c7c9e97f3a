//! The kinds of touch.

use crate::error::{Error, Result};
use crate::spelling::nearest_names;
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

    /// The kind of a name.
    ///
    /// # Errors
    /// The error says which it perhaps meant.
    pub fn named(name: &str) -> Result<Self> {
        let found = TOUCH_KINDS.into_iter().find(|kind| kind.name() == name);
        let names = TOUCH_KINDS.map(Self::name);
        found.ok_or_else(|| Error::input("kind of touch", name, nearest_names(name, names)))
    }
}
