//! Strategies that combine binary classifiers into a multi-class classifier.

use serde::{Deserialize, Serialize};

/// Strategy that combines binary classifiers into a multi-class classifier.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Multiclass {
    /// One binary classifier per pair of classes; the class with the most votes is predicted. On a tie, the lowest class index is predicted (LIBSVM's rule).
    #[default]
    OneVsOne,
    /// One binary classifier per class against all others; the class with the largest decision value is predicted. On a tie, the lowest class index is
    /// predicted.
    OneVsRest,
}

impl Multiclass {
    /// Returns the binary problems of n classes as pairs (positive class, negative class); the negative class `None` means all other classes.
    pub(crate) fn problems(self, n: usize) -> Vec<(usize, Option<usize>)> {
        match self {
            Self::OneVsOne => (0..n)
                .flat_map(|first| (first + 1..n).map(move |second| (first, Some(second))))
                .collect(),
            Self::OneVsRest => (0..n).map(|class| (class, None)).collect(),
        }
    }
}
