//! Laws of several free objects: all forces balance, as computed from the geometry alone, and no object penetrates a rigid one.

use crate::scenes::{ball, bed, grid, skin, union};
use crate::{reference_data, scans};
use bubbletouch_sim::contact::GRAZING;
use bubbletouch_sim::contact::equilibrium::{
    Equilibrium, EquilibriumSolver, FreeObject, Ground, HalfSpace, Obstacle, Outcome, PlacedSkin,
    Touched,
};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::Surface;
use bubbletouch_sim::objects::{Sphere, SphereUnion};
use bubbletouch_sim::packing::{Body, pack_mesh};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{Layout, Patch, Taxel};
use glam::{DQuat, DVec3};
use rand::Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;

const G: f64 = 9.81;
const DOWN: DVec3 = DVec3::new(0.0, 0.0, -G);
/// Largest allowed imbalance, relative to a weight.
const BALANCED: f64 = 1e-6;
/// Largest allowed penetration of rigid objects, metres.
const INSIDE: f64 = 1e-9;

const NO_FAULTS: [&str; 0] = [];

/// Free object: its shape, mass and centre of mass.
#[derive(Clone, Copy)]
struct Free<'a> {
    union: &'a SphereUnion,
    mass: f64,
    /// Centre of mass in the object's own frame, metres.
    center: DVec3,
    /// Distance from the centre of mass to the object's farthest point, metres.
    reach: f64,
}

impl<'a> Free<'a> {
    fn new(union: &'a SphereUnion, mass: f64) -> Self {
        let center = union.center_of_mass();
        Self {
            union,
            mass,
            center,
            reach: union.reach_from(center),
        }
    }

    fn weight(&self) -> f64 {
        self.mass * G
    }
}

/// Scene after the solver has finished.
struct Rest<'a> {
    ground: Ground<'a>,
    objects: Vec<Free<'a>>,
    balances: Vec<Equilibrium>,
    balancer: EquilibriumSolver,
}

fn equilibrium<'a>(ground: Ground<'a>, objects: &[Free<'a>], starts: &[Pose]) -> Rest<'a> {
    let free = objects
        .iter()
        .map(|object| FreeObject::new(object.union, object.mass, object.center).unwrap());
    let free: Vec<_> = free.collect();
    let mut balancer = EquilibriumSolver::new();
    let balances = balancer.solve_all(&free, &ground, DOWN, starts).unwrap();
    Rest {
        ground,
        objects: objects.to_vec(),
        balances,
        balancer,
    }
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(DVec3::new(x, y, z))
}

/// Returns a ground of one skin at the origin.
fn on(skin: &Patch) -> Ground<'_> {
    Ground {
        skins: vec![PlacedSkin::new(skin, Pose::IDENTITY)],
        ..Ground::default()
    }
}

/// Returns a ground of planes with these normals and heights.
fn between(planes: impl IntoIterator<Item = (DVec3, f64)>) -> Ground<'static> {
    let planes = planes.into_iter();
    Ground {
        planes: planes
            .map(|(normal, height)| HalfSpace { normal, height })
            .collect(),
        ..Ground::default()
    }
}

/// Part of an object or a skin, by two indices.
type Part = (usize, usize);

