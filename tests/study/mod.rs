//! A study from its text to its outcome, as the command does it.
// Each test file uses its part of this.
#![allow(dead_code)]

use bubbletouch::random::Seed;
use bubbletouch::study::memory::MemoryPlan;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::{Cell, TrialScore};
use bubbletouch::study::{
    Estimate, Outcome, Plan, StudySpec, Sweep, TouchedObject, draw_touches, load_objects, run,
};

/// A study that is laid out.
pub struct Study {
    pub plan: Plan,
    pub touched: Vec<TouchedObject>,
    pub sweep: Sweep,
}

impl Study {
    pub fn new(text: &str) -> Self {
        let spec = StudySpec::parse("study.toml", text).unwrap();
        let plan = Plan::new("study.toml", spec).unwrap();
        let objects = load_objects(&plan.spec.objects, None).unwrap();
        let touched = draw_touches(objects, &plan.placement, &Seed::new(plan.spec.seed)).unwrap();
        let sweep = Sweep::new(&plan, &touched).unwrap();
        Self {
            plan,
            touched,
            sweep,
        }
    }

    /// What is said of a study that cannot be laid out.
    pub fn error(text: &str) -> String {
        let laid_out = || {
            let spec = StudySpec::parse("study.toml", text)?;
            let plan = Plan::new("study.toml", spec)?;
            let objects = load_objects(&plan.spec.objects, None)?;
            let touched = draw_touches(objects, &plan.placement, &Seed::new(plan.spec.seed))?;
            Sweep::new(&plan, &touched).map(|_| ())
        };
        laid_out().expect_err("it is refused").to_string()
    }

    pub fn estimate(&self) -> Estimate {
        let memory = MemoryPlan::new(&self.plan, &self.sweep, self.touched.len(), None).unwrap();
        Estimate::new(&self.plan, &self.touched, &self.sweep, &memory)
    }

    pub fn run(&self) -> Outcome {
        run(&self.plan, &self.sweep, &self.touched, &Silent).unwrap()
    }
}

/// The trials of the only cell with these settings; its number in the sweep does not count.
pub fn trials_of<'a>(outcome: &'a Outcome, wanted: &Cell) -> Vec<&'a TrialScore> {
    let same = |cell: &Cell| {
        let numbered = Cell {
            cell: cell.cell,
            ..wanted.clone()
        };
        *cell == numbered
    };
    let rows = outcome.tables.accuracy.iter();
    rows.filter(|(cell, _)| same(cell))
        .map(|(_, score)| score)
        .collect()
}
