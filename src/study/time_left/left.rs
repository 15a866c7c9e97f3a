//! What is left of a run, by what was planned and spent.

use super::spent::{Mean, Spent};
use super::{Piece, Work};
use std::collections::BTreeMap;

/// Planned and spent processor-seconds of a run.
///
/// What is left of a place costs as much more or less than planned as what was done for it; where little was done, as the
/// geometric mean of the places of its kind whose pieces were planned to take about as long (a plan is wrong in much the same way for
/// much the same work), and where little was done of these, of all places of its kind. Each place counts the same however much is done
/// there: a few large pieces that were planned badly do not speak for all. A kind that has hardly begun, and the report, costs as the
/// middle one of all kinds so far and of one that costs as planned. Threads are as busy as they have been.
#[derive(Clone, Debug)]
pub struct TimeLeft {
    n_threads: f64,
    kinds: BTreeMap<Work, Spent>,
    places: BTreeMap<(Work, usize), Spent>,
    /// Of pieces that are told of when they end: sum of what they took times how long that was by the clock, and of what they took.
    alone: [f64; 2],
}

/// Share of a run's work for which all threads count as busy before it began.
const BUSY_BEFORE: f64 = 0.02;
/// Processor-seconds after which what was told speaks for what is still unknown as much as the plan does: what a run does first is slow
/// because memory is new and caches are cold.
const SETTING_UP_S: f64 = 1.0;
/// Places that what is known without them counts as much as: in the factor of a kind that of all kinds, in the factor of pieces of a size
/// that of their kind.
const PRIOR_PLACES: f64 = 0.5;
/// Half octaves that sizes of pieces are apart whose plans are wrong in much the same way: a standard deviation.
const ALIKE_SIZES: f64 = 2.0;

impl TimeLeft {
    /// Of a run with this work.
    pub fn new(work: &[Piece], n_threads: usize) -> Self {
        let mut left = Self {
            n_threads: n_threads as f64,
            kinds: BTreeMap::new(),
            places: BTreeMap::new(),
            alone: [0.0; 2],
        };
        for piece in work {
            for spent in left.spent(piece) {
                spent.planned_s += piece.planned_s;
                spent.n_pieces += 1;
            }
        }
        left
    }

    /// A piece of work is done, or a part of one, and took so long on its thread.
    pub fn worked(&mut self, piece: &Piece, took_s: f64) {
        for spent in self.spent(piece) {
            spent.done_s += piece.planned_s;
            spent.took_s += took_s;
        }
        let wall_s = match piece.kind {
            Work::Measure | Work::Learn(_) | Work::Stage(_) => took_s,
            Work::OneByOne(_) => took_s / self.n_threads,
            Work::Touch | Work::Report => return,
        };
        self.alone[0] += wall_s * took_s;
        self.alone[1] += took_s;
    }

    fn spent(&mut self, piece: &Piece) -> [&mut Spent; 2] {
        let kind = self.kinds.entry(piece.kind).or_default();
        let place = self.places.entry((piece.kind, piece.place)).or_default();
        [kind, place]
    }

    /// Seconds left when a run has gone on for `elapsed_s`.
    pub fn left_s(&self, elapsed_s: f64) -> f64 {
        let at_once = || self.kinds.iter().filter(|(kind, _)| **kind != Work::Report);
        let took_s: f64 = at_once().map(|(_, spent)| spent.took_s).sum();
        let common = self.common_factor();
        let of_alike = self.factors_of_alike(&self.factors(common));
        let places = self
            .places
            .iter()
            .filter(|((kind, _), _)| *kind != Work::Report);
        let left = places.map(|((kind, _), spent)| {
            let prior = of_alike[&(*kind, spent.size())];
            spent.left_s() * spent.factor(prior)
        });
        let left_s: f64 = left.sum();
        // Each thread is somewhere within a piece that nobody has heard of yet; a second is longer within a long one. What they
        // have done of these pieces makes up for the time in which, at the end, some threads wait for the last.
        let usual_s = match self.alone[1] > 0.0 {
            true => self.alone[0] / self.alone[1],
            false => 0.0,
        };
        let not_told_s = (self.n_threads * elapsed_s - took_s).max(0.0);
        let under_way_s = (0.5 * self.n_threads * usual_s)
            .min(0.5 * left_s)
            .min(not_told_s);
        // What the very first pieces tell is chance.
        let planned_s: f64 = at_once().map(|(_, spent)| spent.planned_s).sum();
        let before_s = BUSY_BEFORE * planned_s / self.n_threads;
        let busy = match took_s > 0.0 && elapsed_s > 0.0 {
            true => (took_s + under_way_s + self.n_threads * before_s) / (elapsed_s + before_s),
            false => self.n_threads,
        };
        let report = self.kinds.get(&Work::Report);
        let report_s = report.map_or(0.0, |spent| spent.left_s() * spent.cautious_factor(common));
        left_s / busy + report_s
    }

