//! The choice of C on a validation split of the training rows; the test rows are never seen.

use ndarray::Array1;

use crate::recognition::dataset::{Dataset, rows};
use crate::recognition::metrics::ConfusionMatrix;
use crate::recognition::scaling::Scaling;
use crate::recognition::split::Split;
use crate::recognition::svm::SvmParams;
use crate::{Error, Result};

/// A chosen C and what it was chosen from.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenC {
    /// The chosen C.
    pub c: f64,
    /// Every candidate, ascending, with its accuracy on the validation rows.
    pub accuracies: Vec<(f64, f64)>,
}

/// Tries every candidate C and keeps the most accurate on the validation rows; the smaller C on a tie (more
/// regularised, and faster).
///
/// `training` holds training rows alone, and `validation` splits those. The scaling is fitted on the validation
/// split's training rows, so validation rows are as unseen as test rows will be. A duplicated candidate counts once.
///
/// # Errors
/// No candidates, a candidate out of range, a row beyond the training rows, or what training refuses.
pub fn choose_c(
    params: &SvmParams,
    scaling: Scaling,
    training: &Dataset,
    validation: &Split,
    candidates: &[f64],
) -> Result<ChosenC> {
    choose_c_by(
        |fitting, held_out, c| {
            let model = SvmParams { c, ..*params }.train(fitting)?;
            model.labels(held_out.records.view())
        },
        scaling,
        training,
        validation,
        candidates,
    )
}

/// [`choose_c`] for any classifier: `predict` trains on its first argument with this C and labels the rows of its second.
pub(crate) fn choose_c_by(
    predict: impl Fn(&Dataset, &Dataset, f64) -> Result<Array1<usize>>,
    scaling: Scaling,
    training: &Dataset,
    validation: &Split,
    candidates: &[f64],
) -> Result<ChosenC> {
    let mut candidates = candidates.to_vec();
    candidates.sort_by(f64::total_cmp);
    candidates.dedup();
    if candidates.is_empty() {
        return Err(Error::input("C", "no candidates", "at least one is needed"));
    }
    let mut fitting = rows(training, &validation.train)?;
    let mut held_out = rows(training, &validation.test)?;
    let scaling = scaling.fit(fitting.records.view())?;
    fitting.records = scaling.apply(fitting.records.view())?;
    held_out.records = scaling.apply(held_out.records.view())?;
    let n_classes = training.targets.iter().max().map_or(0, |max| max + 1);
    let accuracies = candidates
        .into_iter()
        .map(|c| {
            let predicted = predict(&fitting, &held_out, c)?;
            let truth = held_out.targets.view();
            let confusion = ConfusionMatrix::new(truth, predicted.view(), n_classes)?;
            Ok((c, confusion.accuracy()))
        })
        .collect::<Result<Vec<_>>>()?;
    let best = accuracies.iter().fold(
        accuracies[0],
        |best, &tried| if tried.1 > best.1 { tried } else { best },
    );
    Ok(ChosenC {
        c: best.0,
        accuracies,
    })
}
