//! Human touches as they are written: `[human_touch]`, in place of `[objects]` and `[touches]`.

use crate::inputs::defaults::number;
use crate::world::TouchKind;
use serde::{Deserialize, Serialize};

/// `[human_touch]`: which kind of touch is it? The skin is bent around a forearm, its columns around it, its rows along it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HumanTouchSpec {
    /// The kinds to tell apart; all six when left out.
    #[serde(default = "all_kinds")]
    pub kinds: Vec<TouchKind>,
    /// Touches a kind.
    pub per_kind: usize,
    /// From the axis of the arm to the outside of its skin, mm.
    #[serde(default = "number::<43>")]
    pub arm_radius_mm: f64,
    /// Frames a second.
    pub frames_hz: f64,
    /// How long each recording is, s; the touch begins at any time that lets it end within.
    pub duration_s: f64,
}

fn all_kinds() -> Vec<TouchKind> {
    crate::world::TOUCH_KINDS.to_vec()
}
