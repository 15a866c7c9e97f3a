//! Class `Mesh`: triangle meshes.

use crate::arrays::{
    Matrix, Object, Vector, array, corners, points, rows, to_column, to_rows, whole_numbers,
};
use crate::errors::{bad_input, check_readable, exception, guarded, one_of, warn};
use crate::length_unit::unit_of;
use crate::sphere_union::SphereUnion;
use crate::threads::aside;
use bubbletouch::mesh::{LengthUnit, Orientation, SizeLimits, Surface, TriangleMesh};
use bubbletouch::objects::{MeshModel, Model, vertex_spheres};
use bubbletouch::packing::{Body, error_of_file, pack_mesh_watched};
use bubbletouch::study::{pack_with, read_mesh_file};
use glam::DVec3;
use ndarray::Array2;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::path::PathBuf;

/// Advice in the error message for a mesh that cannot be packed.
const ADVICE: &str = "Mesh.read(…, close_holes=WIDTH) closes holes up to that width, pack(…, sheet=True) packs the surface without thickness";

/// Triangle mesh with exact contact: taxels touch its faces, edges and corners, from both sides.
///
/// `Mesh(vertices, triangles)`: vertices (n, 3), metres; triangles (m, 3), vertex indices from 0, counter-clockwise seen from outside. Raises
/// ValueError if a number is not finite or a vertex index does not exist.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Mesh {
    /// Source of the mesh, such as its file, for error messages.
    place: String,
    /// Shape that taxels touch.
    contact: MeshModel,
    model: Model,
    /// Facets of a capsule, which differ from the shape that taxels touch; `None` for a mesh of triangles.
    capsule: Option<CapsuleFacets>,
}

#[derive(Clone)]
struct CapsuleFacets {
    /// Radius, length and tolerance, metres.
    sizes: [f64; 3],
    mesh: TriangleMesh,
}

impl Mesh {
    /// Wraps a triangle mesh; `place` is its source, for error messages.
    pub fn new(place: String, mesh: TriangleMesh) -> Self {
        Self::from_model(place, MeshModel::new(mesh))
    }

    /// Wraps the mesh of a primitive shape.
    fn of_shape(place: &str, mesh: bubbletouch::Result<TriangleMesh>) -> PyResult<Self> {
        Ok(Self::new(place.to_owned(), mesh.map_err(exception)?))
    }

    fn from_model(place: String, contact: MeshModel) -> Self {
        Self {
            place,
            model: Model::Mesh(contact.clone()),
            contact,
            capsule: None,
        }
    }

    /// Returns the mesh as a model of the contact kernel.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the surface as a triangle mesh: the triangles themselves, or the facets of a capsule.
    pub fn triangle_mesh(&self) -> &TriangleMesh {
        match &self.capsule {
            Some(capsule) => &capsule.mesh,
            None => self.contact.mesh(),
        }
    }

    /// Issues a Python warning if triangles of the mesh were turned outwards.
    ///
    /// # Errors
    /// If Python raises the warning as an exception.
    pub fn warn_if_turned(&self, py: Python, orientation: &Orientation) -> PyResult<()> {
        let turned = orientation
            .is_turned()
            .then(|| format!("{}: {orientation}", self.place));
        warn(py, turned, 1)
    }
}

#[pymethods]
impl Mesh {
    #[new]
    fn from_arrays(vertices: &Object, triangles: &Object) -> PyResult<Self> {
        guarded(|| {
            let vertices = points("vertices", vertices)?;
            let triangles = corner_numbers(triangles)?;
            let mesh = TriangleMesh::in_unit("mesh", LengthUnit::Metre, vertices, triangles);
            Self::of_shape("mesh", mesh)
        })
    }

    /// Reads a mesh from a PLY, OBJ, STL, Collada (.dae) or glTF (.glb, .gltf) file.
    ///
    /// unit: unit of the coordinates in the file. If None, the unit is metres, or the unit in a Collada file. The object must then
    /// be 0.1 mm to 10 m in size.
    /// close_holes: maximum width of the holes to close, metres. Each hole is closed by a cone of triangles. Default: no hole is closed.
    ///
    /// Closed parts that face inwards are turned outwards, with a UserWarning. Raises OSError if the file cannot be read, and ValueError if it contains
    /// no valid mesh.
    #[staticmethod]
    #[pyo3(signature = (path, *, unit=None, close_holes=None))]
    fn read(
        py: Python,
        path: PathBuf,
        unit: Option<&str>,
        close_holes: Option<f64>,
    ) -> PyResult<Self> {
        guarded(|| {
            let unit = unit_of(unit)?;
            check_readable(&path)?;
            let place = path.display().to_string();
            let read = || {
                let file = read_mesh_file(&path, unit, &SizeLimits::ANY)?;
                let (mut mesh, orientation) = file.into_mesh(&place)?.turned_outwards();
                let mut orientations = vec![orientation];
                if let Some(widest) = close_holes {
                    let (closed, orientation) =
                        mesh.with_holes_closed(widest)?.mesh.turned_outwards();
                    mesh = closed;
                    orientations.push(orientation);
                }
                Ok((Self::new(place.clone(), mesh), orientations))
            };
            let (mesh, orientations) = py.detach(read).map_err(exception)?;
            for orientation in &orientations {
                mesh.warn_if_turned(py, orientation)?;
            }
            Ok(mesh)
        })
    }

