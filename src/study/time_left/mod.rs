//! The time remaining of a run: from what its work was planned to cost, and what the finished part has cost.

mod left;

pub use left::TimeLeft;

use crate::recognition::ClassifierKind;

/// Kinds of work. The plan of each may be wrong by a factor of its own: another machine, touches that are hard to tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Work {
    /// Touches are made.
    Touch,
    /// Frames are read and projected.
    Measure,
    /// A classifier is trained and tested.
    Learn(ClassifierKind),
    /// A stage of a study in pieces, by number: each piece on a thread of its own.
    Stage(u8),
    /// The same of a stage whose pieces come one after the other, each with all threads.
    OneByOne(u8),
    /// Tables and charts are written, on one thread at the end.
    Report,
}

/// A piece of work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// What is done.
    pub kind: Work,
    /// What it was planned to take, processor-seconds.
    pub planned_s: f64,
}

impl Piece {
    /// Tables and charts at the end: seconds by the clock.
    pub const fn report(planned_s: f64) -> Self {
        Self {
            kind: Work::Report,
            planned_s,
        }
    }

    /// Of a stage whose pieces have a thread each.
    pub fn of_stage(stage: u8, planned_s: f64) -> Self {
        Self {
            kind: Work::Stage(stage),
            planned_s,
        }
    }

    /// Of a stage whose pieces come one after the other: seconds by the clock.
    pub fn one_by_one(stage: u8, planned_wall_s: f64) -> Self {
        Self {
            kind: Work::OneByOne(stage),
            planned_s: planned_wall_s * rayon::current_num_threads() as f64,
        }
    }

    /// So much of it.
    pub fn share(&self, share: f64) -> Self {
        Self {
            planned_s: share * self.planned_s,
            ..*self
        }
    }

    /// Processor-seconds that so much time by the clock is.
    pub fn spent_s(&self, wall_s: f64) -> f64 {
        match self.kind {
            Work::OneByOne(_) => wall_s * rayon::current_num_threads() as f64,
            _ => wall_s,
        }
    }
}
