//! Laws of free objects on a skin with friction: friction holds them inside Coulomb's cone, and no further.

use crate::scenes::{TAXEL, grid, skin, touched, union};
use bubbletouch_sim::contact::equilibrium::{
    Equilibrium, EquilibriumSolver, FreeObject, Ground, Outcome, PlacedSkin, TangentialSpring,
};
use bubbletouch_sim::contact::{FrictionState, NormalForce, TaxelContact, Wrench};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Model, SphereUnion};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{Patch, Shear, Shears, Taxel};
use glam::{DQuat, DVec2, DVec3, Vec3Swizzles};
use rand::Rng;

const G: f64 = 9.81;
const MASS: f64 = 0.15;
const STIFFNESS: f64 = 120.0;

/// Creates a bed of 24 × 24 taxels, 2 mm apart.
fn bed() -> Patch {
    let taxel = Taxel {
        stiffness: STIFFNESS,
        stroke: 6e-3,
        ..TAXEL
    };
    skin(grid(24, 24, 2e-3).layout().clone(), taxel)
}

/// Creates a plate of 5 × 5 spheres, 24 mm wide, which cannot roll.
fn plate() -> SphereUnion {
    let place = |k: i32| 4e-3 * DVec3::new(f64::from(k % 5 - 2), f64::from(k / 5 - 2), 0.0);
    union((0..25).map(place), 4e-3)
}

/// Returns the gravity on a bed that is tilted by `angle` about y.
fn gravity(angle: f64) -> DVec3 {
    G * DVec3::new(angle.sin(), 0.0, -angle.cos())
}

/// Plate on a bed, advanced step by step.
struct HeldObject {
    patch: Patch,
    union: SphereUnion,
    objects: [Model; 1],
    balancer: EquilibriumSolver,
    contacts: Vec<TaxelContact>,
    friction: FrictionState,
    world_from_patch: Pose,
    balance: Equilibrium,
    /// Tangential springs at the beginning of the last step.
    tips: Vec<TangentialSpring>,
}

impl HeldObject {
    /// Creates the plate at rest on a level bed.
    fn new(shear: Shear) -> Self {
        let (patch, union) = (bed(), plate());
        let object = FreeObject::new(&union, MASS, DVec3::ZERO).unwrap();
        let mut balancer = EquilibriumSolver::new();
        let start = Pose::from_translation(DVec3::new(0.3e-3, -0.2e-3, 6e-3));
        let skins = [PlacedSkin::new(&patch, Pose::IDENTITY)];
        let balance = balancer
            .solve(&object, &skins, gravity(0.0), &start)
            .unwrap();
        assert_eq!(balance.outcome, Outcome::AtRest);
        let mut held = Self {
            friction: FrictionState::at_rest(&patch, Shears::Equal(shear)).unwrap(),
            objects: [union.clone().into()],
            world_from_patch: Pose::IDENTITY,
            contacts: Vec::new(),
            tips: Vec::new(),
            patch,
            union,
            balancer,
            balance,
        };
        held.feel();
        held
    }

    fn feel(&mut self) {
        let pose = self.balance.pose.seen_from(&self.world_from_patch);
        self.contacts = touched(&self.patch, &self.objects, &[pose]).contacts;
        let at_rest = self.balancer.tangential_springs();
        let normal = NormalForce::Springs;
        self.friction
            .step_with(&self.patch, &self.contacts, &[pose], normal, at_rest);
    }

    fn step(&mut self, gravity: DVec3) -> Outcome {
        self.tips = self.friction.tangential_springs().collect();
        let object = FreeObject::new(&self.union, MASS, DVec3::ZERO).unwrap();
        let skins = [PlacedSkin {
            tangential_springs: &self.tips,
            ..PlacedSkin::new(&self.patch, self.world_from_patch)
        }];
        let start = self.balance.pose;
        let found = self.balancer.solve(&object, &skins, gravity, &start);
        self.balance = found.unwrap();
        self.feel();
        self.balance.outcome
    }

