//! Tests of the energy of free meshes: continuity, and derivatives against finite differences.

use super::tilted_bed::{self, Differences};
use crate::contact::equilibrium::energy::Energy;
use crate::contact::equilibrium::loads::{Load, Multipliers, Smoothness};
use crate::contact::equilibrium::meshes::{Depth, Placed, Range, each_contact, overlap};
use crate::contact::equilibrium::model::Model;
use crate::contact::equilibrium::pair::Key;
use crate::contact::equilibrium::pairs::Group;
use crate::contact::equilibrium::scene::Scene;
use crate::contact::equilibrium::{Ground, PlacedSkin};
use crate::geometry::Pose;
use crate::mesh::TriangleMesh;
use crate::objects::MeshModel;
use crate::random::Seed;
use glam::{DQuat, DVec3};
use rand::Rng;
use std::collections::{BTreeMap, BTreeSet};

/// Returns a prism with a vertical axis of 24 mm × 24 mm whose upper side is a grid of 2·n² triangles with the given heights above its base.
fn relief(n: usize, height: impl Fn(f64, f64) -> f64) -> MeshModel {
    let side = 24e-3;
    let at = |k: usize| side * (k as f64 / n as f64 - 0.5);
    let number = |i: usize, j: usize| i * (n + 1) + j;
    let all = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
    let top = all
        .clone()
        .map(|(i, j)| DVec3::new(at(i), at(j), height(at(i), at(j))));
    let bottom = all.map(|(i, j)| DVec3::new(at(i), at(j), -5e-3));
    let vertices: Vec<DVec3> = top.chain(bottom).collect();
    let below = (n + 1) * (n + 1);
    let mut triangles = Vec::new();
    let mut quad = |a: usize, b: usize, c: usize, d: usize| {
        let [a, b, c, d] = [a, b, c, d].map(|corner| corner as u32);
        triangles.extend([[a, b, c], [a, c, d]]);
    };
    for i in 0..n {
        for j in 0..n {
            let corners = [
                number(i, j),
                number(i + 1, j),
                number(i + 1, j + 1),
                number(i, j + 1),
            ];
            let [a, b, c, d] = corners;
            quad(a, b, c, d);
            quad(below + d, below + c, below + b, below + a);
        }
        for (a, b) in [
            (number(i, n), number(i + 1, n)),
            (number(i + 1, 0), number(i, 0)),
            (number(0, i), number(0, i + 1)),
            (number(n, i + 1), number(n, i)),
        ] {
            quad(a, b, below + b, below + a);
        }
    }
    let mesh = TriangleMesh::new("relief", vertices, triangles).unwrap();
    assert!(mesh.volume_and_centroid().0 > 0.0);
    MeshModel::new(mesh)
}

