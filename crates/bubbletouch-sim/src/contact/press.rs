//! Presses of any patch on any objects: to a depth, a travel or a force along the patch's z axis, or at a given pose.
//!
//! A flat grid with equal radii and substrate heights is pressed row by row (`grid`), any other patch taxel by taxel (`tree`). The results of the two kernels
//! are equal up to rounding.

use super::checks::check_output;
use super::grid::{OutputBuffer, Row, TravelGoal, force};
use super::press_summary::Contact;
use super::tree::{self, Approach};
use super::workspace::Workspace;
use crate::error::Result;
use crate::geometry::{Pose, check_poses};
use crate::objects::Model;
use crate::world::{Patch, Taxels};

/// Condition that ends a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The patch presses at its given pose, without travel ([`press_at_pose`]).
    Pose,
    /// The patch travels to a depth past first contact, metres, zero or positive ([`press_to_depth`]).
    Depth(f64),
    /// The patch moves by a travel from the given pose, metres ([`press_to_travel`]).
    Travel(f64),
    /// The patch travels until the springs of all taxels together carry a force, newtons, positive ([`press_to_force`]).
    Force(f64),
}

/// Presses a patch against objects until `goal` is reached. Returns `None`, with zero deflections, if the patch meets nothing.
///
/// A press to a depth or a force meets nothing if no travel touches anything. A press at a pose or to a travel meets nothing if no taxel is touched there.
///
/// # Errors
/// If there is not one pose for each object, a pose is not finite or has no unit quaternion, or the number of the goal is out of its range ([`Goal`]). If
/// the force exceeds the largest possible force, as in [`press_to_force`].
pub fn press(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    goal: Goal,
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    let placed = (objects, patch_from_objects);
    to_goal(patch, placed, goal, (workspace, &mut OutputBuffer::none()))
}

/// Presses a patch against objects until `goal` is reached and writes the deflections into `row`, which is faster than copying them afterwards.
///
/// # Errors
/// If [`press`] fails; the contents of `row` are then unspecified. If `row` has not `n_taxels` elements.
pub fn press_into(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    goal: Goal,
    row: Row,
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    let placed = (objects, patch_from_objects);
    press_with_output(patch, placed, goal, (workspace, OutputBuffer::new(row)))
}

/// Presses a patch against objects until `goal` is reached and writes the deflections into a row of zeros. Taxels far from all objects are not written, so
/// memory pages of the array that were never written cost nothing.
///
/// # Errors
/// If [`press_into`] fails.
pub fn press_onto_zeros(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    goal: Goal,
    zeros: Row,
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    let placed = (objects, patch_from_objects);
    press_with_output(
        patch,
        placed,
        goal,
        (workspace, OutputBuffer::from_zeros(zeros)),
    )
}

fn press_with_output(
    patch: &Patch,
    placed: (&[Model], &[Pose]),
    goal: Goal,
    (workspace, mut output): (&mut Workspace, OutputBuffer),
) -> Result<Option<Contact>> {
    check_output(output.row.len(), patch.n_taxels())?;
    let contact = to_goal(patch, placed, goal, (workspace, &mut output))?;
    match workspace.is_on_grid() {
        // Either the kernel has written the row, or nothing is touched.
        true => output.finish(),
        false => output.row.write(workspace.deflections()),
    }
    Ok(contact)
}

/// Checks the numbers of a press, and presses.
fn to_goal(
    patch: &Patch,
    placed: (&[Model], &[Pose]),
    goal: Goal,
    scratch: (&mut Workspace, &mut OutputBuffer),
) -> Result<Option<Contact>> {
    check_poses("object", placed.0.len(), placed.1)?;
    goal.check()?;
    let until = match goal {
        Goal::Pose => TravelGoal::Pose,
        Goal::Depth(depth) => TravelGoal::Depth(depth),
        Goal::Travel(travel) => TravelGoal::Travel(travel),
        Goal::Force(force) => return to_force(patch, placed, force, scratch),
    };
    let contact = to_place(patch, placed, until, scratch);
    let is_depth = matches!(goal, Goal::Depth(_));
    Ok(contact.filter(|contact| is_depth || contact.n_touched > 0))
}

