//! What stands for a mesh: the models that are compared.

use super::plan::ObjectDetailPlan;
use super::spec::DetailMethod;
use crate::error::Result;
use crate::geometry::distinct_places;
use crate::mesh::Surface;
use crate::objects::{MeshModel, Model, vertex_spheres};
use crate::packing::medial_spheres;
use crate::study::packings::pack_within;
use glam::DVec3;
use std::path::Path;
use std::time::Instant;

/// A model of a mesh.
pub(super) struct Variant {
    pub method: DetailMethod,
    /// Of the packing that it is, or has as many spheres as; mm, as written.
    pub tolerance_mm: Option<f64>,
    pub model: Model,
    /// Seconds that making it took.
    pub prepare_s: f64,
    /// Whether it was kept from before.
    pub was_kept: bool,
}

/// Makes a model, and says whether it was kept from before.
type Make<'a> = &'a dyn Fn() -> Result<(Model, bool)>;

/// All models of a mesh, the mesh itself first. The error names `place`, the mesh's file.
pub(super) fn variants(
    plan: &ObjectDetailPlan,
    place: &str,
    surface: &Surface,
    packings: Option<&Path>,
) -> Result<Vec<Variant>> {
    let wanted = &plan.spec.object_detail;
    let is_wanted = |method| wanted.methods.contains(&method);
    let mesh = surface.mesh();
    let timed = |method, tolerance_mm, make: Make| -> Result<Variant> {
        let start = Instant::now();
        let (model, was_kept) = make()?;
        Ok(Variant {
            method,
            tolerance_mm,
            model,
            prepare_s: start.elapsed().as_secs_f64(),
            was_kept,
        })
    };
    let mut found = vec![timed(DetailMethod::Mesh, None, &|| {
        Ok((MeshModel::new(mesh.clone()).into(), false))
    })?];
    if is_wanted(DetailMethod::VertexSpheres) {
        found.push(timed(DetailMethod::VertexSpheres, None, &|| {
            Ok((vertex_spheres(place, mesh.vertices())?.into(), false))
        })?);
    }
    let packing = DetailMethod::Packing;
    let as_many = as_many(plan);
    if !is_wanted(packing) && as_many.is_empty() {
        return Ok(found);
    }
    for (&tolerance, &mm) in plan.tolerances.iter().zip(&wanted.tolerances_mm) {
        let packed = timed(packing, Some(mm), &|| {
            let packed = pack_within(place, surface, tolerance, packings)?;
            Ok((packed.spheres.into(), packed.was_kept))
        })?;
        let n = packed.model.n_spheres();
        if is_wanted(packing) {
            found.push(packed);
        }
        for &method in &as_many {
            found.push(timed(method, Some(mm), &|| {
                let spheres = match method {
                    DetailMethod::MedialSpheres => medial_spheres(surface, n)?,
                    _ => vertex_spheres(place, &evenly_chosen(mesh.vertices(), n))?,
                };
                Ok((spheres.into(), false))
            })?);
        }
    }
    Ok(found)
}

/// The methods of a plan whose models have as many spheres as a packing.
fn as_many(plan: &ObjectDetailPlan) -> Vec<DetailMethod> {
    let methods = [
        DetailMethod::DecimatedVertexSpheres,
        DetailMethod::MedialSpheres,
    ];
    let wanted = &plan.spec.object_detail.methods;
    let methods = methods.into_iter();
    methods.filter(|method| wanted.contains(method)).collect()
}

/// Methods and tolerances (mm, as written) of the models of every mesh, in the order of [`variants`].
pub(super) fn levels(plan: &ObjectDetailPlan) -> Vec<(DetailMethod, Option<f64>)> {
    let wanted = &plan.spec.object_detail;
    let is_wanted = |method: &DetailMethod| wanted.methods.contains(method);
    let mut levels = vec![(DetailMethod::Mesh, None)];
    let vertices = Some(DetailMethod::VertexSpheres).filter(is_wanted);
    levels.extend(vertices.map(|method| (method, None)));
    for &mm in &wanted.tolerances_mm {
        let packing = Some(DetailMethod::Packing).filter(is_wanted);
        let methods = packing.into_iter().chain(as_many(plan));
        levels.extend(methods.map(|method| (method, Some(mm))));
    }
    levels
}

/// `n` of the places of `vertices` (all, if there are fewer; never fewer than two), each the farthest from those before it,
/// from the first vertex on.
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
