//! The indentation kernel of a grid patch: only the spheres and triangles that reach the skin, only the taxels under them.

use super::envelope::{Envelope, Limit};
use super::grid_lines::GridLines;
use crate::geometry::Pose;
use crate::objects::Sphere;
use crate::world::{Patch, Scene};
use glam::{DMat3, DVec3};

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
    /// Of the last scene's grid.
    lines: GridLines,
    /// Spheres that can press, in the patch frame before any travel.
    spheres: Vec<PlacedSphere>,
    /// Where the scene's meshes stop the taxels; empty if it has none.
    envelope: Envelope,
    /// n_taxels deflections, metres, row by row.
    deflections: Vec<f64>,
    /// Of the last press to a force: see [`starts`](Self::starts).
    starts: Vec<f64>,
}

/// A sphere in the patch frame, its radius grown by the taxel's: the taxel is then a point.
#[derive(Clone, Copy, Debug)]
struct PlacedSphere {
    center: DVec3,
    /// S = ρ + R.
    reach: f64,
}

impl Workspace {
    /// An empty workspace.
    pub fn new() -> Self {
        Self::default()
    }

    /// Deflections of the last press: n_taxels, metres, row (patch y, ascending) by row.
    pub fn deflections(&self) -> &[f64] {
        &self.deflections
    }

    /// Keeps the spheres that can press a taxel on the way to the goal, and returns the travel to first contact if the
    /// goal is a depth (`None` where no travel touches anything).
    ///
    /// Most spheres of an object are on its far side. They cost one row of the rotation and one comparison: a sphere
    /// presses nothing before its lowest point meets the plane of the taxels. For a depth, a few spheres are looked at
    /// beforehand, so that the comparison is with a travel close to the final one from the start.
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
        self.spheres.clear();
        let views = || {
            let pairs = scene.objects.iter().zip(patch_from_objects);
            pairs.filter_map(|(object, pose)| {
                let spheres = object.spheres()?.spheres();
                Some((spheres, View::new(&scene.patch, pose)))
            })
        };
        let depth = match goal {
            Goal::Depth(depth) => depth,
            Goal::Travel(travel) => {
                for (spheres, view) in views() {
                    let near = spheres.iter().filter_map(|s| view.place(s, travel));
                    self.spheres.extend(near);
                }
                let limit = Limit::Travel(travel);
                self.envelope
                    .look(scene, patch_from_objects, &self.lines, limit);
                return None;
            }
        };
        let mut first = f64::INFINITY;
        for (spheres, view) in views() {
            for sphere in spheres.iter().step_by(PREVIEW_STRIDE) {
                if let Some(placed) = view.place(sphere, first) {
                    first = first.min(placed.first_touch(&self.lines));
                }
            }
        }
        for (spheres, view) in views() {
            for sphere in spheres {
                if let Some(placed) = view.place(sphere, first + depth) {
                    first = first.min(placed.first_touch(&self.lines));
                    self.spheres.push(placed);
                }
            }
        }
        let limit = Limit::Past { depth, first };
        if self
            .envelope
            .look(scene, patch_from_objects, &self.lines, limit)
        {
            first = first.min(self.envelope.first);
        }
        first.is_finite().then_some(first)
    }

    /// Indents the patch at a travel, after a depth of at least as much has been gathered for.
    pub(super) fn indent_past_first(
        &mut self,
        scene: &Scene,
        patch_from_objects: &[Pose],
        travel: f64,
    ) -> Contact {
        self.envelope
            .leave_out_passed(scene, patch_from_objects, &self.lines, travel);
        indent(&scene.patch, travel, self)
    }

    /// For each taxel that what has been gathered reaches up to `travel`, the travel at which it begins to move, metres;
    /// nothing counts as behind the substrate.
    pub(super) fn starts(&mut self, patch: &Patch, travel: f64) -> &[f64] {
        self.push(patch, travel, f64::NEG_INFINITY);
        self.starts.clear();
        self.starts.reserve(self.deflections.len());
        let touched = self.deflections.iter().filter(|&&needed| needed > 0.0);
        self.starts.extend(touched.map(|needed| travel - needed));
        &self.starts
    }

    /// What [`starts`](Self::starts) said last.
    pub(super) fn last_starts(&self) -> &[f64] {
        &self.starts
    }

    /// Leaves all taxels of a patch at rest.
    pub(super) fn touch_nothing(&mut self, patch: &Patch) {
        self.deflections.clear();
        self.deflections.resize(patch.grid.n_taxels(), 0.0);
    }

    /// Sets the deflections to what the taxels need at a travel, without a stop; spheres whose centres are lower than `behind` do
    /// not count.
    fn push(&mut self, patch: &Patch, travel: f64, behind: f64) {
        self.touch_nothing(patch);
        for sphere in &self.spheres {
            let height = sphere.center.z - travel;
            if height < sphere.reach && height >= behind {
                raise(&self.lines, sphere, height, &mut self.deflections);
            }
        }
        for (deflection, height) in self.deflections.iter_mut().zip(&self.envelope.heights) {
            *deflection = deflection.max(travel - height);
        }
    }
}

