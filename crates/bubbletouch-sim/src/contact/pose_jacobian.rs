//! Derivatives of deflections with respect to the objects' poses, computed from the contact normals.
//!
//! A motion of the object in the patch frame consists of a translation dx of its origin o and a rotation dω about o. The motion changes the deflection of
//! contact i by `g·dx + ((p − o) × g)·dω`, where p is the contact point and g = −n_c / (n_c·n). The change of the travel of the patch depends on the goal:
//!
//! - pose or travel: the travel is constant;
//! - depth past first contact, on a flat patch: the deflection of the deepest taxel d is constant, so the derivative is `J_i − J_d`;
//! - force Σ k δ: the derivative is `J_i + r_i dT`, where the travel changes by `dT = −Σ k J / Σ k r` and r = −g_z is the change of a deflection per travel.
//!
//! The derivative of a saturated or untouched taxel is 0. If there are several objects, each contact moves with its
//! own object, and the travel changes with all of them.

use super::{TaxelContact, Until};
use crate::world::Patch;
use glam::DVec3;

/// Number of pose parameters: translation along x, y, z and rotation about x, y, z.
pub const POSE_PARAMETERS: usize = 6;

/// Writes the derivatives of all deflections of a press with respect to the poses of k objects into `changes`, shape (n_taxels, k, 6), initially 0. The
/// derivatives are per metre along x, y, z, and per radian about x, y, z through the origin of the object, in the axes of the patch. `contacts` are all contacts of
/// the press, and `origins` the positions of the k objects after the press, metres. If the press ends at a depth, the patch must be flat.
pub fn pose_jacobian(
    until: Until,
    patch: &Patch,
    (contacts, origins): (&[TaxelContact], &[DVec3]),
    changes: &mut [f64],
) {
    let change = |contact: &TaxelContact| {
        let gradient = contact.gradient();
        let turn = (contact.point - origins[contact.object]).cross(gradient);
        [gradient.x, gradient.y, gradient.z, turn.x, turn.y, turn.z]
    };
    let taxel = |contact: &TaxelContact| patch.taxels().at(contact.taxel);
    let moving = || {
        contacts
            .iter()
            .filter(|contact| !contact.is_saturated(taxel(contact)))
    };
    let rise = |contact: &TaxelContact| -contact.gradient().z;
    let mut travels = vec![[0.0; POSE_PARAMETERS]; origins.len()];
    match until {
        Until::Pose | Until::Travel(_) => {}
        Until::Depth(_) => {
            let deepest = contacts.iter().max_by(|a, b| a.needed.total_cmp(&b.needed));
            if let Some(deepest) = deepest {
                travels[deepest.object] = change(deepest).map(|change| -change);
            }
        }
        Until::Force(_) => {
            let mut rises = 0.0;
            for contact in moving() {
                let stiffness = taxel(contact).stiffness;
                rises += stiffness * rise(contact);
                let sums = &mut travels[contact.object];
                for (sum, change) in sums.iter_mut().zip(change(contact)) {
                    *sum += stiffness * change;
                }
            }
            for sum in travels.as_flattened_mut() {
                *sum = if rises > 0.0 { -*sum / rises } else { 0.0 };
            }
        }
    }
    let width = POSE_PARAMETERS * origins.len();
    for contact in moving() {
        let rise = rise(contact);
        let row = &mut changes[contact.taxel * width..][..width];
        for (object, travel) in travels.iter().enumerate() {
            let own = match object == contact.object {
                true => change(contact),
                false => [0.0; POSE_PARAMETERS],
            };
            let row = &mut row[object * POSE_PARAMETERS..][..POSE_PARAMETERS];
            for ((to, change), travel) in row.iter_mut().zip(own).zip(travel) {
                *to = change + rise * travel;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Press, Workspace};
    use crate::geometry::Pose;
    use crate::objects::{Model, Sphere, SphereUnion};
    use crate::world::{Grid, Taxel};
    use glam::DQuat;
    use std::slice::from_ref;

    #[test]
    fn the_derivatives_are_the_differences_of_presses_at_neighbouring_poses() {
        let (nx, ny, pitch) = (9, 9, 2e-3);
        let taxel = Taxel {
            radius: 1e-3,
            stiffness: 100.0,
            damping: 0.0,
            stroke: 5e-3,
        };
        let patch = Patch::grid(Grid { nx, ny, pitch }, taxel).unwrap();
        let ball = Sphere {
            center: DVec3::new(2e-3, 1e-3, 0.0),
            radius: 0.012,
        };
        let ball: Model = SphereUnion::new(vec![ball]).unwrap().into();
        let origin = DVec3::new(0.3e-3, -0.2e-3, 0.011);
        let goals = [
            Until::Pose,
            Until::Travel(1e-3),
            Until::Depth(2e-3),
            Until::Force(1.0),
        ];
        for until in goals {
            let press = |motion: [f64; POSE_PARAMETERS]| {
                let [x, y, z, about_x, about_y, about_z] = motion;
                let turn = DQuat::from_scaled_axis(DVec3::new(about_x, about_y, about_z));
                let pose = Pose::new(turn, origin + DVec3::new(x, y, z));
                let mut workspace = Workspace::new();
                let press = Press::new(&patch, from_ref(&ball), from_ref(&pose), until);
                let pressed = press.with_contacts().run(&mut workspace).unwrap();
                (pressed.unwrap().travel, workspace)
            };
            let (travel, workspace) = press([0.0; POSE_PARAMETERS]);
            let mut changes = vec![0.0; POSE_PARAMETERS * patch.n_taxels()];
            let origins = [origin - travel * DVec3::Z];
            let contacts = (workspace.contacts(), &origins[..]);
            pose_jacobian(until, &patch, contacts, &mut changes);
            for (row, deflection) in changes.chunks(POSE_PARAMETERS).zip(workspace.deflections()) {
                assert!(*deflection > 0.0 || row.iter().all(|change| *change == 0.0));
            }
            for parameter in 0..POSE_PARAMETERS {
                let step = 1e-7;
                let moved = |step: f64| {
                    let mut motion = [0.0; POSE_PARAMETERS];
                    motion[parameter] = step;
                    press(motion).1.deflections().to_vec()
                };
                let (after, before) = (moved(step), moved(-step));
                for contact in workspace
                    .contacts()
                    .iter()
                    .filter(|it| it.deflection > 1e-5)
                {
                    let taxel = contact.taxel;
                    let change = changes[taxel * POSE_PARAMETERS + parameter];
                    let difference = (after[taxel] - before[taxel]) / (2.0 * step);
                    assert!(
                        (change - difference).abs() < 1e-4 * change.abs().max(1.0),
                        "{until:?}, parameter {parameter}: {change}, {difference}"
                    );
                }
            }
        }
    }
}
