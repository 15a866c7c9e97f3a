//! Batches of presses, which write deflections into a NumPy array.

use crate::arrays::{Object, shape_of};
use crate::batch::for_each;
use crate::errors::{bad_input, exception};
use crate::model::Objects;
use crate::patch::Patch;
use crate::poses::Poses;
use crate::press::contacts::{Contacts, OfPose};
use crate::press::goal::Goal;
use crate::press::output::{Output, Real};
use bubbletouch::contact::{POSE_PARAMETERS, Press, Until, Workspace, pose_jacobian};
use bubbletouch::geometry::Pose;
use bubbletouch::world;
use glam::DVec3;
use numpy::{
    Element, PyArrayDescr, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods,
    dtype as dtype_of,
};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;
use std::sync::Mutex;

/// Results that a call of `Patch.press` requests.
#[derive(Clone, Copy)]
pub struct Wanted {
    /// Quantity of the frames.
    pub output: Output,
    /// Whether the call requests the contacts of each press.
    pub contacts: bool,
    /// Whether the call requests the derivatives of the deflections with respect to the pose.
    pub jacobian: bool,
}

/// Presses a patch on objects at all poses. Returns the frames, or a tuple of the frames and the other requested results, contacts first.
///
/// # Errors
/// If an argument is invalid, a force cannot be reached (the error names the pose), or Ctrl-C was pressed.
pub fn press<'py>(
    py: Python<'py>,
    patch: &Patch,
    (object, poses, goal): (&Object<'py>, &Object<'py>, Goal),
    (out, dtype): (Option<&Object<'py>>, Option<&Object<'py>>),
    threads: Option<usize>,
    wanted: Wanted,
) -> PyResult<Object<'py>> {
    let objects = Objects::from_argument(object)?;
    let given = Poses::of_objects("poses", poses, objects.n_several())?;
    let n_sets = given.poses.len() / objects.models().len();
    goal.check(n_sets)?;
    if wanted.jacobian {
        check_jacobian(goal.kind(), patch.inner())?;
    }
    let batch = Batch {
        patch,
        objects,
        given,
        goal,
        threads,
        wanted,
    };
    let mut shape = patch.sides().to_vec();
    if !batch.given.is_one {
        shape.insert(0, n_sets);
    }
    let single = dtype.map(|dtype| is_single(py, dtype)).transpose()?;
    let array = match out {
        Some(out) => {
            if let (Some(dtype), Some(single)) = (dtype, single) {
                let has = out.getattr("dtype")?;
                if single != is_single(py, &has)? {
                    return Err(bad_input("dtype", dtype, format!("{has}, which out has")));
                }
            }
            out.clone()
        }
        None => {
            let dtype = match single {
                Some(true) => dtype_of::<f32>(py),
                _ => dtype_of::<f64>(py),
            };
            zeros(py)?.call1((PyTuple::new(py, &shape)?, dtype))?
        }
    };
    let is_zero = out.is_none();
    if let Ok(array) = array.cast::<PyArrayDyn<f64>>() {
        check_out(array, &shape)?;
        return batch.fill(py, array.clone(), is_zero);
    }
    if let Ok(array) = array.cast::<PyArrayDyn<f32>>() {
        check_out(array, &shape)?;
        return batch.fill(py, array.clone(), is_zero);
    }
    let given = match array.getattr("dtype") {
        Ok(dtype) => format!("dtype {dtype}"),
        Err(_) => array.get_type().to_string(),
    };
    Err(bad_input("out", given, "an array of float32 or float64"))
}

/// Returns an error if the derivatives for a kind of goal are not implemented: for a depth on a patch that is not flat.
fn check_jacobian(goal: Until, patch: &world::Patch) -> PyResult<()> {
    if !matches!(goal, Until::Depth(_)) || patch.is_flat() {
        return Ok(());
    }
    let given = "with a depth, on a patch that is not flat";
    let allowed = "a travel, a force, or none of them there";
    Err(bad_input("jacobian", given, allowed))
}

/// Returns whether a NumPy type is float32. If the type is neither float32 nor float64, returns an error.
fn is_single(py: Python, dtype: &Object) -> PyResult<bool> {
    let refuse = || bad_input("dtype", dtype, "float32 or float64");
    let descr = PyArrayDescr::new(py, dtype.clone()).map_err(|_| refuse())?;
    let is_single = descr.is_equiv_to(&dtype_of::<f32>(py));
    match is_single || descr.is_equiv_to(&dtype_of::<f64>(py)) {
        true => Ok(is_single),
        false => Err(refuse()),
    }
}

/// Returns the function `numpy.zeros`, which creates the output arrays. Memory of untouched taxels is never written, and large arrays use large memory pages.
fn zeros<'py>(py: Python<'py>) -> PyResult<&'py Object<'py>> {
    static ZEROS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    ZEROS.import(py, "numpy", "zeros")
}

struct Batch<'a> {
    patch: &'a Patch,
    objects: Objects<'a>,
    given: Poses,
    goal: Goal,
    threads: Option<usize>,
    wanted: Wanted,
}

