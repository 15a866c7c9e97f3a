//! What the results of a family of cells depend on, beside what all cells of a study share: its name in a journal.
//!
//! Nothing in it says where its cells stand in their study, so that it keeps its name when an axis has more values. Nothing of a cell is
//! drawn by its number either: streams go by the study's seed, the trial, and what is touched.

use crate::engine::axes::AxisValues;
use crate::inputs::content_hash::short_hash;
use crate::inputs::sensor_errors::{Strengths, TestedOn, all_strengths};
use crate::signal::Strength;
use crate::studies::recognition::plan::group::Group;
use crate::studies::recognition::plan::plan::Plan;
use crate::studies::recognition::rows::cell::Cell;
use crate::studies::recognition::spec::signal::StepSpec;

/// Hexadecimal digits of a name. Fewer: two cells may be taken for each other.
const DIGITS: usize = 24;

/// The name of a [family](Group::families): the same for the same cells of the same study.
pub fn family_name(plan: &Plan, family: &[Cell]) -> String {
    let steps = active_steps(plan, &family[0]);
    let path = solved_together(family);
    let settings = settings(plan, &family[0]);
    let differ = family.iter().map(|cell| {
        let next_touch = cell.next_touch.unwrap_or_default();
        (cell.c, cell.fused_touches, next_touch)
    });
    let differ: Vec<_> = differ.collect();
    let content = format!("{settings:?} {steps:?} {path:?} {differ:?}");
    short_hash(content, DIGITS)
}

/// A cell without its number, and with all that is left out said: an axis that a study does not have is one whose value does nothing.
fn settings(plan: &Plan, cell: &Cell) -> Cell {
    let said = |strengths: Strengths, (_, strength): (_, &Strength)| {
        let value = strengths.of(strength.key).unwrap_or(0.0);
        strengths.with(strength.key, Some(value))
    };
    Cell {
        cell: 0,
        strengths: all_strengths().fold(cell.strengths, said),
        tested_on: Some(cell.tested_on.unwrap_or(TestedOn::SameSkin)),
        // All of a split's, which more trials may make fewer in a split of theirs.
        train_touches: match plan.spec.recognition.train_touches {
            None => 0,
            Some(_) => cell.train_touches,
        },
        // Among what the cells of a family differ in.
        next_touch: None,
        variant: AxisValues {
            number: 0,
            ..cell.variant.clone()
        },
        ..cell.clone()
    }
}

/// The steps of the signal that do something to the cell, in their order.
fn active_steps(plan: &Plan, cell: &Cell) -> Vec<StepSpec> {
    let is_active = |step: &&StepSpec| match step {
        StepSpec::Force => true,
        StepSpec::Noise => cell.noise_std != 0.0,
        StepSpec::Smoothing => cell.smoothing_mm != 0.0,
        StepSpec::Error(error) => cell.strengths.present().any(|(own, ..)| own == *error),
    };
    let steps = plan.spec.signal.steps.iter();
    steps.filter(is_active).copied().collect()
}

/// The C's of which each is solved from where the last one ended: the last digits of a solution depend on them all. None where each fit
/// stands alone.
fn solved_together(family: &[Cell]) -> Vec<f64> {
    let is_path = family[0].classifier.about().kernel.is_some();
    let penalties = Group::fits(family).filter_map(|cells| cells[0].c);
    let mut penalties: Vec<f64> = penalties.filter(|_| is_path).collect();
    penalties.sort_by(f64::total_cmp);
    match penalties.len() {
        1 => Vec::new(),
        _ => penalties,
    }
}
