//! Laws of free meshes: closed forms, balance computed by another evaluator, symmetry, and contact between two meshes.

use crate::scenes::{TAXEL, ball, grid, mesh, skin, touched};
use bubbletouch_sim::contact::equilibrium::{
    Equilibrium, EquilibriumSolver, FreeObject, Ground, HalfSpace, Obstacle, Outcome, PlacedSkin,
    RigidContact, TaxelLoad, Touched, overlap,
};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::TriangleMesh;
use bubbletouch_sim::objects::Model;
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{Patch, Taxel};
use glam::{DQuat, DVec3};
use rand::Rng;

pub(super) const G: f64 = 9.81;
pub(super) const DOWN: DVec3 = DVec3::new(0.0, 0.0, -G);
pub(super) const BALANCED: f64 = 1e-6;

pub(super) fn bed(n: usize, pitch: f64, stiffness: f64) -> Patch {
    skin(
        grid(n, n, pitch).layout().clone(),
        Taxel { stiffness, ..TAXEL },
    )
}

fn cuboid(x: f64, y: f64, z: f64) -> Model {
    mesh(TriangleMesh::cuboid("box", DVec3::new(x, y, z)).unwrap())
}

fn ellipsoid(radii: DVec3, tolerance: f64) -> Model {
    mesh(TriangleMesh::ellipsoid("egg", radii, tolerance).unwrap())
}

/// Returns a tray: an open box of the outer size `width` and `height`, with walls and a floor of `wall` metres. Its origin is the middle of its base.
fn tray(width: f64, height: f64, wall: f64) -> Model {
    let (o, i) = (0.5 * width, 0.5 * width - wall);
    let ring = |half: f64, z: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| DVec3::new(half * x, half * y, z))
    };
    let rings = [
        ring(o, 0.0),
        ring(o, height),
        ring(i, height),
        ring(i, wall),
    ];
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [12, 13, 14], [12, 14, 15]];
    for level in 0..3 {
        for k in 0..4 {
            let (a, b) = (4 * level + k, 4 * level + (k + 1) % 4);
            triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    let tray = TriangleMesh::new("tray", rings.concat(), triangles).unwrap();
    let (volume, _) = tray.volume_and_centroid();
    let solid = width * width * wall + (height - wall) * wall * 4.0 * (width - wall);
    assert!((volume - solid).abs() < 1e-9 * solid, "{volume} {solid}");
    mesh(tray)
}

/// Free object: shape, mass and centre of mass.
#[derive(Clone)]
pub(super) struct Free {
    pub model: Model,
    pub mass: f64,
    pub center: DVec3,
}

impl Free {
    pub fn new(model: Model, mass: f64) -> Self {
        let center = match &model {
            Model::Mesh(mesh) => mesh.mesh().volume_and_centroid().1,
            Model::Spheres(spheres) => spheres.bounds().center(),
        };
        Self {
            model,
            mass,
            center,
        }
    }
}

pub(super) struct Rest {
    pub solutions: Vec<Equilibrium>,
    pub touches: Vec<RigidContact>,
    pub loads: Vec<TaxelLoad>,
}

impl Rest {
    pub fn poses(&self) -> Vec<Pose> {
        self.solutions.iter().map(|found| found.pose).collect()
    }

    /// Returns the largest residual of force and torque of all objects, relative to the weights. `pushes` are the forces of taxels on objects, with the points
    /// where they act; the reported contacts supply the forces between objects.
    pub fn residual(
        &self,
        free: &[Free],
        pushes: impl Iterator<Item = (usize, DVec3, DVec3)>,
    ) -> f64 {
        let poses = self.poses();
        let weights = free.iter().map(|free| (free.mass * DOWN, DVec3::ZERO));
        let mut sums: Vec<(DVec3, DVec3)> = weights.collect();
        let mut add = |object: usize, force: DVec3, point: DVec3| {
            let center = poses[object].transform_point(free[object].center);
            sums[object].0 += force;
            sums[object].1 += (point - center).cross(force);
        };
        pushes.for_each(|(object, force, point)| add(object, force, point));
        for touch in &self.touches {
            add(touch.object, touch.force, touch.point);
            if let Touched::Object(other, _) = touch.other {
                add(other, -touch.force, touch.point);
            }
        }
        let residuals = free.iter().zip(sums).map(|(free, (force, torque))| {
            let reach = 0.5 * free.model.bounds().size().length();
            f64::max(force.length(), torque.length() / reach) / (free.mass * G)
        });
        residuals.fold(0.0, f64::max)
    }
}

pub(super) fn settle(free: &[Free], ground: &Ground, gravity: DVec3, starts: &[Pose]) -> Rest {
    let objects = free
        .iter()
        .map(|free| FreeObject::new(&free.model, free.mass, free.center).unwrap());
    let objects: Vec<_> = objects.collect();
    let mut solver = EquilibriumSolver::new();
    let solutions = solver.solve_all(&objects, ground, gravity, starts).unwrap();
    Rest {
        solutions,
        touches: solver.touches().to_vec(),
        loads: solver.loads().to_vec(),
    }
}

pub(super) fn on_bed(patch: &Patch) -> Ground<'_> {
    Ground {
        skins: vec![PlacedSkin::new(patch, Pose::IDENTITY)],
        ..Ground::default()
    }
}

