//! Position that drives each joint, found through chains of mimicking joints.

use super::xml::Element;
use super::{Joint, Mimic};
use crate::error::{Error, Result};

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

/// Returns the source of the coordinates of each joint. A joint that mimics a fixed joint stays at its offset.
///
/// # Errors
/// If a mimic chain is a cycle or its numbers are too large. The error contains the line of a joint of the chain.
///
/// # Panics
/// If a joint mimics a joint of several coordinates.
pub(super) fn drives(joints: &[Joint], elements: &[Element]) -> Result<Vec<Drive>> {
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
            let followed = &joints[mimic.joint].kind;
            assert!(followed.coordinates().len() < 2, "one position to follow");
            drive.offset = mimic.multiplier * drive.offset + mimic.offset;
            drive.multiplier *= mimic.multiplier;
            if !(drive.multiplier.is_finite() && drive.offset.is_finite()) {
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
