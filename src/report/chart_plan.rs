//! Which charts a study gets: what runs along x, what tells the lines apart, what tells the panels apart.
//!
//! Every setting that varies has a place, so no chart mixes cells that differ in something it does not show: x takes the
//! compression ratio if it varies, else another numeric axis; lines and panels take the next two; each combination of what
//! is left gets a chart of its own, with the values in its name and title.

use crate::report::axis::{Axis, AxisValue};
use crate::report::varying::{Levels, Settings};
use crate::study::strength_columns;
use crate::study::table::Cell;

/// What a chart shows where.
#[derive(Clone, Debug, PartialEq)]
pub struct ChartPlan {
    /// File name without ending.
    pub name: String,
    /// Along x.
    pub x: Levels,
    /// One line a value.
    pub lines: Option<Levels>,
    /// One panel a value.
    pub panels: Option<Levels>,
    /// Axes that vary in the study and stay in this chart.
    pub fixed: Vec<(Axis, AxisValue)>,
    /// Axes of the signal that other charts are about, at the values that they keep in this one.
    pub base: Vec<(Axis, AxisValue)>,
}

/// First choice first: what a reader looks for along x.
const ALONG_X: [Axis; 17] = [
    Axis::Ratio,
    Axis::Measurements,
    Axis::FusedTouches,
    Axis::TrainTouches,
    Axis::Mislabelled,
    Axis::ClassImbalance,
    Axis::Noise,
    Axis::Smoothing,
    Axis::C,
    Axis::Pitch,
    Axis::Size,
    Axis::Frames,
    Axis::OverTime,
    Axis::Features,
    Axis::Ensemble,
    Axis::Classifier,
    Axis::TestedOn,
];

/// What makes good lines: resolution first, then ways of treating the signal.
const AS_LINES: [Axis; 17] = [
    Axis::TestedOn,
    Axis::OverTime,
    Axis::Pitch,
    Axis::Ensemble,
    Axis::Features,
    Axis::Smoothing,
    Axis::Classifier,
    Axis::Size,
    Axis::Noise,
    Axis::Frames,
    Axis::FusedTouches,
    Axis::TrainTouches,
    Axis::Mislabelled,
    Axis::ClassImbalance,
    Axis::C,
    Axis::Ratio,
    Axis::Measurements,
];

/// What makes good panels.
const AS_PANELS: [Axis; 17] = [
    Axis::TestedOn,
    Axis::OverTime,
    Axis::Size,
    Axis::Frames,
    Axis::Classifier,
    Axis::Noise,
    Axis::Ensemble,
    Axis::Features,
    Axis::Smoothing,
    Axis::FusedTouches,
    Axis::TrainTouches,
    Axis::Mislabelled,
    Axis::ClassImbalance,
    Axis::C,
    Axis::Pitch,
    Axis::Ratio,
    Axis::Measurements,
];

/// The charts of accuracy that show every cell.
///
/// Where lines and panels are in use and no axis is left over, the chart comes a second time with the two exchanged, so that
/// both effects can be read off lines that lie in one panel. Axes of the signal that leave their first values one at a time
/// get charts of their own, along x.
pub fn plan_charts(cells: &[&Cell]) -> Vec<ChartPlan> {
    let settings = Settings::of(cells);
    if cells.is_empty() {
        return Vec::new();
    }
    if settings.one_at_a_time.is_empty() {
        return charts_along(None, settings.varying, cells);
    }
    let signal = &settings.one_at_a_time;
    let charts_of = |levels: &Levels| {
        let others = signal.iter().filter(|other| other.axis != levels.axis);
        let base: Vec<(Axis, AxisValue)> = others
            .map(|other| (other.axis, other.axis.value(cells[0])))
            .collect();
        let at_base = |cell: &&&Cell| base.iter().all(|(axis, value)| axis.value(cell) == *value);
        let cells: Vec<&Cell> = cells.iter().filter(at_base).copied().collect();
        let free = Settings::of(&cells).varying;
        let mut plans = charts_along(Some(levels.axis), free, &cells);
        for plan in &mut plans {
            plan.base = base.clone();
        }
        plans
    };
    signal.iter().flat_map(charts_of).collect()
}