    /// Returns a box about the origin with the side lengths `size` (3,), metres, positive: 12 triangles.
    #[staticmethod]
    #[pyo3(name = "box")]
    fn cuboid(size: &Object) -> PyResult<Self> {
        guarded(|| {
            let size = three_lengths("size", size)?;
            Self::of_shape("box", TriangleMesh::cuboid("box", size))
        })
    }

    /// Returns a cylinder about the origin along z, metres.
    ///
    /// tolerance: largest distance of the facets from the round surface, metres. The facets are inside the cylinder.
    #[staticmethod]
    #[pyo3(signature = (radius, length, tolerance=1e-5))]
    fn cylinder(radius: f64, length: f64, tolerance: f64) -> PyResult<Self> {
        guarded(|| {
            let mesh = TriangleMesh::cylinder("cylinder", radius, length, tolerance);
            Self::of_shape("cylinder", mesh)
        })
    }

    /// Returns an ellipsoid about the origin with the given radii (3,) along the axes, metres.
    ///
    /// tolerance: largest distance of the facets from the surface, metres. The facets are inside the ellipsoid. A SphereUnion of one sphere is an exact
    /// ball.
    #[staticmethod]
    #[pyo3(signature = (radii, tolerance=1e-5))]
    fn ellipsoid(radii: &Object, tolerance: f64) -> PyResult<Self> {
        guarded(|| {
            let radii = three_lengths("radii", radii)?;
            let mesh = TriangleMesh::ellipsoid("ellipsoid", radii, tolerance);
            Self::of_shape("ellipsoid", mesh)
        })
    }

    /// Returns a capsule about the origin along z: a cylinder with a hemisphere at each end. `length` is the distance between the centres of the
    /// hemispheres, metres, zero or more.
    ///
    /// Taxels touch the exact capsule. Its vertices and triangles, and all properties computed from them, describe facets inside the capsule.
    /// tolerance: largest distance of the facets from the surface, metres.
    #[staticmethod]
    #[pyo3(signature = (radius, length, tolerance=1e-5))]
    fn capsule(radius: f64, length: f64, tolerance: f64) -> PyResult<Self> {
        guarded(|| {
            let place = "capsule";
            let mesh = TriangleMesh::capsule(place, radius, length, tolerance);
            let facets = CapsuleFacets {
                sizes: [radius, length, tolerance],
                mesh: mesh.map_err(exception)?,
            };
            let model = MeshModel::capsule(radius, length).map_err(exception)?;
            Ok(Self {
                capsule: Some(facets),
                ..Self::from_model(place.to_owned(), model)
            })
        })
    }

    /// Returns the mirror image of the mesh in the plane through the origin normal to the axis "x", "y" or "z". Triangles that face outwards face
    /// outwards again.
    fn mirrored(&self, axis: &str) -> PyResult<Self> {
        guarded(|| {
            let number = one_of("axis", axis, &[("x", 0), ("y", 1), ("z", 2)])?;
            // A capsule is its own mirror image.
            Ok(match &self.capsule {
                Some(facets) => Self {
                    capsule: Some(facets.clone()),
                    ..Self::from_model(self.place.clone(), self.contact.clone())
                },
                None => Self::new(self.place.clone(), self.contact.mesh().mirrored(number)),
            })
        })
    }

