//! Charts of a recognition study.
//!
//! Every varying setting has a role in a chart, so no chart mixes configurations that differ in a setting it does not show. The x axis shows the numeric
//! setting with the most values. Lines and panels show the settings with the next most values; in a tie, texts come before numbers. Each combination of the
//! remaining settings has its own chart. If a setting applies only to some values of another setting, one line represents a pair of their values.

use crate::report::chart::Chart;
use crate::report::pictures::LINES;
use crate::report::study_folder::MAX_CHARTS;
use crate::report::swept::{Setting, Swept, without};
use crate::studies::recognition::tables::chance::ChanceLevels;
use crate::studies::recognition::tables::robustness::{LOG_RATIO, ROBUSTNESS, breaks};
use crate::studies::recognition::tables::table_files::{
    CHANCE, CHANGED, CHANGED_TO, CONFIGURATIONS, CONFUSION, OVER_FOLDS, OVER_TRIAL,
    SELECTED_TAXELS, UNCHANGED, filled, note_of_groups,
};
use crate::table::{Along, At, ChartSpec, Dot, Mark, Role, Rule, Shown, Table, Value};
use std::cmp::Reverse;

/// Charts of accuracy against the time of a decision, and against the time to train.
const TIMES: [Chart; 2] = [
    Chart {
        name: "pareto_prediction",
        title: "Accuracy against the time of a decision: {best}, within the interval of the best",
        x: "predict_us_per_decision",
        ..TIME
    },
    Chart {
        name: "pareto_training",
        title: "Accuracy against the time to train: {best}, within the interval of the best",
        x: "fit_s",
        ..TIME
    },
];

const TIME: Chart = Chart {
    table: CONFIGURATIONS,
    note: "Times are means of the trials on this machine; one of training is of all training touches, one of a decision has its touches measured.",
    y: "accuracy",
    ..Chart::FRONT
};

/// Chart of the confusions between objects in one configuration.
const CONFUSIONS: Chart = Chart {
    table: CONFUSION.name(),
    name: "confusion",
    title: "Confusion matrix",
    each: &["configuration"],
    x: "predicted",
    y: "object",
    mark: Mark::Tiles { fill: "count" },
    ..Chart::LINES
};

/// Chart of the positions of the selected taxels.
const PLACES: Chart = Chart {
    table: SELECTED_TAXELS,
    name: "selected_taxels",
    title: "Selected taxels",
    x: "x_mm",
    y: "y_mm",
    mark: Mark::Points,
    square: true,
    ..Chart::LINES
};

/// Maximum number of charts of selected taxels; further combinations of settings are only in the table.
const MAX_PLACES: usize = 4;

/// Maximum number of lines in a chart for which further settings become lines instead of charts of their own.
const MAX_LINES: usize = 6;

/// Minimum number of designs (combinations of choices) with which a study charts accuracy against the time of a decision. With as many classifiers, it also
/// charts accuracy against the time to train.
const MANY: usize = 3;

/// Returns the charts of a study: accuracy by each varying setting, accuracy against time as the second chart, and confusions of the best configuration.
/// Accuracy against time is included if there are three designs or `pareto` is `Some(true)`, but not if it is `Some(false)`.
pub fn charts(tables: &[Table], pareto: Option<bool>) -> Vec<ChartSpec> {
    let Some(configurations) = filled(tables, CONFIGURATIONS) else {
        return Vec::new();
    };
    let confusion = filled(tables, "confusion.csv");
    let summary_note = filled(tables, "summary.csv").map_or("", |table| &table.note);
    let over = match note_of_groups(configurations) {
        Some(note) => note,
        None if summary_note.contains(OVER_FOLDS) => OVER_FOLDS.to_owned(),
        None => OVER_TRIAL.to_owned(),
    };
    let chart = ChartSpec {
        note: format!("Points are means over trials. {over}"),
        table: CONFIGURATIONS,
        y: "accuracy".to_owned(),
        rules: chance(configurations, confusion).into_iter().collect(),
        ..ChartSpec::default()
    };
    let robustness = filled(tables, ROBUSTNESS.name());
    let mut charts = accuracy_charts(configurations, &chart, robustness);
    // If most settings break recognition, the places where they do are the answer; otherwise the losses are.
    let all = charts.iter().flat_map(|chart| &chart.parts);
    let all: Vec<&ChartSpec> = all.collect();
    let n_broken = all.iter().filter(|part| !part.dots.is_empty()).count();
    if 2 * n_broken <= all.len() {
        charts.splice(0..0, change_chart(configurations, &chart));
    }
    // Accuracy against time is the second chart.
    let (mut charts, mut times) = (
        charts.into_iter(),
        time_charts(configurations, pareto).into_iter(),
    );
    let first = charts.next().into_iter().chain(times.next());
    let mut charts: Vec<ChartSpec> = first.chain(charts).collect();
    let mut others: Vec<ChartSpec> = times.collect();
    others.extend(confusion.and_then(|table| confusion_chart(configurations, table)));
    others.extend(filled(tables, SELECTED_TAXELS).map_or_else(Vec::new, selected_charts));
    // Charts of accuracies are adjacent, and leave room for the other charts.
    let place = charts.len().min(MAX_CHARTS - others.len());
    charts.splice(place..place, others);
    charts
}