impl Batch<'_> {
    fn fill<'py, T: Real>(
        self,
        py: Python<'py>,
        array: Bound<'py, PyArrayDyn<T>>,
        is_zero: bool,
    ) -> PyResult<Object<'py>> {
        let mut sides = array.shape().to_vec();
        sides.extend(self.objects.n_several());
        sides.push(POSE_PARAMETERS);
        let changes = self
            .wanted
            .jacobian
            .then(|| PyArrayDyn::<f64>::zeros(py, sides, false));
        let contacts = {
            let mut writable = array
                .try_readwrite()
                .map_err(|error| bad_input("out", error, "an array that nobody else uses"))?;
            let mut changing = changes.as_ref().map(|changes| changes.readwrite());
            let changes = changing.as_mut().map(|changes| changes.as_slice_mut());
            let frames = writable.as_slice_mut()?;
            self.run(py, (frames, is_zero), changes.transpose()?)?
        };
        if contacts.is_none() && changes.is_none() {
            return Ok(array.into_any());
        }
        let contacts = contacts.map(|contacts| Bound::new(py, contacts));
        let contacts = contacts.transpose()?.map(Bound::into_any);
        let others = contacts.into_iter().chain(changes.map(Bound::into_any));
        let results: Vec<Object> = std::iter::once(array.into_any()).chain(others).collect();
        Ok(PyTuple::new(py, results)?.into_any())
    }

    /// Writes a frame and its derivatives for each pose. The arrays contain zeros or values that are overwritten.
    fn run<T: Real>(
        &self,
        py: Python,
        (frames, are_zero): (&mut [T], bool),
        changes: Option<&mut [f64]>,
    ) -> PyResult<Option<Contacts>> {
        let models = self.objects.models();
        let (patch, goal, k) = (self.patch.inner(), &self.goal, models.len());
        let (is_one, wanted) = (self.given.is_one, self.wanted);
        let named = |number: usize, error: bubbletouch::Error| {
            let place = if is_one {
                "poses: ".to_owned()
            } else {
                format!("poses[{number}]: ")
            };
            exception(error.under(place))
        };
        let found: Mutex<Vec<(usize, OfPose)>> = Mutex::new(Vec::new());
        type Item<'a, T> = (&'a mut [T], Option<&'a mut [f64]>);
        let work = |number: usize, (frame, changes): Item<T>, workspace: &mut Workspace| {
            let poses = &self.given.poses[number * k..][..k];
            let press = goal.of_pose(number, patch, (models, poses));
            let row = T::row(frame);
            let pressed = match are_zero {
                true => press.write_onto_zeros(row, workspace),
                false => press.write(row, workspace),
            };
            let pressed = pressed.map_err(|error| named(number, error))?;
            wanted.output.convert(patch, frame);
            if !wanted.contacts && changes.is_none() {
                return Ok(());
            }
            // The contacts of a flat patch depend on its travel only.
            let is_known = patch.is_flat() && press.until != Until::Pose;
            let until = match pressed.filter(|_| is_known) {
                Some(pressed) => Until::Travel(pressed.travel),
                None => press.until,
            };
            let met = Press { until, ..press }.with_contacts().run(workspace);
            let met = met.map_err(|error| named(number, error))?;
            if let (Some(changes), Some(pressed), Some(_)) = (changes, pressed, met) {
                let origin = |pose: &Pose| pose.translation - pressed.travel * DVec3::Z;
                let origins: Vec<DVec3> = poses.iter().map(origin).collect();
                let contacts = (workspace.contacts(), &origins[..]);
                pose_jacobian(press.until, patch, contacts, changes);
                wanted.output.convert(patch, changes);
            }
            if wanted.contacts {
                let of_pose = OfPose::new(patch, (pressed, met), workspace);
                if let Ok(mut found) = found.lock() {
                    found.push((number, of_pose));
                }
            }
            Ok(())
        };
        let n_taxels = patch.n_taxels();
        let frames = frames.chunks_exact_mut(n_taxels);
        let items: Vec<Item<T>> = match changes {
            None => frames.map(|frame| (frame, None)).collect(),
            Some(changes) => {
                let changes = changes.chunks_exact_mut(n_taxels * k * POSE_PARAMETERS);
                frames.zip(changes.map(Some)).collect()
            }
        };
        let spare = self.patch.spare();
        for_each(py, items, self.threads, spare, Workspace::new, work)?;
        if !wanted.contacts {
            return Ok(None);
        }
        let found = found.into_inner().unwrap_or_default();
        Contacts::from_poses(py, found).map(Some)
    }
}

/// Returns an error if an array cannot receive the frames because of its shape or memory layout.
fn check_out<T: Element>(array: &Bound<PyArrayDyn<T>>, shape: &[usize]) -> PyResult<()> {
    if array.shape() != shape {
        return Err(bad_input("out", shape_of(array.shape()), shape_of(shape)));
    }
    match array.is_c_contiguous() {
        true => Ok(()),
        false => Err(bad_input("out", "a strided array", "a C-contiguous one")),
    }
}
