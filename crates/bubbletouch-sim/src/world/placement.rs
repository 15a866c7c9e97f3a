//! Placement of touches: pose of a patch relative to an object that rests on the table.
//!
//! The object rests in one of its poses with its bounding box centred at x = y = 0, turned by the yaw about the table's z. The
//! patch comes from above, facing down. The patch's axis passes through the offset (x, y) at the height of the object's top. At this point the
//! patch is tilted about its own x, then about its own y:
//!
//! patch_from_table = R_y(tilt_y)⁻¹ · R_x(tilt_x)⁻¹ · F · T(−offset_x, −offset_y, −height), F = half a turn about x.
//!
//! The travel of the patch along its own axis is determined by the contact stage: to first contact, then `depth` further.

use super::rest::{RestPose, as_modelled, stable_poses};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::Model;
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Rotation by half a turn about x, after which the patch's z points down. The components are constants, so that the rotation is exact.
const FACING_DOWN: DQuat = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);

/// Difference, metres or radians, below which two values of a coordinate count as one pose. The value is far below the resolution of any skin and far above
/// rounding. If larger, fine steps are merged; if smaller, 0.1 + 0.2 and 0.3 are two poses.
const SAME_POSE: f64 = 1e-9;

/// Values of one coordinate of a touch, in metres or radians: a list, or a uniform range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Spread {
    /// List of at least one value, all different.
    Values(Vec<f64>),
    /// Uniform distribution from `low` to `high`.
    Uniform {
        /// Smallest value of the range.
        low: f64,
        /// Largest value of the range, at least `low`.
        high: f64,
    },
}

/// Choice of the resting poses (stable poses on a table) in which an object is touched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RestPoses {
    /// The pose that the model has in its file, with the object's own z up.
    #[default]
    AsModelled,
    /// All stable resting poses on the table.
    Stable,
}

impl RestPoses {
    /// Returns the resting poses of an object that this choice selects.
    pub fn poses(self, object: &Model) -> Vec<RestPose> {
        match self {
            Self::AsModelled => vec![as_modelled(object)],
            Self::Stable => stable_poses(object),
        }
    }
}

/// Coordinate of a touch that a study can vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchAxis {
    /// Resting pose of the object.
    Rest,
    /// Offset of the patch along the x axis of the table.
    OffsetX,
    /// Offset of the patch along the y axis of the table.
    OffsetY,
    /// Yaw: rotation of the object about the z axis of the table.
    Yaw,
    /// Tilt of the patch about its own x axis.
    TiltX,
    /// Tilt of the patch about its own y axis.
    TiltY,
    /// Travel of the patch past first contact.
    Depth,
}

impl TouchAxis {
    /// Returns the name of the axis in study files and table headers, without its unit.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::OffsetX => "offset_x",
            Self::OffsetY => "offset_y",
            Self::Yaw => "yaw",
            Self::TiltX => "tilt_x",
            Self::TiltY => "tilt_y",
            Self::Depth => "depth",
        }
    }

    /// Returns the list of the given values without duplicates. If several values describe one pose, only the first value is kept. For example, the yaws 0
    /// and 2π describe one pose.
    pub fn listed(self, values: Vec<f64>) -> Spread {
        let mut first: Vec<usize> = (0..values.len()).collect();
        let pairs = self.same_poses(&values);
        // The pairs form chains of close values; two passes assign the first value of a chain to all its members.
        for &(one, other) in pairs.iter().chain(pairs.iter().rev()) {
            let earlier = first[one].min(first[other]);
            (first[one], first[other]) = (earlier, earlier);
        }
        let values = values.into_iter().zip(first).enumerate();
        let kept = values.filter(|(place, (_, first))| place == first);
        Spread::Values(kept.map(|(_, (value, _))| value).collect())
    }

    /// Returns pairs of indices of values that count as one pose. Two values count as one if they differ by less than [`SAME_POSE`], for yaws modulo a full
    /// turn.
    pub(super) fn same_poses(self, values: &[f64]) -> Vec<(usize, usize)> {
        let is_turn = self == Self::Yaw;
        let place = |value: f64| {
            if is_turn {
                value.rem_euclid(TAU)
            } else {
                value
            }
        };
        let values = values.iter().enumerate();
        let mut sorted: Vec<(f64, usize)> = values.map(|(n, &value)| (place(value), n)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let (true, Some(&(least, number))) = (is_turn, sorted.first()) {
            sorted.push((least + TAU, number));
        }
        let pairs = sorted.windows(2).map(|pair| (pair[0], pair[1]));
        let same = pairs.filter(|((a, n), (b, m))| n != m && b - a < SAME_POSE);
        same.map(|((_, n), (_, m))| (n, m)).collect()
    }
}

