//! Benchmarks of measuring 1,000 touches of a 64 × 64 array, adding noise and smoothing to them, and reconstructing 64 of them.

use bubbletouch::random::Seed;
use bubbletouch::sensing::{
    Basis, Dictionary, Effort, Ensemble, Projection, Reconstructor, SensedDictionary, Solver,
};
use bubbletouch::signal::{Chain, Noise, NoiseUnit, SensorError, SignalStep, SignalWorkspace};
use bubbletouch::world::ImageShape;
use bubbletouch::world::{Grid, Patch, Taxel};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use ndarray::Array2;

const N_TOUCHES: usize = 1000;
const SIDE: usize = 64;

fn frames() -> Array2<f64> {
    Array2::from_shape_fn((N_TOUCHES, SIDE * SIDE), |(i, j)| {
        1e-3 * (1.0 + ((i * 31 + j) as f64 * 0.1).sin())
    })
}

fn measure(criterion: &mut Criterion) {
    let frames = frames();
    let mut group = criterion.benchmark_group("measure_1000_touches_64x64");
    group.throughput(Throughput::Elements(N_TOUCHES as u64));
    group.sample_size(10);
    for (name, ensemble) in [
        ("gaussian", Ensemble::Gaussian),
        ("bernoulli", Ensemble::Bernoulli),
        ("sparse", Ensemble::Sparse),
        ("sbhe", Ensemble::Sbhe),
        ("block_average", Ensemble::BlockAverage),
        ("subsample", Ensemble::Subsample),
        ("identity", Ensemble::Identity),
    ] {
        for m in [64, 1024] {
            let projection = Projection::new(
                ensemble,
                ImageShape { ny: SIDE, nx: SIDE },
                m,
                &Seed::new(1),
            )
            .expect("m is in its range");
            let mut out = Array2::zeros((N_TOUCHES, projection.n_measurements()));
            group.bench_function(BenchmarkId::new(name, m), |bencher| {
                bencher.iter(|| projection.measure_into(frames.view(), out.view_mut()));
            });
        }
    }
    group.finish();
}

fn signal(criterion: &mut Criterion) {
    let grid = Grid {
        nx: SIDE,
        ny: SIDE,
        pitch: 2e-3,
    };
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    let patch = Patch::grid(grid, taxel).expect("the patch is valid");
    let noise = SignalStep::Noise(Noise {
        std: 0.1,
        unit: NoiseUnit::FullScale,
    });
    let skin = Seed::new(1);
    let mut group = criterion.benchmark_group("signal_one_touch_64x64");
    for (name, step) in [
        ("force", SignalStep::Force),
        ("noise", noise),
        ("smoothing_2_taxels", SignalStep::Smoothing { width: 4e-3 }),
        (
            "hysteresis",
            SensorError::Hysteresis.step(&[0.1], skin).unwrap(),
        ),
        (
            "crosstalk",
            SensorError::Crosstalk.step(&[0.1], skin).unwrap(),
        ),
        ("gain", SensorError::Gain.step(&[0.1], skin).unwrap()),
        ("drift", SensorError::Drift.step(&[0.1], skin).unwrap()),
        (
            "faults",
            SensorError::Faults.step(&[0.05, 0.05], skin).unwrap(),
        ),
        (
            "quantisation",
            SensorError::Quantisation.step(&[8.0], skin).unwrap(),
        ),
    ] {
        let chain = Chain::new(&[step], &patch).expect("the step is valid");
        let (mut frame, mut scratch) = (vec![1e-3; SIDE * SIDE], SignalWorkspace::default());
        let mut touch = 0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                touch += 1;
                frame.fill(1e-3);
                chain.apply(&mut frame, None, &Seed::new(touch), &mut scratch);
            });
        });
    }
    group.finish();
}

/// Returns frames of bumps at different positions on the array, for training dictionaries and for reconstruction.
fn bumps(n_frames: usize) -> Array2<f64> {
    Array2::from_shape_fn((n_frames, SIDE * SIDE), |(i, j)| {
        let (y, x) = ((j / SIDE) as f64, (j % SIDE) as f64);
        let (cy, cx) = ((i * 7 % 64) as f64, (i * 11 % 61) as f64);
        let (dy, dx) = (y - cy, x - cx);
        2e-3 * (1.0 - (dx * dx + dy * dy) / (40.0 + (i % 13) as f64)).max(0.0)
    })
}

fn reconstruct(criterion: &mut Criterion) {
    const BATCH: usize = 64;
    let seed = Seed::new(1);
    let (train, grid) = (bumps(600), ImageShape { ny: SIDE, nx: SIDE });
    let mut group = criterion.benchmark_group("reconstruct_64_touches_64x64_from_1024");
    group.throughput(Throughput::Elements(BATCH as u64));
    group.sample_size(10);
    let projection = Projection::new(Ensemble::Sbhe, grid, 1024, &seed).expect("m is in its range");
    let measurements = projection.measure(bumps(BATCH).view());
    for (name, basis) in [("dct", Basis::Dct), ("pca", Basis::Pca)] {
        let dictionary = Dictionary::learned(basis, grid, train.view(), Some(256), &seed)
            .expect("training frames are finite");
        let sensed = SensedDictionary::new(&projection, &dictionary).expect("one array");
        for (solver_name, solver) in [
            ("omp", Solver::Omp),
            ("l1", Solver::L1),
            ("lmmse", Solver::Lmmse),
        ] {
            let reconstructor = Reconstructor::new(solver, &sensed, &Effort::default(), 5e-4)
                .expect("the dictionary is learned");
            group.bench_function(
                BenchmarkId::new(solver_name, format!("{name}_256")),
                |bencher| {
                    bencher.iter(|| reconstructor.reconstruct(measurements.view()));
                },
            );
        }
    }
    group.finish();
}

criterion_group!(benches, measure, signal, reconstruct);
criterion_main!(benches);
