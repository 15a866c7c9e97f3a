//! What the memory of a taxel buys.

use crate::table::{ChartSpec, Mark, Table};

/// Accuracy against the bytes that a compression keeps for each taxel, with the front; none where nothing was learned.
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