/// Moves a corner of a cube by short random steps just below and above the surface of a mesh. The penalty energy of the corner never changes by more than the
/// largest slope times the step, and the error of a plane instead of the distance to an edge.
#[test]
fn the_energy_of_a_corner_is_continuous_on_smooth_surfaces_and_in_a_tray() {
    let egg = TriangleMesh::ellipsoid("egg", DVec3::new(12e-3, 10e-3, 8e-3), 1e-5).unwrap();
    let egg = MeshModel::new(egg);
    let hollow = |x: f64, y: f64| 30.0 * (x * x + y * y);
    let waves = |x: f64, y: f64| 2e-4 * ((900.0 * x).sin() + (700.0 * y).cos());
    let tray = |x: f64, y: f64| {
        if x.abs().max(y.abs()) > 7.9e-3 {
            4e-3
        } else {
            0.0
        }
    };
    let egg_top = |x: f64, y: f64| 8e-3 * (1.0 - (x / 12e-3).powi(2) - (y / 10e-3).powi(2)).sqrt();
    type Height<'a> = &'a dyn Fn(f64, f64) -> f64;
    let surfaces: [(MeshModel, Height); 5] = [
        (egg, &egg_top),
        (relief(40, |_, _| 0.0), &|_, _| 0.0),
        (relief(40, hollow), &hollow),
        (relief(40, waves), &waves),
        // The walls lean outwards by a cell of the grid.
        (relief(24, tray), &tray),
    ];
    let cube = MeshModel::new(TriangleMesh::cuboid("cube", DVec3::splat(2e-3)).unwrap());
    let upright = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::NEG_Z);
    let corners = cube.features().corners();
    let lowest = (0..8).min_by(|a, b| {
        let height = |k: &usize| (upright * corners[*k]).z;
        height(a).total_cmp(&height(b))
    });
    let lowest = lowest.unwrap();
    let range = Range {
        gap: 1e-4,
        depth: Depth::up_to(1.5e-3),
    };
    let mut rng = Seed::new(7).named("continuity").rng();
    for (number, (mesh, surface)) in surfaces.iter().enumerate() {
        let fixed = Placed {
            shape: mesh.into(),
            pose: Pose::IDENTITY,
        };
        let depths = |point: DVec3| {
            let moved = Placed {
                shape: (&cube).into(),
                pose: Pose::new(upright, point - upright * corners[lowest]),
            };
            let mut depths: BTreeMap<[u32; 2], f64> = BTreeMap::new();
            each_contact(&moved, &fixed, range, |found| {
                if found.parts[0] == lowest as u32 && found.beyond <= 0.0 {
                    let depth = depths.entry(found.identity).or_default();
                    *depth = depth.max(found.penetration);
                }
            });
            let deepest = depths.values().copied().fold(0.0, f64::max);
            (depths.values().map(|d| 0.5 * d * d).sum::<f64>(), deepest)
        };
        let (mut n_deep, mut n_moved) = (0, 0);
        for _ in 0..20 {
            let mut place = || rng.gen_range(-7.8e-3..7.8e-3);
            let (x, y) = match number {
                // In the corner of the floor and two walls.
                4 => (7e-3 + 0.02 * place(), -7e-3 + 0.02 * place()),
                1 | 3 => (place(), place()),
                _ => (0.5 * place(), 0.5 * place()),
            };
            let depth = 10f64.powf(rng.gen_range(-6.0..-4.0));
            let mut point = DVec3::new(x, y, surface(x, y) - depth);
            let way = DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0)));
            let step = 0.02 * depth * (way * DVec3::new(1.0, 1.0, 0.05)).normalize();
            let (mut energy, mut deepest) = depths(point);
            for _ in 0..200 {
                point += step;
                let (next, next_deepest) = depths(point);
                let most = deepest.max(next_deepest) + step.length();
                // Three walls at most, and 1 − cos of half the angle between two faces of the grid.
                let bound = 3.0 * most * step.length() + 0.01 * most * most;
                assert!(
                    (next - energy).abs() <= bound,
                    "surface {number} at {point}: {energy:e} {next:e}, deepest {deepest:e} {next_deepest:e}"
                );
                n_moved += 1;
                n_deep += usize::from(next_deepest > 0.0);
                (energy, deepest) = (next, next_deepest);
            }
        }
        assert!(2 * n_deep > n_moved, "{number}: {n_deep} of {n_moved}");
    }
}

