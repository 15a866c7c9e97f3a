//! Audit of arrays, as in `bubbletouch audit`.

use crate::errors::{exception, guarded};
use crate::study::{ColumnsOfTable, columns};
use crate::threads::aside;
use bubbletouch::audit::{AuditData, AuditFiles, AuditOptions, audit, audit_files};
use bubbletouch::report::folder::write_files;
use bubbletouch::study::RecordedSpec;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Audits files, by their names `data`, `labels`, `groups`, `sessions`, `times`, `lengths`, `frames_test`, `labels_test`, `groups_test` and `lengths_test`, as the
/// command `bubbletouch audit` does. Writes the page, tables and charts to a folder. Returns the tables; the first one lists the findings.
#[pyfunction]
#[pyo3(signature = (files, order, columns, grid, full_scale, before_contact, untouched, split, not_claimed, seed, permutations, name, out))]
pub fn run_audit<'py>(
    py: Python<'py>,
    mut files: BTreeMap<String, PathBuf>,
    order: Option<String>,
    columns: Option<String>,
    grid: Option<[usize; 2]>,
    full_scale: Option<f64>,
    before_contact: Option<(usize, usize)>,
    untouched: Vec<usize>,
    split: Option<String>,
    not_claimed: Option<Vec<String>>,
    seed: u64,
    permutations: usize,
    name: String,
    out: PathBuf,
) -> PyResult<Vec<ColumnsOfTable<'py>>> {
    guarded(|| {
        let mut file = |name: &str| files.remove(name);
        let files = AuditFiles {
            data: file("data").unwrap_or_default(),
            sessions: file("sessions"),
            times: file("times"),
            given: RecordedSpec {
                labels: file("labels").unwrap_or_default(),
                groups: file("groups"),
                lengths: file("lengths"),
                lengths_test: file("lengths_test"),
                frames_test: file("frames_test"),
                labels_test: file("labels_test"),
                groups_test: file("groups_test"),
                order,
                columns,
                grid,
                full_scale,
                ..RecordedSpec::default()
            },
        };
        let data = aside(py, move |_| files.read())?.map_err(exception)?;
        let options = AuditOptions {
            seed,
            n_permutations: permutations,
            before_contact: before_contact.map(|(from, to)| from..to),
            untouched,
            not_claimed,
            split,
        };
        audit_of(py, data, options, (name, out))
    })
}

/// Audits data and writes the page, tables and charts to a folder.
fn audit_of<'py>(
    py: Python<'py>,
    data: AuditData,
    options: AuditOptions,
    (name, out): (String, PathBuf),
) -> PyResult<Vec<ColumnsOfTable<'py>>> {
    options.check(&data, str::to_owned).map_err(exception)?;
    let found = aside(py, move |_| -> bubbletouch::Result<_> {
        let found = audit(data, options)?;
        let tables = found.tables.clone();
        let command = "bubbletouch.audit(frames, labels, …)";
        let files = audit_files(found, &name, command)?;
        write_files(&out, files)?;
        Ok(tables)
    });
    let tables = found?.map_err(exception)?;
    tables.iter().map(|table| columns(py, table)).collect()
}
