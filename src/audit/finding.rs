//! Findings of an audit: a number, its evidence, and the recommended action.

use crate::row;
use crate::statistics::many_tests::holm_of_some;
use crate::table::short_number;
use bubbletouch_svm::audit::Permuted;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// Significance level of all tests of an audit together, after Holm's correction.
pub const ALPHA: f64 = 0.05;

/// Result of a finding, in the order of the page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The data have this fault.
    Fault,
    /// The data do not contain the inputs of the check.
    NotChecked,
    /// The data have a property that limits conclusions, but is not a fault.
    Note,
    /// The check found nothing.
    #[default]
    Passed,
}

impl Verdict {
    /// Returns the verdict in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Fault => "Fault",
            Self::NotChecked => "Not checked",
            Self::Note => "Note",
            Self::Passed => "Passed",
        }
    }

    /// Returns the word for the verdict in tables.
    pub fn word(self) -> String {
        self.words().to_lowercase().replace(' ', "_")
    }
}

/// Names and titles of all checks, in the order of the page.
pub const TITLES: &[(&str, &str)] = &[
    ("split", "Accuracy with whole units held out"),
    ("shared", "Shared by training and test"),
    ("copies", "Copies"),
    ("clusters", "Clusters of touches"),
    ("sample_size", "Effective sample size"),
    ("labels", "Labels to look at"),
    ("order", "Order of the touches"),
    ("session", "Sessions"),
    ("padding", "Length and padding"),
    ("mean", "Mean reading"),
    ("noise", "Size of the noise"),
    ("place", "Place of the contact"),
    ("single_taxel", "One taxel"),
    ("before_contact", "Frames before contact"),
    ("untouched", "Taxels named as untouched"),
    ("constant_taxels", "Constant taxels"),
    ("stuck_taxels", "Taxels stuck for some time"),
    ("equal_taxels", "Equal taxels"),
    ("missing_readings", "Missing readings"),
    ("saturation", "Saturation"),
    ("drift", "Drift"),
    ("not_given", "What was not given"),
];

row! {
/// Finding of one check about one subject.
#[derive(Default)]
pub struct Finding {
    /// Name of the check, such as `copies`.
    check: String => Choice;
    /// Part of the data that the finding is about, such as `group`; empty if it is about all data.
    subject: String => Choice;
    /// Verdict: fault, not_checked, note or passed; for tests it follows from the corrected p-value.
    verdict: Verdict => Outcome;
    /// Measured number; its meaning is in the sentence.
    value: Option<f64> => Value(Neither): Linear between [value_low, value_high];
    /// Lower end of the 95 % interval of the value.
    value_low: Option<f64> => Note: Linear;
    /// Upper end of the 95 % interval of the value.
    value_high: Option<f64> => Note: Linear;
    /// Value without the fault, such as the accuracy by chance.
    baseline: Option<f64> => Note: Linear;
    /// p-value of the test; empty for counts and facts.
    p_value: Option<f64> => Note "p": Log;
    /// p-value after Holm's correction over all tests of the audit.
    p_holm: Option<f64> => Note "p, Holm": Log;
    /// Whether no permutation reaches the statistic, so that the p-value is an upper bound.
    is_end: bool => Note "p is a bound";
    /// Result of the check in one or two sentences.
    sentence: String => Note;
    /// Recommended action; empty if no action is needed.
    advice: String => Note;
    /// Name of the chart or picture that shows the finding; empty if there is none.
    picture: String => Note;
} }

impl Finding {
    /// Creates a finding without a value and a test.
    pub fn new(check: &str, verdict: Verdict, sentence: impl Into<String>) -> Self {
        Self {
            check: check.to_owned(),
            verdict,
            sentence: sentence.into(),
            ..Self::default()
        }
    }

    /// Creates a finding from a count: a note if `is_found`, otherwise passed.
    pub fn counted(check: &str, is_found: bool, sentence: impl Into<String>) -> Self {
        let verdict = match is_found {
            true => Verdict::Note,
            false => Verdict::Passed,
        };
        Self::new(check, verdict, sentence)
    }

    /// Adds a test: the finding keeps its verdict if the corrected p-value is at most [`ALPHA`], otherwise it is passed.
    pub fn tested(mut self, found: &Permuted) -> Self {
        (self.p_value, self.is_end) = (Some(found.p_value), found.is_end);
        self
    }

