//! Where the results come from, for the page.

use crate::report::drawing::escape;
use crate::spelling::counted;
use crate::study::provenance::Manifest;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Program, machine, times, and hashes.
pub(super) fn provenance_html(manifest: &Manifest) -> String {
    let Manifest {
        program,
        commit,
        rustc,
        target,
        cpu,
        cores,
        threads,
        ..
    } = manifest;
    let rows = [
        ("Program", format!("{program}, commit {commit}")),
        ("Built", format!("{rustc} for {target}")),
        (
            "Machine",
            format!(
                "{cpu}, {}, {} used",
                counted(*cores, "core"),
                counted(*threads, "thread")
            ),
        ),
        (
            "Run (UTC)",
            format!("{} to {}", manifest.started, manifest.ended),
        ),
        (
            "Cells",
            format!(
                "{} in {} trials; {} evaluations were finished before this run, {} failed",
                manifest.n_cells, manifest.n_trials, manifest.n_finished_before, manifest.n_failed
            ),
        ),
        ("Seed", manifest.seed.to_string()),
        ("Hash of the sources", manifest.source.clone()),
        ("SHA-256 of study.toml", manifest.study_sha256.clone()),
    ];
    let mut html = "<dl>".to_owned();
    for (name, value) in rows {
        let _ = write!(
            html,
            "<div><dt>{name}</dt><dd>{}</dd></div>",
            escape(&value)
        );
    }
    html += "</dl>";
    html += &listed("Methods of intervals and p-values", &manifest.methods);
    html += &listed("Tables (SHA-256)", &manifest.tables_sha256);
    html + &listed("Objects (SHA-256)", &manifest.objects_sha256)
}

fn listed(title: &str, known: &BTreeMap<String, String>) -> String {
    if known.is_empty() {
        return String::new();
    }
    let rows = known.iter().map(|(name, hash)| {
        format!(
            "<div><dt>{}</dt><dd>{}</dd></div>",
            escape(name),
            escape(hash)
        )
    });
    format!(
        "<details><summary>{title}: {}</summary><dl class=\"hashes\">{}</dl></details>",
        known.len(),
        rows.collect::<String>()
    )
}
