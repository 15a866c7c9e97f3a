//! Benchmarks of the resting poses of an object of 3,000 spheres, and of the equilibrium of free objects after a motion of the skin.

use bubbletouch::contact::equilibrium::{
    EquilibriumSolver, FreeObject, Ground, Outcome, PlacedSkin,
};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::{Sphere, SphereUnion};
use bubbletouch::world::{Grid, Patch, Taxel, stable_poses};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use std::hint::black_box;

/// Returns spheres of 3 mm in a spiral on an ellipsoid with the given half axes.
fn ellipsoid(n: usize, axes: DVec3) -> SphereUnion {
    let point = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / n as f64;
        let (sin, cos) = (2.399963229728653 * i as f64).sin_cos();
        let flat = (1.0 - z * z).sqrt();
        axes * DVec3::new(flat * cos, flat * sin, z)
    };
    shell((0..n).map(point))
}

/// Returns spheres of 3 mm on the surface of a can.
fn can(n: usize, radius: f64, length: f64) -> SphereUnion {
    let around = (n as f64).sqrt() as usize;
    let point = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * (i % around) as f64 / around as f64).sin_cos();
        let along = (i / around) as f64 * around as f64 / n as f64;
        DVec3::new(radius * cos, radius * sin, length * along)
    };
    shell((0..n).map(point))
}

/// Returns spheres of 3 mm on the six sides of a box.
fn carton(n: usize, size: DVec3) -> SphereUnion {
    let per_side = ((n / 6) as f64).sqrt() as usize;
    let place = |i: usize| i as f64 / (per_side - 1) as f64;
    let sides = (0..6).flat_map(move |side| {
        (0..per_side * per_side).map(move |i| {
            let (u, v) = (place(i % per_side), place(i / per_side));
            let w = f64::from(side % 2);
            size * match side / 2 {
                0 => DVec3::new(w, u, v),
                1 => DVec3::new(u, w, v),
                _ => DVec3::new(u, v, w),
            }
        })
    });
    shell(sides)
}

fn shell(points: impl Iterator<Item = DVec3>) -> SphereUnion {
    let sphere = |center| Sphere {
        center,
        radius: 3e-3,
    };
    SphereUnion::new(points.map(sphere).collect()).expect("the spheres are valid")
}

fn rest(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stable_poses");
    group.sample_size(20);
    for (name, union) in [
        ("ellipsoid", ellipsoid(3000, DVec3::new(0.03, 0.04, 0.06))),
        ("can", can(3000, 0.034, 0.1)),
        ("carton", carton(3000, DVec3::new(0.04, 0.1, 0.15))),
        ("ball", ellipsoid(3000, DVec3::splat(0.04))),
    ] {
        group.bench_function(BenchmarkId::new(name, 3000), |bencher| {
            let object = union.clone().into();
            bencher.iter(|| stable_poses(&object));
        });
        group.bench_function(BenchmarkId::new(format!("{name}_mass"), 3000), |bencher| {
            bencher.iter(|| {
                SphereUnion::new(union.spheres().to_vec())
                    .unwrap()
                    .center_of_mass()
            });
        });
    }
    group.finish();
}

/// Benchmarks the equilibrium of one egg, and of four touching eggs, after the skin has moved by 0.2 mm. Each egg has 1,000 spheres; the patch has 4,096
/// taxels.
fn settle(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("settled_step_4096_taxels_1000_spheres");
    let grid = Grid {
        nx: 64,
        ny: 64,
        pitch: 2e-3,
    };
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 100.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    let skin = Patch::grid(grid, taxel).expect("the grid is valid");
    let egg = ellipsoid(1000, DVec3::new(0.017, 0.021, 0.019));
    let object = FreeObject::new(&egg, 0.1, DVec3::new(1e-3, 0.0, -3e-3));
    let object = object.expect("the mass is positive");
    for n in [1, 2, 4] {
        let mut balancer = EquilibriumSolver::new();
        let mut settle = |height: f64, starts: &[Pose]| {
            let skins = [PlacedSkin::new(
                &skin,
                Pose::from_translation(height * DVec3::Z),
            )];
            let ground = Ground {
                skins: skins.to_vec(),
                ..Ground::default()
            };
            let objects = vec![object; n];
            let found = balancer.solve_all(&objects, &ground, -9.81 * DVec3::Z, starts);
            let found = found.expect("the starts are finite");
            assert!(found.iter().all(|b| b.outcome == Outcome::AtRest));
            found.iter().map(|b| b.pose).collect::<Vec<_>>()
        };
        let start = |k: usize| {
            let side = |bit: usize| if bit == 0 { -0.021 } else { 0.021 };
            Pose::from_translation(DVec3::new(side(k & 1), side(k >> 1), 0.05))
        };
        let mut height = 0.0;
        let mut poses = settle(height, &(0..n).map(start).collect::<Vec<_>>());
        group.bench_function(BenchmarkId::new("objects", n), |bencher| {
            bencher.iter(|| {
                height = 2e-4 - height;
                poses = settle(black_box(height), &poses);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, rest, settle);
criterion_main!(benches);