pub(super) fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(DVec3::new(x, y, z))
}

/// Returns the largest residual of force and torque of all objects, relative to the weights. The forces of the taxels are computed by another evaluator, the
/// press at a pose; the forces between objects are the reported contacts. A press has one contact a taxel, so this function is for shapes without valleys below.
fn residual(patch: &Patch, free: &[Free], rest: &Rest) -> f64 {
    let models: Vec<Model> = free.iter().map(|free| free.model.clone()).collect();
    let poses = rest.poses();
    let pushes = touched(patch, &models, &poses).contacts.into_iter();
    let pushes = pushes.map(|contact| {
        let stiffness = patch.taxels().at(contact.taxel).stiffness;
        let push = contact.push(stiffness * contact.deflection).force;
        (contact.object, push, contact.point)
    });
    rest.residual(free, pushes)
}

/// Smooth walls hold the box in the middle. Without them, a box whose sides are between two rows slides and tilts until a side meets a row. The taxels that
/// carry the box do not move with it.
#[test]
fn a_box_sinks_evenly_by_its_weight_over_the_stiffness_below_it() {
    let patch = bed(64, 4e-3, 100.0);
    let (x, y, z) = (56e-3, 40e-3, 30e-3);
    let walls = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y].map(|normal| HalfSpace {
        normal,
        height: -0.5 * normal.abs().dot(DVec3::new(x, y, z)),
    });
    let ground = Ground {
        planes: walls.to_vec(),
        ..on_bed(&patch)
    };
    for mass in [0.01, 0.3, 5.0] {
        let free = [Free::new(cuboid(x, y, z), mass)];
        let rest = settle(&free, &ground, DOWN, &[at(0.0, 0.0, 0.02)]);
        let found = rest.solutions[0];
        assert_eq!(found.outcome, Outcome::AtRest, "{mass}");
        assert!(found.imbalance <= BALANCED);
        let up = found.pose.rotation * DVec3::Z;
        assert!((up - DVec3::Z).length() < 1e-6, "{mass}: {up}");
        assert_eq!(found.n_touched, 140);
        let sunk = mass * G / (140.0 * 100.0);
        let bottom = found.pose.translation.z - 0.5 * z;
        assert!((1e-3 - bottom - sunk).abs() < 1e-9, "{mass}: {bottom}");
    }
}

#[test]
fn a_tilted_box_settles_on_the_nearest_side() {
    let patch = bed(64, 4e-3, 100.0);
    for tilt in [-0.2, -0.05, 0.02, 0.1, 0.3] {
        let free = [Free::new(cuboid(56e-3, 40e-3, 30e-3), 0.3)];
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), tilt);
        let start = Pose::new(turn, DVec3::new(0.0, 0.0, 0.02));
        let rest = settle(&free, &on_bed(&patch), DOWN, &[start]);
        assert_eq!(rest.solutions[0].outcome, Outcome::AtRest, "{tilt}");
        assert!(rest.solutions[0].imbalance <= BALANCED);
        let up = rest.solutions[0].pose.rotation * DVec3::Z;
        assert!(up.z > 0.9998, "{tilt}: {up}");
        assert!(residual(&patch, &free, &rest) < 1e-5);
    }
}

#[test]
fn forces_and_torques_of_a_mesh_balance_as_another_evaluator_computes_them() {
    let patch = bed(40, 2e-3, 80.0);
    let mut rng = Seed::new(61).named("eggs").rng();
    let shapes = [
        ellipsoid(DVec3::new(20e-3, 14e-3, 9e-3), 2e-5),
        cuboid(31e-3, 23e-3, 11e-3),
        mesh(TriangleMesh::cylinder("can", 15e-3, 22e-3, 5e-5).unwrap()),
    ];
    for shape in shapes {
        for _ in 0..4 {
            let free = [Free::new(shape.clone(), rng.gen_range(0.02..0.2))];
            let turn = DQuat::from_axis_angle(
                DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0))).normalize(),
                rng.gen_range(0.0..3.0),
            );
            let start = Pose::new(turn, DVec3::new(1e-3, -2e-3, 0.03));
            let rest = settle(&free, &on_bed(&patch), DOWN, &[start]);
            assert_eq!(rest.solutions[0].outcome, Outcome::AtRest);
            assert!(rest.solutions[0].imbalance <= BALANCED);
            let residual = residual(&patch, &free, &rest);
            assert!(residual < 1e-5, "{residual:e}");
        }
    }
}

