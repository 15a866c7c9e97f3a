//! How near a model is to its mesh: by its surface, and by what the skin feels.

use super::deflection::Truth;
use super::plan::ObjectDetailPlan;
use super::rows::{DetailCell, DetailScore};
use super::spec::DetailMethod;
use super::variants::Variant;
use crate::error::Result;
use crate::mesh::Surface;
use crate::objects::{Model, Object};
use crate::packing::{Body, PackingError, packing_error};
use crate::random::Seed;
use crate::study::simulation::draw_touches;

/// The touches that every study would draw for an object of this name, felt exactly.
pub(super) fn truth(plan: &ObjectDetailPlan, name: &str, mesh: &Model) -> Result<Truth> {
    let object = Object::of_one_part(name, mesh.clone());
    let seed = Seed::new(plan.spec.seed);
    let touched = draw_touches(vec![object], &plan.placement, &seed)?;
    Ok(Truth::new(&touched[0], &plan.patch))
}

/// Millimetres in a metre.
const MM: f64 = 1e3;

/// Mean error of a model that is touched as far past its own first contact as the mesh past its.
pub(super) fn own_contact_error_mm(truth: &Truth, variant: &Variant) -> f64 {
    MM * truth.error_past_own_contact(&variant.model)
}

/// What a row of a model begins with.
pub(super) fn cell(object: &str, variant: &Variant) -> DetailCell {
    DetailCell {
        object: object.to_owned(),
        method: variant.method,
        tolerance_mm: variant.tolerance_mm,
        n_spheres: variant.model.n_spheres(),
    }
}

/// How near a model is to its mesh, seen from so many points of it.
pub(super) fn score(
    variant: &Variant,
    surface: &Surface,
    truth: &Truth,
    n_points: usize,
) -> DetailScore {
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
        n_touches: truth.readings().len(),
        n_missed: truth.n_missed,
        n_taxels: truth.n_touched,
        error_mm: MM * error.mean,
        error_p95_mm: MM * error.p95,
        offset_mm: MM * offset,
        error_after_offset_mm: MM * after.mean,
        error_after_offset_p95_mm: MM * after.p95,
        error_own_contact_mm: own_contact_error_mm(truth, variant),
    }
}
