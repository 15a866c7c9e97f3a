//! What is charted of a study of recognition.
//!
//! Every setting that varies has a place, so no chart mixes cells that differ in something it does not show: x takes the number of most
//! values, lines and panels the others of most values, of equals words before numbers; each combination of the rest gets a chart of its own.

use crate::report::study_folder::MOST_CHARTS;
use crate::report::swept::{Setting, Swept, without};
use crate::studies::recognition::charts::filled::filled;
use crate::studies::recognition::charts::tables::{
    CELLS, CHANCE, OVER_FOLDS, OVER_TRIAL, note_of_groups,
};
use crate::table::{Along, At, ChartSpec, Mark, Role, Rule, Shown, Table, Value};
use std::cmp::Reverse;

/// Classifiers from which on a study is about choosing one.
const MANY_CLASSIFIERS: usize = 3;

/// Accuracy by what varies; against time if classifiers are compared or a study asks; and what the best cell takes for what.
pub fn charts(tables: &[Table], pareto: Option<bool>) -> Vec<ChartSpec> {
    let Some(cells) = filled(tables, CELLS) else {
        return Vec::new();
    };
    let confusion = filled(tables, "confusion.csv");
    let summary_note = filled(tables, "summary.csv").map_or("", |table| &table.note);
    let over = match note_of_groups(cells) {
        Some(note) => note,
        None if summary_note.contains(OVER_FOLDS) => OVER_FOLDS.to_owned(),
        None => OVER_TRIAL.to_owned(),
    };
    let chart = ChartSpec {
        note: format!("Points are means over trials. {over}"),
        table: CELLS,
        y: "accuracy".to_owned(),
        rules: chance(cells, confusion).into_iter().collect(),
        ..ChartSpec::default()
    };
    let mut charts = accuracy_charts(cells, &chart);
    let n_classifiers = cells.groups(&["classifier"], 0..cells.n_rows).len();
    let mut others = Vec::new();
    if pareto.unwrap_or(n_classifiers >= MANY_CLASSIFIERS) {
        others.extend(time_charts(cells, &chart));
    }
    others.extend(confusion.and_then(|table| confusion_chart(cells, table)));
    // Charts of accuracies stand together; those that are drawn leave room for the others.
    let place = charts.len().min(MOST_CHARTS - others.len());
    charts.splice(place..place, others);
    charts
}

/// Returns the line at the share that guessing recognises: that of each cell where cells differ in their number of objects.
fn chance(cells: &Table, confusion: Option<&Table>) -> Option<Rule> {
    if cells.numbers(CHANCE).is_some() {
        return Some(Rule {
            along: Along::Y,
            at: At::Column(CHANCE.to_owned()),
            words: "chance (1 in the objects of each configuration)".to_owned(),
        });
    }
    let confusion = confusion?;
    let first = confusion
        .groups(&["cell"], 0..confusion.n_rows)
        .swap_remove(0);
    let n_objects = confusion.groups(&["object"], first).len();
    let words = format!("chance (1 in {n_objects})");
    Some(Rule::at(Along::Y, 1.0 / n_objects as f64, words))
}

/// The charts of accuracy that show every cell. Settings of the signal that leave their first values one at a time get charts of their own,
/// along x.
fn accuracy_charts(cells: &Table, chart: &ChartSpec) -> Vec<ChartSpec> {
    let all: Vec<usize> = (0..cells.n_rows).collect();
    let signal = Swept::of(cells, &all).one_at_a_time;
    if signal.is_empty() {
        let mut charts = charts_along(cells, chart, None, &all);
        // A setting of some classifiers alone also runs along an axis of its own, over the rows that have it.
        for setting in &Swept::of(cells, &all).free {
            let has_it = |row: &usize| setting.data.value(*row).is_some();
            let rows: Vec<usize> = all.iter().copied().filter(has_it).collect();
            if setting.is_number() && rows.len() < all.len() && setting.levels(&rows).len() > 2 {
                charts.extend(charts_along(cells, chart, Some(*setting), &rows));
            }
        }
        return charts;
    }
    let charts_of = |setting: &Setting| {
        let others = without(&signal, setting);
        let is_first = |row: &usize| {
            let mut others = others.iter();
            others.all(|other| other.data.key(*row) == other.data.key(0))
        };
        let has_value = |row: &usize| setting.data.value(*row).is_some();
        let rows = all.iter().copied().filter(is_first);
        let rows: Vec<usize> = rows.filter(has_value).collect();
        let first = |other: &Setting| Shown {
            column: other.column.name.to_string(),
            value: other.data.value(0).unwrap_or_else(|| Value::from("")),
        };
        let chart = ChartSpec {
            shown: others.iter().map(first).collect(),
            ..chart.clone()
        };
        charts_along(cells, &chart, Some(*setting), &rows)
    };
    signal.iter().flat_map(charts_of).collect()
}

