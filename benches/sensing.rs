//! Time to measure 1,000 touches of a 64 × 64 array, and to make their noise and smoothing.

use bubbletouch::random::Seed;
use bubbletouch::sensing::{Ensemble, Projection};
use bubbletouch::signal::{Chain, Noise, NoiseUnit, Scratch, SignalStep};
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
            let projection = Projection::new(ensemble, (SIDE, SIDE), m, &Seed::new(1))
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
    let patch = Patch::new(grid, taxel).expect("the patch is valid");
    let noise = SignalStep::Noise(Noise {
        std: 0.1,
        unit: NoiseUnit::FullScale,
    });
    let mut group = criterion.benchmark_group("signal_one_touch_64x64");
    for (name, step) in [
        ("force", SignalStep::Force),
        ("noise", noise),
        ("smoothing_2_taxels", SignalStep::Smoothing { width: 4e-3 }),
    ] {
        let chain = Chain::new(&[step], &patch).expect("the step is valid");
        let (mut frame, mut scratch) = (vec![1e-3; SIDE * SIDE], Scratch::default());
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

criterion_group!(benches, measure, signal);
criterion_main!(benches);
