//! Human touch: its randomly drawn parameters, and the resulting motion of the hand.

use super::course::{Course, State};
use super::posture::{Posture, spheres};
use super::{TouchKind, TouchRanges};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::{Hand, SphereUnion};
use crate::random::Seed;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Touch of a forearm by a hand: randomly drawn parameters, and the motion of the hand over time.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::world::{HumanTouch, TouchKind, TouchRanges};
///
/// let surface = 0.043;
/// let ranges = TouchRanges::usual(TouchKind::Pat);
/// let pat = HumanTouch::draw(TouchKind::Pat, &ranges, surface, &Seed::new(3))?;
/// assert!((2..=4).contains(&pat.contacts));
/// // The hand starts and ends in the air, and equal seeds give equal touches.
/// assert!(pat.at(0.0).height > 0.01 && pat.at(pat.duration()).height > 0.01);
/// assert_eq!(pat, HumanTouch::draw(TouchKind::Pat, &ranges, surface, &Seed::new(3))?);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HumanTouch {
    /// Kind of the touch.
    pub kind: TouchKind,
    /// Number of touching fingertips (1 to 4); 5 for the flat hand or a grab.
    pub fingers: usize,
    /// Position along the arm's axis (+z) where the touch begins, metres from the middle.
    pub along: f64,
    /// Angle around the arm where the touch begins, radians from +x.
    pub around: f64,
    /// Largest depth of the hand past first contact, metres; the palm's depth for a grab.
    pub depth: f64,
    /// Time from first contact to the largest depth, seconds; the withdrawal to first contact takes equally long.
    pub rise: f64,
    /// Time that the hand stays at the largest depth in each contact, seconds.
    pub hold: f64,
    /// Number of contacts between hand and arm.
    pub contacts: usize,
    /// Length of the path along the skin, metres.
    pub travel: f64,
    /// Direction of the path, radians from +z towards larger angles around the arm.
    pub direction: f64,
    /// Distance of the skin from the arm's axis, metres.
    pub surface: f64,
    /// Height of the hand's anchor point above the skin at first contact of the open hand, metres.
    first_contact: f64,
    posture: Posture,
    course: Course,
}

/// State of a hand at one instant of a touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandState {
    /// Hand at this instant: its size, and the bending of its fingers.
    pub hand: Hand,
    /// Pose of the hand in the patch frame, whose z axis is the arm's axis; metres.
    pub patch_from_hand: Pose,
    /// Height of the hand above its position at first contact of the open hand, metres; negative while the hand presses.
    pub height: f64,
    /// Fraction to which the fingers are closed, 0 (open) to 1.
    pub closed: f64,
}

impl HandState {
    /// Returns the hand as spheres, in its own frame.
    pub fn spheres(&self) -> SphereUnion {
        spheres(&self.hand)
    }
}

impl HumanTouch {
    /// Draws a touch of a kind on an arm whose skin is `surface` metres from its axis.
    ///
    /// Every parameter is drawn uniformly from its range, independently of the others.
    ///
    /// # Errors
    /// If a range is invalid, or `surface` is not between 5 and 500 mm.
    pub fn draw(kind: TouchKind, ranges: &TouchRanges, surface: f64, seed: &Seed) -> Result<Self> {
        ranges
            .check()
            .map_err(|error| error.under(format!("{}, ", kind.name())))?;
        if !(0.005..=0.5).contains(&surface) {
            let given = format!("{surface} m");
            return Err(Error::input("radius of the arm", given, "0.005 to 0.5 m"));
        }
        let rng = &mut seed.named("human touch").rng();
        let any = |range: &RangeInclusive<f64>, rng: &mut ChaCha8Rng| rng.gen_range(range.clone());
        let is_flat = matches!(kind, TouchKind::Shove | TouchKind::Grab);
        let chosen = ranges.fingers[rng.gen_range(0..ranges.fingers.len())];
        let fingers = if is_flat { 5 } else { chosen };
        let shape = (
            any(&ranges.hand_length, rng),
            fingers,
            any(&ranges.yaw, rng),
        );
        let mut posture = Posture::draw(kind, shape, rng);
        let (along, around) = (any(&ranges.along, rng), any(&ranges.around, rng));
        let depth = any(&ranges.depth, rng);
        let (rise, hold) = (any(&ranges.rise, rng), any(&ranges.hold, rng));
        let moves = matches!(kind, TouchKind::Stroke | TouchKind::Shove);
        let travel = if moves { any(&ranges.travel, rng) } else { 0.0 };
        let seconds = travel / any(&ranges.speed, rng);
        let turned = if rng.r#gen() { PI } else { 0.0 };
        let direction = turned + any(&ranges.direction, rng);
        let contacts = match kind {
            TouchKind::Pat => rng.gen_range(ranges.contacts.clone()),
            _ => 1,
        };
        if kind == TouchKind::Grab {
            posture.close(surface, depth, any(&ranges.grip, rng));
        }
        let high = State {
            height: any(&ranges.clearance, rng),
            ..State::default()
        };
        let mut course = Course::from(high);
        match kind {
            TouchKind::Tap | TouchKind::Hold => {
                course.press(depth, rise);
                course.wait(hold);
            }
            TouchKind::Stroke => {
                course.press(depth, rise);
                slide(&mut course, seconds, travel, depth);
                course.wait(hold);
            }
            TouchKind::Shove => {
                // The hand is first laid on the skin and then pushes.
                course.press(0.4 * depth, rise);
                slide(&mut course, seconds, travel, depth);
                course.wait(hold);
            }
            TouchKind::Pat => {
                for contact in 0..contacts {
                    if contact > 0 {
                        course.lift(any(&ranges.lift, rng), rise);
                    }
                    course.press(depth, rise);
                    course.wait(hold);
                }
            }
            TouchKind::Grab => {
                let closing = any(&ranges.closing, rng);
                course.press(depth, rise);
                close(&mut course, closing, 1.0);
                course.wait(hold);
                close(&mut course, closing, 0.0);
            }
        }
        course.lift(high.height, rise);
        Ok(Self {
            kind,
            fingers,
            along,
            around,
            depth,
            rise,
            hold,
            contacts,
            travel,
            direction,
            surface,
            first_contact: posture.first_contact(surface),
            posture,
            course,
        })
    }

    /// Returns the time between the start and the end of the touch, seconds. The hand is in the air at both times.
    pub fn duration(&self) -> f64 {
        self.course.duration()
    }

    /// Returns the state of the hand at a time in seconds; constant, in the air, before the start and after the end.
    pub fn at(&self, time: f64) -> HandState {
        let state = self.course.at(time);
        let (sin, cos) = self.direction.sin_cos();
        // The path is centred on the touched place: half of it lies before the place.
        let slid = state.slid - 0.5 * self.travel;
        let along = self.along + slid * cos;
        let around = self.around + slid * sin / self.surface;
        let radius = self.surface + self.first_contact + state.height;
        HandState {
            hand: self.posture.hand(state.closed),
            patch_from_hand: self.posture.pose((along, around), radius),
            height: state.height,
            closed: state.closed,
        }
    }
}

/// Appends a movement of the hand along the skin during which the depth changes.
fn slide(course: &mut Course, seconds: f64, travel: f64, depth: f64) {
    let to = State {
        height: -depth,
        slid: travel,
        ..course.end()
    };
    course.go(seconds, to);
}

/// Appends a movement that closes or opens the fingers.
fn close(course: &mut Course, seconds: f64, closed: f64) {
    let to = State {
        closed,
        ..course.end()
    };
    course.go(seconds, to);
}
