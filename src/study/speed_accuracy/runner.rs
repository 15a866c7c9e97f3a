//! Runs a study of speed against accuracy, part by part.

use super::contact::measure_contact;
use super::peers::read_peers;
use super::plan::SpeedAccuracyPlan;
use super::recognition::measure_recognition;
use super::resolution::measure_resolution;
use super::subject::{load_scans, load_subjects};
use super::table::SpeedAccuracyTables;
use crate::error::Result;
use crate::study::progress::Progress;
use std::path::Path;

/// Runs a study; packings of meshes are looked for and kept in the folder `packings`, if one is given. The tables but for times are the
/// same bytes at any number of threads.
///
/// # Errors
/// Objects that are not there, a mesh that cannot be packed, a file of peers that cannot be read; what a stage refuses.
pub fn measure_speed_accuracy(
    plan: &SpeedAccuracyPlan,
    packings: Option<&Path>,
    progress: &dyn Progress,
) -> Result<SpeedAccuracyTables> {
    let mut tables = SpeedAccuracyTables::default();
    let contact = plan.contact.as_ref();
    if let Some(path) = contact.and_then(|contact| contact.peers.as_ref()) {
        tables.peers = read_peers(path)?;
    }
    let subjects = load_subjects(&plan.spec.objects)?;
    let objects = (subjects.as_slice(), packings);
    if let Some(contact) = contact {
        let scans = load_scans(contact.spec.scans.as_ref(), &plan.spec.objects)?;
        let objects = (subjects.as_slice(), scans.as_slice(), packings);
        measure_contact(plan, contact, objects, progress, &mut tables)?;
    }
    if let Some(sweep) = &plan.recognition {
        measure_recognition(plan, sweep, objects, progress, &mut tables)?;
    }
    if let Some(resolution) = &plan.resolution {
        measure_resolution(plan, resolution, objects, progress, &mut tables)?;
    }
    Ok(tables)
}
