//! Page section on the provenance of the results.

use super::frame::definition;
use crate::engine::provenance::Manifest;
use crate::spelling::counted;

/// Returns the provenance as HTML: program, machine, times and hashes.
pub(crate) fn provenance_html(manifest: &Manifest) -> String {
    let Manifest { program, cpu, .. } = manifest;
    let [cores, threads] = [(manifest.cores, "core"), (manifest.threads, "thread")]
        .map(|(number, one)| counted(number, one));
    let rows = [
        ("Program", format!("{program}, commit {}", manifest.commit)),
        (
            "Built",
            format!("{} for {}", manifest.rustc, manifest.target),
        ),
        ("Machine", format!("{cpu}, {cores}, {threads} used")),
        (
            "Run (UTC)",
            format!("{} to {}", manifest.started, manifest.ended),
        ),
        (
            "Work items",
            format!(
                "{}; {} were finished before this run, {} failed",
                manifest.n_configurations, manifest.n_finished_before, manifest.n_failed
            ),
        ),
        ("Seed", manifest.seed.to_string()),
        ("Hash of the sources", manifest.source.clone()),
        ("SHA-256 of study.toml", manifest.study_sha256.clone()),
    ];
    let rows = rows.iter().map(|(name, value)| definition(name, value));
    format!(
        "<dl>{}</dl><p class=\"quiet\">manifest.json lists the hashes of all tables and objects, and the methods of intervals and p-values.</p>",
        rows.collect::<String>()
    )
}
