//! Training of a family of configurations on common features, with one classifier for each C.

use crate::learning::classifiers::classifier::{Classifier, Cost};
use crate::learning::classifiers::trained_classifier::TrainedClassifier;
use crate::learning::data::split::{group_k_fold, stratified_k_fold};
use crate::studies::prelude::*;
use crate::studies::recognition::training::TrainingInputs;
use bubbletouch_svm::cross_validation::choice::Candidates;
use bubbletouch_svm::dataset::{Dataset, rows};
use bubbletouch_svm::kernel::Gamma;
use ndarray::{Array1, ArrayView1, Axis, s};
use std::collections::HashMap;
use std::time::Instant;

/// Training rows of a family of configurations in one trial, and the parameters of the training.
pub struct Training<'a> {
    /// Classifier, and the candidate values from which its C and γ are selected.
    pub inputs: &'a TrainingInputs,
    /// Training rows in drawing order with alternating objects: first readings, then further readings, then tilted copies.
    pub data: Dataset,
    /// Number of training rows that are first readings of touches; C and γ are chosen on these rows only.
    pub n_first: usize,
    /// Group of each training row; `None` if the split may divide groups.
    pub group_keys: Option<Array1<usize>>,
    /// Seed of the random numbers with which the inner cross-validation folds are drawn.
    pub seed: Seed,
}

/// Trained classifier and its parameters.
pub struct Fitted {
    /// Trained classifier, including the scaling of its features.
    pub classifier: TrainedClassifier,
    /// Penalty C with which the classifier was trained; `None` if the classifier has no C.
    pub c: Option<f64>,
    /// Kernel parameter γ with which the classifier was trained; `None` if the classifier has no γ.
    pub gamma: Option<f64>,
    /// Time to choose C and γ and to train the classifier, s.
    pub fit_s: f64,
}

impl Training<'_> {
    /// Trains one classifier for each penalty C, in order. A penalty of `None` means that C is chosen by cross-validation, or that the classifier has no C.
    ///
    /// # Errors
    /// If a fold cannot be drawn or the training fails.
    pub(crate) fn train_all(&self, penalties: &[Option<f64>]) -> Result<Vec<Fitted>> {
        let given: Option<Vec<f64>> = penalties.iter().copied().collect();
        match given {
            Some(path) if !self.chooses_gamma() => self.train_path(&path),
            _ => penalties.iter().map(|&c| self.train(c)).collect(),
        }
    }

    fn chooses_gamma(&self) -> bool {
        self.inputs.gamma_grid.is_some()
    }

    /// Trains one classifier for each given value of C. Common computations are done once, and their time is divided equally among the classifiers.
    fn train_path(&self, path: &[f64]) -> Result<Vec<Fitted>> {
        let start = Instant::now();
        let classifier = &self.inputs.classifier;
        let trained = classifier.train_path(&self.data, path, &self.seed)?;
        let gamma = self.gamma()?;
        let fit_s = start.elapsed().as_secs_f64() / path.len() as f64;
        let fitted = trained.into_iter().map(|classifier| Fitted {
            c: classifier.c(),
            classifier,
            gamma,
            fit_s,
        });
        Ok(fitted.collect())
    }

    /// Trains one classifier with a given C, with a C selected by cross-validation, or without C. The kernel parameter γ is also given or chosen.
    fn train(&self, c: Option<f64>) -> Result<Fitted> {
        let start = Instant::now();
        let classifier = &self.inputs.classifier;
        let kind = classifier.kind;
        let (classifier, gamma) = if kind.has_c() {
            let given = c.map(|c| vec![c]).or(self.inputs.c_grid.clone());
            let candidates = Candidates {
                c: given.unwrap_or_default(),
                gamma_scales: self.inputs.gamma_grid.clone().unwrap_or_default(),
            };
            let (c, classifier) = self.choose(classifier.clone(), &candidates)?;
            let mut trained = classifier.train_path(&self.data, &[c], &self.seed)?;
            let gamma = number(classifier.gamma()).filter(|_| kind.has_gamma());
            (trained.swap_remove(0), gamma)
        } else {
            let all: Vec<usize> = (0..self.data.targets.len()).collect();
            let classifier = self.with_groups(classifier, &all);
            (classifier.train(&self.data, &self.seed)?, None)
        };
        Ok(Fitted {
            c: classifier.c(),
            classifier,
            gamma,
            fit_s: start.elapsed().as_secs_f64(),
        })
    }

    /// Selects the best C and γ among the candidates by cross-validation; returns C, and the classifier with γ. A single candidate gives the same result as a
    /// given value.
    fn choose(&self, classifier: Classifier, candidates: &Candidates) -> Result<(f64, Classifier)> {
        let unit = self.gamma()?;
        let scaled_by = |scale: f64| match unit {
            Some(unit) => classifier.with_gamma(Gamma::Value(scale * unit)),
            None => classifier.clone(),
        };
        if let ([c], [] | [_]) = (&candidates.c[..], &candidates.gamma_scales[..]) {
            let scale = candidates.gamma_scales.first().copied().unwrap_or(1.0);
            return Ok((*c, scaled_by(scale)));
        }
        let classifier = scaled_by(1.0);
        let first = self.data.targets.slice(s![..self.n_first]);
        let chosen_on = self.inputs.choosing_rows(first);
        let folds = self.folds(&chosen_on)?;
        let data = rows(&self.data, &chosen_on)?;
        let chosen = classifier.choose(&data, &folds, candidates, &self.seed)?;
        Ok((chosen.best.c, classifier.with_choice(&chosen)))
    }

    /// Returns a predicted label for each training touch, by a classifier that is trained without the fold of the touch. All classifiers have the parameters of
    /// the fitted classifier `like`.
    ///
    /// # Errors
    /// If a fold cannot be drawn or the training fails.
    pub(crate) fn held_out_answers(&self, like: &Fitted) -> Result<Vec<usize>> {
        let n_first = self.n_first;
        let usual = &self.inputs.classifier;
        let usual = match like.gamma {
            Some(gamma) => usual.with_gamma(Gamma::Value(gamma)),
            None => usual.clone(),
        };
        let classifier = Classifier {
            c: like.c.map_or(usual.c.clone(), Cost::Fixed),
            ..usual
        };
        let mut answers = vec![0; n_first];
        let first: Vec<usize> = (0..n_first).collect();
        for fold in self.folds(&first)? {
            // Further readings and copies repeat the order of the first readings.
            let starts = (0..self.data.targets.len()).step_by(n_first);
            let learned = starts.flat_map(|start| fold.train.iter().map(move |row| start + row));
            let places: Vec<usize> = learned.collect();
            let learned = rows(&self.data, &places)?;
            let trained = self.with_groups(&classifier, &places);
            let trained = trained.train(&learned, &self.seed)?;
            let held_out = self.data.records.select(Axis(0), &fold.test);
            for (&row, label) in fold.test.iter().zip(trained.labels(held_out.view())?) {
                answers[row] = label;
            }
        }
        Ok(answers)
    }

    /// Returns the classifier with the groups of the given training rows.
    fn with_groups(&self, classifier: &Classifier, rows: &[usize]) -> Classifier {
        // Further readings and copies repeat the order of the first readings.
        let keys = self.group_keys.as_ref();
        let groups = keys.map(|keys| rows.iter().map(|row| keys[row % self.n_first]).collect());
        Classifier {
            groups,
            ..classifier.clone()
        }
    }

    /// Returns the kernel parameter γ, given or computed from the training rows; `None` if the classifier has no γ.
    fn gamma(&self) -> Result<Option<f64>> {
        let classifier = &self.inputs.classifier;
        let kernel = classifier.kind.about().kernel;
        let kernel = kernel.filter(|_| classifier.kind.has_gamma());
        let Some(kernel) = kernel.map(|kernel| kernel(&classifier.parameters)) else {
            return Ok(None);
        };
        let records = self.data.records.view();
        let scaled = classifier.scaling.fit(records)?.apply(records)?;
        let scale = || kernel.gamma_scale(scaled.view());
        Ok(Some(number(classifier.gamma()).unwrap_or_else(scale)))
    }

    fn folds(&self, rows: &[usize]) -> Result<Vec<Split>> {
        let (labels, keys) = (&self.data.targets, self.group_keys.as_ref());
        self.inputs.folds((labels, keys), rows, &self.seed)
    }
}

