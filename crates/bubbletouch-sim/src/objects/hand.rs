//! Human hand with posed fingers; palm and fingers are balls of varying size swept along the bones.
//!
//! The hand is a right hand, palm down, on the plane z = 0. Fingers point along +y and the thumb towards −x; the middle of the wrist is at the origin. A flat
//! hand touches the plane with palm, fingers and thumb; bent fingers extend below the plane.
//!
//! Bone lengths are mean values of adults \[BK\]. Breadths are estimates for the fingers of an average man, to about half a
//! millimetre. The skin of the hand is rigid, as every object is.

use super::{Part, Shape, Solid, Sphere};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use glam::{DQuat, DVec3};

/// Joint angles of a finger, radians; 0 is straight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FingerPose {
    /// Abduction angle towards the little finger, −0.5 to 0.5 rad.
    pub spread: f64,
    /// Flexion angle of the knuckle (the thumb's metacarpophalangeal joint), −0.5 to 1.7 rad.
    pub knuckle: f64,
    /// Flexion angle of the middle joint (the thumb's last joint), −0.1 to 2.0 rad.
    pub middle: f64,
    /// Flexion angle of the last joint (unused for the thumb), −0.1 to 1.5 rad.
    pub end: f64,
}

/// Size and pose of a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Length of the hand from the wrist to the end of the straight middle finger, metres; 0.16 to 0.21 for adults.
    pub length: f64,
    /// Poses of the index, middle, ring and little finger.
    pub fingers: [FingerPose; 4],
    /// Pose of the thumb.
    pub thumb: FingerPose,
    /// Rotation of the thumb's metacarpal under the palm, radians, from 0 (beside the palm) to 1.2.
    pub opposition: f64,
}

/// Dimensions of a digit: the lengths of its bones and the diameters at its joints, mm, for a hand of [`MODEL_LENGTH`].
struct Digit {
    /// Position of the start of the metacarpal, mm.
    base: [f64; 2],
    /// Angle of the metacarpal from +y towards +x, radians.
    angle: f64,
    /// Lengths of the metacarpal and the phalanges, mm; the last phalanx includes its pulp.
    bones: [f64; 4],
    /// Diameters at the start of the metacarpal and at the end of each bone, mm.
    diameters: [f64; 5],
}

/// Dimensions of the index, middle, ring and little finger.
const FINGERS: [Digit; 4] = [
    Digit {
        base: [-14.0, 20.0],
        angle: -0.19,
        bones: [68.1, 39.8, 22.4, 17.3],
        diameters: [26.0, 25.0, 18.0, 16.0, 13.0],
    },
    Digit {
        base: [-4.5, 22.0],
        angle: -0.03,
        bones: [64.6, 44.6, 26.3, 18.9],
        diameters: [26.0, 25.5, 18.5, 16.5, 13.5],
    },
    Digit {
        base: [5.0, 21.0],
        angle: 0.12,
        bones: [58.0, 41.4, 25.7, 18.8],
        diameters: [26.0, 24.5, 17.5, 15.5, 12.5],
    },
    Digit {
        base: [14.0, 19.0],
        angle: 0.27,
        bones: [53.7, 32.7, 18.1, 17.5],
        diameters: [26.0, 23.0, 15.5, 14.0, 11.5],
    },
];

/// Dimensions of the thumb, which has no third phalanx.
const THUMB: Digit = Digit {
    base: [-17.0, 12.0],
    angle: -0.75,
    bones: [46.2, 31.6, 23.2, 0.0],
    diameters: [28.0, 25.0, 20.5, 15.0, 15.0],
};

/// Distance from the origin to the end of the middle finger in the dimensions of this model, mm.
const MODEL_LENGTH: f64 = 183.1;

impl Hand {
    /// Index of the thumb in the sphere chains of a hand.
    pub const THUMB: usize = 7;

    /// Returns a hand with straight fingers.
    pub fn flat() -> Self {
        Self {
            length: 0.189,
            fingers: [FingerPose::default(); 4],
            thumb: FingerPose::default(),
            opposition: 0.0,
        }
    }

