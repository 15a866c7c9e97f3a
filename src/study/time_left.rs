//! The time remaining of a run: work items are weighed by those that finished.

use std::collections::BTreeMap;

/// A work item, or what several need first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Which kind of work: the plan of each kind may be wrong by a factor of its own.
    stage: u8,
    /// Threads that it has.
    n_threads: usize,
    /// What it was planned to take, processor-seconds: only how those of a stage compare counts once some of them are finished.
    pub planned_s: f64,
}

impl Piece {
    /// Of a stage whose pieces have a thread each.
    pub fn of_stage(stage: u8, planned_s: f64) -> Self {
        Self {
            stage,
            n_threads: 1,
            planned_s,
        }
    }

    /// Of a stage whose pieces come one after the other, each with all threads: seconds by the clock.
    pub fn one_by_one(stage: u8, planned_wall_s: f64) -> Self {
        let n_threads = rayon::current_num_threads();
        Self {
            stage,
            n_threads,
            planned_s: planned_wall_s * n_threads as f64,
        }
    }

    /// Processor-seconds that so much time by the clock is.
    pub fn spent_s(&self, wall_s: f64) -> f64 {
        wall_s * self.n_threads as f64
    }
}

/// Planned and spent processor-seconds of a run.
#[derive(Clone, Debug)]
pub struct TimeLeft {
    n_threads: f64,
    stages: BTreeMap<(u8, usize), Spent>,
}

/// Processor-seconds of a stage.
#[derive(Clone, Copy, Debug, Default)]
struct Spent {
    n_pieces: usize,
    planned_s: f64,
    /// Of the finished part: by plan, and as measured.
    done_s: f64,
    took_s: f64,
}

impl TimeLeft {
    /// Of a run with this work.
    pub fn new(work: &[Piece], n_threads: usize) -> Self {
        let mut left = Self {
            n_threads: n_threads as f64,
            stages: BTreeMap::new(),
        };
        for piece in work {
            let spent = left.stage(piece);
            spent.planned_s += piece.planned_s;
            spent.n_pieces += 1;
        }
        left
    }

    /// A work item is done and took so long, processor-seconds.
    pub fn worked(&mut self, piece: &Piece, took_s: f64) {
        let spent = self.stage(piece);
        spent.done_s += piece.planned_s;
        spent.took_s += took_s;
    }

    /// Seconds left, if all threads are busy.
    pub fn left_s(&self) -> f64 {
        let sum = |of: fn(&Spent) -> f64| self.stages.values().map(of).sum::<f64>();
        let (done_s, took_s) = (sum(|spent| spent.done_s), sum(|spent| spent.took_s));
        let all = if done_s > 0.0 { took_s / done_s } else { 1.0 };
        let left_s = self.stages.values().map(|spent| spent.left_s(all));
        left_s.sum::<f64>() / self.n_threads
    }

    fn stage(&mut self, piece: &Piece) -> &mut Spent {
        let stage = (piece.stage, piece.n_threads);
        self.stages.entry(stage).or_default()
    }
}

impl Spent {
    /// By what a planned second of the stage took, where what one took in all stages counts as much as one piece.
    fn left_s(&self, all: f64) -> f64 {
        let item_s = self.planned_s / self.n_pieces.max(1) as f64;
        let factor = match self.done_s + item_s {
            0.0 => all,
            sum_s => (self.took_s + item_s * all) / sum_s,
        };
        (self.planned_s - self.done_s).max(0.0) * factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn after_the_first_tenth_the_time_left_is_right_within_thirty_percent() {
        let mut rng = Seed::new(1).rng();
        // How wrong the plan of each stage is.
        for factors in [[1.0, 1.0, 1.0], [4.0, 4.0, 4.0], [0.4, 2.0, 3.0]] {
            let mut work = Vec::new();
            for number in 0..300 {
                let stage = number % 3;
                let planned_s = [0.1, 0.3, 1.0][stage] * rng.gen_range(0.5..2.0);
                let took_s = planned_s * factors[stage] * rng.gen_range(0.7..1.4);
                work.push((Piece::of_stage(stage as u8, planned_s), took_s));
            }
            let pieces: Vec<Piece> = work.iter().map(|(piece, _)| *piece).collect();
            let total_s: f64 = work.iter().map(|(_, took_s)| took_s).sum();
            let (mut left, mut elapsed_s) = (TimeLeft::new(&pieces, 4), 0.0);
            for (piece, took_s) in &work {
                left.worked(piece, *took_s);
                elapsed_s += took_s;
                let truth_s = (total_s - elapsed_s) / 4.0;
                let error_s = (left.left_s() - truth_s).abs();
                let is_late = elapsed_s > 0.1 * total_s;
                assert!(
                    !is_late || error_s < 0.3 * truth_s + 0.005 * total_s,
                    "{factors:?}: {error_s} of {truth_s} s after {elapsed_s} of {total_s}"
                );
            }
            assert!(left.left_s() < 1e-9);
        }
    }

    #[test]
    fn before_anything_is_done_it_is_the_plan_shared_by_threads() {
        let work = [Piece::of_stage(0, 4.0), Piece::of_stage(1, 6.0)];
        assert_eq!(TimeLeft::new(&work, 2).left_s(), 5.0);
        assert_eq!(TimeLeft::new(&[], 2).left_s(), 0.0);
        let n_threads = rayon::current_num_threads();
        let alone = TimeLeft::new(&[Piece::one_by_one(0, 2.0)], n_threads);
        assert!((alone.left_s() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_stage_of_which_nothing_is_finished_takes_as_much_longer_as_the_others() {
        let work = [Piece::of_stage(0, 1.0), Piece::of_stage(1, 10.0)];
        let mut left = TimeLeft::new(&work, 2);
        left.worked(&work[0], 4.0);
        assert_eq!(left.left_s(), 20.0);
    }
}
