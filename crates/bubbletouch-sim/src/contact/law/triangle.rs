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

//!
//! The functions on [`SweptFace`] and [`SweptEdge`] that return heights have no branches: loops over lanes of pairs (`pair_batch`) become vector instructions.

use crate::mesh::Triangle;
use crate::objects::ContactFace;
use glam::{DMat3, DVec2, DVec3};

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
    let corners = &triangle.0;
    let mut height = f64::INFINITY;
    if let Some(normal) = triangle.normal() {
        let face = SweptFace::new(corners, normal, radius);
        if !face.is_steep() && face.is_outside(at, 0.0) == [false; 3] {
            height = face.height(at);
        }
    }
    for k in 0..3 {
        let edge = SweptEdge::new(corners[k], corners[(k + 1) % 3], radius, &[DVec3::ZERO; 2]);
        let beside = corner_height(corners[k], radius, at);
        height = height.min(edge.height(at)).min(beside);
    }
    (height < f64::INFINITY).then_some(height)
}

/// Returns the height of the centre of a ball that rises along the z axis until a triangle of a mesh stops it, metres; infinite if the ball misses the
/// triangle. `turn` turns the contact data `face` into the frame of the corners.
///
/// If the ball is under the face, no edge or corner is lower. Otherwise the function evaluates the sides that have the ball on their outer side, and the
/// corners of these sides. Edges and corners that belong to another triangle are not evaluated.
#[inline(always)]
pub(crate) fn stop(corners: &[DVec3; 3], face: &ContactFace, turn: &DMat3, radius: f64) -> f64 {
    let at = DVec2::ZERO;
    let swept = SweptFace::new(corners, *turn * face.normal, radius);
    let mut is_outside = [true; 3];
    if !swept.is_steep() {
        is_outside = swept.is_outside(at, FACE_SLACK * radius);
        if is_outside == [false; 3] {
            return swept.height(at);
        }
    }
    let mut height = f64::INFINITY;
    for k in 0..3 {
        let next = (k + 1) % 3;
        if face.has_edge(k) && is_outside[k] {
            let normals = [swept.normal, *turn * face.across[k]];
            let edge = SweptEdge::new(corners[k], corners[next], radius, &normals);
            if edge.is_beside(at) {
                height = height.min(edge.height(at));
            }
        }
        if (is_outside[k] || is_outside[next]) && face.has_corner(next) {
            height = height.min(corner_height(corners[next], radius, at));
        }
    }
    height
}

/// Returns the height of the ball's centre at which a corner of a triangle stops the ball, metres; infinite if the ball misses the corner.
#[inline(always)]
pub(crate) fn corner_height(corner: DVec3, radius: f64, at: DVec2) -> f64 {
    let q = radius * radius - at.distance_squared(corner.truncate());
    if q > 0.0 {
        corner.z - q.sqrt()
    } else {
        f64::INFINITY
    }
}

/// Face of a triangle, moved down by the ball's radius along the normal of the face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweptFace {
    pub corners: [DVec2; 3],
    /// Unit normal of the face.
    pub normal: DVec3,
    /// 1 if the normal points up, otherwise −1; the corners are then counter-clockwise, or clockwise, as seen from above.
    pub sign: f64,
    height_of_first: f64,
}

impl SweptFace {
    /// Creates the swept face from the triangle's corners and `normal`.
    #[inline(always)]
    pub fn new([a, b, c]: &[DVec3; 3], normal: DVec3, radius: f64) -> Self {
        let sign = if normal.z > 0.0 { 1.0 } else { -1.0 };
        let shift = -(sign * radius) * normal;
        Self {
            corners: [
                (*a + shift).truncate(),
                (*b + shift).truncate(),
                (*c + shift).truncate(),
            ],
            normal,
            sign,
            height_of_first: a.z + shift.z,
        }
    }

    /// Returns whether the face is vertical, so that only its edges and corners stop a ball.
    #[inline(always)]
    pub fn is_steep(&self) -> bool {
        self.sign * self.normal.z < STEEP
    }