    /// Returns a hand that is bent around a round object. The number `share` is the fraction of the bending, 0 for a flat hand and 1 for a fist.
    pub fn curled(share: f64) -> Self {
        let finger = FingerPose {
            spread: 0.0,
            knuckle: 1.45 * share,
            middle: 1.75 * share,
            end: 1.1 * share,
        };
        Self {
            fingers: [finger; 4],
            thumb: FingerPose {
                spread: 0.0,
                knuckle: 0.6 * share,
                middle: 0.9 * share,
                end: 0.0,
            },
            opposition: 0.9 * share,
            ..Self::flat()
        }
    }

    /// Returns a fist with a straight index finger.
    pub fn pointing() -> Self {
        let mut hand = Self::curled(1.0);
        hand.fingers[0] = FingerPose::default();
        hand
    }

    /// Returns a hand with fingers and thumb spread apart.
    pub fn spread() -> Self {
        let mut hand = Self::flat();
        for (finger, spread) in hand.fingers.iter_mut().zip([-0.22, -0.05, 0.12, 0.3]) {
            finger.spread = spread;
        }
        hand.thumb.spread = -0.25;
        hand
    }

    /// Returns the hand as a union of sphere sweeps.
    ///
    /// # Errors
    /// If a joint angle is out of range; the error names the joint and the range.
    pub fn solid(&self) -> Result<Solid> {
        self.check()?;
        let parts = self.strands().into_iter().map(|balls| {
            let shape = Shape::SphereSweep {
                points: balls.iter().map(|ball| ball.center).collect(),
                diameters: balls.iter().map(|ball| 2.0 * ball.radius).collect(),
            };
            Part::new(shape, Pose::IDENTITY)
        });
        Solid::new(parts.collect::<Result<_>>()?)
    }

    /// Returns chains of balls at the joints, metres; the hand is the union of the convex hulls of consecutive balls. The first chains are the index, middle,
    /// ring and little finger: the start of the metacarpal, then the end of each bone. The palm between the metacarpals, the thumb, and the ball of the thumb
    /// follow.
    pub fn strands(&self) -> [Vec<Sphere>; 9] {
        // Scale from the model's millimetres to the metres of this hand.
        let scale = self.length / MODEL_LENGTH;
        let strand = |points: &[DVec3], diameters: &[f64]| -> Vec<Sphere> {
            let balls = points.iter().zip(diameters);
            balls
                .map(|(point, diameter)| Sphere {
                    center: scale * *point,
                    radius: 0.5 * (scale * diameter),
                })
                .collect()
        };
        let joints: [[DVec3; 5]; 4] =
            std::array::from_fn(|finger| FINGERS[finger].joints(&self.fingers[finger], 0.0));
        let finger = |k: usize| strand(&joints[k], &FINGERS[k].diameters);
        // Palm between the metacarpals.
        let palm = |k: usize| {
            let middle = |end: usize| 0.5 * (joints[k][end] + joints[k + 1][end]);
            let width =
                |end: usize| 0.5 * (FINGERS[k].diameters[end] + FINGERS[k + 1].diameters[end]);
            strand(&[middle(0), middle(1)], &[width(0), width(1)])
        };
        let thumb = THUMB.joints(&self.thumb, self.opposition);
        // Ball of the thumb, towards the middle of the palm.
        let middle = 0.5 * (joints[1][0] + joints[1][1]);
        let ball = [thumb[0], 0.5 * (thumb[1] + middle)];
        [
            finger(0),
            finger(1),
            finger(2),
            finger(3),
            palm(0),
            palm(1),
            palm(2),
            strand(&thumb[..4], &THUMB.diameters[..4]),
            strand(&ball, &[28.0, 24.0]),
        ]
    }

    fn check(&self) -> Result<()> {
        within("hand length", self.length, 0.05..=0.5, "m")?;
        within("thumb opposition", self.opposition, 0.0..=1.2, "rad")?;
        let fingers = [
            "index finger",
            "middle finger",
            "ring finger",
            "little finger",
        ];
        let names = fingers.into_iter().chain(["thumb"]);
        for (name, pose) in names.zip(self.fingers.iter().chain([&self.thumb])) {
            let place = |joint: &str| format!("{name}, {joint}");
            within(&place("spread"), pose.spread, -0.5..=0.5, "rad")?;
            within(&place("knuckle"), pose.knuckle, -0.5..=1.7, "rad")?;
            within(&place("middle joint"), pose.middle, -0.1..=2.0, "rad")?;
            within(&place("last joint"), pose.end, -0.1..=1.5, "rad")?;
        }
        Ok(())
    }
}