/// Returns a horizontal line at the chance level of the accuracy. If configurations differ in it, the line has one level per configuration.
fn chance(configurations: &Table, confusion: Option<&Table>) -> Option<Rule> {
    if configurations.numbers(CHANCE).is_some() {
        let words = "chance of each configuration";
        return Some(Rule::constant(Along::Y, At::Column(CHANCE), words));
    }
    let confusion = confusion?;
    let first = confusion.number("configuration", 0);
    let chance = ChanceLevels::new(confusion).of(first);
    Some(Rule::at(Along::Y, chance.accuracy, chance.words()))
}

/// Returns accuracy charts that together show every configuration. If settings vary one at a time, each has its own small chart, with the setting along x.
fn accuracy_charts(
    configurations: &Table,
    chart: &ChartSpec,
    robustness: Option<&Table>,
) -> Vec<ChartSpec> {
    let all = configurations.all_rows();
    let signal = Swept::of(configurations).one_at_a_time;
    if signal.is_empty() {
        let mut charts = charts_along(configurations, chart, None, &all);
        // A setting that only some classifiers have also has its own chart, over the rows that have it.
        for setting in &Swept::of(configurations).free {
            let has_it = |row: &usize| setting.data.value(*row).is_some();
            let rows: Vec<usize> = all.iter().copied().filter(has_it).collect();
            if setting.is_number() && rows.len() < all.len() && setting.levels(&rows).len() > 2 {
                charts.extend(charts_along(configurations, chart, Some(*setting), &rows));
            }
        }
        return charts;
    }
    let charts_of = |setting: &Setting| {
        let others = without(&signal, &[*setting]);
        let shown: Vec<Shown> = others.iter().map(first_value).collect();
        let mut rows = configurations.rows_shown(&shown);
        rows.retain(|&row| setting.data.value(row).is_some());
        let chart = ChartSpec {
            shown,
            ..chart.clone()
        };
        charts_along(configurations, &chart, Some(*setting), &rows)
    };
    let charts: Vec<ChartSpec> = signal.iter().flat_map(charts_of).collect();
    match charts.len() < MANY || charts.iter().any(|chart| chart.panels.is_some()) {
        true => charts,
        false => vec![sheet(configurations, chart, charts, robustness)],
    }
}

/// Returns a chart of small charts, one for each setting that is changed alone, the costliest first.
/// Their notes and dots show where the designs lose half of their accuracy above chance.
fn sheet(
    configurations: &Table,
    chart: &ChartSpec,
    mut parts: Vec<ChartSpec>,
    robustness: Option<&Table>,
) -> ChartSpec {
    let numbers = configurations.numbers("configuration").unwrap_or_default();
    let n_rows = robustness.map_or(0, |table| table.n_rows);
    for part in &mut parts {
        let Some((column, _)) = configurations.column(&part.x) else {
            continue;
        };
        part.title = column.title();
        part.log_x = is_wide(configurations.numbers(&part.x).unwrap_or_default());
        let breaks = robustness.and_then(|table| breaks(table, column));
        part.note = match breaks.as_deref() {
            None => String::new(),
            Some([]) => "never breaks".to_owned(),
            Some(at) => format!("breaks at {}", at.join(", ")),
        };
        let dot = |row: usize| {
            let table = robustness.filter(|table| table.word("condition", row) == part.x)?;
            let number = |column: &str| table.number(column, row);
            let row = numbers.iter().position(|n| *n == number("configuration"))?;
            let at = (number("half_accuracy_at"), number("half_accuracy"));
            at.0.is_finite().then_some(Dot { row, at })
        };
        part.dots = (0..n_rows).filter_map(dot).collect();
    }
    // The costliest settings come first in the column.
    let order = configurations.column(CHANGED);
    parts.sort_by_key(|part| {
        let words = configurations
            .column(&part.x)
            .map(|(column, _)| &column.words);
        let place = order.and_then(|(_, order)| order.level(words?));
        place.unwrap_or(usize::MAX)
    });
    let lines = parts
        .first()
        .map_or_else(Vec::new, |part| part.lines.clone());
    ChartSpec {
        name: "accuracy_by_setting".to_owned(),
        title: "Accuracy by each setting alone: where it breaks, half of the accuracy above chance is lost".to_owned(),
        x: "configuration".to_owned(),
        lines,
        parts,
        ..chart.clone()
    }
}