impl TrainingInputs {
    /// Returns the training rows that are used to choose C and γ, given the labels of the first readings: a maximum number per object. With further readings, a
    /// fold could train on another reading of a held-out touch.
    pub(crate) fn choosing_rows(&self, first: ArrayView1<usize>) -> Vec<usize> {
        let most = self.cv_touches.unwrap_or(usize::MAX);
        let mut n_chosen: HashMap<usize, usize> = HashMap::new();
        let takes_part = |row: &usize| {
            let n_chosen = n_chosen.entry(first[*row]).or_default();
            *n_chosen += 1;
            *n_chosen <= most
        };
        (0..first.len()).filter(takes_part).collect()
    }

    /// Returns the folds of the inner cross-validation as positions in `rows`, given the labels of all training rows and the groups of the first readings. The
    /// folds do not divide groups.
    ///
    /// # Errors
    /// If an object has too few rows or groups for the folds.
    pub(crate) fn folds(
        &self,
        (labels, keys): (&Array1<usize>, Option<&Array1<usize>>),
        rows: &[usize],
        seed: &Seed,
    ) -> Result<Vec<Split>> {
        let labels = labels.select(Axis(0), rows);
        let k = self.n_folds.expect("folds of a choice");
        let folds = match keys {
            None => stratified_k_fold(labels.view(), k, seed),
            Some(keys) => {
                let keys = keys.select(Axis(0), rows);
                group_k_fold(labels.view(), keys.view(), k, seed)
            }
        };
        folds.map_err(|error| Error::from(error).under("key recognition.cv_folds: "))
    }
}

/// Returns the kernel parameter γ as a number; `None` if γ is derived from the data or the kernel has no γ.
fn number(gamma: Gamma) -> Option<f64> {
    match gamma {
        Gamma::Value(gamma) => Some(gamma),
        Gamma::Scale => None,
    }
}