impl Digit {
    /// Returns the positions of the five joints of a digit, mm. Each bone is rotated down from the previous bone; the underside of a straight digit is on z =
    /// 0.
    fn joints(&self, pose: &FingerPose, opposition: f64) -> [DVec3; 5] {
        let [base_x, base_y] = self.base;
        let mut joints = [DVec3::new(base_x, base_y, 0.5 * self.diameters[0]); 5];
        let sideways = |angle: f64| DVec3::new(angle.sin(), angle.cos(), 0.0);
        // A metacarpal rotated under the palm points down by this angle.
        let mut forward = sideways(self.angle) * opposition.cos() - DVec3::Z * opposition.sin();
        let bends = [0.0, pose.knuckle, pose.middle, pose.end];
        for (bone, bend) in bends.into_iter().enumerate() {
            if bone == 1 {
                forward = DQuat::from_rotation_z(-pose.spread) * forward;
            }
            let hinge = sideways(self.angle + pose.spread)
                .cross(DVec3::Z)
                .normalize();
            forward = DQuat::from_axis_angle(hinge, -bend) * forward;
            // Straight digits become thinner towards their ends, so their joints become lower.
            let sinks = 0.5 * (self.diameters[bone] - self.diameters[bone + 1]);
            let length = self.bones[bone];
            let up = forward.cross(hinge).normalize();
            let level = (length * length - sinks * sinks).max(0.0).sqrt();
            joints[bone + 1] = joints[bone] + level * forward + sinks * up;
        }
        joints
    }
}

fn within(place: &str, value: f64, range: std::ops::RangeInclusive<f64>, unit: &str) -> Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    let allowed = format!("{} to {} {unit}", range.start(), range.end());
    Err(Error::input(place, format!("{value} {unit}"), allowed))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digits() -> impl Iterator<Item = &'static Digit> {
        FINGERS.iter().chain([&THUMB])
    }

    #[test]
    fn a_flat_hand_is_as_long_as_it_says_and_lies_on_the_plane() {
        let solid = Hand::flat().solid().unwrap();
        let bounds = solid.bounds();
        assert!((bounds.max.y - 0.189).abs() < 1e-3, "{bounds:?}");
        assert!(bounds.min.z.abs() < 1e-9, "{bounds:?}");
        for digit in digits() {
            let joints = digit.joints(&FingerPose::default(), 0.0);
            for (joint, diameter) in joints.iter().zip(digit.diameters) {
                assert!((joint.z - 0.5 * diameter).abs() < 1e-9, "{joint}");
            }
        }
    }

    #[test]
    fn bones_keep_their_lengths_in_every_pose() {
        for digit in digits() {
            for share in [0.0, 0.3, 0.7, 1.0] {
                let mut pose = Hand::curled(share).fingers[0];
                pose.spread = 0.3 * share;
                let joints = digit.joints(&pose, share);
                for (bone, length) in digit.bones.into_iter().enumerate() {
                    let found = joints[bone].distance(joints[bone + 1]);
                    assert!((found - length).abs() < 1e-9, "{found} for {length}");
                }
            }
        }
    }

    #[test]
    fn fingers_bend_downwards_and_a_fist_is_short() {
        let flat = Hand::flat().solid().unwrap().bounds();
        let fist = Hand::curled(1.0).solid().unwrap().bounds();
        assert!(fist.min.z < -0.02, "{fist:?}");
        assert!(fist.max.y < 0.7 * flat.max.y, "{fist:?}");
        let pointing = Hand::pointing().solid().unwrap().bounds();
        assert!(pointing.max.y > 0.16, "{pointing:?}");
    }

    #[test]
    fn a_joint_that_no_hand_has_is_refused() {
        let said = |hand: Hand| hand.solid().unwrap_err().to_string();
        let mut hand = Hand::flat();
        hand.fingers[2].middle = 2.5;
        let expected = "ring finger, middle joint: 2.5 rad; -0.1 to 2 rad";
        assert_eq!(said(hand), expected);
        let length = f64::NAN;
        let hand = Hand {
            length,
            ..Hand::flat()
        };
        assert!(said(hand).starts_with("hand length"));
    }
}
