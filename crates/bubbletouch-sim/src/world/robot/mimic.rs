//! Position that drives each joint, found through chains of mimicking joints.

use super::Joint;
use super::tree::{chain_words, cycle};
use crate::error::{Error, Result};
use std::iter::successors;

/// Source of a joint's coordinates: its own positions, or `multiplier · position + offset` of the joint at the end of a chain of mimicking joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drive {
    /// Index of the first position of the joint at the end of the chain; unused if the multiplier is 0.
    pub position: usize,
    /// Multiplier of the whole chain; 1 for a joint that mimics no other joint, 0 if the chain ends at a fixed joint.
    pub multiplier: f64,
    /// Offset of the whole chain; 0 for a joint that mimics no other joint.
    pub offset: f64,
}

/// Returns the source of the coordinates of each joint. A joint that mimics a fixed joint stays at its offset. `place` returns the location of a joint for
/// messages.
///
/// # Errors
/// If a mimic chain is a cycle or its numbers are too large. The error contains the line of a joint of the chain.
///
/// # Panics
/// If a joint mimics a joint of several coordinates.
pub(super) fn drives(joints: &[Joint], place: impl Fn(usize) -> String) -> Result<Vec<Drive>> {
    let mut known: Vec<Option<Drive>> = vec![None; joints.len()];
    let mut first = 0;
    for (joint, drive) in joints.iter().zip(&mut known) {
        if joint.mimic.is_none() {
            let n_coordinates = joint.kind.coordinates().len();
            *drive = Some(Drive {
                position: first,
                multiplier: if n_coordinates == 0 { 0.0 } else { 1.0 },
                offset: 0.0,
            });
            first += n_coordinates;
        }
    }
    for start in 0..joints.len() {
        let unknown = |joint: usize| joints[joint].mimic.filter(|_| known[joint].is_none());
        let chain = successors(Some(start), |&joint| Some(unknown(joint)?.joint));
        let chain: Vec<usize> = chain.take(joints.len() + 1).collect();
        if chain.len() > joints.len() {
            let round = cycle(start, |joint| {
                joints[joint].mimic.map_or(joint, |m| m.joint)
            });
            let names = chain_words(&round, |joint| &joints[joint].name);
            let given = format!("joints mimic each other in a circle: {names}");
            let allowed = "a chain that ends in a joint without <mimic>";
            return Err(Error::input(place(round[0]), given, allowed));
        }
        for pair in chain.windows(2).rev() {
            let (joint, mimic) = (pair[0], joints[pair[0]].mimic.expect("a follower"));
            let followed = joints[mimic.joint].kind.coordinates();
            assert!(followed.len() < 2, "one position to follow");
            let mut drive = known[mimic.joint].expect("known from the end of the chain");
            drive.offset = mimic.multiplier * drive.offset + mimic.offset;
            drive.multiplier *= mimic.multiplier;
            if !(drive.multiplier.is_finite() && drive.offset.is_finite()) {
                let name = &joints[joint].name;
                let given = format!("joint `{name}` mimics with numbers too large");
                let allowed = "a finite product along the chain";
                return Err(Error::input(place(joint), given, allowed));
            }
            known[joint] = Some(drive);
        }
    }
    Ok(known.into_iter().flatten().collect())
}
