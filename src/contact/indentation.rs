//! The indentation kernel of a grid patch: only the spheres that reach the skin, only the taxels under them.

use crate::geometry::Pose;
use crate::world::{Grid, Patch, Scene};
use glam::DVec3;

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
    /// Spheres over the patch, in the patch frame before any travel.
    spheres: Vec<PlacedSphere>,
    /// n_taxels deflections, metres, row by row.
    deflections: Vec<f64>,
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

    /// Loads the spheres whose shadow falls on the patch.
    fn place(&mut self, scene: &Scene, patch_from_objects: &[Pose]) {
        assert_eq!(
            scene.objects.len(),
            patch_from_objects.len(),
            "one pose an object"
        );
        let grid = &scene.patch.grid;
        let rho = scene.patch.taxel.radius;
        let (half_x, half_y) = (grid.x(grid.nx - 1), grid.y(grid.ny - 1));
        self.spheres.clear();
        for (object, pose) in scene.objects.iter().zip(patch_from_objects) {
            let rotation = glam::DMat3::from_quat(pose.rotation);
            for sphere in object.spheres() {
                let center = rotation * sphere.center + pose.translation;
                let reach = rho + sphere.radius;
                if center.x.abs() < half_x + reach && center.y.abs() < half_y + reach {
                    self.spheres.push(PlacedSphere { center, reach });
                }
            }
        }
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
    workspace.place(scene, patch_from_objects);
    first_touch(&scene.patch.grid, &workspace.spheres)
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
    workspace.place(scene, patch_from_objects);
    let first = first_touch(&scene.patch.grid, &workspace.spheres);
    let contact = indent(&scene.patch, first.unwrap_or(0.0) + depth, workspace);
    first.map(|_| contact)
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
    workspace.place(scene, patch_from_objects);
    indent(&scene.patch, travel, workspace)
}

fn first_touch(grid: &Grid, spheres: &[PlacedSphere]) -> Option<f64> {
    let mut first = f64::INFINITY;
    for sphere in spheres {
        // No taxel can meet the sphere before its lowest point does.
        if sphere.center.z - sphere.reach >= first {
            continue;
        }
        let dx = sphere.center.x - grid.x(nearest(sphere.center.x, grid.x(0), grid.pitch, grid.nx));
        let dy = sphere.center.y - grid.y(nearest(sphere.center.y, grid.y(0), grid.pitch, grid.ny));
        let q = sphere.reach * sphere.reach - (dx * dx + dy * dy);
        if q > 0.0 {
            first = first.min(sphere.center.z - q.sqrt());
        }
    }
    first.is_finite().then_some(first)
}

/// The index of the grid line nearest to a coordinate.
fn nearest(coordinate: f64, origin: f64, pitch: f64, n: usize) -> usize {
    let index = ((coordinate - origin) / pitch).round();
    (index.max(0.0) as usize).min(n - 1)
}

fn indent(patch: &Patch, travel: f64, workspace: &mut Workspace) -> Contact {
    let Workspace {
        spheres,
        deflections,
    } = workspace;
    deflections.clear();
    deflections.resize(patch.grid.n_taxels(), 0.0);
    let behind = -patch.taxel.stroke - patch.taxel.radius;
    for sphere in spheres.iter() {
        let height = sphere.center.z - travel;
        if height < sphere.reach && height >= behind {
            raise(&patch.grid, sphere, height, deflections);
        }
    }
    let (n_touched, n_saturated) = stop_at_stroke(deflections, patch.taxel.stroke);
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
fn raise(grid: &Grid, sphere: &PlacedSphere, height: f64, deflections: &mut [f64]) {
    let reach2 = sphere.reach * sphere.reach;
    let lift = height.max(0.0);
    let footprint = (reach2 - lift * lift).max(0.0);
    let rows = covered(
        sphere.center.y,
        footprint.sqrt(),
        grid.y(0),
        grid.pitch,
        grid.ny,
    );
    for row in rows {
        let dy = grid.y(row) - sphere.center.y;
        let half_width = (footprint - dy * dy).max(0.0).sqrt();
        let columns = covered(sphere.center.x, half_width, grid.x(0), grid.pitch, grid.nx);
        let row_reach2 = reach2 - dy * dy;
        let first = columns.start;
        let taxels = &mut deflections[row * grid.nx..][columns];
        for (offset, deflection) in taxels.iter_mut().enumerate() {
            let dx = grid.x(first + offset) - sphere.center.x;
            let q = row_reach2 - dx * dx;
            let needed = if q > 0.0 { q.sqrt() - height } else { 0.0 };
            *deflection = deflection.max(needed);
        }
    }
}

/// The grid lines within `half_width` of a coordinate, one line more on each side to be safe against rounding.
fn covered(
    coordinate: f64,
    half_width: f64,
    origin: f64,
    pitch: f64,
    n: usize,
) -> std::ops::Range<usize> {
    let low = ((coordinate - half_width - origin) / pitch).floor();
    let high = ((coordinate + half_width - origin) / pitch).ceil() + 1.0;
    // The casts saturate: far outside the grid they give an empty range.
    let start = (low.max(0.0) as usize).min(n);
    let end = (high.max(0.0) as usize).min(n);
    start..end.max(start)
}

/// Counts touched and saturated taxels and stops the latter at their stroke.
///
/// A press to a depth of exactly the stroke saturates nothing: rounding (1e-12 of the stroke) does not count.
fn stop_at_stroke(deflections: &mut [f64], stroke: f64) -> (usize, usize) {
    let limit = stroke * (1.0 + 1e-12);
    let (mut n_touched, mut n_saturated) = (0, 0);
    for deflection in deflections {
        n_touched += usize::from(*deflection > 0.0);
        n_saturated += usize::from(*deflection > limit);
        *deflection = deflection.min(stroke);
    }
    (n_touched, n_saturated)
}
