//! Contacts between spheres of free objects and planes, obstacles, and other free objects.

use super::body::Body;
use super::free_object::{Ground, HalfSpace};
use super::pair::{Key, Kind, Pair, Part};
use super::rigid_contact::{Touched, Touching};
use crate::geometry::Pose;
use crate::objects::Sphere;
use glam::{DMat3, DVec3};

/// Spheres of another body or of an obstacle, which a sphere of the body may touch.
struct Others<'a> {
    spheres: &'a [Sphere],
    pose: Pose,
    /// Index and centre of mass of the body that owns the spheres; `None` for an obstacle.
    body: Option<(u32, DVec3)>,
}

/// Appends the pairs of spheres that penetrate a rigid counterpart or are nearer to it than `may_move` metres; sorted.
pub(super) fn gather_rigid(pairs: &mut Vec<Pair>, bodies: &[Body], ground: &Ground, may_move: f64) {
    let first = pairs.len();
    for (body, slot) in bodies.iter().zip(0..) {
        for (number, plane) in ground.planes.iter().enumerate() {
            gather_plane(pairs, (slot, body), (number, plane), may_move);
        }
        for (number, obstacle) in ground.obstacles.iter().enumerate() {
            let others = Others {
                spheres: obstacle.spheres.spheres(),
                pose: obstacle.pose,
                body: None,
            };
            let touched = |sphere| Touched::Obstacle(number, sphere);
            gather_spheres(pairs, (slot, body), &others, touched, may_move);
        }
        for (other, number) in bodies.iter().zip(0..).skip(slot as usize + 1) {
            let reach = body.arm() + other.arm() + 2.0 * may_move;
            if body.center.distance_squared(other.center) > reach * reach {
                continue;
            }
            let others = Others {
                spheres: other.object.spheres,
                pose: other.pose(),
                body: Some((number, other.center)),
            };
            let touched = |sphere| Touched::Object(number as usize, sphere);
            gather_spheres(pairs, (slot, body), &others, touched, 2.0 * may_move);
        }
    }
    pairs[first..].sort_unstable_by_key(|pair| pair.key);
}

fn gather_plane(
    pairs: &mut Vec<Pair>,
    (slot, body): (u32, &Body),
    (number, plane): (usize, &HalfSpace),
    may_move: f64,
) {
    let above = |center: DVec3| center.dot(plane.normal) - plane.height;
    if above(body.center) >= body.arm() + may_move {
        return;
    }
    for (index, sphere) in placed(body.object.spheres, &body.pose()) {
        let deflection = sphere.radius - above(sphere.center);
        if deflection > -may_move {
            pairs.push(Pair {
                key: Key::Rigid((slot, index), Touched::Plane(number)),
                part: (slot, index),
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

/// Collects the pairs of a body's spheres and other spheres that are less than `gap` metres apart. Spheres are sorted along the line from the body to the
/// middle of the nearby others, so the sweep skips most pairs.
fn gather_spheres(
    pairs: &mut Vec<Pair>,
    (slot, body): (u32, &Body),
    others: &Others,
    touched: impl Fn(usize) -> Touched,
    gap: f64,
) {
    let is_near = |(_, sphere): &(u32, Sphere)| {
        let reach = sphere.radius + body.arm() + gap;
        sphere.center.distance_squared(body.center) <= reach * reach
    };
    let mut near: Vec<_> = placed(others.spheres, &others.pose)
        .filter(is_near)
        .collect();
    let middle = near.iter().map(|other| other.1.center).sum::<DVec3>() / near.len() as f64;
    let Some(way) = (middle - body.center).try_normalize() else {
        return;
    };
    let begin = |sphere: &Sphere| sphere.center.dot(way) - sphere.radius;
    near.sort_unstable_by(|a, b| begin(&a.1).total_cmp(&begin(&b.1)));
    for (index, own) in placed(body.object.spheres, &body.pose()) {
        let end = own.center.dot(way) + own.radius + gap;
        for (number, other) in near.iter().take_while(|other| begin(&other.1) < end) {
            let between = own.center - other.center;
            let distance = between.length();
            let deflection = own.radius + other.radius - distance;
            if deflection > -gap {
                let part: Part = (slot, index);
                let touching = Touching {
                    // Coincident centres have no normal; any direction is valid.
                    normal: between.try_normalize().unwrap_or(DVec3::Z),
                    distance: distance.max(f64::MIN_POSITIVE),
                    other: others
                        .body
                        .map(|(body, middle)| (body, other.center - middle)),
                };
                pairs.push(Pair {
                    key: Key::Rigid(part, touched(*number as usize)),
                    part,
                    deflection,
                    kind: Kind::Rigid(touching),
                    arm: own.center - body.center,
                });
            }
        }
    }
}

/// Returns the index and the sphere in the world for each sphere of an object at a pose.
fn placed(spheres: &[Sphere], pose: &Pose) -> impl Iterator<Item = (u32, Sphere)> {
    let (rotation, origin) = (DMat3::from_quat(pose.rotation), pose.translation);
    let all = spheres.iter().zip(0..);
    all.map(move |(sphere, number)| {
        let center = rotation * sphere.center + origin;
        (number, Sphere { center, ..*sphere })
    })
}
