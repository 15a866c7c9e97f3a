//! Meshes that overlap themselves, and a judge of packings that knows nothing of the library's own geometry.

use crate::mesh_shapes::{cuboid, icosphere};
use bubbletouch::geometry::Pose;
use bubbletouch::mesh::TriangleMesh;
use bubbletouch::objects::SphereUnion;
use glam::{DQuat, DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

const MM: f64 = 1e-3;

/// All triangles of all parts.
pub fn together(parts: &[TriangleMesh]) -> TriangleMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for part in parts {
        let shift = vertices.len() as u32;
        vertices.extend_from_slice(part.vertices());
        triangles.extend(part.triangles().iter().map(|t| t.map(|c| c + shift)));
    }
    TriangleMesh::new("parts", vertices, triangles).unwrap()
}

/// A closed outline (millimetres; x from the axis, y along it; counter-clockwise) turned about the z axis.
pub fn turned(outline: &[(f64, f64)], n_around: usize) -> TriangleMesh {
    let n = outline.len();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for step in 0..n_around {
        let turn = DVec2::from_angle(TAU * step as f64 / n_around as f64);
        for (k, &(r, z)) in outline.iter().enumerate() {
            vertices.push(MM * (turn * r).extend(z));
            let corner = |step: usize, k: usize| (step % n_around * n + k % n) as u32;
            let [a, b] = [corner(step, k), corner(step + 1, k)];
            let [c, d] = [corner(step + 1, k + 1), corner(step, k + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriangleMesh::new("turned", vertices, triangles).unwrap()
}

fn block(x: f64, y: f64, z: f64) -> TriangleMesh {
    cuboid(0.5 * MM * DVec3::new(x, y, z))
}

fn rod(radius: f64, height: f64) -> TriangleMesh {
    let h = 0.5 * height;
    turned(&[(1e-3, -h), (radius, -h), (radius, h), (1e-3, h)], 20)
}

fn torus() -> TriangleMesh {
    let corner = |k: usize| DVec2::new(9.0, 0.0) + 2.5 * DVec2::from_angle(TAU * k as f64 / 12.0);
    let outline: Vec<(f64, f64)> = (0..12).map(|k| corner(k).into()).collect();
    turned(&outline, 24)
}

fn cup() -> TriangleMesh {
    let outline = [
        (6.0, 0.0),
        (8.0, 18.0),
        (7.0, 18.0),
        (5.2, 1.0),
        (1e-3, 1.0),
        (1e-3, 0.0),
    ];
    turned(&outline, 16)
}

fn ball(radius: f64) -> TriangleMesh {
    icosphere(MM * radius, 2)
}

/// Turned by a rotation vector (radians), then shifted (millimetres).
fn put(mesh: &TriangleMesh, turn: [f64; 3], shift: [f64; 3]) -> TriangleMesh {
    let turn = DQuat::from_scaled_axis(DVec3::from_array(turn));
    mesh.moved(&Pose::new(turn, MM * DVec3::from_array(shift)))
}

fn at(mesh: TriangleMesh, shift: [f64; 3]) -> TriangleMesh {
    put(&mesh, [0.0; 3], shift)
}

/// The same faces, looking the other way.
fn inside_out(mesh: &TriangleMesh) -> TriangleMesh {
    let triangles = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]);
    let vertices = mesh.vertices().to_vec();
    TriangleMesh::new("inside out", vertices, triangles.collect()).unwrap()
}

/// Parts with poses that depend on a number alone.
fn heap(number: u64, part: impl Fn(usize) -> TriangleMesh) -> TriangleMesh {
    let mut state = number;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    let parts: Vec<TriangleMesh> = (0..5)
        .map(|k| {
            let turn = [random(), random(), random()].map(|r| PI * r);
            put(
                &part(k),
                turn,
                [random(), random(), random()].map(|r| 7.0 * r),
            )
        })
        .collect();
    together(&parts)
}

/// A plate whose two large triangles on top have a post on their middle and near each corner, and are free all around.
fn plate_with_posts() -> TriangleMesh {
    let plate = block(24.0, 24.0, 4.0);
    let mut parts = vec![plate.clone()];
    for corners in (0..plate.n_triangles()).map(|t| plate.triangle(t)) {
        if corners.0.iter().all(|corner| corner.z > 0.0) {
            let middle = corners.middle();
            let near = corners.0.map(|corner| corner.lerp(middle, 0.2));
            for place in [middle, near[0], near[1], near[2]] {
                parts.push(at(block(1.5, 1.5, 6.0), (place / MM).to_array()));
            }
        }
    }
    together(&parts)
}

/// Closed parts that overlap, one object each.
pub fn objects() -> Vec<(&'static str, TriangleMesh)> {
    let quarter = 0.25 * TAU;
    let bars = [
        block(24.0, 5.0, 5.0),
        block(5.0, 24.0, 5.0),
        block(5.0, 5.0, 24.0),
    ];
    let link = |k: usize| {
        put(
            &torus(),
            [quarter * k as f64, 0.0, 0.0],
            [14.0 * k as f64, 0.0, 0.0],
        )
    };
    let two = |a: TriangleMesh, b: TriangleMesh| together(&[a, b]);
    vec![
        ("plate with posts", plate_with_posts()),
        ("crossing bars", together(&bars)),
        ("flat cross", two(bars[0].clone(), bars[1].clone())),
        (
            "sunken lid",
            two(
                block(30.0, 30.0, 6.0),
                at(block(25.0, 25.0, 6.0), [0.0, 0.0, 4.0]),
            ),
        ),
        (
            "lid on its box, face on face",
            two(
                block(20.0, 20.0, 6.0),
                at(block(14.0, 14.0, 6.0), [0.0, 0.0, 6.0]),
            ),
        ),
        (
            "boxes with one whole face in common",
            two(
                block(12.0, 9.0, 6.0),
                at(block(12.0, 9.0, 6.0), [12.0, 0.0, 0.0]),
            ),
        ),
        (
            "bars with tops in one plane, turned",
            two(
                block(20.0, 8.0, 5.0),
                put(&block(20.0, 8.0, 5.0), [0.0, 0.0, 0.5], [0.0; 3]),
            ),
        ),
        (
            "a box twice",
            two(block(12.0, 9.0, 6.0), block(12.0, 9.0, 6.0)),
        ),
        (
            "needle through a plate",
            two(block(24.0, 24.0, 1.0), block(0.8, 0.8, 30.0)),
        ),
        (
            "corner out of a box",
            two(
                block(16.0, 16.0, 16.0),
                put(&block(16.0, 16.0, 16.0), [0.6, 0.6, 0.0], [2.0, 0.0, 0.0]),
            ),
        ),
        (
            "crossing rods",
            two(
                rod(4.0, 24.0),
                put(&rod(3.0, 24.0), [quarter, 0.0, 0.0], [1.0, 0.0, 0.0]),
            ),
        ),
        (
            "rod and its turned copy",
            two(
                rod(6.0, 12.0),
                put(&rod(6.0, 12.0), [0.0, 0.0, 0.1], [0.0; 3]),
            ),
        ),
        (
            "rod through a box",
            two(block(14.0, 14.0, 8.0), rod(4.0, 22.0)),
        ),
        (
            "rod sunk in a box",
            two(block(18.0, 18.0, 8.0), at(rod(7.0, 8.0), [0.0, 0.0, 1.0])),
        ),
        ("two balls", two(ball(8.0), at(ball(8.0), [7.0, 0.0, 0.0]))),
        (
            "ball and its turned copy",
            two(ball(9.0), put(&ball(9.0), [0.3, 0.1, 0.2], [0.0; 3])),
        ),
        (
            "ball in the face of a box",
            two(block(20.0, 20.0, 8.0), at(ball(7.0), [0.0, 0.0, 4.0])),
        ),
        (
            "marbles",
            together(&[0, 1, 2, 3, 4, 5].map(|k| {
                let k = f64::from(k);
                at(
                    ball(6.0),
                    [7.0 * (k % 3.0), 9.0 * (k / 3.0).floor(), 2.0 * (k % 2.0)],
                )
            })),
        ),
        (
            "links that cut each other",
            together(&[link(0), link(1), link(2)]),
        ),
        (
            "links that hang free",
            two(torus(), put(&torus(), [quarter, 0.0, 0.0], [9.0, 0.0, 0.0])),
        ),
        (
            "stacked cups",
            together(&[0.0, 4.0, 8.0].map(|z| at(cup(), [0.0, 0.0, z]))),
        ),
        ("ball in a ball", two(ball(9.0), ball(6.0))),
        (
            "hollow box",
            two(block(18.0, 14.0, 12.0), inside_out(&block(12.0, 8.0, 6.0))),
        ),
        (
            "rod through the wall of a hollow box",
            together(&[
                block(18.0, 14.0, 12.0),
                inside_out(&block(12.0, 8.0, 6.0)),
                put(&rod(2.0, 14.0), [0.0, quarter, 0.0], [8.0, 0.0, 0.0]),
            ]),
        ),
        (
            "heap of boxes",
            heap(1, |k| block(12.0, 6.0, 2.0 + k as f64)),
        ),
        (
            "heap of plates",
            heap(2, |k| block(18.0, 14.0, 0.7 + 0.3 * k as f64)),
        ),
        (
            "heap of everything",
            heap(3, |k| match k {
                0 => block(14.0, 8.0, 5.0),
                1 => rod(3.0, 16.0),
                2 => ball(5.0),
                3 => torus(),
                _ => cup(),
            }),
        ),
    ]
}

/// Judges by sums over all triangles, and looks at samples of its own.
pub struct Judge<'a> {
    mesh: &'a TriangleMesh,
}

/// The largest distances that were found, metres; 0 if none is outside.
#[derive(Debug)]
pub struct Found {
    /// From points of the boundary of the solid to the spheres.
    pub gap: f64,
    /// From points of the spheres to the solid.
    pub protrusion: f64,
    /// Points of the boundary.
    pub n_outer: usize,
}

/// How far beside a face it is asked what is there, metres.
const BESIDE: f64 = 1e-9;

impl<'a> Judge<'a> {
    pub fn new(mesh: &'a TriangleMesh) -> Self {
        Self { mesh }
    }

    /// How often the mesh goes around a point: the sum of solid angles (van Oosterom and Strackee 1983).
    fn winding(&self, point: DVec3) -> f64 {
        let angle = |t: usize| {
            let [a, b, c] = self.mesh.triangle(t).0.map(|corner| corner - point);
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            a.dot(b.cross(c)).atan2(below)
        };
        (0..self.mesh.n_triangles()).map(angle).sum::<f64>() / TAU
    }

    fn is_inside(&self, point: DVec3) -> bool {
        self.winding(point) > 0.5
    }

    /// To the nearest triangle.
    fn distance(&self, point: DVec3) -> f64 {
        let triangles = (0..self.mesh.n_triangles()).map(|t| self.mesh.triangle(t).0);
        triangles
            .map(|corners| to_triangle(point, corners))
            .fold(f64::INFINITY, f64::min)
    }

    /// Looks from `n_points` points all over the mesh, about as many near corners and middles of edges, and points all over the
    /// spheres.
    pub fn look(&self, spheres: &SphereUnion, n_points: usize) -> Found {
        let places = self.places(n_points);
        let gaps: Vec<f64> = places
            .par_iter()
            .filter(|&&(point, normal)| {
                !self.is_inside(point + BESIDE * normal) && self.is_inside(point - BESIDE * normal)
            })
            .map(|&(point, _)| {
                let to = |s: &bubbletouch::objects::Sphere| point.distance(s.center) - s.radius;
                let nearest = spheres
                    .spheres()
                    .iter()
                    .map(to)
                    .fold(f64::INFINITY, f64::min);
                nearest.max(0.0)
            })
            .collect();
        let a_sphere = (n_points / spheres.n_spheres()).max(4);
        let protrusion = |index: usize| {
            let sphere = &spheres.spheres()[index / a_sphere];
            let point = sphere.center + sphere.radius * spread(index % a_sphere, a_sphere);
            if self.is_inside(point) {
                0.0
            } else {
                self.distance(point)
            }
        };
        let n = a_sphere * spheres.n_spheres();
        Found {
            n_outer: gaps.len(),
            gap: gaps.into_iter().fold(0.0, f64::max),
            protrusion: (0..n)
                .into_par_iter()
                .map(protrusion)
                .reduce(|| 0.0, f64::max),
        }
    }

    /// Places on triangles and their normals: by area, and near corners and the middles of edges.
    fn places(&self, n_points: usize) -> Vec<(DVec3, DVec3)> {
        let area: f64 = (0..self.mesh.n_triangles())
            .map(|t| self.mesh.triangle(t).area())
            .sum();
        let (mut places, mut due) = (Vec::new(), 0.0);
        let every = (6 * self.mesh.n_triangles()).div_ceil(n_points);
        for t in 0..self.mesh.n_triangles() {
            let [a, b, c] = self.mesh.triangle(t).0;
            let normal = (b - a).cross(c - a);
            if normal.length() < 1e-9 * (a - b).length_squared().max((a - c).length_squared()) {
                continue;
            }
            let normal = normal.normalize();
            let mut weights = Vec::new();
            if t % every == 0 {
                let near = |k: usize| {
                    let mut w = [1e-4; 3];
                    w[k] = 1.0 - 2e-4;
                    w
                };
                weights.extend([near(0), near(1), near(2)]);
                weights.extend([
                    [0.4999, 0.4999, 2e-4],
                    [2e-4, 0.4999, 0.4999],
                    [0.4999, 2e-4, 0.4999],
                ]);
            }
            due += self.mesh.triangle(t).area() / area * n_points as f64;
            while due >= 1.0 {
                due -= 1.0;
                // The R2 sequence, folded into the triangle.
                let n = places.len() as f64;
                let (u, v) = ((0.754_877_666 * n).fract(), (0.569_840_291 * n).fract());
                let (u, v) = if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                };
                places.push((a + u * (b - a) + v * (c - a), normal));
            }
            let place = |[wa, wb, wc]: [f64; 3]| (wa * a + wb * b + wc * c, normal);
            places.extend(weights.into_iter().map(place));
        }
        places
    }
}

/// One of `n` directions spread evenly over the sphere.
fn spread(number: usize, n: usize) -> DVec3 {
    let z = 1.0 - (2 * number + 1) as f64 / n as f64;
    let turn = DVec2::from_angle(2.399_963_229_728_653 * number as f64) * (1.0 - z * z).sqrt();
    turn.extend(z)
}

/// Ericson, *Real-time collision detection*, 2005, 5.1.5: by the Voronoi region of the corners.
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.length();
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return bp.length();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ap - ab * (d1 / (d1 - d3))).length();
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return cp.length();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (ap - ac * (d2 / (d2 - d6))).length();
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (bp - (c - b) * along).length();
    }
    let scale = 1.0 / (va + vb + vc);
    (ap - ab * (vb * scale) - ac * (vc * scale)).length()
}