    /// Asserts that the forces of taxels and friction on the plate (patch frame) balance its weight and have no torque about its centre of mass.
    fn assert_balanced(&self, gravity: DVec3, case: &str) {
        let pose = self.balance.pose.seen_from(&self.world_from_patch);
        let normal = self.balancer.loads().iter().map(|load| load.on_object);
        let friction = self.balancer.tangential_springs().iter().map(|tip| {
            let shear = self.friction.shears().at(tip.taxel);
            let force = -shear.stiffness * tip.displacement.extend(0.0);
            Wrench::at(tip.place, force)
        });
        let sum = normal.chain(friction);
        let sum = sum.fold(Wrench::default(), |sum, wrench| sum + wrench);
        let weight = self.world_from_patch.rotation.conjugate() * (MASS * gravity);
        let torque = sum.torque - pose.translation.cross(sum.force);
        let size = MASS * G;
        assert!(
            (sum.force + weight).length() <= 1e-6 * size,
            "{case}: {sum:?}"
        );
        assert!(torque.length() <= 1e-6 * size * 0.02, "{case}: {torque}");
        assert!(self.balance.imbalance <= 1e-6, "{case}");
        // No tangential force exceeds the friction cone of the taxel's normal force.
        for contact in &self.contacts {
            let carried = self.friction.friction(contact.taxel).length();
            let shear = self.friction.shears().at(contact.taxel);
            let most = shear.friction * STIFFNESS * contact.deflection;
            assert!(carried <= most + 1e-6 * size, "{case}: {carried} of {most}");
        }
    }
}

/// Returns the angle, in steps of half a degree, at which a plate starts to slide without friction.
fn angle_without_friction() -> f64 {
    let mut held = HeldObject::new(Shear {
        stiffness: 100.0,
        friction: 0.0,
    });
    let angles = (1..90).map(|k| 0.5 * f64::from(k) * std::f64::consts::PI / 180.0);
    let mut left = angles.skip_while(|angle| held.step(gravity(*angle)) == Outcome::AtRest);
    left.next().unwrap()
}

#[test]
fn a_plate_sticks_below_the_angle_of_friction_and_leaves_above() {
    for (stiffness, friction) in [(60.0, 0.2), (120.0, 0.5), (500.0, 0.8)] {
        let mut held = HeldObject::new(Shear {
            stiffness,
            friction,
        });
        let start = held.balance.pose.translation;
        let most = f64::atan(friction);
        for k in 1..=12 {
            let angle = 0.08 * f64::from(k) * most;
            let case = format!("μ {friction} at {angle} of {most}");
            assert_eq!(held.step(gravity(angle)), Outcome::AtRest, "{case}");
            held.assert_balanced(gravity(angle), &case);
            // The springs across and along the axes yield by a few millimetres at most.
            let way = held.balance.pose.translation - start;
            assert!(way.length() < 2e-3, "{case}: {way}");
        }
        // The flanks of taxels between the spheres also hold the plate without friction.
        let alone = f64::tan(angle_without_friction());
        let outcome = held.step(gravity(f64::atan(1.05 * (friction + alone))));
        assert!(matches!(outcome, Outcome::Escaped { .. }), "{outcome:?}");
    }
}

/// A horizontal force is carried by all shear springs in parallel, as long as all taxels stick.
#[test]
fn a_plate_that_is_drawn_a_little_goes_as_far_as_its_shear_springs_say() {
    let stiffness = 80.0;
    let mut held = HeldObject::new(Shear {
        stiffness,
        friction: 5.0,
    });
    let start = held.balance.pose;
    let angle = 0.01;
    assert_eq!(held.step(gravity(angle)), Outcome::AtRest);
    let n = held.tips.len() as f64;
    let way = held.balance.pose.translation - start.translation;
    let pull = MASS * G * angle.sin();
    // Part of the pull that the flanks of the taxels carry without friction.
    let of_flanks: f64 = held
        .balancer
        .loads()
        .iter()
        .map(|load| load.on_object.force.x)
        .sum();
    let of_tips: f64 = held
        .balancer
        .tangential_springs()
        .iter()
        .map(|tip| stiffness * tip.displacement.x)
        .sum();
    assert!((of_tips - of_flanks - pull).abs() < 1e-6 * MASS * G);
    let (_, turn) = (start.rotation.conjugate() * held.balance.pose.rotation).to_axis_angle();
    let expected = (pull + of_flanks) / (n * stiffness);
    // Rotation moves the contact points, which lie 4 mm below the centre.
    assert!(
        (way.x - expected).abs() <= 5e-3 * turn + 1e-9,
        "{way} {expected} {turn}"
    );
    assert!(
        held.balancer
            .tangential_springs()
            .iter()
            .all(|tip| !tip.has_slipped)
    );
}

