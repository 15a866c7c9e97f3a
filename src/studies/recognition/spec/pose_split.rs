//! Splits by pose: rules that select training and test poses, if the touches have listed pose values.
//!
//! Values are numbered in ascending order, regardless of their order in the study. Each trial holds out one part. The parts are held out in order. After the
//! last part, the first one follows again.
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
//! If the number of values is odd, the middle value belongs to the smaller half. `opposite_blocks` omits the touches that belong to neither block.

use crate::learning::data::split::Side;
use crate::studies::prelude::*;
use std::cmp::Ordering;

words! {
    /// Rule that selects the poses for testing and the poses for training.
    pub enum PoseSplit = Random {
        /// Test touches are drawn at random. On a grid of poses, most test touches then have neighbours among the training touches.
        Random = "random",
        /// One yaw angle per trial is held out for testing; each trial holds out the next yaw angle.
        LeaveOneYawOut = "leave_one_yaw_out",
        /// The touches with the larger half of the yaw angles are test touches in one trial; those with the smaller half in the next trial.
        HalfOfYaws = "half_of_yaws",
        /// Test touches are in one eighth of the ranges of offsets and yaws; training touches are in the opposite eighth.
        OppositeBlocks = "opposite_blocks",
        /// One tilt per trial is held out for testing; each trial holds out the next tilt.
        UnseenTilt = "unseen_tilt",
        /// One depth per trial is held out for testing; each trial holds out the next depth.
        UnseenDepth = "unseen_depth",
    }
}

/// Pose parameters whose values are divided into two halves to form blocks of poses.
const BLOCK: [TouchAxis; 3] = [TouchAxis::OffsetX, TouchAxis::OffsetY, TouchAxis::Yaw];

impl PoseSplit {
    /// Returns a phrase that describes which touches are held out for testing.
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

    /// Returns the rule that groups training touches for the inner cross-validation, which selects C and γ. Returns `None` if touches are drawn one by one.
    pub(crate) fn group(self) -> Option<GroupSpec> {
        match self {
            Self::Random | Self::OppositeBlocks => None,
            Self::LeaveOneYawOut | Self::HalfOfYaws => Some(GroupSpec::Yaw),
            Self::UnseenTilt => Some(GroupSpec::Tilt),
            Self::UnseenDepth => Some(GroupSpec::Depth),
        }
    }

    /// Returns the number of the block of poses that is tested in a trial; `None` if the split does not hold out blocks.
    pub(crate) fn tested_block(self, trial: usize) -> Option<usize> {
        (self == Self::OppositeBlocks).then_some(trial % (1 << BLOCK.len()))
    }

    /// Checks that the split rule can divide the given touches.
    ///
    /// # Errors
    /// If a required axis has drawn values or fewer than two listed values.
    pub(crate) fn check(self, touches: &[&Touch]) -> Result<()> {
        match self {
            Self::Random => Ok(()),
            _ => self.sides(touches, 0).map(drop),
        }
    }

    /// Returns the side of each touch in a trial: training, test, or left out.
    ///
    /// # Errors
    /// If a required axis has drawn values or fewer than two listed values.
    ///
    /// # Panics
    /// If the split is `random`, which does not depend on poses.
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
            // A block of one axis contains half of the values; the opposite block contains the other half.
            Self::HalfOfYaws => self.blocks(touches, &[TouchAxis::Yaw], trial),
            Self::OppositeBlocks => self.blocks(touches, &BLOCK, trial),
        }
    }

    /// Returns the side (training, test or left out) of each touch for a split by blocks of poses. Each bit of `trial` selects the tested half of one axis; 0 selects
    /// the larger values. Touches in the tested half of all axes are test touches. Touches in the tested half of no axis are training touches.
    fn blocks(self, touches: &[&Touch], axes: &[TouchAxis], trial: usize) -> Result<Vec<Side>> {
        let block = axes.len();
        // For each touch, the number of its values that lie in the tested halves.
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

    /// Returns the index of each touch's combination of values on `axes`, and the number of distinct combinations.
    fn numbered(self, touches: &[&Touch], axes: &[TouchAxis]) -> Result<(Vec<usize>, usize)> {
        let refused = |given: String| {
            let allowed = format!(
                "at least two listed values, of which {:?} can hold some out",
                self.word()
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
            keys.push(
                axes.iter()
                    .map(|&axis| touch.value(axis))
                    .collect::<Vec<f64>>(),
            );
        }
        let by_size = |a: &Vec<f64>, b: &Vec<f64>| {
            let mut orders = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
            orders
                .find(|order| order.is_ne())
                .unwrap_or(Ordering::Equal)
        };
        let mut distinct = keys.clone();
        distinct.sort_by(by_size);
        distinct.dedup_by(|a, b| by_size(a, b).is_eq());
        let place = |key: &Vec<f64>| distinct.partition_point(|other| by_size(other, key).is_lt());
        match distinct.len() {
            0 | 1 => Err(refused(format!("one {words}"))),
            n => Ok((keys.iter().map(place).collect(), n)),
        }
    }
}

words! {
    /// Property of touches that defines groups; all touches of a group are on one side of a split.
    pub enum GroupSpec {
        /// Touches with equal resting pose, offset, yaw and tilt form a group: the whole pose except the depth.
        Pose = "pose",
        /// Touches with equal offsets along x and y form a group.
        Offset = "offset",
        /// Touches with equal yaw of the object form a group.
        Yaw = "yaw",
        /// Touches with equal tilts about x and y form a group.
        Tilt = "tilt",
        /// Touches whose objects lie in equal stable resting poses form a group.
        Rest = "rest",
        /// Touches with equal press depth form a group.
        Depth = "depth",
    }
}
