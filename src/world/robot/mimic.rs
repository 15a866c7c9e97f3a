//! Which position drives each joint, through chains of joints that follow each other.

use super::xml::Element;
use super::{Joint, Mimic};
use crate::error::{Error, Result};

/// Where a joint's coordinates come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drive {
    /// Its own, from this index of the positions on; none for a fixed joint.
    Own {
        /// Index of the first.
        first: usize,
    },
    /// `multiplier · position + offset` of a single position.
    Follows {
        /// Index of the position.
        position: usize,
        /// Of the whole chain.
        multiplier: f64,
        /// Of the whole chain.
        offset: f64,
    },
}

/// The drive of each joint. The error, at a joint's element, is a chain that ends in itself, in a joint of no coordinate or
/// several, or in numbers that are too large.
pub(super) fn drives(joints: &[Joint], elements: &[Element]) -> Result<Vec<Drive>> {
    let mut known: Vec<Option<Drive>> = vec![None; joints.len()];
    let mut first = 0;
    for (joint, drive) in joints.iter().zip(&mut known) {
        if joint.mimic.is_none() {
            *drive = Some(Drive::Own { first });
            first += joint.kind.coordinates().len();
        }
    }
    let mut on_chain = vec![false; joints.len()];
    let mut drives = Vec::with_capacity(joints.len());
    for start in 0..joints.len() {
        let mut chain = Vec::new();
        let mut end = start;
        let mut drive = loop {
            match (known[end], joints[end].mimic) {
                (Some(drive), _) => break drive,
                (None, Some(mimic)) if !on_chain[end] => {
                    on_chain[end] = true;
                    chain.push((end, mimic));
                    end = mimic.joint;
                }
                _ => return Err(circle(&chain, end, joints, elements)),
            }
        };
        for (joint, mimic) in chain.into_iter().rev() {
            let element = &elements[joint];
            if !joints[mimic.joint].kind.has_one_coordinate() {
                let (name, followed) = (&joints[joint].name, &joints[mimic.joint].name);
                return Err(element.refuse(
                    format!("joint `{name}` mimics `{followed}`, which has not one coordinate"),
                    "a revolute, continuous or prismatic joint to follow",
                ));
            }
            drive = drive.followed(mimic.multiplier, mimic.offset);
            if !drive.is_finite() {
                let given = format!(
                    "joint `{}` mimics with numbers too large",
                    joints[joint].name
                );
                return Err(element.refuse(given, "a finite product along the chain"));
            }
            known[joint] = Some(drive);
        }
        drives.push(drive);
    }
    Ok(drives)
}

impl Drive {
    /// The drive of a joint that follows one with this drive.
    fn followed(self, multiplier: f64, offset: f64) -> Self {
        match self {
            Self::Own { first } => Self::Follows {
                position: first,
                multiplier,
                offset,
            },
            Self::Follows {
                position,
                multiplier: inner,
                offset: inner_offset,
            } => Self::Follows {
                position,
                multiplier: multiplier * inner,
                offset: multiplier * inner_offset + offset,
            },
        }
    }

    fn is_finite(self) -> bool {
        match self {
            Self::Own { .. } => true,
            Self::Follows {
                multiplier, offset, ..
            } => multiplier.is_finite() && offset.is_finite(),
        }
    }
}

fn circle(chain: &[(usize, Mimic)], end: usize, joints: &[Joint], elements: &[Element]) -> Error {
    let round = chain
        .iter()
        .map(|&(joint, _)| joint)
        .skip_while(|&joint| joint != end);
    let names: Vec<String> = round
        .chain([end])
        .map(|joint| format!("`{}`", joints[joint].name))
        .collect();
    elements[end].refuse(
        format!("joints mimic each other in a circle: {}", names.join(" → ")),
        "a chain that ends in a joint without <mimic>",
    )
}
