//! Flat grid of taxels, projected onto the surface of a mesh.

use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::mesh::{Bvh, TriangleMesh};
use crate::world::{Grid, Layout};
use glam::{DVec2, DVec3};

/// Lateral offset of a second ray, relative to the size of the mesh. Due to rounding, the first ray may pass between two triangles exactly at their common
/// edge. If larger, the second ray may hit another face; if smaller, it may pass through the same edge.
const ASIDE: f64 = 1e-9;
/// Directions of the lateral offsets, in the plane of the grid. None is parallel to an edge that is likely in a mesh.
const OFFSETS: [DVec2; 4] = [
    DVec2::new(0.8, 0.61),
    DVec2::new(-0.61, 0.8),
    DVec2::new(-0.8, -0.61),
    DVec2::new(0.61, -0.8),
];
/// Smallest cosine between the surface normal and the z axis of the grid. A face with a smaller cosine is parallel to the rays, and its point is undetermined.
const MIN_COSINE: f64 = 1e-9;

/// Treatment of taxels of a projected grid that do not meet the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissingTaxels {
    /// The projection returns an error that names the first such taxel.
    #[default]
    Refuse,
    /// The layout omits such taxels and counts them.
    Drop,
}

/// Grid that was projected onto a mesh.
#[derive(Clone, Debug)]
pub struct Projected {
    /// Taxels in the mesh frame, row by row. The layout has rows and columns if no taxel was omitted.
    pub layout: Layout,
    /// Row and column of each taxel in the grid, shape (n_taxels,).
    pub pixels: Vec<[usize; 2]>,
}

impl Layout {
    /// Projects a flat grid onto a mesh, as if a flat array were wrapped around the surface.
    ///
    /// The grid lies in the plane z = 0 of a frame with the pose `mesh_from_grid`. Each taxel moves along −z to the first point of the mesh; its axis is the
    /// outward unit normal of the triangle at this point. A grid that touches or intersects the mesh has taxels that start inside and meet no outer face.
    ///
    /// # Errors
    /// If the grid is invalid, no taxel meets the mesh, or a taxel misses the mesh and `missing` is [`MissingTaxels::Refuse`]. The error then contains the row
    /// and the column of the taxel, from 0.
    pub fn projected(
        mesh: &TriangleMesh,
        mesh_from_grid: &Pose,
        grid: &Grid,
        missing: MissingTaxels,
    ) -> Result<Projected> {
        const PLACE: &str = "projected layout";
        let flat = Self::grid(grid)?;
        let surface = RayTarget::new(mesh, mesh_from_grid);
        let (mut taxels, mut pixels) = (Vec::new(), Vec::new());
        for (number, center) in flat.centers().iter().enumerate() {
            let pixel = [number / grid.nx, number % grid.nx];
            match surface.first_hit(mesh_from_grid.transform_point(*center)) {
                Some(taxel) => {
                    taxels.push(taxel);
                    pixels.push(pixel);
                }
                None if missing == MissingTaxels::Drop => {}
                None => {
                    let [row, column] = pixel;
                    let given =
                        format!("the taxel in row {row}, column {column} meets no outer face");
                    let allowed = "a grid in front of the mesh, above its surface with all taxels";
                    return Err(Error::input(PLACE, given, allowed));
                }
            }
        }
        if taxels.is_empty() {
            let allowed = "a grid in front of the mesh, with its z axis away from the surface";
            return Err(Error::input(PLACE, "no taxel meets an outer face", allowed));
        }
        let n_left_out = flat.n_taxels() - taxels.len();
        let layout = Self::of_taxels(taxels).with_left_out(n_left_out);
        let layout = match n_left_out {
            0 => layout.with_sides([grid.ny, grid.nx])?,
            _ => layout,
        };
        Ok(Projected { layout, pixels })
    }
}

/// Mesh that rays of one direction hit.
struct RayTarget<'a> {
    mesh: &'a TriangleMesh,
    bvh: Bvh,
    /// Unit direction of the rays.
    direction: DVec3,
    /// Starting points of the rays, relative to the taxel: the taxel itself, then points beside it.
    starts: Vec<DVec3>,
}

impl<'a> RayTarget<'a> {
    fn new(mesh: &'a TriangleMesh, mesh_from_grid: &Pose) -> Self {
        let bvh = Bvh::new(mesh);
        let aside = ASIDE * bvh.bounds().size().length();
        let offset = |offset: DVec2| mesh_from_grid.transform_vector(aside * offset.extend(0.0));
        Self {
            mesh,
            bvh,
            direction: mesh_from_grid.transform_vector(DVec3::NEG_Z),
            starts: std::iter::once(DVec3::ZERO)
                .chain(OFFSETS.map(offset))
                .collect(),
        }
    }

