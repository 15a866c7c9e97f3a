//! Training of a family of cells: the same rows and features, one fit for each C.

use super::spec::RecognitionSpec;
use crate::error::Result;
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::classifier::{Classifier, Cost, TrainedClassifier};
use crate::recognition::dataset::{Dataset, rows};
use crate::recognition::kernel::Gamma;
use crate::recognition::split::{Split, group_k_fold, stratified_k_fold};
use ndarray::{Array1, s};
use std::time::Instant;

/// Folds of the cross-validation that chooses C and γ, when a study does not say.
pub const DEFAULT_FOLDS: usize = 5;

/// How C and γ are chosen by cross-validation within the training rows.
#[derive(Clone, Debug, PartialEq)]
pub struct ChoicePlan {
    /// Values of C to try; none when C is given.
    pub c: Vec<f64>,
    /// Values of γ to try, as multiples of 'scale'; none when γ is given.
    pub gamma_multiples: Vec<f64>,
    /// Folds.
    pub folds: usize,
    /// Training touches an object that take part, at most; `None` is all of them.
    pub touches: Option<usize>,
}

/// Whether a classifier has a soft-margin penalty C.
pub fn has_c(kind: ClassifierKind) -> bool {
    use ClassifierKind::{LinearSvm, PolynomialSvm, RbfSvm};
    matches!(kind, LinearSvm | RbfSvm | PolynomialSvm)
}

/// Whether a classifier has a kernel with a γ.
pub fn has_gamma(kind: ClassifierKind) -> bool {
    matches!(kind, ClassifierKind::RbfSvm | ClassifierKind::PolynomialSvm)
}

/// The training rows of a family in one trial, and what they are trained with.
pub struct Training<'a> {
    /// The study's keys.
    pub recognition: &'a RecognitionSpec,
    /// How what is left open is chosen.
    pub choice: &'a ChoicePlan,
    /// Which classifier.
    pub kind: ClassifierKind,
    /// Training rows in drawing order, one of each object in turn.
    pub data: Dataset,
    /// The group of each row, when the study keeps groups together.
    pub group_keys: Option<Array1<usize>>,
    /// What the folds of a choice are drawn from.
    pub seed: Seed,
}

/// A trained classifier and what it was trained with.
pub struct Fitted {
    /// The classifier, with its scaling.
    pub classifier: TrainedClassifier,
    /// C, of a classifier that has one.
    pub c: Option<f64>,
    /// γ, of a classifier that has one.
    pub gamma: Option<f64>,
    /// Seconds to choose and to train.
    pub fit_s: f64,
}

/// A C and a γ that can be trained with; `None` where the classifier has none.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parameters {
    c: Option<f64>,
    gamma: Option<f64>,
}