/// Presses the patch at its pose, to a travel or to a depth. Returns `None` if the goal is a depth and the patch meets nothing.
fn to_place(
    patch: &Patch,
    (objects, patch_from_objects): (&[Model], &[Pose]),
    until: TravelGoal,
    (workspace, output): (&mut Workspace, &mut OutputBuffer),
) -> Option<Contact> {
    let by_rows = |workspace: &Workspace| match until {
        TravelGoal::Depth(_) | TravelGoal::Travel(_) => true,
        // Held parts can also touch taxels from behind the substrate.
        TravelGoal::Pose => !workspace.holds_any(),
    };
    if let Some(grid) = patch.even_grid()
        && by_rows(workspace)
    {
        let press = workspace.on_grid();
        let first = press.gather(grid, objects, patch_from_objects, until);
        let travel = match (until, first) {
            (TravelGoal::Pose, _) => 0.0,
            (TravelGoal::Travel(travel), _) => travel,
            (TravelGoal::Depth(depth), Some(first)) => first + depth,
            (TravelGoal::Depth(_), None) => {
                press.touch_nothing(grid);
                return None;
            }
        };
        return Some(press.indent(grid, travel, output));
    }
    if let TravelGoal::Pose = until {
        return Some(tree::deflect(patch, objects, patch_from_objects, workspace));
    }
    let approach = Approach::ahead(patch);
    let first = approach.meets(objects, patch_from_objects);
    let travels = first.and_then(|first| match until {
        TravelGoal::Depth(depth) => Some([first, first + depth]),
        TravelGoal::Travel(travel) => (first < travel).then_some([first, travel]),
        TravelGoal::Pose => None,
    });
    approach.deflect(objects, patch_from_objects, travels, workspace)
}

/// Returns the travel of the patch along its z axis at which the first taxel is touched, metres; negative if a taxel is touched already. Returns `None` if no
/// travel touches anything.
///
/// `patch_from_objects` contains one pose per object. The travel is computed in closed form: a taxel that travels along a line meets a sphere at a root of a
/// quadratic equation.
///
/// # Errors
/// If the poses are invalid, as in [`press`].
pub fn first_contact(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut Workspace,
) -> Result<Option<f64>> {
    check_poses("object", objects.len(), patch_from_objects)?;
    Ok(match patch.even_grid() {
        Some(grid) => {
            let until = TravelGoal::Depth(0.0);
            workspace
                .on_grid()
                .gather(grid, objects, patch_from_objects, until)
        }
        None => Approach::ahead(patch).meets(objects, patch_from_objects),
    })
}

/// Presses a patch against objects until it is `depth` metres past first contact. Returns `None`, with zero deflections, if the patch meets nothing.
///
/// The patch approaches from the front, and spheres push at any distance behind the taxels. Taxels pushed past their stroke are saturated. On a flat patch
/// the deflection of a taxel never decreases with the depth.
///
/// # Errors
/// If the depth is negative or not finite, or the poses are invalid, as in [`press`].
pub fn press_to_depth(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    depth: f64,
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    let goal = Goal::Depth(depth);
    press(patch, objects, patch_from_objects, goal, workspace)
}

/// Presses a patch from the front until it has moved `travel` metres along its z axis from the given pose. The result equals [`press_to_depth`] at the depth
/// with this travel. Returns `None`, with zero deflections, if no taxel is touched.
///
/// # Errors
/// If the travel is not finite, or the poses are invalid, as in [`press`].
pub fn press_to_travel(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    travel: f64,
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    let goal = Goal::Travel(travel);
    press(patch, objects, patch_from_objects, goal, workspace)
}

/// Presses a patch until the sum of all spring forces equals `force` newtons. The relative error is at most 1e-12, or what rounding of the travel causes.
///
/// Returns `None`, with zero deflections, if the patch meets nothing. The travel of the patch may be negative. The result equals a press to the depth `travel
/// − first_contact`, where `first_contact` is the travel at first contact.
///
/// # Errors
/// If `force` is not a positive number or exceeds the largest force that the object can exert within the taxels' strokes. The message contains
/// this largest force and its travel. If the poses are invalid, as in [`press`].
///
/// ```
/// use bubbletouch_sim::contact::{Workspace, press_to_force};
/// use bubbletouch_sim::geometry::Pose;
/// use bubbletouch_sim::objects::{Sphere, SphereUnion};
/// use bubbletouch_sim::world::{Grid, Patch, Taxel};
/// use glam::DVec3;
///
/// let grid = Grid { nx: 32, ny: 32, pitch: 2e-3 };
/// let taxel = Taxel { radius: 1e-3, stiffness: 100.0, damping: 0.0, stroke: 5e-3 };
/// let patch = Patch::grid(grid, taxel)?;
/// let ball = Sphere { center: DVec3::new(0.0, 0.0, 0.1), radius: 0.03 };
/// let objects = [SphereUnion::new(vec![ball])?.into()];
/// let mut workspace = Workspace::new();
/// let contact = press_to_force(&patch, &objects, &[Pose::IDENTITY], 5.0, &mut workspace)?;
/// assert!(contact.is_some(), "the ball is over the patch");
/// let force = taxel.stiffness * workspace.deflections().iter().sum::<f64>();
/// assert!((force - 5.0).abs() < 5e-12);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
pub fn press_to_force(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    force: f64,
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    let goal = Goal::Force(force);
    press(patch, objects, patch_from_objects, goal, workspace)
}

