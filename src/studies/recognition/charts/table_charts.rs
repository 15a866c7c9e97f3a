//! Charts of a recognition study.
//!
//! Every varying setting has a role in a chart, so no chart mixes configurations that differ in a setting it does not show. The x axis shows the numeric
//! setting with the most values. Lines and panels show the settings with the next most values; in a tie, texts come before numbers. Each combination of the
//! remaining settings has its own chart. If a setting applies only to some values of another setting, one line represents a pair of their values.

use crate::report::study_folder::MAX_CHARTS;
use crate::report::swept::{Setting, Swept, without};
use crate::studies::recognition::charts::chance::ChanceLevels;
use crate::studies::recognition::charts::filled::filled;
use crate::studies::recognition::charts::tables::{
    CHANCE, CONFIGURATIONS, OVER_FOLDS, OVER_TRIAL, SELECTED_TAXELS, note_of_groups,
};
use crate::table::{Along, At, ChartSpec, Mark, Role, Rule, Shown, Table, Value};
use std::cmp::Reverse;

/// Maximum number of charts of selected taxels; further combinations of settings are only in the table.
const MAX_PLACES: usize = 4;

/// Minimum number of classifiers with which a study counts as a comparison of classifiers, and charts accuracy against time.
const MANY_CLASSIFIERS: usize = 3;

/// Returns the charts of a study: accuracy by each varying setting, confusions of the best configuration, and accuracy against time. Accuracy against time is
/// included if classifiers are compared or `pareto` is `Some(true)`.
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
    let mut charts = accuracy_charts(configurations, &chart);
    let n_classifiers = configurations
        .groups(&["classifier"], 0..configurations.n_rows)
        .len();
    let mut others = Vec::new();
    if pareto.unwrap_or(n_classifiers >= MANY_CLASSIFIERS) {
        others.extend(time_charts(configurations, &chart));
    }
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
        return Some(Rule {
            along: Along::Y,
            at: At::Column(CHANCE.to_owned()),
            words: "chance of each configuration".to_owned(),
        });
    }
    let confusion = confusion?;
    let first = confusion.number("configuration", 0);
    let chance = ChanceLevels::new(confusion).of(first);
    Some(Rule::at(Along::Y, chance.accuracy, chance.words()))
}

