//! The four hot paths on fixed scenes, and the amount of work per step.
#![allow(dead_code, reason = "each bench uses some of it")]

use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::{Model, Sphere, SphereUnion};
use bubbletouch::random::Seed;
use bubbletouch::recognition::data::dataset::dataset;
use bubbletouch::recognition::svm::kernel::Kernel;
use bubbletouch::recognition::svm::{Multiclass, SvmParams};
use bubbletouch::sensing::{Ensemble, Projection};
use bubbletouch::whole_body::{BodyState, SphereClusters, WholeBody};
use bubbletouch::world::{Extrusion, Grid, ImageShape, Patch, Taxel};
use glam::{DQuat, DVec3};
use ndarray::{Array1, Array2, Axis};
use rand::Rng;

/// Patch and the objects that press it.
struct Scene {
    patch: Patch,
    objects: Vec<Model>,
}

/// Path of computation that is repeated step by step.
pub struct HotPath {
    /// Name of the path, without spaces.
    pub name: String,
    /// Function that makes one step; each step uses another pose or row.
    pub step: Box<dyn FnMut()>,
    /// Work of one step.
    pub work: Work,
}

/// Function that prepares a path.
pub type Make = fn() -> HotPath;

/// Minimum work of a step, counted from the equations. Each multiplication, addition, comparison and root is one operation. Each number that is read or written
/// counts with its bytes, regardless of caches.
#[derive(Clone, Copy, Default)]
pub struct Work {
    /// Number of operations that are not roots.
    pub operations: f64,
    pub roots: f64,
    pub bytes: f64,
    /// Bytes of all numbers that a step accesses, each counted once; determines which cache can hold them.
    pub working_set: f64,
}

const PITCH: f64 = 2e-3;

fn taxel(stroke: f64) -> Taxel {
    Taxel {
        radius: 0.5 * PITCH,
        stiffness: 100.0,
        damping: 0.0,
        stroke,
    }
}

fn grid(n: usize) -> Grid {
    Grid {
        nx: n,
        ny: n,
        pitch: PITCH,
    }
}

/// Returns spheres so large that each touches all of n × n taxels at a few millimetres of depth. The centres are over the middle of the patch; the lowest
/// points are at z = ρ ± 0.5 mm.
fn large_spheres(n_spheres: usize, n: usize) -> SphereUnion {
    let half = 0.5 * PITCH * n as f64;
    // From the middle to a corner, the sphere rises by a millimetre.
    let radius = half * half / 1e-3;
    let mut rng = Seed::new(8).named("large spheres").rng();
    let spheres = (0..n_spheres).map(|_| {
        let mut shift = |most: f64| rng.gen_range(-most..most);
        let center = DVec3::new(shift(0.1 * half), shift(0.1 * half), shift(5e-4));
        Sphere {
            center: center + (radius + 0.5 * PITCH) * DVec3::Z,
            radius,
        }
    });
    SphereUnion::new(spheres.collect()).expect("radii are positive")
}

/// Returns a different pose for each step: `depth` metres below the objects, varied by 0.1 mm.
fn pose(step: usize, depth: f64) -> Pose {
    let wave = (0.7 * step as f64).sin();
    Pose::from_translation(DVec3::new(1e-3 * wave, 0.0, 1e-4 * wave - depth))
}

/// Returns the path of a grid patch whose taxels are all touched by every sphere.
///
/// Per sphere and taxel: dx (1), dx² (1), q = S² − dy² − dx² (1), √q, − h (1), maximum of two (1). Each pair reads x and δ, and writes δ.
pub fn dense_press(n: usize, n_spheres: usize) -> HotPath {
    let scene = Scene {
        patch: Patch::grid(grid(n), taxel(0.02)).expect("the grid has taxels"),
        objects: vec![large_spheres(n_spheres, n).into()],
    };
    let mut workspace = Workspace::new();
    let pairs = (n * n * n_spheres) as f64;
    let mut number = 0;
    let mut step = move || {
        number += 1;
        Press::new(
            &scene.patch,
            &scene.objects,
            &[pose(number, 4e-3)],
            Until::Pose,
        )
        .run(&mut workspace)
        .unwrap()
        .unwrap_or_default()
        .n_touched
    };
    assert_eq!(step(), n * n, "all are touched");
    HotPath {
        name: format!("press_{n}x{n}_all_touched_{n_spheres}_spheres"),
        step: Box::new(move || {
            step();
        }),
        work: Work {
            operations: 5.0 * pairs,
            roots: pairs,
            bytes: 24.0 * pairs,
            working_set: 8.0 * (n * n) as f64,
        },
    }
}

