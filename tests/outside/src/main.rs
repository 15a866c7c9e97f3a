//! Own parts of studies, linfa's cross-validation on published data sets, and presses with numbers that are none.

mod own_parts;

use bubbletouch_sim::contact::{Press, Row, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{LengthUnit, TriangleMesh};
use bubbletouch_sim::objects::Catalogue;
use bubbletouch_sim::world::{Grid, Patch, Taxel};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::{Error, SvmParams};
use glam::DVec3;
use linfa::Dataset;
use linfa::dataset::DatasetBase;
use linfa::prelude::ToConfusionMatrix;
use linfa::traits::{Fit, Predict};
use ndarray::{Array1, ArrayView1, Ix1};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Returns the mean accuracy of each C in five folds of linfa.
fn validated(mut data: Dataset<f64, usize, Ix1>) -> Result<Array1<f32>, Error> {
    let params = [0.1, 1.0, 10.0].map(|c| SvmParams {
        kernel: Kernel::Rbf {
            gamma: Gamma::Scale,
        },
        c,
        ..SvmParams::default()
    });
    let accuracy = |predicted: &Array1<usize>, truth: &ArrayView1<usize>| {
        Ok(predicted.confusion_matrix(truth)?.accuracy())
    };
    data.cross_validate_single(5, &params, accuracy)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    own_parts::check()?;
    let mut rng = ChaCha8Rng::seed_from_u64(2018);
    let iris = linfa_datasets::iris().shuffle(&mut rng);
    let accuracies = validated(iris)?;
    println!("iris: {accuracies:.3}");
    assert!(accuracies.iter().all(|&accuracy| accuracy > 0.85));

    let wine = linfa_datasets::winequality().shuffle(&mut rng);
    let is_good = wine.targets.map(|&quality| quality > 5);
    let accuracies = validated(wine.clone())?;
    println!("winequality: {accuracies:.3}");
    assert!(accuracies.iter().all(|&accuracy| accuracy > 0.4));

    // Labels that are true or false, and a view.
    let (training, held_out) = wine.clone().split_with_ratio(0.8);
    let n = training.records.nrows();
    let good = DatasetBase::new(training.records.view(), is_good.slice(ndarray::s![..n]));
    let model = SvmParams::default().fit(&good)?;
    let predicted: Array1<bool> = model.predict(&held_out.records);
    let truth = is_good.slice(ndarray::s![n..]);
    let accuracy = predicted.confusion_matrix(&truth)?.accuracy();
    println!("good wine: {accuracy:.3}");
    assert!(accuracy > 0.6);

    let ball = [Catalogue::builtin()?.object("tennis")?.build(1e-3)?.model];
    let taxel = Taxel {
        radius: 2e-3,
        stiffness: 100.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    let patch = Patch::grid(
        Grid {
            nx: 8,
            ny: 8,
            pitch: 4e-3,
        },
        taxel,
    )?;
    let mut workspace = Workspace::new();
    let mut press = |place: f64, depth: f64| {
        let pose = Pose::from_translation(place * DVec3::X);
        Press::new(&patch, &ball, &[pose], Until::Depth(depth)).run(&mut workspace)
    };
    assert!(press(0.0, 1e-3)?.is_some_and(|contact| contact.n_touched > 0));
    // Numbers that are none, and an output of another size, are errors of one sentence.
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for pressed in [press(number, 1e-3), press(0.0, number)] {
            let sentence = pressed.expect_err("no number").to_string();
            println!("{sentence}");
            assert!(sentence.contains(&number.to_string()), "{sentence}");
        }
    }
    let (goal, mut row) = (Until::Depth(1e-3), [0.0; 63]);
    let row = Row::Double(&mut row);
    let pressed = Press::new(&patch, &ball, &[Pose::default()], goal).write(row, &mut workspace);
    let sentence = pressed.expect_err("63 values for 64 taxels").to_string();
    println!("{sentence}");
    assert!(sentence.contains("63 values for 64 taxels"));
    // A mesh in millimetres needs its unit.
    let corners = || [DVec3::ZERO, 20.0 * DVec3::X, 20.0 * DVec3::Y].to_vec();
    let metres = TriangleMesh::new("die", corners(), vec![[0, 1, 2]]);
    println!("{}", metres.expect_err("20 m").to_string());
    let unit = LengthUnit::Millimetre;
    TriangleMesh::in_unit("die", unit, corners(), vec![[0, 1, 2]])?;
    Ok(())
}