/// Compares gradient and Hessian of the energy with finite differences at random poses: a mesh presses taxels of a bed, and another mesh presses the first one.
/// Poses within a step of a kink are left out.
#[test]
fn derivatives_of_meshes_on_taxels_and_on_meshes_are_differences_of_the_energy() {
    let patch = tilted_bed::patch(12, 0.0);
    let egg = |x: f64, y: f64, z: f64, tolerance: f64| {
        let mesh = TriangleMesh::ellipsoid("egg", DVec3::new(x, y, z), tolerance).unwrap();
        MeshModel::new(mesh)
    };
    let hollow = relief(12, |x, y| 30.0 * (x * x + y * y) - 4e-3);
    let meshes = [
        egg(9e-3, 8e-3, 7e-3, 4e-4),
        hollow,
        egg(6e-3, 7e-3, 5e-3, 4e-4),
    ];
    let world_from_patch = tilted_bed::world_from_patch();
    let ground = Ground {
        skins: vec![PlacedSkin::new(&patch, world_from_patch)],
        ..Ground::default()
    };
    let mut rng = Seed::new(11).named("mesh derivatives").rng();
    let mut vector = || DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0)));
    let (mut n_smooth, mut n_faces, mut n_edges, mut n_corners) = (0, 0, 0, 0);
    let (mut n_rigid, mut n_ties) = (0, 0);
    for case in 0..48 {
        let is_hollow = case % 2 == 1;
        let meshes = [&meshes[case % 2], &meshes[2]];
        let turns = [0.3, 3.0].map(|angle| DQuat::from_scaled_axis(angle * vector()));
        let lower = DVec3::new(1e-3, 2e-3, 5e-3) + 1e-3 * vector();
        let way = (DVec3::Z + 0.2 * vector()).normalize();
        let pose =
            |body: usize, center: DVec3| world_from_patch.compose(&Pose::new(turns[body], center));
        let (mut near, mut far) = (0.0, 0.03);
        for _ in 0..40 {
            let middle = 0.5 * (near + far);
            let poses = [pose(0, lower), pose(1, lower + middle * way)];
            match overlap((meshes[0].into(), &poses[0]), (meshes[1].into(), &poses[1])) > 0.0 {
                true => near = middle,
                false => far = middle,
            }
        }
        let starts = [pose(0, lower), pose(1, lower + (near - 4e-5) * way)];
        let scene = Scene {
            springs: Vec::new(),
            bodies: tilted_bed::bodies(meshes, starts),
            ground: &ground,
            multipliers: Multipliers::default(),
            smoothness: Smoothness {
                smoothing: if is_hollow { 2e-4 } else { 1e-10 },
                load: f64::INFINITY,
                least: 0.0,
                stop_stiffness: 1e4,
            },
        };
        let mut energy = Energy::default();
        let mut value = |steps: &[(usize, f64)]| {
            let (moved, fallen) = tilted_bed::moved(&scene, steps);
            energy.look(&moved, (0.0, Depth::up_to(2e-3)), (&[], &[]));
            let loads = &energy.loads;
            let all = energy.pairs.groups.iter().zip(&loads.all);
            let carrying = all.filter(|(_, load)| load.force > 0.0);
            let parts: BTreeSet<_> = carrying
                .flat_map(|(group, _)| group.pairs.clone())
                .filter(|&at| loads.shares[at] > 0.0)
                .map(|at| (energy.pairs.all[at].key, energy.pairs.all[at].part))
                .collect();
            (loads.elastic - fallen, parts)
        };
        let here = value(&[]).1;
        let mut is_smooth = true;
        let at = |steps: &[(usize, f64)]| {
            let (energy, parts) = value(steps);
            is_smooth &= parts == here;
            energy
        };
        let differences = Differences::new(at, [3e-8; 2]);
        if !is_smooth {
            continue;
        }
        energy.look(&scene, (0.0, Depth::up_to(2e-3)), (&[], &[]));
        let loads = energy.loads.carrying(&energy.pairs.groups);
        let ties = loads.filter(|(_, load)| load.n_sharing > 1);
        let is_rigid = |(group, _): &(&Group, &Load)| matches!(group.key, Key::Rigid(..));
        n_ties += ties.filter(is_rigid).count();
        n_smooth += 1;
        let features = meshes[0].features();
        let first_face = features.face_number(0);
        for (key, part) in &here {
            match key {
                Key::Rigid(..) => n_rigid += 1,
                Key::Taxel(..) if part.1 >= first_face => n_faces += 1,
                Key::Taxel(..) if part.1 >= features.corners().len() as u32 => n_edges += 1,
                Key::Taxel(..) => n_corners += 1,
            }
        }
        let (gradient, hessian) = Model::default().lay(&scene, &energy);
        differences.assert_equal((&gradient, &hessian), [1e-5, 1e-3]);
    }
    let all = [n_smooth, n_faces, n_edges, n_corners, n_rigid, n_ties];
    let names = "poses, faces, edges, corners, rigid contacts, rigid ties";
    assert!(all.iter().all(|n| *n > 3), "{names}: {all:?}");
}