/// Returns whether the values of a setting extend over a large range, which needs a logarithmic axis.
fn is_wide(values: &[f64]) -> bool {
    let positive = values.iter().copied().filter(|&value| value > 0.0);
    let least = positive.fold(f64::INFINITY, f64::min);
    values.iter().any(|&value| value >= LOG_RATIO * least)
}

/// Rows of a study in which single settings are changed, for the design that is most accurate without a change.
pub(super) struct Changes {
    /// Filters that select the design.
    shown: Vec<Shown>,
    /// Row of the unchanged design.
    pub base: usize,
    /// Rows of the design.
    pub drawn: Vec<usize>,
}

impl Changes {
    /// Returns the rows of the best design; `None` if the study does not change single settings.
    pub fn new(configurations: &Table) -> Option<Self> {
        let accuracy = |row: usize| configurations.number("accuracy", row);
        let is_unchanged = |row: &usize| configurations.word(CHANGED, *row) == UNCHANGED;
        let unchanged = configurations.all_rows().into_iter().filter(is_unchanged);
        let base = unchanged.max_by(|&a, &b| accuracy(a).total_cmp(&accuracy(b)))?;
        let Swept {
            free,
            one_at_a_time,
            ..
        } = Swept::of(configurations);
        let others = without(&free, &one_at_a_time);
        let shown = others.iter();
        let shown = shown.filter_map(|one| configurations.shown(&one.column.name, base));
        let shown: Vec<Shown> = shown.collect();
        let drawn = configurations.rows_shown(&shown);
        Some(Self { shown, base, drawn })
    }
}

/// Returns a chart with one row for each setting that is changed alone, sorted by the accuracy that it costs at most: the accuracy at each of its values.
/// Returns `None` for other studies.
fn change_chart(configurations: &Table, chart: &ChartSpec) -> Option<ChartSpec> {
    let Changes { shown, base, .. } = Changes::new(configurations)?;
    let accuracy = |row: usize| configurations.number("accuracy", row);
    let [low, high] = configurations.interval(configurations.column("accuracy")?.0, base)?;
    let words = format!("unchanged, {:.2}, and its 95 % interval", accuracy(base));
    let unchanged = |at: f64| Rule::at(Along::X, at, words.clone());
    let mut rules: Vec<Rule> = [accuracy(base), low, high].map(unchanged).into();
    if let Some(&Rule {
        at: At::Value(chance),
        ..
    }) = chart.rules.first()
    {
        let half = 0.5 * (chance + accuracy(base));
        let words = "half of the accuracy above chance is lost";
        rules.push(Rule::at(Along::X, half, words));
    }
    Some(ChartSpec {
        name: "accuracy_by_change".to_owned(),
        title: "Accuracy with each setting changed alone, the costliest at the top".to_owned(),
        x: "accuracy".to_owned(),
        y: CHANGED.to_owned(),
        label: Some(CHANGED_TO.to_owned()),
        mark: Mark::Points,
        shown,
        rules,
        ..chart.clone()
    })
}

