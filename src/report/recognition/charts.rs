//! What is charted of a study of recognition.
//!
//! Every setting that varies has a place, so no chart mixes cells that differ in something it does not show: x takes the first of the
//! study's own axes, else the compression ratio if it varies, else another number; lines and panels take the next two; each combination of what
//! is left gets a chart of its own.

use super::CELLS;
use crate::report::swept::{Setting, Swept, without};
use crate::study::table::Cell;
use crate::table::{Along, At, ChartSpec, Columns, Data, Mark, Role, Rule, Shown, Table};

/// Classifiers from which on a study is about choosing one.
const MANY_CLASSIFIERS: usize = 3;

/// First choice first: what a reader looks for along x. Others follow in the order of the table.
const ALONG_X: [&str; 12] = [
    "ratio",
    "measurements",
    "fused_touches",
    "train_touches",
    "mislabelled_fraction",
    "class_imbalance",
    "noise_std",
    "smoothing_mm",
    "c",
    "pitch_mm",
    "size_mm",
    "frames",
];

/// What makes good lines: resolution first, then ways of treating the signal.
const AS_LINES: [&str; 8] = [
    "tested_on",
    "over_time",
    "pitch_mm",
    "ensemble",
    "features",
    "smoothing_mm",
    "classifier",
    "size_mm",
];

/// What makes good panels.
const AS_PANELS: [&str; 8] = [
    "tested_on",
    "over_time",
    "size_mm",
    "frames",
    "classifier",
    "noise_std",
    "ensemble",
    "features",
];

/// Accuracy by what varies; against time if classifiers are compared or a study asks; and what the best cell takes for what.
pub fn charts(tables: &[Table], pareto: Option<bool>) -> Vec<ChartSpec> {
    let Some(cells) = tables
        .iter()
        .find(|table| table.file == CELLS && table.n_rows > 0)
    else {
        return Vec::new();
    };
    let confusion = tables.iter().find(|table| table.file == "confusion.csv");
    let chance = confusion.and_then(chance);
    let mut charts = accuracy_charts(cells, &chance);
    // Before the many that a large study has.
    let place = charts.len().min(2);
    let mut others = Vec::new();
    if is_wanted(cells, pareto) {
        others.extend(time_charts(cells, &chance));
    }
    others.extend(confusion.and_then(|table| confusion_chart(cells, table)));
    charts.splice(place..place, others);
    charts
}

/// What runs along x of the first chart.
pub(super) fn along(cells: &Table) -> String {
    let charts = accuracy_charts(cells, &None);
    charts
        .first()
        .map_or_else(|| "ratio".to_owned(), |chart| chart.x.clone())
}

/// Whether accuracy is charted against time: as a study asks, else if it sweeps three classifiers or more.
pub fn is_wanted(cells: &Table, asked: Option<bool>) -> bool {
    let n_kinds = match cells.column("classifier") {
        Some((_, Data::Words { levels, .. })) => levels.len(),
        _ => 0,
    };
    asked.unwrap_or(n_kinds >= MANY_CLASSIFIERS)
}

/// A line at the share that guessing recognises.
fn chance(confusion: &Table) -> Option<Rule> {
    let (_, Data::Words { levels, .. }) = confusion.column("object")? else {
        return None;
    };
    (!levels.is_empty()).then(|| Rule {
        along: Along::Y,
        at: At::Value(1.0 / levels.len() as f64),
        words: format!("chance (1 in {})", levels.len()),
    })
}

/// The charts of accuracy that show every cell. Where lines and panels are in use and no setting is left over, the chart comes a second
/// time with the two exchanged, so that both effects can be read off lines that lie in one panel. Settings of the signal that leave their
/// first values one at a time get charts of their own, along x.
fn accuracy_charts(cells: &Table, chance: &Option<Rule>) -> Vec<ChartSpec> {
    let all: Vec<usize> = (0..cells.n_rows).collect();
    let swept = Swept::of(cells, &all);
    if swept.one_at_a_time.is_empty() {
        return charts_along(cells, chance, None, &all, &[]);
    }
    let signal = &swept.one_at_a_time;
    let charts_of = |setting: &Setting| {
        let others = without(signal, setting);
        let is_at_base = |row: &usize| {
            others
                .iter()
                .all(|other| other.data.key(*row) == other.data.key(0))
        };
        let rows: Vec<usize> = all.iter().copied().filter(is_at_base).collect();
        charts_along(cells, chance, Some(&setting.column.name), &rows, &others)
    };
    signal.iter().flat_map(charts_of).collect()
}

