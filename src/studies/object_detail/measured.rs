//! Models of an object's mesh, and their measurements: surface deviation, deflection error, and computing time per touch.

use crate::geometry::distinct_places;
use crate::inputs::object_files::NamedMesh;
use crate::inputs::packings::pack_within;
use crate::mesh::Surface;
use crate::objects::{MeshModel, vertex_spheres};
use crate::packing::{Body, medial_spheres, packing_error};
use crate::studies::object_detail::deflection::{Truth, in_mm};
use crate::studies::object_detail::plan::*;
use crate::studies::object_detail::rows::*;
use crate::studies::prelude::*;
use glam::DVec3;
use std::path::Path;
use std::time::Instant;

/// Object with all its models, including the exact mesh.
pub(super) struct Measured<'a> {
    pub mesh: &'a NamedMesh,
    pub truth: Truth,
    /// Models of the object; the first one is the mesh itself.
    pub variants: Vec<Variant>,
}

impl<'a> Measured<'a> {
    /// Computes all models of an object.
    pub fn new(
        (plan, packings): (&ObjectDetailPlan, Option<&Path>),
        mesh: &'a NamedMesh,
    ) -> Result<Self> {
        let surface = Surface::new(mesh.mesh.clone());
        let variants = variants(plan, &mesh.place, &surface, packings)?;
        let exact = (&mesh.name[..], variants[0].model.clone());
        let seed = Seed::new(plan.spec.seed);
        Ok(Self {
            truth: Truth::new(exact, &plan.array, &plan.placement, &seed)?,
            mesh,
            variants,
        })
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

    /// Returns the differences between each model and the mesh.
    pub fn scores(&self, plan: &ObjectDetailPlan) -> Vec<(DetailConfiguration, DetailScore)> {
        let surface = Surface::new(self.mesh.mesh.clone());
        let n_points = plan.spec.object_detail.surface_points;
        self.rows(|variant| self.score(variant, (&surface, n_points)))
    }

    /// Returns the computing times of each model.
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

/// Method and tolerance (mm, as written in the study file) of a model. A method without tolerances has the tolerance of the packing with the same number of
/// spheres; `None` if there is none.
pub(super) type Level = (DetailMethod, Option<f64>);

/// Returns a tolerance as text, such as ` within 0.5 mm`; empty without a tolerance.
pub(super) fn within(tolerance_mm: Option<f64>) -> String {
    tolerance_mm.map_or(String::new(), |mm| format!(" within {mm} mm"))
}

/// Model of a mesh, with the time to compute it.
pub(super) struct Variant {
    pub level: Level,
    pub model: Model,
    /// Time to compute the model from the mesh, s.
    pub prepare_s: f64,
    /// Whether the model was read from the cache of an earlier run.
    pub cached: bool,
}

/// Returns all models of a mesh in the order of [`levels`]; the first model is the mesh itself. Error messages name `place`, the file of the mesh.
pub(super) fn variants(
    plan: &ObjectDetailPlan,
    place: &str,
    surface: &Surface,
    packings: Option<&Path>,
) -> Result<Vec<Variant>> {
    let mesh = surface.mesh();
    let pack = |mm: f64| pack_within(place, surface, mm * MM, packings);
    // Tolerance of the last packing, and its number of spheres.
    let mut packed = (None, 0);
    let mut found = Vec::new();
    for (method, tolerance_mm) in levels(plan) {
        let mm = tolerance_mm.unwrap_or_default();
        if method != DetailMethod::Packing && packed.0 != tolerance_mm {
            packed = (tolerance_mm, pack(mm)?.spheres.spheres().len());
        }
        let start = Instant::now();
        let (model, cached): (Model, bool) = match method {
            DetailMethod::Mesh => (MeshModel::new(mesh.clone()).into(), false),
            DetailMethod::VertexSpheres => (vertex_spheres(place, mesh.vertices())?.into(), false),
            DetailMethod::Packing => {
                let made = pack(mm)?;
                packed = (tolerance_mm, made.spheres.spheres().len());
                (made.spheres.into(), made.cached)
            }
            DetailMethod::DecimatedVertexSpheres => {
                let chosen = evenly_chosen(mesh.vertices(), packed.1);
                (vertex_spheres(place, &chosen)?.into(), false)
            }
            DetailMethod::MedialSpheres => (medial_spheres(surface, packed.1)?.into(), false),
        };
        found.push(Variant {
            level: (method, tolerance_mm),
            model,
            prepare_s: start.elapsed().as_secs_f64(),
            cached,
        });
    }
    Ok(found)
}

/// Returns all pairs of method and tolerance: the exact mesh first, then methods without tolerances, then the other methods by tolerance.
pub(super) fn levels(plan: &ObjectDetailPlan) -> Vec<Level> {
    let wanted = &plan.spec.object_detail;
    let is_wanted = |method: &DetailMethod| wanted.methods.contains(method);
    let vertices = Some(DetailMethod::VertexSpheres).filter(is_wanted);
    let mut levels = vec![(DetailMethod::Mesh, None)];
    levels.extend(vertices.map(|method| (method, None)));
    for &mm in &wanted.tolerances_mm {
        let methods = [
            DetailMethod::Packing,
            DetailMethod::DecimatedVertexSpheres,
            DetailMethod::MedialSpheres,
        ];
        let methods = methods.into_iter().filter(is_wanted);
        levels.extend(methods.map(|method| (method, Some(mm))));
    }
    levels
}

/// Returns `n` distinct positions from `vertices`; at least two, and all if there are fewer. The first position is the first vertex. Each further position is
/// the vertex that is farthest from all previous positions.
fn evenly_chosen(vertices: &[DVec3], n: usize) -> Vec<DVec3> {
    let places = distinct_places(vertices);
    if n >= places.len() {
        return places;
    }
    let mut chosen = vec![places[0]];
    let mut distances = vec![f64::INFINITY; places.len()];
    while chosen.len() < n.max(2) {
        let last = chosen[chosen.len() - 1];
        let mut farthest = 0;
        for (index, place) in places.iter().enumerate() {
            distances[index] = distances[index].min(place.distance_squared(last));
            if distances[index] > distances[farthest] {
                farthest = index;
            }
        }
        chosen.push(places[farthest]);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evenly_chosen_vertices_are_different_places_and_fewer_are_the_first_of_more() {
        let grid = (0..400).map(|i| DVec3::new(f64::from(i % 20), f64::from(i / 20), 0.0));
        let mut vertices: Vec<DVec3> = grid.collect();
        vertices.extend(vertices.clone());
        let some = evenly_chosen(&vertices, 25);
        let more = evenly_chosen(&vertices, 100);
        assert_eq!(some[..], more[..25]);
        let least_apart = |chosen: &[DVec3]| {
            let pairs = chosen.iter().enumerate();
            let apart = pairs.flat_map(|(i, a)| chosen[..i].iter().map(|b| a.distance(*b)));
            apart.fold(f64::INFINITY, f64::min)
        };
        assert!(least_apart(&some) >= 3.0 && least_apart(&more) >= 1.4);
        assert_eq!(evenly_chosen(&vertices, 1000).len(), 400);
        assert_eq!(evenly_chosen(&vertices, 1).len(), 2);
    }
}
