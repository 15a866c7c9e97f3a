//! Presses, a chain, a projection and SVMs by the library alone, as `.npy` files in a folder: what `tests/test_identity.py` computes again in Python
//! and compares bit by bit. With `pace SIDE`, prints the time of the press kernel alone, which `benches/press.py` compares with calls from Python.

use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::{Model, Sphere, SphereUnion};
use bubbletouch::random::Seed;
use bubbletouch::recognition::classifiers::class_model::ClassModel;
use bubbletouch::recognition::classifiers::linear_svm::LinearSvmParams;
use bubbletouch::recognition::data::dataset::dataset;
use bubbletouch::recognition::svm::SvmParams;
use bubbletouch::recognition::svm::kernel::{Gamma, Kernel};
use bubbletouch::sensing::{Ensemble, Projection};
use bubbletouch::signal::{Chain, Noise, NoiseUnit, SensorError, SignalStep, SignalWorkspace};
use bubbletouch::study::write_npy;
use bubbletouch::world::ImageShape;
use bubbletouch::world::{Grid, Layout, Patch, Taxel};
use bubbletouch::{Error, Result};
use glam::{DQuat, DVec3};
use ndarray::{Array1, Array2};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

const N: usize = 120;
const TAXEL: Taxel = Taxel {
    radius: 1e-3,
    stiffness: 100.0,
    damping: 0.0,
    stroke: 5e-3,
};

/// Three balls in a row, apart by a distance, metres.
fn balls(apart: f64) -> Result<Model> {
    let ball = |k: i32| Sphere {
        center: DVec3::new(f64::from(k) * apart, 0.0, 0.03),
        radius: 0.012,
    };
    Ok(SphereUnion::new((-1..=1).map(ball).collect())?.into())
}

/// Numbers that are exact in any language.
fn pose(number: usize) -> Pose {
    let k = number as f64;
    let turn = DQuat::from_xyzw(0.0, 0.0, 0.6, 0.8).normalize();
    let at = DVec3::new((k - 60.0) / 8192.0, (number % 7) as f64 / 1024.0, 0.0);
    Pose::new(turn, at)
}

/// Prints the shortest mean time of a press of a ball on a grid of `side` × `side` taxels over five rounds, seconds.
fn print_pace(side: usize) -> Result<()> {
    let grid = Grid {
        nx: side,
        ny: side,
        pitch: 2e-3,
    };
    let patch = Patch::grid(grid, TAXEL)?;
    let ball = Sphere {
        center: DVec3::ZERO,
        radius: 0.02,
    };
    let models = [SphereUnion::new(vec![ball])?.into()];
    let poses = [Pose::from_translation(DVec3::new(0.0, 0.0, 0.03))];
    let press = Press::new(&patch, &models, &poses, Until::Depth(1e-3));
    let (mut workspace, mut shortest) = (Workspace::new(), f64::INFINITY);
    for _ in 0..5 {
        let start = Instant::now();
        for _ in 0..20_000 {
            press.run(&mut workspace)?;
            black_box(workspace.deflections());
        }
        shortest = shortest.min(start.elapsed().as_secs_f64() / 20_000.0);
    }
    println!("{shortest}");
    Ok(())
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, word, side] = &arguments[..]
        && word == "pace"
    {
        return print_pace(side.parse().expect("a number of rows and columns"));
    }
    let folder = arguments
        .get(1)
        .ok_or_else(|| Error::input("reference", "no folder", "the folder where its files go"))?;
    let folder = Path::new(folder);
    let grid = Grid {
        nx: 24,
        ny: 20,
        pitch: 2e-3,
    };
    let flat = Patch::grid(grid, TAXEL)?;
    let hexagonal = Patch::new("patch", Layout::hexagonal(24, 20, 2e-3)?, TAXEL)?;
    let models = [balls(0.014)?, balls(0.016)?, balls(0.02)?];
    let mut workspace = Workspace::new();
    for (name, patch) in [("grid", &flat), ("hexagonal", &hexagonal)] {
        for (goal, until) in [
            ("depth", Until::Depth(3e-3)),
            ("force", Until::Force(2.0)),
            ("here", Until::Pose),
        ] {
            let mut frames = Array2::zeros((N, patch.n_taxels()));
            for (number, mut frame) in frames.outer_iter_mut().enumerate() {
                let mut pose = pose(number);
                if until == Until::Pose {
                    pose.translation.z = -0.02;
                }
                let models = std::slice::from_ref(&models[number % 3]);
                Press::new(patch, models, &[pose], until).run(&mut workspace)?;
                frame.assign(&Array1::from(workspace.deflections().to_vec()));
            }
            write_npy(&folder.join(format!("{name}_{goal}.npy")), &frames)?;
            if (name, goal) == ("grid", "depth") {
                after_presses(folder, &flat, frames)?;
            }
        }
    }
    Ok(())
}

fn after_presses(folder: &Path, patch: &Patch, mut frames: Array2<f64>) -> Result<()> {
    let skin = Seed::new(7);
    let noise = Noise {
        std: 0.02,
        unit: NoiseUnit::FullScale,
    };
    let steps = [
        SensorError::Hysteresis.step(&[0.1], skin).unwrap(),
        SensorError::Gain.step(&[0.05], skin).unwrap(),
        SensorError::Drift.step(&[0.02], skin).unwrap(),
        SensorError::Faults.step(&[0.01, 0.02], skin).unwrap(),
        SignalStep::Noise(noise),
        SignalStep::Smoothing { width: 4e-3 },
        SensorError::Quantisation.step(&[10.0], skin).unwrap(),
    ];
    let chain = Chain::new(&steps, patch)?;
    let (touches, mut scratch) = (Seed::new(2018), SignalWorkspace::default());
    for (number, mut frame) in frames.outer_iter_mut().enumerate() {
        let frame = frame.as_slice_mut().expect("rows are whole");
        chain.apply(frame, None, &touches.numbered(number as u64), &mut scratch);
    }
    write_npy(&folder.join("chain.npy"), &frames)?;
    let drawn = Ensemble::ALL.iter().zip(Ensemble::NAMES);
    for (ensemble, (name, _)) in drawn.filter(|(ensemble, _)| ensemble.is_drawn()) {
        let projection =
            Projection::new(*ensemble, ImageShape { ny: 20, nx: 24 }, 32, &Seed::new(11))?;
        let measured = projection.measure(frames.view());
        write_npy(&folder.join(format!("{name}.npy")), &measured)?;
    }
    let projection = Projection::new(
        Ensemble::Sbhe,
        ImageShape { ny: 20, nx: 24 },
        32,
        &Seed::new(11),
    )?;
    let features = 1e3 * projection.measure(frames.view());
    let labels = Array1::from_iter((0..N).map(|number| number % 3));
    let data = dataset(features.clone(), labels)?;
    let gamma = Gamma::Scale;
    for (name, kernel) in [("linear", Kernel::Linear), ("rbf", Kernel::Rbf { gamma })] {
        let params = SvmParams {
            kernel,
            ..SvmParams::default()
        };
        let values = params.train(&data)?.decision_values(features.view())?;
        write_npy(&folder.join(format!("svc_{name}.npy")), &values)?;
    }
    let linear = LinearSvmParams::default().train(&data, &Seed::new(0))?;
    write_npy(
        &folder.join("linear_svc.npy"),
        &linear.scores(features.view())?,
    )
}