    /// Returns the first point of the mesh on the ray from `start`, and the unit normal of the surface there. Returns `None` if the ray meets no face, or meets
    /// the inner side of a face first.
    fn first_hit(&self, start: DVec3) -> Option<(DVec3, DVec3)> {
        self.starts.iter().find_map(|offset| {
            let origin = start + *offset;
            let range = 0.0..f64::INFINITY;
            let hit = self.bvh.first_hit(origin, self.direction, range)?;
            let triangle = self.mesh.triangle(hit.triangle);
            let normal = triangle.normal()?;
            let cosine = -normal.dot(self.direction);
            if cosine < MIN_COSINE {
                return None;
            }
            // The point lies exactly below the taxel, in the plane of the triangle.
            let along = (start - triangle.middle()).dot(normal) / cosine;
            Some((start + along * self.direction, normal))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    const GRID: Grid = Grid {
        nx: 5,
        ny: 4,
        pitch: 2e-3,
    };

    fn cube() -> TriangleMesh {
        TriangleMesh::cuboid("cube", DVec3::splat(0.02)).unwrap()
    }

    #[test]
    fn a_grid_above_a_face_keeps_its_places_on_the_face() {
        let odd = Grid { ny: 5, ..GRID };
        // The rays of an odd grid hit the diagonal of the face exactly.
        for grid in [GRID, odd] {
            let pose = Pose::from_translation(0.03 * DVec3::Z);
            let projected = Layout::projected(&cube(), &pose, &grid, MissingTaxels::Refuse);
            let Projected { layout, pixels } = projected.unwrap();
            assert_eq!(layout.sides(), Some([grid.ny, grid.nx]));
            for (taxel, center) in layout.centers().iter().enumerate() {
                let [row, column] = pixels[taxel];
                let expected = DVec3::new(grid.x(column), grid.y(row), 0.01);
                assert!((*center - expected).length() < 1e-16, "{center}");
                assert_eq!(layout.axes()[taxel], DVec3::Z);
            }
        }
    }

    #[test]
    fn taxels_on_a_sphere_lie_below_the_grid_with_radial_axes() {
        let radius = 0.03;
        // 60 facets around each circle.
        let ball = TriangleMesh::ellipsoid("ball", DVec3::splat(radius), 8.3e-5).unwrap();
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 0.2);
        let pose = Pose::new(turn, turn * (0.05 * DVec3::Z));
        let projected = Layout::projected(&ball, &pose, &GRID, MissingTaxels::Refuse).unwrap();
        let grid_from_mesh = pose.inverse();
        for (taxel, center) in projected.layout.centers().iter().enumerate() {
            let [row, column] = projected.pixels[taxel];
            let place = grid_from_mesh.transform_point(*center);
            let expected = DVec2::new(GRID.x(column), GRID.y(row));
            assert!((place.truncate() - expected).length() < 1e-15);
            // With 60 facets around a circle, a facet is at most 0.14 % of the radius inside, and inclined by at most 3°. Along diagonals, both values double.
            assert!((center.length() / radius - 1.0).abs() < 3e-3);
            let axis = projected.layout.axes()[taxel];
            assert!(axis.dot(center.normalize()) > 0.997, "{axis}");
        }
    }

    #[test]
    fn taxels_that_miss_are_refused_or_dropped() {
        let pose = Pose::from_translation(DVec3::new(0.0065, 0.0, 0.03));
        let project = |missing| Layout::projected(&cube(), &pose, &GRID, missing);
        let error = project(MissingTaxels::Refuse).unwrap_err().to_string();
        let expected = "projected layout: the taxel in row 0, column 4 meets no outer face; a grid in front of";
        assert!(error.starts_with(expected), "{error}");
        let dropped = project(MissingTaxels::Drop).unwrap();
        let layout = &dropped.layout;
        assert_eq!((layout.n_taxels(), layout.n_left_out()), (16, 4));
        assert_eq!(layout.sides(), None);
        assert_eq!(dropped.pixels[4], [1, 0]);
        // A grid inside the cube meets only inner sides of faces. A grid below the cube meets no face.
        for height in [0.0, -0.03] {
            let pose = Pose::from_translation(height * DVec3::Z);
            let error = Layout::projected(&cube(), &pose, &GRID, MissingTaxels::Drop);
            let error = error.unwrap_err().to_string();
            assert!(error.contains("no taxel meets an outer face"), "{error}");
        }
    }
}
