//! Heights at which a mesh stops each taxel, computed only for triangles that the patch can reach.

use super::lines::GridLines;
use super::placed_objects::{PlacedObjects, TravelGoal};
use crate::contact::mesh::swept_triangle::{SweptEdge, SweptFace, corner_height};
use crate::geometry::{Aabb, Pose};
use crate::mesh::Triangle;
use crate::objects::{ContactFace, MeshModel, Model};
use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};
use std::cell::Cell;

/// Travel of the patch at which a triangle first stops each taxel, given as the least height in the patch frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Envelope {
    /// Heights at which triangles stop the taxels, metres, shape (n_taxels,); infinite if no triangle evaluated so far stops the taxel.
    pub heights: Vec<f64>,
    /// Smallest of the heights, metres.
    pub first: f64,
}

impl Envelope {
    /// Resets the heights to infinity for `n_taxels` taxels.
    pub fn clear(&mut self, n_taxels: usize) {
        self.heights.clear();
        self.heights.resize(n_taxels, f64::INFINITY);
        self.first = f64::INFINITY;
    }

    /// Computes the heights at which meshes stop the taxels, up to the goal of the press. Returns whether there is a mesh. `first` is the travel at first
    /// contact with spheres.
    pub fn look(&mut self, placed: &PlacedObjects, (goal, first): (TravelGoal, f64)) -> bool {
        let pairs = placed.objects.iter().zip(placed.patch_from_objects);
        let meshes = pairs.filter_map(|(object, pose)| match object {
            Model::Mesh(mesh) => Some((mesh, pose)),
            Model::Spheres(_) => None,
        });
        let mut meshes = meshes.peekable();
        let has_meshes = meshes.peek().is_some();
        let n_taxels = placed.lines.x.positions.len() * placed.lines.y.positions.len();
        self.clear(if has_meshes { n_taxels } else { 0 });
        for (mesh, pose) in meshes {
            self.lower(mesh, pose, placed, (goal, first));
        }
        has_meshes
    }

    /// Lowers the stored heights to the heights at which a mesh stops the taxels, up to the goal of the press.
    fn lower(
        &mut self,
        mesh: &MeshModel,
        pose: &Pose,
        placed: &PlacedObjects,
        goal: (TravelGoal, f64),
    ) {
        let first = Cell::new(self.first);
        let radius = placed.radius + mesh.rounding();
        let sweep = Sweep {
            view: MeshView::new(pose, radius, placed.lines),
            radius,
            lines: placed.lines,
            goal,
            heights: Cell::from_mut(&mut self.heights[..]).as_slice_of_cells(),
            first: &first,
        };
        let [low, high] = sweep.view.turned(&mesh.bvh().bounds());
        if sweep.view.is_beside(low, high) || low.z - radius >= sweep.limit() {
            return;
        }
        mesh.bvh().search_places(
            sweep.limit(),
            |bounds| sweep.bound(bounds),
            |place, triangle, _| {
                sweep.lower_to(triangle, &mesh.faces()[place]);
                sweep.limit()
            },
        );
        self.first = first.get();
    }
}

/// State of the search over one mesh. The heights are stored in `Cell`s, so that the search can read and lower them at any time.
struct Sweep<'a> {
    view: MeshView,
    /// Sum of a taxel's radius and the rounding of the mesh, metres.
    radius: f64,
    lines: &'a GridLines,
    /// Goal of the press, and the travel at first contact with the objects evaluated before.
    goal: (TravelGoal, f64),
    heights: &'a [Cell<f64>],
    first: &'a Cell<f64>,
}

/// Maximum number of taxels near a bounding box for which the search tests whether the box is hidden. If larger, tests are wasted on triangles as large as
/// taxels; if smaller, boxes of small triangles are searched needlessly.
const FEW: usize = 2;