#[test]
fn a_finer_ball_sinks_as_deep_as_a_sphere() {
    let patch = bed(24, 2e-3, 60.0);
    let exact = Free::new(ball(15e-3).into(), 0.1);
    let start = [at(0.3e-3, 0.0, 0.02)];
    let height = |free: Free| {
        let rest = settle(&[free], &on_bed(&patch), DOWN, &start);
        assert_eq!(rest.solutions[0].outcome, Outcome::AtRest);
        rest.solutions[0].pose.translation.z
    };
    let expected = height(exact);
    let mut last = f64::INFINITY;
    for tolerance in [4e-4, 1e-4, 2.5e-5] {
        let ball = Free::new(ellipsoid(DVec3::splat(15e-3), tolerance), 0.1);
        let error = (height(ball) - expected).abs();
        assert!(error < tolerance && error < last, "{tolerance}: {error:e}");
        last = error;
    }
}

#[test]
fn a_mesh_that_is_beside_the_bed_escapes_and_one_on_its_border_falls_off() {
    let patch = bed(16, 2e-3, 60.0);
    for x in [0.2, 0.026] {
        let free = [Free::new(cuboid(20e-3, 20e-3, 10e-3), 0.05)];
        let rest = settle(&free, &on_bed(&patch), DOWN, &[at(x, 0.0, 0.01)]);
        let outcome = rest.solutions[0].outcome;
        assert!(matches!(outcome, Outcome::Escaped { .. }), "{outcome:?}");
    }
}

#[test]
fn a_box_in_a_tray_on_a_bed_rests_on_the_tray_which_carries_both() {
    let patch = bed(40, 2e-3, 100.0);
    let free = [
        Free::new(tray(50e-3, 12e-3, 3e-3), 0.08),
        Free::new(cuboid(20e-3, 16e-3, 10e-3), 0.05),
    ];
    for (x, tilt) in [(0.0, 0.0), (4e-3, 0.05), (-7e-3, -0.1)] {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), tilt);
        let starts = [
            at(0.3e-3, 0.2e-3, 2e-3),
            Pose::new(turn, DVec3::new(x, 0.5 * x, 0.016)),
        ];
        let rest = settle(&free, &on_bed(&patch), DOWN, &starts);
        for (free, found) in free.iter().zip(&rest.solutions) {
            assert_eq!(found.outcome, Outcome::AtRest, "{x}");
            assert!(found.imbalance <= BALANCED, "{}", found.imbalance);
            let force = found.force + free.mass * DOWN;
            assert!(force.length() < 1e-6 * free.mass * G, "{force}");
        }
        // The tray alone touches the bed; it carries the weight of both.
        let carried: DVec3 = rest.touches.iter().map(|touch| touch.force).sum();
        let is_on_box = rest.touches.iter().all(|touch| touch.object == 0);
        assert!(is_on_box && rest.solutions[1].n_touched == 0);
        assert!((carried - free[1].mass * DOWN).length() < 1e-6 * free[1].mass * G);
        let residual = residual(&patch, &free, &rest);
        assert!(residual < 1e-5, "{residual:e}");
    }
}

#[test]
fn meshes_rest_on_planes_and_obstacles_of_spheres_and_triangles() {
    // A box on a table: the corners carry it.
    let free = [Free::new(cuboid(40e-3, 30e-3, 20e-3), 0.2)];
    let plane = HalfSpace {
        normal: DVec3::Z,
        height: 0.01,
    };
    let ground = Ground {
        planes: vec![plane],
        ..Ground::default()
    };
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), 0.1);
    let start = Pose::new(turn, DVec3::new(0.0, 0.0, 0.05));
    let rest = settle(&free, &ground, DOWN, &[start]);
    assert_eq!(rest.solutions[0].outcome, Outcome::AtRest);
    assert!((rest.solutions[0].pose.translation.z - 0.02).abs() < 1e-8);
    // A ball of spheres in a fixed tray, and a ball of triangles in the corner of two walls.
    let tray = tray(50e-3, 12e-3, 3e-3);
    let tilted = DQuat::from_rotation_x(0.2) * DQuat::from_rotation_y(0.15);
    let ground = Ground {
        obstacles: vec![Obstacle {
            shape: (&tray).into(),
            pose: Pose::from_rotation(tilted),
        }],
        ..Ground::default()
    };
    let egg = ellipsoid(DVec3::new(8e-3, 7e-3, 6e-3), 5e-5);
    for model in [ball(8e-3).into(), egg, cuboid(9e-3, 8e-3, 7e-3)] {
        let free = [Free::new(model, 0.1)];
        let rest = settle(&free, &ground, DOWN, &[at(2e-3, -1e-3, 0.025)]);
        let found = rest.solutions[0];
        assert_eq!(found.outcome, Outcome::AtRest);
        assert!(found.imbalance <= BALANCED);
        let force: DVec3 = rest.touches.iter().map(|touch| touch.force).sum();
        assert!((force + 0.1 * DOWN).length() < 1e-6 * 0.1 * G);
    }
}

