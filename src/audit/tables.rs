//! Tables and charts of an audit.

use crate::audit::claim::Claim;
use crate::audit::context::Context;
use crate::audit::finding::Finding;
use crate::audit::readings::{N_BLOCKS, TaxelState};
use crate::audit::sources::SourceResult;
use crate::audit::splits::METHODS;
use crate::error::Result;
use crate::row;
use crate::table::{Along, ChartSpec, File, Mark, Rule, Table};
use bubbletouch_sim::audit::taxels::levels;

const SPLITS: &[(&str, &str)] = &[
    ("time", "blocks of time"),
    ("group", "groups"),
    ("session", "sessions"),
    ("given", "given test set"),
    ("random_as_time", "at random, sizes of blocks"),
    ("random_as_group", "at random, sizes of groups"),
    ("random_as_session", "at random, sizes of sessions"),
    ("random_as_given", "at random, sizes of the test set"),
];
const LABELS: &[(&str, &str)] = &[
    ("given", "given labels"),
    ("exchanged", "exchanged labels, up to 95 %"),
];

row! {
/// Accuracy of a classifier by a split.
pub struct SplitRow {
    /// Touches that are held out; `random_as_group` is the random split of which each fold has as many touches of each class as the split by groups.
    split: String => Condition "held out" named SPLITS;
    /// Classifier.
    method: String => Choice named METHODS;
    /// Fraction of held-out touches that are recognised.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Lower end of the 95 % interval of the accuracy, over groups if there are any.
    accuracy_low: f64 => Note: Share;
    /// Upper end of the 95 % interval of the accuracy.
    accuracy_high: f64 => Note: Share;
    /// Number of tested touches.
    n_tested: usize => Note "touches": Linear;
} }

row! {
/// Accuracy with which the class can be read from a source.
pub struct SourceRow {
    /// Source of the features.
    source: String => Choice;
    /// Labels: as given, or exchanged.
    labels: String => Condition named LABELS;
    /// Fraction of touches whose class is predicted correctly from other units. The touches of each unit and class together have the same weight.
    accuracy: f64 => Value(Neither): Share between [accuracy_low, accuracy_high];
    /// Accuracy; for exchanged labels, the mean accuracy.
    accuracy_low: f64 => Note: Share;
    /// Accuracy; for exchanged labels, the 95 % quantile of the accuracy.
    accuracy_high: f64 => Note: Share;
    /// Probability of at least this accuracy if source and label are independent.
    p_value: Option<f64> => Note "p": Log;
} }

row! {
/// Taxel of the recorded skin.
pub struct TaxelRow {
    /// Number of the taxel, from 0, row by row.
    taxel: usize => Subject: Linear;
    /// State: working, constant, stuck or equal.
    state: TaxelState => Outcome;
    /// Mean reading.
    mean: f64 => Value(Neither): Linear;
    /// Standard deviation of the readings.
    std: f64 => Value(Neither): Linear;
    /// Smallest reading.
    least: f64 => Note: Linear;
    /// Largest reading.
    largest: f64 => Note: Linear;
    /// Number of missing readings.
    n_missing: usize => Note "missing": Linear;
} }

row! {
/// Touch to look at: a copy, or a touch with a doubtful label.
pub struct DoubtfulRow {
    /// Number of the touch in the file of the frames, from 0, also if the audit sorts the touches by time. The touches of a given test set, and of further files
    /// of a folder in the order of their names, follow.
    touch: usize => Subject: Linear;
    /// Class of the touch.
    class: String => Subject;
    /// Reason: copy or doubtful_label.
    reason: String => Outcome;
    /// Number of the touch of which it is a copy.
    other_touch: Option<usize> => Note "other touch": Linear;
    /// Class of the other touch, or the class that the classifier gives.
    other_class: String => Note "other class";
} }

row! {
/// Mean level of a block of touches.
pub struct LevelRow {
    /// Middle of the block in the order of recording, as a fraction of the touches.
    place: f64 => Condition "place in the file": Share;
    /// Quantity: level or contact.
    quantity: String => Choice;
    /// Mean over the block. Level: median over the taxels of the reading less the mean of its class, as a fraction of the range of the readings. Contact:
    /// logarithm of the size of the deviation from rest, less the mean of the class.
    level: f64 => Value(Neither) "change": Linear;
} }

/// Results of all checks, from which the tables are made.
pub struct Results<'a> {
    pub findings: &'a [Finding],
    pub claim: &'a Claim,
    pub sources: &'a [SourceResult],
    pub states: &'a [TaxelState],
}

/// Returns the tables of an audit. The first one contains the findings.
///
/// # Errors
/// If an interval cannot be computed.
pub fn tables(context: &Context, results: &Results) -> Result<Vec<Table>> {
    let findings = File::new("findings.csv", "Findings", "");
    let accuracy = File::new(
        "accuracy_by_split.csv",
        "Accuracy of fast classifiers by split",
        "Each split stands beside the random split that trains on equally many touches of each class. Intervals are over groups if there are any.",
    );
    let sources = File::new(
        "sources.csv",
        "Classes read from single sources",
        "A source names the class if its accuracy exceeds that of exchanged labels.",
    );
    let note = "Means of blocks of consecutive touches, less the means of the classes.";
    let levels = File::new("levels.csv", "Level in the order of recording", note);
    let rows = File::new("rows.csv", "Touches to look at", "");
    let note = "Statistics over at most 2,000 frames.";
    let taxels = File::new("taxels.csv", "Taxels", note);
    let mut tables = vec![findings.table(results.findings)?];
    if context.has_classes {
        tables.push(accuracy.table(&split_rows(context)?)?);
        tables.push(sources.table(&source_rows(results.sources))?);
    }
    tables.push(levels.table(&level_rows(context))?);
    tables.push(rows.table(&doubtful_rows(context, results.claim))?);
    tables.push(taxels.table(&taxel_rows(context, results.states))?);
    Ok(tables)
}