impl Rest<'_> {
    fn poses(&self) -> Vec<Pose> {
        self.balances.iter().map(|balance| balance.pose).collect()
    }

    fn there(&self) -> impl Iterator<Item = usize> {
        let balances = self.balances.iter().enumerate();
        balances.filter_map(|(number, balance)| balance.is_there().then_some(number))
    }

    fn sphere(&self, poses: &[Pose], (object, sphere): Part) -> Sphere {
        let sphere = self.objects[object].union.spheres()[sphere];
        Sphere {
            center: poses[object].transform_point(sphere.center),
            ..sphere
        }
    }

    fn weights(&self) -> f64 {
        self.there()
            .map(|object| self.objects[object].weight())
            .sum()
    }

    /// Returns the deflection that a sphere needs of a taxel, computed from the formula (on a grazing flank, along its tangent), metres. Also returns the force
    /// on the sphere per newton along the axis. Returns `None` if the sphere is behind the substrate, or beyond the stop, which it can reach only from behind.
    fn needed(&self, (skin, taxel): Part, sphere: &Sphere) -> Option<(f64, DVec3)> {
        let skin = &self.ground.skins[skin];
        let layout = skin.patch.layout();
        let center = skin
            .world_from_patch
            .transform_point(layout.centers()[taxel]);
        let axis = skin.world_from_patch.rotation * layout.axes()[taxel];
        let Taxel { radius, stroke, .. } = *skin.patch.taxels().at(taxel);
        let from = sphere.center - center;
        let (height, reach) = (from.dot(axis), sphere.radius + radius);
        let beside = from - height * axis;
        let left = (reach * reach - beside.length_squared()).max(0.0).sqrt();
        let least = GRAZING * reach;
        let edge = (reach * reach - least * least).sqrt();
        let slope = edge / least;
        let (needed, way) = if left >= least {
            (left - height, axis + beside / left)
        } else {
            let needed = least - slope * (beside.length() - edge) - height;
            (needed, axis + slope * beside.normalize())
        };
        let is_behind =
            height + left < -stroke - radius || height < -stroke && needed > stroke + INSIDE;
        (!is_behind).then_some((needed, way))
    }

    /// Returns all pairs of a taxel and a sphere that touch, or would touch after a motion of `margin` metres.
    fn near(&self, margin: f64) -> BTreeMap<Part, Vec<Part>> {
        let poses = self.poses();
        let mut near: BTreeMap<Part, Vec<Part>> = BTreeMap::new();
        for (number, skin) in self.ground.skins.iter().enumerate() {
            let centers = skin.patch.layout().centers().iter();
            let taxels = centers.map(|center| skin.world_from_patch.transform_point(*center));
            let taxels: Vec<DVec3> = taxels.collect();
            let Taxel { radius, stroke, .. } = *skin.patch.taxels().at(0);
            for object in self.there() {
                for index in 0..self.objects[object].union.n_spheres() {
                    let sphere = self.sphere(&poses, (object, index));
                    let reach = sphere.radius + radius + stroke + margin;
                    for (taxel, center) in taxels.iter().enumerate() {
                        if center.distance_squared(sphere.center) > reach * reach {
                            continue;
                        }
                        let needed = self.needed((number, taxel), &sphere);
                        let (needed, way) = needed.unwrap_or((0.0, DVec3::X));
                        if needed > -margin * (1.0 + way.length()) {
                            let parts = near.entry((number, taxel)).or_default();
                            parts.push((object, index));
                        }
                    }
                }
            }
        }
        near
    }

    /// Returns all pairs of spheres of different objects, or of an object and a rigid obstacle, that are nearer than `margin`, metres.
    fn rigid_pairs(&self, margin: f64) -> Vec<(Part, Touched)> {
        let poses = self.poses();
        let mut pairs = Vec::new();
        let parts = |object: usize| {
            let all = 0..self.objects[object].union.n_spheres();
            all.map(move |index| (object, index))
        };
        let ball = |object: usize| {
            let Free { center, reach, .. } = self.objects[object];
            (poses[object].transform_point(center), reach)
        };
        for object in self.there() {
            for part in parts(object) {
                let sphere = self.sphere(&poses, part);
                let mut add = |touched| {
                    if self.gap(&sphere, &touched, &poses) < margin {
                        pairs.push((part, touched));
                    }
                };
                (0..self.ground.planes.len()).for_each(|plane| add(Touched::Plane(plane)));
                for (number, obstacle) in self.ground.obstacles.iter().enumerate() {
                    let all = 0..obstacle.shape.spheres().len();
                    all.for_each(|index| add(Touched::Obstacle(number, index)));
                }
                for other in self.there().filter(|other| *other > object) {
                    let (center, radius) = ball(other);
                    if sphere.center.distance(center) < sphere.radius + radius + margin.abs() {
                        parts(other).for_each(|(other, index)| add(Touched::Object(other, index)));
                    }
                }
            }
        }
        pairs
    }

    /// Returns the distance of a sphere from a rigid counterpart, metres.
    fn gap(&self, sphere: &Sphere, touched: &Touched, poses: &[Pose]) -> f64 {
        let other = match *touched {
            Touched::Plane(plane) => {
                let HalfSpace { normal, height } = self.ground.planes[plane];
                return sphere.center.dot(normal) - height - sphere.radius;
            }
            Touched::Obstacle(number, index) => {
                let obstacle = &self.ground.obstacles[number];
                let sphere = obstacle.shape.spheres()[index];
                let center = obstacle.pose.transform_point(sphere.center);
                Sphere { center, ..sphere }
            }
            Touched::Object(object, index) => self.sphere(poses, (object, index)),
        };
        sphere.center.distance(other.center) - sphere.radius - other.radius
    }

    /// Returns all violations of the conditions of a scene at rest.
    fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        let mut on_object = vec![[DVec3::ZERO; 2]; self.objects.len()];
        let poses = self.poses();
        for (object, balance) in self.balances.iter().enumerate() {
            if balance.outcome == Outcome::NotConverged {
                faults.push(format!("object {object} is not at rest: {balance:?}"));
            }
        }
        self.check_taxels(&poses, &mut on_object, &mut faults);
        self.check_touches(&poses, &mut on_object, &mut faults);
        for object in self.there() {
            let Free {
                mass,
                center,
                reach,
                ..
            } = self.objects[object];
            let middle = poses[object].transform_point(center);
            let [force, moment] = on_object[object];
            let torque = moment - middle.cross(force);
            let weight = mass * G;
            let left = (force + mass * DOWN).length() / weight;
            if left.max(torque.length() / (weight * reach)) > BALANCED {
                faults.push(format!(
                    "object {object}: {left} of the weight, {torque} N·m are left"
                ));
            }
        }
        faults
    }

    /// Checks the taxels: forces equal the spring forces at these poses, stops are reached, and spheres that share a taxel all touch it.
    fn check_taxels(&self, poses: &[Pose], on_object: &mut [[DVec3; 2]], faults: &mut Vec<String>) {
        let near = self.near(0.0);
        let loads = self.balancer.loads();
        let mut of_taxels: BTreeMap<Part, Vec<_>> = BTreeMap::new();
        for load in loads {
            of_taxels
                .entry((load.skin, load.taxel))
                .or_default()
                .push(load);
        }
        let enough = 1e-7 * self.weights();
        let lightest = self
            .there()
            .map(|object| self.objects[object].weight())
            .fold(f64::INFINITY, f64::min);
        for (key, parts) in &near {
            let needed = |part: &Part| {
                self.needed(*key, &self.sphere(poses, *part))
                    .map_or(0.0, |n| n.0)
            };
            let deepest = parts.iter().map(needed).fold(0.0, f64::max);
            let taxel = self.ground.skins[key.0].patch.taxels().at(key.1);
            if deepest > taxel.stroke + INSIDE {
                faults.push(format!("taxel {key:?} is in by {deepest} m"));
            }
            let own = of_taxels.remove(key).unwrap_or_default();
            let spring: f64 = own.iter().map(|load| load.force - load.stop).sum();
            let stop: f64 = own.iter().map(|load| load.stop).sum();
            let expected = taxel.stiffness * deepest.min(taxel.stroke);
            if (spring - expected).abs() > 1e-7 * lightest {
                faults.push(format!("taxel {key:?}: {spring} N of {expected} N"));
            }
            if stop > 0.0 && deepest < taxel.stroke - INSIDE {
                faults.push(format!(
                    "taxel {key:?}: its stop carries {stop} N at {deepest} m"
                ));
            }
            for load in own {
                let sphere = self.sphere(poses, (load.object, load.sphere));
                let Some((needed, way)) = self.needed(*key, &sphere) else {
                    faults.push(format!("taxel {key:?} carries a sphere that is not there"));
                    continue;
                };
                if taxel.stiffness * (deepest - needed) > enough {
                    faults.push(format!("taxel {key:?}: {needed} m of {deepest} m carry"));
                }
                on_object[load.object][0] += load.force * way;
                on_object[load.object][1] += sphere.center.cross(load.force * way);
            }
        }
        if !of_taxels.is_empty() {
            faults.push(format!(
                "{} taxels carry what is not there",
                of_taxels.len()
            ));
        }
    }

    /// Checks the rigid contacts: forces only push and act where the objects touch, and nothing penetrates.
    fn check_touches(
        &self,
        poses: &[Pose],
        on_object: &mut [[DVec3; 2]],
        faults: &mut Vec<String>,
    ) {
        for (part, touched) in self.rigid_pairs(-INSIDE) {
            faults.push(format!("{part:?} is inside of {touched:?}"));
        }
        for touch in self.balancer.touches() {
            let sphere = self.sphere(poses, (touch.object, touch.sphere));
            let gap = self.gap(&sphere, &touch.other, poses);
            if gap > INSIDE {
                faults.push(format!("{touch:?} is {gap} m away"));
            }
            let out = match touch.other {
                Touched::Plane(plane) => self.ground.planes[plane].normal,
                Touched::Obstacle(number, index) => {
                    let obstacle = &self.ground.obstacles[number];
                    let other = obstacle.shape.spheres()[index].center;
                    (sphere.center - obstacle.pose.transform_point(other)).normalize()
                }
                Touched::Object(object, index) => {
                    let other = self.sphere(poses, (object, index)).center;
                    (sphere.center - other).normalize()
                }
            };
            let force = touch.force.length() * out;
            if (force - touch.force).length() > 1e-9 * force.length() {
                faults.push(format!("{touch:?} pulls, or rubs"));
            }
            if touch.point.distance(sphere.center - sphere.radius * out) > 1e-9 {
                faults.push(format!("{touch:?} is elsewhere"));
            }
            on_object[touch.object][0] += force;
            on_object[touch.object][1] += sphere.center.cross(force);
            if let Touched::Object(other, index) = touch.other {
                let at = self.sphere(poses, (other, index)).center;
                on_object[other][0] -= force;
                on_object[other][1] -= at.cross(force);
            }
        }
    }

    /// Checks that none of `n` small motions of all objects lowers the energy of springs and heights. Penetration of a rigid object costs more energy than it
    /// can gain.
    fn try_motions(&self, n: usize, case: u64, faults: &mut Vec<String>) {
        const LONGEST: f64 = 1e-4;
        let near = self.near(LONGEST);
        let poses = self.poses();
        let rigid = self.rigid_pairs(4.0 * LONGEST);
        let gap = |poses: &[Pose], (part, touched): &(Part, Touched)| {
            self.gap(&self.sphere(poses, *part), touched, poses)
        };
        let met = |gap: f64| if gap.abs() < INSIDE { gap } else { 0.0 };
        let gaps: Vec<f64> = rigid.iter().map(|pair| met(gap(&poses, pair))).collect();
        let steep = 10.0 * self.weights();
        let energy = |poses: &[Pose]| -> f64 {
            let mut energy = 0.0;
            for (key, parts) in &near {
                let Taxel {
                    stiffness, stroke, ..
                } = *self.ground.skins[key.0].patch.taxels().at(key.1);
                let mut deepest = 0.0_f64;
                for part in parts {
                    let sphere = self.sphere(poses, *part);
                    let needed = self.needed(*key, &sphere);
                    deepest = deepest.max(needed.map_or(0.0, |needed| needed.0));
                }
                let past = deepest - stroke;
                energy += 0.5 * stiffness * deepest.min(stroke).powi(2);
                energy += steep * (past - INSIDE).max(0.0);
            }
            for (pair, reference) in rigid.iter().zip(&gaps) {
                energy += steep * (reference - gap(poses, pair)).max(0.0);
            }
            for object in self.there() {
                let Free { mass, center, .. } = self.objects[object];
                let middle = poses[object].transform_point(center);
                energy -= mass * DOWN.dot(middle);
            }
            energy
        };
        let lowest = energy(&poses);
        let mut rng = Seed::new(case).named("motions").rng();
        let mut random = || rng.gen_range(-1.0..1.0);
        for _ in 0..n {
            let step = 10f64.powf(-5.5 + random());
            let moved = poses.iter().zip(&self.objects).map(|(pose, object)| {
                let turn = step / object.reach * DVec3::new(random(), random(), random());
                let rotation = DQuat::from_scaled_axis(turn) * pose.rotation;
                let shift = step * DVec3::new(random(), random(), random());
                let middle = pose.transform_point(object.center) + shift;
                Pose::new(rotation, middle - rotation * object.center)
            });
            let moved: Vec<Pose> = moved.collect();
            let there = energy(&moved);
            let allowed = self.weights() * (4e-6 * step + INSIDE) + 1e-14 * lowest.abs();
            if there < lowest - allowed {
                let by = lowest - there;
                faults.push(format!("{step} m lower {lowest} J by {by}"));
            }
        }
    }
}