#[test]
fn a_skin_that_moves_takes_along_what_lies_on_it() {
    let mut held = HeldObject::new(Shear {
        stiffness: 100.0,
        friction: 0.5,
    });
    // This step removes the remaining motion of the first solution.
    held.step(gravity(0.0));
    let on_patch = held.balance.pose;
    let turn = DQuat::from_axis_angle(DVec3::Z, 0.01);
    let along = DVec3::new(0.4e-3, 0.1e-3, 0.0);
    for step in 1..=60 {
        let moved = Pose::new(
            turn * held.world_from_patch.rotation,
            along * f64::from(step),
        );
        held.world_from_patch = moved;
        assert_eq!(held.step(gravity(0.0)), Outcome::AtRest, "{step}");
        let seen = held.balance.pose.seen_from(&held.world_from_patch);
        let apart = seen.translation - on_patch.translation;
        assert!(apart.length() < 1e-8, "{step}: {apart}");
        assert!(
            seen.rotation.angle_between(on_patch.rotation) < 1e-6,
            "{step}"
        );
    }
    let gone = held.balance.pose.translation - on_patch.translation;
    assert!(gone.length() > 0.02);
}

#[test]
fn no_friction_is_none_to_the_bit() {
    let mut held = HeldObject::new(Shear {
        stiffness: 100.0,
        friction: 0.0,
    });
    let object = FreeObject::new(&held.union, MASS, DVec3::ZERO).unwrap();
    let skins = [PlacedSkin::new(&held.patch, Pose::IDENTITY)];
    let mut balancer = held.balancer.clone();
    let start = held.balance.pose;
    let free = balancer
        .solve(&object, &skins, gravity(1e-4), &start)
        .unwrap();
    held.step(gravity(1e-4));
    assert_eq!(held.balance, free);
}

/// With the friction cones of the solution held fixed, no small motion lowers the energy.
#[test]
fn where_a_plate_rests_on_tips_that_stick_and_slip_its_energy_is_least() {
    let friction = 0.4;
    let mut held = HeldObject::new(Shear {
        stiffness: 150.0,
        friction,
    });
    let mut n_slipped = 0;
    for k in 1..=9 {
        // Near the limit some taxels already slip, since the foot rotates.
        let angle = 0.11 * f64::from(k) * f64::atan(friction);
        assert_eq!(held.step(gravity(angle)), Outcome::AtRest);
        n_slipped += held
            .balancer
            .tangential_springs()
            .iter()
            .filter(|tip| tip.has_slipped)
            .count();
        let reaches: Vec<f64> = held
            .tips
            .iter()
            .map(|tip| {
                let found = held
                    .contacts
                    .iter()
                    .find(|contact| contact.taxel == tip.taxel);
                tip.shear
                    .reach(found.map_or(0.0, |contact| STIFFNESS * contact.deflection))
            })
            .collect();
        let energy = |pose: &Pose| {
            let found = touched(&held.patch, &held.objects, &[*pose]);
            let springs = found.deflections.iter();
            let springs: f64 = springs.map(|d| 0.5 * STIFFNESS * d * d).sum();
            let tips = held.tips.iter().zip(&reaches).map(|(tip, &reach)| {
                let way = pose.transform_point(tip.point) - tip.place;
                let length = (tip.displacement + way.xy()).length();
                match length <= reach {
                    true => 75.0 * length * length,
                    false => 150.0 * reach * (length - 0.5 * reach),
                }
            });
            springs + tips.sum::<f64>() - MASS * gravity(angle).dot(pose.translation)
        };
        let rest = held.balance.pose;
        let least = energy(&rest);
        let mut rng = Seed::new(7).named("held").numbered(k as u64).rng();
        for size in [1e-6, 1e-5, 1e-4] {
            for _ in 0..100 {
                let mut random =
                    || DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-size..size)));
                let (shift, turn) = (random(), random() / 0.01);
                let moved = Pose::new(
                    DQuat::from_scaled_axis(turn) * rest.rotation,
                    rest.translation + shift,
                );
                // Energy that the accepted imbalance may gain.
                let allowed = 1e-6 * MASS * G * 4.0 * size;
                assert!(energy(&moved) >= least - allowed, "{angle} {size}");
            }
        }
    }
    assert!(n_slipped > 0);
    let still = |tip: &TangentialSpring| tip.displacement == DVec2::ZERO;
    assert!(!held.tips.iter().all(still));
}