/// Rules for choosing the touches of an object, which the function `touches` applies.
///
/// - No uniform spread, no `per_object`: every combination of resting poses and values; the first [`TouchAxis`] varies slowest.
/// - No uniform spread, `per_object` given: this number of different combinations, drawn without replacement, all equally likely.
/// - A uniform spread: `per_object` touches, each drawn by its own number; resting poses are drawn by their probability.
///
/// Drawn touches are nested: the touches for a smaller `per_object` are the first touches for a larger value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Placement {
    /// Choice of the object's resting poses.
    pub rest: RestPoses,
    /// Range of the offset of the patch's axis along the x axis of the table, from the middle of the object's bounding box; metres.
    pub offset_x: Spread,
    /// Range of the offset of the patch's axis along the y axis of the table, from the middle of the object's bounding box; metres.
    pub offset_y: Spread,
    /// Range of the yaw, the rotation of the object about the z axis of the table; radians.
    pub yaw: Spread,
    /// Range of the patch's tilt about its own x axis; radians, less than a quarter turn in either direction.
    pub tilt_x: Spread,
    /// Range of the patch's tilt about its own y axis, after `tilt_x`; radians, less than a quarter turn in either direction.
    pub tilt_y: Spread,
    /// Range of the depth, the travel of the patch past first contact; metres, zero or positive.
    pub depth: Spread,
    /// Number of touches of each object; every combination if `None`.
    pub per_object: Option<usize>,
}

/// One touch of one object, given by resting pose, offsets, angles and depth.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    /// Index of the resting pose in the object's list of resting poses.
    pub rest: usize,
    /// Offset of the patch's axis at the height of the object's top, along table x and y, metres.
    pub offset: [f64; 2],
    /// Yaw: rotation of the object about the z axis of the table, radians.
    pub yaw: f64,
    /// Tilts of the patch about its own x axis, then about its own y axis, radians.
    pub tilt: [f64; 2],
    /// Depth: travel of the patch past first contact, metres.
    pub depth: f64,
    /// For each [`TouchAxis`], the index of the touch's value among the listed values; `None` if the values are a uniform range.
    pub indices: [Option<usize>; 7],
}

impl Placement {
    /// Returns the number of touches of an object with one resting pose.
    pub fn n_touches(&self) -> f64 {
        let n_values = |(_, spread): (_, &Spread)| match spread {
            Spread::Values(values) => values.len() as f64,
            Spread::Uniform { .. } => 1.0,
        };
        match self.per_object {
            Some(count) => count as f64,
            None => self.spreads().map(n_values).iter().product(),
        }
    }
}

impl Touch {
    /// Returns the group of this touch: the index of its value on each of the given axes. Data splits keep whole groups (an offset, a yaw, a resting pose)
    /// out of training.
    ///
    /// # Errors
    /// If the values of an axis are uniformly distributed, because no two touches share a value.
    pub fn group(&self, axes: &[TouchAxis]) -> Result<Vec<usize>> {
        let index = |axis: &TouchAxis| {
            self.indices[*axis as usize].ok_or_else(|| {
                Error::input(
                    "group of touches",
                    format!("{}, which is spread uniformly", axis.name()),
                    "axes with listed values, or rest",
                )
            })
        };
        axes.iter().map(index).collect()
    }

    /// Returns the coordinate of the touch on an axis, in SI units; for the resting pose its index.
    pub fn value(&self, axis: TouchAxis) -> f64 {
        match axis {
            TouchAxis::Rest => self.rest as f64,
            TouchAxis::OffsetX => self.offset[0],
            TouchAxis::OffsetY => self.offset[1],
            TouchAxis::Yaw => self.yaw,
            TouchAxis::TiltX => self.tilt[0],
            TouchAxis::TiltY => self.tilt[1],
            TouchAxis::Depth => self.depth,
        }
    }

    /// Returns the object's pose in the patch frame before the patch travels along its axis. If offsets and angles are zero, the top of the
    /// object's box lies in the plane z = 0, and the box is in front (z > 0).
    pub fn patch_from_object(&self, rest: &RestPose) -> Pose {
        let yawed = Pose::from_rotation(DQuat::from_rotation_z(self.yaw));
        let to_axis = DVec3::new(-self.offset[0], -self.offset[1], -rest.height);
        let tilt = DQuat::from_rotation_x(self.tilt[0]) * DQuat::from_rotation_y(self.tilt[1]);
        Pose::from_rotation(tilt.conjugate() * FACING_DOWN)
            .compose(&Pose::from_translation(to_axis))
            .compose(&yawed)
            .compose(&rest.table_from_object)
    }
}

