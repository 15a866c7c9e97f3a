//! Specification of human touches: the table `[human_touch]`, which replaces `[objects]` and `[touches]`.

use crate::inputs::defaults::number;
use crate::inputs::schema_types::Names;
use crate::world::TouchKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Keys of `[human_touch]`: recognition of kinds of human touch on a forearm. The columns of the array are bent around the arm; its rows run along the arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HumanTouchSpec {
    /// Kinds of human touch that the classifier distinguishes. Default: all six.
    #[serde(default = "all_kinds")]
    #[schemars(with = "Vec<Names<TouchKind>>")]
    pub kinds: Vec<TouchKind>,
    /// Number of human touches of each kind, at least 1.
    pub per_kind: usize,
    /// Distance from the axis of the arm to the outside of its skin, mm, positive. Default: 43.
    #[serde(default = "number::<43>")]
    pub arm_radius_mm: f64,
    /// Frame rate of the skin, Hz, positive.
    pub frames_hz: f64,
    /// Duration of the recording of each touch, s. The touch begins at a random time such that it ends within the recording.
    pub duration_s: f64,
}

fn all_kinds() -> Vec<TouchKind> {
    crate::world::TOUCH_KINDS.to_vec()
}
