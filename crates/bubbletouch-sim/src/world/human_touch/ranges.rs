//! Ranges from which the parameters of a touch are drawn.

use super::TouchKind;
use crate::error::{Error, Result};
use std::ops::RangeInclusive;

/// Ranges of the parameters of a kind of touch, drawn uniformly. Parameters that a kind does not use are not drawn.
///
/// The default ranges were chosen for this project, except for the length of the hand.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchRanges {
    /// Length of the hand, metres; adults have 0.16 to 0.21 \[BK\].
    pub hand_length: RangeInclusive<f64>,
    /// Numbers of touching fingers: 1 to 4 are fingertips, 5 is the flat hand. The kinds shove (always the flat hand) and grab ignore this list.
    pub fingers: Vec<usize>,
    /// Position of the touch along the arm's axis, metres from the middle of the arm.
    pub along: RangeInclusive<f64>,
    /// Position of the touch around the arm, radians from +x.
    pub around: RangeInclusive<f64>,
    /// Angle from the direction across the arm to the fingers, positive towards the arm's axis, radians.
    pub yaw: RangeInclusive<f64>,
    /// Height of the hand above the skin at the start and the end of the touch, metres.
    pub clearance: RangeInclusive<f64>,
    /// Depth of the hand past first contact, metres.
    pub depth: RangeInclusive<f64>,
    /// Time from first contact to the largest depth, seconds; the withdrawal to first contact takes equally long.
    pub rise: RangeInclusive<f64>,
    /// Time that the hand stays at the largest depth, seconds.
    pub hold: RangeInclusive<f64>,
    /// Number of contacts; used by the kind pat.
    pub contacts: RangeInclusive<usize>,
    /// Height of the hand between contacts, metres; used by the kind pat.
    pub lift: RangeInclusive<f64>,
    /// Length of the path along the skin, metres; used by the kinds stroke and shove.
    pub travel: RangeInclusive<f64>,
    /// Mean speed along the skin, metres per second; used by the kinds stroke and shove.
    pub speed: RangeInclusive<f64>,
    /// Direction of the path, radians from the arm's axis; both directions along the arm are equally likely. Used by the kinds stroke and shove.
    pub direction: RangeInclusive<f64>,
    /// Time in which the fingers close, and also time in which they open, seconds; used by the kind grab.
    pub closing: RangeInclusive<f64>,
    /// Depth of each finger in the skin, metres; used by the kind grab.
    pub grip: RangeInclusive<f64>,
}

impl TouchRanges {
    /// Returns the default ranges of a kind of touch.
    pub fn usual(kind: TouchKind) -> Self {
        let tap = Self {
            hand_length: 0.165..=0.205,
            fingers: vec![1, 2, 3, 4, 5, 5],
            along: -0.025..=0.025,
            around: -1.0..=1.0,
            yaw: -0.6..=0.6,
            clearance: 0.015..=0.025,
            depth: 0.8e-3..=3e-3,
            rise: 0.04..=0.1,
            hold: 0.0..=0.2,
            contacts: 1..=1,
            lift: 0.0..=0.0,
            travel: 0.0..=0.0,
            speed: 0.1..=0.1,
            direction: 0.0..=0.0,
            closing: 0.3..=0.3,
            grip: 1e-3..=1e-3,
        };
        match kind {
            TouchKind::Tap => tap,
            TouchKind::Hold => Self {
                hold: 0.25..=1.6,
                ..tap
            },
            // Faster than the few cm/s that people rate as most pleasant, to keep the touch short.
            TouchKind::Stroke => Self {
                along: -0.01..=0.01,
                travel: 0.03..=0.09,
                speed: 0.06..=0.15,
                direction: -0.35..=0.35,
                hold: 0.0..=0.1,
                ..tap
            },
            TouchKind::Shove => Self {
                depth: 1.5e-3..=4.5e-3,
                rise: 0.05..=0.12,
                hold: 0.1..=0.5,
                travel: 0.01..=0.04,
                speed: 0.04..=0.12,
                direction: -1.5..=1.5,
                ..tap
            },
            TouchKind::Pat => Self {
                fingers: vec![3, 4, 5, 5, 5, 5],
                rise: 0.03..=0.07,
                hold: 0.0..=0.1,
                contacts: 2..=4,
                lift: 3e-3..=6e-3,
                ..tap
            },
            TouchKind::Grab => Self {
                yaw: -0.3..=0.3,
                depth: 0.5e-3..=2e-3,
                hold: 0.2..=1.0,
                closing: 0.2..=0.45,
                grip: 1e-3..=4e-3,
                ..tap
            },
        }
    }

    /// Returns an error unless every range is valid.
    ///
    /// # Errors
    /// If a range is empty, not finite, or outside the values for which a touch is defined; the error names the range.
    pub fn check(&self) -> Result<()> {
        let length = "lengths above 0 to 0.2 m, the smaller first";
        let seconds = "0.02 to 10 s, the shorter first";
        for (name, range, low, high, allowed) in [
            ("hand_length", &self.hand_length, 0.05, 0.5, "0.05 to 0.5 m"),
            ("along", &self.along, -10.0, 10.0, "-10 to 10 m"),
            ("around", &self.around, -3.2, 3.2, "-3.2 to 3.2 rad"),
            ("yaw", &self.yaw, -3.2, 3.2, "-3.2 to 3.2 rad"),
            ("clearance", &self.clearance, 1e-6, 0.2, length),
            ("depth", &self.depth, 1e-6, 0.2, length),
            ("rise", &self.rise, 0.02, 10.0, seconds),
            ("hold", &self.hold, 0.0, 60.0, "0 to 60 s"),
            ("lift", &self.lift, 0.0, 0.2, "0 to 0.2 m"),
            ("travel", &self.travel, 0.0, 1.0, "0 to 1 m"),
            ("speed", &self.speed, 1e-3, 2.0, "0.001 to 2 m/s"),
            ("direction", &self.direction, -3.2, 3.2, "-3.2 to 3.2 rad"),
            ("closing", &self.closing, 0.02, 10.0, seconds),
            ("grip", &self.grip, 1e-6, 0.2, length),
        ] {
            let (first, last) = (*range.start(), *range.end());
            // NaN fails every comparison.
            if !(low <= first && first <= last && last <= high) {
                let given = format!("{first} to {last}");
                return Err(Error::input(format!("range of {name}"), given, allowed));
            }
        }
        let (fewest, most) = (*self.contacts.start(), *self.contacts.end());
        if !(1 <= fewest && fewest <= most && most <= 100) {
            let given = format!("{fewest} to {most}");
            let place = "range of contacts";
            let allowed = "1 to 100, the fewer first";
            return Err(Error::input(place, given, allowed));
        }
        if most > 1 && *self.lift.start() <= 0.0 {
            let given = format!("{} m between contacts", self.lift.start());
            let allowed = "more than 0 where contacts repeat";
            return Err(Error::input("range of lift", given, allowed));
        }
        let wrong = self.fingers.iter().find(|&&n| !(1..=5).contains(&n));
        match (wrong, self.fingers.is_empty()) {
            (None, false) => Ok(()),
            (Some(n), _) => Err(Error::input("fingers", n, "1 to 4, or 5 for the flat hand")),
            (None, true) => Err(Error::input(
                "fingers",
                "none",
                "at least one number, 1 to 5",
            )),
        }
    }
}
