//! Random forests [Breiman 2001]. Each tree is grown on a bootstrap sample of the training rows, and each node considers √m random features. The trees vote
//! with the class fractions of their leaves, as in scikit-learn.
//!
//! The crate linfa-ensemble 0.8.1 is not used for three reasons. The trees of linfa-trees 0.8.1 sum impurities in f32 in the order of a `HashMap`, so two
//! models trained on equal rows differ. The crate linfa-ensemble breaks ties of votes in the order of a `HashMap`, and draws features once per tree instead of
//! once per node.

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::classifiers::parameters::{DefaultValue, MAX_COUNT, Parameter};
use ndarray::{Array2, ArrayView2};
use rand::Rng;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use crate::class_model::{ClassModel, log_vote_shares};
use crate::class_weight::ClassWeight;
use crate::classifiers::ranked::Ranked;
use crate::classifiers::tree::{Growth, Tree, check_depth};
use crate::dataset::{Dataset, check_width, checked_classes, positions};
use crate::saved::SavedModel;
use crate::streams::Streams;
use crate::{Error, Result};

/// Trained random forest. The score of a class is the logarithm of its smoothed fraction of the trees' votes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RandomForest {
    classes: Vec<usize>,
    class_weights: Vec<f64>,
    trees: Vec<Tree>,
    n_features: usize,
}

impl RandomForest {
    /// Grows `n_trees` trees, each until all leaves contain a single class or the depth `max_depth` is reached. Tree t uses the random stream
    /// `seed.named("tree").numbered(t)`, so a larger forest contains the trees of a smaller forest.
    ///
    /// # Errors
    /// If there are no trees, the depth is 0, the data are empty, or a feature is NaN or infinite. If the number of labels differs from the number of rows, or
    /// there is a single class.
    pub fn train(
        data: &Dataset,
        n_trees: usize,
        max_depth: Option<usize>,
        class_weight: ClassWeight,
        seed: &dyn Streams,
    ) -> Result<Self> {
        let classes = checked_classes(data)?;
        check_depth(max_depth)?;
        if n_trees == 0 {
            return Err(Error::input("trees", 0, "at least 1 is allowed"));
        }
        let n_features = data.records.ncols();
        let label = positions(data.targets.view(), &classes);
        let class_weights = class_weight.of_classes(&label, classes.len()).to_vec();
        let growth = Growth {
            class_weights: &class_weights,
            n_candidates: n_features.isqrt().max(1),
            max_depth,
        };
        let ranked = Ranked::new(data.records.view());
        let n_rows = label.len() as u32;
        let trees = (0..n_trees as u64)
            .map(|tree| {
                let seed = seed.named("tree").numbered(tree);
                let mut rng = seed.named("rows").rng();
                let rows = (0..n_rows).map(|_| rng.gen_range(0..n_rows)).collect();
                growth.grow(&ranked, &label, rows, &*seed.named("features"))
            })
            .collect();
        Ok(Self {
            classes,
            class_weights,
            trees,
            n_features,
        })
    }
}

impl ClassModel for RandomForest {
    fn saved(&self) -> Option<SavedModel> {
        Some(SavedModel::RandomForest(self.clone()))
    }

    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn is_probabilistic(&self) -> bool {
        true
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.n_features)?;
        let mut votes = Array2::zeros((features.nrows(), self.classes.len()));
        // The outer loop runs over trees, because one tree fits into the processor's cache for all rows.
        for tree in &self.trees {
            for (row, mut votes) in features.rows().into_iter().zip(votes.rows_mut()) {
                let counts = tree.leaf(row);
                let weighted = |&(class, count): &(u32, u32)| {
                    self.class_weights[class as usize] * f64::from(count)
                };
                let sum: f64 = counts.iter().map(weighted).sum();
                for count in counts {
                    votes[count.0 as usize] += weighted(count) / sum;
                }
            }
        }
        Ok(log_vote_shares(votes))
    }
}

const N_TREES: Parameter = Parameter::integer(
    "n_trees",
    "number of trees of a random forest",
    [1.0, MAX_COUNT],
    DefaultValue::Number(100.0),
);

const MAX_DEPTH: Parameter = Parameter::integer(
    "max_depth",
    "maximum depth of the trees of a random forest",
    [1.0, MAX_COUNT],
    DefaultValue::Rule("pure", "trees grow until their leaves are pure"),
);

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_class_weights: true,
    parameters: &[N_TREES, MAX_DEPTH],
    ..ClassifierAbout::new("random forest", |classifier, scaled, _, seed| {
        let n_trees = N_TREES.count(&classifier.parameters);
        let depth = MAX_DEPTH.value(&classifier.parameters);
        let depth = depth.map(|depth| depth as usize);
        let seed = seed.named("forest");
        let forest = RandomForest::train(scaled, n_trees, depth, classifier.class_weight, &*seed)?;
        Ok(Arc::new(forest))
    })
};

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array1;

    #[test]
    fn a_tree_sees_two_thirds_of_the_rows() {
        let mut rng = 5_u64.rng();
        let features = Array2::from_shape_simple_fn((600, 4), || rng.r#gen::<f64>());
        let labels = Array1::from_shape_simple_fn(600, || rng.gen_range(0..2));
        let data = Dataset::new(features, labels);
        let tree = RandomForest::train(&data, 1, None, ClassWeight::Uniform, &3_u64).unwrap();
        let found = tree.labels(data.records.view()).unwrap();
        let n_right = found.iter().zip(&data.targets).filter(|(a, b)| a == b);
        // All rows of the bootstrap sample, 1 − 1/e of the rows, and half of the others: 490, within five standard deviations.
        let n_right = n_right.count();
        assert!((440..=540).contains(&n_right), "{n_right}");
    }
}