    /// Sets the subject of the finding.
    pub fn about(mut self, subject: impl Into<String>) -> Self {
        self.subject = subject.into();
        self
    }

    /// Sets the value, and the value without the fault.
    pub fn value(mut self, value: f64, baseline: f64) -> Self {
        (self.value, self.baseline) = (Some(value), Some(baseline));
        self
    }

    /// Sets the advice of the finding; faults and notes show it.
    pub fn advice(mut self, advice: impl Into<String>) -> Self {
        self.advice = advice.into();
        self
    }

    /// Sets the name of the chart or picture that shows the finding.
    pub fn shown_in(mut self, picture: &str) -> Self {
        self.picture = picture.to_owned();
        self
    }

    /// Returns the distance of the value from the value without the fault; 1 for facts without a value.
    fn effect(&self) -> f64 {
        let ends = self.value.zip(self.baseline);
        ends.map_or(1.0, |(value, baseline)| (value - baseline).abs())
    }

    /// Returns the title of the finding: the title of its check, and its subject.
    pub fn title(&self) -> String {
        let check = TITLES.iter().find(|check| check.0 == self.check);
        let title = check.map_or(&self.check[..], |check| check.1);
        match &self.subject[..] {
            "" => title.to_owned(),
            subject => format!("{title}: {subject}"),
        }
    }

    /// Returns the corrected p-value as a text, such as `p < 0.003` if no permutation reaches the statistic; empty without a test.
    pub fn p_text(&self) -> String {
        let sign = if self.is_end { "<" } else { "=" };
        // Two digits, rounded up.
        let text = |p: f64| {
            let step = 10_f64.powf(p.max(1e-99).log10().floor() - 1.0);
            format!("p {sign} {}", short_number((p / step).ceil() * step))
        };
        self.p_holm.map_or(String::new(), text)
    }
}

/// Corrects the p-values of all findings together and sets the verdicts of tests.
pub fn decide(findings: &mut [Finding]) {
    let p_values: Vec<Option<f64>> = findings.iter().map(|finding| finding.p_value).collect();
    for (finding, p_holm) in findings.iter_mut().zip(holm_of_some(&p_values)) {
        finding.p_holm = p_holm;
        if p_holm.is_some_and(|p| p > ALPHA) {
            finding.verdict = Verdict::Passed;
        }
        if finding.verdict == Verdict::Passed {
            finding.advice.clear();
        }
    }
    // If several splits have a fault, the cause is reported once: the largest loss remains a fault, and of equal ones the last, most specific one.
    let is_split = |finding: &Finding| matches!(&finding.check[..], "split" | "shared");
    let splits = findings.iter_mut().rev();
    let splits = splits.filter(|finding| is_split(finding));
    let mut faults: Vec<_> = splits
        .filter(|finding| finding.verdict == Verdict::Fault)
        .collect();
    faults.sort_by(|a, b| b.effect().total_cmp(&a.effect()));
    for finding in faults.into_iter().skip(1) {
        finding.verdict = Verdict::Note;
    }
}

/// Returns the findings in the order of the page: faults by the size of their effect, what could not be checked, notes, and what passed.
pub fn by_verdict(findings: &[Finding]) -> Vec<&Finding> {
    let place = |finding: &Finding| TITLES.iter().position(|title| title.0 == finding.check);
    let mut findings: Vec<&Finding> = findings.iter().collect();
    findings.sort_by(|a, b| {
        let order = a.verdict.cmp(&b.verdict);
        let by_effect = match a.verdict {
            Verdict::Fault => b.effect().total_cmp(&a.effect()),
            _ => Ordering::Equal,
        };
        order.then(by_effect).then(place(a).cmp(&place(b)))
    });
    findings
}

/// Returns whether one of the findings is a fault.
pub fn has_fault(findings: &[Finding]) -> bool {
    let mut verdicts = findings.iter().map(|finding| finding.verdict);
    verdicts.any(|verdict| verdict == Verdict::Fault)
}

/// Formats a fraction as a percentage with few digits.
pub fn percent(share: f64) -> String {
    let share = 100.0 * share;
    match share >= 10.0 {
        true => format!("{share:.0} %"),
        false => format!("{} %", short_number((10.0 * share).round() / 10.0)),
    }
}