/// Returns the path of a press in which every sphere touches all taxels, with the kernel of whole bodies.
///
/// Per sphere and taxel: q = (S² − b²) − d² (1), comparison with zero (1), √q, − h (1), maximum of two (1). Each pair reads
/// S² − b², h and δ, and writes δ.
pub fn dense_body(n: usize, n_spheres: usize) -> HotPath {
    let extrusion = Extrusion::grid(&grid(n)).expect("the grid has taxels");
    let patch = Patch::new("patch", extrusion, taxel(0.02)).expect("the taxel is a good one");
    let body = WholeBody::new(&[patch]).expect("one name");
    let mut state = BodyState::at_rest(&body);
    let objects = [SphereClusters::new(&large_spheres(n_spheres, n))];
    let pairs = (n * n * n_spheres) as f64;
    let mut number = 0;
    let mut step = move || {
        number += 1;
        state
            .press(&body, &objects, &[pose(number, 4e-3)], 1e-3)
            .unwrap()
            .n_touched
    };
    assert_eq!(step(), n * n, "all are touched");
    HotPath {
        name: format!("body_{n}x{n}_all_touched_{n_spheres}_spheres"),
        step: Box::new(move || {
            step();
        }),
        work: Work {
            operations: 4.0 * pairs,
            roots: pairs,
            bytes: 32.0 * pairs,
            working_set: 24.0 * (n * n) as f64,
        },
    }
}