/// A plate that is 1 mm thick, with a roof of two faces that meet at a ridge above its middle.
fn roof() -> Model {
    let (x, y) = (20e-3, 15e-3);
    let corners = [
        (-x, -y, 0.0),
        (x, -y, 0.0),
        (x, y, 0.0),
        (-x, y, 0.0),
        (-x, 0.0, 1e-3),
        (x, 0.0, 1e-3),
    ];
    let corners = corners.map(|(x, y, z)| DVec3::new(x, y, z)).to_vec();
    let triangles = vec![
        [0, 2, 1],
        [0, 3, 2],
        [0, 1, 5],
        [0, 5, 4],
        [2, 3, 4],
        [2, 4, 5],
        [0, 4, 3],
        [1, 2, 5],
    ];
    mesh(TriangleMesh::new("roof", corners, triangles).unwrap())
}

/// A corner above a ridge has its foot on no face of the near side. The far side of the thin plate is not touched.
#[test]
fn a_corner_above_the_ridge_of_a_thin_plate_touches_nothing() {
    let (roof, cube) = (roof(), cuboid(10e-3, 10e-3, 10e-3));
    // The cube stands on one corner.
    let upright = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::NEG_Z);
    let half_diagonal = 3f64.sqrt() * 5e-3;
    let depth = |above: f64| {
        let cube_at = Pose::new(upright, DVec3::new(1e-3, 0.0, 1e-3 + above + half_diagonal));
        overlap(
            ((&cube).into(), &cube_at),
            ((&roof).into(), &Pose::IDENTITY),
        )
    };
    for above in [1e-6, 1e-4, 5e-4, 2e-3] {
        assert_eq!(depth(above), 0.0, "{above}");
    }
    for below in [1e-5, 3e-4] {
        let expected = below * (15.0 / (15f64.powi(2) + 1.0).sqrt());
        assert!(
            (depth(-below) - expected).abs() < 1e-9,
            "{below}: {}",
            depth(-below)
        );
    }
}

#[test]
fn a_turned_and_mirrored_world_gives_turned_and_mirrored_equilibria() {
    let patch = bed(40, 2e-3, 100.0);
    let free = [
        Free::new(tray(50e-3, 12e-3, 3e-3), 0.08),
        Free::new(cuboid(20e-3, 16e-3, 10e-3), 0.05),
    ];
    let starts = [at(0.3e-3, 0.2e-3, 2e-3), at(3e-3, 2e-3, 0.015)];
    let here = settle(&free, &on_bed(&patch), DOWN, &starts);
    let move_by = Pose::new(
        DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 1.1),
        DVec3::new(0.3, -0.2, 0.7),
    );
    let ground = Ground {
        skins: vec![PlacedSkin::new(&patch, move_by)],
        ..Ground::default()
    };
    let moved = starts.map(|start| move_by.compose(&start));
    let there = settle(&free, &ground, move_by.rotation * DOWN, &moved);
    // Mirrored at x = 0: the shapes are symmetric, and a pose without rotation stays one.
    let mirrored = [at(-0.3e-3, 0.2e-3, 2e-3), at(-3e-3, 2e-3, 0.015)];
    let mirrored = settle(&free, &on_bed(&patch), DOWN, &mirrored);
    for object in 0..2 {
        let [one, turned, mirror] =
            [&here, &there, &mirrored].map(|rest| rest.solutions[object].pose);
        let back = turned.seen_from(&move_by);
        let height = (back.translation.z - one.translation.z).abs();
        assert!(height < 1e-8, "{height:e}");
        let up = (back.rotation * DVec3::Z - one.rotation * DVec3::Z).length();
        assert!(up < 1e-5, "{up:e}");
        let height = (mirror.translation.z - one.translation.z).abs();
        assert!(height < 1e-8, "{height:e}");
    }
}