impl Placement {
    /// Returns the values or range of each axis except the resting pose, in the order in which combinations are formed.
    pub fn spreads(&self) -> [(TouchAxis, &Spread); 6] {
        [
            (TouchAxis::OffsetX, &self.offset_x),
            (TouchAxis::OffsetY, &self.offset_y),
            (TouchAxis::Yaw, &self.yaw),
            (TouchAxis::TiltX, &self.tilt_x),
            (TouchAxis::TiltY, &self.tilt_y),
            (TouchAxis::Depth, &self.depth),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const REST: RestPose = RestPose {
        table_from_object: Pose::IDENTITY,
        height: 0.12,
        probability: 1.0,
    };

    fn touch() -> Touch {
        Touch {
            rest: 0,
            offset: [0.0; 2],
            yaw: 0.0,
            tilt: [0.0; 2],
            depth: 0.0,
            indices: [Some(0); 7],
        }
    }

    fn close(a: DVec3, b: DVec3) {
        assert!((a - b).length() < 1e-15, "{a} is not {b}");
    }

    #[test]
    fn the_zero_touch_flips_the_object_and_puts_its_top_in_the_taxel_plane() {
        let pose = touch().patch_from_object(&REST);
        let seen = pose.transform_point(DVec3::new(0.01, 0.02, 0.12));
        assert_eq!(seen, DVec3::new(0.01, -0.02, 0.0));
        let table = pose.transform_point(DVec3::ZERO);
        assert_eq!(table, DVec3::new(0.0, 0.0, 0.12));
    }

    #[test]
    fn the_offset_is_the_place_on_the_table_above_which_the_patch_stands() {
        let mut touch = touch();
        touch.offset = [0.03, -0.01];
        touch.yaw = 0.4;
        let pose = touch.patch_from_object(&REST);
        let yawed = DQuat::from_rotation_z(-0.4);
        let under_patch = yawed * DVec3::new(0.03, -0.01, 0.12);
        close(pose.transform_point(under_patch), DVec3::ZERO);
    }

    #[test]
    fn yaw_turns_the_object_counterclockwise_seen_from_above() {
        let mut touch = touch();
        touch.yaw = FRAC_PI_2;
        let pose = touch.patch_from_object(&REST);
        // The object's x points along table y, which is −y of the patch, because the patch is rotated about x by half a turn.
        close(pose.transform_vector(DVec3::X), DVec3::NEG_Y);
        close(pose.transform_vector(DVec3::Y), DVec3::NEG_X);
    }

    #[test]
    fn tilts_turn_the_patch_about_its_own_x_and_then_its_own_y() {
        let mut touch = touch();
        touch.offset = [0.03, -0.01];
        touch.tilt = [0.2, -0.1];
        let table_from_patch = touch.patch_from_object(&REST).inverse();
        let tilt = DQuat::from_rotation_x(0.2) * DQuat::from_rotation_y(-0.1);
        let axis = FACING_DOWN * (tilt * DVec3::Z);
        close(table_from_patch.transform_vector(DVec3::Z), axis);
        // The patch turns about its own centre.
        let center = table_from_patch.transform_point(DVec3::ZERO);
        close(center, DVec3::new(0.03, -0.01, 0.12));
    }

    #[test]
    fn listed_values_that_are_the_same_pose_are_one_value_the_first() {
        let listed = |axis: TouchAxis, values: &[f64]| match axis.listed(values.to_vec()) {
            Spread::Values(values) => values,
            Spread::Uniform { .. } => unreachable!(),
        };
        let half = std::f64::consts::PI;
        let yaws = [-half, 1.0, half, 0.0, TAU, 1.0 - TAU, 3.0 * half, -1e-12];
        assert_eq!(listed(TouchAxis::Yaw, &yaws), [-half, 1.0, 0.0]);
        // Chain of neighbouring values, out of order.
        let close = [2e-10, 1e-3, -2e-10, 0.0];
        assert_eq!(listed(TouchAxis::Depth, &close), [2e-10, 1e-3]);
        let sums = [0.1 + 0.2, 0.3];
        assert_eq!(listed(TouchAxis::OffsetX, &sums), [0.1 + 0.2]);
        // For lengths a full turn is not zero.
        assert_eq!(listed(TouchAxis::OffsetX, &[0.0, TAU]), [0.0, TAU]);
        assert_eq!(listed(TouchAxis::Yaw, &[0.0, 1e-6]), [0.0, 1e-6]);
    }
}
