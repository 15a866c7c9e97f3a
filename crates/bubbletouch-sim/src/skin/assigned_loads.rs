//! Assignment of contact forces on rigid bodies to the patches that these bodies carry.
//!
//! A contact acts on the nearest patch of its carrier that it faces and whose taxels are within reach of its point. A contact that acts on no patch is counted
//! at the nearest patch of the carrier, if that is nearer than the diameter of the patch.

use super::point_loads::PointLoad;
use crate::geometry::{Aabb, Pose, distinct_places};
use crate::objects::{Sphere, nearest_distances};
use crate::world::Patch;

/// Least cosine between a normal force and the axis of the nearest taxel, reversed: contacts up to 60° off the axis act on the patch. If larger, contacts on
/// the rims of curved skins are lost; if smaller, contacts on the side of a finger act on its pad.
const FACING: f64 = 0.5;

/// Relative allowance for rounding of a contact point on the rim.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Distances from the taxels of a patch within which contacts act on the patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LoadRange {
    /// Largest height above the nearest taxel, metres: the largest stroke plus the largest diameter of a taxel. Points of deep contacts are up to twice as far
    /// behind the taxel.
    pub reach: f64,
    /// Largest distance from the axis of the nearest taxel, metres: the largest spacing, or the largest radius if that is larger. If larger, contacts beside
    /// the skin act on it; if smaller, contacts on the rim do not.
    pub margin: f64,
    /// Ball around all taxels (their spheres at rest and the substrate below them), in the patch frame, metres.
    pub ball: Sphere,
    /// Diameter of a ball around the taxels at rest, metres.
    pub diameter: f64,
}

impl LoadRange {
    /// Returns the range of a patch.
    pub fn new(patch: &Patch) -> Self {
        let (centers, taxels) = (patch.layout().centers(), patch.taxels().all());
        let radius = taxels.iter().map(|taxel| taxel.radius).fold(0.0, f64::max);
        let stroke = taxels.iter().map(|taxel| taxel.stroke).fold(0.0, f64::max);
        let bottoms = centers.iter().zip(patch.layout().axes()).enumerate();
        let bottoms = bottoms
            .map(|(taxel, (center, axis))| center + patch.taxels().at(taxel).substrate() * axis);
        let at_rest = Aabb::around_points(centers.iter().copied());
        let ball = Sphere::around(&at_rest.joined(&Aabb::around_points(bottoms)));
        Self {
            reach: stroke + 2.0 * radius,
            margin: radius.max(largest_spacing(patch)),
            ball: Sphere {
                radius: ball.radius + radius,
                ..ball
            },
            diameter: at_rest.size().length() + 2.0 * radius,
        }
    }
}

/// Contact force of a simulator on a rigid body that carries patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyLoad {
    /// Index of the carrier on which the force acts.
    pub carrier: usize,
    /// Index of the rigid object that touches the carrier.
    pub object: usize,
    /// Force in the world.
    pub load: PointLoad,
}

/// Patch of a skin on its carrier.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadedPatch<'a> {
    /// Patch on which contacts act.
    pub patch: &'a Patch,
    /// Range within which contacts act on the patch; `reach` may be larger than the patch's own.
    pub range: LoadRange,
    /// Index of the rigid body that carries the patch.
    pub carrier: usize,
    /// Pose `world_from_patch` of the patch.
    pub pose: Pose,
}

/// Contact forces by the patch and the object between which they act.
#[derive(Clone, Debug, Default)]
pub(super) struct AssignedLoads {
    /// Patch, object and load in the patch frame, sorted by patch and object.
    pub loads: Vec<(usize, usize, PointLoad)>,
    /// Patch, object and normal force, newtons, of contacts that act on no patch, at the nearest patch.
    pub beside: Vec<(usize, usize, f64)>,
}

/// Assigns contacts to patches.
pub(super) fn assign_loads(patches: &[LoadedPatch], contacts: &[BodyLoad]) -> AssignedLoads {
    let mut found = AssignedLoads::default();
    let patch_from_world = patches.iter().map(|patch| patch.pose.inverse());
    let patch_from_world: Vec<Pose> = patch_from_world.collect();
    for &BodyLoad {
        carrier,
        object,
        load,
    } in contacts
    {
        let own = patches.iter().zip(&patch_from_world).enumerate();
        let own = own.filter(|(_, (patch, _))| patch.carrier == carrier);
        let places = own.map(|(number, (patch, patch_from_world))| {
            let local = load.transformed(patch_from_world);
            let (distance, acts) = place(patch, &local);
            (number, local, distance, acts)
        });
        let nearest = places.min_by(|a, b| b.3.cmp(&a.3).then(a.2.total_cmp(&b.2)));
        match nearest {
            Some((number, local, _, true)) => found.loads.push((number, object, local)),
            Some((number, local, distance, false))
                if distance <= patches[number].range.diameter =>
            {
                found.beside.push((number, object, local.normal.length()));
            }
            _ => {}
        }
    }
    found
        .loads
        .sort_by_key(|(patch, object, _)| (*patch, *object));
    found
}

