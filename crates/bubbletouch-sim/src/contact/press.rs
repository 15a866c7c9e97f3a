//! Presses of any patch on any objects: at a given pose, or along a direction to a travel, a depth or a force.
//!
//! A flat grid with equal radii and substrate heights that travels along its axis is pressed row by row (`grid`). Any other patch, and a press that records
//! contacts, is evaluated taxel by taxel (`tree`). The results of the two kernels are equal up to rounding.

use super::FrictionState;
use super::grid::{GridPress, OutputBuffer, Row, force};
use super::press_summary::Contact;
use super::tree::Path;
use super::workspace::Workspace;
use crate::error::{Error, Result};
use crate::geometry::{Pose, check_poses};
use crate::objects::Model;
use crate::text::in_range::{finite, not_negative, positive};
use crate::world::{EvenGrid, Patch, Taxels};
use glam::DVec3;

/// Condition that ends a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Until {
    /// The patch presses at its given pose, without travel.
    ///
    /// Parts of objects behind the substrate of a taxel do not push this taxel (rule in the module `contact`). An object below a forearm therefore does not
    /// press the taxels on the upper side. A part that is pushed far past the stroke is also behind the substrate. Only a press along a path includes such
    /// parts, because its path is known.
    Pose,
    /// The patch travels to a depth past first contact, metres, zero or positive. The travel of a press to depth 0 is the travel at first contact.
    Depth(f64),
    /// The patch moves by a travel from the given pose, metres. The result equals a press to the depth with this travel.
    Travel(f64),
    /// The patch travels until the springs of all taxels together carry a force, newtons, positive. The relative error is at most 1e-12, or what rounding of
    /// the travel causes. The result equals a press to the travel found, which may be negative.
    ///
    /// On a curved skin several travels can have this force; the first travel found by steps of half a stroke is returned. The total force can jump past the
    /// given force if an edge meets a taxel from the side. The side of the jump with the larger force is then returned.
    Force(f64),
}

/// Selection of what a press records in the workspace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// Only the deflections of the taxels.
    Deflections,
    /// Also the contacts of the touched taxels.
    ///
    /// One part determines each deflection. If several parts require equal deflections, the first sphere of the first object determines the deflection. A
    /// free object at rest often lies on taxels that two of its parts push equally far, such as two faces of a valley. Their shares of the force are needed
    /// for the balance; [`EquilibriumSolver::loads`](crate::contact::equilibrium::EquilibriumSolver::loads) contains them.
    Contacts,
}

/// Request of a press: a patch is pressed against objects until a condition is met.
///
/// A press along a path comes from the front, and parts of objects push at any distance behind the taxels. On a flat patch the deflection of a taxel
/// therefore never decreases with the depth. On a curved patch the path is divided into steps. An object that pushes a taxel continues to push this taxel
/// even from behind the substrate, so no object can pass through the skin.
///
/// ```
/// use bubbletouch_sim::contact::{Press, Until, Workspace, spring_load};
/// use bubbletouch_sim::geometry::Pose;
/// use bubbletouch_sim::objects::{Sphere, SphereUnion};
/// use bubbletouch_sim::world::{Grid, Layout, Patch, Taxel, Taxels};
/// use glam::DVec3;
///
/// let grid = Grid { nx: 32, ny: 32, pitch: 2e-3 };
/// let taxel = Taxel { radius: 1e-3, stiffness: 100.0, damping: 0.0, stroke: 5e-3 };
/// let patch = Patch::grid(grid, taxel)?;
/// let ball = Sphere { center: DVec3::new(0.0, 0.0, 0.1), radius: 0.03 };
/// let objects = [SphereUnion::new(vec![ball])?.into()];
/// let mut workspace = Workspace::new();
/// let press = Press::new(&patch, &objects, &[Pose::IDENTITY], Until::Force(5.0));
/// assert!(press.run(&mut workspace)?.is_some(), "the ball is over the patch");
/// let force = taxel.stiffness * workspace.deflections().iter().sum::<f64>();
/// assert!((force - 5.0).abs() < 5e-12);
///
/// // A fingertip: half a ball of 8 mm with a taxel every 1.5 mm. A marble presses half a millimetre deep, from the side.
/// let layout = Layout::sphere_cap(8e-3, std::f64::consts::FRAC_PI_2, 1.5e-3)?;
/// let taxel = Taxel { radius: 0.5e-3, stiffness: 100.0, damping: 0.0, stroke: 2e-3 };
/// let fingertip = Patch::new("fingertip", layout, Taxels::Equal(taxel))?;
/// let marble = Sphere { center: DVec3::ZERO, radius: 8e-3 };
/// let objects = [SphereUnion::new(vec![marble])?.into()];
/// let poses = [Pose::from_translation(16e-3 * DVec3::new(0.6, 0.0, 0.8))];
/// let press = Press::new(&fingertip, &objects, &poses, Until::Pose);
/// let counts = press.with_contacts().run(&mut workspace)?;
/// assert!(counts.is_some_and(|counts| counts.n_touched > 3 && counts.n_saturated == 0));
///
/// // The force on the marble points back along its approach.
/// let load = spring_load(&fingertip, workspace.contacts());
/// let force = load.on_object.force;
/// assert!(force.normalize().dot(DVec3::new(0.6, 0.0, 0.8)) > 0.95);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Press<'a> {
    /// Patch that moves.
    pub patch: &'a Patch,
    /// Objects that the patch meets.
    pub objects: &'a [Model],
    /// Poses `patch_from_object` of the objects before the motion, one per object.
    pub poses: &'a [Pose],
    /// Direction of travel, unit vector in the patch frame.
    pub along: DVec3,
    /// Condition that ends the press.
    pub until: Until,
    /// Selection of what the press records.
    pub record: Record,
}

