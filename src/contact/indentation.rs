//! The indentation kernel of a grid patch: only the spheres and triangles that reach the skin, only the taxels under them.

use super::envelope::Envelope;
use super::grid_lines::GridLines;
use super::instructions::{Instructions, for_instructions};
use super::placed_sphere::PlacedSphere;
use super::sheet::Sheet;
use super::sphere_search::{SphereSearch, search};
use crate::geometry::Pose;
use crate::world::{Patch, Scene};

/// What a press did, beside its deflections in [`Workspace::deflections`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// How far the patch went along its axis from the pose it was given, metres.
    pub travel: f64,
    /// Taxels with a deflection above zero.
    pub n_touched: usize,
    /// Taxels at their stroke that the object would push further.
    pub n_saturated: usize,
}

/// Scratch of one thread; it is reused, so a press allocates nothing once the largest scene has been seen.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    instructions: Instructions,
    /// Of the last scene's grid.
    lines: GridLines,
    /// Spheres that can press.
    search: SphereSearch,
    /// Where the scene's meshes stop the taxels; empty if it has none.
    envelope: Envelope,
    sheet: Sheet,
    /// Of the last press to a force: see [`starts`](Self::starts).
    starts: Vec<f64>,
}

impl Workspace {
    /// An empty workspace.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty workspace for some other than the best instructions, to compare them.
    pub fn with(instructions: Instructions) -> Self {
        Self {
            instructions,
            ..Self::default()
        }
    }

    /// Deflections of the last press: n_taxels, metres, row (patch y, ascending) by row.
    pub fn deflections(&self) -> &[f64] {
        self.sheet.deflections()
    }

    /// Keeps the spheres that press a taxel on the way to the goal, and returns the travel to first contact if the
    /// goal is a depth (`None` where no travel touches anything).
    pub(super) fn gather(
        &mut self,
        scene: &Scene,
        patch_from_objects: &[Pose],
        goal: Goal,
    ) -> Option<f64> {
        assert_eq!(
            scene.objects.len(),
            patch_from_objects.len(),
            "one pose an object"
        );
        self.lines.lay(&scene.patch.grid);
        let mut first = search(
            self.instructions,
            &mut self.search,
            scene,
            patch_from_objects,
            &self.lines,
            goal,
        );
        if self
            .envelope
            .look(scene, patch_from_objects, &self.lines, (goal, first))
        {
            first = first.min(self.envelope.first);
        }
        first.is_finite().then_some(first)
    }

    /// Indents the patch at a travel, after a depth of at least as much has been gathered for.
    pub(super) fn indent(&mut self, patch: &Patch, travel: f64) -> Contact {
        let stroke = patch.taxel.stroke;
        self.push(patch, travel);
        let [n_touched, n_saturated] = stop_at_stroke(self.instructions, &mut self.sheet, stroke);
        Contact {
            travel,
            n_touched,
            n_saturated,
        }
    }

    /// For each taxel that what has been gathered reaches up to `travel`, the travel at which it begins to move, metres.
    pub(super) fn starts(&mut self, patch: &Patch, travel: f64) -> &[f64] {
        self.push(patch, travel);
        self.starts.clear();
        self.starts.reserve(patch.grid.n_taxels());
        let Self { sheet, starts, .. } = self;
        sheet.each_row(|taxels| {
            let touched = taxels.iter().filter(|needed| **needed > 0.0);
            starts.extend(touched.map(|needed| travel - *needed));
        });
        &self.starts
    }

    /// Goes on to the next step of a time loop: a press at a pose, but what counted in the step before also counts behind the
    /// substrate. Each workspace follows one scene.
    pub(super) fn follow(&mut self, scene: &Scene, patch_from_objects: &[Pose]) -> Contact {
        self.gather(scene, patch_from_objects, Goal::Step);
        self.indent(&scene.patch, 0.0)
    }

    /// Leaves all taxels of a patch at rest.
    pub(super) fn touch_nothing(&mut self, patch: &Patch) {
        self.sheet.clear(patch.grid.nx, patch.grid.ny);
    }

    /// Sets the deflections to what the taxels need at a travel, without a stop.
    fn push(&mut self, patch: &Patch, travel: f64) {
        self.touch_nothing(patch);
        raise_all(
            self.instructions,
            &self.search.found,
            &self.lines,
            travel,
            &mut self.sheet,
        );
        if !self.envelope.heights.is_empty() {
            self.sheet.cover(&(0..patch.grid.ny), &(0..patch.grid.nx));
            let mut heights = self.envelope.heights.chunks_exact(patch.grid.nx);
            self.sheet.each_row(|taxels| {
                let heights = heights.next().unwrap_or_default();
                for (deflection, height) in taxels.iter_mut().zip(heights) {
                    *deflection = deflection.max(travel - height);
                }
            });
        }
    }
}

