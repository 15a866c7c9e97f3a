//! Benchmarks of training, choice of parameters and prediction of SVMs, beside the training and prediction of linfa-svm.
//!
//! `cargo bench --bench recognition` uses 20 classes with 30 training and 30 test touches each. The features are standardised Gaussian measurements of
//! synthetic frames. Ids end with the number of measurements m.

use bubbletouch::contact::{self, Press, Until};
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::classifier::Classifier;
use bubbletouch::recognition::data::dataset::{Dataset, dataset};
use bubbletouch::recognition::data::scaling::Scaling;
use bubbletouch::recognition::data::split::stratified_k_fold;
use bubbletouch::recognition::features::{
    Cut, FeatureWorkspace, Features, ImageFeature, ImageFeatures, Join,
};
use bubbletouch::recognition::svm::cross_validation::choice::{Candidates, choose};
use bubbletouch::recognition::svm::kernel::{Gamma, Kernel};
use bubbletouch::recognition::svm::{Multiclass, SvmParams};
use bubbletouch::signal::{Chain, Noise, NoiseUnit, SignalStep, SignalWorkspace};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::{Plan, StudySpec, draw_touches, load_objects};
use bubbletouch::world::ImageShape;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use linfa::DatasetBase;
use linfa::traits::Fit;
use linfa_svm::Svm;
use ndarray::{Array1, Array2, Axis};
use rand::Rng;
use rand_distr::StandardNormal;

const N_CLASSES: usize = 20;
const N_PER_CLASS: usize = 30;
const SIDE: usize = 24;

/// Returns measurements of synthetic frames: smooth non-negative bumps, four per class, shifted and rotated at random, and projected to m numbers.
fn touches(m: usize, seed: &Seed) -> Dataset {
    let n_rows = N_CLASSES * N_PER_CLASS;
    let mut frames = Array2::zeros((n_rows, SIDE * SIDE));
    let labels = Array1::from_iter((0..n_rows).map(|row| row / N_PER_CLASS));
    for (row, mut frame) in frames.rows_mut().into_iter().enumerate() {
        let mut shape = Seed::new(1)
            .named("shape")
            .numbered(labels[row] as u64)
            .rng();
        let bumps: [[f64; 4]; 4] = std::array::from_fn(|_| {
            let (x, y) = (shape.gen_range(-4.0..4.0), shape.gen_range(-4.0..4.0));
            [x, y, shape.gen_range(8.0..60.0), shape.gen_range(0.3..1.0)]
        });
        let mut pose = seed.numbered(row as u64).rng();
        let (dx, dy) = (pose.gen_range(-3.0..3.0), pose.gen_range(-3.0..3.0));
        let (sin, cos) = pose.gen_range(0.0..0.9_f64).sin_cos();
        for (taxel, value) in frame.iter_mut().enumerate() {
            let u = (taxel % SIDE) as f64 - 11.5 - dx;
            let v = (taxel / SIDE) as f64 - 11.5 - dy;
            let (u, v) = (cos * u - sin * v, sin * u + cos * v);
            let height =
                |[x, y, width, top]: [f64; 4]| top - ((u - x).powi(2) + (v - y).powi(2)) / width;
            let noise: f64 = pose.sample(StandardNormal);
            *value = bumps.map(height).into_iter().fold(0.0, f64::max) + 0.02 * noise;
        }
    }
    let mut projection = Seed::new(1).named("projection").rng();
    let projection = Array2::from_shape_fn((SIDE * SIDE, m), |_| {
        projection.sample::<f64, _>(StandardNormal)
    });
    let features = frames.dot(&projection);
    let scaling = Scaling::Standard.fit(features.view()).unwrap();
    dataset(scaling.apply(features.view()).unwrap(), labels).unwrap()
}

fn kernels() -> [(&'static str, Kernel); 2] {
    let gamma = Gamma::Scale;
    [("linear", Kernel::Linear), ("rbf", Kernel::Rbf { gamma })]
}

fn train(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("train");
    group.sample_size(10);
    for m in [64, 256] {
        let data = touches(m, &Seed::new(2));
        for (name, kernel) in kernels() {
            for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
                let params = SvmParams {
                    kernel,
                    multiclass,
                    ..SvmParams::default()
                };
                let name = format!("{name} {multiclass:?}");
                group.bench_function(BenchmarkId::new(name, m), |bencher| {
                    bencher.iter(|| params.train(&data).unwrap());
                });
            }
            let name = format!("{name} OneVsOne, linfa-svm");
            group.bench_function(BenchmarkId::new(name, m), |bencher| {
                bencher.iter(|| linfa_models(kernel, &data));
            });
        }
    }
    group.finish();
}

