//! Posture of a hand: orientation, and bending of the fingers.

use super::TouchKind;
use crate::geometry::Pose;
use crate::objects::{FingerPose, Hand, Sphere, SphereUnion};
use glam::{DQuat, DVec3};
use rand::Rng;
use std::f64::consts::FRAC_PI_2;

/// Largest distance between the spheres that represent a hand and the hand's surface, metres. If larger, a finger resembles a row of balls; if smaller, a
/// frame takes longer (10 to 30 µs for 100 spheres).
const SURFACE_ERROR: f64 = 0.5e-3;

/// Largest inclination of a hand against the skin, radians. If larger, a flat hand (which is rigid) touches only with the ball of the thumb or a finger.
const LEVEL: f64 = 0.03;

/// Bending of the fingers in a fist, as argument of [`Hand::curled`].
const FIST: f64 = 0.85;

/// Posture of a hand before it moves: finger positions, orientation, and the point of the hand that lies above the touched point of the arm.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Posture {
    /// Hand with open fingers.
    pub open: Hand,
    /// Hand with closed fingers; equal to the open hand unless the touch is a grab.
    pub closed: Hand,
    /// Rotation from the hand's frame to a frame at the touched point of the arm. In this frame, x points back along the arm, y around it and z away from it.
    pub place_from_hand: DQuat,
    /// Point of the hand that lies above the touched point of the arm, metres, in the hand's frame.
    pub anchor: DVec3,
}

impl Posture {
    /// Draws the posture of a hand that touches with 1 to 4 fingertips, with the flat hand (`fingers` = 5), or with a grab.
    pub fn draw(
        kind: TouchKind,
        (length, fingers, yaw): (f64, usize, f64),
        rng: &mut impl Rng,
    ) -> Self {
        let is_flat = fingers == 5 || matches!(kind, TouchKind::Shove | TouchKind::Grab);
        let mut open = match is_flat {
            true => Hand::curled(rng.gen_range(0.0..=0.1)),
            false => Hand::curled(FIST),
        };
        open.length = length;
        // Fingertips touch first if the wrist is higher.
        let mut pitch = rng.gen_range(-LEVEL..=LEVEL);
        if !is_flat {
            pitch = -rng.gen_range(0.35..=0.8);
            let straight = FingerPose {
                spread: 0.0,
                knuckle: rng.gen_range(0.05..=0.25),
                middle: rng.gen_range(0.05..=0.25),
                end: rng.gen_range(0.0..=0.15),
            };
            open.fingers[..fingers].fill(straight);
        }
        if is_flat {
            // Otherwise a flat hand would lie on its thumb.
            open.thumb.knuckle = -0.3;
        }
        let roll = rng.gen_range(-LEVEL..=LEVEL);
        let place_from_hand = DQuat::from_rotation_z(yaw)
            * DQuat::from_rotation_x(pitch)
            * DQuat::from_rotation_y(roll);
        Self {
            anchor: anchor(&open, if is_flat { 5 } else { fingers }),
            closed: open,
            open,
            place_from_hand,
        }
    }

    /// Bends each finger until it would be `grip` metres deep in the skin. The hand is at the depth `depth`, on an arm of radius `surface`. A finger that
    /// misses the arm closes to a fist.
    pub fn close(&mut self, surface: f64, depth: f64, grip: f64) {
        let height = self.first_contact(surface) - depth;
        let fist = Hand::curled(1.0);
        for digit in 0..5 {
            let closed_by = |share: f64| {
                let mut hand = self.open;
                bend(&mut hand, &self.open, &fist, (digit, share));
                hand
            };
            let is_in = |share: f64| {
                let hand = closed_by(share);
                let balls = phalanges(&hand, digit).into_iter();
                let sunk = balls.map(|ball| self.sunk(ball, surface, height));
                sunk.fold(f64::NEG_INFINITY, f64::max) >= grip
            };
            let share = first_share(is_in);
            bend(&mut self.closed, &self.open, &fist, (digit, share));
        }
    }

    /// Returns the hand with its fingers closed by the fraction `share`, 0 to 1.
    pub fn hand(&self, share: f64) -> Hand {
        let mut hand = self.open;
        for digit in 0..5 {
            bend(&mut hand, &self.open, &self.closed, (digit, share));
        }
        hand
    }