/// Returns charts whose x axis is the given setting; if none is given, the main setting of the study. If only lines show a setting of numbers and no other setting
/// remains, a second chart has it along x.
fn charts_along(
    configurations: &Table,
    chart: &ChartSpec,
    x: Option<Setting>,
    rows: &[usize],
) -> Vec<ChartSpec> {
    let swept = Swept::new(configurations, rows);
    let x = x.or_else(|| swept.main(rows));
    let mut others = without(&swept.free, x.as_slice());
    // A setting that is a text and applies only to some rows, such as the method of a selection, divides the lines of another setting.
    let is_part = |one: &Setting| !one.is_number() && !one.applies(rows);
    let parts: Vec<Setting> = others.iter().copied().filter(is_part).collect();
    others.retain(|one| !is_part(one));
    others.sort_by_key(|one| (Reverse(one.levels(rows).len()), one.is_number()));
    let (used, mut fixed) = others.split_at(others.len().min(2));
    let [lines, panels] = [used.first(), used.get(1)].map(|one| one.map(name_of));
    // Few further settings become lines, too.
    let n_levels = |settings: &[Setting]| -> usize {
        let levels = settings.iter().map(|one| one.levels(rows).len());
        levels.product()
    };
    let folded = match used.first() {
        Some(one) if n_levels(&[*one]) * n_levels(fixed) <= MAX_LINES => std::mem::take(&mut fixed),
        _ => &[],
    };
    let parts = [folded, &parts].concat();
    let with_parts = |one: Option<String>| one.into_iter().chain(parts.iter().map(name_of));
    let n_along = x.map_or(0, |x| x.levels(rows).len());
    let x = x.map_or_else(|| "ratio".to_owned(), |x| name_of(&x));
    let along = |x: &str, lines: Vec<String>| ChartSpec {
        lines,
        panels: panels.clone(),
        shown: chart.shown.clone(),
        rules: chart.rules.clone(),
        note: chart.note.clone(),
        ..configurations.chart(
            format!("accuracy_by_{}", word(x)),
            "Accuracy by {x}",
            ("accuracy", x),
        )
    };
    let main = along(&x, with_parts(lines.clone()).collect());
    let mut charts: Vec<ChartSpec> = for_each(configurations, rows, fixed, main).collect();
    let is_axis = others
        .first()
        .is_some_and(|one| one.is_number() && one.applies(rows));
    let is_whole = fixed.is_empty() && parts.is_empty();
    if is_whole && is_axis && n_along <= LINES.len() && panels.is_none() {
        charts.extend(lines.map(|lines| along(&lines, vec![x])));
    }
    charts
}

/// Returns a copy of a chart for each combination of the values of some settings, which stand in its file name and its title.
fn for_each(
    table: &Table,
    rows: &[usize],
    settings: &[Setting],
    chart: ChartSpec,
) -> impl Iterator<Item = ChartSpec> {
    let groups = Setting::groups(settings, table, rows).into_iter();
    groups.map(move |rows| {
        let row = rows[0];
        let here = settings
            .iter()
            .filter_map(|one| table.shown(&one.column.name, row));
        let words: Vec<String> = settings.iter().map(|one| one.phrase(row)).collect();
        ChartSpec {
            name: chart.name.clone() + &name_ending(settings, row),
            title: match &words.join(", ")[..] {
                "" => chart.title.clone(),
                words => format!("{} ({words})", chart.title),
            },
            shown: chart.shown.iter().cloned().chain(here).collect(),
            ..chart.clone()
        }
    })
}

fn name_of(setting: &Setting) -> String {
    setting.column.name.to_string()
}

/// Returns a column name in the form that the file names of charts use.
fn word(column: &str) -> &str {
    match column {
        "pitch_mm" | "size_mm" | "smoothing_mm" => column.trim_end_matches("_mm"),
        "noise_std" => "noise",
        other => other,
    }
}

/// Returns a suffix of a file name, such as `_noise_10_ensemble_sbhe`; it contains only letters, digits, points and underscores.
fn name_ending(fixed: &[Setting], row: usize) -> String {
    let plain = |letter: char| match letter {
        '.' | '-' => letter,
        _ if letter.is_ascii_alphanumeric() => letter.to_ascii_lowercase(),
        _ => '_',
    };
    let parts = fixed.iter().map(|setting| {
        let value = match setting.data.value(row) {
            Some(Value::Number(number)) => setting.column.tick(number),
            Some(Value::Word(word)) => word,
            None => setting.label(row),
        };
        let value: String = value.chars().map(plain).collect();
        format!("_{}_{value}", word(&setting.column.name))
    });
    parts.collect()
}

