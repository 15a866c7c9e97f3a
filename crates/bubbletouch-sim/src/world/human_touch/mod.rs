//! Human touches: a hand that taps, presses and holds, strokes, shoves, pats or grabs a forearm.
//!
//! The ranges of a kind of touch → [`HumanTouch`] with randomly drawn parameters → pose of the hand and bending of its fingers at any time.
//!
//! **The forearm** is a cylinder around the z axis of the patch frame, as in [`Layout::cylinder`](super::Layout::cylinder). The skin ends
//! at `surface` metres from the axis: the radius of the layout plus the radius of a taxel.
//!
//! **Height** is the distance of the hand's nearest point from the skin along the radius through the touched place; a depth is a
//! negative height. Ball j of the hand has the radius R, and its centre is at y beside and z above the place. The ball is at height 0 where
//! `y² + (z + s)² = (R + s)²` with s = `surface`. First contact thus has a closed form and is independent of the angle around the arm.
//!
//! **Time.** A touch is a sequence of phases between states (height, displacement along the skin, closing of the fingers). Each phase follows
//! `10 τ³ − 15 τ⁴ + 6 τ⁵`, the minimum-jerk movement between two stops \[FH\]. The hand starts and ends in the air.
//!
//! The six kinds are gestures of \[CoST\] or similar to them (`hold` corresponds to its press). The motions of the six kinds in space and time were chosen for
//! this project. Tap and hold share the distributions of posture, place and depth and differ in time only. Pat is a repeated tap, mostly with the flat hand.
//! Stroke and shove move along the skin, the shove more deeply. Grab closes the fingers around the arm. A single frame therefore cannot distinguish tap from
//! hold.

mod course;
mod kind;
mod posture;
mod ranges;
mod touch;

pub use kind::{TOUCH_KINDS, TouchKind};
pub use ranges::TouchRanges;
pub use touch::{HandState, HumanTouch};
