//! Groups of touches that a split does not divide: touches with equal listed values or with similar drawn values.
//!
//! If the values are listed, touches with equal values on the grouping axes form a group, for any object.
//!
//! If the values are drawn uniformly, groups consist of neighbours. Two touches of an object are neighbours if their listed values are equal and, on *each*
//! axis, their drawn values differ by less than the stated distance. The yaws 359° and 1° differ by 2°. A group contains all touches that are connected by
//! neighbours (single linkage). Touches of different groups are therefore at least the stated distance apart on some axis. Touches of different objects are
//! never neighbours, because their labels differ.

use crate::studies::prelude::*;
use crate::studies::recognition::spec::GroupSpec;
use bubbletouch_sim::disjoint_sets::DisjointSets;
use ndarray::Array1;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Rule that forms groups of touches; all touches of a group are on one side of a split into training and test touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeepTogether {
    /// Pose parameters whose values define a group of touches.
    pub kind: GroupSpec,
    /// Distance below which two drawn offsets or depths are neighbours, metres, positive.
    pub metres: Option<f64>,
    /// Angle below which two drawn yaws or tilts are neighbours, radians, positive.
    pub radians: Option<f64>,
}

impl GroupSpec {
    /// Returns the pose parameters whose values define a group.
    pub(super) fn axes(self) -> &'static [TouchAxis] {
        use TouchAxis::{Depth, OffsetX, OffsetY, Rest, TiltX, TiltY, Yaw};
        match self {
            Self::Pose => &[Rest, OffsetX, OffsetY, Yaw, TiltX, TiltY],
            Self::Offset => &[OffsetX, OffsetY],
            Self::Yaw => &[Yaw],
            Self::Tilt => &[TiltX, TiltY],
            Self::Rest => &[Rest],
            Self::Depth => &[Depth],
        }
    }
}

impl KeepTogether {
    /// Returns the distance below which two drawn values of a pose parameter are neighbours, metres or radians.
    fn distance(&self, axis: TouchAxis) -> Result<f64> {
        let (distance, key) = match axis {
            TouchAxis::Yaw | TouchAxis::TiltX | TouchAxis::TiltY => {
                (self.radians, "recognition.group_by_deg")
            }
            _ => (self.metres, "recognition.group_by_mm"),
        };
        distance.ok_or_else(|| {
            let given = format!("left out, and {} is spread uniformly", axis.name());
            let allowed = "the distance below which touches are kept together (or listed values)";
            Error::input(format!("key {key}"), given, allowed)
        })
    }

    /// Returns the group number of each touch, in the order of the objects.
    ///
    /// # Errors
    /// If an axis is drawn and no distance is given for it.
    pub fn groups(&self, touched: &[&[Touch]]) -> Result<Array1<usize>> {
        let mut numbers = BTreeMap::new();
        let mut keys = Vec::new();
        for (object, touched) in touched.iter().enumerate() {
            let touches = *touched;
            let drawn = self.drawn(touches)?;
            // Without drawn axes, a group extends over all objects.
            let of_object = (!drawn.is_empty()).then_some(object);
            let listed = touches.iter().map(|touch| self.listed(touch));
            let listed: Vec<Vec<usize>> = listed.collect();
            for (first, listed) in connected(touches, &listed, &drawn).iter().zip(&listed) {
                let next = numbers.len();
                let key = (of_object, of_object.map(|_| *first), listed.clone());
                keys.push(*numbers.entry(key).or_insert(next));
            }
        }
        Ok(keys.into())
    }

    /// Returns the grouping parameters with randomly drawn values, each with the distance below which values are neighbours.
    fn drawn(&self, touches: &[Touch]) -> Result<Vec<(TouchAxis, f64)>> {
        let is_drawn = |axis: &&TouchAxis| {
            let mut indices = touches.iter().map(|touch| touch.indices[**axis as usize]);
            indices.any(|index| index.is_none())
        };
        let axes = self.kind.axes().iter().filter(is_drawn);
        axes.map(|&axis| Ok((axis, self.distance(axis)?))).collect()
    }

    /// Returns, for each grouping parameter with a list of values in the study, the index of the touch's value in the list.
    fn listed(&self, touch: &Touch) -> Vec<usize> {
        let axes = self.kind.axes().iter();
        let indices = axes.map(|&axis| touch.indices[axis as usize]);
        indices.flatten().collect()
    }
}

/// Returns the group number of each touch; touches with neighbouring poses are in one group. For each touch, returns the first touch of its connected
/// component.
fn connected(touches: &[Touch], listed: &[Vec<usize>], drawn: &[(TouchAxis, f64)]) -> Vec<usize> {
    let mut joined = DisjointSets::new(touches.len());
    let Some(&(along, distance)) = drawn.first() else {
        return joined.roots();
    };
    // After sorting along one axis, only touches within its distance are compared. A yaw is inserted a second time, one turn later.
    let mut order: Vec<(f64, usize)> = Vec::new();
    for (number, touch) in touches.iter().enumerate() {
        let value = touch.value(along);
        let turned = value.rem_euclid(TAU);
        match along {
            TouchAxis::Yaw if turned < distance => {
                order.extend([(turned, number), (turned + TAU, number)]);
            }
            TouchAxis::Yaw => order.push((turned, number)),
            _ => order.push((value, number)),
        }
    }
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (place, &(low, a)) in order.iter().enumerate() {
        let near = order[place + 1..].iter();
        for &(_, b) in near.take_while(|(high, _)| high - low < distance) {
            if listed[a] == listed[b] && are_neighbours(&touches[a], &touches[b], drawn) {
                joined.join(a, b);
            }
        }
    }
    joined.roots()
}

fn are_neighbours(a: &Touch, b: &Touch, drawn: &[(TouchAxis, f64)]) -> bool {
    let apart = |axis: TouchAxis| {
        let apart = (a.value(axis) - b.value(axis)).abs();
        match axis {
            TouchAxis::Yaw => {
                let turned = apart.rem_euclid(TAU);
                turned.min(TAU - turned)
            }
            _ => apart,
        }
    };
    drawn.iter().all(|&(axis, distance)| apart(axis) < distance)
}
