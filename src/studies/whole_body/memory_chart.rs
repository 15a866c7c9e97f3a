//! Chart of accuracy against the memory of the measurement matrix.

use crate::table::{ChartSpec, Mark, Table};

/// Returns the chart of recognition accuracy against the memory of the measurement matrix per taxel, with the Pareto front. Returns `None` if the table has
/// no rows.
pub(super) fn memory_chart(recognition: &Table) -> Option<ChartSpec> {
    (recognition.n_rows > 0).then(|| ChartSpec {
        lines: vec!["compression".to_owned()],
        mark: Mark::Points,
        front: true,
        ..recognition.chart(
            "accuracy_by_memory",
            "Which object is it: accuracy against memory of a taxel",
            ("accuracy", "bytes_per_taxel"),
        )
    })
}