/// Benchmarks the choice among three values of C, and three of γ for the RBF kernel, with three folds.
fn choice(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("choose C and gamma");
    group.sample_size(10);
    let candidates = Candidates {
        c: vec![0.1, 1.0, 10.0],
        gamma_scales: vec![0.3, 1.0, 3.0],
    };
    for m in [64, 256] {
        let data = touches(m, &Seed::new(2));
        let folds = stratified_k_fold(data.targets.view(), 3, &Seed::new(4)).unwrap();
        for (name, kernel) in kernels() {
            let params = SvmParams {
                kernel,
                ..SvmParams::default()
            };
            group.bench_function(BenchmarkId::new(name, m), |bencher| {
                bencher.iter(|| choose(&params, &data, &folds, &candidates).unwrap());
            });
        }
    }
    group.finish();
}

fn predict(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("predict 600 rows, one-vs-one");
    group.sample_size(10);
    for m in [64, 256] {
        let data = touches(m, &Seed::new(2));
        let test = touches(m, &Seed::new(3)).records;
        for (name, kernel) in kernels() {
            let params = SvmParams {
                kernel,
                ..SvmParams::default()
            };
            let model = params.train(&data).unwrap();
            group.bench_function(BenchmarkId::new(name, m), |bencher| {
                bencher.iter(|| model.labels(test.view()).unwrap());
            });
            let oracles = linfa_models(kernel, &data);
            group.bench_function(
                BenchmarkId::new(format!("{name}, linfa-svm"), m),
                |bencher| {
                    bencher.iter(|| {
                        let decide = |svm: &Svm<f64, bool>| {
                            test.rows()
                                .into_iter()
                                .map(|row| svm.weighted_sum(&row) - svm.rho)
                                .sum::<f64>()
                        };
                        oracles.iter().map(decide).sum::<f64>()
                    });
                },
            );
        }
    }
    group.finish();
}

/// Trains linfa-svm's model of every pair of classes.
fn linfa_models(kernel: Kernel, data: &Dataset) -> Vec<Svm<f64, bool>> {
    let mut models = Vec::new();
    for a in 0..N_CLASSES {
        for b in a + 1..N_CLASSES {
            let in_pair = |row: &usize| [a, b].contains(&data.targets[*row]);
            let rows: Vec<usize> = (0..data.targets.len()).filter(in_pair).collect();
            let targets = Array1::from_iter(rows.iter().map(|&row| data.targets[row] == a));
            let params = Svm::<f64, bool>::params().eps(1e-3);
            let params = match kernel {
                Kernel::Linear => params.linear_kernel(),
                // For standardised features, 1/γ is the number of features.
                _ => params.gaussian_kernel(data.records.ncols() as f64),
            };
            let pair = DatasetBase::new(data.records.select(Axis(0), &rows), targets);
            models.push(params.fit(&pair).unwrap());
        }
    }
    models
}

/// Benchmarks the features of a frame of 64 × 64 taxels, touched by a disc of half its width, on one thread.
fn features(criterion: &mut Criterion) {
    const TAXELS: usize = 64;
    let height = |i: usize| {
        let (x, y) = ((i % TAXELS) as f64 - 30.3, (i / TAXELS) as f64 - 33.1);
        (1.0 - (x * x + 1.5 * y * y) / 256.0 + 0.05 * (0.7 * x + 0.4 * y).sin()).max(0.0)
    };
    let frame: Vec<f64> = (0..TAXELS * TAXELS).map(height).collect();
    let mut group = criterion.benchmark_group("features of a frame");
    let mut named: Vec<Vec<ImageFeature>> = ImageFeature::ALL.iter().map(|f| vec![*f]).collect();
    named.push(vec![
        ImageFeature::FourierMellin,
        ImageFeature::PolarHarmonics,
        ImageFeature::Descriptors,
    ]);
    for features in named {
        let join = Join::new(&features).unwrap();
        let shape = ImageShape {
            ny: TAXELS,
            nx: TAXELS,
        };
        let features = ImageFeatures::new(join, shape, 1.0, Cut::default());
        let (mut workspace, mut out) =
            (FeatureWorkspace::default(), vec![0.0; join.n_values(shape)]);
        group.bench_function(BenchmarkId::new(join.to_string(), TAXELS), |bencher| {
            bencher.iter(|| features.write(&frame, &mut workspace, &mut out));
        });
    }
    group.finish();
}

