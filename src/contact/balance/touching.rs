//! Spheres of free objects on what is rigid: planes, obstacles, and one another.

use super::body::Body;
use super::free_object::Ground;
use super::pairs::{Key, Kind, Pair, Part, Rigid};
use crate::objects::Sphere;
use glam::{DMat3, DVec3};

/// How far a sphere is inside of something rigid, and what that depends on; in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    /// Unit, out of it to the sphere.
    pub normal: DVec3,
    /// Between the middles of two spheres, metres; endless from a plane.
    distance: f64,
    /// The body that the sphere touches, and where the centre of its sphere is from its centre of mass; `None` of what does not move.
    pub other: Option<(u32, DVec3)>,
}

impl Touching {
    /// ∂δ/∂c and ∂²δ/∂c² (1/m) by how the sphere's centre moves, less how the other one's does.
    pub fn derivatives(&self) -> (DVec3, DMat3) {
        let n = self.normal;
        let along = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        (-n, (DMat3::IDENTITY - along) * (-1.0 / self.distance))
    }
}

/// Appends the pairs of all spheres that are inside of something rigid, or nearer to it than each may move, metres; sorted.
pub(super) fn gather(pairs: &mut Vec<Pair>, bodies: &[Body], ground: &Ground, may_move: f64) {
    let first = pairs.len();
    for (slot, body) in bodies.iter().enumerate() {
        for (plane, number) in ground.planes.iter().zip(0..) {
            let above = |center: DVec3| center.dot(plane.normal) - plane.height;
            if above(body.center) >= body.arm() + may_move {
                continue;
            }
            for (index, sphere) in body.spheres_near(body.center, f64::INFINITY) {
                let deflection = sphere.radius - above(sphere.center);
                if deflection > -may_move {
                    pairs.push(Pair {
                        key: Key::Rigid((slot as u32, index), Rigid::Plane(number)),
                        part: (slot as u32, index),
                        deflection,
                        kind: Kind::Rigid(Touching {
                            normal: plane.normal,
                            distance: f64::INFINITY,
                            other: None,
                        }),
                        arm: sphere.center - body.center,
                    });
                }
            }
        }
        for (obstacle, number) in ground.obstacles.iter().zip(0..) {
            let spheres = obstacle.spheres.spheres().iter().zip(0..);
            let placed = spheres.filter_map(|(sphere, index)| {
                let center = obstacle.pose.transform_point(sphere.center);
                let reach = sphere.radius + body.arm() + may_move;
                let is_near = center.distance_squared(body.center) <= reach * reach;
                is_near.then_some((index, Sphere { center, ..*sphere }))
            });
            let placed: Vec<_> = placed.collect();
            // Those of the body that meet the ball around what is near of the obstacle: all, since that is about the body.
            let own: Vec<_> = body.spheres_near(body.center, f64::INFINITY).collect();
            each_touching(&own, &placed, may_move, |own, other| {
                let rigid = Rigid::Obstacle(number, other.0);
                pairs.push(touch((slot as u32, body), own, other, rigid, None));
            });
        }
        for (other_slot, other) in bodies.iter().enumerate().skip(slot + 1) {
            let reach = body.arm() + other.arm() + 2.0 * may_move;
            if body.center.distance_squared(other.center) > reach * reach {
                continue;
            }
            let own: Vec<_> = body
                .spheres_near(other.center, other.arm() + 2.0 * may_move)
                .collect();
            let others: Vec<_> = other
                .spheres_near(body.center, body.arm() + 2.0 * may_move)
                .collect();
            each_touching(&own, &others, 2.0 * may_move, |own, sphere| {
                let part = (other_slot as u32, sphere.0);
                let arm = Some((other_slot as u32, sphere.1.center - other.center));
                let rigid = Rigid::Body(part);
                pairs.push(touch((slot as u32, body), own, sphere, rigid, arm));
            });
        }
    }
    pairs[first..].sort_unstable_by_key(|pair| pair.key);
}

fn touch(
    (slot, body): (u32, &Body),
    (index, own): (u32, Sphere),
    (_, sphere): (u32, Sphere),
    rigid: Rigid,
    other: Option<(u32, DVec3)>,
) -> Pair {
    let between = own.center - sphere.center;
    let part: Part = (slot, index);
    Pair {
        key: Key::Rigid(part, rigid),
        part,
        deflection: own.radius + sphere.radius - between.length(),
        kind: Kind::Rigid(Touching {
            // Of two in the same place, whichever.
            normal: between.try_normalize().unwrap_or(DVec3::Z),
            distance: between.length().max(f64::MIN_POSITIVE),
            other,
        }),
        arm: own.center - body.center,
    }
}

/// Visits all pairs of spheres that are less than `gap` apart: sorted along the way from the middle of one list to that of the other,
/// where most are past each other.
fn each_touching(
    one: &[(u32, Sphere)],
    other: &[(u32, Sphere)],
    gap: f64,
    mut visit: impl FnMut((u32, Sphere), (u32, Sphere)),
) {
    let middle = |all: &[(u32, Sphere)]| {
        let sum: DVec3 = all.iter().map(|(_, sphere)| sphere.center).sum();
        sum / all.len().max(1) as f64
    };
    let way = (middle(other) - middle(one))
        .try_normalize()
        .unwrap_or(DVec3::Z);
    let begin = |sphere: &Sphere| sphere.center.dot(way) - sphere.radius;
    let mut sorted: Vec<_> = other.iter().map(|part| (begin(&part.1), part)).collect();
    sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    for own in one {
        let end = own.1.center.dot(way) + own.1.radius + gap;
        for (_, part) in sorted.iter().take_while(|(begin, _)| *begin < end) {
            let reach = own.1.radius + part.1.radius + gap;
            if own.1.center.distance_squared(part.1.center) < reach * reach {
                visit(*own, **part);
            }
        }
    }
}