for_instructions! {
    /// Raises the deflections to what the spheres need at a travel.
    fn raise_all(
        spheres: &[PlacedSphere],
        lines: &GridLines,
        travel: f64,
        sheet: &mut Sheet,
    ) = raise_each
}

#[inline(always)]
fn raise_each(spheres: &[PlacedSphere], lines: &GridLines, travel: f64, sheet: &mut Sheet) {
    for sphere in spheres {
        let height = sphere.center.z - travel;
        if height < sphere.reach {
            sphere.raise(lines, height, sheet);
        }
    }
}

/// How far a press goes, and what counts on the way.
#[derive(Clone, Copy)]
pub(super) enum Goal {
    /// To this travel, metres, from the front: all counts.
    Travel(f64),
    /// To first contact and this far past it, metres, from the front: all counts.
    Depth(f64),
    /// Nowhere: what lies behind the substrate does not count.
    Pose,
    /// Nowhere: what lies behind the substrate counts if it counted in the step before.
    Step,
}

/// How far the patch must travel along its axis until the first taxel is touched, metres (negative: it already is);
/// `None` where no travel would touch anything.
///
/// Poses are `patch_from_object`, one an object. Closed form: a sphere meets the taxel nearest to its axis first.
///
/// # Panics
/// If there are not as many poses as objects.
pub fn first_contact(
    scene: &Scene,
    patch_from_objects: &[Pose],
    workspace: &mut Workspace,
) -> Option<f64> {
    workspace.gather(scene, patch_from_objects, Goal::Depth(0.0))
}

/// Presses until the patch is `depth` metres past first contact; `None` (and zero deflections) where it meets nothing.
///
/// The patch comes from the front and all counts, however deep: past the stroke taxels are saturated. No taxel that is touched
/// at a depth is deflected less at a larger one.
///
/// # Panics
/// If there are not as many poses as objects.
pub fn press_to_depth(
    scene: &Scene,
    patch_from_objects: &[Pose],
    depth: f64,
    workspace: &mut Workspace,
) -> Option<Contact> {
    let Some(first) = workspace.gather(scene, patch_from_objects, Goal::Depth(depth)) else {
        workspace.touch_nothing(&scene.patch);
        return None;
    };
    Some(workspace.indent(&scene.patch, first + depth))
}

/// Presses until the patch has moved `travel` metres along its axis from the pose given, from the front: the press of
/// [`press_to_depth`] with this travel.
///
/// # Panics
/// If there are not as many poses as objects.
pub fn press_to_travel(
    scene: &Scene,
    patch_from_objects: &[Pose],
    travel: f64,
    workspace: &mut Workspace,
) -> Contact {
    workspace.gather(scene, patch_from_objects, Goal::Travel(travel));
    workspace.indent(&scene.patch, travel)
}

/// Presses right at the pose given, with no way to it: what lies behind the substrate does not count (see the
/// [contact stage](super)).
///
/// # Panics
/// If there are not as many poses as objects.
pub fn press_at_pose(
    scene: &Scene,
    patch_from_objects: &[Pose],
    workspace: &mut Workspace,
) -> Contact {
    workspace.gather(scene, patch_from_objects, Goal::Pose);
    workspace.indent(&scene.patch, 0.0)
}

/// How far a taxel of this stroke may be pushed without being saturated: a press to a depth of exactly the stroke saturates
/// nothing, and rounding (1e-12 of the stroke) does not count.
pub(crate) fn saturation_limit(stroke: f64) -> f64 {
    stroke * (1.0 + 1e-12)
}

for_instructions! {
    /// Counts touched and saturated taxels and stops the latter at their stroke.
    fn stop_at_stroke(sheet: &mut Sheet, stroke: f64) -> [usize; 2] = stop_each
}

#[inline(always)]
fn stop_each(sheet: &mut Sheet, stroke: f64) -> [usize; 2] {
    let limit = saturation_limit(stroke);
    let (mut n_touched, mut n_saturated) = (0, 0);
    sheet.each_row(|taxels| {
        for deflection in taxels {
            n_touched += usize::from(*deflection > 0.0);
            n_saturated += usize::from(*deflection > limit);
            *deflection = deflection.min(stroke);
        }
    });
    [n_touched, n_saturated]
}