impl<'a> Press<'a> {
    /// Creates a press along the patch's z axis that records deflections only.
    pub fn new(patch: &'a Patch, objects: &'a [Model], poses: &'a [Pose], until: Until) -> Self {
        Self {
            patch,
            objects,
            poses,
            along: DVec3::Z,
            until,
            record: Record::Deflections,
        }
    }

    /// Returns the press that also records the contacts of the touched taxels.
    pub fn with_contacts(self) -> Self {
        Self {
            record: Record::Contacts,
            ..self
        }
    }

    /// Returns the press along another direction, a unit vector in the patch frame.
    pub fn along(self, along: DVec3) -> Self {
        Self { along, ..self }
    }

    /// Presses the patch; the workspace then contains the deflections. Returns `None` if the patch meets nothing; deflections and contacts are then
    /// unspecified if the goal is a force, otherwise they are zero and empty.
    ///
    /// A press to a depth or a force meets nothing if no travel touches anything. A press at a pose or to a travel meets nothing if no taxel is touched there.
    ///
    /// # Errors
    /// If there is not one pose for each object, a pose is not finite or has no unit quaternion, `along` is not a unit vector, or the number of the goal is
    /// out of its range ([`Until`]). If the force exceeds the largest force on the path past the objects; the message contains this largest force and its
    /// travel.
    pub fn run(&self, workspace: &mut Workspace) -> Result<Option<Contact>> {
        self.run_with(workspace, None)
    }

    /// Presses the patch and writes the deflections into `row`, which is faster than copying them afterwards.
    ///
    /// # Errors
    /// If [`run`](Self::run) fails; the contents of `row` are then unspecified. If `row` has not `n_taxels` elements.
    pub fn write(&self, row: Row, workspace: &mut Workspace) -> Result<Option<Contact>> {
        self.write_with(OutputBuffer::new(row), workspace)
    }

    /// Presses the patch and writes the deflections into a row of zeros. Taxels far from all objects are not written, so memory pages of the array that were
    /// never written cost nothing.
    ///
    /// # Errors
    /// If [`write`](Self::write) fails.
    pub fn write_onto_zeros(
        &self,
        zeros: Row,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        self.write_with(OutputBuffer::from_zeros(zeros), workspace)
    }

    /// Presses the patch and then slides it along a straight line (metres, in the patch frame); contacts are recorded. With friction, the objects drag the
    /// taxels sideways. The friction is zero at the start of the path; `friction` then contains the forces at the end of the path. If the patch meets
    /// nothing, returns `None`, with zero deflections.
    ///
    /// # Errors
    /// If [`run`](Self::run) fails or the slide is not finite. If the friction belongs to a patch with another number of taxels.
    pub fn slide(
        &self,
        slide: DVec3,
        friction: Option<&mut FrictionState>,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        self.check()?;
        if !slide.is_finite() {
            return Err(Error::input(
                "slide",
                format!("{slide} m"),
                "finite numbers",
            ));
        }
        if let Some(friction) = &friction {
            check_output(friction.force3().len(), self.patch.n_taxels())?;
        }
        let press = self.with_contacts();
        let travels = Path::new(&press, workspace).travels()?;
        Ok(Path::new(&press, workspace).steps(travels, slide, friction))
    }

