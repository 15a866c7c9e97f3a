//! Run of all checks of an audit.

use crate::audit::context::{AuditOptions, Context};
use crate::audit::data::AuditData;
use crate::audit::finding::{Finding, decide};
use crate::audit::{checks, pictures, tables};
use crate::error::Result;
use crate::table::{ChartSpec, Table};
use rayon::prelude::*;

/// Findings of an audit, with tables, charts and pictures.
pub struct Audit {
    /// Findings in the order of the checks.
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
/// If lists have other lengths than the number of touches, or there are too few touches.
pub fn audit(data: AuditData, options: AuditOptions) -> Result<Audit> {
    let mut context = Context::new(data, options)?;
    if context.has_classes() {
        let sources = checks::SOURCES.par_iter();
        let read = sources.filter_map(|source| {
            let rows = (source.rows)(&context)?;
            let (name, is_tested) = (source.name, source.is_tested);
            let found =
                context.readability(rows.view(), name, source.holds_out_groups, is_tested)?;
            Some((name, found))
        });
        context.readable = read.collect();
    }
    let mut findings = Vec::new();
    for check in checks::CHECKS {
        let mut found = (check.run)(&context)?;
        found
            .iter_mut()
            .for_each(|finding| finding.check = check.name);
        findings.extend(found);
    }
    decide(&mut findings);
    let tables = tables::tables(&context, &findings)?;
    let charts = tables::charts(&context, &tables);
    let pictures = pictures::pictures(&context, &findings)?;
    Ok(Audit {
        findings,
        tables,
        charts,
        pictures,
    })
}
