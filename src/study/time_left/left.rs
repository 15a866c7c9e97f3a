//! The time remaining of a run, by what was planned and what the finished part took.

use super::{Piece, Work};
use std::collections::BTreeMap;

/// Planned and spent processor-seconds of a run.
///
/// The plan only weighs work items against each other: what a planned second takes is measured, for each kind of work by its own
/// finished items, and for a kind of which less than one item is finished mostly by all of them.
#[derive(Clone, Debug)]
pub struct TimeLeft {
    n_threads: f64,
    kinds: BTreeMap<Work, Spent>,
}

/// Processor-seconds of a kind of work.
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
        let mut kinds: BTreeMap<Work, Spent> = BTreeMap::new();
        for piece in work {
            let spent = kinds.entry(piece.kind).or_default();
            spent.planned_s += piece.planned_s;
            spent.n_pieces += 1;
        }
        Self {
            n_threads: n_threads as f64,
            kinds,
        }
    }

    /// A work item is done, or a part of one, and took so long on its thread.
    pub fn worked(&mut self, piece: &Piece, took_s: f64) {
        let spent = self.kinds.entry(piece.kind).or_default();
        spent.done_s += piece.planned_s;
        spent.took_s += took_s;
    }

    /// Seconds left, if all threads are busy but for the report, which comes at the end on one.
    pub fn left_s(&self) -> f64 {
        let all = self.common_factor();
        let left_s = |(kind, spent): (&Work, &Spent)| {
            let threads = match kind {
                Work::Report => 1.0,
                _ => self.n_threads,
            };
            spent.left_s() * spent.factor(all) / threads
        };
        self.kinds.iter().map(left_s).sum()
    }

    /// What a planned second took so far; 1 before anything is finished.
    fn common_factor(&self) -> f64 {
        let done_s: f64 = self.kinds.values().map(|spent| spent.done_s).sum();
        let took_s: f64 = self.kinds.values().map(|spent| spent.took_s).sum();
        match done_s > 0.0 {
            true => took_s / done_s,
            false => 1.0,
        }
    }
}

impl Spent {
    fn left_s(&self) -> f64 {
        (self.planned_s - self.done_s).max(0.0)
    }