/// The charts of cells whose axes in `free` vary, along a given one or along the first that suits.
fn charts_along(x: Option<Axis>, mut free: Vec<Levels>, cells: &[&Cell]) -> Vec<ChartPlan> {
    // Words stand along x only if no number varies.
    let words_last = |levels: &Levels| levels.numbers().is_some();
    let given = free.iter().position(|levels| Some(levels.axis) == x);
    let given = given.map(|place| free.remove(place));
    let x = given
        .or_else(|| take(&mut free, &ALONG_X, words_last))
        .or_else(|| take(&mut free, &ALONG_X, |_| true))
        .unwrap_or_else(|| Levels::of(Axis::Ratio, cells));
    let lines = take(&mut free, &AS_LINES, |_| true);
    let panels = take(&mut free, &AS_PANELS, |_| true);
    let mut plans = Vec::new();
    for fixed in combinations(&free) {
        let name = format!("accuracy_by_{}{}", x.axis.word(), name_ending(&fixed));
        let plan = ChartPlan {
            name: name.clone(),
            x: x.clone(),
            lines: lines.clone(),
            panels: panels.clone(),
            fixed: fixed.clone(),
            base: Vec::new(),
        };
        plans.push(plan.clone());
        if let (Some(lines), Some(panels), true) = (&lines, &panels, fixed.is_empty()) {
            plans.push(ChartPlan {
                name: format!("{}_per_{}", plan.name, panels.axis.word()),
                lines: Some(panels.clone()),
                panels: Some(lines.clone()),
                ..plan
            });
        }
    }
    plans.retain(|plan| cells.iter().any(|cell| plan.shows(cell)));
    plans
}

impl ChartPlan {
    /// Whether a cell is in this chart.
    pub fn shows(&self, cell: &Cell) -> bool {
        let stated = self.fixed.iter().chain(&self.base);
        stated
            .into_iter()
            .all(|(axis, value)| axis.value(cell) == *value)
    }
}

fn take(free: &mut Vec<Levels>, order: &[Axis], suits: impl Fn(&Levels) -> bool) -> Option<Levels> {
    // What a study names itself comes first, and what a skin does to a signal after what people choose.
    let errors = strength_columns();
    let is_own = |axis: &Axis| matches!(axis, Axis::Column(own) if !errors.contains(own));
    let own: Vec<Axis> = free.iter().map(|l| l.axis).filter(is_own).collect();
    let errors = errors.iter().map(Axis::Column);
    let mut order = own.into_iter().chain(order.iter().copied()).chain(errors);
    let chosen = order.find_map(|axis| free.iter().position(|l| l.axis == axis && suits(l)))?;
    Some(free.remove(chosen))
}

/// Every choice of one value an axis; one empty choice for no axes.
fn combinations(axes: &[Levels]) -> Vec<Vec<(Axis, AxisValue)>> {
    axes.iter().fold(vec![Vec::new()], |found, levels| {
        let extended = found.iter().flat_map(|start| {
            levels.values.iter().map(move |value| {
                let mut longer = start.clone();
                longer.push((levels.axis, value.clone()));
                longer
            })
        });
        extended.collect()
    })
}