/// Creates taxels on the inside of a ball, around its lowest point at the origin; their axes point to the ball's middle.
fn bowl(radius: f64, half_angle: f64, pitch: f64, taxel: Taxel) -> Patch {
    let n_rings = (radius * half_angle / pitch) as usize;
    let (mut centers, mut axes) = (Vec::new(), Vec::new());
    for ring in 0..=n_rings {
        let (sin, cos) = (ring as f64 * pitch / radius).sin_cos();
        let n = ((std::f64::consts::TAU * radius * sin / pitch) as usize).max(1);
        for k in 0..n {
            let (y, x) = (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
            let out = DVec3::new(sin * x, sin * y, -cos);
            centers.push(radius * (out + DVec3::Z));
            axes.push(-out);
        }
    }
    skin(Layout::new(centers, axes).unwrap(), taxel)
}

fn taxel(stiffness: f64) -> Taxel {
    Taxel {
        radius: 3e-3,
        stiffness,
        damping: 0.0,
        stroke: 8e-3,
    }
}

/// Returns scanned objects, packed to 1.5 mm; none if the scans are missing.
fn scanned() -> Vec<SphereUnion> {
    let Some(folder) = reference_data::folder("BUBBLETOUCH_YCB") else {
        return Vec::new();
    };
    let names = [
        "011_banana",
        "012_strawberry",
        "014_lemon",
        "040_large_marker",
        "062_dice",
        "077_rubiks_cube",
    ];
    let packed = names.par_iter().map(|name| {
        let surface = Surface::new(scans::scan(&folder.join(format!("{name}.ply"))));
        pack_mesh(&surface, Body::Solid, 1.5e-3).unwrap().spheres
    });
    packed.collect()
}

/// Returns skins to rest on: two bowls, soft and stiff, and a bed with edges.
fn skins() -> [Patch; 3] {
    let [soft, stiff] = [30.0, 300.0].map(|stiffness| bowl(0.12, 1.0, 6e-3, taxel(stiffness)));
    [
        soft,
        stiff,
        skin(grid(16, 16, 6e-3).layout().clone(), taxel(100.0)),
    ]
}

/// Solves a random scene of two to eight objects above a skin. Half of the objects are balls and half are scans; all are balls if there are no scans. Every
/// second scene also has objects beside the skin and a table below, level or tilted. Returns the violations, and the numbers of objects that are at rest
/// and that have left.
fn random_scene(case: u64, scans: &[SphereUnion], skins: &[Patch]) -> (Vec<String>, [usize; 2]) {
    let mut rng = Seed::new(case).named("many bodies").rng();
    let mut random = |a: f64, b: f64| rng.gen_range(a..b);
    let n = random(2.0, 9.0) as usize;
    let balls: Vec<SphereUnion> = (0..n).map(|_| ball(random(0.008, 0.03))).collect();
    let (mut objects, mut starts) = (Vec::new(), Vec::new());
    let is_wide = case % 2 == 1;
    let wide = if is_wide { 0.13 } else { 0.06 };
    let mut height = 0.05;
    for ball in &balls {
        let at = random(0.0, 2.0 * scans.len().max(1) as f64) as usize;
        let union = scans.get(at).unwrap_or(ball);
        let reach = union.reach_from(DVec3::ZERO);
        height += reach;
        let [x, y, z, w] = [0; 4].map(|_| random(-1.0, 1.0));
        let across = DVec3::new(random(-wide, wide), random(-wide, wide), height);
        starts.push(Pose::new(DQuat::from_xyzw(x, y, z, w).normalize(), across));
        height += reach + 0.005;
        objects.push(Free::new(union, 10f64.powf(random(-2.0, 0.0))));
    }
    let tilt = DQuat::from_rotation_x(random(-0.1, 0.1));
    let kind = (case / 2) as usize % skins.len();
    let is_bowl = kind < 2;
    let placed = [PlacedSkin::new(&skins[kind], Pose::from_rotation(tilt))];
    let slope = if case % 4 == 1 { 0.02 } else { 0.0 };
    let table = [HalfSpace {
        normal: DVec3::new(random(-slope, slope + 1e-9), slope, 1.0).normalize(),
        // The table is so low beside a bowl that no object on it is behind the taxels.
        height: random(-0.02, 0.0) - if is_bowl && is_wide { 0.2 } else { 0.0 },
    }];
    let ground = Ground {
        skins: placed.to_vec(),
        planes: if case % 8 < 6 {
            table.to_vec()
        } else {
            Vec::new()
        },
        obstacles: Vec::new(),
    };
    let rest = equilibrium(ground, &objects, &starts);
    let mut faults = rest.faults();
    rest.try_motions(100, case, &mut faults);
    let faults = faults.iter().map(|fault| format!("scene {case}, {fault}"));
    let n_there = rest.there().count();
    (faults.collect(), [n_there, n - n_there])
}

/// Asserts that all objects of these scenes are at rest or have left, except in at most `n_others` scenes.
fn all_settle_or_leave(cases: std::ops::Range<u64>, n_others: usize) {
    let (scans, skins) = (scanned(), skins());
    let all = cases.into_par_iter();
    let results: Vec<_> = all.map(|case| random_scene(case, &scans, &skins)).collect();
    let faulty = results.iter().filter(|result| !result.0.is_empty());
    let first: Vec<&String> = faulty.map(|result| &result.0[0]).collect();
    assert!(first.len() <= n_others, "{}: {first:#?}", first.len());
    println!("{} scenes are not at rest: {first:#?}", first.len());
    let sum = |k: usize| results.iter().map(|result| result.1[k]).sum::<usize>();
    assert!(sum(0) > 2 * sum(1) && sum(1) > 0);
}

#[test]
fn random_scenes_of_several_objects_settle_or_leave() {
    all_settle_or_leave(0..24, 0);
}

/// Exceptions are scenes in which the solver reports no convergence, and scenes in which a small sphere of a scan slipped between taxels. This sphere counts as
/// behind the substrate until it is out again, but the oracle recognises only spheres farther back.
#[test]
#[ignore = "takes seven minutes"]
fn a_thousand_random_scenes_of_several_objects_settle_or_leave() {
    all_settle_or_leave(0..1000, 4);
}

#[test]
fn two_balls_on_the_same_taxels_carry_both_weights() {
    let skin = bed(40, 40.0);
    let ground = on(&skin);
    for masses in [[0.2, 0.2], [0.2, 0.1], [0.5, 0.02]] {
        for apart in [5e-3, 0.02, 0.03, 0.0305] {
            let ball = ball(0.015);
            let starts = [-1.0, 1.0]
                .map(|side| at(0.5 * side * apart + 3e-4, 2e-4 * side, 0.02 + 0.02 * side));
            let objects = masses.map(|mass| Free::new(&ball, mass));
            let rest = equilibrium(ground.clone(), &objects, &starts);
            let case = format!("{masses:?}, {apart} m");
            assert_eq!(rest.faults(), NO_FAULTS, "{case}");
            assert_eq!(rest.there().count(), 2, "{case}");
            let taxels: f64 = rest.balancer.loads().iter().map(|load| load.force).sum();
            let weights = (masses[0] + masses[1]) * G;
            assert!((taxels / weights - 1.0).abs() < 1e-6, "{case}: {taxels} N");
        }
    }
}

#[test]
fn stacks_of_two_and_four_balls_come_down_between_walls_and_in_a_bowl_and_the_skin_carries_all() {
    let ball = ball(0.015);
    let walls = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y].map(|normal| HalfSpace {
        normal,
        height: -0.019,
    });
    let skins = [bed(40, 300.0), bowl(0.05, 1.0, 4e-3, taxel(300.0))];
    for (skin, planes) in skins.iter().zip([&walls[..], &[]]) {
        for n in [2, 4] {
            let planes = planes.to_vec();
            let ground = Ground { planes, ..on(skin) };
            let place = |k| at(0.0, 0.0, f64::from(k) * 0.031 + 0.02);
            let starts: Vec<Pose> = (0..n).map(place).collect();
            let rest = equilibrium(ground, &vec![Free::new(&ball, 0.05); starts.len()], &starts);
            assert_eq!(rest.faults(), NO_FAULTS, "{n}");
            assert_eq!(rest.there().count(), starts.len());
            let mut faults = Vec::new();
            rest.try_motions(100, 0, &mut faults);
            assert_eq!(faults, NO_FAULTS, "{n}");
            let loads = rest.balancer.loads().iter();
            let carried: DVec3 = loads.map(|load| load.on_object.force).sum();
            let weights = f64::from(n) * 0.05 * G;
            assert!((carried.z / weights - 1.0).abs() < 1e-6, "{n}: {carried}");
        }
    }
}

