//! Presses: of any patch on any objects, to a depth, a travel or a force along its z axis, or right at a pose.
//!
//! A flat grid of taxels that go equally deep is pressed row by row (`grid`), any other patch taxel by taxel
//! (`tree`); what both can do is the same, to rounding.

use super::grid::{OutputBuffer, Row, TravelGoal, force};
use super::press_summary::Contact;
use super::tree::{self, Approach};
use super::workspace::Workspace;
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{Patch, Taxels};

/// What ends a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Nothing: [`press_at_pose`].
    Pose,
    /// Metres past first contact: [`press_to_depth`].
    Depth(f64),
    /// Metres from the pose: [`press_to_travel`].
    Travel(f64),
    /// Newtons that the springs carry: [`press_to_force`].
    Force(f64),
}

/// The press that a goal asks for; `None` (and zero deflections) where the patch meets nothing on its way.
///
/// # Errors
/// Those of [`press_to_force`].
///
/// # Panics
/// If there are not as many poses as objects.
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

/// The same press, whose deflections are written into a row, too: faster than a copy of them, where rows are many.
///
/// # Errors
/// Those of [`press_to_force`]; then nobody knows what is in the row.
///
/// # Panics
/// If there are not as many poses as objects, or the row has not one place a taxel.
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

/// The same press into a row of zeros. What nothing has come near is left alone: an array whose pages were never written costs nothing there.
///
/// # Errors
/// Those of [`press_into`].
///
/// # Panics
/// As [`press_into`].
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
        // Written there, or nothing is touched.
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

/// Presses to a pose, a travel or a depth; `None` if the goal is a depth and nothing is met.
fn to_place(
    patch: &Patch,
    (objects, patch_from_objects): (&[Model], &[Pose]),
    until: TravelGoal,
    (workspace, output): (&mut Workspace, &mut OutputBuffer),
) -> Option<Contact> {
    let by_rows = |workspace: &Workspace| match until {
        TravelGoal::Depth(_) | TravelGoal::Travel(_) => true,
        // At a pose a mesh may be behind some taxels, and what is held pushes from there.
        TravelGoal::Pose => {
            objects.iter().all(|object| object.spheres().is_some()) && !workspace.holds_any()
        }
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

/// How far the patch must travel along z until the first taxel is touched, metres (negative: it already is); `None` where no
/// travel would touch anything.
///
/// Poses are `patch_from_object`, one an object. Closed form: a taxel that travels along a line meets a sphere at a root.
///
/// # Panics
/// If there are not as many poses as objects.
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

/// Presses until the patch is `depth` metres past first contact; `None` (and zero deflections) where it meets nothing.
///
/// The patch comes from the front and all counts, however deep: past the stroke taxels are saturated. On a flat patch no taxel that is
/// touched at a depth is deflected less at a larger one.
///
/// # Panics
/// If there are not as many poses as objects.
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

/// Presses until the patch has moved `travel` metres along z from the pose given, from the front: the press of [`press_to_depth`]
/// with this travel.
///
/// # Panics
/// If there are not as many poses as objects.
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

/// Presses until the springs carry `force` newtons together, Σ k δ: to within 1e-12 of it, or to the last bit of the travel.
///
/// `None` (and zero deflections) where the patch meets nothing. The travel may be negative, as that of
/// [`press_to_depth`]: to the depth of this travel past [`first_contact`] it is the same press.
///
/// # Errors
/// A force that is not a positive number; one that is more than what the object can press into the taxels' strokes: the text
/// says the largest force, and its travel.
///
/// # Panics
/// If there are not as many poses as objects.
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

/// Presses as [`press_with_contacts`](super::press_with_contacts) does, without recording contacts.
///
/// # Panics
/// If there are not as many poses as objects.
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
