//! Findings of an audit: a number, its evidence, and the recommended action.

use crate::statistics::many_tests::holm_of_some;
use crate::table::short_number;
use bubbletouch_svm::audit::Permuted;

/// Significance level of all tests of an audit together, after Holm's correction.
pub const ALPHA: f64 = 0.05;

/// Result of a finding, in the order of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The data have this fault.
    Fault,
    /// The data do not contain the inputs of the check.
    NotChecked,
    /// The data have a property that limits conclusions, but is not a fault.
    Note,
    /// The check found nothing.
    Passed,
}

impl Verdict {
    /// Returns the word for the verdict in tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Fault => "fault",
            Self::NotChecked => "not_checked",
            Self::Note => "note",
            Self::Passed => "passed",
        }
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
    ("class_balance", "Class balance"),
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

/// Finding of one check about one subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Name of the check, such as `copies`.
    pub check: &'static str,
    /// Part of the data that the finding is about, such as `group`; may be empty.
    pub subject: String,
    /// Verdict; for tests it follows from the corrected p-value.
    pub verdict: Verdict,
    /// Measured number; NaN if there is none.
    pub value: f64,
    /// Lower and upper end of the value's 95 % interval; NaN if there is none.
    pub interval: [f64; 2],
    /// Number that the value would have without the fault, such as the accuracy by chance; NaN if there is none.
    pub baseline: f64,
    /// p-value of the test; `None` for counts and facts.
    pub p_value: Option<f64>,
    /// p-value after Holm's correction over all tests of the audit.
    pub p_holm: Option<f64>,
    /// Whether the p-value is the smallest one that the permutations resolve.
    pub is_end: bool,
    /// Result of the check in one or two sentences.
    pub sentence: String,
    /// Recommended action; empty if no action is needed.
    pub advice: String,
    /// Name of the chart or picture that shows the finding; empty if there is none.
    pub picture: &'static str,
}

impl Finding {
    /// Creates a finding without a test. The value, its interval and its baseline are NaN unless they are set.
    pub fn new(check: &'static str, verdict: Verdict, sentence: impl Into<String>) -> Self {
        Self {
            check,
            subject: String::new(),
            verdict,
            value: f64::NAN,
            interval: [f64::NAN; 2],
            baseline: f64::NAN,
            p_value: None,
            p_holm: None,
            is_end: false,
            sentence: sentence.into(),
            advice: String::new(),
            picture: "",
        }
    }

    /// Creates a finding from a count: a note if `is_found`, otherwise passed.
    pub fn counted(check: &'static str, is_found: bool, sentence: impl Into<String>) -> Self {
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
        (self.value, self.baseline) = (value, baseline);
        self
    }

    /// Sets the advice of the finding; faults and notes show it.
    pub fn advice(mut self, advice: impl Into<String>) -> Self {
        self.advice = advice.into();
        self
    }

    /// Sets the name of the chart or picture that shows the finding.
    pub fn shown_in(mut self, picture: &'static str) -> Self {
        self.picture = picture;
        self
    }

    /// Returns the title of the finding: the title of its check, and its subject.
    pub fn title(&self) -> String {
        let check = TITLES.iter().find(|check| check.0 == self.check);
        let title = check.map_or(self.check, |check| check.1);
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
    merge_splits(findings);
}

/// If several splits have a fault, the cause is reported once: the largest loss remains a fault.
fn merge_splits(findings: &mut [Finding]) {
    let is_fault = |finding: &Finding| {
        matches!(finding.check, "split" | "shared") && finding.verdict == Verdict::Fault
    };
    let loss = |finding: &Finding| finding.baseline - finding.value;
    let faults = (0..findings.len()).filter(|&number| is_fault(&findings[number]));
    let worst = faults
        .clone()
        .max_by(|&a, &b| loss(&findings[a]).total_cmp(&loss(&findings[b])));
    for number in faults.collect::<Vec<_>>() {
        if Some(number) != worst {
            findings[number].verdict = Verdict::Note;
        }
    }
}

/// Returns the findings in the order of the page: faults by the size of their effect, what could not be checked, notes, and what passed.
pub fn by_verdict(findings: &[Finding]) -> Vec<&Finding> {
    let effect = |finding: &Finding| match finding.verdict {
        Verdict::Fault => -(finding.value - finding.baseline).abs(),
        _ => 0.0,
    };
    let place = |finding: &Finding| TITLES.iter().position(|title| title.0 == finding.check);
    let mut findings: Vec<&Finding> = findings.iter().collect();
    findings.sort_by(|a, b| {
        let order = a.verdict.cmp(&b.verdict);
        let order = order.then(effect(a).total_cmp(&effect(b)));
        order.then(place(a).cmp(&place(b)))
    });
    findings
}

/// Returns whether one of the findings is a fault.
pub fn has_fault(findings: &[Finding]) -> bool {
    findings
        .iter()
        .any(|finding| finding.verdict == Verdict::Fault)
}

/// Formats a fraction as a percentage with few digits.
pub fn percent(share: f64) -> String {
    let share = 100.0 * share;
    match share >= 10.0 {
        true => format!("{share:.0} %"),
        false => format!("{} %", short_number((10.0 * share).round() / 10.0)),
    }
}
