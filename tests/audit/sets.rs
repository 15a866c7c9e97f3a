//! Data sets of the tests: labelled touches with random numbers of their own.

use bubbletouch::audit::{AuditData, AuditOptions, Finding, Verdict, audit};
use bubbletouch::random::Seed;
use ndarray::{Array2, Axis};
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Labelled touches, in the order of recording.
pub struct Set {
    pub frames: Array2<f64>,
    pub n_frames: usize,
    pub grid: Option<(usize, usize)>,
    pub labels: Vec<usize>,
    pub groups: Option<Vec<usize>>,
    pub sessions: Option<Vec<usize>>,
    pub is_test: Option<Vec<bool>>,
    pub full_scale: Option<f64>,
    pub options: AuditOptions,
    pub rng: ChaCha8Rng,
}

pub fn rng(name: &str, seed: u64) -> ChaCha8Rng {
    Seed::new(seed).named(name).rng()
}

pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    rng.sample(StandardNormal)
}

pub fn normals(rng: &mut ChaCha8Rng, n: usize, m: usize) -> Array2<f64> {
    Array2::from_shape_simple_fn((n, m), || normal(rng))
}

/// Returns the readings of `n` taxels.
pub fn row(n: usize, reading: impl FnMut(usize) -> f64) -> Vec<f64> {
    (0..n).map(reading).collect()
}

/// Returns `per_class` labels of each of `n_classes` classes in random order.
pub fn shuffled_labels(rng: &mut ChaCha8Rng, n_classes: usize, per_class: usize) -> Vec<usize> {
    let mut labels: Vec<usize> = (0..n_classes * per_class).map(|k| k % n_classes).collect();
    labels.shuffle(rng);
    labels
}

/// Returns the frame of a round contact on a grid of `side` × `side` taxels, without noise.
pub fn disc(side: usize, (y, x): (f64, f64), radius: f64, depth: f64) -> Vec<f64> {
    let reading = |taxel: usize| {
        let away = ((taxel / side) as f64 - y).hypot((taxel % side) as f64 - x);
        depth * (1.0 + radius - away).clamp(0.0, 1.0)
    };
    row(side * side, reading)
}

/// Returns an array of normal numbers, such as a pattern of each class.
pub fn patterns(name: &str, seed: u64, n: usize, m: usize) -> Array2<f64> {
    normals(&mut rng(&format!("patterns {name}"), seed), n, m)
}

impl Set {
    /// Creates a set of `per_class` touches of each of `n_classes` classes in random order.
    pub fn of(
        name: &str,
        seed: u64,
        [n_classes, per_class]: [usize; 2],
        n_frames: usize,
        touch: impl FnMut(usize, usize, &mut ChaCha8Rng) -> Vec<f64>,
    ) -> Self {
        let mut rng = rng(name, seed);
        let labels = shuffled_labels(&mut rng, n_classes, per_class);
        Self::new(rng, labels, n_frames, touch)
    }

    /// Creates a set from a function that returns the readings of all frames of a touch.
    pub fn new(
        mut rng: ChaCha8Rng,
        labels: Vec<usize>,
        n_frames: usize,
        mut touch: impl FnMut(usize, usize, &mut ChaCha8Rng) -> Vec<f64>,
    ) -> Self {
        let rows: Vec<Vec<f64>> = (0..labels.len())
            .map(|k| touch(k, labels[k], &mut rng))
            .collect();
        let n_taxels = rows[0].len() / n_frames;
        let frames = Array2::from_shape_vec((labels.len() * n_frames, n_taxels), rows.concat());
        Self {
            frames: frames.unwrap(),
            n_frames,
            grid: None,
            labels,
            groups: None,
            sessions: None,
            is_test: None,
            full_scale: None,
            options: AuditOptions {
                n_permutations: 399,
                ..AuditOptions::default()
            },
            rng,
        }
    }

    /// Five sizes of a disc at random places of 12 × 12 taxels, with noise: the clean set into which faults are planted.
    pub fn discs(seed: u64) -> Self {
        let mut rng = rng("discs", seed);
        let labels = shuffled_labels(&mut rng, 5, 60);
        Self::of_discs(rng, labels)
    }

    pub fn of_discs(rng: ChaCha8Rng, labels: Vec<usize>) -> Self {
        let set = Self::new(rng, labels, 1, |_, class, rng| {
            let place = (rng.gen_range(4.0..7.0), rng.gen_range(4.0..7.0));
            let frame = disc(12, place, 1.0 + 0.7 * class as f64, rng.gen_range(0.6..1.0));
            frame.into_iter().map(|x| x + 0.02 * normal(rng)).collect()
        });
        Self {
            grid: Some((12, 12)),
            ..set
        }
    }

    pub fn grid(self, grid: (usize, usize)) -> Self {
        let grid = Some(grid);
        Self { grid, ..self }
    }

    pub fn groups(self, groups: Vec<usize>) -> Self {
        let groups = Some(groups);
        Self { groups, ..self }
    }

    pub fn sessions(self, sessions: Vec<usize>) -> Self {
        let sessions = Some(sessions);
        Self { sessions, ..self }
    }

    pub fn n(&self) -> usize {
        self.labels.len()
    }

    /// Puts the touches into another order.
    pub fn reorder(&mut self, order: &[usize]) {
        let n_frames = self.n_frames;
        let frames = order.iter().flat_map(|&k| k * n_frames..(k + 1) * n_frames);
        self.frames = self.frames.select(Axis(0), &frames.collect::<Vec<_>>());
        self.labels = order.iter().map(|&k| self.labels[k]).collect();
        for list in [&mut self.groups, &mut self.sessions].into_iter().flatten() {
            *list = order.iter().map(|&k| list[k]).collect();
        }
    }

    /// Sorts the touches by a key; equal keys keep their order.
    pub fn sort_by(&mut self, key: impl Fn(&Self, usize) -> usize) {
        let mut order: Vec<usize> = (0..self.n()).collect();
        order.sort_by_key(|&k| key(self, k));
        self.reorder(&order);
    }

    /// Adds a row of normal numbers for each value of `of` to all frames of its touches.
    pub fn add_styles(&mut self, of: &[usize], size: f64) {
        let n = of.iter().max().unwrap() + 1;
        let styles = size * normals(&mut self.rng, n, self.frames.ncols());
        for (frame, mut row) in self.frames.rows_mut().into_iter().enumerate() {
            row += &styles.row(of[frame / self.n_frames]);
        }
    }

    pub fn findings(self) -> Vec<Finding> {
        let classes = 0..*self.labels.iter().max().unwrap() + 1;
        let data = AuditData {
            frames: self.frames,
            n_frames: self.n_frames,
            grid: self.grid,
            labels: Some(self.labels),
            classes: classes.map(|class| format!("class {class}")).collect(),
            groups: self.groups,
            sessions: self.sessions,
            is_test: self.is_test,
            full_scale: self.full_scale,
            ..AuditData::default()
        };
        audit(data, self.options).unwrap().findings
    }
}

/// Returns the faults, with their sentences.
pub fn faults(findings: &[Finding]) -> Vec<String> {
    let words = |fault: &Finding| {
        let (place, p_value) = (format!("{} {}", fault.check, fault.subject), fault.p_text());
        format!("{place}: {p_value} {}", fault.sentence)
    };
    let findings = findings.iter();
    let faults = findings.filter(|finding| finding.verdict == Verdict::Fault);
    faults.map(words).collect()
}
