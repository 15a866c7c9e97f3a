//! How often limits of the model were reached.

use super::rows::ArrayOutcome;
use super::study::RecognitionStudy;
use crate::study::table::{Limit, Tables};

impl RecognitionStudy {
    /// Of touches on all arrays, and of fits.
    pub(super) fn limits(&self, tables: &Tables, arrays: &[ArrayOutcome]) -> Vec<Limit> {
        let sum = |count: fn(&ArrayOutcome) -> usize| -> u64 {
            arrays.iter().map(|array| count(array) as u64).sum()
        };
        let n_touches = sum(|a| a.n_touches);
        let fits = tables.accuracy.iter();
        let n_capped = fits.filter(|(_, score)| score.n_capped > 0).count();
        let limit = |what: &str, (count, of), meaning: &str| Limit {
            what: what.to_owned(),
            count,
            of,
            meaning: meaning.to_owned(),
        };
        let mut limits = vec![
            limit(
                "touches that met nothing",
                (sum(|a| a.n_missed), n_touches),
                match self.first().plan.spec.human_touch {
                    Some(_) => {
                        "the hand was beyond the array or between its taxels; their frames hold no contact"
                    }
                    None => {
                        "no part of the object was over the array; their frames hold no contact"
                    }
                },
            ),
            limit(
                "touches with a saturated taxel",
                (sum(|a| a.n_saturated), n_touches),
                "a taxel was at its stroke, where it cannot tell how much further the object pushes",
            ),
            limit(
                "fits stopped at the solver's iteration cap",
                (n_capped as u64, tables.accuracy.len() as u64),
                "at least one of their SVMs is short of its tolerance",
            ),
        ];
        let n_deep = sum(|a| a.n_deeper);
        if n_deep > 0 {
            limits.push(limit(
                "touches deeper than the stroke",
                (n_deep, n_touches),
                "the patch went on past the depth at which its first taxel was at its stroke: more taxels are saturated, the deeper the more",
            ));
        }
        limits
    }
}
