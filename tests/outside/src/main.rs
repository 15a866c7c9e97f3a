//! Own parts of studies, linfa's cross-validation on published data sets, and a press.

mod own_parts;

use bubbletouch_sim::contact::{Workspace, press_to_depth};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::Catalogue;
use bubbletouch_sim::world::{Grid, Patch, Taxel};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::{Error, SvmParams};
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
    let mut press =
        |depth| press_to_depth(&patch, &ball, &[Pose::default()], depth, &mut workspace);
    assert!(press(1e-3).is_some_and(|contact| contact.n_touched > 0));
    Ok(())
}
