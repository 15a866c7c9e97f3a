//! Splits by pose: which poses are learned and which are tested, where touches have listed values.
//!
//! Values are numbered from the least to the largest, whatever their order in the study. A trial holds out one part, the next trial the
//! next, and after the last comes the first again:
//!
//! | `recognition.split` | tested | learned | parts |
//! |---|---|---|---|
//! | `random` | touches drawn at random | all others | |
//! | `leave_one_yaw_out` | one yaw | all other yaws | yaws |
//! | `half_of_yaws` | the larger half of the yaws; then the smaller | the other half | 2 |
//! | `opposite_blocks` | an eighth of the poses: a half of the offsets along x, of those along y, and of the yaws | the other half of each | 8 |
//! | `unseen_tilt` | one tilt (about x and y together) | all other tilts | tilts |
//! | `unseen_depth` | one depth | all other depths | depths |
//!
//! Of an odd number of values the middle one is of the smaller half. `opposite_blocks` leaves out what is in neither block.

use crate::error::{Error, Result};
use crate::learning::data::split::Side;
use crate::world::{Touch, TouchAxis};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Which poses a split holds out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PoseSplit {
    /// Touches drawn at random: on a grid of poses most have neighbours that are learned.
    #[default]
    Random,
    /// One yaw in turn.
    LeaveOneYawOut,
    /// The larger half of the yaws, then the smaller.
    HalfOfYaws,
    /// An eighth of offsets and yaws; the opposite eighth is learned.
    OppositeBlocks,
    /// One tilt in turn.
    UnseenTilt,
    /// One depth in turn.
    UnseenDepth,
}

/// The axes of which a block has half the values each.
const BLOCK: [TouchAxis; 3] = [TouchAxis::OffsetX, TouchAxis::OffsetY, TouchAxis::Yaw];