    /// What a planned second takes, where what all kinds took counts as much as one item of this kind.
    fn factor(&self, all: f64) -> f64 {
        let item_s = self.planned_s / self.n_pieces.max(1) as f64;
        match self.done_s + item_s {
            0.0 => all,
            sum_s => (self.took_s + item_s * all) / sum_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use crate::recognition::ClassifierKind;
    use rand::Rng;
    use rand_chacha::ChaCha8Rng;

    /// Pieces one after the other on threads, then a report; (elapsed, estimate) after each, and how long all takes.
    fn run(
        pieces: &[(Piece, f64)],
        n_threads: usize,
        (planned_s, report_s): (f64, f64),
    ) -> (Vec<[f64; 2]>, f64) {
        let mut work: Vec<Piece> = pieces.iter().map(|(piece, _)| *piece).collect();
        work.push(piece(Work::Report, planned_s));
        let mut left = TimeLeft::new(&work, n_threads);
        // When each thread is free, and what it does until then.
        let mut threads: Vec<(f64, Option<(Piece, f64)>)> = vec![(0.0, None); n_threads];
        let mut told = Vec::new();
        let mut next = pieces.iter();
        let mut now = 0.0;
        while let Some(thread) = threads
            .iter()
            .position(|t| {
                t.0 == threads
                    .iter()
                    .fold(f64::INFINITY, |least, t| least.min(t.0))
            })
            .filter(|&thread| threads[thread].0.is_finite())
        {
            now = threads[thread].0;
            if let Some((piece, took_s)) = threads[thread].1.take() {
                left.worked(&piece, took_s);
                told.push([now, left.left_s()]);
            }
            threads[thread] = match next.next() {
                Some(piece) => (now + piece.1, Some(*piece)),
                None => (f64::INFINITY, None),
            };
        }
        (told, now + report_s)
    }

    /// The largest relative error of the estimates after the first tenth; below 2 % of the run, seconds do not count.
    fn worst((told, total): &(Vec<[f64; 2]>, f64)) -> f64 {
        let after = told.iter().filter(|[elapsed, _]| *elapsed > 0.1 * total);
        let errors = after.map(|[elapsed, estimate]| {
            let true_left = total - elapsed;
            ((estimate - true_left).abs() - 0.02 * total).max(0.0) / true_left.max(0.02 * total)
        });
        errors.fold(0.0, f64::max)
    }

    fn piece(kind: Work, planned_s: f64) -> Piece {
        Piece { kind, planned_s }
    }

    /// Arrays one after the other, each with touches, and in each trial measuring and three classifiers with several m. What
    /// they take is what was planned, times a factor a kind, times one a cell (much the same on both arrays), times chance.
    fn study(
        rng: &mut ChaCha8Rng,
        n_trials: usize,
        factor: impl Fn(Work) -> f64,
    ) -> Vec<(Piece, f64)> {
        let mut chance = |spread: f64| rng.gen_range(-spread..spread).exp();
        let of_cell: Vec<f64> = (0..40).map(|_| chance(0.4)).collect();
        let mut pieces = Vec::new();
        for size in [1.0, 4.0] {
            let of_array = chance(0.15);
            let mut add = |kind: Work, place: usize, planned_s: f64| {
                let as_planned = of_cell[place] * of_array * chance(0.2);
                let took_s = planned_s * factor(kind) * as_planned;
                pieces.push((piece(kind, planned_s), took_s));
            };
            (0..40).for_each(|_| add(Work::Touch, 0, 0.02 * size));
            for _ in 0..n_trials {
                add(Work::Measure, 1, 0.3 * size);
                for (place, m) in [(2, 1.0), (3, 4.0), (4, 16.0)] {
                    add(
                        Work::Learn(ClassifierKind::LinearSvm),
                        place,
                        0.1 * m * size,
                    );
                    add(
                        Work::Learn(ClassifierKind::RbfSvm),
                        10 + place,
                        0.3 * m * size,
                    );
                    add(
                        Work::Learn(ClassifierKind::KNearest),
                        20 + place,
                        0.01 * m * size,
                    );
                }
            }
        }
        pieces
    }

    #[test]
    fn after_the_first_tenth_the_time_left_is_right_within_thirty_percent() {
        let mut rng = Seed::new(1).rng();
        // How wrong the plan is, by kind.
        let right = |_: Work| 1.0;
        let slow = |_: Work| 4.0;
        let mixed = |kind: Work| match kind {
            Work::Touch => 0.4,
            Work::Measure => 2.0,
            Work::Learn(ClassifierKind::LinearSvm) => 3.0,
            Work::Learn(_) => 0.5,
            Work::Stage(_) | Work::OneByOne(_) | Work::Report => 1.0,
        };
        let factors: [&dyn Fn(Work) -> f64; 3] = [&right, &slow, &mixed];
        for (number, factor) in factors.into_iter().enumerate() {
            for n_threads in [1, 2, 8] {
                let pieces = study(&mut rng, 10 + 10 * n_threads, factor);
                let worst = worst(&run(&pieces, n_threads, (1.0, 1.0)));
                assert!(
                    worst < 0.3,
                    "factors {number}, {n_threads} threads: {worst}"
                );
            }
        }
    }

    #[test]
    fn a_count_of_pieces_alone_would_be_wrong() {
        // What the estimate is for: the same run told by how many pieces are done.
        let mut rng = Seed::new(2).rng();
        let pieces = study(&mut rng, 20, |_| 1.0);
        let (told, total) = run(&pieces, 2, (1.0, 1.0));
        let n = told.len() as f64;
        let by_count = told
            .iter()
            .enumerate()
            .map(|(k, [elapsed, _])| [*elapsed, elapsed * (n - 1.0 - k as f64) / (k as f64 + 1.0)]);
        assert!(worst(&(by_count.collect(), total)) > 0.5);
    }

    #[test]
    fn before_anything_is_done_it_is_the_plan_shared_by_threads() {
        let work = [
            piece(Work::Touch, 4.0),
            piece(Work::Measure, 6.0),
            piece(Work::Report, 1.5),
        ];
        let left = TimeLeft::new(&work, 2);
        assert_eq!(left.left_s(), 6.5);
        assert_eq!(TimeLeft::new(&[], 2).left_s(), 0.0);
    }

    #[test]
    fn pieces_one_by_one_hold_all_threads_and_those_of_a_stage_one_each() {
        // Four seconds by the clock on all threads, then eight pieces of a second on two threads; twice as slow as planned.
        let shared = Piece::one_by_one(0, 2.0);
        let n_threads = rayon::current_num_threads();
        let alone = Piece::of_stage(1, 0.5);
        let work = [vec![shared], vec![alone; 4 * n_threads]].concat();
        let mut left = TimeLeft::new(&work, n_threads);
        assert!((left.left_s() - 4.0).abs() < 1e-12);
        left.worked(&shared, shared.spent_s(4.0));
        // What is under way is half a piece of the stage before, at most half of what is left.
        assert!((left.left_s() - 4.0).abs() < 1.5, "{}", left.left_s());
        for done in 1..=4 {
            (0..n_threads).for_each(|_| left.worked(&alone, alone.spent_s(1.0)));
            let true_left = 4.0 - done as f64;
            let told = left.left_s();
            assert!(
                (told - true_left).abs() <= 0.3 * true_left + 1e-9,
                "{told} of {true_left}"
            );
        }
    }

    #[test]
    fn an_item_that_has_hardly_begun_does_not_speak_for_its_kind() {
        let work = [
            piece(Work::Touch, 1.0),
            piece(Work::Learn(ClassifierKind::LinearSvm), 10.0),
            piece(Work::Learn(ClassifierKind::RbfSvm), 10.0),
        ];
        let mut left = TimeLeft::new(&work, 1);
        left.worked(&work[0], 1.0);
        assert_eq!(left.left_s(), 20.0);
        left.worked(&piece(Work::Learn(ClassifierKind::LinearSvm), 1e-3), 0.3);
        let after_s = left.left_s();
        assert!((20.0..27.0).contains(&after_s), "{after_s}");
    }

    #[test]
    fn a_kind_of_which_nothing_is_finished_takes_as_much_longer_as_the_others() {
        let work = [
            piece(Work::Touch, 1.0),
            piece(Work::Learn(ClassifierKind::LinearSvm), 10.0),
        ];
        let mut left = TimeLeft::new(&work, 2);
        left.worked(&work[0], 4.0);
        assert_eq!(left.left_s(), 20.0);
    }

    #[test]
    fn nothing_is_left_at_the_end_but_the_report() {
        let work = [piece(Work::Touch, 4.0), piece(Work::Report, 1.5)];
        let mut left = TimeLeft::new(&work, 1);
        left.worked(&work[0], 4.0);
        assert_eq!(left.left_s(), 1.5);
        left.worked(&work[1], 1.0);
        assert_eq!(left.left_s(), 0.0);
    }
}
