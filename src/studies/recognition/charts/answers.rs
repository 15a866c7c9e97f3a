//! Findings of a recognition study as sentences, derived from its tables.

use crate::report::advice::Candidates;
use crate::report::csv_tables::{CAPPED_FITS, LIMITS_FILE, MISSED_TOUCHES};
use crate::report::study_folder::words_of;
use crate::report::terminal::paragraph;
use crate::studies::recognition::charts::table_charts::{Changes, best_row};
use crate::studies::recognition::tables::chance::ChanceLevels;
use crate::studies::recognition::tables::robustness::robustness_words;
use crate::studies::recognition::tables::table_files::{
    CHANGED, CHANGED_TO, CONFIGURATIONS, filled,
};
use crate::table::{Table, Value, short_number};

/// Maximum number of values that a sentence lists.
const MAX_LISTED: usize = 8;

/// Returns the findings of a study as sentences: best and cheapest configurations under each condition, effects of settings, and remarks.
pub fn answers(tables: &[Table]) -> Vec<String> {
    let Some(configurations) = filled(tables, CONFIGURATIONS) else {
        return vec!["No configuration has been computed.".to_owned()];
    };
    let breaking = robustness_words(tables);
    let mut sentences = match change_words(configurations, breaking.clone()) {
        Some(sentences) => sentences,
        None => {
            let columns = ("accuracy", "measurements_per_decision");
            let best = Candidates::of_columns(configurations, columns.0, columns.1);
            let best = best.map_or_else(Vec::new, |best| best.sentences());
            best.into_iter().chain(breaking).collect()
        }
    };
    let best = best_row(configurations).map(|row| configurations.number("accuracy", row));
    if best == Some(1.0) {
        let diagonal = "Every test decision of the most accurate configuration is right: its confusion matrix is diagonal.";
        sentences.push(diagonal.to_owned());
    }
    sentences.extend(limit_words(tables, MISSED_TOUCHES));
    sentences.extend(remarks(tables));
    sentences
}

/// Returns the text that the terminal shows after a run: configurations, findings, published accuracies, and the most frequent confusions of objects.
pub fn words(tables: &[Table], width: usize) -> String {
    let shown = [
        CONFIGURATIONS,
        "published.csv",
        "confused.csv",
        "variance.csv",
        "robustness.csv",
    ];
    let shown = shown.into_iter().filter_map(|file| filled(tables, file));
    let missed = limit_words(tables, MISSED_TOUCHES);
    let mut answers = answers(tables);
    answers.retain(|answer| Some(answer) != missed.as_ref());
    let words = words_of(&shown.collect::<Vec<_>>(), &answers, width);
    // The last lines of a terminal are the ones that are read.
    words
        + &missed.map_or_else(String::new, |missed| {
            format!("\n{}", paragraph(&missed, width))
        })
}

/// Returns sentences on a study in which single settings are changed: the lowest accuracy that a setting alone leaves, and the sentence `breaking`, which is the
/// first one if all settings leave the interval of the unchanged study. Returns `None` for other studies.
fn change_words(configurations: &Table, breaking: Option<String>) -> Option<Vec<String>> {
    let Changes { base, drawn, .. } = Changes::new(configurations)?;
    let accuracy = |row: usize| configurations.number("accuracy", row);
    let (column, _) = configurations.column("accuracy")?;
    let [low, _] = configurations.interval(column, base)?;
    let by_accuracy = |a: &usize, b: &usize| accuracy(*a).total_cmp(&accuracy(*b));
    let settings = configurations.groups(&[CHANGED], drawn).into_iter();
    let lowest = settings.filter_map(|rows| rows.into_iter().min_by(by_accuracy));
    let mut lowest: Vec<usize> = lowest.filter(|row| *row != base).collect();
    lowest.sort_by(by_accuracy);
    let (costly, others) = lowest.split_at(lowest.partition_point(|&row| accuracy(row) < low));
    let name = |row: &usize| configurations.word(CHANGED, *row);
    let said = costly.iter().take(MAX_LISTED).map(|row| {
        let value = configurations.word(CHANGED_TO, *row);
        format!("{} {value} (to {:.2})", name(row), accuracy(*row))
    });
    let said: Vec<String> = said.collect();
    let unchanged = configurations.bounded(column, base);
    let costs = match said.is_empty() {
        true => format!(
            "No setting alone costs more than the interval of the unchanged study, {unchanged}."
        ),
        false => format!(
            "Alone, these lower {unchanged} the most: {}.",
            said.join(", ")
        ),
    };
    let mut sentences = vec![costs];
    let place = usize::from(!others.is_empty());
    sentences.splice(place..place, breaking);
    Some(sentences)
}

