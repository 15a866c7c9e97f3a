//! Specification of human touches: the table `[human_touch]`, which replaces `[objects]` and `[touches]`.

use crate::inputs::params::{named, params};
use crate::inputs::range::Range::{Any, Positive};
use crate::inputs::range::TOUCHES;
use crate::world::TouchKind;

named!(TouchKind);

params! {
    /// Keys of `[human_touch]`: recognition of kinds of human touch on a forearm. The columns of the array are bent around the arm; its rows run along the arm.
    pub struct HumanTouchSpec {
        /// Kinds of human touch that the classifier distinguishes. Default: all six.
        kinds: Vec<TouchKind> = crate::world::TOUCH_KINDS.to_vec() => Any, Condition, Axes;
        /// Number of human touches of each kind, at least 1.
        per_kind: usize => TOUCHES, Choice, Axes;
        /// Distance from the axis of the arm to the outside of its skin, mm, positive. Default: 43.
        arm_radius_mm: f64 = 43.0 => Positive, Choice, Axes;
        /// Frame rate of the skin, Hz, positive.
        frames_hz: f64 => Positive, Choice, Axes;
        /// Duration of the recording of each touch, s. The touch begins at a random time such that it ends within the recording.
        duration_s: f64 => Positive, Choice, Axes;
    }
}
