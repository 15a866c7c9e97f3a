//! Centre of mass of a solid: closed forms of its shapes, corrected where shapes overlap.
//!
//! Let χ = 1 in the solid and χᵢ = 1 in shape i of the union, otherwise 0. The volume is ∫ χ dx = Σᵢ ∫ χᵢ dx + ∫ (χ − Σᵢ χᵢ) dx, and the first moment
//! likewise. The first integrals have closed forms. The last integrand is 0 except where shapes overlap or are subtracted. This region is divided into
//! cubes until the integrand is constant, or until the cubes are small. In a small cube, surfaces count as planes.

use super::{Part, Shape, Solid};
use glam::DVec3;
use std::f64::consts::PI;

/// Number of times that the cube around a solid is halved. If larger, overlapping shapes take four times as long per halving; if smaller, the surfaces of
/// overlaps are less accurate. With 8, the edges of overlaps are accurate to 0.4 % of the longest side.
const MAX_HALVINGS: usize = 8;

/// Volume and its first moment.
#[derive(Clone, Copy, Debug, Default)]
struct Mass {
    /// Volume, m³.
    volume: f64,
    /// Integral of the position over the volume, m⁴.
    moment: DVec3,
}

impl Mass {
    fn add(&mut self, volume: f64, center: DVec3) {
        self.volume += volume;
        self.moment += volume * center;
    }
}

impl Solid {
    /// Returns the centre of mass of the homogeneous solid, metres. The result is exact if shapes neither overlap nor are subtracted; otherwise, the error is
    /// below 0.1 % of the longest side.
    pub fn center_of_mass(&self) -> DVec3 {
        let bounds = self.bounds();
        let origin = bounds.center();
        let [parts, cuts] = [self.parts(), self.cuts()].map(|parts| {
            parts
                .iter()
                .flat_map(Part::convex_links)
                .collect::<Vec<Part>>()
        });
        let mut mass = Mass::default();
        for part in &parts {
            let (volume, center) = part.volume_and_center();
            mass.add(volume, center - origin);
        }
        let cube = Cube {
            center: origin,
            half: 0.5 * bounds.size().max_element(),
            n_halvings: 0,
        };
        let parts = parts.iter().map(|part| (part, false));
        let all: Vec<(&Part, bool)> = parts.chain(cuts.iter().map(|cut| (cut, true))).collect();
        add_overlaps(cube, &all, Depth::default(), &mut |volume, center| {
            mass.add(volume, center - origin);
        });
        origin + mass.moment / mass.volume
    }
}

#[derive(Clone, Copy)]
struct Cube {
    center: DVec3,
    /// Half the side, metres.
    half: f64,
    n_halvings: usize,
}

/// Shapes that contain a point.
#[derive(Clone, Copy, Default)]
struct Depth {
    n_parts: usize,
    n_cuts: usize,
}

impl Depth {
    fn with(self, is_cut: bool) -> Self {
        Self {
            n_parts: self.n_parts + usize::from(!is_cut),
            n_cuts: self.n_cuts + usize::from(is_cut),
        }
    }

    /// Returns the integrand χ − Σᵢ χᵢ.
    fn excess(self) -> f64 {
        f64::from(u8::from(self.n_parts > 0 && self.n_cuts == 0)) - self.n_parts as f64
    }
}

/// Integrates χ − Σᵢ χᵢ over a cube. `near` contains the shapes, and whether each is subtracted, whose surfaces may cross the cube; `depth` counts the other
/// shapes that contain it. Each call of `add` has the integral over a cube and the centre of this cube.
fn add_overlaps(
    cube: Cube,
    near: &[(&Part, bool)],
    mut depth: Depth,
    add: &mut impl FnMut(f64, DVec3),
) {
    let reach = cube.half * 3f64.sqrt();
    let mut crossing = Vec::with_capacity(near.len());
    for &(part, is_cut) in near {
        let distance = part.distance(cube.center);
        if distance.abs() < reach {
            crossing.push((part, is_cut, distance));
        } else if distance < 0.0 {
            depth = depth.with(is_cut);
        }
    }
    let n_parts = depth.n_parts + crossing.iter().filter(|(_, is_cut, _)| !is_cut).count();
    if n_parts == 0
        || (n_parts == 1 && depth.n_cuts == 0 && crossing.iter().all(|(_, is_cut, _)| !is_cut))
    {
        return;
    }
    let volume = (2.0 * cube.half).powi(3);
    if crossing.is_empty() {
        add(volume * depth.excess(), cube.center);
    } else if cube.n_halvings == MAX_HALVINGS {
        add(volume * mean_excess(cube, crossing, depth), cube.center);
    } else {
        let near: Vec<(&Part, bool)> = crossing
            .iter()
            .map(|&(part, is_cut, _)| (part, is_cut))
            .collect();
        for corner in corners() {
            let half = 0.5 * cube.half;
            let cube = Cube {
                center: cube.center + half * corner,
                half,
                n_halvings: cube.n_halvings + 1,
            };
            add_overlaps(cube, &near, depth, add);
        }
    }
}

