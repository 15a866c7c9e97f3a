//! Results of other programs for the same configurations, read from a CSV file.

use crate::error::{Error, Result};
use crate::inputs::units::MM;
use crate::report::csv_tables::read_rows;
use crate::studies::stability::plan::StabilityPlan;
use crate::studies::stability::rows::{
    PeerScene, PeerSource, StabilityConfiguration, StabilityRow,
};
use crate::table::csv_place;
use std::path::Path;

/// Returns the results of other programs for the configurations of the plan, and their source, such as `MuJoCo 4.0.0, 2026-11-22`. Each row stands in the
/// first part of the study that contains its scene. The result is empty if there is no file.
///
/// # Errors
/// If the file is not a table of such rows, or a row belongs to no scene of the study or repeats another row; the error names the file and the line.
pub(super) fn peer_rows(plan: &StabilityPlan) -> Result<(Vec<StabilityRow>, String)> {
    let Some(path) = plan.peers.as_ref().filter(|path| path.exists()) else {
        return Ok(Default::default());
    };
    // Each line is read once for each struct, because serde's flattening reads an empty field as an empty text.
    let configurations = read_rows::<StabilityConfiguration>(path)?.into_iter();
    let found = configurations.zip(read_rows(path)?).zip(read_rows(path)?);
    let others = read_rows::<PeerScene>(path)?
        .into_iter()
        .zip(read_rows::<PeerSource>(path)?);
    let mut sources: Vec<String> = Vec::new();
    let mut rows: Vec<StabilityRow> = Vec::new();
    for (line, (((configuration, score), time), (scene, source))) in (2..).zip(found.zip(others)) {
        let configuration = placed(plan, configuration, &scene)
            .ok_or("a scene and a method that the study lacks")
            .and_then(|one| match rows.iter().any(|(known, ..)| *known == one) {
                true => Err("a configuration of an earlier line"),
                false => Ok(one),
            })
            .map_err(|given| refuse(path, line, given))?;
        rows.push((configuration, score, time));
        let source = format!("{} {}, {}", source.program, source.version, source.date);
        if !sources.contains(&source) {
            sources.push(source);
        }
    }
    Ok((rows, sources.join("; ")))
}

/// Returns a configuration of another program's method as it stands in the plan: in the first part that contains its scene. Returns `None` if no part does.
/// Scenes are equal if all their parameters are equal; the part and the method do not belong to a scene.
fn placed(
    plan: &StabilityPlan,
    configuration: StabilityConfiguration,
    scene: &PeerScene,
) -> Option<StabilityConfiguration> {
    let (radius, stroke) = (0.5 * scene.pitch_mm * MM, scene.stroke_mm * MM);
    let mut others = plan.all_methods.iter();
    let part = others.find_map(|(other, taxel)| {
        let of_scene = StabilityConfiguration {
            part: configuration.part,
            method: configuration.method,
            solver_iterations: configuration.solver_iterations,
            ..other.clone()
        };
        let is_equal =
            of_scene == configuration && (taxel.radius, taxel.stroke) == (radius, stroke);
        is_equal.then_some(other.part)
    })?;
    let is_peer = configuration.method.is_peer();
    is_peer.then_some(StabilityConfiguration {
        part,
        ..configuration
    })
}

fn refuse(path: &Path, line: u64, given: &str) -> Error {
    let allowed =
        "rows of the study's own scenes, each once, as benches/peers/stability.py writes them";
    Error::input(csv_place(path, Some(line)), given, allowed)
}
