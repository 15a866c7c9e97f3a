//! Planned and spent processor-seconds of some work, and what they tell of other work.

/// Share of one of a place's pieces that counts as much as the factor of its kind, and makes the place count in that: before that
/// much is done, its own factor is chance.
const HESITATION: f64 = 0.3;
/// The same for the factor of a place within its kind, which so is never 0; and the share of a kind that makes it count in the
/// middle of all kinds, if a piece of it takes longer.
const LEAST_SHARE: f64 = 0.02;

/// Of a kind or a place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spent {
    pub n_pieces: usize,
    /// Of all the work, by plan.
    pub planned_s: f64,
    /// Of the finished part, by plan.
    pub done_s: f64,
    /// Of the finished part, as it was.
    pub took_s: f64,
}

impl Spent {
    pub fn left_s(&self) -> f64 {
        (self.planned_s - self.done_s).max(0.0)
    }

    /// What a piece was planned to take, on average.
    pub fn piece_s(&self) -> f64 {
        self.planned_s / self.n_pieces.max(1) as f64
    }

    /// Whether so much is done that it says something of what is left.
    pub fn has_begun(&self) -> bool {
        let enough_s = (HESITATION * self.piece_s()).min(LEAST_SHARE * self.planned_s);
        self.done_s > 0.0 && self.done_s >= enough_s
    }

    /// How long its pieces were planned to take: half octaves.
    pub fn size(&self) -> i32 {
        (2.0 * self.piece_s().max(f64::MIN_POSITIVE).log2()).round() as i32
    }

    /// What it tells of others, as nobody knew but `prior`: nothing before it begins.
    pub fn told(&self, prior: f64) -> Mean {
        let piece_s = self.piece_s();
        match self.done_s > 0.0 {
            true => Mean::of(
                (self.done_s / (HESITATION * piece_s)).min(1.0),
                self.mixed(prior, LEAST_SHARE * piece_s),
            ),
            false => Mean::default(),
        }
    }

    /// What a planned second of what is left takes, as nobody knew but `prior`.
    pub fn factor(&self, prior: f64) -> f64 {
        self.mixed(prior, HESITATION * self.piece_s())
    }

    /// The same, where `prior` counts as much as a whole piece: of work that several threads have begun before any is told of.
    pub fn cautious_factor(&self, prior: f64) -> f64 {
        self.mixed(prior, self.piece_s())
    }

    /// What a planned second took, where `prior` counts as much as `weight_s` planned seconds.
    fn mixed(&self, prior: f64, weight_s: f64) -> f64 {
        match self.done_s + weight_s {
            0.0 => prior,
            sum_s => (self.took_s + weight_s * prior) / sum_s,
        }
    }
}

/// A geometric mean of factors.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mean {
    weight: f64,
    /// Of weighted logarithms.
    sum: f64,
}

impl Mean {
    /// Of one factor.
    pub fn of(weight: f64, factor: f64) -> Self {
        let sum = weight * factor.ln();
        Self { weight, sum }
    }

    /// Takes that of others, each with so much of its weight.
    pub fn take(&mut self, others: Self, share: f64) {
        self.weight += share * others.weight;
        self.sum += share * others.sum;
    }

    pub fn factor(&self) -> f64 {
        (self.sum / self.weight).exp()
    }
}
