//! Tables and charts of an audit.

use crate::audit::checks::{SOURCES, dead_taxels, drift, hot_taxels, label_noise, near_duplicates};
use crate::audit::context::Context;
use crate::audit::finding::{Finding, Verdict};
use crate::audit::scores::METHODS;
use crate::audit::splits::touches_of_classes;
use crate::error::Result;
use crate::row;
use crate::table::{Along, ChartSpec, File, Mark, Rule, Table};
use ndarray::Axis;

const VERDICTS: &[(&str, &str)] = &[("not_checked", "not checked")];
const SPLITS: &[(&str, &str)] = &[
    ("random", "random"),
    ("time", "blocks of time"),
    ("group", "groups"),
    ("session", "sessions"),
    ("given", "given test set"),
];
const LABELS: &[(&str, &str)] = &[
    ("given", "given labels"),
    ("permuted", "permuted labels, up to 95 %"),
];

row! {
/// Finding of an audit.
pub struct FindingRow {
    /// Name of the check.
    check: String => Choice;
    /// Part of the data that the finding is about; empty if it is about all data.
    subject: String => Choice;
    /// Verdict: fault, note, passed or not_checked.
    verdict: String => Outcome named VERDICTS;
    /// Measured number; its meaning is in the sentence.
    value: Option<f64> => Value(Neither): Linear between [value_low, value_high];
    /// Lower end of the 95 % interval of the value.
    value_low: Option<f64> => Note: Linear;
    /// Upper end of the 95 % interval of the value.
    value_high: Option<f64> => Note: Linear;
    /// Value without the fault, such as the accuracy by chance.
    baseline: Option<f64> => Note: Linear;
    /// p-value of the test; empty for counts.
    p_value: Option<f64> => Note "p": Log;
    /// p-value after Holm's correction over all tests of the audit.
    p_holm: Option<f64> => Note "p, Holm": Log;
    /// Result of the check in one or two sentences.
    sentence: String => Note;
    /// Recommended action against a fault.
    advice: String => Note;
} }

