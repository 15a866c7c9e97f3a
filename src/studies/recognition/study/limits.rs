//! Numbers of touches and trained classifiers that reached a limit of the simulation or of the solver.

use crate::report::csv_tables::MISSED_TOUCHES;
use crate::studies::recognition::rows::configuration::Configuration;
use crate::studies::recognition::rows::table_rows::{Limit, TrialScore};
use crate::studies::recognition::study::recognition_study::RecognitionStudy;
use crate::studies::recognition::study::rows::TouchRow;

impl RecognitionStudy {
    /// Returns how often touches reached a limit of the simulation, and how often training reached a limit of the solver, over all arrays.
    pub(crate) fn limits(
        &self,
        fits: &[(Configuration, TrialScore)],
        rows: &[TouchRow],
    ) -> Vec<Limit> {
        // The deepest frame is equal for any number of frames per touch.
        let is_counted = |row: &&TouchRow| {
            let (_, _, n_frames) = self.on(row.on);
            row.is_made && n_frames == self.first_frames(row.on)
        };
        let made: Vec<&TouchRow> = rows.iter().filter(is_counted).collect();
        let sum = |count: fn(&TouchRow) -> usize| made.iter().map(|row| count(row)).sum();
        let n_touches = sum(|row| row.n_touches);
        let deeper = made.iter().map(|row| {
            let (touched, array, _) = self.on(row.on);
            touched.n_deeper_than(array.taxel().stroke)
        });
        let n_deeper: usize = deeper.sum();
        let n_capped = fits.iter().filter(|(_, score)| score.n_capped > 0).count();
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
                "fits stopped at the solver's iteration cap",
                (n_capped, fits.len()),
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
        let n_masked = self.first().touched.n_masked();
        if n_masked.0 > 0 {
            let meaning = "they are missing (NaN) in at least 10 % of the frames, or read one number other than recorded.zero in all; they are taken as absent";
            limits.push(limit("taxels that are masked", n_masked, meaning));
        }
        limits
    }
}
