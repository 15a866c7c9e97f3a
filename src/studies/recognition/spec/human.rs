//! Specification of human touches: `[human_touch]`, which replaces `[objects]` and `[touches]`.

use crate::inputs::defaults::number;
use crate::world::TouchKind;
use serde::{Deserialize, Serialize};

/// `[human_touch]`: recognition of kinds of human touch on a forearm. The columns of the skin are bent around the arm; the rows run along it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HumanTouchSpec {
    /// Kinds of touch to distinguish. Default: all six.
    #[serde(default = "all_kinds")]
    pub kinds: Vec<TouchKind>,
    /// Number of touches of each kind.
    pub per_kind: usize,
    /// Distance from the axis of the arm to the outside of its skin, mm.
    #[serde(default = "number::<43>")]
    pub arm_radius_mm: f64,
    /// Frame rate, Hz.
    pub frames_hz: f64,
    /// Duration of each recording, s. The touch begins at a random time that lets it end within the recording.
    pub duration_s: f64,
}

fn all_kinds() -> Vec<TouchKind> {
    crate::world::TOUCH_KINDS.to_vec()
}