/// Study of objects in any position, touched once with 10 % noise.
const TOUCHES: &str = r#"
question = "How long from touch to answer?"
trials = 1
[objects]
sets = ["household"]
surface_error_mm = 1.0
[skin]
pitch_mm = 2.0
taxels = 64
stroke_mm = 5.0
[touches]
per_object = 80
offset_x_mm = { uniform = [-10.0, 10.0] }
offset_y_mm = { uniform = [-10.0, 10.0] }
yaw_deg = { uniform = [0.0, 360.0] }
depth_mm = { uniform = [2.0, 4.0] }
[signal]
noise_std_full_scale = 0.1
smoothing_mm = 4.0
[sensing]
ensemble = "identity"
[recognition]
features = "fourier_mellin+polar_harmonics+descriptors"
classifier = "linear_svm"
"#;

/// Benchmarks one touch on one thread: press, noise and smoothing, joined invariant features, and classification.
fn touch_to_answer(criterion: &mut Criterion) {
    let plan = StudySpec::parse("bench.toml", TOUCHES).unwrap();
    let plan = Plan::new("bench.toml", plan).unwrap();
    let objects = load_objects(&plan.spec.objects, None).unwrap();
    let touched = draw_touches(objects, &plan.placement, &Seed::new(1)).unwrap();
    let study = RecognitionStudy::new(plan, Box::new(touched.clone())).unwrap();
    let set = study.first().features((0, 0), &Silent).unwrap();
    let array = &study.first().plan.array;
    let noise = Noise {
        std: 0.1,
        unit: NoiseUnit::FullScale,
    };
    let steps = [
        SignalStep::Noise(noise),
        SignalStep::Smoothing { width: 4e-3 },
    ];
    let chain = Chain::new(&steps, array.patch()).unwrap();
    // Noise after smoothing, 0.0149 of full scale, times √(2 ln 4096).
    let cut = Cut {
        level: 3e-4,
        foremost: None,
    };
    let join = Features::try_from("fourier_mellin+polar_harmonics+descriptors".to_owned());
    let join = join.unwrap().of_image().unwrap();
    let features = ImageFeatures::new(join, array.shape(), 5e-3, cut);
    let mut group = criterion.benchmark_group("touch to answer");
    for (kind, multiclass) in [
        (ClassifierKind::LinearSvm, Multiclass::OneVsOne),
        (ClassifierKind::LinearSvm, Multiclass::OneVsRest),
        (ClassifierKind::RbfSvm, Multiclass::OneVsOne),
    ] {
        let classifier = Classifier {
            multiclass,
            ..Classifier::new(kind)
        };
        let classifier = classifier
            .train(&set.training(None).unwrap(), &Seed::new(1))
            .unwrap();
        let (mut press, mut scratch) = (contact::Workspace::new(), SignalWorkspace::default());
        let (mut workspace, mut frame) = (FeatureWorkspace::default(), vec![0.0; array.n_taxels()]);
        let mut row = Array2::zeros((1, join.n_values(array.shape())));
        let mut next = 0;
        let name = format!("{kind:?}, {multiclass:?}");
        group.bench_function(BenchmarkId::new(name, touched.len()), |bencher| {
            bencher.iter(|| {
                next += 1;
                let object = &touched[next % touched.len()];
                let place = &object.touches[next % object.touches.len()];
                let pose = place.patch_from_object(&object.rests[place.rest]);
                let model = std::slice::from_ref(&object.object.model);
                Press::new(array.patch(), model, &[pose], Until::Depth(place.depth))
                    .run(&mut press)
                    .unwrap();
                frame.copy_from_slice(press.deflections());
                let seed = Seed::new(2).numbered(next as u64);
                chain.apply(&mut frame, None, &seed, &mut scratch);
                features.write(&frame, &mut workspace, row.as_slice_mut().unwrap());
                classifier.labels(row.view()).unwrap()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, train, choice, predict, features, touch_to_answer);
criterion_main!(benches);
