//! What is touched: a closed mesh or a solid, as spheres of each detail and exactly.

use super::rows::ContactWay;
use super::solid_contact::press_solid;
use crate::error::Result;
use crate::kinds::object_detail::Truth;
use crate::mesh::Surface;
use crate::objects::{Entry, MeshModel, Model, vertex_spheres};
use crate::random::Seed;
use crate::study::object_files::{NamedMesh, load_named_meshes, set_entries};
use crate::study::packings::pack_within;
use crate::study::plan::MM;
use crate::study::spec::ObjectsSpec;
use crate::study::taxel_array::TaxelArray;
use crate::world::Placement;
use std::path::Path;

/// An object before it has a model.
pub(super) enum Subject {
    /// A closed mesh: its file, and its surface.
    Mesh {
        name: String,
        place: String,
        surface: Box<Surface>,
    },
    /// A solid of a set.
    Solid(Entry),
}

/// All objects of a study, solids first.
pub(super) fn load_subjects(spec: &ObjectsSpec) -> Result<Vec<Subject>> {
    let mut subjects = Vec::new();
    for set in &spec.sets {
        let entries = set_entries(set, spec.names.as_deref())?;
        subjects.extend(entries.into_iter().map(Subject::Solid));
    }
    if let Some(folder) = &spec.meshes {
        let meshes = load_named_meshes(folder, spec)?.into_iter();
        subjects.extend(meshes.map(|NamedMesh { name, place, mesh }| {
            let surface = Box::new(Surface::new(mesh));
            Subject::Mesh {
                name,
                place,
                surface,
            }
        }));
    }
    Ok(subjects)
}

/// At most `n` of them, spread evenly over the list, the first and the last among them.
pub(super) fn spread_evenly<T>(all: &[T], n: usize) -> Vec<&T> {
    let n = n.min(all.len());
    let last = all.len().saturating_sub(1);
    let gaps = n.saturating_sub(1).max(1);
    (0..n).map(|k| &all[k * last / gaps]).collect()
}

impl Subject {
    pub fn name(&self) -> &str {
        match self {
            Self::Mesh { name, .. } => name,
            Self::Solid(entry) => &entry.name,
        }
    }

    /// Spheres within so many millimetres; those of meshes are looked for and kept in the folder `packings`.
    pub fn packed(&self, within_mm: f64, packings: Option<&Path>) -> Result<Model> {
        let tolerance = within_mm * MM;
        match self {
            Self::Mesh { place, surface, .. } => {
                let packed = pack_within(place, surface, tolerance, packings)?;
                Ok(packed.spheres.into())
            }
            Self::Solid(entry) => Ok(entry.build(tolerance)?.model),
        }
    }

    /// Ways to evaluate contact with it that have a model, with the tolerance (mm) of packed spheres, which come first.
    pub fn models(
        &self,
        levels_mm: &[f64],
        packings: Option<&Path>,
    ) -> Result<Vec<(ContactWay, Option<f64>, Model)>> {
        let packed = levels_mm.iter().map(|&level| {
            let model = self.packed(level, packings)?;
            Ok((ContactWay::PackedSpheres, Some(level), model))
        });
        let mut models = packed.collect::<Result<Vec<_>>>()?;
        if let Self::Mesh { place, surface, .. } = self {
            let mesh = surface.mesh();
            let spheres = vertex_spheres(place, mesh.vertices())?;
            models.push((ContactWay::VertexSpheres, None, spheres.into()));
            let exact = MeshModel::new(mesh.clone());
            models.push((ContactWay::ExactMesh, None, exact.into()));
        }
        Ok(models)
    }

    /// The model that is the object itself, or as near to it as it gets: the triangles, or spheres within half of the finest tolerance.
    pub fn exact(&self, finest_mm: f64) -> Result<Model> {
        match self {
            Self::Mesh { surface, .. } => Ok(MeshModel::new(surface.mesh().clone()).into()),
            Self::Solid(_) => self.packed(0.5 * finest_mm, None),
        }
    }

    /// The touches that every study would draw for an object of this name, and what exact contact says of them.
    pub fn truth(
        &self,
        array: &TaxelArray,
        placement: &Placement,
        (finest_mm, seed): (f64, &Seed),
    ) -> Result<Truth> {
        let exact = (self.name(), self.exact(finest_mm)?);
        let mut truth = Truth::new(exact, array, placement, seed)?;
        if let Self::Solid(entry) = self {
            truth.feel_instead(|pose| press_solid(array.patch(), &entry.solid, pose));
        }
        Ok(truth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_are_spread_over_the_whole_list_and_none_comes_twice() {
        let all: Vec<usize> = (0..38).collect();
        assert_eq!(spread_evenly(&all, 3), [&0, &18, &37]);
        assert_eq!(spread_evenly(&all, 1), [&0]);
        assert_eq!(spread_evenly(&all, 99).len(), 38);
        assert!(spread_evenly::<usize>(&[], 3).is_empty());
        for n in 2..=38 {
            let mut chosen = spread_evenly(&all, n);
            assert_eq!((chosen[0], chosen[n - 1]), (&0, &37));
            chosen.dedup();
            assert_eq!(chosen.len(), n);
        }
    }
}
