//! Measurements of an object's models: surface deviation, deflection error, and computing time per touch.

use crate::error::Result;
use crate::inputs::object_files::NamedMesh;
use crate::mesh::Surface;
use crate::packing::{Body, packing_error};
use crate::random::Seed;
use crate::studies::object_detail::deflection::{Truth, in_mm};
use crate::studies::object_detail::plan::ObjectDetailPlan;
use crate::studies::object_detail::rows::{DetailConfiguration, DetailScore, DetailTime};
use crate::studies::object_detail::spec::DetailMethod;
use crate::studies::object_detail::variants::{Variant, variants};
use std::path::Path;

/// Object with all its models, including the exact mesh.
pub(super) struct Measured<'a> {
    pub mesh: &'a NamedMesh,
    pub truth: Truth,
    /// Models of the object; the first one is the mesh itself.
    pub variants: Vec<Variant>,
}

impl<'a> Measured<'a> {
    /// Computes all models of an object; also returns the surface of its mesh, which only their errors need.
    pub fn new(
        (plan, packings): (&ObjectDetailPlan, Option<&Path>),
        mesh: &'a NamedMesh,
    ) -> Result<(Self, Surface)> {
        let surface = Surface::new(mesh.mesh.clone());
        let variants = variants(plan, &mesh.place, &surface, packings)?;
        let exact = (&mesh.name[..], variants[0].model.clone());
        let seed = Seed::new(plan.spec.seed);
        let measured = Self {
            truth: Truth::new(exact, &plan.array, &plan.placement, &seed)?,
            mesh,
            variants,
        };
        Ok((measured, surface))
    }

    /// Returns the configuration of each model of the object, together with the result of `row`.
    fn rows<T>(&self, row: impl Fn(&Variant) -> T) -> Vec<(DetailConfiguration, T)> {
        let configuration = |variant: &Variant| DetailConfiguration {
            object: self.mesh.name.clone(),
            method: variant.level.0,
            tolerance_mm: variant.level.1,
            n_spheres: variant.model.n_spheres(),
        };
        let variants = self.variants.iter();
        variants
            .map(|variant| (configuration(variant), row(variant)))
            .collect()
    }

    pub fn models(
        &self,
        plan: &ObjectDetailPlan,
        surface: &Surface,
    ) -> Vec<(DetailConfiguration, DetailScore)> {
        let n_points = plan.spec.object_detail.surface_points;
        self.rows(|variant| self.score(variant, (surface, n_points)))
    }

    pub fn times(&self) -> Vec<(DetailConfiguration, DetailTime)> {
        self.rows(|variant| DetailTime {
            us_per_touch: 1e6 * self.truth.seconds_per_touch(&variant.model),
            prepare_s: variant.prepare_s,
            cached: variant.cached,
        })
    }

    /// Returns the distances between the surfaces of a model and its mesh, measured at `n_points` points, and the deflection errors of the model.
    fn score(&self, variant: &Variant, (surface, n_points): (&Surface, usize)) -> DetailScore {
        let truth = &self.truth;
        let model = &variant.model;
        // An open surface has no inside in which parts could be hidden.
        let body = match surface.is_closed() {
            true => Body::Solid,
            false => Body::Sheet,
        };
        let (protrusion, gap) = model.spheres().map_or_else(Default::default, |spheres| {
            let apart = packing_error(surface, body, spheres, n_points);
            (apart.protrusion, apart.gap)
        });
        let error = truth.error(model, 0.0);
        let offset = match variant.level.0 {
            DetailMethod::Mesh => 0.0,
            _ => truth.best_offset(model),
        };
        let after = truth.error(model, offset);
        DetailScore {
            surface_error_mm: in_mm(protrusion.mean + gap.mean),
            protrusion_mean_mm: in_mm(protrusion.mean),
            protrusion_p95_mm: in_mm(protrusion.p95),
            protrusion_max_mm: in_mm(protrusion.max),
            gap_mean_mm: in_mm(gap.mean),
            gap_p95_mm: in_mm(gap.p95),
            gap_max_mm: in_mm(gap.max),
            n_touches: truth.readings.len(),
            n_missed: truth.n_missed,
            n_taxels: truth.n_touched,
            error_mm: error.mean_mm,
            error_p95_mm: error.p95_mm,
            offset_mm: in_mm(offset),
            error_after_offset_mm: after.mean_mm,
            error_after_offset_p95_mm: after.p95_mm,
            error_own_contact_mm: truth.error_past_own_contact(model).mean_mm,
        }
    }
}