/// Returns the mean of χ − Σᵢ χᵢ over a small cube. A surface at the distance d from the centre leaves the fraction ½ − d / side of the cube inside, which is
/// right on average over all positions of a plane.
fn mean_excess(cube: Cube, crossing: Vec<(&Part, bool, f64)>, mut depth: Depth) -> f64 {
    let mut cut_by = Vec::with_capacity(crossing.len());
    for &(part, is_cut, distance) in &crossing {
        let inside = 0.5 - 0.5 * distance / cube.half;
        if inside > 0.0 && inside < 1.0 {
            cut_by.push((part, is_cut, distance, inside));
        } else if inside >= 1.0 {
            depth = depth.with(is_cut);
        }
    }
    match cut_by[..] {
        [] => depth.excess(),
        [(_, is_cut, _, inside)] => {
            inside * depth.with(is_cut).excess() + (1.0 - inside) * depth.excess()
        }
        [
            (one, is_cut, distance, inside),
            (two, is_other_cut, other_distance, other_inside),
        ] => {
            let rises = corners().map(|corner| {
                let point = cube.center + cube.half * corner;
                (one.distance(point) - distance) * (two.distance(point) - other_distance)
            });
            // Parallel planes: the insides of two planes that face the same way contain each other, otherwise they overlap as little as possible.
            let both = match rises.sum::<f64>() > 0.0 {
                true => inside.min(other_inside),
                false => (inside + other_inside - 1.0).max(0.0),
            };
            both * depth.with(is_cut).with(is_other_cut).excess()
                + (inside - both) * depth.with(is_cut).excess()
                + (other_inside - both) * depth.with(is_other_cut).excess()
                + (1.0 - inside - other_inside + both) * depth.excess()
        }
        _ => {
            let around = cut_by.iter().filter(|(.., inside)| *inside > 0.5);
            around
                .fold(depth, |depth, &(_, is_cut, ..)| depth.with(is_cut))
                .excess()
        }
    }
}

/// Returns the directions from the middle of a cube of side 2 to its corners.
fn corners() -> impl Iterator<Item = DVec3> {
    let sign = |corner: u8, axis: u8| f64::from(2 * (corner >> axis & 1)) - 1.0;
    (0..8).map(move |corner| DVec3::new(sign(corner, 0), sign(corner, 1), sign(corner, 2)))
}

impl Part {
    /// Returns parts with the same union: a sphere sweep of several balls becomes the hulls of neighbouring balls.
    fn convex_links(&self) -> Vec<Self> {
        match self.shape() {
            Shape::SphereSweep { points, diameters } if points.len() > 2 => {
                let links = points.windows(2).zip(diameters.windows(2));
                let link = |(points, diameters): (&[DVec3], &[f64])| {
                    let (points, diameters) = (points.to_vec(), diameters.to_vec());
                    self.reshaped(Shape::SphereSweep { points, diameters })
                };
                links.map(link).collect()
            }
            _ => vec![self.clone()],
        }
    }
}

/// Returns the volume of a slice of a solid of revolution between two heights z, m³, and the integral of z over this volume, m⁴.
///
/// `square` is the squared distance of the surface from the axis, a polynomial in z of at most the second degree. Simpson's rule is therefore exact.
pub(super) fn turned(low: f64, high: f64, square: impl Fn(f64) -> f64) -> [f64; 2] {
    let nodes = [(low, 1.0), (0.5 * (low + high), 4.0), (high, 1.0)];
    let areas = nodes.map(|(z, weight)| (z, PI * square(z) * weight * (high - low) / 6.0));
    [
        areas.iter().map(|(_, part)| part).sum(),
        areas.iter().map(|(z, part)| z * part).sum(),
    ]
}
