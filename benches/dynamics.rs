//! Benchmarks of a touch: one quasi-static evaluation beside taxels simulated as bodies, for 8 × 8 to 64 × 64 taxels.
//!
//! Bodies start under the object at its final pose and make three steps in 10 ms; with fewer steps they do not reach equilibrium. The scene and all bodies are
//! built outside the timed part.

use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::dynamics::{Drive, ImplicitEuler, Integrator, SemiImplicit, System, skin_sim};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::{Catalogue, Model};
use bubbletouch::world::{Grid, Patch, RestPoses, Taxel, Touch, VelocityPlan};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use std::hint::black_box;

/// Patch and the objects that press it.
struct Scene {
    patch: Patch,
    objects: Vec<Model>,
}

const DT: f64 = 1e-2;
const N_STEPS: usize = 3;
const DEPTH: f64 = 3e-3;
const STROKE: f64 = 5e-3;
/// Additional distance within which objects are searched, metres; the objects do not move.
const REACH: f64 = 1e-6;

fn patch(side: usize) -> Patch {
    let grid = Grid {
        nx: side,
        ny: side,
        pitch: 2e-3,
    };
    let stiffness: f64 = 100.0;
    let taxel = Taxel {
        radius: 1e-3,
        stiffness,
        damping: 2.0 * (stiffness * skin_sim::TAXEL_MASS).sqrt(),
        stroke: STROKE,
    };
    Patch::grid(grid, taxel).expect("a good patch")
}

/// Returns a built-in bottle, approximated within half a millimetre.
fn bottle() -> Model {
    let catalogue = Catalogue::builtin().expect("the built-in catalogue is valid");
    let entry = catalogue
        .object("mustard_bottle")
        .expect("a built-in object");
    entry.build(5e-4).expect("it can be packed").model
}

/// Returns the pose of the pressed object, `patch_from_object`, at the depth.
fn pressed(scene: &Scene) -> Pose {
    let rest = RestPoses::AsModelled
        .poses(&scene.objects[0])
        .swap_remove(0);
    let touch = Touch {
        rest: 0,
        offset: [0.0; 2],
        yaw: 0.3,
        tilt: [0.03, -0.02],
        depth: DEPTH,
        indices: [None; 7],
    };
    let pose = touch.patch_from_object(&rest);
    let mut workspace = Workspace::new();
    let contact = bubbletouch::contact::Press::new(
        &scene.patch,
        &scene.objects,
        &[pose],
        bubbletouch::contact::Until::Depth(DEPTH),
    )
    .run(&mut workspace)
    .unwrap();
    let travel = contact.expect("the bottle is over the patch").travel;
    Pose::from_translation(-travel * DVec3::Z).compose(&pose)
}

/// Returns the mean |δ − δ*| over touched taxels, mm.
fn error_mm(felt: &[f64], right: &[f64]) -> f64 {
    let pairs = felt.iter().zip(right);
    let (mut sum, mut n) = (0.0, 0);
    for (felt, right) in pairs.filter(|(a, b)| **a > 1e-9 || **b > 0.0) {
        sum += 1e3 * (felt - right).abs();
        n += 1;
    }
    sum / f64::from(n)
}

fn steps(integrator: &mut dyn Integrator, system: &System) -> Vec<f64> {
    for _ in 0..N_STEPS {
        integrator.step(system, DT);
    }
    integrator.state(system).deflection.clone()
}

fn touch(c: &mut Criterion) {
    let mut group = c.benchmark_group("touch");
    group.sample_size(10);
    let bottle = bottle();
    for side in [8, 16, 32, 64] {
        let patch = patch(side);
        let scene = Scene {
            patch: patch.clone(),
            objects: vec![bottle.clone()],
        };
        let pose = pressed(&scene);
        let mut workspace = Workspace::new();
        group.bench_function(BenchmarkId::new("direct", side), |b| {
            b.iter(|| {
                Press::new(
                    black_box(&scene.patch),
                    &scene.objects,
                    &[pose],
                    Until::Pose,
                )
                .run(&mut workspace)
                .unwrap()
                .unwrap_or_default()
            });
        });
        let right = workspace.deflections().to_vec();
        let skin = patch.clone();
        let still = VelocityPlan::new(pose, Vec::new()).expect("no phases are good phases");
        let system = System::new(
            &skin,
            skin_sim::TAXEL_MASS,
            &bottle,
            pose,
            Drive::Imposed(still),
            REACH,
        );
        let system = system.expect("axes along z");
        let stiffest = SemiImplicit::stiffest(&system, DT, 1);
        type Start<'a> = Box<dyn Fn() -> Box<dyn Integrator> + 'a>;
        let mut bodies: Vec<(&str, Start)> = vec![
            (
                "semi_implicit",
                Box::new(|| Box::new(SemiImplicit::new(&system, stiffest))),
            ),
            (
                "implicit_euler",
                Box::new(|| Box::new(ImplicitEuler::new(&system))),
            ),
        ];
        #[cfg(feature = "rapier")]
        bodies.push((
            "rapier_tuned",
            Box::new(|| {
                use bubbletouch::dynamics::{RapierSettings, RapierWorld};
                let settings = RapierSettings::tuned(&system);
                Box::new(RapierWorld::new(&system, settings).expect("spheres"))
            }),
        ));
        for (name, build) in bodies.drain(..) {
            let felt = steps(build().as_mut(), &system);
            println!("{name}, {side} x {side}: {:.4} mm", error_mm(&felt, &right));
            group.bench_function(BenchmarkId::new(name, side), |b| {
                b.iter_batched(
                    &build,
                    |mut integrator| steps(integrator.as_mut(), &system),
                    criterion::BatchSize::PerIteration,
                );
            });
        }
    }
    group.finish();
}

criterion_group!(benches, touch);
criterion_main!(benches);