/// One sphere in so many is looked at to estimate first contact. Larger: a worse estimate, so more spheres are placed in
/// vain; smaller: more spheres are looked at twice.
const PREVIEW_STRIDE: usize = 16;

/// An object's frame seen from the patch.
struct View {
    /// Rows of the rotation.
    rows: DMat3,
    translation: DVec3,
    /// ρ.
    taxel_radius: f64,
    /// The outermost taxels' |x| and |y|.
    half_size: [f64; 2],
}

impl View {
    fn new(patch: &Patch, pose: &Pose) -> Self {
        let grid = &patch.grid;
        Self {
            rows: DMat3::from_quat(pose.rotation).transpose(),
            translation: pose.translation,
            taxel_radius: patch.taxel.radius,
            half_size: [grid.x(grid.nx - 1), grid.y(grid.ny - 1)],
        }
    }

    /// The sphere in the patch frame; `None` if it meets no taxel before `travel` or its shadow misses the patch.
    fn place(&self, sphere: &Sphere, travel: f64) -> Option<PlacedSphere> {
        let reach = self.taxel_radius + sphere.radius;
        let z = self.rows.z_axis.dot(sphere.center) + self.translation.z;
        if z - reach >= travel {
            return None;
        }
        let x = self.rows.x_axis.dot(sphere.center) + self.translation.x;
        let y = self.rows.y_axis.dot(sphere.center) + self.translation.y;
        let [half_x, half_y] = self.half_size;
        (x.abs() < half_x + reach && y.abs() < half_y + reach).then_some(PlacedSphere {
            center: DVec3::new(x, y, z),
            reach,
        })
    }
}

/// How far a press goes.
#[derive(Clone, Copy)]
pub(super) enum Goal {
    /// To this travel, metres.
    Travel(f64),
    /// To first contact and this far past it, metres.
    Depth(f64),
}

impl PlacedSphere {
    /// The travel at which the sphere meets the taxel nearest to its axis, its first; infinite if it passes between all.
    fn first_touch(&self, lines: &GridLines) -> f64 {
        let DVec3 { x, y, z } = self.center;
        let (dx, dy) = (x - lines.x.nearest(x), y - lines.y.nearest(y));
        let q = self.reach * self.reach - (dx * dx + dy * dy);
        if q > 0.0 { z - q.sqrt() } else { f64::INFINITY }
    }
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
    Some(workspace.indent_past_first(scene, patch_from_objects, first + depth))
}

/// Presses until the patch has moved `travel` metres along its axis from the pose given (0: right there).
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
    indent(&scene.patch, travel, workspace)
}

fn indent(patch: &Patch, travel: f64, workspace: &mut Workspace) -> Contact {
    let taxel = &patch.taxel;
    workspace.push(patch, travel, -taxel.stroke - taxel.radius);
    let (n_touched, n_saturated) = stop_at_stroke(&mut workspace.deflections, taxel.stroke);
    Contact {
        travel,
        n_touched,
        n_saturated,
    }
}

/// Raises the deflections under one sphere to what it needs, row by row of its footprint.
///
/// The footprint is where the sphere needs more than zero: `b² < S² − max(h, 0)²`. Ranges are rounded outwards; the
/// comparison with S in the innermost loop is what decides.
fn raise(lines: &GridLines, sphere: &PlacedSphere, height: f64, deflections: &mut [f64]) {
    let reach2 = sphere.reach * sphere.reach;
    let lift = height.max(0.0);
    let footprint = (reach2 - lift * lift).max(0.0);
    let n_columns = lines.x.positions.len();
    for row in lines.y.within(sphere.center.y, footprint.sqrt()) {
        let dy = lines.y.positions[row] - sphere.center.y;
        let half_width = (footprint - dy * dy).max(0.0).sqrt();
        let columns = lines.x.within(sphere.center.x, half_width);
        let row_reach2 = reach2 - dy * dy;
        let taxels = &mut deflections[row * n_columns..][columns.clone()];
        for (deflection, x) in taxels.iter_mut().zip(&lines.x.positions[columns]) {
            let dx = x - sphere.center.x;
            let q = row_reach2 - dx * dx;
            let needed = if q > 0.0 { q.sqrt() - height } else { 0.0 };
            *deflection = deflection.max(needed);
        }
    }
}

/// How far a taxel of this stroke may be pushed without being saturated: a press to a depth of exactly the stroke saturates
/// nothing, and rounding (1e-12 of the stroke) does not count.
pub(crate) fn saturation_limit(stroke: f64) -> f64 {
    stroke * (1.0 + 1e-12)
}

/// Counts touched and saturated taxels and stops the latter at their stroke.
fn stop_at_stroke(deflections: &mut [f64], stroke: f64) -> (usize, usize) {
    let limit = saturation_limit(stroke);
    let (mut n_touched, mut n_saturated) = (0, 0);
    for deflection in deflections {
        n_touched += usize::from(*deflection > 0.0);
        n_saturated += usize::from(*deflection > limit);
        *deflection = deflection.min(stroke);
    }
    (n_touched, n_saturated)
}