/// Returns the path of a touch of 64 × 64 taxels by 8,000 spheres on a bumpy egg. Each step has another pose. Most of the work is the search for
/// spheres near the patch.
pub fn sparse_press() -> HotPath {
    let mut rng = Seed::new(6).rng();
    let spheres = (0..8_000).map(|_| {
        let direction = DVec3::from(rng.r#gen::<[f64; 3]>()) * 2.0 - DVec3::ONE;
        Sphere {
            center: direction.normalize_or(DVec3::Z) * DVec3::new(0.05, 0.04, 0.03),
            radius: 2e-3,
        }
    });
    let egg = SphereUnion::new(spheres.collect()).expect("radii are positive");
    let scene = Scene {
        patch: Patch::grid(grid(64), taxel(5e-3)).expect("the grid has taxels"),
        objects: vec![egg.into()],
    };
    let mut workspace = Workspace::new();
    let mut number = 0;
    let mut step = move || {
        number += 1;
        let yaw = DQuat::from_rotation_z(0.17 * f64::from(number));
        let place = DVec3::new(2e-3 * f64::from(number % 6), 0.0, 0.1);
        Press::new(
            &scene.patch,
            &scene.objects,
            &[Pose::new(yaw, place)],
            Until::Depth(3e-3),
        )
        .run(&mut workspace)
        .unwrap()
    };
    assert!(step().is_some_and(|contact| contact.n_touched > 50));
    HotPath {
        name: "press_64x64_8000_spheres".into(),
        step: Box::new(move || {
            step();
        }),
        work: Work::default(),
    }
}

/// Returns the path of a ball of 1,000 spheres that rolls over a skin of 200,000 taxels and touches more than a thousand of them.
pub fn body_step() -> HotPath {
    let sleeve = Extrusion::cylinder(0.065, 0.1, 0.5 * std::f64::consts::PI, 1e-3);
    let sleeve = sleeve.expect("lengths are positive");
    let skin = Taxel {
        radius: 0.5e-3,
        ..taxel(2e-3)
    };
    let patches = (0..20).map(|k| {
        let patch = Patch::new(format!("patch {k}"), sleeve.clone(), skin);
        patch.expect("the taxel is a good one")
    });
    let body = WholeBody::new(&patches.collect::<Vec<_>>()).expect("every patch has its name");
    let mut state = BodyState::at_rest(&body);
    let poses = (0..20).map(|k| {
        let turn = DQuat::from_rotation_z(0.5 * std::f64::consts::PI * f64::from(k % 4));
        Pose::new(turn, 0.5 * DVec3::Y * f64::from(k / 4))
    });
    state.place(&body, &poses.collect::<Vec<_>>()).unwrap();
    let mut rng = Seed::new(7).rng();
    let spheres = (0..1_000).map(|_| {
        let direction = DVec3::from(rng.r#gen::<[f64; 3]>()) * 2.0 - DVec3::ONE;
        Sphere {
            center: 0.094 * direction.normalize_or(DVec3::Z),
            radius: 6e-3,
        }
    });
    let ball = SphereUnion::new(spheres.collect()).expect("radii are positive");
    let objects = [SphereClusters::new(&ball)];
    let mut number = 0;
    let mut step = move || {
        number += 1;
        let time = 1e-3 * f64::from(number);
        let angle = 0.8 + 0.2 * (3.0 * time).sin();
        let place = 0.136 * DVec3::new(angle.cos(), angle.sin(), 0.0);
        let pose = Pose::new(DQuat::from_rotation_y(time), place);
        state
            .press(&body, &objects, &[pose], 1e-3)
            .unwrap()
            .n_touched
    };
    let touched = step();
    assert!((500..20_000).contains(&touched), "{touched}");
    HotPath {
        name: format!("body_step_{touched}_touched_1000_spheres"),
        step: Box::new(move || {
            step();
        }),
        work: Work::default(),
    }
}

/// Returns the path of 1,024 scrambled-block measurements of 200,000 taxels, of which 10,000 are touched.
///
/// Each measurement has 32 taxels, so 1,638 entries of Φ of the touched taxels are non-zero. Each needs a product and a sum; its measurement index and its
/// value are read, and the sum is read and written. For each touched taxel, the start and end of its entries are read.
pub fn sensing() -> HotPath {
    const TOUCHED: usize = 10_000;
    let seed = Seed::new(9);
    let projection = Projection::new(Ensemble::Sbhe, ImageShape { ny: 400, nx: 500 }, 1024, &seed);
    let columns = projection.expect("m is in its range").columns();
    let mut measurements = vec![0.0; 1024];
    let mut first = 0;
    let step = move || {
        first = (first + 997) % 150_000;
        let touched = (0..TOUCHED).map(|k| (first + 5 * k, 1e-3 + 1e-7 * k as f64));
        columns.measure_touched(touched, &mut measurements);
    };
    let entries = 32.0 * 1024.0 / 200_000.0 * TOUCHED as f64;
    HotPath {
        name: format!("sense_{TOUCHED}_touched_to_1024"),
        step: Box::new(step),
        work: Work {
            operations: 2.0 * entries,
            roots: 0.0,
            bytes: 32.0 * entries + 8.0 * TOUCHED as f64,
            working_set: 16.0 * 32.0 * 1024.0 + 4.0 * 200_000.0,
        },
    }
}

/// Returns the path of classifying one touch of 1,024 measurements by a linear SVM, one-vs-one among 20 classes.
///
/// For each of the 190 hyperplanes and each measurement: a product and a sum. The factors of a product are read in double precision, because the training
/// set has fewer than 1,000 rows.
pub fn decision() -> HotPath {
    const CLASSES: usize = 20;
    const M: usize = 1024;
    let mut rng = Seed::new(10).rng();
    let labels = Array1::from_iter((0..10 * CLASSES).map(|row| row % CLASSES));
    let features = Array2::from_shape_fn((10 * CLASSES, M), |(row, column)| {
        f64::from(u8::from(column % CLASSES == row % CLASSES)) + rng.gen_range(-1.0..1.0)
    });
    let data = dataset(features.clone(), labels).expect("a label a row");
    let params = SvmParams {
        kernel: Kernel::Linear,
        multiclass: Multiclass::OneVsOne,
        ..SvmParams::default()
    };
    let model = params.train(&data).expect("two classes and more");
    let mut row = 0;
    let step = move || {
        row = (row + 1) % features.nrows();
        let one = features.index_axis(Axis(0), row).insert_axis(Axis(0));
        std::hint::black_box(model.labels(one).expect("as many features as learned"));
    };
    let products = (CLASSES * (CLASSES - 1) / 2 * M) as f64;
    HotPath {
        name: format!("decide_{CLASSES}_classes_from_{M}"),
        step: Box::new(step),
        work: Work {
            operations: 2.0 * products,
            roots: 0.0,
            bytes: 16.0 * products,
            working_set: 8.0 * products,
        },
    }
}
