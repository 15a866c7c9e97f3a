//! Class `Robot`: links, joints and poses of a robot of a URDF or MJCF file.

use crate::arrays::{Object, Rows, array, shape_of, to_column, to_matrix};
use crate::errors::{bad_input, check_number, check_readable, exception, guarded, named};
use crate::mesh::Mesh;
use crate::poses::Poses;
use bubbletouch::geometry::Pose;
use bubbletouch::scene::{LinkSurface, link_surface};
use bubbletouch::world::{MeshFolders, Robot as WorldRobot};
use ndarray::Array2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Robot of a URDF or MJCF file: links, joints and their poses. Use Robot.read.
///
/// The base of a URDF robot is the link that no joint moves. The base of an MJCF robot is the link `world`; the other links are the bodies and, after them,
/// the sites with a name.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Robot {
    robot: WorldRobot,
    meshes: MeshFolders,
}

/// Joint position of a Robot. Fixed joints and joints that mimic others have none.
#[pyclass(frozen, get_all, module = "bubbletouch")]
pub struct Joint {
    /// Name of the joint. A joint of several positions has the suffixes .x, .y, .z, .roll, .pitch, .yaw or .theta.
    name: String,
    /// Kind of the joint: revolute, continuous, prismatic, planar, floating or ball.
    kind: String,
    /// Lowest and highest position, radians or metres; infinite without a limit.
    range: (f64, f64),
    /// Position if `q` does not contain the joint: in URDF 0 or the limit nearest to 0, in MJCF `ref`.
    default: f64,
}

#[pymethods]
impl Joint {
    fn __repr__(&self) -> String {
        let Self {
            name,
            kind,
            range: (lower, upper),
            default,
        } = self;
        format!("Joint(name={name:?}, kind={kind:?}, range=({lower}, {upper}), default={default})")
    }
}

#[pymethods]
impl Robot {
    /// Reads a robot from a URDF or MJCF file. The root element determines the format.
    ///
    /// packages: folders by the names of packages, for meshes at package://NAME/…. If None, packages are searched in the folders above the file.
    ///
    /// Parts of the file that are not used are listed in `notes`. Mesh files are opened only by mesh(). Raises OSError if the file cannot be read, and
    /// ValueError if a part that places links is invalid.
    #[staticmethod]
    #[pyo3(signature = (file, packages=None))]
    fn read(
        py: Python,
        file: PathBuf,
        packages: Option<BTreeMap<String, PathBuf>>,
    ) -> PyResult<Self> {
        guarded(|| {
            check_readable(&file)?;
            let packages = packages.unwrap_or_default();
            for (name, folder) in &packages {
                if !folder.is_dir() {
                    let given = format!("{}, which is no folder", folder.display());
                    return Err(bad_input(format!("packages[{name:?}]"), given, "a folder"));
                }
            }
            let robot = py.detach(|| WorldRobot::read(&file)).map_err(exception)?;
            Ok(Self {
                robot,
                meshes: MeshFolders::beside(&file, packages),
            })
        })
    }

    /// Name of the robot.
    #[getter]
    fn name(&self) -> &str {
        self.robot.name()
    }

    /// Names of all links.
    #[getter]
    fn links(&self) -> Vec<&str> {
        let links = self.robot.links().iter();
        links.map(|link| link.name.as_str()).collect()
    }

    /// Joint positions that `q` contains, in the order of `q`.
    #[getter]
    fn joints(&self) -> Vec<Joint> {
        let coordinates = self.robot.coordinates().iter();
        let rest = self.robot.rest_positions();
        let joints = coordinates.zip(rest).map(|(coordinate, default)| {
            let joint = &self.robot.joints()[coordinate.joint];
            let limits = joint.limits;
            Joint {
                name: coordinate.name.clone(),
                kind: format!("{:?}", joint.kind).to_lowercase(),
                range: limits.map_or((f64::NEG_INFINITY, f64::INFINITY), |limits| {
                    (limits.lower, limits.upper)
                }),
                default,
            }
        });
        joints.collect()
    }

