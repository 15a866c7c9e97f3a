//! Findings of an audit: a number, its evidence, and the recommended action.

use crate::statistics::many_tests::holm_of_some;
use crate::table::short_number;
use bubbletouch_svm::audit::Readability;

/// Significance level of all tests of an audit together, after Holm's correction.
pub const ALPHA: f64 = 0.05;

/// Result of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The data have this fault.
    Fault,
    /// The data have a property that limits conclusions, but is not a fault.
    Note,
    /// The check found no fault.
    Passed,
    /// The data do not contain the inputs of the check.
    NotChecked,
}

impl Verdict {
    /// Returns the word for the verdict in tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Fault => "fault",
            Self::Note => "note",
            Self::Passed => "passed",
            Self::NotChecked => "not_checked",
        }
    }
}

/// Evidence from which the verdict of a finding follows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Evidence {
    /// A count: the data have the fault or not.
    Counted(bool),
    /// A test: the data have the fault if the corrected p-value is at most [`ALPHA`] and the effect is relevant.
    Tested { p_value: f64, is_relevant: bool },
    /// A fact without a test.
    Fact,
    /// No evidence, because the check could not be made.
    None,
}

/// Finding of one check about one subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Name of the check, such as `near_duplicates`.
    pub check: &'static str,
    /// Part of the data or comparison that the finding is about, such as `group split`; may be empty.
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
    /// Result of the check in one or two sentences.
    pub sentence: String,
    /// Recommended action against a fault; empty if no action is needed.
    pub advice: String,
    /// Name of the chart or picture that shows the finding; empty if there is none.
    pub picture: &'static str,
    evidence: Evidence,
}

impl Finding {
    fn new(check: &'static str, value: f64, sentence: String, evidence: Evidence) -> Self {
        Self {
            check,
            subject: String::new(),
            verdict: Verdict::Passed,
            value,
            interval: [f64::NAN; 2],
            baseline: f64::NAN,
            p_value: None,
            p_holm: None,
            sentence,
            advice: String::new(),
            picture: "",
            evidence,
        }
    }

    /// Creates a finding from a test. The finding is a fault if the corrected p-value is at most [`ALPHA`] and the effect is relevant.
    pub fn tested(
        check: &'static str,
        value: f64,
        sentence: String,
        (p_value, is_relevant): (f64, bool),
    ) -> Self {
        let evidence = Evidence::Tested {
            p_value,
            is_relevant,
        };
        Self {
            p_value: Some(p_value),
            ..Self::new(check, value, sentence, evidence)
        }
    }

    /// Creates a finding from the test whether the class can be read from a source other than the contact.
    pub fn readable(found: &Readability, sentence: String, advice: &str) -> Self {
        Self::tested("", found.accuracy, sentence, (found.p_value, true))
            .against(found.chance)
            .advice(advice)
            .shown_in("confounds")
    }

    /// Creates the finding that labels can be read from a source. `names` is the subject and the verb of the sentence, such as "The mean reading names".
    pub fn names_class(found: &Readability, names: &str, advice: &str) -> Self {
        let sentence = format!(
            "{names} the class of {} of the touches; permuted labels give {}.",
            percent(found.accuracy),
            percent(found.chance)
        );
        Self::readable(found, sentence, advice)
    }

    /// Creates a finding from a count.
    pub fn counted(check: &'static str, value: f64, sentence: String, is_fault: bool) -> Self {
        Self::new(check, value, sentence, Evidence::Counted(is_fault))
    }

    /// Creates a fact that is not a fault.
    pub fn note(check: &'static str, value: f64, sentence: String) -> Self {
        Self::new(check, value, sentence, Evidence::Fact)
    }

    /// Creates the finding of a check that could not be made; the sentence gives the reason.
    pub fn not_checked(check: &'static str, sentence: impl Into<String>) -> Self {
        Self::new(check, f64::NAN, sentence.into(), Evidence::None)
    }

    /// Sets the subject of the finding.
    pub fn about(mut self, subject: impl Into<String>) -> Self {
        self.subject = subject.into();
        self
    }

    /// Sets the advice of the finding; faults and notes show it.
    pub fn advice(mut self, advice: impl Into<String>) -> Self {
        self.advice = advice.into();
        self
    }

    /// Sets the interval of the value.
    pub fn within(mut self, interval: [f64; 2]) -> Self {
        self.interval = interval;
        self
    }

    /// Sets the value without the fault.
    pub fn against(mut self, baseline: f64) -> Self {
        self.baseline = baseline;
        self
    }

    /// Sets the name of the chart or picture that shows the finding.
    pub fn shown_in(mut self, picture: &'static str) -> Self {
        self.picture = picture;
        self
    }
}

/// Corrects the p-values of all findings together and sets their verdicts.
pub fn decide(findings: &mut [Finding]) {
    let p_values: Vec<Option<f64>> = findings.iter().map(|finding| finding.p_value).collect();
    for (finding, p_holm) in findings.iter_mut().zip(holm_of_some(&p_values)) {
        finding.p_holm = p_holm;
        finding.verdict = match finding.evidence {
            Evidence::Counted(true) => Verdict::Fault,
            Evidence::Tested {
                is_relevant: true, ..
            } if p_holm.is_some_and(|p| p <= ALPHA) => Verdict::Fault,
            Evidence::Counted(false) | Evidence::Tested { .. } => Verdict::Passed,
            Evidence::Fact => Verdict::Note,
            Evidence::None => Verdict::NotChecked,
        };
        if matches!(finding.verdict, Verdict::Passed | Verdict::NotChecked) {
            finding.advice.clear();
        }
    }
}

/// Formats a fraction as a percentage with few digits.
pub fn percent(share: f64) -> String {
    format!("{} %", short_number(100.0 * share))
}
