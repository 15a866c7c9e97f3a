//! Combination of binary classifiers to a classifier of many classes.

use serde::{Deserialize, Serialize};

/// Combination of binary classifiers to a classifier of many classes.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Multiclass {
    /// One classifier per pair of classes; each votes, and the class with the most votes wins. On a tie, the lowest class index wins (LIBSVM's rule).
    #[default]
    OneVsOne,
    /// One classifier per class against all others; the largest decision value wins. On a tie, the lowest class index wins.
    OneVsRest,
}

impl Multiclass {
    /// Returns the binary problems of n classes as pairs of a positive and a negative class (`None`: all others).
    pub(crate) fn problems(self, n: usize) -> Vec<(usize, Option<usize>)> {
        match self {
            Self::OneVsOne => (0..n)
                .flat_map(|first| (first + 1..n).map(move |second| (first, Some(second))))
                .collect(),
            Self::OneVsRest => (0..n).map(|class| (class, None)).collect(),
        }
    }
}
