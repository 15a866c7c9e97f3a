//! Contact of a ball that rises along a line with a triangle: with the face, an edge or a corner, each in closed form.
//!
//! The ball's centre is at (x, y) and rises from z = −∞. The ball stops at the lowest point of the triangle swept by the ball. The stopping
//! height is the smallest of the heights below, over the parts that contain the point of the triangle nearest to the stopped centre.
//!
//! | part | with | stops at |
//! |---|---|---|
//! | face | unit normal n, n_z < 0, corner a | the plane through a + ρn, if the foot (x, y) − ρ(n_x, n_y) is under the triangle |
//! | edge | rise tan θ along the ground, d: distance beside it, r = √(ρ² − d²) | z_A − r cos θ, A being r sin θ before (x, y) along the edge |
//! | corner | v, b: distance beside it | v_z − √(ρ² − b²) |

use crate::contact::law;
use crate::mesh::Triangle;
use glam::{DVec2, DVec3, Vec3Swizzles};

/// Cosine to the vertical below which a steep face is replaced by its edges, and a steep edge by its corners. The projection of such a face or edge of 0.1 m
/// is less than a nanometre, and its heights would be dominated by rounding.
pub(crate) const STEEP: f64 = 1e-8;
/// Distance by which a face extends beyond its sides, relative to the radius of a taxel. Sides between triangles in one plane are not evaluated. The extension
/// closes the gaps at these sides, which are due to the tolerance [`FLAT`](crate::objects::FLAT), in radii, and to rounding.
pub(crate) const FACE_SLACK: f64 = 1.5 * crate::objects::FLAT;
/// Distance by which an edge extends into the region that its faces hide, relative to the radius of a taxel. Far above rounding, so that no gap can open between
/// an edge and its faces; if larger, edges are evaluated needlessly.
pub(crate) const HIDDEN_SLACK: f64 = 1e-6;

/// Returns the height of the centre of a ball that rises along z at the position `at` (x, y) until a triangle stops it. Returns `None` if the ball misses the
/// triangle.
///
/// All lengths are in metres. The triangle is solid from both sides and may degenerate to a line or a point.
pub fn stopping_height(triangle: &Triangle, radius: f64, at: DVec2) -> Option<f64> {
    let [a, b, c] = triangle.0;
    let face = triangle
        .normal()
        .and_then(|normal| SweptFace::new(&triangle.0, normal, radius));
    let edges = [(a, b), (b, c), (c, a)]
        .map(|(from, to)| SweptEdge::new(from, to, radius, [DVec3::ZERO; 2]));
    let heights = [face.and_then(|face| face.height(at))]
        .into_iter()
        .chain(edges.map(|edge| edge.and_then(|edge| edge.height(at))))
        .chain(triangle.0.map(|corner| corner_height(corner, radius, at)));
    heights.flatten().reduce(f64::min)
}

/// Returns the height of the ball's centre at which a corner of a triangle stops the ball, metres; `None` if the ball misses the corner.
#[inline]
pub(crate) fn corner_height(corner: DVec3, radius: f64, at: DVec2) -> Option<f64> {
    let q = radius * radius - at.distance_squared(corner.xy());
    (q > 0.0).then(|| -law::deflection(q, corner.z))
}

/// Face of a triangle, moved down by the ball's radius along the normal of the face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweptFace {
    corners: [DVec2; 3],
    /// Unit normal of the face; if it points up, the corners are counter-clockwise as seen from above.
    normal: DVec3,
    height_of_first: f64,
}

impl SweptFace {
    /// Creates the swept face from the triangle's corners and `normal`; `None` if the face is vertical.
    #[inline]
    pub fn new(corners: &[DVec3; 3], normal: DVec3, radius: f64) -> Option<Self> {
        if normal.z.abs() < STEEP {
            return None;
        }
        let shift = if normal.z > 0.0 { -radius } else { radius } * normal;
        let [a, b, c] = [corners[0].xy(), corners[1].xy(), corners[2].xy()];
        Some(Self {
            corners: [a + shift.xy(), b + shift.xy(), c + shift.xy()],
            normal,
            height_of_first: corners[0].z + shift.z,
        })
    }

    /// Returns the height of the ball's centre at which the face stops the ball, metres; `None` if the ball misses the face.
    #[inline]
    pub fn height(&self, at: DVec2) -> Option<f64> {
        (self.is_outside(at, 0.0) == [false; 3]).then(|| self.height_at(at))
    }

    /// Returns, for each side of the face, whether a position is more than `slack` metres beyond the side.
    #[inline(always)]
    pub fn is_outside(&self, at: DVec2, slack: f64) -> [bool; 3] {
        let [a, b, c] = self.corners;
        let sign = if self.normal.z > 0.0 { 1.0 } else { -1.0 };
        let is_outside = |from: DVec2, to: DVec2| {
            let side = to - from;
            let length = side.x.abs() + side.y.abs();
            sign * side.perp_dot(at - from) < -slack * length
        };
        [is_outside(a, b), is_outside(b, c), is_outside(c, a)]
    }

    /// Returns the height at which the plane of the face stops the ball, metres.
    #[inline(always)]
    pub fn height_at(&self, at: DVec2) -> f64 {
        self.height_of_first - self.normal.xy().dot(at - self.corners[0]) / self.normal.z
    }
}