/// The charts of some rows along a given setting, or along the main one. Where lines and panels are in use and no setting is left over, the
/// chart comes a second time with the two exchanged, so that both effects can be read off lines that lie in one panel.
fn charts_along(
    cells: &Table,
    chart: &ChartSpec,
    x: Option<Setting>,
    rows: &[usize],
) -> Vec<ChartSpec> {
    let swept = Swept::of(cells, rows);
    let x = x.or_else(|| swept.main(rows));
    let mut others = x.map_or_else(|| swept.free.clone(), |x| without(&swept.free, &x));
    others.sort_by_key(|one| (Reverse(one.levels(rows).len()), one.is_number()));
    let (used, fixed) = others.split_at(others.len().min(2));
    let [lines, panels] = [used.first(), used.get(1)].map(|one| one.map(name_of));
    let x = x.map_or_else(|| "ratio".to_owned(), |x| name_of(&x));
    let of_rows = |rows: Vec<usize>| {
        let here = fixed.iter().map(|one| &one.column.name);
        let here = here.filter_map(|name| cells.shown(name, rows[0]));
        ChartSpec {
            name: format!("accuracy_by_{}{}", word(&x), name_ending(fixed, rows[0])),
            title: title(cells, &x, (used, fixed), rows[0]),
            shown: chart.shown.iter().cloned().chain(here).collect(),
            x: x.clone(),
            lines: lines.iter().cloned().collect(),
            panels: panels.clone(),
            ..chart.clone()
        }
    };
    let mut charts: Vec<ChartSpec> = swept.groups(fixed, rows).into_iter().map(of_rows).collect();
    if let (Some(panels), true) = (panels, fixed.is_empty()) {
        let chart = charts[0].clone();
        charts.push(ChartSpec {
            name: format!("{}_per_{}", chart.name, word(&panels)),
            lines: vec![panels],
            panels: lines,
            ..chart
        });
    }
    charts
}

fn name_of(setting: &Setting) -> String {
    setting.column.name.to_string()
}

/// `Accuracy by compression, for each pitch and array size (noise 10 %)`.
fn title(cells: &Table, x: &str, (used, fixed): (&[Setting], &[Setting]), row: usize) -> String {
    let along = cells.column(x).map_or(x, |(column, _)| &column.words);
    let mut title = format!("Accuracy by {along}");
    let each = used.iter().map(|one| match &one.column.words[..] {
        "features" => "kind of features",
        words => words,
    });
    let used: Vec<&str> = each.collect();
    if !used.is_empty() {
        title += &format!(", for each {}", used.join(" and "));
    }
    let fixed: Vec<String> = fixed.iter().map(|one| one.phrase(row)).collect();
    if !fixed.is_empty() {
        title += &format!(" ({})", fixed.join(", "));
    }
    title
}

/// A column in names of files.
fn word(column: &str) -> &str {
    match column {
        "pitch_mm" | "size_mm" | "smoothing_mm" => column.trim_end_matches("_mm"),
        "noise_std" => "noise",
        other => other,
    }
}

/// `_noise_10_ensemble_sbhe`: letters, digits, points and underscores only.
fn name_ending(fixed: &[Setting], row: usize) -> String {
    let plain = |letter: char| match letter {
        '.' | '-' => letter,
        _ if letter.is_ascii_alphanumeric() => letter.to_ascii_lowercase(),
        _ => '_',
    };
    let parts = fixed.iter().map(|setting| {
        let value = match setting.data.value(row) {
            Some(Value::Number(number)) => setting.column.tick(number),
            _ => setting.label(row),
        };
        let value: String = value.chars().map(plain).collect();
        format!("_{}_{value}", word(&setting.column.name))
    });
    parts.collect()
}

/// Accuracy against the time to train and to decide: one panel for each value of the first condition, one colour for each classifier or, with
/// one classifier, for each value of the first other choice that varies.
fn time_charts(cells: &Table, chart: &ChartSpec) -> [ChartSpec; 2] {
    let all: Vec<usize> = (0..cells.n_rows).collect();
    let free = Swept::of(cells, &all).free;
    let of = |role: Role| free.iter().filter(move |one| one.column.role == role);
    let classifier = of(Role::Choice).find(|one| one.column.name == "classifier");
    let lines = classifier.or_else(|| of(Role::Choice).next());
    let costs = [
        ("training", "to train", "fit_s"),
        (
            "prediction",
            "to decide on an object",
            "predict_us_per_decision",
        ),
    ];
    costs.map(|(name, what, x)| ChartSpec {
        name: format!("pareto_{name}"),
        title: format!("Accuracy against the time {what}"),
        note: "Times are means of the trials on this machine; one of training is of all training touches, one of a decision has its touches measured."
            .to_owned(),
        x: x.to_owned(),
        lines: lines.map(name_of).into_iter().collect(),
        panels: of(Role::Condition).next().map(name_of),
        mark: Mark::Points,
        front: true,
        ..chart.clone()
    })
}

/// What the best cell takes for what.
fn confusion_chart(cells: &Table, confusion: &Table) -> Option<ChartSpec> {
    let accuracy = cells.numbers("accuracy")?;
    let best = (0..accuracy.len()).reduce(|a, b| if accuracy[b] > accuracy[a] { b } else { a })?;
    let cell = cells.number("cell", best);
    let mut cells_there = confusion.numbers("cell")?.iter();
    let row = cells_there.position(|known| *known == cell)?;
    let all: Vec<usize> = (0..cells.n_rows).collect();
    let swept = Swept::of(cells, &all);
    let mut words = vec![swept.condition_words(best), swept.choice_words(best)];
    words.retain(|words| !words.is_empty());
    words.push(format!("accuracy {:.2}", accuracy[best]));
    Some(ChartSpec {
        note: format!(
            "Rows were touched, columns are what they were taken for, all trials together. Of the most accurate cell ({}).",
            words.join(", ")
        ),
        shown: confusion.shown("cell", row).into_iter().collect(),
        mark: Mark::Tiles {
            fill: "count".to_owned(),
            sign: None,
        },
        ..confusion.chart(
            "confusion",
            "What was taken for what",
            ("object", "predicted"),
        )
    })
}
