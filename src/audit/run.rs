//! Run of all checks of an audit.

use crate::audit::context::{AuditOptions, Context};
use crate::audit::data::AuditData;
use crate::audit::finding::{Finding, Verdict, by_verdict, decide};
use crate::audit::tables::Results;
use crate::audit::{claim, pictures, readings, sources, tables};
use crate::error::Result;
use crate::table::{ChartSpec, Table};

/// Findings of an audit, with tables, charts and pictures.
pub struct Audit {
    /// Sentences at the top of the page: the accuracy that the split measures, what was not given, and the worst fault.
    pub sentences: Vec<String>,
    /// Findings in the order of the questions.
    pub findings: Vec<Finding>,
    /// Tables behind the findings; the first one lists the findings.
    pub tables: Vec<Table>,
    /// Charts of the tables.
    pub charts: Vec<ChartSpec>,
    /// Pictures of frames and taxels.
    pub pictures: Vec<crate::report::study_folder::NamedPicture>,
}

/// Audits a data set. The result depends only on data and options.
///
/// # Errors
/// If lists have other lengths than the number of touches, there are too few touches, or an option does not fit the data.
pub fn audit(data: AuditData, options: AuditOptions) -> Result<Audit> {
    let context = Context::new(data, options)?;
    let mut claim = claim::answer(&context)?;
    let read = sources::tested(&context);
    let (states, of_readings) = readings::answer(&context);
    let mut findings = std::mem::take(&mut claim.findings);
    findings.extend(sources::findings(&context, &read));
    findings.extend(of_readings);
    decide(&mut findings);
    let mut sentences = claim.sentences.clone();
    sentences.push(worst(&findings));
    let results = Results {
        findings: &findings,
        claim: &claim,
        sources: &read,
        states: &states,
    };
    let tables = tables::tables(&context, &results)?;
    let charts = tables::charts(&context, &tables);
    let pictures = pictures::pictures(&context, &claim, &states)?;
    Ok(Audit {
        sentences,
        findings,
        tables,
        charts,
        pictures,
    })
}

/// Returns the sentence on the worst fault.
fn worst(findings: &[Finding]) -> String {
    let mut faults = by_verdict(findings);
    faults.retain(|finding| finding.verdict == Verdict::Fault);
    match &faults[..] {
        [] => "No test finds a fault.".to_owned(),
        [worst, ..] => {
            let n = match faults.len() {
                1 => "There is one fault".to_owned(),
                n => format!("The worst of {n} faults"),
            };
            format!("{n}: {}. {}", worst.title(), worst.sentence)
        }
    }
}
