//! Runs a study of object detail: models of every mesh, their errors on all threads, then their times on one.

use super::deflection::Truth;
use super::plan::ObjectDetailPlan;
use super::recognition::Sensor;
use super::spec::DetailMethod;
use super::summary::summary;
use super::table::{DetailCell, DetailScore, DetailTime, ObjectDetailTables};
use super::variants::{Variant, variants};
use crate::error::{Error, Result};
use crate::mesh::Surface;
use crate::objects::{Model, Object};
use crate::packing::{Body, PackingError, packing_error};
use crate::random::Seed;
use crate::study::object_files::NamedMesh;
use crate::study::progress::Progress;
use crate::study::simulation::draw_touches;
use ndarray::Array2;
use rayon::prelude::*;
use std::path::Path;

/// Runs a study on meshes; packings are looked for and kept in the folder `packings`, if one is given. The tables but for
/// times are the same bytes at any number of threads.
///
/// # Errors
/// A mesh that cannot be packed, named by its file; a folder that cannot be written.
pub fn measure_detail(
    plan: &ObjectDetailPlan,
    meshes: Vec<NamedMesh>,
    packings: Option<&Path>,
    progress: &dyn Progress,
) -> Result<ObjectDetailTables> {
    let sensor = Sensor::of(plan)?;
    if sensor.is_some() && meshes.len() < 2 {
        return Err(Error::input(
            "object_detail.recognition",
            format!("{} meshes", meshes.len()),
            "at least 2 objects to tell apart",
        ));
    }
    progress.stage("models", (meshes.len() * plan.n_models()) as u64);
    let measured = meshes
        .into_par_iter()
        .map(|named| Measured::new(plan, named, packings, sensor.as_ref(), progress))
        .collect::<Result<Vec<_>>>()?;
    let mut tables = ObjectDetailTables::default();
    progress.stage("time touches", measured.len() as u64);
    for object in &measured {
        for (variant, score) in object.variants.iter().zip(&object.scores) {
            let cell = cell(&object.name, variant);
            let time = DetailTime {
                us_per_touch: 1e6 * object.truth.seconds_per_touch(&variant.model),
                prepare_s: variant.prepare_s,
                was_kept: variant.was_kept,
            };
            tables.detail.push((cell.clone(), score.clone()));
            tables.timing.push((cell, time));
        }
        progress.advance(1);
    }
    tables.summary = summary(&tables.detail);
    if let Some(sensor) = sensor {
        progress.stage("recognise", 1);
        let objects = measured.into_iter().map(|object| object.felt);
        tables.recognition = sensor.recognise(&tables.detail, &objects.collect::<Vec<_>>())?;
        progress.advance(1);
    }
    Ok(tables)
}

/// An object, its models and how near they are.
struct Measured {
    name: String,
    truth: Truth,
    variants: Vec<Variant>,
    scores: Vec<DetailScore>,
    /// Measurements of each variant, for learning; none if nothing learns.
    felt: Vec<Array2<f64>>,
}

impl Measured {
    fn new(
        plan: &ObjectDetailPlan,
        NamedMesh { name, place, mesh }: NamedMesh,
        packings: Option<&Path>,
        sensor: Option<&Sensor>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let surface = Surface::new(mesh);
        let variants = variants(plan, &place, &surface, packings)?;
        // The first of them is the mesh itself.
        let truth = truth(plan, &name, &variants[0].model)?;
        let n_points = plan.spec.object_detail.surface_points;
        let scores = variants.iter().map(|variant| {
            let score = score(variant, &surface, &truth, n_points);
            progress.advance(1);
            score
        });
        let scores = scores.collect();
        let felt = sensor.map(|sensor| sensor.measure(&name, &variants));
        Ok(Self {
            scores,
            felt: felt.transpose()?.unwrap_or_default(),
            name,
            truth,
            variants,
        })
    }
}

/// The touches that every study would draw for an object of this name, felt exactly.
fn truth(plan: &ObjectDetailPlan, name: &str, mesh: &Model) -> Result<Truth> {
    let object = Object::of_one_part(name, mesh.clone());
    let seed = Seed::new(plan.spec.seed);
    let touched = draw_touches(vec![object], &plan.placement, &seed)?;
    Ok(Truth::new(&touched[0], &plan.patch))
}

fn cell(object: &str, variant: &Variant) -> DetailCell {
    DetailCell {
        object: object.to_owned(),
        method: variant.method,
        tolerance_mm: variant.tolerance_mm,
        n_spheres: variant.model.n_spheres(),
    }
}

fn score(variant: &Variant, surface: &Surface, truth: &Truth, n_points: usize) -> DetailScore {
    const MM: f64 = 1e3;
    let model = &variant.model;
    // An open surface has no inside that could hide a part of it.
    let body = match surface.is_closed() {
        true => Body::Solid,
        false => Body::Sheet,
    };
    let apart = model
        .spheres()
        .map(|spheres| packing_error(surface, body, spheres, n_points));
    let apart = apart.unwrap_or(PackingError {
        protrusion: Default::default(),
        gap: Default::default(),
        n_points,
        buried_share: 0.0,
    });
    let (protrusion, gap) = (apart.protrusion, apart.gap);
    let error = truth.error(model, 0.0);
    let offset = match variant.method {
        DetailMethod::Mesh => 0.0,
        _ => truth.best_offset(model),
    };
    let after = truth.error(model, offset);
    DetailScore {
        surface_error_mm: MM * (protrusion.mean + gap.mean),
        protrusion_mean_mm: MM * protrusion.mean,
        protrusion_p95_mm: MM * protrusion.p95,
        protrusion_max_mm: MM * protrusion.max,
        gap_mean_mm: MM * gap.mean,
        gap_p95_mm: MM * gap.p95,
        gap_max_mm: MM * gap.max,
        n_touches: truth.n_met(),
        n_missed: truth.n_missed,
        n_taxels: truth.n_touched,
        error_mm: MM * error.mean,
        error_p95_mm: MM * error.p95,
        offset_mm: MM * offset,
        error_after_offset_mm: MM * after.mean,
        error_after_offset_p95_mm: MM * after.p95,
        error_own_contact_mm: MM * truth.error_past_own_contact(model),
    }
}
