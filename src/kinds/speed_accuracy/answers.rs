//! What was found, in sentences: the two ends of each front.

use super::charts::charts;
use super::plan::SpeedAccuracyPlan;
use crate::report::chart::front_ends;
use crate::table::Table;

/// The cheapest and the best of each part, and what was left out because it is not there.
pub(super) fn answers(plan: &SpeedAccuracyPlan, tables: &[Table]) -> Vec<String> {
    let charts = charts(tables).into_iter();
    let fronts = charts.filter_map(|chart| {
        let [cheapest, best] = front_ends(&chart, tables)?;
        Some(format!("{}, the front: {cheapest} … {best}.", chart.title))
    });
    let peers = plan.peers.as_ref().filter(|path| !path.exists());
    let peers =
        peers.map(|path| format!("Without other programs: there is no {}.", path.display()));
    let scans = plan.scans().filter(|scans| !scans.meshes.is_dir());
    let scans = scans.map(|scans| {
        let folder = scans.meshes.display();
        format!("Without scans: there is no folder {folder}; --objects names one.")
    });
    fronts.chain(peers).chain(scans).collect()
}