impl Sweep<'_> {
    /// Returns the travel, metres, beyond which the heights do not affect the press.
    fn limit(&self) -> f64 {
        match self.goal {
            (TravelGoal::Travel(travel), _) => travel,
            (TravelGoal::Pose, _) => 0.0,
            (TravelGoal::Depth(depth), others) => self.first.get().min(others) + depth,
        }
    }

    /// Returns a lower bound, metres, of the travel at which a triangle in a bounding box stops a taxel. The bound is infinite if no triangle in the box can
    /// lower a height.
    fn bound(&self, bounds: &Aabb) -> f64 {
        let [low, high] = self.view.turned(bounds);
        if self.view.is_beside(low, high) || self.is_hidden(low, high) {
            return f64::INFINITY;
        }
        low.z - self.radius
    }

    /// Returns whether the triangles in a small box certainly cannot lower the heights of the taxels near the box. At a horizontal distance b from the box, a
    /// ball of radius ρ stops no lower than √(ρ² − b²) below the box.
    fn is_hidden(&self, low: DVec3, high: DVec3) -> bool {
        let (center, half) = (0.5 * (low + high), 0.5 * (high - low) + self.radius);
        let rows = self.lines.y.within(center.y, half.y);
        let columns = self.lines.x.within(center.x, half.x);
        if rows.len() * columns.len() > FEW {
            return false;
        }
        let n_columns = self.lines.x.positions.len();
        let limit = self.limit();
        rows.into_iter().all(|row| {
            let y = self.lines.y.positions[row];
            let dy = (low.y - y).max(y - high.y).max(0.0);
            columns.clone().all(|column| {
                let x = self.lines.x.positions[column];
                let dx = (low.x - x).max(x - high.x).max(0.0);
                let q = self.radius * self.radius - dx * dx - dy * dy;
                let above = low.z - self.heights[row * n_columns + column].get().min(limit);
                q <= 0.0 || (above >= 0.0 && q <= above * above)
            })
        })
    }

    fn lower_to(&self, triangle: &Triangle, face: &ContactFace) {
        let corners = triangle.0.map(|corner| self.view.place(corner));
        let lowest = corners[0].z.min(corners[1].z).min(corners[2].z);
        if lowest - self.radius >= self.limit() {
            return;
        }
        let normal = self.view.rotation * face.normal;
        if let Some(swept) = SweptFace::new(&corners, normal, self.radius) {
            self.lower_under(swept.ground(), |at| swept.height(at));
        }
        for k in 0..3 {
            if face.has_edge[k] {
                let (from, to) = (corners[k], corners[(k + 1) % 3]);
                let across = self.view.rotation * face.across[k];
                if let Some(swept) = SweptEdge::new(from, to, self.radius, [normal, across]) {
                    self.lower_under(swept.ground(), |at| swept.height(at));
                }
            }
            if face.has_corner[k] {
                let corner = corners[k];
                let ground = (corner.xy() - self.radius, corner.xy() + self.radius);
                self.lower_under(ground, |at| corner_height(corner, self.radius, at));
            }
        }
    }

    /// Lowers the heights of the taxels inside a rectangle (given by two corners) to the value of the function `height` at each taxel.
    #[inline]
    fn lower_under(&self, ground: (DVec2, DVec2), height: impl Fn(DVec2) -> Option<f64>) {
        let (low, high) = ground;
        let (center, half) = (0.5 * (low + high), 0.5 * (high - low));
        let rows = self.lines.y.within(center.y, half.y);
        if rows.is_empty() {
            return;
        }
        let columns = self.lines.x.within(center.x, half.x);
        let n_columns = self.lines.x.positions.len();
        for row in rows {
            let y = self.lines.y.positions[row];
            let heights = &self.heights[row * n_columns..][columns.clone()];
            for (lowest, &x) in heights.iter().zip(&self.lines.x.positions[columns.clone()]) {
                if let Some(height) = height(DVec2::new(x, y))
                    && height < lowest.get()
                {
                    lowest.set(height);
                    self.first.set(self.first.get().min(height));
                }
            }
        }
    }
}

/// Transform from a mesh's frame to the patch frame, which also rotates bounding boxes.
struct MeshView {
    rotation: DMat3,
    translation: DVec3,
    /// Positive and negative parts of the rotation matrix; their products with a box's corners are the bounds of the rotated box.
    positive: DMat3,
    negative: DMat3,
    /// Half the patch's width along x and y, enlarged by the taxels' radius, metres.
    half_size: DVec2,
}

impl MeshView {
    fn new(pose: &Pose, radius: f64, lines: &GridLines) -> Self {
        let rotation = DMat3::from_quat(pose.rotation);
        let part = |select: fn(DVec3) -> DVec3| {
            DMat3::from_cols(
                select(rotation.x_axis),
                select(rotation.y_axis),
                select(rotation.z_axis),
            )
        };
        let last = |positions: &[f64]| positions.last().copied().unwrap_or(0.0);
        Self {
            rotation,
            translation: pose.translation,
            positive: part(|column| column.max(DVec3::ZERO)),
            negative: part(|column| column.min(DVec3::ZERO)),
            half_size: DVec2::new(last(&lines.x.positions), last(&lines.y.positions)) + radius,
        }
    }

    fn place(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    /// Returns the lowest and the highest corner, in the patch frame, of the axis-aligned box around a rotated box.
    fn turned(&self, bounds: &Aabb) -> [DVec3; 2] {
        [(bounds.min, bounds.max), (bounds.max, bounds.min)]
            .map(|(near, far)| self.positive * near + self.negative * far + self.translation)
    }

    /// Returns whether no taxel lies below a box, given by its lowest and highest corner in the patch frame.
    fn is_beside(&self, low: DVec3, high: DVec3) -> bool {
        low.xy().cmpgt(self.half_size).any() || high.xy().cmplt(-self.half_size).any()
    }
}
