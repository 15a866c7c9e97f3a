//! Human touches: a hand that taps, presses and holds, strokes, shoves, pats or grabs a forearm.
//!
//! A kind of touch and its ranges → [`HumanTouch`] (parameters, drawn by name) → where the hand is and how its fingers are bent, at
//! any time.
//!
//! **The forearm** is a cylinder around the z axis of the patch frame: that of [`Layout::cylinder`](super::Layout::cylinder), whose skin
//! ends at `surface` metres from the axis (the radius of the layout and that of a taxel).
//!
//! **Height** is how far the hand's nearest point is above the skin along the radius through the place that it touches; a depth is a
//! negative height. Ball j of the hand, of radius R and with its centre y beside and z above the place, is at height 0 where
//! `y² + (z + s)² = (R + s)²`, s being `surface`: so first contact is known in closed form, and is the same all around the arm.
//!
//! **Time.** A touch is a row of phases, each from one state (height, way slid along the skin, closing of the fingers) to the next along
//! `10 τ³ − 15 τ⁴ + 6 τ⁵`, the movement of least jerk between two stops \[FH\]. The hand starts and ends in the air.
//!
//! The six kinds are among the gestures that \[CoST\] names or close to them (its press is our hold). What each does in space and time is
//! our choice: tap and hold are drawn from the same postures, places and depths and differ in time only; pat is a repeated tap, mostly
//! with the flat hand; stroke and shove move along the skin, the shove more deeply; grab closes the fingers around the arm. A shape at one
//! instant therefore does not tell tap from hold.

mod course;
mod kind;
mod posture;
mod ranges;
mod touch;

pub use kind::{TOUCH_KINDS, TouchKind};
pub use ranges::TouchRanges;
pub use touch::{HandState, HumanTouch};