/// Returns accuracy charts that together show every configuration. If signal settings vary one at a time, each has its own chart, with the setting along x.
fn accuracy_charts(configurations: &Table, chart: &ChartSpec) -> Vec<ChartSpec> {
    let all: Vec<usize> = (0..configurations.n_rows).collect();
    let signal = Swept::new(configurations, &all).one_at_a_time;
    if signal.is_empty() {
        let mut charts = charts_along(configurations, chart, None, &all);
        // A setting that only some classifiers have also has its own chart, over the rows that have it.
        for setting in &Swept::new(configurations, &all).free {
            let has_it = |row: &usize| setting.data.value(*row).is_some();
            let rows: Vec<usize> = all.iter().copied().filter(has_it).collect();
            if setting.is_number() && rows.len() < all.len() && setting.levels(&rows).len() > 2 {
                charts.extend(charts_along(configurations, chart, Some(*setting), &rows));
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
        charts_along(configurations, &chart, Some(*setting), &rows)
    };
    signal.iter().flat_map(charts_of).collect()
}

/// Returns charts whose x axis is the given setting; if none is given, the main setting of the study. If lines and panels show settings and no other setting
/// remains, a second chart exchanges the two. The effects of both settings can then be read from lines within one panel.
fn charts_along(
    configurations: &Table,
    chart: &ChartSpec,
    x: Option<Setting>,
    rows: &[usize],
) -> Vec<ChartSpec> {
    let swept = Swept::new(configurations, rows);
    let x = x.or_else(|| swept.main(rows));
    let mut others = x.map_or_else(|| swept.free.clone(), |x| without(&swept.free, &x));
    // A setting that is a text and applies only to some rows, such as the method of a selection, divides the lines of another setting.
    let is_part = |one: &Setting| !one.is_number() && !one.applies(rows);
    let parts: Vec<Setting> = others.iter().copied().filter(is_part).collect();
    others.retain(|one| !is_part(one));
    others.sort_by_key(|one| (Reverse(one.levels(rows).len()), one.is_number()));
    let (used, fixed) = others.split_at(others.len().min(2));
    let [lines, panels] = [used.first(), used.get(1)].map(|one| one.map(name_of));
    let with_parts = |one: Option<String>| one.into_iter().chain(parts.iter().map(name_of));
    let x = x.map_or_else(|| "ratio".to_owned(), |x| name_of(&x));
    let of_rows = |rows: Vec<usize>| {
        let here = fixed.iter().map(|one| &one.column.name);
        let here = here.filter_map(|name| configurations.shown(name, rows[0]));
        ChartSpec {
            name: format!("accuracy_by_{}{}", word(&x), name_ending(fixed, rows[0])),
            title: title(configurations, &x, (used, fixed), rows[0]),
            shown: chart.shown.iter().cloned().chain(here).collect(),
            x: x.clone(),
            lines: with_parts(lines.clone()).collect(),
            panels: panels.clone(),
            ..chart.clone()
        }
    };
    let mut charts: Vec<ChartSpec> = swept.groups(fixed, rows).into_iter().map(of_rows).collect();
    if let (Some(panels), true) = (panels, fixed.is_empty() && parts.is_empty()) {
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

/// Returns the title of a chart, such as `Accuracy by compression, for each pitch and array size (noise 10 %)`.
fn title(
    configurations: &Table,
    x: &str,
    (used, fixed): (&[Setting], &[Setting]),
    row: usize,
) -> String {
    let along = configurations
        .column(x)
        .map_or(x, |(column, _)| &column.words);
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
            _ => setting.label(row),
        };
        let value: String = value.chars().map(plain).collect();
        format!("_{}_{value}", word(&setting.column.name))
    });
    parts.collect()
}

/// Returns two charts: accuracy against training time, and accuracy against prediction time. Each value of the first condition has a panel, and each classifier
/// has a colour. If there is only one classifier, colours show the values of the first other varying setting.
fn time_charts(configurations: &Table, chart: &ChartSpec) -> [ChartSpec; 2] {
    let all: Vec<usize> = (0..configurations.n_rows).collect();
    let free = Swept::new(configurations, &all).free;
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

/// Returns a chart of the confusions between objects in the best configuration.
fn confusion_chart(configurations: &Table, confusion: &Table) -> Option<ChartSpec> {
    let accuracy = configurations.numbers("accuracy")?;
    let best = (0..accuracy.len()).reduce(|a, b| if accuracy[b] > accuracy[a] { b } else { a })?;
    let configuration = configurations.number("configuration", best);
    let mut cells_there = confusion.numbers("configuration")?.iter();
    let row = cells_there.position(|known| *known == configuration)?;
    let all: Vec<usize> = (0..configurations.n_rows).collect();
    let swept = Swept::new(configurations, &all);
    let mut words = vec![swept.condition_words(best), swept.choice_words(best)];
    words.retain(|words| !words.is_empty());
    words.push(format!("accuracy {:.2}", accuracy[best]));
    Some(ChartSpec {
        note: format!(
            "Rows: touched object; columns: recognised object; all trials together. Most accurate configuration ({}).",
            words.join(", ")
        ),
        shown: confusion.shown("configuration", row).into_iter().collect(),
        mark: Mark::Tiles {
            fill: "count".to_owned(),
            sign: None,
        },
        ..confusion.chart("confusion", "Confusion matrix", ("object", "predicted"))
    })
}

/// Returns charts of the positions of the selected taxels. Colours show the method, panels show the first condition, and each combination of the other settings
/// has its own chart.
fn selected_charts(selected: &Table) -> Vec<ChartSpec> {
    let rows: Vec<usize> = (0..selected.n_rows).collect();
    let has_place = |row: &usize| selected.number("x_mm", *row).is_finite();
    let rows: Vec<usize> = rows.into_iter().filter(has_place).collect();
    let swept = Swept::new(selected, &rows);
    let of = |wanted: &dyn Fn(&Setting) -> bool| swept.free.iter().find(|one| wanted(one)).copied();
    let method = of(&|one| one.column.name == "selection");
    let condition = of(&|one| one.column.role == Role::Condition);
    let is_fixed = |one: &&Setting| {
        let mut used = [method, condition].into_iter().flatten();
        used.all(|used| used.column.name != one.column.name)
    };
    let fixed: Vec<Setting> = swept.free.iter().filter(is_fixed).copied().collect();
    let chart = |rows: Vec<usize>| {
        let here = fixed.iter().map(|one| &one.column.name);
        let words: Vec<String> = fixed.iter().map(|one| one.phrase(rows[0])).collect();
        let title = match words.is_empty() {
            true => "Selected taxels".to_owned(),
            false => format!("Selected taxels ({})", words.join(", ")),
        };
        ChartSpec {
            shown: here
                .filter_map(|name| selected.shown(name, rows[0]))
                .collect(),
            lines: method.as_ref().map(name_of).into_iter().collect(),
            panels: condition.as_ref().map(name_of),
            mark: Mark::Points,
            ..selected.chart(
                format!("selected_taxels{}", name_ending(&fixed, rows[0])),
                title,
                ("y_mm", "x_mm"),
            )
        }
    };
    let groups = swept.groups(&fixed, &rows).into_iter();
    groups
        .filter(|rows| !rows.is_empty())
        .take(MAX_PLACES)
        .map(chart)
        .collect()
}