    /// Returns the height of the hand's `anchor` point above the skin at first contact of the open hand, metres. `surface` is the radius of the arm.
    pub fn first_contact(&self, surface: f64) -> f64 {
        let hand = spheres(&self.open);
        let balls = hand.spheres().iter();
        let heights = balls.filter_map(|ball| self.touches_at(ball, surface));
        heights.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns the height of the hand's `anchor` point at which a ball of the hand touches the arm, metres. Returns `None` if the ball passes beside the arm.
    fn touches_at(&self, ball: &Sphere, surface: f64) -> Option<f64> {
        let at = self.place_from_hand * (ball.center - self.anchor);
        let reach = ball.radius + surface;
        let square = reach * reach - at.y * at.y;
        (square > 0.0).then(|| square.sqrt() - at.z - surface)
    }

    /// Returns the depth to which a ball of the hand penetrates the arm, metres; negative if the ball is outside. `height` is the height of the hand's
    /// `anchor` point above the skin.
    fn sunk(&self, ball: Sphere, surface: f64, height: f64) -> f64 {
        let at = self.place_from_hand * (ball.center - self.anchor);
        ball.radius + surface - at.y.hypot(at.z + height + surface)
    }

    /// Returns the pose `patch_from_hand` with the hand's `anchor` point above the point (along, around) of the arm, `radius` metres from the arm's axis.
    pub fn pose(&self, (along, around): (f64, f64), radius: f64) -> Pose {
        // Frame of the touched place at +x (its x is −z of the arm, y is unchanged, z is the arm's x), rotated around the arm.
        let rotation = DQuat::from_rotation_z(around) * DQuat::from_rotation_y(FRAC_PI_2);
        let place = radius * (rotation * DVec3::Z) + along * DVec3::Z;
        let patch_from_hand = rotation * self.place_from_hand;
        Pose::new(patch_from_hand, place - patch_from_hand * self.anchor)
    }
}

/// Returns the hand as a union of spheres, within [`SURFACE_ERROR`] of its surface.
pub(super) fn spheres(hand: &Hand) -> SphereUnion {
    let solid = hand.solid().expect("fingers between open and closed");
    solid.pack(SURFACE_ERROR).expect("a hand takes few spheres")
}

/// Interpolates the posture of one digit of `hand` (0 to 3 are fingers, 4 is the thumb) between the postures in `from` and `to`.
fn bend(hand: &mut Hand, from: &Hand, to: &Hand, (digit, share): (usize, f64)) {
    let between = |a: f64, b: f64| a + share * (b - a);
    let pose = |a: &FingerPose, b: &FingerPose| FingerPose {
        spread: between(a.spread, b.spread),
        knuckle: between(a.knuckle, b.knuckle),
        middle: between(a.middle, b.middle),
        end: between(a.end, b.end),
    };
    if digit < 4 {
        hand.fingers[digit] = pose(&from.fingers[digit], &to.fingers[digit]);
    } else {
        hand.thumb = pose(&from.thumb, &to.thumb);
        hand.opposition = between(from.opposition, to.opposition);
    }
}

/// Returns the smallest fraction, 0 to 1, for which `is_so` returns true, to an accuracy of 1e-4; 1 if there is none. The search proceeds in steps, because a
/// finger can move past the arm.
fn first_share(is_so: impl Fn(f64) -> bool) -> f64 {
    const STEPS: usize = 40;
    let share = |step: usize| step as f64 / STEPS as f64;
    let Some(step) = (0..=STEPS).find(|&step| is_so(share(step))) else {
        return 1.0;
    };
    let (mut low, mut high) = (share(step.saturating_sub(1)), share(step));
    while high - low > 1e-4 {
        let middle = 0.5 * (low + high);
        match is_so(middle) {
            true => high = middle,
            false => low = middle,
        }
    }
    high
}

/// Returns the point of a hand that is placed above the touched point of the arm. This point is the mean of the touching fingertips, or a point near the
/// knuckles of the flat hand.
fn anchor(hand: &Hand, fingers: usize) -> DVec3 {
    let strands = hand.strands();
    match fingers {
        5 => strands[1][0].center.lerp(strands[1][1].center, 0.75),
        n => {
            let tips = strands[..n].iter().map(|finger| finger[4].center);
            tips.sum::<DVec3>() / n as f64
        }
    }
}

/// Returns balls along the phalanges (finger bones) of a digit (0 to 3 are fingers, 4 is the thumb).
fn phalanges(hand: &Hand, digit: usize) -> Vec<Sphere> {
    const STEPS: usize = 6;
    let strand = if digit == 4 { Hand::THUMB } else { digit };
    let balls = &hand.strands()[strand][1..];
    let pairs = balls.windows(2).flat_map(|pair| {
        (0..STEPS).map(move |step| {
            let share = step as f64 / STEPS as f64;
            Sphere {
                center: pair[0].center.lerp(pair[1].center, share),
                radius: pair[0].radius + share * (pair[1].radius - pair[0].radius) + SURFACE_ERROR,
            }
        })
    });
    pairs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;

    const SURFACE: f64 = 0.04;

    fn grab(number: u64) -> Posture {
        let mut rng = Seed::new(3).named("posture").numbered(number).rng();
        Posture::draw(TouchKind::Grab, (0.19, 5, 0.4), &mut rng)
    }

    #[test]
    fn a_ball_is_in_the_skin_as_deep_as_the_hand_is_lower_than_at_its_first_contact() {
        let posture = grab(0);
        let mut n_above = 0;
        for ball in spheres(&posture.open).spheres() {
            let Some(contact) = posture.touches_at(ball, SURFACE) else {
                continue;
            };
            assert!(posture.sunk(*ball, SURFACE, contact).abs() < 1e-12);
            // A ball above the axis of the arm moves along the radius.
            let above = Sphere {
                center: posture.anchor,
                ..*ball
            };
            for depth in [-5e-3, 3e-3] {
                let contact = posture.touches_at(&above, SURFACE).unwrap();
                let sunk = posture.sunk(above, SURFACE, contact - depth);
                assert!((sunk - depth).abs() < 1e-12, "{sunk} of {depth}");
                n_above += 1;
            }
        }
        assert!(n_above > 100);
    }

    #[test]
    fn a_closed_finger_is_as_deep_as_its_grip_or_is_a_fist() {
        let (depth, grip) = (1e-3, 2e-3);
        let fist = Hand::curled(1.0);
        let mut n_gripping = 0;
        for number in 0..4 {
            let mut posture = grab(number);
            posture.close(SURFACE, depth, grip);
            let height = posture.first_contact(SURFACE) - depth;
            for digit in 0..4 {
                let balls = phalanges(&posture.closed, digit).into_iter();
                let sunk = balls.map(|ball| posture.sunk(ball, SURFACE, height));
                let deepest = sunk.fold(f64::NEG_INFINITY, f64::max);
                if posture.closed.fingers[digit] != fist.fingers[digit] {
                    assert!((deepest - grip).abs() < 1e-4, "{deepest}");
                    n_gripping += 1;
                }
            }
        }
        assert!(n_gripping > 8, "{n_gripping}");
    }
}