impl PoseSplit {
    /// As a study spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::LeaveOneYawOut => "leave_one_yaw_out",
            Self::HalfOfYaws => "half_of_yaws",
            Self::OppositeBlocks => "opposite_blocks",
            Self::UnseenTilt => "unseen_tilt",
            Self::UnseenDepth => "unseen_depth",
        }
    }

    /// What the test touches are, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Random => "random touches: most have neighbours in the pose that are learned",
            Self::LeaveOneYawOut => "one yaw in turn, which is never learned",
            Self::HalfOfYaws => "half of the yaws, none of which is learned",
            Self::OppositeBlocks => {
                "an eighth of offsets and yaws; only the opposite eighth is learned"
            }
            Self::UnseenTilt => "one tilt in turn, which is never learned",
            Self::UnseenDepth => "one depth in turn, which is never learned",
        }
    }

    /// What training touches are grouped by where they are split once more, to choose C or γ.
    pub(crate) fn group(self) -> Option<GroupSpec> {
        match self {
            Self::Random | Self::OppositeBlocks => None,
            Self::LeaveOneYawOut | Self::HalfOfYaws => Some(GroupSpec::Yaw),
            Self::UnseenTilt => Some(GroupSpec::Tilt),
            Self::UnseenDepth => Some(GroupSpec::Depth),
        }
    }

    /// The number of the block that a trial tests, of a split by blocks: all that it tests is near each other.
    pub(crate) fn tested_block(self, trial: usize) -> Option<usize> {
        (self == Self::OppositeBlocks).then_some(trial % (1 << BLOCK.len()))
    }

    /// Whether it can split these touches.
    ///
    /// # Errors
    /// Those of [`sides`](Self::sides).
    pub(crate) fn check(self, touches: &[&Touch]) -> Result<()> {
        match self {
            Self::Random => Ok(()),
            _ => self.sides(touches, 0).map(drop),
        }
    }

    /// The side of every touch in a trial.
    ///
    /// # Errors
    /// An axis that it goes by whose values are drawn, or of which there are fewer than two.
    ///
    /// # Panics
    /// Of [`Random`](Self::Random), which goes by no pose.
    pub(crate) fn sides(self, touches: &[&Touch], trial: usize) -> Result<Vec<Side>> {
        let number = |axes: &[TouchAxis]| self.numbered(touches, axes);
        let leave_one_out = |(numbers, n): (Vec<usize>, usize)| {
            let held_out = trial % n;
            let side = move |number: usize| match number == held_out {
                true => Side::Test,
                false => Side::Train,
            };
            numbers.into_iter().map(side).collect()
        };
        match self {
            Self::Random => unreachable!("a random split goes by no pose"),
            Self::LeaveOneYawOut => Ok(leave_one_out(number(&[TouchAxis::Yaw])?)),
            Self::UnseenTilt => {
                let tilts = number(&[TouchAxis::TiltX, TouchAxis::TiltY])?;
                Ok(leave_one_out(tilts))
            }
            Self::UnseenDepth => Ok(leave_one_out(number(&[TouchAxis::Depth])?)),
            // A block of one axis has half its values, and the opposite block the other half.
            Self::HalfOfYaws => self.blocks(touches, &[TouchAxis::Yaw], trial),
            Self::OppositeBlocks => self.blocks(touches, &BLOCK, trial),
        }
    }

    /// Test: all axes on the side that the trial says, bit by bit, the larger halves first. Train: all on the other.
    fn blocks(self, touches: &[&Touch], axes: &[TouchAxis], trial: usize) -> Result<Vec<Side>> {
        let block = axes.len();
        // Of each touch, how many of its values are in the halves that are tested.
        let mut n_tested = vec![0; touches.len()];
        for (bit, &axis) in axes.iter().enumerate() {
            let (numbers, n) = self.numbered(touches, &[axis])?;
            let is_larger_tested = (trial >> bit) & 1 == 0;
            for (tested, number) in n_tested.iter_mut().zip(numbers) {
                let is_larger = number >= n.div_ceil(2);
                *tested += usize::from(is_larger == is_larger_tested);
            }
        }
        let side = |n_tested: usize| match n_tested {
            0 => Side::Train,
            n if n == block => Side::Test,
            _ => Side::LeftOut,
        };
        Ok(n_tested.into_iter().map(side).collect())
    }

    /// Of each touch the number of its combination of values on some axes, and how many combinations there are.
    fn numbered(self, touches: &[&Touch], axes: &[TouchAxis]) -> Result<(Vec<usize>, usize)> {
        let refused = |given: String| {
            let allowed = format!(
                "at least two listed values, of which {:?} can hold some out",
                self.name()
            );
            Error::input("key recognition.split", given, allowed)
        };
        let words: Vec<&str> = axes.iter().map(|axis| axis.name()).collect();
        let words = words.join(" and ");
        let mut keys = Vec::with_capacity(touches.len());
        for touch in touches {
            touch
                .group(axes)
                .map_err(|_| refused(format!("{words} spread uniformly")))?;
            keys.push(axes.iter().map(|&axis| Value(touch.value(axis))).collect());
        }
        let distinct: BTreeSet<&Vec<Value>> = keys.iter().collect();
        let numbers: BTreeMap<&Vec<Value>, usize> = distinct.into_iter().zip(0..).collect();
        match numbers.len() {
            0 | 1 => Err(refused(format!("one {words}"))),
            n => Ok((keys.iter().map(|key| numbers[key]).collect(), n)),
        }
    }
}

/// A listed value, in order of size.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Value(f64);

impl Eq for Value {}

impl Ord for Value {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Value {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// What groups touches for a split that keeps groups together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GroupSpec {
    /// Rest pose, offset, yaw and tilt: everything but the depth.
    Pose,
    /// Both offsets.
    Offset,
    /// The yaw.
    Yaw,
    /// Both tilts.
    Tilt,
    /// The stable pose.
    Rest,
    /// The depth.
    Depth,
}