/// Returns the distance of a load's point from the nearest taxel, metres, and whether the load acts on the patch. The load is in the patch frame.
fn place(patch: &LoadedPatch, load: &PointLoad) -> (f64, bool) {
    let (layout, range) = (patch.patch.layout(), patch.range);
    let squares = layout
        .centers()
        .iter()
        .map(|center| center.distance_squared(load.point));
    let nearest = squares.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    let (taxel, square) = nearest.expect("a patch has taxels");
    let (axis, offset) = (layout.axes()[taxel], load.point - layout.centers()[taxel]);
    let height = offset.dot(axis);
    let beside = (square - height * height).max(0.0).sqrt();
    let acts = -load.normal.dot(axis) >= FACING * load.normal.length()
        && beside <= range.margin * ROUNDING
        && (-2.0 * range.reach..=range.reach).contains(&height);
    (square.sqrt(), acts)
}

/// Returns the largest distance between a taxel and its nearest neighbour at another place, metres; 0 for a single taxel.
fn largest_spacing(patch: &Patch) -> f64 {
    let places = distinct_places(patch.layout().centers());
    match places.len() {
        1 => 0.0,
        _ => nearest_distances(&places).into_iter().fold(0.0, f64::max),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Wrench;
    use crate::random::Seed;
    use crate::world::{Grid, Taxel};
    use glam::{DQuat, DVec3};
    use rand::Rng;

    const REACH: f64 = 7e-3;
    const MARGIN: f64 = 2e-3;

    /// Returns a grid of 5 × 3 taxels with a pitch of 2 mm; its taxels have a reach of 7 mm.
    fn pad() -> Patch {
        let grid = Grid {
            nx: 5,
            ny: 3,
            pitch: 2e-3,
        };
        let taxel = Taxel {
            radius: 1e-3,
            stiffness: 500.0,
            damping: 0.0,
            stroke: 5e-3,
        };
        Patch::grid(grid, taxel).unwrap()
    }

    fn on(patch: &Patch, carrier: usize, pose: Pose) -> LoadedPatch<'_> {
        LoadedPatch {
            patch,
            range: LoadRange::new(patch),
            carrier,
            pose,
        }
    }

    /// Returns a contact at a point in the frame of a pose, with a normal force in this frame.
    fn push(pose: &Pose, point: [f64; 3], normal: [f64; 3]) -> PointLoad {
        let load = PointLoad {
            point: point.into(),
            normal: normal.into(),
            friction: DVec3::new(0.3, 0.2, 0.1),
            torque: DVec3::new(1e-3, -2e-3, 3e-3),
        };
        load.transformed(pose)
    }

    fn on_body(carrier: usize, object: usize, load: PointLoad) -> BodyLoad {
        BodyLoad {
            carrier,
            object,
            load,
        }
    }

    fn wrench(load: &PointLoad) -> Wrench {
        let wrench = Wrench::at(load.point, load.normal + load.friction);
        Wrench {
            torque: wrench.torque + load.torque,
            ..wrench
        }
    }

    fn near(a: DVec3, b: DVec3) {
        assert!(a.distance(b) < 1e-12, "{a} is not {b}");
    }

    #[test]
    fn each_contact_acts_on_the_nearest_patch_with_its_force_moment_and_center_of_pressure() {
        let mut rng = Seed::new(61).rng();
        let pad = pad();
        for _ in 0..100 {
            let mut draw = |scale: f64| rng.gen_range(-scale..scale);
            let turn = DQuat::from_xyzw(draw(1.0), draw(1.0), draw(1.0), 1.0).normalize();
            let body = Pose::new(turn, DVec3::new(draw(1.0), draw(1.0), draw(1.0)));
            let places = [0.0, 0.2, 0.04].map(|x| Pose::from_translation(x * DVec3::X));
            let patches = places.map(|place| on(&pad, 3, body.compose(&place)));
            let expected: Vec<(usize, usize, PointLoad)> = (0..12)
                .map(|number| {
                    let point = [draw(5e-3), draw(3e-3), draw(5e-3)];
                    let normal = [draw(1.0), draw(1.0), -1.0];
                    let load = push(&Pose::IDENTITY, point, normal);
                    (number % 3, number / 4, load)
                })
                .collect();
            let contacts = expected.iter().map(|(patch, object, load)| {
                let pose = &patches[*patch].pose;
                on_body(3, *object, load.transformed(pose))
            });
            let found = assign_loads(&patches, &contacts.collect::<Vec<_>>());
            assert_eq!((found.loads.len(), found.beside.len()), (12, 0));
            for patch in 0..3 {
                for object in 0..3 {
                    let of = |loads: &[(usize, usize, PointLoad)]| {
                        let own = loads
                            .iter()
                            .filter(|load| (load.0, load.1) == (patch, object));
                        let own: Vec<PointLoad> = own.map(|load| load.2).collect();
                        let sum = own.iter().map(wrench);
                        let amount: f64 = own.iter().map(|load| load.normal.length()).sum();
                        let center = own.iter().map(|load| load.normal.length() * load.point);
                        let center = center.sum::<DVec3>() / amount;
                        (sum.fold(Wrench::default(), |sum, next| sum + next), center)
                    };
                    let [(found, at), (sum, center)] = [of(&found.loads), of(&expected)];
                    near(found.force, sum.force);
                    near(found.torque, sum.torque);
                    near(at, center);
                }
            }
            let order = found.loads.iter().map(|load| (load.0, load.1));
            assert!(order.is_sorted());
        }
    }

    #[test]
    fn a_contact_acts_within_reach_margin_and_sixty_degrees_of_the_axis_and_else_counts_beside() {
        let pad = pad();
        let pose = Pose::new(DQuat::from_rotation_x(1.0), DVec3::new(0.1, 0.2, 0.3));
        let patches = [on(&pad, 0, pose)];
        let range = patches[0].range;
        assert_eq!((range.reach, range.margin), (REACH, MARGIN));
        // The corner taxel is at (4, 2, 0) mm.
        let (inside, outside) = (1.0 - 1e-6, 1.0 + 1e-6);
        let tilted = |degrees: f64| {
            let angle = degrees.to_radians();
            [2.0 * angle.sin(), 0.0, -2.0 * angle.cos()]
        };
        for (point, normal, [acting, beside]) in [
            ([4e-3, 2e-3, inside * REACH], tilted(0.0), [1, 0]),
            ([4e-3, 2e-3, outside * REACH], tilted(0.0), [0, 1]),
            ([4e-3, 2e-3, -2.0 * inside * REACH], tilted(0.0), [1, 0]),
            // Further than the diameter of the patch, 10.9 mm.
            ([4e-3, 2e-3, -2.0 * outside * REACH], tilted(0.0), [0, 0]),
            ([4e-3 + inside * MARGIN, 2e-3, 0.0], tilted(0.0), [1, 0]),
            ([4e-3 + outside * MARGIN, 2e-3, 0.0], tilted(0.0), [0, 1]),
            ([1e-3, 0.0, 0.0], tilted(59.99), [1, 0]),
            ([1e-3, 0.0, 0.0], tilted(60.01), [0, 1]),
        ] {
            let found = assign_loads(&patches, &[on_body(0, 5, push(&pose, point, normal))]);
            assert_eq!(found.loads.len(), acting, "{point:?} {normal:?}");
            assert_eq!(found.beside.len(), beside, "{point:?} {normal:?}");
            for (patch, object, force) in found.beside {
                assert_eq!((patch, object), (0, 5));
                assert!((force - 2.0).abs() < 1e-12);
            }
        }
        // Beyond the diameter of the patch, and on another carrier.
        let diameter = 2.0 * (20f64.sqrt() * 1e-3 + 1e-3);
        assert!((range.diameter - diameter).abs() < 1e-15);
        let far = push(&pose, [4e-3 + outside * diameter, 2e-3, 0.0], tilted(0.0));
        let other = push(&pose, [0.0, 0.0, 0.0], tilted(0.0));
        let found = assign_loads(&patches, &[on_body(0, 5, far), on_body(1, 5, other)]);
        assert!(found.loads.is_empty() && found.beside.is_empty());
    }

    #[test]
    fn a_contact_between_two_patches_acts_once_and_a_contact_on_a_plate_acts_on_the_side_it_faces()
    {
        let pad = pad();
        let beside = Pose::from_translation(10e-3 * DVec3::X);
        let patches = [on(&pad, 0, Pose::IDENTITY), on(&pad, 0, beside)];
        // 1 mm from the last column of the first patch, and from the first column of the second one.
        let between = push(&Pose::IDENTITY, [5e-3, 0.0, 0.0], [0.0, 0.0, -2.0]);
        let found = assign_loads(&patches, &[on_body(0, 0, between)]);
        assert_eq!((found.loads.len(), found.loads[0].0), (1, 0));

        // A plate of 1 mm with a patch on each side.
        let behind = DQuat::from_rotation_y(std::f64::consts::PI);
        let behind = Pose::new(behind, -1e-3 * DVec3::Z);
        let patches = [on(&pad, 0, Pose::IDENTITY), on(&pad, 0, behind)];
        for (z, force, patch) in [(-9e-4, -2.0, 0), (-1e-4, 2.0, 1)] {
            // The point is nearer to the patch of the other side.
            let contact = push(&Pose::IDENTITY, [1e-3, 0.0, z], [0.0, 0.0, force]);
            let found = assign_loads(&patches, &[on_body(0, 0, contact)]);
            assert_eq!((found.loads.len(), found.loads[0].0), (1, patch));
            near(found.loads[0].2.normal, -2.0 * DVec3::Z);
        }
    }
}