#[test]
fn what_has_no_room_is_said_not_to_rest_and_what_does_not_touch_it_rests() {
    // The planes are a table, and a ceiling 30 mm above it.
    let ground = between([(DVec3::Z, 0.0), (DVec3::NEG_Z, -0.03)]);
    let [large, small] = [ball(0.02), ball(0.01)];
    let objects = [Free::new(&large, 0.1), Free::new(&small, 0.1)];
    let starts = [0.0, 0.1].map(|x| at(x, 0.0, 0.012));
    let rest = equilibrium(ground, &objects, &starts);
    let outcomes = [0, 1].map(|object| rest.balances[object].outcome);
    assert_eq!(outcomes, [Outcome::NotConverged, Outcome::AtRest]);
    assert!(rest.balances[0].imbalance > BALANCED || rest.faults().len() > 1);
}

#[test]
fn what_slides_on_a_slope_escapes_down_it_and_what_lies_in_a_gutter_of_planes_stays() {
    let union = ball(0.02);
    let tilted = |x: f64, y: f64| (DVec3::new(x, y, 1.0).normalize(), 0.0);
    let slope = [tilted(1e-4, 0.0)];
    let falling = [tilted(1.0, 1e-3), tilted(-1.0, 1e-3)];
    let level = [tilted(1.0, 0.0), tilted(-1.0, 0.0)];
    let start = [at(0.0, 0.0, 0.05)];
    for (planes, way) in [
        (&slope[..], Some(DVec3::X)),
        (&falling, Some(DVec3::Y)),
        (&level, None),
    ] {
        let ground = between(planes.iter().copied());
        let rest = equilibrium(ground, &[Free::new(&union, 0.1)], &start);
        match (rest.balances[0].outcome, way) {
            (Outcome::AtRest, None) => assert_eq!(rest.faults(), NO_FAULTS),
            (Outcome::Escaped { direction }, Some(way)) => {
                assert!(direction.dot(way) > 0.999, "{direction}");
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_pyramid_of_balls_stands_in_a_corner_of_planes_and_says_what_each_touch_carries() {
    // Three balls on a table, held together by three walls, carry a fourth ball. By statics the load of each upper contact is W / (3 cos).
    let radius: f64 = 0.02;
    let unions = [ball(radius)];
    let side = |k: usize| DQuat::from_rotation_z(std::f64::consts::TAU * k as f64 / 3.0) * DVec3::X;
    let beside = 2.0 * radius / 3f64.sqrt();
    let walls = (0..3).map(|k| (side(k), -0.5 * beside - radius));
    let ground = between([(DVec3::Z, 0.0)].into_iter().chain(walls));
    let mut starts: Vec<Pose> = (0..3)
        .map(|k| Pose::from_translation(beside * side(k) + (radius + 1e-3 * k as f64) * DVec3::Z))
        .collect();
    starts.push(at(1e-4, 2e-4, 0.1));
    let rest = equilibrium(ground, &[Free::new(&unions[0], 0.1); 4], &starts);
    assert_eq!(rest.faults(), NO_FAULTS);
    let touches = rest.balancer.touches().iter();
    let on_top: Vec<f64> = touches
        .filter(|touch| touch.other == Touched::Object(3, 0))
        .map(|touch| touch.force.length())
        .collect();
    let cos = (1.0 - (beside / (2.0 * radius)).powi(2)).sqrt();
    let exact = 0.1 * G / (3.0 * cos);
    assert_eq!(on_top.len(), 3);
    for force in on_top {
        assert!((force / exact - 1.0).abs() < 1e-6, "{force} {exact}");
    }
}

#[test]
fn a_ball_lies_in_the_valley_of_an_obstacle_beside_a_wall_but_not_on_its_ridge() {
    let [ball, one] = [ball(0.02), ball(0.03)];
    let two = union([-1.0, 1.0].map(|side| 0.02 * side * DVec3::Y), 0.03);
    for (spheres, n_there) in [(&one, 0), (&two, 1)] {
        let (shape, pose) = (spheres.into(), at(0.02, 0.0, 0.0));
        let ground = Ground {
            obstacles: vec![Obstacle { shape, pose }],
            ..between([(DVec3::X, -0.02)])
        };
        let start = [at(0.0, 0.0, 0.1)];
        let rest = equilibrium(ground, &[Free::new(&ball, 0.1)], &start);
        assert_eq!(rest.faults(), NO_FAULTS);
        assert_eq!(rest.there().count(), n_there);
    }
}
