//! Numbers of touches and trained classifiers that reached a limit of the simulation or of the solver.

use crate::report::csv_tables::{CAPPED_FITS, MISSED_TOUCHES};
use crate::studies::recognition::rows::{Configuration, Limit, TrialScore};
use crate::studies::recognition::study::{RecognitionStudy, TouchRow};
use std::collections::HashSet;

impl RecognitionStudy {
    /// Returns how often touches reached a limit of the simulation, and how often training reached a limit of the solver, over all arrays and all values of
    /// `[axes]`.
    pub(crate) fn limits(
        &self,
        scores: &[(Configuration, TrialScore)],
        rows: &[TouchRow],
    ) -> Vec<Limit> {
        // The deepest frame is equal for any number of frames per touch.
        let is_first = |&touches: &usize| {
            let set = &self.touch_sets[touches];
            set.n_frames == self.parts()[set.part].plan.frames[0]
        };
        let is_counted = |row: &&TouchRow| row.is_made && is_first(&row.on);
        let made: Vec<&TouchRow> = rows.iter().filter(is_counted).collect();
        let sum = |count: fn(&TouchRow) -> usize| made.iter().map(|row| count(row)).sum();
        let n_touches = sum(|row| row.n_touches);
        let deeper = made.iter().map(|row| {
            let (touched, array, _) = self.on(row.on);
            touched.n_deeper_than(array.taxel().stroke)
        });
        let n_deeper: usize = deeper.sum();
        let fits = self.capped_fits(scores);
        let spec = &self.first().plan.spec;
        let missed = match (&spec.human_touch, &spec.recorded) {
            (Some(_), _) => {
                "the hand was beyond the array or between its taxels; their frames hold no contact"
            }
            (_, Some(_)) => "no taxel reads more than recorded.zero",
            _ => "no part of the object was over the array; their frames hold no contact",
        };
        let limit = |what: &str, (count, total): (usize, usize), meaning: &str| Limit {
            limit: what.to_owned(),
            count: count as u64,
            total: total as u64,
            meaning: meaning.to_owned(),
        };
        let mut limits = vec![
            limit(MISSED_TOUCHES, (sum(|row| row.n_missed), n_touches), missed),
            limit(
                "touches with a saturated taxel",
                (sum(|row| row.n_saturated), n_touches),
                match &spec.recorded {
                    None => {
                        "a taxel was at its stroke, where it cannot tell how much further the object pushes"
                    }
                    Some(_) => {
                        "a taxel read its full scale, or a largest reading that many frames share: it cannot tell how much further the object pushes"
                    }
                },
            ),
            limit(
                CAPPED_FITS,
                fits,
                "at least one of their SVMs is short of its tolerance",
            ),
            limit(
                "touches deeper than the stroke",
                (n_deeper, n_touches),
                "the patch went on past the depth at which its first taxel was at its stroke: more taxels are saturated, the deeper the more",
            ),
        ];
        if n_deeper == 0 {
            limits.pop();
        }
        let sets = (0..self.touch_sets.len()).filter(is_first);
        let masked = sets.map(|touches| self.on(touches).0.n_masked());
        let n_masked = masked.fold((0, 0), |sum, of| (sum.0 + of.0, sum.1 + of.1));
        if n_masked.0 > 0 {
            let meaning = "they are missing (NaN) in at least 10 % of the frames, or read one number other than recorded.zero in all; they are taken as absent";
            limits.push(limit("taxels that are masked", n_masked, meaning));
        }
        limits
    }

    /// Returns the number of fits in which a solver stopped at its iteration cap, and the number of all fits by solvers that have a cap. Configurations that
    /// differ only in their decisions share a fit.
    fn capped_fits(&self, scores: &[(Configuration, TrialScore)]) -> (usize, usize) {
        let families = (0..self.families.len()).map(|family| self.family(family).1);
        let fits = families.flat_map(|family| family.chunk_by(|a, b| a.c == b.c));
        let capped = fits.filter(|fit| fit[0].classifier.has_c());
        let numbers: HashSet<usize> = capped.map(|fit| fit[0].configuration).collect();
        let scores = scores.iter();
        let fits =
            scores.filter(|(configuration, _)| numbers.contains(&configuration.configuration));
        let n_capped = fits.clone().filter(|(_, score)| score.n_capped > 0);
        (n_capped.count(), fits.count())
    }
}
