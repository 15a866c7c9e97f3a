//! Presses of any patch on any objects: to a depth, a travel or a force along the patch's z axis, or at a given pose.
//!
//! A flat grid with equal radii and substrate heights is pressed row by row (`grid`), any other patch taxel by taxel (`tree`). The results of the two kernels
//! are equal up to rounding.

use super::grid::{OutputBuffer, Row, TravelGoal, force};
use super::press_summary::Contact;
use super::tree::{self, Approach};
use super::workspace::Workspace;
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{Patch, Taxels};

/// Condition that ends a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The patch presses at its given pose, without travel ([`press_at_pose`]).
    Pose,
    /// The patch travels to a depth past first contact, metres ([`press_to_depth`]).
    Depth(f64),
    /// The patch moves by a travel from the given pose, metres ([`press_to_travel`]).
    Travel(f64),
    /// The patch travels until the springs of all taxels together carry a force, newtons ([`press_to_force`]).
    Force(f64),
}

/// Presses a patch against objects until `goal` is reached. Returns `None`, with zero deflections, if the patch meets nothing on its path.
///
/// # Errors
/// If [`press_to_force`] fails.
///
/// # Panics
/// If the number of poses differs from the number of objects.
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
/// If [`press_to_force`] fails; the contents of `row` are then unspecified.
///
/// # Panics
/// If the number of poses differs from the number of objects, or `row` has not `n_taxels` elements.
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
///
/// # Panics
/// If the number of poses differs from the number of objects, or `zeros` has not `n_taxels` elements.
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
    assert_eq!(output.row.len(), patch.n_taxels(), "one number a taxel");
    let contact = to_goal(patch, placed, goal, (workspace, &mut output))?;
    match workspace.is_on_grid() {
        // Either the kernel has written the row, or nothing is touched.
        true => output.finish(),
        false => output.row.write(workspace.deflections()),
    }
    Ok(contact)
}

fn to_goal(
    patch: &Patch,
    placed: (&[Model], &[Pose]),
    goal: Goal,
    scratch: (&mut Workspace, &mut OutputBuffer),
) -> Result<Option<Contact>> {
    let until = match goal {
        Goal::Pose => TravelGoal::Pose,
        Goal::Depth(depth) => TravelGoal::Depth(depth),
        Goal::Travel(travel) => TravelGoal::Travel(travel),
        Goal::Force(force) => return to_force(patch, placed, force, scratch),
    };
    Ok(to_place(patch, placed, until, scratch))
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
    let first = approach.first_contact(objects, patch_from_objects);
    let travels = first.and_then(|first| match until {
        TravelGoal::Depth(depth) => Some([first, first + depth]),
        TravelGoal::Travel(travel) => (first < travel).then_some([first, travel]),
        TravelGoal::Pose => None,
    });
    let contact = approach.deflect(objects, patch_from_objects, travels, workspace);
    match until {
        TravelGoal::Travel(travel) => Some(Contact {
            travel,
            ..contact.unwrap_or_default()
        }),
        _ => contact,
    }
}

/// Returns the travel of the patch along its z axis at which the first taxel is touched, metres; negative if a taxel is touched already. Returns `None` if no
/// travel touches anything.
///
/// `patch_from_objects` contains one pose per object. The travel is computed in closed form: a taxel that travels along a line meets a sphere at a root of a
/// quadratic equation.
///
/// # Panics
/// If the number of poses differs from the number of objects.
pub fn first_contact(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut Workspace,
) -> Option<f64> {
    match patch.even_grid() {
        Some(grid) => {
            let until = TravelGoal::Depth(0.0);
            workspace
                .on_grid()
                .gather(grid, objects, patch_from_objects, until)
        }
        None => Approach::ahead(patch).first_contact(objects, patch_from_objects),
    }
}

/// Presses a patch against objects until it is `depth` metres past first contact. Returns `None`, with zero deflections, if the patch meets nothing.
///
/// The patch approaches from the front, and spheres push at any distance behind the taxels. Taxels pushed past their stroke are saturated. On a flat patch
/// the deflection of a taxel never decreases with the depth.
///
/// # Panics
/// If the number of poses differs from the number of objects.
pub fn press_to_depth(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    depth: f64,
    workspace: &mut Workspace,
) -> Option<Contact> {
    let placed = (objects, patch_from_objects);
    let scratch = (workspace, &mut OutputBuffer::none());
    to_place(patch, placed, TravelGoal::Depth(depth), scratch)
}

/// Presses a patch from the front until it has moved `travel` metres along its z axis from the given pose. The result equals [`press_to_depth`] at the depth
/// with this travel.
///
/// # Panics
/// If the number of poses differs from the number of objects.
pub fn press_to_travel(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    travel: f64,
    workspace: &mut Workspace,
) -> Contact {
    let placed = (objects, patch_from_objects);
    let scratch = (workspace, &mut OutputBuffer::none());
    to_place(patch, placed, TravelGoal::Travel(travel), scratch).unwrap_or_default()
}

/// Presses a patch until the sum of all spring forces equals `force` newtons. The relative error is at most 1e-12, or what rounding of the travel causes.
///
/// Returns `None`, with zero deflections, if the patch meets nothing. The travel of the patch may be negative. The result equals a press to the depth `travel
/// − first_contact`, where `first_contact` is the travel at first contact.
///
/// # Errors
/// If `force` is not a positive number or exceeds the largest force that the object can exert within the taxels' strokes. The message contains
/// this largest force and its travel.
///
/// # Panics
/// If the number of poses differs from the number of objects.
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
        _ => Approach::ahead(patch).press_to_force(objects, patch_from_objects, force, workspace),
    }
}

/// Presses a patch at its given pose as `press_with_contacts` does, but without recording contacts.
///
/// # Panics
/// If the number of poses differs from the number of objects.
pub fn press_at_pose(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut Workspace,
) -> Contact {
    let placed = (objects, patch_from_objects);
    let scratch = (workspace, &mut OutputBuffer::none());
    to_place(patch, placed, TravelGoal::Pose, scratch).unwrap_or_default()
}