/// Returns the limits of `limits.csv` that were reached: the name of each, and a sentence on the number of times.
pub(super) fn limits(tables: &[Table]) -> Vec<(&str, String)> {
    let limits = filled(tables, LIMITS_FILE).into_iter();
    let sentences = limits.flat_map(|limits| {
        let number = move |column: &str, row| limits.number(column, row);
        let reached = (0..limits.n_rows).filter(move |&row| number("count", row) > 0.0);
        reached.map(move |row| {
            let (count, of) = (number("count", row), number("total", row));
            let share = short_number(100.0 * count / of.max(1.0));
            let [limit, meaning] = ["limit", "meaning"].map(|name| limits.word(name, row));
            let words = format!("{count} of {of} {limit} ({share} %): {meaning}.");
            (limit, words)
        })
    });
    sentences.collect()
}

/// Returns the sentence on a limit; `None` if it was not reached.
fn limit_words(tables: &[Table], limit: &str) -> Option<String> {
    let mut limits = limits(tables).into_iter();
    limits.find_map(|(name, words)| (name == limit).then_some(words))
}

/// Returns the accuracy of an answer that is always the same object, if objects have unequal numbers of test rows; `None` if they are about equal.
fn always_one(tables: &[Table]) -> Option<String> {
    let confusion = filled(tables, "confusion.csv")?;
    let chances = ChanceLevels::new(confusion);
    let all = (0..confusion.n_rows).map(|row| chances.of(confusion.number("configuration", row)));
    let (share, object, n) = all
        .filter_map(|chance| Some((chance.accuracy, chance.object?, chance.n_objects)))
        .reduce(|most, next| if next.0 > most.0 { next } else { most })?;
    Some(format!(
        "Objects have unequal numbers of test touches: the answer \"{object}\" alone has an accuracy of {share:.2}, and a balanced accuracy of {:.2} (1 in {n}).",
        1.0 / n as f64
    ))
}

/// Returns remarks on omitted touches, and on trained classifiers whose solver stopped at a limit. If there are too few trials for a p-value, a remark gives
/// the required number.
fn remarks(tables: &[Table]) -> Vec<String> {
    let numbers = |file: &str, column: &str| -> &[f64] {
        let numbers = filled(tables, file).and_then(|table| table.numbers(column));
        numbers.unwrap_or_default()
    };
    let n_left_out = numbers("accuracy.csv", "n_left_out").iter();
    let n_left_out = n_left_out.copied().fold(0.0, f64::max);
    let too_few = Value::from("too_few_trials");
    let is_short = |row| {
        filled(tables, "comparison.csv").is_some_and(|t| t.has_setting("p_status", row, &too_few))
    };
    let n_needed = numbers("comparison.csv", "n_trials_needed").iter();
    let mut n_needed = n_needed.enumerate();
    let n_needed = n_needed.find(|(row, n)| n.is_finite() && is_short(*row));
    let said = [
        always_one(tables),
        (n_left_out > 0.0).then(|| format!(
            "Up to {n_left_out} test touches of a trial are left out, because they do not fill a whole decision."
        )),
        limit_words(tables, CAPPED_FITS)
            .map(|said| said + " Their configurations may do better with more iterations or a smaller C."),
        n_needed.map(|(_, n)| format!("No p-values where trials are too few: {n} are needed.")),
    ];
    said.into_iter().flatten().collect()
}