/// `_noise_10_ensemble_sbhe`: letters, digits, points and underscores only.
fn name_ending(fixed: &[(Axis, AxisValue)]) -> String {
    let parts = fixed.iter().map(|(axis, value)| {
        let plain = |letter: char| match letter {
            '.' | '-' => letter,
            _ if letter.is_ascii_alphanumeric() => letter.to_ascii_lowercase(),
            _ => '_',
        };
        let value: String = value.tick.chars().map(plain).collect();
        format!("_{}_{value}", axis.word())
    });
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::ClassifierKind;
    use crate::sensing::Ensemble;
    use crate::study::table::tests::cell;

    fn roles(plan: &ChartPlan) -> (Axis, Option<Axis>, Option<Axis>) {
        let axis = |levels: &Option<Levels>| levels.as_ref().map(|l| l.axis);
        (plan.x.axis, axis(&plan.lines), axis(&plan.panels))
    }

    #[test]
    fn the_ratio_runs_along_x_whenever_it_varies() {
        let mut cells = Vec::new();
        for pitch_mm in [2.0, 4.0] {
            for ratio in [4.0, 16.0] {
                cells.push(Cell {
                    pitch_mm,
                    size_mm: 32.0 * pitch_mm,
                    ratio,
                    ..cell()
                });
            }
        }
        let plans = plan_charts(&cells.iter().collect::<Vec<_>>());
        assert_eq!(plans.len(), 1);
        assert_eq!(plans[0].name, "accuracy_by_ratio");
        assert_eq!(roles(&plans[0]), (Axis::Ratio, Some(Axis::Pitch), None));
    }

    #[test]
    fn what_finds_no_place_in_a_chart_makes_charts_of_its_own() {
        let mut cells = Vec::new();
        for ratio in [4.0, 16.0] {
            for noise_std in [0.0, 0.1] {
                for smoothing_mm in [0.0, 4.0] {
                    for classifier in [ClassifierKind::LinearSvm, ClassifierKind::RbfSvm] {
                        for ensemble in [Ensemble::Gaussian, Ensemble::Sbhe] {
                            cells.push(Cell {
                                ratio,
                                noise_std,
                                smoothing_mm,
                                classifier,
                                ensemble,
                                ..cell()
                            });
                        }
                    }
                }
            }
        }
        let plans = plan_charts(&cells.iter().collect::<Vec<_>>());
        let places = (Axis::Ratio, Some(Axis::Ensemble), Some(Axis::Classifier));
        assert_eq!(roles(&plans[0]), places);
        assert_eq!(plans.len(), 4);
        assert_eq!(plans[1].name, "accuracy_by_ratio_noise_0_smoothing_4");
        for cell in &cells {
            assert_eq!(plans.iter().filter(|plan| plan.shows(cell)).count(), 1);
        }
        let mut names: Vec<&str> = plans.iter().map(|plan| plan.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), plans.len());
    }

    #[test]
    fn a_study_of_one_cell_has_one_chart() {
        let cell = cell();
        let plans = plan_charts(&[&cell]);
        assert_eq!(plans.len(), 1);
        assert_eq!(roles(&plans[0]), (Axis::Ratio, None, None));
        assert_eq!(plan_charts(&[]), []);
    }

    #[test]
    fn words_stand_along_x_only_if_no_number_varies() {
        let cells = [
            Cell {
                ensemble: Ensemble::Sbhe,
                ..cell()
            },
            Cell {
                ensemble: Ensemble::Sbhe,
                pitch_mm: 4.0,
                ..cell()
            },
            cell(),
            Cell {
                pitch_mm: 4.0,
                ..cell()
            },
        ];
        let all: Vec<&Cell> = cells.iter().collect();
        assert_eq!(
            roles(&plan_charts(&all)[0]),
            (Axis::Pitch, Some(Axis::Ensemble), None)
        );
        assert_eq!(
            roles(&plan_charts(&[all[0], all[2]])[0]),
            (Axis::Ensemble, None, None)
        );
    }
    #[test]
    fn what_changes_alone_gets_a_chart_of_its_own_from_the_same_first_cells() {
        let mut cells = Vec::new();
        for classifier in [ClassifierKind::LinearSvm, ClassifierKind::RbfSvm] {
            let at = |noise_std, crosstalk| Cell {
                noise_std,
                strengths: crate::study::Strengths::default().with("crosstalk", Some(crosstalk)),
                classifier,
                ..cell()
            };
            cells.extend([at(0.05, 0.0), at(0.2, 0.0), at(0.05, 0.1), at(0.05, 0.4)]);
        }
        let all: Vec<&Cell> = cells.iter().collect();
        let plans = plan_charts(&all);
        let crosstalk = Axis::Column(&strength_columns()[1]);
        let lines = Some(Axis::Classifier);
        assert_eq!(plans.len(), 2);
        assert_eq!(roles(&plans[0]), (Axis::Noise, lines, None));
        assert_eq!(roles(&plans[1]), (crosstalk, lines, None));
        assert_eq!(plans[1].name, "accuracy_by_crosstalk");
        for (plan, shown) in plans
            .iter()
            .zip([[0, 1, 4, 5].to_vec(), [0, 2, 3, 4, 6, 7].to_vec()])
        {
            let found: Vec<usize> = (0..8).filter(|&i| plan.shows(all[i])).collect();
            assert_eq!(found, shown);
        }
    }
}