    /// What a planned second takes, of work of which nothing is known: as the middle of the kinds so far and of the plan itself, the
    /// nearer to the plan the less is done.
    fn common_factor(&self) -> f64 {
        let kinds = self.kinds.iter().filter(|(kind, _)| **kind != Work::Report);
        let begun = kinds.filter(|(_, spent)| spent.has_begun());
        let factors = begun.map(|(_, spent)| spent.took_s / spent.done_s);
        let middle = middle(factors.chain([1.0]).collect()).max(f64::MIN_POSITIVE);
        let took_s: f64 = self.kinds.values().map(|spent| spent.took_s).sum();
        middle.powf(took_s / (took_s + SETTING_UP_S))
    }

    /// What a planned second of each kind takes.
    fn factors(&self, common: f64) -> BTreeMap<Work, f64> {
        let mut means: BTreeMap<Work, Mean> = BTreeMap::new();
        for ((kind, _), spent) in &self.places {
            let mean = means.entry(*kind).or_insert(Mean::of(PRIOR_PLACES, common));
            mean.take(spent.told(common), 1.0);
        }
        let factor = |(kind, mean): (Work, Mean)| (kind, mean.factor());
        means.into_iter().map(factor).collect()
    }

    /// The same of each kind and size of its pieces.
    fn factors_of_alike(&self, of_kinds: &BTreeMap<Work, f64>) -> BTreeMap<(Work, i32), f64> {
        let mut told: BTreeMap<(Work, i32), Mean> = BTreeMap::new();
        for ((kind, _), spent) in &self.places {
            let of_size = told.entry((*kind, spent.size())).or_default();
            of_size.take(spent.told(of_kinds[kind]), 1.0);
        }
        let factor = |&(kind, size): &(Work, i32)| {
            let mut mean = Mean::of(PRIOR_PLACES, of_kinds[&kind]);
            let of_kind = told.range((kind, i32::MIN)..=(kind, i32::MAX));
            for (&(_, other), &told) in of_kind {
                let apart = (f64::from(other) - f64::from(size)) / ALIKE_SIZES;
                mean.take(told, (-0.5 * apart * apart).exp());
            }
            ((kind, size), mean.factor())
        };
        told.keys().map(factor).collect()
    }
}

