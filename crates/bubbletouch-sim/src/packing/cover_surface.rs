//! Covering of the outer surface with few balls, cell by cell; repeated with other cells until no gap remains.

use super::ball::Ball;
use super::cells::Cells;
use super::certificate::{Gaps, gaps};
use super::sampling::{Sample, SampleTree, Sampling, sample};
use super::set_cover::{Cover, Lists};
use super::target::Target;
use crate::error::Result;
use crate::random::Seed;
use glam::DVec3;
use rand::Rng;

/// Maximum number of surface samples per cell. If larger, there are fewer borders between cells, but the data of the search exceed the processor's cache.
const CELL: usize = 24_000;

/// Fraction of the total time that sampling takes, for progress reports.
const SAMPLING_TIME: f64 = 0.2;

/// Parameters of one optimisation pass over all cells.
struct Pass {
    /// Fraction of a cell's samples on the lower side of the plane that divides the cell. Passes with different fractions have different cell borders.
    cut: f64,
    /// Fraction of the allowed search steps per ball that this pass uses to exchange balls.
    steps: f64,
    /// Fraction of the allowed moves per ball that this pass uses to create shifted copies of balls.
    moves: f64,
}

/// Optimisation passes that reduce the number of balls. After each pass, the remaining gaps become samples.
const PASSES: [Pass; 3] = [
    Pass {
        cut: 0.5,
        steps: 1.0,
        moves: 0.0,
    },
    Pass {
        cut: 0.4,
        steps: 0.5,
        moves: 1.0,
    },
    Pass {
        cut: 0.6,
        steps: 0.5,
        moves: 1.0,
    },
];

/// Maximum number of rounds that add balls at the remaining gaps. Usually no gap remains after three rounds.
const MAX_REPAIRS: usize = 40;

/// Returns balls whose spheres come within the tolerance of every point of the outer surface, and the number of remaining gaps. This number is 0 unless
/// [`MAX_REPAIRS`] rounds were needed.
pub(super) fn cover_surface(
    target: &Target,
    watch: &mut dyn FnMut(f64),
) -> Result<(Vec<Ball>, usize)> {
    let mut covering = Covering::new(target)?;
    watch(SAMPLING_TIME);
    let n_passes = covering.sampling.effort.n_passes;
    for (number, pass) in PASSES.iter().take(n_passes).enumerate() {
        covering.pass(pass, number as u64, &mut |share| {
            let done = (number as f64 + share) / n_passes as f64;
            watch(SAMPLING_TIME + (1.0 - SAMPLING_TIME) * done);
        });
        if number + 1 < n_passes {
            let gaps = covering.gaps();
            covering.sample_gaps(&gaps.places);
        }
    }
    covering.chosen.retain(|ball| ball.has_center_in(target));
    let mut gaps = covering.gaps();
    for _ in 0..MAX_REPAIRS {
        if gaps.places.is_empty() {
            break;
        }
        covering.fill(&gaps.places);
        gaps = covering.gaps_in(&gaps.triangles);
    }
    Ok((covering.chosen, gaps.places.len()))
}

struct Covering<'a> {
    target: &'a Target<'a>,
    sampling: Sampling,
    tree: SampleTree,
    chosen: Vec<Ball>,
    /// Number of chosen balls that cover each sample.
    counts: Vec<u32>,
    /// Index of each sample among the samples of the current cell; [`NOT_HERE`] for samples that do not belong to the cell.
    row_of: Vec<u32>,
}

/// Index that marks samples outside the current cell.
const NOT_HERE: u32 = u32::MAX;

impl<'a> Covering<'a> {
    fn new(target: &'a Target<'a>) -> Result<Self> {
        let mut sampling = sample(target)?;
        let samples = std::mem::take(&mut sampling.samples);
        Ok(Self {
            target,
            chosen: Vec::new(),
            counts: vec![0; samples.len()],
            row_of: vec![NOT_HERE; samples.len()],
            tree: SampleTree::new(samples, target.e),
            sampling,
        })
    }

    fn gaps(&self) -> Gaps {
        self.gaps_in(&self.sampling.outer)
    }

    fn gaps_in(&self, triangles: &[usize]) -> Gaps {
        gaps(self.target, triangles, &self.chosen)
    }

    /// Optimises the balls of all cells, one cell after another, in one pass.
    fn pass(&mut self, pass: &Pass, number: u64, watch: &mut dyn FnMut(f64)) {
        let positions: Vec<DVec3> = self.tree.samples.iter().map(|s| s.position).collect();
        let cells = Cells::new(&positions, CELL, pass.cut);
        let mut samples_in = vec![Vec::new(); cells.n_cells()];
        for (index, &position) in positions.iter().enumerate() {
            samples_in[cells.cell_of(position)].push(index);
        }
        let mut balls_in = vec![Vec::new(); cells.n_cells()];
        for ball in &self.sampling.balls {
            balls_in[cells.cell_of(ball.foot)].push(*ball);
        }
        let mut freed_in = vec![Vec::new(); cells.n_cells()];
        for ball in self.chosen.drain(..) {
            freed_in[cells.cell_of(ball.foot)].push(ball);
        }
        let seed = Seed::new(number).named("packing");
        for cell in 0..cells.n_cells() {
            let mut rng = seed.numbered(cell as u64).rng();
            let freed = std::mem::take(&mut freed_in[cell]);
            let candidates = std::mem::take(&mut balls_in[cell]);
            self.work_on(freed, candidates, &samples_in[cell], pass, &mut rng);
            watch((cell + 1) as f64 / cells.n_cells() as f64);
        }
    }

