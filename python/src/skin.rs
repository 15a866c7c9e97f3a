//! `Skin`: several patches read under several bodies at once, as a simulator's loop needs them.

use crate::arrays::{numbers, shape_of};
use crate::errors::{bad_input, guarded};
use crate::model::model_of;
use crate::patch::Patch;
use crate::poses::{from_numbers, from_parts};
use bubbletouch::contact::{Workspace, press_at_pose};
use bubbletouch::geometry::{Aabb, Pose};
use bubbletouch::objects::Model;
use bubbletouch::world;
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::Mutex;

const ALLOWED: &str = "(…, k, 7) of x, y, z, qw, qx, qy, qz; (…, k, 4, 4); or a pair of positions (…, k, 3) and rotations (…, k, 4), (…, k, 9) or (…, k, 3, 3)";

/// Patches of skin and bodies that may touch them, read at given poses in one call.
///
/// `Skin(patches, bodies)`: patches, a sequence of Patch; bodies, a sequence of Mesh or SphereUnion. A taxel that several bodies deflect has the largest
/// of the deflections. Raises ValueError for an empty sequence of patches.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Skin {
    patches: Vec<SkinPatch>,
    bodies: Vec<Body>,
    /// Number of taxels of all patches.
    n_taxels: usize,
    scratch: Mutex<SkinWorkspace>,
}

/// Patch of a skin, with a ball (centre and radius) that contains all its taxels.
struct SkinPatch {
    patch: world::Patch,
    /// Index of the patch's first taxel in a frame of the skin.
    first: usize,
    ball: Ball,
}

struct Body {
    model: Model,
    ball: Ball,
}

/// Ball that contains a patch or a body, in its own frame, metres.
#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
}

impl Ball {
    fn around(bounds: &Aabb) -> Self {
        Self {
            center: 0.5 * (bounds.min + bounds.max),
            radius: 0.5 * (bounds.max - bounds.min).length(),
        }
    }
}

/// Memory that successive calls of `read` reuse.
#[derive(Default)]
struct SkinWorkspace {
    workspace: Workspace,
    patch_poses: Vec<Pose>,
    body_poses: Vec<Pose>,
    frame: Vec<f64>,
    wrenches: Vec<f64>,
}

/// Quantity that a frame contains: deflections or forces.
#[derive(Clone, Copy, PartialEq)]
enum Output {
    Deflection,
    Force,
}

#[pymethods]
impl Skin {
    #[new]
    fn new(patches: Vec<Bound<Patch>>, bodies: Vec<Bound<PyAny>>) -> PyResult<Self> {
        guarded(|| {
            if patches.is_empty() {
                return Err(bad_input("patches", "none", "at least one Patch"));
            }
            let mut first = 0;
            let patches = patches.iter().map(|patch| {
                let patch = patch.get().inner().clone();
                let taxels = patch.layout().centers().iter().enumerate();
                let reach = taxels
                    .clone()
                    .map(|(taxel, _)| patch.taxels().at(taxel).radius);
                let reach = reach.fold(0.0, f64::max);
                let (min, max) = taxels.fold(
                    (DVec3::INFINITY, DVec3::NEG_INFINITY),
                    |(min, max), (_, center)| (min.min(*center), max.max(*center)),
                );
                let bounds = Aabb {
                    min: min - reach,
                    max: max + reach,
                };
                let placed = SkinPatch {
                    ball: Ball::around(&bounds),
                    first,
                    patch,
                };
                first += placed.patch.n_taxels();
                placed
            });
            let patches: Vec<SkinPatch> = patches.collect();
            let bodies = bodies.iter().enumerate().map(|(number, body)| {
                let model = model_of(&format!("bodies[{number}]"), body)?.clone();
                model.prepare();
                Ok(Body {
                    ball: Ball::around(&model.bounds()),
                    model,
                })
            });
            Ok(Self {
                bodies: bodies.collect::<PyResult<_>>()?,
                patches,
                n_taxels: first,
                scratch: Mutex::default(),
            })
        })
    }