    /// Packs the solid enclosed by the mesh with few spheres, on all cores.
    ///
    /// No sphere extends more than tolerance / 2 (metres, positive) beyond the surface. No point of the surface is more than the tolerance outside the
    /// spheres. If these bounds cannot be reached, ValueError is raised. The mesh must be closed. Parts that face inwards are turned outwards, with a
    /// UserWarning. With sheet=True, the surface is packed as a sheet without thickness; the mesh may then be open. A scan of 16,000 triangles takes
    /// seconds. Ctrl-C ends the call.
    ///
    /// cache: folder of packings, created if missing. If the folder contains the spheres of an equal mesh and tolerance, these are read; otherwise, the
    /// spheres are written to it. Studies use the same files, in the folder packings beside their results. Several processes can share a folder.
    #[pyo3(signature = (tolerance, *, sheet=false, cache=None))]
    fn pack(
        &self,
        py: Python,
        tolerance: f64,
        sheet: bool,
        cache: Option<PathBuf>,
    ) -> PyResult<SphereUnion> {
        guarded(|| {
            let mesh = self.triangle_mesh().clone();
            let place = self.place.clone();
            let body = if sheet { Body::Sheet } else { Body::Solid };
            let (orientation, packed) = aside(py, move |stop| {
                let (mesh, orientation) = match body {
                    Body::Solid => mesh.turned_outwards(),
                    Body::Sheet => (mesh, Orientation::Outwards),
                };
                let surface = Surface::new(mesh);
                let watch = &mut |_| stop.end_if_told();
                let packed = pack_with(&surface, (body, tolerance), cache.as_deref(), || {
                    let packed = pack_mesh_watched(&surface, body, tolerance, watch);
                    packed.map_err(|error| error_of_file(error, &place, ADVICE))
                });
                (orientation, packed)
            })?;
            let packed = packed.map_err(exception)?;
            self.warn_if_turned(py, &orientation)?;
            Ok(SphereUnion::from_spheres(packed.spheres))
        })
    }

    /// Returns one sphere per distinct vertex, as in the original BubbleTouch. All radii equal twice the mean distance from a vertex to its nearest
    /// neighbour.
    fn vertex_spheres(&self) -> PyResult<SphereUnion> {
        guarded(|| {
            let vertices = self.triangle_mesh().vertices();
            let spheres = vertex_spheres(&self.place, vertices).map_err(exception)?;
            Ok(SphereUnion::from_spheres(spheres))
        })
    }

    /// Vertices of the mesh (n, 3), metres; a copy.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        to_rows(py, self.triangle_mesh().vertices().iter().copied())
    }

    /// Triangles of the mesh (m, 3) as vertex indices; a copy.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> Matrix<'py, u32> {
        let triangles = self.triangle_mesh().triangles();
        Array2::from(triangles.to_vec()).into_pyarray(py)
    }

    /// Bounding box (2, 3): the smallest and largest coordinates, metres.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        corners(py, &self.contact.bounds())
    }

    /// Surface area of the mesh, m².
    #[getter]
    fn area(&self) -> f64 {
        self.triangle_mesh().area()
    }

    /// Volume of the mesh, m³; negative if the triangles of the given arrays face inwards.
    #[getter]
    fn volume(&self) -> f64 {
        self.triangle_mesh().volume_and_centroid().0
    }

    /// Centroid of the mesh's volume (3,), metres.
    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_column(py, self.triangle_mesh().volume_and_centroid().1.to_array())
    }

    /// Number of triangles of the mesh.
    fn __len__(&self) -> usize {
        self.triangle_mesh().n_triangles()
    }

    fn __repr__(&self) -> String {
        let size = self.contact.bounds().size() * 1e3;
        let (n, place) = (self.triangle_mesh().n_triangles(), &self.place);
        let [x, y, z] = [size.x, size.y, size.z];
        format!("<bubbletouch.Mesh {place}: {n} triangles, {x:.1} × {y:.1} × {z:.1} mm>")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Object<'py>, Bound<'py, PyTuple>)> {
        let class = py.get_type::<Self>();
        Ok(match &self.capsule {
            Some(capsule) => (class.getattr("capsule")?, PyTuple::new(py, capsule.sizes)?),
            None => {
                let arrays = (self.vertices(py), self.triangles(py));
                (class.into_any(), arrays.into_pyobject(py)?)
            }
        })
    }
}

/// Reads three positive lengths, metres.
fn three_lengths(place: &str, given: &Object) -> PyResult<DVec3> {
    let allowed = "(3,) of positive numbers of metres";
    let lengths = array(place, given, allowed, |shape| shape == [3])?;
    let lengths = DVec3::from_slice(lengths.values());
    match lengths.is_finite() && lengths.cmpgt(DVec3::ZERO).all() {
        true => Ok(lengths),
        false => Err(bad_input(place, lengths, allowed)),
    }
}

/// Reads the vertex indices of triangles from an n × 3 array of integers.
fn corner_numbers(given: &Object) -> PyResult<Vec<[u32; 3]>> {
    let corners = rows::<3>("triangles", given)?;
    let allowed = "whole numbers of vertices, from 0";
    let corners: Vec<u32> = whole_numbers("triangles", corners.as_flattened(), allowed)?;
    Ok(corners.as_chunks::<3>().0.to_vec())
}