    fn write_with(
        &self,
        mut output: OutputBuffer,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        check_output(output.row.len(), self.patch.n_taxels())?;
        self.run_with(workspace, Some(&mut output))
    }

    fn check(&self) -> Result<()> {
        check_poses("object", self.objects.len(), self.poses)?;
        check_direction(self.along)?;
        self.until.check()
    }

    fn run_with(
        &self,
        workspace: &mut Workspace,
        output: Option<&mut OutputBuffer>,
    ) -> Result<Option<Contact>> {
        self.check()?;
        let contact = match self.kernel(workspace) {
            Some(grid) => {
                let mut none = OutputBuffer::none();
                let output = output.unwrap_or(&mut none);
                let contact = self.run_by_rows(workspace.on_grid(grid), output)?;
                // If nothing is touched, the kernel has not filled the row.
                output.finish();
                contact
            }
            None => {
                let contact = Path::new(self, workspace).run()?;
                if let Some(output) = output {
                    output.row.write(workspace.deflections());
                }
                contact
            }
        };
        let counts_untouched = matches!(self.until, Until::Depth(_));
        Ok(contact.filter(|contact| counts_untouched || contact.n_touched > 0))
    }

    /// Returns the grid if the press is evaluated row by row.
    fn kernel(&self, workspace: &Workspace) -> Option<&'a EvenGrid> {
        let grid = self.patch.even_grid()?;
        let is_possible = match self.until {
            // Held parts can also touch taxels from behind the substrate.
            Until::Pose => !workspace.holds_any(),
            Until::Depth(_) | Until::Travel(_) => true,
            Until::Force(_) => matches!(self.patch.taxels(), Taxels::Equal(_)),
        };
        let is_wanted = self.record == Record::Deflections && self.along == DVec3::Z;
        (is_possible && is_wanted).then_some(grid)
    }

    fn run_by_rows(
        &self,
        mut press: GridPress,
        output: &mut OutputBuffer,
    ) -> Result<Option<Contact>> {
        let (objects, poses) = (self.objects, self.poses);
        if let Until::Force(force) = self.until {
            let stiffness = self.patch.taxels().at(0).stiffness;
            let placed = (objects, poses);
            return force::press(&mut press, placed, (force, stiffness), output);
        }
        let first = press.gather(objects, poses, self.until);
        let travel = self.until.limit(first.unwrap_or(f64::INFINITY));
        if travel == f64::INFINITY {
            press.touch_nothing();
            return Ok(None);
        }
        Ok(Some(press.indent(travel, output)))
    }
}

impl Until {
    /// Returns the travel beyond which objects do not affect the press, metres; infinite for a force. `first` is the travel at first contact.
    pub(super) fn limit(self, first: f64) -> f64 {
        match self {
            Self::Pose => 0.0,
            Self::Depth(depth) => first + depth,
            Self::Travel(travel) => travel,
            Self::Force(_) => f64::INFINITY,
        }
    }

    /// Returns an error if the number of the condition is out of its range.
    pub(super) fn check(self) -> Result<()> {
        match self {
            Self::Pose => Ok(()),
            Self::Depth(depth) => not_negative("touch depth", depth, "m").map(drop),
            Self::Travel(travel) => finite("touch travel", travel, "m").map(drop),
            Self::Force(force) => positive("touch force", force, "N").map(drop),
        }
    }
}

/// Returns an error unless the output of a press has one value for each taxel.
fn check_output(n_values: usize, n_taxels: usize) -> Result<()> {
    if n_values == n_taxels {
        return Ok(());
    }
    let given = format!("{n_values} values for {n_taxels} taxels");
    Err(Error::input(
        "output of a press",
        given,
        "one value for each taxel",
    ))
}

/// Returns an error unless the direction is a unit vector.
pub(super) fn check_direction(direction: DVec3) -> Result<()> {
    if direction.is_finite() && (direction.length() - 1.0).abs() < 1e-9 {
        return Ok(());
    }
    Err(Error::input(
        "touch direction",
        direction,
        "a vector of length one",
    ))
}