    /// Number of taxels of all patches.
    #[getter]
    fn n_taxels(&self) -> usize {
        self.n_taxels
    }

    /// First and last index (exclusive) of each patch's taxels in a frame: a list of pairs, one per patch.
    #[getter]
    fn ranges(&self) -> Vec<(usize, usize)> {
        let of = |patch: &SkinPatch| (patch.first, patch.first + patch.patch.n_taxels());
        self.patches.iter().map(of).collect()
    }

    /// Reads all patches under all bodies; returns a frame of the skin, (n_taxels,) or (n, n_taxels) float64, patch after patch.
    ///
    /// patch_poses, body_poses: poses in the world of the patches and of the bodies, in their order: (k, 7) or (n, k, 7) of x, y, z, qw, qx, qy, qz;
    /// (…, k, 4, 4); or a pair (positions, rotations) with positions (…, k, 3) and rotations (…, k, 4) as quaternions w, x, y, z, or (…, k, 9) or
    /// (…, k, 3, 3) as matrices by rows, as MuJoCo has them.
    /// output: "deflection", metres, or "force", newtons along the axis of each taxel (stiffness times deflection).
    /// out: float64 array of the frame's shape, C order, which is filled and returned.
    /// wrenches: (n_patches, 6) or (n, n_patches, 6) float64 array that is filled with the force and the torque of the normal forces on each patch, in
    /// the patch's frame about its origin, newtons and newton metres.
    #[pyo3(signature = (patch_poses, body_poses, *, output="deflection", out=None, wrenches=None))]
    fn read<'py>(
        &self,
        py: Python<'py>,
        patch_poses: &Bound<'py, PyAny>,
        body_poses: &Bound<'py, PyAny>,
        output: &str,
        out: Option<Bound<'py, PyAny>>,
        wrenches: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        guarded(|| {
            let output = match output {
                "deflection" => Output::Deflection,
                "force" => Output::Force,
                other => {
                    let allowed = "\"deflection\" or \"force\"";
                    return Err(bad_input("output", format!("{other:?}"), allowed));
                }
            };
            let mut scratch = self
                .scratch
                .lock()
                .unwrap_or_else(|poisoned| poisoned.into_inner());
            let scratch = &mut *scratch;
            let (n_patches, n_bodies) = (self.patches.len(), self.bodies.len());
            let of_patches = read_poses(
                "patch_poses",
                patch_poses,
                n_patches,
                &mut scratch.patch_poses,
            )?;
            let of_bodies =
                read_poses("body_poses", body_poses, n_bodies, &mut scratch.body_poses)?;
            if of_patches != of_bodies {
                let words = |n: Option<usize>| n.map_or("one".to_owned(), |n| n.to_string());
                let given = format!(
                    "{} patch_poses, {} body_poses",
                    words(of_patches),
                    words(of_bodies)
                );
                return Err(bad_input("poses", given, "equally many of both"));
            }
            let n = of_patches.unwrap_or(1);
            py.detach(|| self.compute(scratch, n, output));
            let shape: Vec<usize> = of_patches.into_iter().chain([self.n_taxels]).collect();
            if let Some(wrenches) = &wrenches {
                let shape: Vec<usize> = of_patches.into_iter().chain([n_patches, 6]).collect();
                fill("wrenches", wrenches, &shape, &scratch.wrenches)?;
            }
            match out {
                Some(out) => {
                    fill("out", &out, &shape, &scratch.frame)?;
                    Ok(out)
                }
                None => {
                    let frame = PyArray1::from_slice(py, &scratch.frame);
                    match of_patches {
                        None => Ok(frame.into_any()),
                        Some(n) => {
                            let frame: Bound<PyArray2<f64>> = frame.reshape([n, self.n_taxels])?;
                            Ok(frame.into_any())
                        }
                    }
                }
            }
        })
    }

    fn __len__(&self) -> usize {
        self.patches.len()
    }

    fn __repr__(&self) -> String {
        format!(
            "<bubbletouch.Skin: {} patches of {} taxels, {} bodies>",
            self.patches.len(),
            self.n_taxels,
            self.bodies.len()
        )
    }
}