impl Training<'_> {
    /// One classifier for each C (`None`: chosen, or a classifier that has none), in their order.
    ///
    /// # Errors
    /// What a fold or a training refuses.
    pub fn train_all(&self, penalties: &[Option<f64>]) -> Result<Vec<Fitted>> {
        penalties.iter().map(|&c| self.train(c)).collect()
    }

    fn train(&self, c: Option<f64>) -> Result<Fitted> {
        let start = Instant::now();
        let chosen = self.choose(self.candidates(c)?)?;
        let classifier = self.fit(chosen, &self.data)?;
        Ok(Fitted {
            classifier,
            c: chosen.c,
            gamma: chosen.gamma,
            fit_s: start.elapsed().as_secs_f64(),
        })
    }

    /// Every C with every γ that the study leaves to be chosen, the smaller first, C before γ.
    fn candidates(&self, c: Option<f64>) -> Result<Vec<Parameters>> {
        let ascending = |values: &[f64]| {
            let mut values = values.to_vec();
            values.sort_by(f64::total_cmp);
            values.into_iter().map(Some).collect::<Vec<_>>()
        };
        let penalties = match (has_c(self.kind), c) {
            (false, _) => vec![None],
            (true, Some(c)) => vec![Some(c)],
            (true, None) => ascending(&self.choice.c),
        };
        let gammas = match (has_gamma(self.kind), self.recognition.gamma) {
            (false, _) => vec![None],
            (true, Some(gamma)) => vec![Some(gamma)],
            (true, None) => {
                let scale = self.gamma_scale()?;
                let multiples: Vec<f64> = match &self.choice.gamma_multiples[..] {
                    [] => vec![1.0],
                    multiples => multiples.to_vec(),
                };
                let gammas: Vec<f64> = multiples.iter().map(|times| times * scale).collect();
                ascending(&gammas)
            }
        };
        let with_gammas =
            |&c: &Option<f64>| gammas.iter().map(move |&gamma| Parameters { c, gamma });
        Ok(penalties.iter().flat_map(with_gammas).collect())
    }

    /// γ 'scale' of all training rows: 1 / (columns · variance) once they are scaled, or 1 where that variance is 0.
    fn gamma_scale(&self) -> Result<f64> {
        let records = self.data.records.view();
        let scaled = self.recognition.scaling.fit(records)?.apply(records)?;
        let scale = scaled.ncols() as f64 * scaled.var(0.0);
        Ok(if scale > 0.0 { 1.0 / scale } else { 1.0 })
    }

    /// The candidate with the most rows recognised over all folds, the first of equals: the more regularised.
    fn choose(&self, candidates: Vec<Parameters>) -> Result<Parameters> {
        if let [only] = candidates[..] {
            return Ok(only);
        }
        let data = self.choosing_rows();
        let folds: Vec<(Dataset, Dataset)> = self
            .folds(&data)?
            .iter()
            .map(|fold| Ok((rows(&data, &fold.train)?, rows(&data, &fold.test)?)))
            .collect::<Result<_>>()?;
        let mut best = (candidates[0], None);
        for candidate in candidates {
            let mut n_correct = 0;
            for (fitting, held_out) in &folds {
                let predicted = self
                    .fit(candidate, fitting)?
                    .labels(held_out.records.view())?;
                let pairs = predicted.iter().zip(&held_out.targets);
                n_correct += pairs.filter(|(label, truth)| label == truth).count();
            }
            if best.1.is_none_or(|most| n_correct > most) {
                best = (candidate, Some(n_correct));
            }
        }
        Ok(best.0)
    }

    /// The leading training rows, as many of each object as take part in a choice.
    fn choosing_rows(&self) -> Dataset {
        let labels = &self.data.targets;
        let n_objects = labels.iter().max().map_or(0, |last| last + 1);
        let wanted = self.choice.touches.map_or(usize::MAX, |touches| {
            // Rows come one of each object in turn, so these hold as many of each.
            touches.saturating_mul(n_objects)
        });
        let n_rows = wanted.min(labels.len());
        Dataset::new(
            self.data.records.slice(s![..n_rows, ..]).to_owned(),
            labels.slice(s![..n_rows]).to_owned(),
        )
    }

    /// What stays together in the study's split stays together here.
    fn folds(&self, data: &Dataset) -> Result<Vec<Split>> {
        let labels = data.targets.view();
        let k = self.choice.folds;
        match &self.group_keys {
            None => stratified_k_fold(labels, k, &self.seed),
            Some(keys) => group_k_fold(labels, keys.slice(s![..labels.len()]), k, &self.seed),
        }
    }

    fn fit(&self, parameters: Parameters, data: &Dataset) -> Result<TrainedClassifier> {
        let recognition = self.recognition;
        let defaults = Classifier::new(self.kind);
        let classifier = Classifier {
            scaling: recognition.scaling,
            multiclass: recognition.multiclass,
            c: parameters.c.map_or(defaults.c.clone(), Cost::Fixed),
            gamma: parameters.gamma.map_or(Gamma::Scale, Gamma::Value),
            coef0: recognition.coef0,
            degree: recognition.degree,
            ..defaults
        };
        classifier.train(data, &self.seed)
    }
}