fn split_rows(context: &Context) -> Result<Vec<SplitRow>> {
    let rows = context.tested.iter().map(|tested| {
        let split = &context.splits[tested.split];
        let interval = tested.interval(split)?;
        Ok(SplitRow {
            split: match tested.is_held_out {
                true => split.name.to_owned(),
                false => format!("random_as_{}", split.name),
            },
            method: tested.method.to_owned(),
            accuracy: tested.accuracy(),
            accuracy_low: interval.low,
            accuracy_high: interval.high,
            n_tested: tested.is_correct.iter().flatten().count(),
        })
    });
    rows.collect()
}

fn source_rows(sources: &[SourceResult]) -> Vec<SourceRow> {
    let rows = sources.iter().flat_map(|SourceResult { found, finding }| {
        let row = |labels: &str, accuracy: f64, high: f64, p_value: Option<f64>| SourceRow {
            source: finding.check.clone(),
            labels: labels.to_owned(),
            accuracy,
            accuracy_low: accuracy,
            accuracy_high: high,
            p_value,
        };
        let permuted = found.permuted;
        [
            row(
                "given",
                found.accuracy,
                found.accuracy,
                Some(permuted.p_value),
            ),
            row("exchanged", permuted.mean, permuted.bound, None),
        ]
    });
    rows.collect()
}

fn doubtful_rows(context: &Context, claim: &Claim) -> Vec<DoubtfulRow> {
    let name = |class: usize| context.data.classes.get(class).cloned().unwrap_or_default();
    let number = |touch: usize| context.data.number_in_file(touch);
    let copies = claim.copies.iter().flat_map(|set| {
        let others = |row: usize| set.rows.iter().copied().filter(move |&other| other != row);
        set.rows
            .iter()
            .flat_map(move |&row| others(row).map(move |other| (row, other)))
    });
    let copies = copies.map(|(touch, other)| DoubtfulRow {
        touch: number(touch),
        class: name(context.labels[touch]),
        reason: "copy".to_owned(),
        other_touch: Some(number(other)),
        other_class: name(context.labels[other]),
    });
    let doubtful = claim.doubtful.iter().map(|doubtful| DoubtfulRow {
        touch: number(doubtful.touch),
        class: name(context.labels[doubtful.touch]),
        reason: "doubtful_label".to_owned(),
        other_touch: None,
        other_class: name(doubtful.class),
    });
    copies.chain(doubtful).collect()
}

fn taxel_rows(context: &Context, states: &[TaxelState]) -> Vec<TaxelRow> {
    let taxels = context.taxels.iter().enumerate();
    let rows = taxels.map(|(taxel, readings)| TaxelRow {
        taxel,
        state: states[taxel],
        mean: readings.mean,
        std: readings.std,
        least: readings.least,
        largest: readings.largest,
        n_missing: context.n_missing[taxel],
    });
    rows.collect()
}

fn level_rows(context: &Context) -> Vec<LevelRow> {
    let n = context.labels.len();
    let n_blocks = N_BLOCKS.min(n);
    let mut rows = Vec::new();
    for ((quantity, values), scale) in ["level", "contact"]
        .iter()
        .zip(levels(context.means.view(), &context.labels))
        .zip([context.range(), 1.0])
    {
        for block in 0..n_blocks {
            let own = &values[block * n / n_blocks..(block + 1) * n / n_blocks];
            rows.push(LevelRow {
                place: (block as f64 + 0.5) / n_blocks as f64,
                quantity: (*quantity).to_owned(),
                level: own.iter().sum::<f64>() / own.len() as f64 / scale,
            });
        }
    }
    rows
}

/// Returns the charts of an audit.
pub fn charts(context: &Context, tables: &[Table]) -> Vec<ChartSpec> {
    let table = |file: &str| tables.iter().find(|table| table.file == file);
    let mut charts = Vec::new();
    if let Some(accuracy) = table("accuracy_by_split.csv") {
        let title = "Accuracy by split";
        charts.push(ChartSpec {
            lines: vec!["method".to_owned()],
            mark: Mark::Points,
            rules: vec![Rule::at(Along::Y, context.chance(), "most frequent class")],
            ..accuracy.chart("accuracy_by_split", title, ("accuracy", "split"))
        });
    }
    if let Some(sources) = table("sources.csv").filter(|table| table.n_rows > 0) {
        let title = "Classes read from single sources";
        charts.push(ChartSpec {
            lines: vec!["labels".to_owned()],
            mark: Mark::Points,
            ..sources.chart("sources", title, ("accuracy", "source"))
        });
    }
    if let Some(levels) = table("levels.csv").filter(|table| table.n_rows > 0) {
        charts.push(ChartSpec {
            lines: vec!["quantity".to_owned()],
            ..levels.chart(
                "levels",
                "Level in the order of recording",
                ("level", "place"),
            )
        });
    }
    charts
}