impl Skin {
    /// Computes the frames and the wrenches of `n` sets of poses into the scratch memory.
    fn compute(&self, scratch: &mut SkinWorkspace, n: usize, output: Output) {
        let (n_patches, n_bodies) = (self.patches.len(), self.bodies.len());
        scratch.frame.clear();
        scratch.frame.resize(n * self.n_taxels, 0.0);
        scratch.wrenches.clear();
        scratch.wrenches.resize(n * n_patches * 6, 0.0);
        let wrenches = scratch.wrenches.chunks_exact_mut(6);
        for (index, (world_from_patch, wrench)) in
            scratch.patch_poses.iter().zip(wrenches).enumerate()
        {
            let (set, number) = (index / n_patches, index % n_patches);
            let skin = &self.patches[number];
            let start = set * self.n_taxels + skin.first;
            let frame = &mut scratch.frame[start..][..skin.patch.n_taxels()];
            let poses = &scratch.body_poses[set * n_bodies..][..n_bodies];
            let patch_from_world = world_from_patch.inverse();
            let patch_from_bodies = poses.iter().map(|pose| patch_from_world.compose(pose));
            let bodies = self.bodies.iter().zip(patch_from_bodies);
            if skin.press(bodies, frame, &mut scratch.workspace) {
                skin.add_wrench(frame, wrench);
                if output == Output::Force {
                    skin.convert_to_forces(frame);
                }
            }
        }
    }
}

impl SkinPatch {
    /// Writes the deflections under all bodies into a frame of zeros. Returns whether a body is within reach of the patch.
    fn press<'b>(
        &self,
        bodies: impl Iterator<Item = (&'b Body, Pose)>,
        frame: &mut [f64],
        workspace: &mut Workspace,
    ) -> bool {
        let mut is_near = false;
        for (body, patch_from_body) in bodies {
            let center = patch_from_body.transform_point(body.ball.center);
            let reach = self.ball.radius + body.ball.radius;
            if center.distance_squared(self.ball.center) > reach * reach {
                continue;
            }
            let model = std::slice::from_ref(&body.model);
            press_at_pose(&self.patch, model, &[patch_from_body], workspace);
            for (taxel, deflection) in frame.iter_mut().zip(workspace.deflections()) {
                *taxel = taxel.max(*deflection);
            }
            is_near = true;
        }
        is_near
    }

    /// Adds the force and the torque of the normal forces on the patch, in its frame about its origin, N and N·m, to `wrench`.
    fn add_wrench(&self, deflections: &[f64], wrench: &mut [f64]) {
        let (layout, taxels) = (self.patch.layout(), self.patch.taxels());
        let places = layout.centers().iter().zip(layout.axes());
        let touched = deflections.iter().zip(places).enumerate();
        for (index, (deflection, (center, axis))) in touched.filter(|(_, (d, _))| **d > 0.0) {
            let force = -(taxels.at(index).stiffness * deflection) * *axis;
            let six = force
                .to_array()
                .into_iter()
                .chain(center.cross(force).to_array());
            for (sum, term) in wrench.iter_mut().zip(six) {
                *sum += term;
            }
        }
    }

    /// Replaces the deflection of each taxel, metres, by its force, newtons.
    fn convert_to_forces(&self, frame: &mut [f64]) {
        for (index, value) in frame.iter_mut().enumerate() {
            *value *= self.patch.taxels().at(index).stiffness;
        }
    }
}