impl SweptFace {
    /// Lowers the heights of taxels in a row along x, at the positions (x, y), to the heights at which the face stops them, metres. The face extends by
    /// `slack` metres beyond its sides.
    #[inline(always)]
    pub fn lower_row(&self, y: f64, x: &[f64], slack: f64, heights: &mut [f64]) {
        let [a, b, c] = self.corners;
        let sign = if self.normal.z > 0.0 { 1.0 } else { -1.0 };
        // The distance of a place from each side times its length is `across − along · (x − from)`, positive inside.
        let side = |from: DVec2, to: DVec2| {
            let edge = sign * (to - from);
            let length = edge.x.abs() + edge.y.abs();
            (edge.x * (y - from.y) + slack * length, edge.y, from.x)
        };
        let sides = [side(a, b), side(b, c), side(c, a)];
        let DVec3 {
            x: nx,
            y: ny,
            z: nz,
        } = self.normal;
        let along_y = ny * (y - a.y);
        for (lowest, &x) in heights.iter_mut().zip(x) {
            let mut is_under = true;
            for (across, along, from) in sides {
                is_under &= across - along * (x - from) >= 0.0;
            }
            let height = self.height_of_first - (nx * (x - a.x) + along_y) / nz;
            let is_lower = is_under & (height < *lowest);
            *lowest = if is_lower { height } else { *lowest };
        }
    }
}

/// Lower side of a tube around an edge of a triangle, without the part that adjacent faces hide.
///
/// Distances along and beside the edge are stored as multiples of its projected length on the xy plane. Most tests are decided before this length is needed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweptEdge {
    from: DVec3,
    edge: DVec3,
    /// Squared length of the edge's projection onto the ground, m².
    length2: f64,
    radius: f64,
    /// Range of distances beside the edge in which the edge can stop the ball, positive to the left. The distances are multiples of the edge's projected
    /// length.
    beside: [f64; 2],
    /// Normals of the two adjacent faces, pointing down, if the faces lie on different sides of the edge; otherwise `None`.
    between: Option<[DVec3; 2]>,
}

impl SweptEdge {
    /// Creates the swept edge; `None` if the edge is vertical or wholly hidden by its faces.
    ///
    /// `faces` contains the unit normals of the faces at the edge, zero for a missing face. Seen from above, a face whose normal points up lies to the left
    /// of the edge. A face whose normal points down lies to the right.
    ///
    /// A face hides the edge if the direction from the edge to the centre of the stopped ball points towards the face. The hidden region begins where
    /// the face, moved down by the radius, begins: at the distance ρ n·aside beside the edge.
    #[inline]
    pub fn new(from: DVec3, to: DVec3, radius: f64, faces: [DVec3; 2]) -> Option<Self> {
        let edge = to - from;
        let length2 = edge.xy().length_squared();
        if length2 <= STEEP * STEEP * (length2 + edge.z * edge.z) {
            return None;
        }
        let aside = edge.xy().perp();
        let slack = HIDDEN_SLACK * radius * (aside.x.abs() + aside.y.abs());
        let mut beside = [f64::NEG_INFINITY, f64::INFINITY];
        for normal in faces {
            let shift = radius * normal.xy().dot(aside);
            if normal.z > 0.0 {
                beside[1] = beside[1].min(slack - shift);
            } else if normal.z < 0.0 || shift != 0.0 {
                beside[0] = beside[0].max(shift - slack);
            }
        }
        let [a, b] = faces;
        let between = if a.z > 0.0 && b.z < 0.0 {
            Some([-a, b])
        } else if a.z < 0.0 && b.z > 0.0 {
            Some([a, -b])
        } else {
            None
        };
        (beside[0] <= beside[1]).then_some(Self {
            between,
            from,
            edge,
            length2,
            radius,
            beside,
        })
    }

    /// Returns the lowest and the highest corner of a rectangle (x, y) that contains all positions at which the edge can stop the ball.
    ///
    /// These positions are the edge moved by the ball's radius ρ along all directions between its faces' normals. The arc of directions deviates from its
    /// chord by at most ρ (1 − cos β) / 2, where β is the angle between the normals.
    #[inline]
    pub fn ground(&self) -> (DVec2, DVec2) {
        let to = (self.from + self.edge).xy();
        let (low, high) = (self.from.xy().min(to), self.from.xy().max(to));
        let Some([a, b]) = self.between else {
            return (low - self.radius, high + self.radius);
        };
        let arc = self.radius * (0.5 - 0.5 * a.dot(b)) + 1e-5 * self.radius;
        let (a, b) = (self.radius * a.xy(), self.radius * b.xy());
        (low + a.min(b) - arc, high + a.max(b) + arc)
    }

    /// Returns the height of the ball's centre at which the visible part of the edge stops the ball, metres. Returns `None` if the ball misses this part.
    #[inline]
    pub fn height(&self, at: DVec2) -> Option<f64> {
        let from = at - self.from.xy();
        let ground = self.edge.xy();
        let beside = ground.perp_dot(from);
        let is_hidden = beside < self.beside[0] || beside > self.beside[1];
        if is_hidden || beside * beside > self.radius * self.radius * self.length2 {
            return None;
        }
        let length = self.length2.sqrt();
        let whole = (self.length2 + self.edge.z * self.edge.z).sqrt();
        let (sine, cosine) = (self.edge.z / whole, length / whole);
        let d = beside / length;
        let r = (self.radius * self.radius - d * d).max(0.0).sqrt();
        let foot = ground.dot(from) / length - r * sine;
        (foot >= 0.0 && foot <= length)
            .then(|| self.from.z + foot * (self.edge.z / length) - r * cosine)
    }
}
