//! Contacts between free objects and planes, obstacles, and other free objects.

use super::body::Body;
use super::free_object::{Ground, HalfSpace};
use super::meshes::{Depth, Placed, Range, each_below_plane, each_contact};
use super::pair::{Key, Kind, Pair, Part};
use super::rigid_contact::{Touched, Touching};
use super::rigid_shape::RigidShape;
use crate::geometry::Pose;
use crate::objects::Sphere;
use glam::{DMat3, DVec3};

/// Another body or an obstacle, which a body may touch.
struct Others<'a> {
    shape: RigidShape<'a>,
    pose: Pose,
    /// Index and centre of mass of the other body; `None` for an obstacle.
    body: Option<(u32, DVec3)>,
}

/// Appends the pairs of parts that penetrate a rigid counterpart or are nearer to it than `may_move` metres; sorted. `depth` are the penetrations of
/// meshes, and their contacts in `held` (sorted) remain contacts until their parts miss each other clearly.
pub(super) fn gather_rigid(
    pairs: &mut Vec<Pair>,
    bodies: &[Body],
    ground: &Ground,
    (may_move, depth): (f64, Depth),
    held: &[Key],
) {
    let first = pairs.len();
    for (body, slot) in bodies.iter().zip(0..) {
        for (number, plane) in ground.planes.iter().enumerate() {
            gather_plane(pairs, (slot, body), (number, plane), may_move);
        }
        for (number, obstacle) in ground.obstacles.iter().enumerate() {
            let others = Others {
                shape: obstacle.shape,
                pose: obstacle.pose,
                body: None,
            };
            let touched = |sphere| Touched::Obstacle(number, sphere);
            gather_shapes(
                pairs,
                (slot, body),
                &others,
                touched,
                ((may_move, depth), held),
            );
        }
        for (other, number) in bodies.iter().zip(0..).skip(slot as usize + 1) {
            let reach = body.arm() + other.arm() + 2.0 * may_move;
            if body.center.distance_squared(other.center) > reach * reach {
                continue;
            }
            let others = Others {
                shape: other.object.shape,
                pose: other.pose(),
                body: Some((number, other.center)),
            };
            let touched = |sphere| Touched::Object(number as usize, sphere);
            let range = (2.0 * may_move, depth);
            gather_shapes(pairs, (slot, body), &others, touched, (range, held));
        }
    }
    pairs[first..].sort_unstable_by_key(|pair| (pair.key, pair.part));
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
    let mut add = |index: u32, radius: f64, deflection: f64, center: DVec3| {
        let touching = Touching::of_sphere(radius, plane.normal, f64::INFINITY, None);
        pairs.push(Pair {
            key: Key::Rigid((slot, index), Touched::Plane(number)),
            part: (slot, index),
            deflection,
            kind: Kind::Rigid(touching),
            arm: center - body.center,
        });
    };
    if let RigidShape::Mesh(mesh) = body.object.shape {
        let below = (plane.normal, plane.height);
        each_below_plane((mesh, &body.pose()), below, may_move, |index, deep, at| {
            add(index, mesh.rounding(), deep, at);
        });
    }
    for (index, sphere) in placed(body.object.shape.spheres(), &body.pose()) {
        let deflection = sphere.radius - above(sphere.center);
        if deflection > -may_move {
            add(index, sphere.radius, deflection, sphere.center);
        }
    }
}

/// Collects the pairs of the parts of a body and of another shape that are less than `gap` metres apart. `depth` are the penetrations of meshes.
fn gather_shapes(
    pairs: &mut Vec<Pair>,
    (slot, body): (u32, &Body),
    others: &Others,
    touched: impl Fn(usize) -> Touched,
    ((gap, depth), held): ((f64, Depth), &[Key]),
) {
    let is_mesh = |shape: RigidShape| matches!(shape, RigidShape::Mesh(_));
    if !is_mesh(body.object.shape) && !is_mesh(others.shape) {
        return gather_spheres(pairs, (slot, body), others, touched, gap);
    }
    let own = Placed {
        shape: body.object.shape,
        pose: body.pose(),
    };
    let other = Placed {
        shape: others.shape,
        pose: others.pose,
    };
    each_contact(&own, &other, Range { gap, depth }, |found| {
        let [own, other] = found.identity;
        let key = Key::Rigid((slot, own), touched(other as usize));
        // Parts of a smooth patch that one point touches share one multiplier, as spheres that press one taxel. The number of the varying part tells them apart.
        let part = match found.parts[0] == own {
            true => found.parts[1],
            false => found.parts[0],
        };
        if found.beyond > 0.0 && held.binary_search(&key).is_err() {
            return;
        }
        pairs.push(Pair {
            key,
            part: (slot, part),
            deflection: found.penetration,
            kind: Kind::Rigid(Touching {
                curvature: found.curvature,
                inset: found.inset,
                parts: Some(found.parts),
                other: others
                    .body
                    .map(|(body, middle)| (body, found.point - middle)),
            }),
            arm: found.point - body.center,
        });
    });
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
    let mut near: Vec<_> = placed(others.shape.spheres(), &others.pose)
        .filter(is_near)
        .collect();
    let middle = near.iter().map(|other| other.1.center).sum::<DVec3>() / near.len() as f64;
    let Some(way) = (middle - body.center).try_normalize() else {
        return;
    };
    let begin = |sphere: &Sphere| sphere.center.dot(way) - sphere.radius;
    near.sort_unstable_by(|a, b| begin(&a.1).total_cmp(&begin(&b.1)));
    for (index, own) in placed(body.object.shape.spheres(), &body.pose()) {
        let end = own.center.dot(way) + own.radius + gap;
        for (number, other) in near.iter().take_while(|other| begin(&other.1) < end) {
            let between = own.center - other.center;
            let distance = between.length();
            let deflection = own.radius + other.radius - distance;
            if deflection > -gap {
                let part: Part = (slot, index);
                // Coincident centres have no normal; any direction is valid.
                let normal = between.try_normalize().unwrap_or(DVec3::Z);
                let distance = distance.max(f64::MIN_POSITIVE);
                let other = others
                    .body
                    .map(|(body, middle)| (body, other.center - middle));
                let touching = Touching::of_sphere(own.radius, normal, distance, other);
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