/// The charts of some rows along a given column, or along the first that suits; `base` keep their first values.
fn charts_along(
    cells: &Table,
    chance: &Option<Rule>,
    x: Option<&str>,
    rows: &[usize],
    base: &[Setting],
) -> Vec<ChartSpec> {
    let swept = Swept::of(cells, rows);
    let mut free = swept.free.clone();
    let x = match x {
        Some(name) => take(&mut free, &[name], |_| true),
        // What a study has axes for is what it asks about. Words stand along x only if no number varies.
        None => take_own(&mut free)
            .or_else(|| take(&mut free, &ALONG_X, |setting| setting.is_number()))
            .or_else(|| take(&mut free, &AS_LINES, |_| true)),
    };
    let x = x.map_or_else(
        || "ratio".to_owned(),
        |setting| setting.column.name.to_string(),
    );
    let lines = take(&mut free, &AS_LINES, |_| true);
    let panels = take(&mut free, &AS_PANELS, |_| true);
    let mut charts = Vec::new();
    let fixed = free;
    for rows in swept.groups(&fixed, rows) {
        let place = |setting: &Setting| cells.shown(&setting.column.name, rows[0]);
        let chart = ChartSpec {
            name: format!("accuracy_by_{}{}", word(&x), name_ending(&fixed, rows[0])),
            title: title(cells, &x, [&lines, &panels], &fixed, rows[0]),
            note: "Points are means over trials; intervals are 95 % Wilson intervals at the test decisions of one trial.".to_owned(),
            table: CELLS,
            shown: base.iter().chain(&fixed).filter_map(place).collect(),
            x: x.clone(),
            y: "accuracy".to_owned(),
            lines: lines.iter().map(name_of).collect(),
            panels: panels.as_ref().map(name_of),
            rules: chance.iter().cloned().collect(),
            ..ChartSpec::default()
        };
        charts.push(chart.clone());
        if let (Some(lines), Some(panels), true) = (&lines, &panels, fixed.is_empty()) {
            charts.push(ChartSpec {
                name: format!("{}_per_{}", chart.name, word(&panels.column.name)),
                lines: vec![name_of(panels)],
                panels: Some(name_of(lines)),
                ..chart
            });
        }
    }
    charts
}

fn name_of(setting: &Setting) -> String {
    setting.column.name.to_string()
}

fn take<'a>(
    free: &mut Vec<Setting<'a>>,
    order: &[&str],
    suits: impl Fn(&Setting) -> bool,
) -> Option<Setting<'a>> {
    let of_name = |name: &&str| {
        free.iter()
            .position(|one| one.column.name == *name && suits(one))
    };
    let named = order.iter().find_map(of_name);
    // What a skin does to a signal comes after what people look for.
    let place = named.or_else(|| free.iter().position(&suits))?;
    Some(free.remove(place))
}

/// The first number that only this study has a column for.
fn take_own<'a>(free: &mut Vec<Setting<'a>>) -> Option<Setting<'a>> {
    let usual = Cell::columns();
    let is_own = |one: &Setting| usual.iter().all(|column| column.name != one.column.name);
    let place = free.iter().position(|one| one.is_number() && is_own(one))?;
    Some(free.remove(place))
}