    /// Chooses the balls of one cell again from `freed` and `candidates`. The new balls cover the cell's samples and all samples that only the balls in
    /// `freed` covered.
    fn work_on(
        &mut self,
        freed: Vec<Ball>,
        candidates: Vec<Ball>,
        samples: &[usize],
        pass: &Pass,
        rng: &mut impl Rng,
    ) {
        let n_freed = freed.len();
        let moved = self.moved(&freed, pass.moves * self.sampling.effort.moves_a_ball, rng);
        let mut balls = freed;
        balls.extend(candidates);
        balls.extend(moved);
        let row_of = &mut self.row_of;
        let mut sample_of = Vec::new();
        let mut needs = |sample: usize, counts: &[u32]| {
            if counts[sample] == 0 && row_of[sample] == NOT_HERE {
                row_of[sample] = sample_of.len() as u32;
                sample_of.push(sample);
            }
        };
        for ball in &balls[..n_freed] {
            self.tree.each_covered(ball, |s| self.counts[s] -= 1);
        }
        for ball in &balls[..n_freed] {
            self.tree.each_covered(ball, |s| needs(s, &self.counts));
        }
        samples.iter().for_each(|&s| needs(s, &self.counts));
        let mut rows_of = Lists::new();
        let mut rows = Vec::new();
        for ball in &balls {
            rows.clear();
            self.tree.each_covered(ball, |s| {
                if row_of[s] != NOT_HERE {
                    rows.push(row_of[s]);
                }
            });
            rows_of.push(rows.iter().copied());
        }
        sample_of.iter().for_each(|&s| row_of[s] = NOT_HERE);
        let mut cover = Cover::new(&rows_of, sample_of.len());
        (0..n_freed).for_each(|set| cover.add(set));
        cover.complete();
        let steps_a_ball = pass.steps * self.sampling.effort.steps_a_ball;
        cover.improve((steps_a_ball * cover.chosen().len() as f64) as usize, rng);
        for set in cover.sorted() {
            let ball = balls[set];
            self.tree.each_covered(&ball, |s| self.counts[s] += 1);
            self.chosen.push(ball);
        }
    }

    /// Returns shifted copies of balls, about `n_moves` per ball. Each copy is shifted by up to half of the radius that the ball covers on a flat face.
    fn moved(&self, balls: &[Ball], n_moves: f64, rng: &mut impl Rng) -> Vec<Ball> {
        let n_moves = n_moves * balls.len() as f64;
        let mut moved = Vec::new();
        for number in 0..n_moves as usize {
            let ball = &balls[number % balls.len()];
            let shift = DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0)));
            let shift = 0.5 * ball.half_width(self.target.e) * shift;
            moved.extend(ball.beside(self.target, shift));
        }
        moved
    }

    /// Returns one ball for each gap; the ball covers the centre of the gap.
    fn balls_at(&self, gaps: &[Sample]) -> Vec<Ball> {
        let ball = |gap: &Sample| {
            let normal = self.target.normal_at(gap.position);
            Ball::at(self.target, gap.position, normal)
        };
        gaps.iter().map(ball).collect()
    }

    /// Adds the gaps to the samples, and balls that cover the gaps to the candidates.
    fn sample_gaps(&mut self, gaps: &[Sample]) {
        self.sampling.balls.extend(self.balls_at(gaps));
        let samples = [&self.tree.samples[..], gaps].concat();
        self.counts = vec![0; samples.len()];
        self.row_of = vec![NOT_HERE; samples.len()];
        self.tree = SampleTree::new(samples, self.target.e);
        for ball in &self.chosen {
            self.tree.each_covered(ball, |s| self.counts[s] += 1);
        }
    }

    /// Adds a small number of balls that cover the gaps. A gap remains if every ball that covers it has its centre outside the solid.
    fn fill(&mut self, gaps: &[Sample]) {
        let target = self.target;
        let held = |ball: Ball| ball.has_center_in(target).then_some(ball);
        let (mut balls, mut places) = (Vec::new(), Vec::new());
        for (gap, ball) in gaps.iter().zip(self.balls_at(gaps)) {
            if let Some(ball) = held(ball).or_else(|| held(Ball::on_surface(ball.foot))) {
                balls.push(ball);
                // The sample has radius 0: with a larger radius no ball might cover it.
                places.push(Sample {
                    radius: 0.0,
                    ..*gap
                });
            }
        }
        if places.is_empty() {
            return;
        }
        let n_gaps = places.len();
        let tree = SampleTree::new(places, target.e);
        let mut rows_of = Lists::new();
        for ball in &balls {
            let mut rows = Vec::new();
            tree.each_covered(ball, |s| rows.push(s as u32));
            rows_of.push(rows);
        }
        let mut cover = Cover::new(&rows_of, n_gaps);
        cover.complete();
        let chosen = cover.sorted().into_iter();
        self.chosen.extend(chosen.map(|set| balls[set]));
    }
}