/// Returns charts of accuracy against the time of a decision and, if classifiers are compared, against training time. Each value of the first condition has a
/// panel. Colours show the classifier or, if there is one, the choice on whose values the mean accuracy depends most. If conditions vary one at a time, the
/// charts have the first value of each.
fn time_charts(configurations: &Table, pareto: Option<bool>) -> Vec<ChartSpec> {
    let mut alone = Swept::of(configurations).one_at_a_time;
    alone.retain(|one| one.column.role == Role::Condition);
    let shown: Vec<Shown> = alone.iter().map(first_value).collect();
    let rows = configurations.rows_shown(&shown);
    let n_groups = |columns: &[&str]| configurations.groups(columns, rows.iter().copied()).len();
    let is_asked = |n: usize| pareto.unwrap_or(n >= MANY);
    if !is_asked(n_groups(&configurations.of_role(Role::Choice))) {
        return Vec::new();
    }
    let free = Swept::new(configurations, &rows).free;
    let of = |role: Role| free.iter().filter(move |one| one.column.role == role);
    let spread = |one: &&Setting| {
        let groups = Setting::groups(&[**one], configurations, &rows);
        let accuracy = |row: &usize| configurations.number("accuracy", *row);
        let means = groups
            .iter()
            .map(|rows| rows.iter().map(accuracy).sum::<f64>() / rows.len() as f64);
        means.clone().fold(0.0, f64::max) - means.fold(1.0, f64::min)
    };
    let classifier = of(Role::Choice).find(|one| one.column.name == "classifier");
    let few = of(Role::Choice).filter(|one| one.levels(&rows).len() <= LINES.len());
    let lines = classifier.or_else(|| few.max_by(|a, b| spread(a).total_cmp(&spread(b))));
    let n_costs = 1 + usize::from(is_asked(n_groups(&["classifier"])));
    let charts = TIMES.iter().take(n_costs).map(|chart| ChartSpec {
        shown: shown.clone(),
        lines: lines.map(name_of).into_iter().collect(),
        panels: of(Role::Condition).next().map(name_of),
        ..chart.spec(configurations, &rows)
    });
    charts.collect()
}

/// Returns the filter of the rows in which a setting has the value of the first row of its table.
fn first_value(setting: &Setting) -> Shown {
    let value = setting.data.value(0);
    Shown::new(name_of(setting), value.unwrap_or_else(|| "".into()))
}

/// Returns the row of the most accurate configuration; the first one if several are equal.
pub(super) fn best_row(configurations: &Table) -> Option<usize> {
    let accuracy = configurations.numbers("accuracy")?;
    (0..accuracy.len()).reduce(|a, b| if accuracy[b] > accuracy[a] { b } else { a })
}

/// Returns a chart of the confusions between objects in the best configuration; `None` if it confuses none.
fn confusion_chart(configurations: &Table, confusion: &Table) -> Option<ChartSpec> {
    let best = best_row(configurations)?;
    let accuracy = configurations.number("accuracy", best);
    if accuracy == 1.0 {
        return None;
    }
    let configuration = configurations.number("configuration", best);
    let mut rows = confusion.all_rows().into_iter();
    let row = rows.find(|&row| confusion.number("configuration", row) == configuration)?;
    let swept = Swept::of(configurations);
    let mut words = vec![swept.condition_words(best), swept.choice_words(best)];
    words.retain(|words| !words.is_empty());
    words.push(format!("accuracy {accuracy:.2}"));
    Some(ChartSpec {
        note: format!(
            "Rows: touched object; columns: recognised object; all trials together. Most accurate configuration ({}).",
            words.join(", ")
        ),
        ..CONFUSIONS.spec(confusion, &[row])
    })
}

/// Returns charts of the positions of the selected taxels. Colours show the method, panels show the first condition, and each combination of the other settings
/// has its own chart.
fn selected_charts(selected: &Table) -> Vec<ChartSpec> {
    let mut rows = selected.all_rows();
    rows.retain(|&row| selected.number("x_mm", row).is_finite());
    let swept = Swept::new(selected, &rows);
    let mut free = swept.free.iter().copied();
    let method = free.clone().find(|one| one.column.name == "selection");
    let condition = free.find(|one| one.column.role == Role::Condition);
    let others = without(&swept.free, method.as_slice());
    let fixed = without(&others, condition.as_slice());
    let chart = ChartSpec {
        lines: method.as_ref().map(name_of).into_iter().collect(),
        panels: condition.as_ref().map(name_of),
        ..PLACES.spec(selected, &rows)
    };
    let charts = for_each(selected, &rows, &fixed, chart);
    charts.take(MAX_PLACES).collect()
}