/// Two clusters of spheres lie side by side on a bed that tilts and turns, and share taxels.
#[test]
fn lumps_that_share_taxels_are_held_together() {
    let patch = bed();
    let (mut n_slipped, mut n_at_rest, mut n_unsettled) = (0, 0, 0);
    for case in 0..30 {
        let mut rng = Seed::new(11).named("lumps").numbered(case).rng();
        let mut random = |size: f64| -> DVec3 {
            DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-size..size)))
        };
        let unions = [0, 1].map(|_| {
            // Each cluster has four feet.
            let feet = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
            union(
                feet.map(|(x, y)| 5e-3 * DVec3::new(x, y, 0.0) + random(8e-4)),
                4e-3,
            )
        });
        let objects = unions
            .each_ref()
            .map(|union| FreeObject::new(union, 0.05, DVec3::ZERO));
        let objects = objects.map(Result::unwrap);
        let models = unions.clone().map(Model::from);
        let shear = Shear {
            stiffness: 100.0,
            friction: 0.3,
        };
        let mut friction = FrictionState::at_rest(&patch, Shears::Equal(shear)).unwrap();
        let mut balancer = EquilibriumSolver::new();
        let mut poses =
            [-1.0, 1.0].map(|x| Pose::from_translation(DVec3::new(9.2e-3 * x, 0.0, 6e-3)));
        for step in 0..8 {
            let tips: Vec<TangentialSpring> = friction.tangential_springs().collect();
            let ground = Ground {
                skins: vec![PlacedSkin {
                    tangential_springs: &tips,
                    ..PlacedSkin::new(&patch, Pose::IDENTITY)
                }],
                ..Ground::default()
            };
            let down = gravity(0.03 * f64::from(step));
            let found = balancer.solve_all(&objects, &ground, down, &poses).unwrap();
            if found.iter().any(|one| one.outcome != Outcome::AtRest) {
                let is_unsettled = |one: &Equilibrium| one.outcome == Outcome::NotConverged;
                n_unsettled += usize::from(found.iter().any(is_unsettled));
                break;
            }
            n_at_rest += 1;
            poses = [found[0].pose, found[1].pose];
            let contacts = touched(&patch, &models, &poses).contacts;
            let at_rest = balancer.tangential_springs();
            n_slipped += at_rest.iter().filter(|tip| tip.has_slipped).count();
            for (number, pose) in poses.iter().enumerate() {
                let loads = balancer.loads().iter().filter(|load| load.object == number);
                let touches = balancer.touches().iter();
                let tips = at_rest.iter().filter(|tip| tip.object == number);
                let force = loads.map(|load| load.on_object.force).sum::<DVec3>()
                    + touches
                        .map(|touch| match touch.object == number {
                            true => touch.force,
                            false => -touch.force,
                        })
                        .sum::<DVec3>()
                    - 100.0 * tips.map(|tip| tip.displacement.extend(0.0)).sum::<DVec3>();
                let left = (force + 0.05 * down).length();
                assert!(
                    left <= 1e-6 * 0.05 * G,
                    "{case}, {step}, {number}: {left} at {pose:?}"
                );
            }
            friction.step_with(&patch, &contacts, &poses, NormalForce::Springs, at_rest);
        }
    }
    println!("{n_at_rest} at rest, {n_unsettled} not, {n_slipped} slipped");
    assert!(n_slipped > 0 && n_at_rest > 200 && n_unsettled == 0);
}