fn to_force(
    patch: &Patch,
    (objects, patch_from_objects): (&[Model], &[Pose]),
    force: f64,
    (workspace, output): (&mut Workspace, &mut OutputBuffer),
) -> Result<Option<Contact>> {
    match (patch.even_grid(), patch.taxels()) {
        (Some(grid), Taxels::Equal(taxel)) => force::press(
            (grid, taxel.stiffness),
            objects,
            patch_from_objects,
            force,
            (workspace.on_grid(), output),
        ),
        _ => Approach::ahead(patch).to_force(objects, patch_from_objects, force, workspace),
    }
}

/// Presses a patch at its given pose as [`press_with_contacts`] does, but without recording contacts.
///
/// # Errors
/// If the poses are invalid, as in [`press`].
pub fn press_at_pose(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    press(patch, objects, patch_from_objects, Goal::Pose, workspace)
}

/// Presses a patch on objects at their given poses and records the contacts; `patch_from_objects` contains one pose per object. Returns `None`, with zero
/// deflections and without contacts, if no taxel is touched.
///
/// Parts of objects behind the substrate of a taxel do not push this taxel (rule in the module `contact`). An object below a forearm therefore does not
/// press the taxels on the upper side. A part that is pushed far past the stroke is also behind the substrate. Only a press to a depth includes such parts,
/// because its path is known. One part determines each deflection. If several parts require equal deflections, the first sphere of the first object
/// determines the deflection.
///
/// A free object at rest often lies on taxels that two of its parts push equally far, such as two faces of a valley. Their shares of the force are needed for the balance;
/// [`EquilibriumSolver::loads`](crate::contact::equilibrium::EquilibriumSolver::loads) contains them.
///
/// ```
/// use bubbletouch_sim::contact::{Workspace, press_with_contacts, spring_load};
/// use bubbletouch_sim::geometry::Pose;
/// use bubbletouch_sim::objects::{Sphere, SphereUnion};
/// use bubbletouch_sim::world::{Layout, Patch, Taxel, Taxels};
/// use glam::DVec3;
///
/// // A fingertip: half a ball of 8 mm with a taxel every 1.5 mm.
/// let layout = Layout::sphere_cap(8e-3, std::f64::consts::FRAC_PI_2, 1.5e-3)?;
/// let taxel = Taxel { radius: 0.5e-3, stiffness: 100.0, damping: 0.0, stroke: 2e-3 };
/// let fingertip = Patch::new("fingertip", layout, Taxels::Equal(taxel))?;
///
/// // A marble presses half a millimetre deep, from the side.
/// let marble = Sphere { center: DVec3::ZERO, radius: 8e-3 };
/// let objects = [SphereUnion::new(vec![marble])?.into()];
/// let pose = Pose::from_translation(16e-3 * DVec3::new(0.6, 0.0, 0.8));
/// let mut workspace = Workspace::new();
/// let counts = press_with_contacts(&fingertip, &objects, &[pose], &mut workspace)?;
/// assert!(counts.is_some_and(|counts| counts.n_touched > 3 && counts.n_saturated == 0));
///
/// // The force on the marble points back along its approach.
/// let load = spring_load(&fingertip, workspace.contacts());
/// let force = load.on_object.force;
/// assert!(force.normalize().dot(DVec3::new(0.6, 0.0, 0.8)) > 0.95);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
///
/// # Errors
/// If the poses are invalid, as in [`press`].
pub fn press_with_contacts(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    check_poses("object", objects.len(), patch_from_objects)?;
    let contact = tree::deflect_with_contacts(patch, objects, patch_from_objects, workspace);
    Ok(Some(contact).filter(|contact| contact.n_touched > 0))
}