    /// Remarks on parts of the file that are not used.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.robot.notes().to_vec()
    }

    /// Returns the pose of a link in the world for joint positions `q`.
    ///
    /// q: dict from the names of joints to positions, numbers or (n,), radians and metres; or an array (d,) or (n, d) in the order of `joints`. Joints that the
    /// dict does not contain, and all joints without q, have their default positions. Limits are not checked.
    /// base: pose of the base in the world, (7,) or (4, 4). Default: the identity.
    ///
    /// Returns x, y, z, qw, qx, qy, qz: (7,), or (n, 7) for n positions. Raises ValueError if an argument is invalid.
    #[pyo3(signature = (link, q=None, *, base=None))]
    fn pose<'py>(
        &self,
        py: Python<'py>,
        link: &str,
        q: Option<&Object<'py>>,
        base: Option<&Object<'py>>,
    ) -> PyResult<Object<'py>> {
        guarded(|| {
            let link = self.robot.link(link).map_err(exception)?;
            let base = base.map(|base| Poses::single("base", base)).transpose()?;
            let base = base.unwrap_or(Pose::IDENTITY);
            let (positions, is_one) = self.positions(q)?;
            let poses = py.detach(|| {
                let mut links = vec![Pose::IDENTITY; self.robot.links().len()];
                let rows = positions.rows().into_iter();
                let poses = rows.map(|row| {
                    let row = row.to_vec();
                    self.robot.forward_into(&base, &row, &mut links)?;
                    Ok(links[link].to_array())
                });
                poses.collect::<bubbletouch::Result<Vec<[f64; 7]>>>()
            });
            let poses = poses.map_err(exception)?;
            Ok(match is_one {
                true => to_column(py, poses[0]).into_any(),
                false => to_matrix(py, poses).into_any(),
            })
        })
    }

    /// Returns the surface of a link as a mesh in the link's frame, for example for Patch.draped.
    ///
    /// shapes: collision or visual. If None, the collision shapes are used, or the visual shapes if the link has no collision shapes.
    /// pitch: distance of the taxels for which the facets of round shapes are fine enough, metres.
    ///
    /// Raises ValueError if the link has no such shapes, or a mesh file is not found or invalid.
    #[pyo3(signature = (link, *, shapes=None, pitch=1e-3))]
    fn mesh(&self, py: Python, link: &str, shapes: Option<&str>, pitch: f64) -> PyResult<Mesh> {
        guarded(|| {
            let role = shapes.map(|name| named("shapes", name)).transpose()?;
            let is_length = |length: f64| length.is_finite() && length > 0.0;
            check_number(
                "pitch",
                Some(pitch),
                "a positive number of metres",
                is_length,
            )?;
            let surface = LinkSurface { link, role };
            let mesh = py.detach(|| link_surface(&self.robot, &self.meshes, &surface, pitch));
            Ok(Mesh::new(link.to_owned(), mesh.map_err(exception)?))
        })
    }

    fn __repr__(&self) -> String {
        format!(
            "Robot(name={:?}, {} links, {} joints)",
            self.robot.name(),
            self.robot.links().len(),
            self.robot.n_positions()
        )
    }
}

impl Robot {
    /// Returns the joint positions of `q`, shape (n, d), and whether the argument was a single set of positions.
    fn positions(&self, q: Option<&Object>) -> PyResult<(Array2<f64>, bool)> {
        let rest = self.robot.rest_positions();
        let n_joints = rest.len();
        let Some(q) = q else {
            let row = Array2::from_shape_vec((1, n_joints), rest);
            return Ok((row.expect("one row"), true));
        };
        let Ok(q) = q.cast::<PyDict>() else {
            let allowed = format!("a dict, ({n_joints},) or (n, {n_joints})");
            let is_shape = |shape: &[usize]| shape.len() <= 2 && shape.last() == Some(&n_joints);
            let array = array("q", q, &allowed, is_shape)?;
            let n_rows = if let [n, _] = array.shape() { *n } else { 1 };
            let rows = Array2::from_shape_vec((n_rows, n_joints), array.values().to_vec());
            let rows = rows.expect("as many values as the shape");
            return Ok((rows, array.shape().len() == 1));
        };
        let mut n_rows = None;
        let mut given = Vec::with_capacity(q.len());
        for (name, values) in q {
            let words = || bad_input("q", &name, "names of joints");
            let name = name.cast::<PyString>().map_err(|_| words())?.to_string();
            let joint = self.robot.position(&name).map_err(exception)?;
            let place = format!("q[{name:?}]");
            let values = Rows::<1>::read(&place, &values)?;
            if let Some(n) = values.n()
                && *n_rows.get_or_insert(n) != n
            {
                let known = n_rows.unwrap_or_default();
                let allowed = format!("a number or ({known},), as for the joints before");
                return Err(bad_input(place, shape_of(&[n]), allowed));
            }
            given.push((joint, values));
        }
        let n = n_rows.unwrap_or(1);
        let mut positions = Array2::from_shape_fn((n, n_joints), |(_, joint)| rest[joint]);
        for (joint, values) in given {
            for (row, position) in positions.column_mut(joint).iter_mut().enumerate() {
                [*position] = values.at(row);
            }
        }
        Ok((positions, n_rows.is_none()))
    }
}