/// The middle one of some factors; of an even number the geometric mean of both, of none 1.
fn middle(mut factors: Vec<f64>) -> f64 {
    factors.sort_by(f64::total_cmp);
    match factors.len() {
        0 => 1.0,
        n => (factors[(n - 1) / 2] * factors[n / 2]).sqrt(),
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
        work.push(piece(Work::Report, 0, planned_s));
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
                told.push([now, left.left_s(now)]);
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

    fn piece(kind: Work, place: usize, planned_s: f64) -> Piece {
        Piece {
            kind,
            place,
            planned_s,
        }
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
        for (array, size) in [(0, 1.0), (1, 4.0)] {
            let of_array = chance(0.15);
            let mut add = |kind: Work, place: usize, planned_s: f64| {
                let as_planned = of_cell[place] * of_array * chance(0.2);
                let took_s = planned_s * factor(kind) * as_planned;
                let place = 40 * array + place;
                pieces.push((piece(kind, place, planned_s), took_s));
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
            piece(Work::Touch, 0, 4.0),
            piece(Work::Measure, 0, 6.0),
            piece(Work::Report, 0, 1.5),
        ];
        let left = TimeLeft::new(&work, 2);
        assert_eq!(left.left_s(0.0), 6.5);
        assert_eq!(TimeLeft::new(&[], 2).left_s(3.0), 0.0);
    }

    #[test]
    fn pieces_one_by_one_hold_all_threads_and_those_of_a_stage_one_each() {
        // Four seconds by the clock on all threads, then eight pieces of a second on two threads; twice as slow as planned.
        let shared = Piece::one_by_one(0, 0, 2.0);
        let n_threads = rayon::current_num_threads();
        let alone = Piece::of_stage(1, 0, 0.5);
        let work = [vec![shared], vec![alone; 4 * n_threads]].concat();
        let mut left = TimeLeft::new(&work, n_threads);
        assert!((left.left_s(0.0) - 4.0).abs() < 1e-12);
        left.worked(&shared, shared.spent_s(4.0));
        // What is under way is half a piece of the stage before, at most half of what is left.
        assert!((left.left_s(4.0) - 4.0).abs() < 1.5, "{}", left.left_s(4.0));
        for done in 1..=4 {
            (0..n_threads).for_each(|_| left.worked(&alone, alone.spent_s(1.0)));
            let (now, true_left) = (4.0 + done as f64, 4.0 - done as f64);
            let told = left.left_s(now);
            assert!(
                (told - true_left).abs() <= 0.3 * true_left + 1e-9,
                "{told} of {true_left}"
            );
        }
    }

    #[test]
    fn a_piece_that_was_planned_badly_speaks_for_others_of_its_size_and_less_for_all() {
        let learn = |place: usize, planned_s: f64| {
            piece(Work::Learn(ClassifierKind::LinearSvm), place, planned_s)
        };
        // A large one took five times as long as planned, two small ones as long; together they took 4.9 times as long.
        let done = [
            (learn(0, 64.0), 320.0),
            (learn(1, 1.0), 1.0),
            (learn(2, 1.0), 1.0),
        ];
        let left_s = |last: Piece| {
            let mut work: Vec<Piece> = done.iter().map(|(piece, _)| *piece).collect();
            work.push(last);
            let mut left = TimeLeft::new(&work, 1);
            let worked = done.iter();
            worked.for_each(|(piece, took_s)| left.worked(piece, *took_s));
            left.left_s(322.0)
        };
        let small_s = left_s(learn(3, 1.0));
        assert!((1.0..1.3).contains(&small_s), "{small_s}");
        let large_s = left_s(learn(3, 64.0));
        assert!((150.0..320.0).contains(&large_s), "{large_s}");
        // Of a size that nothing was done of, as all places of the kind, of which each counts the same.
        let other_s = left_s(learn(3, 8.0));
        assert!((8.0..24.0).contains(&other_s), "{other_s}");
    }

    #[test]
    fn a_kind_of_which_only_the_setting_up_is_done_says_nothing_of_others() {
        let work = [
            piece(Work::Touch, 0, 1.0),
            piece(Work::Learn(ClassifierKind::LinearSvm), 0, 10.0),
            piece(Work::Learn(ClassifierKind::RbfSvm), 1, 10.0),
        ];
        let mut left = TimeLeft::new(&work, 1);
        left.worked(&work[0], 1.0);
        let before_s = left.left_s(1.0);
        let begun = piece(Work::Learn(ClassifierKind::LinearSvm), 0, 1e-3);
        left.worked(&begun, 0.3);
        assert!((before_s - 20.0).abs() < 1e-9, "{before_s}");
        let after_s = left.left_s(1.3);
        assert!((after_s - before_s).abs() < 0.1 * before_s, "{after_s}");
    }

    #[test]
    fn nothing_is_left_at_the_end_but_the_report() {
        let work = [piece(Work::Touch, 0, 4.0), piece(Work::Report, 0, 1.5)];
        let mut left = TimeLeft::new(&work, 1);
        left.worked(&work[0], 4.0);
        assert_eq!(left.left_s(4.0), 1.5);
        // Where all else took nine times as long as planned, it may take about three times as long; until some of it is told.
        let mut slow = TimeLeft::new(&work, 1);
        slow.worked(&work[0], 36.0);
        let slow_s = slow.left_s(36.0);
        assert!((4.0..4.5).contains(&slow_s), "{slow_s}");
        let half = piece(Work::Report, 0, 0.75);
        slow.worked(&half, 0.75);
        let half_s = slow.left_s(36.75);
        assert!((0.75..0.5 * slow_s).contains(&half_s), "{half_s}");
        slow.worked(&half, 0.75);
        assert_eq!(slow.left_s(37.5), 0.0);
        left.worked(&work[1], 1.0);
        assert_eq!(left.left_s(5.0), 0.0);
    }
}