/// `Accuracy by compression, for each pitch and array size (noise 10 %)`.
fn title(
    cells: &Table,
    x: &str,
    others: [&Option<Setting>; 2],
    fixed: &[Setting],
    row: usize,
) -> String {
    let along = cells.column(x).map_or(x, |(column, _)| &column.words);
    let mut title = format!("Accuracy by {along}");
    let others: Vec<&str> = others
        .into_iter()
        .flatten()
        .map(|setting| &setting.column.words[..])
        .collect();
    if !others.is_empty() {
        title += &format!(", for each {}", others.join(" and "));
    }
    if !fixed.is_empty() {
        let fixed: Vec<String> = fixed.iter().map(|setting| setting.phrase(row)).collect();
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
    let parts = fixed.iter().map(|setting| {
        let value = match setting.data.value(row) {
            Some(crate::table::Value::Number(number)) => setting.column.tick(number),
            _ => setting.label(row),
        };
        let plain = |letter: char| match letter {
            '.' | '-' => letter,
            _ if letter.is_ascii_alphanumeric() => letter.to_ascii_lowercase(),
            _ => '_',
        };
        let value: String = value.chars().map(plain).collect();
        format!("_{}_{value}", word(&setting.column.name))
    });
    parts.collect()
}

/// Accuracy against the time to train and to decide: one panel for each value of the first condition, one colour for each classifier or, with
/// one classifier, for each value of the first other choice that varies.
fn time_charts(cells: &Table, chance: &Option<Rule>) -> Vec<ChartSpec> {
    let all: Vec<usize> = (0..cells.n_rows).collect();
    let swept = Swept::of(cells, &all);
    let of = |role: Role| {
        swept
            .free
            .iter()
            .filter(move |setting| setting.column.role == role)
    };
    let choices = || of(Role::Choice);
    let classifier = choices().find(|setting| setting.column.name == "classifier");
    let lines = classifier.or_else(|| choices().next()).map(name_of);
    let costs = [
        (
            "pareto_training",
            "Accuracy against the time to train",
            "fit_s",
        ),
        (
            "pareto_prediction",
            "Accuracy against the time to decide on an object",
            "predict_us_per_decision",
        ),
    ];
    let chart = |(name, title, x): (&str, &str, &str)| {
        ChartSpec {
        name: name.to_owned(),
        title: title.to_owned(),
        note: "Times are means of the trials on this machine; one of training is of all training touches, one of a decision has its touches measured."
            .to_owned(),
        table: CELLS,
        x: x.to_owned(),
        y: "accuracy".to_owned(),
        lines: lines.iter().cloned().collect(),
        panels: of(Role::Condition).next().map(name_of),
        mark: Mark::Points,
        rules: chance.iter().cloned().collect(),
        front: true,
        ..ChartSpec::default()
    }
    };
    costs.map(chart).into()
}

/// What tells a cell from the others, and its accuracy.
fn words_of(cells: &Table, row: usize) -> String {
    let all: Vec<usize> = (0..cells.n_rows).collect();
    let swept = Swept::of(cells, &all);
    let accuracy = format!("accuracy {:.2}", cells.number("accuracy", row));
    let words = [
        swept.condition_words(row),
        swept.choice_words(row),
        accuracy,
    ];
    let words: Vec<String> = words
        .into_iter()
        .filter(|words| !words.is_empty())
        .collect();
    format!(" ({})", words.join(", "))
}

/// What the best cell takes for what.
fn confusion_chart(cells: &Table, confusion: &Table) -> Option<ChartSpec> {
    let accuracy = cells.numbers("accuracy")?;
    let best = (0..accuracy.len()).reduce(|a, b| if accuracy[b] > accuracy[a] { b } else { a })?;
    let cell = cells.numbers("cell")?[best];
    confusion.numbers("cell")?.contains(&cell).then(|| ChartSpec {
        name: "confusion".to_owned(),
        title: "What was taken for what".to_owned(),
        note: format!("Rows were touched, columns are what they were taken for, all trials together. Of the most accurate cell{}.", words_of(cells, best)),
        table: "confusion.csv",
        shown: vec![Shown {
            column: "cell".to_owned(),
            value: cell.into(),
        }],
        x: "predicted".to_owned(),
        y: "object".to_owned(),
        mark: Mark::Tiles {
            fill: "count".to_owned(),
            sign: None,
        },
        ..ChartSpec::default()
    })
}