row! {
/// Accuracy of a classifier by a split.
pub struct SplitRow {
    /// Touches that are held out.
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
/// Accuracy with which the label can be read from a source other than the contact.
pub struct ConfoundRow {
    /// Source of the features.
    source: String => Choice;
    /// Labels: as given, or permuted.
    labels: String => Condition named LABELS;
    /// Fraction of touches whose class is predicted correctly from the other touches.
    accuracy: f64 => Value(Neither): Share between [accuracy_low, accuracy_high];
    /// Accuracy; for permuted labels, the mean accuracy.
    accuracy_low: f64 => Note: Share;
    /// Accuracy; for permuted labels, the 95 % quantile of the accuracy.
    accuracy_high: f64 => Note: Share;
    /// Probability of at least this accuracy if source and label are independent; empty for sources without a finding of their own.
    p_value: Option<f64> => Note "p": Log;
} }

row! {
/// Taxel of the recorded skin.
pub struct TaxelRow {
    /// Number of the taxel, from 0, row by row.
    taxel: usize => Subject: Linear;
    /// State: working, dead, stuck, hot or untouched.
    state: String => Outcome;
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
/// Class of the labels.
pub struct ClassRow {
    /// Name of the class.
    class: String => Subject;
    /// Number of touches.
    n_touches: usize => Value(Neither) "touches": Linear;
    /// Fraction of the touches that the best classifier recognises by the random split.
    accuracy: f64 => Value(More): Share;
} }

row! {
/// Touch to inspect: a near-duplicate, or a touch with a doubtful label.
pub struct DoubtfulRow {
    /// Number of the touch in the file of the frames, from 0, also if the audit sorts the touches by time. The touches of a given test set, and of further files
    /// of a folder in the order of their names, follow.
    touch: usize => Subject: Linear;
    /// Class of the touch.
    class: String => Subject;
    /// Reason: near_duplicate or doubtful_label.
    reason: String => Outcome;
    /// Number of the touch of which it is a near-duplicate.
    other_touch: Option<usize> => Note "other touch": Linear;
    /// Class of the other touch, or the class that the classifier gives.
    other_class: String => Note "other class";
} }

row! {
/// Mean level of a block of touches.
pub struct LevelRow {
    /// Middle of the block in the order of recording, as a fraction of the touches.
    place: f64 => Condition "place in the file": Share;
    /// Taxels over which the mean is taken: all, or untouched ones.
    taxels: String => Choice;
    /// Mean reading less the mean over the touches of the class, as a fraction of the full scale.
    level: f64 => Value(Neither) "level, of full scale": Linear;
} }

const FINDINGS: File<FindingRow> = File::new("findings.csv", "Findings", "");
const ACCURACY: File<SplitRow> = File::new(
    "accuracy_by_split.csv",
    "Accuracy of cheap classifiers by split",
    "Intervals are over groups if there are any. If the lines cross, the order of the methods depends on the split.",
);
const CONFOUNDS: File<ConfoundRow> = File::new(
    "confounds.csv",
    "Classes read from sources other than the contact",
    "A source that names the class more often than permuted labels is a confound, unless it is the contact itself (shape, mean).",
);
const TAXELS: File<TaxelRow> = File::new(
    "taxels.csv",
    "Taxels",
    "Statistics over at most 2,000 frames.",
);
const CLASSES: File<ClassRow> = File::new("classes.csv", "Classes", "");
const ROWS: File<DoubtfulRow> = File::new("rows.csv", "Touches to look at", "");
const LEVELS: File<LevelRow> = File::new(
    "levels.csv",
    "Level in the order of recording",
    "Mean of blocks of touches, less the means of the classes. Untouched taxels show drift; all taxels also show changes of the contact.",
);

/// Number of blocks of touches in the table of levels.
const N_LEVELS: usize = 20;

/// Returns the tables of an audit; the first one lists the findings.
pub fn tables(context: &Context, findings: &[Finding]) -> Result<Vec<Table>> {
    let known = |number: f64| number.is_finite().then_some(number);
    let finding_rows: Vec<FindingRow> = findings
        .iter()
        .map(|finding| FindingRow {
            check: finding.check.to_owned(),
            subject: finding.subject.clone(),
            verdict: finding.verdict.word().to_owned(),
            value: known(finding.value),
            value_low: known(finding.interval[0]),
            value_high: known(finding.interval[1]),
            baseline: known(finding.baseline),
            p_value: finding.p_value,
            p_holm: finding.p_holm,
            sentence: finding.sentence.clone(),
            advice: finding.advice.clone(),
        })
        .collect();
    let mut tables = vec![FINDINGS.table(&finding_rows)?];
    if context.has_classes() {
        tables.push(ACCURACY.table(&split_rows(context)?)?);
        tables.push(CONFOUNDS.table(&confound_rows(context))?);
        tables.push(CLASSES.table(&class_rows(context))?);
    }
    tables.push(LEVELS.table(&level_rows(context))?);
    tables.push(ROWS.table(&doubtful_rows(context))?);
    tables.push(TAXELS.table(&taxel_rows(context))?);
    Ok(tables)
}

fn split_rows(context: &Context) -> Result<Vec<SplitRow>> {
    let tested = context.scores.iter().flat_map(|scores| &scores.tested);
    let rows = tested.map(|tested| {
        let split = &context.splits[tested.split];
        let interval = tested.interval(split)?;
        Ok(SplitRow {
            split: split.name.to_owned(),
            method: tested.method.to_owned(),
            accuracy: tested.accuracy(),
            accuracy_low: interval.low,
            accuracy_high: interval.high,
            n_tested: split.n_tested(),
        })
    });
    rows.collect()
}

fn confound_rows(context: &Context) -> Vec<ConfoundRow> {
    let rows = context.readable.iter().flat_map(|(source, found)| {
        let row = |labels: &str, accuracy: f64, high: f64, p_value: Option<f64>| ConfoundRow {
            source: (*source).to_owned(),
            labels: labels.to_owned(),
            accuracy,
            accuracy_low: accuracy,
            accuracy_high: high,
            p_value,
        };
        let is_tested = SOURCES.iter().any(|of| of.name == *source && of.is_tested);
        let p_value = is_tested.then_some(found.p_value);
        [
            row("given", found.accuracy, found.accuracy, p_value),
            row("permuted", found.chance, found.bound, None),
        ]
    });
    rows.collect()
}

fn class_rows(context: &Context) -> Vec<ClassRow> {
    let best = context.best_at_random();
    let classes = touches_of_classes(&context.labels).into_iter();
    let rows = classes.map(|(class, touches)| {
        let results = best.map(|best| touches.iter().filter_map(|&t| best.is_correct[t]));
        let results: Vec<bool> = results.into_iter().flatten().collect();
        let n_correct = results.iter().filter(|&&is_correct| is_correct).count();
        ClassRow {
            class: context.data.classes[class].clone(),
            n_touches: touches.len(),
            accuracy: n_correct as f64 / results.len().max(1) as f64,
        }
    });
    rows.collect()
}

fn doubtful_rows(context: &Context) -> Vec<DoubtfulRow> {
    let name = |touch: usize| {
        let class = context.data.classes.get(context.labels[touch]);
        class.cloned().unwrap_or_default()
    };
    let mut rows = Vec::new();
    let duplicates = near_duplicates::pairs(context).map_or(&[][..], |found| &found.pairs);
    for &(touch, other) in duplicates {
        rows.push(DoubtfulRow {
            touch: context.data.number_in_file(touch),
            class: name(touch),
            reason: "near_duplicate".to_owned(),
            other_touch: Some(context.data.number_in_file(other)),
            other_class: name(other),
        });
    }
    let doubtful = label_noise::deep_touches(context).map_or(&[][..], |found| &found.doubtful);
    for doubtful in doubtful {
        rows.push(DoubtfulRow {
            touch: context.data.number_in_file(doubtful.touch),
            class: name(doubtful.touch),
            reason: "doubtful_label".to_owned(),
            other_touch: None,
            other_class: context.data.classes[doubtful.class].clone(),
        });
    }
    rows
}

/// Returns the state of each taxel in one word.
pub fn taxel_states(context: &Context) -> Vec<&'static str> {
    let states = context.is_untouched.iter();
    let mut states: Vec<&'static str> = states
        .map(|&is_untouched| if is_untouched { "untouched" } else { "working" })
        .collect();
    for hot in hot_taxels::found(context) {
        states[hot.taxel] = "hot";
    }
    for fault in dead_taxels::found(context) {
        states[fault.taxel] = if fault.is_dead { "dead" } else { "stuck" };
    }
    states
}

fn taxel_rows(context: &Context) -> Vec<TaxelRow> {
    let states = taxel_states(context);
    let taxels = context.taxels.iter().enumerate();
    let rows = taxels.map(|(taxel, readings)| TaxelRow {
        taxel,
        state: states[taxel].to_owned(),
        mean: readings.mean,
        std: readings.std,
        least: readings.least,
        largest: readings.largest,
        n_missing: context.n_missing[taxel],
    });
    rows.collect()
}

fn level_rows(context: &Context) -> Vec<LevelRow> {
    let range = context.scale.1 - context.scale.0;
    let untouched = drift::untouched(context);
    let mut rows = Vec::new();
    let n = context.sample.len();
    let n_blocks = N_LEVELS.min(n);
    for (taxels, residuals) in [("all", &context.residuals), ("untouched", &untouched)] {
        if residuals.ncols() == 0 || range <= 0.0 {
            continue;
        }
        let means = residuals.mean_axis(Axis(1)).expect("at least one taxel");
        for block in 0..n_blocks {
            let own = block * n / n_blocks..(block + 1) * n / n_blocks;
            rows.push(LevelRow {
                place: (block as f64 + 0.5) / n_blocks as f64,
                taxels: taxels.to_owned(),
                level: means.slice(ndarray::s![own]).mean().unwrap_or(0.0) / range,
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
    if let Some(confounds) = table("confounds.csv").filter(|table| table.n_rows > 0) {
        let title = "Classes read from sources other than the contact";
        charts.push(ChartSpec {
            lines: vec!["labels".to_owned()],
            mark: Mark::Points,
            ..confounds.chart("confounds", title, ("accuracy", "source"))
        });
    }
    if let Some(levels) = table("levels.csv").filter(|table| table.n_rows > 0) {
        charts.push(ChartSpec {
            lines: vec!["taxels".to_owned()],
            ..levels.chart(
                "levels",
                "Level in the order of recording",
                ("level", "place"),
            )
        });
    }
    if let Some(classes) = table("classes.csv") {
        charts.push(ChartSpec {
            mark: Mark::Points,
            ..classes.chart("classes", "Touches of each class", ("n_touches", "class"))
        });
    }
    charts
}

/// Returns the findings in the order of their verdicts, faults first.
pub fn by_verdict(findings: &[Finding]) -> Vec<&Finding> {
    let mut findings: Vec<&Finding> = findings.iter().collect();
    findings.sort_by_key(|finding| finding.verdict);
    findings
}

/// Returns the sentences that summarise whether the data support a claim about recognition.
pub fn answers(findings: &[Finding]) -> Vec<String> {
    let faults = findings
        .iter()
        .filter(|finding| finding.verdict == Verdict::Fault);
    let n_faults = faults.clone().count();
    let first = match n_faults {
        0 => "No check finds a fault in these data.".to_owned(),
        1 => "These data have 1 fault that limits what they can show.".to_owned(),
        n => format!("These data have {n} faults that limit what they can show."),
    };
    let mut answers = vec![first];
    answers.extend(faults.map(|finding| finding.sentence.clone()));
    answers
}
