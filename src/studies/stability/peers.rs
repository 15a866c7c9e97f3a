//! Results of other programs for the same configurations, read from a CSV file.

use crate::error::Result;
use crate::report::csv_tables::read_rows;
use crate::studies::stability::plan::StabilityPlan;
use crate::studies::stability::rows::{PeerSource, StabilityConfiguration, StabilityRow};

/// Returns the results of other programs for the configurations of the plan, and their source, such as `MuJoCo 4.0.0, 2026-11-22`. The result is empty if there
/// is no file.
///
/// # Errors
/// If the file is not a table of such rows; the error names the file and the line.
pub(super) fn peer_rows(plan: &StabilityPlan) -> Result<(Vec<StabilityRow>, String)> {
    let Some(path) = plan.peers.as_ref().filter(|path| path.exists()) else {
        return Ok(Default::default());
    };
    // Each line is read once for each struct, because serde's flattening reads an empty field as an empty text.
    let configurations = read_rows::<StabilityConfiguration>(path)?.into_iter();
    let found = configurations.zip(read_rows(path)?).zip(read_rows(path)?);
    let mut sources: Vec<String> = Vec::new();
    let mut rows = Vec::new();
    for (((configuration, score), time), source) in found.zip(read_rows::<PeerSource>(path)?) {
        if is_asked(plan, &configuration) {
            rows.push((configuration, score, time));
            let source = format!("{} {}, {}", source.program, source.version, source.date);
            if !sources.contains(&source) {
                sources.push(source);
            }
        }
    }
    Ok((rows, sources.join("; ")))
}

/// Returns whether the plan contains a configuration that differs from the given one only in its method.
fn is_asked(plan: &StabilityPlan, configuration: &StabilityConfiguration) -> bool {
    let is_like = |(other, _): &(StabilityConfiguration, _)| {
        let of_method = StabilityConfiguration {
            method: configuration.method,
            solver_iterations: configuration.solver_iterations,
            ..other.clone()
        };
        of_method == *configuration
    };
    configuration.method.is_peer() && plan.configurations.iter().any(is_like)
}