/// Writes numbers into the array `out` of the caller, which must have the given shape.
fn fill(place: &str, out: &Bound<PyAny>, shape: &[usize], numbers: &[f64]) -> PyResult<()> {
    let allowed = || format!("a float64 array in C order of {}", shape_of(shape));
    let Ok(array) = out.cast::<PyArrayDyn<f64>>() else {
        return Err(bad_input(place, out.get_type(), allowed()));
    };
    if array.shape() != shape || !array.is_c_contiguous() {
        return Err(bad_input(place, shape_of(array.shape()), allowed()));
    }
    let mut array = array
        .try_readwrite()
        .map_err(|error| bad_input(place, error, "a writeable array"))?;
    array.as_slice_mut()?.copy_from_slice(numbers);
    Ok(())
}

/// Reads poses of `n_each` patches or bodies into `poses`. Returns the number of sets of poses; returns `None` if the argument has no axis of sets.
fn read_poses(
    place: &str,
    given: &Bound<PyAny>,
    n_each: usize,
    poses: &mut Vec<Pose>,
) -> PyResult<Option<usize>> {
    poses.clear();
    let pair = given.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
    let Some(pair) = pair else {
        let array = numbers(place, given)?;
        let shape = array.shape().to_vec();
        let width = match shape[..] {
            [.., 4, 4] => 2,
            [.., 7] => 1,
            _ => return Err(bad_input(place, shape_of(&shape), ALLOWED)),
        };
        let sets = n_sets(place, &shape, &shape[..shape.len() - width], n_each)?;
        let array = array
            .try_readonly()
            .map_err(|e| bad_input(place, e, ALLOWED))?;
        let numbers = array.as_slice()?;
        for (number, pose) in numbers
            .chunks_exact(if width == 1 { 7 } else { 16 })
            .enumerate()
        {
            let read = from_numbers(pose);
            poses.push(read.map_err(|_| invalid(place, number))?);
        }
        return Ok(sets);
    };
    let positions = numbers(place, &pair.get_item(0)?)?;
    let rotations = numbers(place, &pair.get_item(1)?)?;
    let shape = positions.shape().to_vec();
    let [leading @ .., 3] = &shape[..] else {
        return Err(bad_input(place, shape_of(&shape), ALLOWED));
    };
    let sets = n_sets(place, &shape, leading, n_each)?;
    let n = sets.unwrap_or(1) * n_each;
    let width = match rotations.shape() {
        [of @ .., 4 | 9] | [of @ .., 3, 3] if of == leading => rotations.len() / n.max(1),
        other => return Err(bad_input(place, shape_of(other), ALLOWED)),
    };
    let positions = positions
        .try_readonly()
        .map_err(|e| bad_input(place, e, ALLOWED))?;
    let rotations = rotations
        .try_readonly()
        .map_err(|e| bad_input(place, e, ALLOWED))?;
    let each = positions.as_slice()?.chunks_exact(3);
    let each = each.zip(rotations.as_slice()?.chunks_exact(width.max(1)));
    for (number, (position, rotation)) in each.enumerate() {
        let read = from_parts(position, rotation);
        poses.push(read.ok_or_else(|| invalid(place, number))?);
    }
    Ok(sets)
}

fn invalid(place: &str, number: usize) -> PyErr {
    let place = format!("{place}[{number}]");
    let allowed = "finite numbers, and a quaternion of length one or a rotation matrix";
    bad_input(place, "no pose", allowed)
}

/// Returns the number of sets of poses in an array with this shape; returns `None` if the shape has no axis of sets.
fn n_sets(
    place: &str,
    shape: &[usize],
    leading: &[usize],
    n_each: usize,
) -> PyResult<Option<usize>> {
    match leading {
        [k] if *k == n_each => Ok(None),
        [n, k] if *k == n_each => Ok(Some(*n)),
        _ => {
            let allowed = format!("k = {n_each} poses; {ALLOWED}");
            Err(bad_input(place, shape_of(shape), allowed))
        }
    }
}