    /// Returns the distance of a position from side `k`, positive inside, times the length of the side, m². Also returns the sum of the absolute components
    /// of the side, metres, which is at least its length.
    #[inline(always)]
    pub fn side(&self, k: usize, at: DVec2) -> [f64; 2] {
        let (from, to) = (self.corners[k], self.corners[(k + 1) % 3]);
        let edge = to - from;
        [
            self.sign * edge.perp_dot(at - from),
            edge.x.abs() + edge.y.abs(),
        ]
    }

    /// Returns, for each side of the face, whether a position is more than `slack` metres beyond the side.
    #[inline(always)]
    pub fn is_outside(&self, at: DVec2, slack: f64) -> [bool; 3] {
        [0, 1, 2].map(|k| {
            let [side, length] = self.side(k, at);
            side < -slack * length
        })
    }

    /// Returns the height at which the plane of the face stops the ball, metres.
    #[inline(always)]
    pub fn height(&self, at: DVec2) -> f64 {
        let rise = self.normal.truncate().dot(at - self.corners[0]);
        self.height_of_first - rise / self.normal.z
    }

    /// Lowers the heights of taxels in a row along x, at the positions (x, y), to the heights at which the face stops them, metres. The face extends by
    /// `slack` metres beyond its sides.
    #[inline(always)]
    pub fn lower_row(&self, y: f64, x: &[f64], slack: f64, heights: &mut [f64]) {
        let [a, b, c] = self.corners;
        let sign = self.sign;
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
/// A face hides the edge if the direction from the edge to the centre of the stopped ball points towards the face. The hidden region begins where the face,
/// moved down by the radius, begins: at the distance ρ n·aside beside the edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweptEdge {
    from: DVec3,
    edge: DVec3,
    /// Squared lengths of the edge's projection onto the ground, and of the edge, m².
    length2: f64,
    whole2: f64,
    radius: f64,
    /// Range of distances beside the edge in which the edge can stop the ball, positive to the left. The distances are multiples of the edge's projected
    /// length.
    low: f64,
    high: f64,
    normals: [DVec3; 2],
}

impl SweptEdge {
    /// Creates the swept edge. `normals` are the unit normals of the faces at the edge, zero for a missing face. Seen from above, a face whose normal points
    /// up lies to the left of the edge. A face whose normal points down lies to the right.
    #[inline(always)]
    pub fn new(from: DVec3, to: DVec3, radius: f64, normals: &[DVec3; 2]) -> Self {
        let edge = to - from;
        let slack = HIDDEN_SLACK * radius * (edge.y.abs() + edge.x.abs());
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for normal in normals {
            let shift = radius * (normal.x * -edge.y + normal.y * edge.x);
            let is_left = normal.z > 0.0;
            let is_right = !is_left & ((normal.z < 0.0) | (shift != 0.0));
            let (right_end, left_end) = (slack - shift, shift - slack);
            high = if is_left & (right_end < high) {
                right_end
            } else {
                high
            };
            low = if is_right & (left_end > low) {
                left_end
            } else {
                low
            };
        }
        let length2 = edge.x * edge.x + edge.y * edge.y;
        Self {
            from,
            edge,
            length2,
            whole2: length2 + edge.z * edge.z,
            radius,
            low,
            high,
            normals: *normals,
        }
    }

    /// Returns the lowest and the highest corner of a rectangle (x, y) that contains all positions at which the edge can stop the ball.
    ///
    /// These positions are the edge moved by the ball's radius ρ along all directions between its faces' normals. The arc of directions deviates from its
    /// chord by at most ρ (1 − cos β) / 2, where β is the angle between the normals.
    #[inline]
    pub fn ground(&self) -> (DVec2, DVec2) {
        let (from, to) = (self.from.truncate(), (self.from + self.edge).truncate());
        let (low, high) = (from.min(to), from.max(to));
        let [a, b] = self.normals;
        if a.z * b.z >= 0.0 {
            return (low - self.radius, high + self.radius);
        }
        // Both normals pointing down.
        let (a, b) = if a.z > 0.0 { (-a, b) } else { (a, -b) };
        let arc = self.radius * (0.5 - 0.5 * a.dot(b)) + 1e-5 * self.radius;
        let (a, b) = (self.radius * a.truncate(), self.radius * b.truncate());
        (low + a.min(b) - arc, high + a.max(b) + arc)
    }

    /// Returns the distance of a position beside the edge, positive to the left, times the projected length of the edge, m².
    #[inline(always)]
    fn beside(&self, at: DVec2) -> f64 {
        self.edge.x * (at.y - self.from.y) - self.edge.y * (at.x - self.from.x)
    }

    /// Returns whether a position is beside the visible part of the edge. If not, the height is infinite.
    #[inline(always)]
    pub fn is_beside(&self, at: DVec2) -> bool {
        let beside = self.beside(at);
        (self.length2 > STEEP * STEEP * self.whole2)
            & (beside >= self.low)
            & (beside <= self.high)
            & (beside * beside <= self.radius * self.radius * self.length2)
    }

    /// Returns the height of the ball's centre at which the visible part of the edge stops the ball, metres; infinite if the ball misses this part.
    #[inline(always)]
    pub fn height(&self, at: DVec2) -> f64 {
        let (x, y) = (at.x - self.from.x, at.y - self.from.y);
        let (length, whole) = (self.length2.sqrt(), self.whole2.sqrt());
        let (sine, cosine) = (self.edge.z / whole, length / whole);
        let d = self.beside(at) / length;
        let r2 = self.radius * self.radius - d * d;
        let r = (if r2 > 0.0 { r2 } else { 0.0 }).sqrt();
        let foot = (self.edge.x * x + self.edge.y * y) / length - r * sine;
        let is_edge = self.is_beside(at) & (foot >= 0.0) & (foot <= length);
        let height = self.from.z + foot * (self.edge.z / length) - r * cosine;
        if is_edge { height } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    /// Where the faces end, rounding decides on which side of the border a taxel is. The edge reaches beyond both borders, so no taxel slips through.
    #[test]
    fn between_two_faces_without_slack_and_their_edge_there_is_no_gap() {
        let mut rng = Seed::new(5).named("borders").rng();
        let mut n_borders = 0;
        for case in 0..20_000 {
            let mut random = |size: f64| {
                DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0))) * size
            };
            let (from, to) = (random(0.05), random(0.05));
            let others = [random(0.05), random(0.05)];
            let (part, radius) = (0.5 + random(0.4).x, 2e-3 + random(1e-3).x);
            let (Some(one), Some(other)) = (
                Triangle([from, to, others[0]]).normal(),
                Triangle([to, from, others[1]]).normal(),
            ) else {
                continue;
            };
            // Both faces must look down at the ball that comes from below, and the edge must be a ridge.
            let is_ridge = one.dot(others[1] - from) < -1e-3 && one.z < -1e-2 && other.z < -1e-2;
            if !is_ridge {
                continue;
            }
            let faces = [
                SweptFace::new(&[from, to, others[0]], one, radius),
                SweptFace::new(&[to, from, others[1]], other, radius),
            ];
            let edge = SweptEdge::new(from, to, radius, &[one, -other]);
            for normal in [one, other] {
                let border = from.lerp(to, part).truncate() + radius * normal.truncate();
                for step in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                    let at = border * (1.0 + step * f64::EPSILON);
                    let is_under = |face: &SweptFace| face.side(0, at)[0] >= 0.0;
                    let is_stopped = faces.iter().any(is_under) || edge.is_beside(at);
                    assert!(is_stopped, "case {case}: {at}");
                    n_borders += 1;
                }
            }
        }
        assert!(n_borders > 1_000, "{n_borders}");
    }
}
