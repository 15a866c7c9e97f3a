//! Batches of presses, which write deflections into a NumPy array.

use crate::arrays::Object;
use crate::batch::for_each;
use crate::errors::bad_input;
use crate::output_array::{output_array, writable};
use crate::patch::Patch;
use crate::press::contacts::{Contacts, OfPose};
use crate::press::goal::{Goal, Presses};
use crate::press::output::{Output, Real};
use bubbletouch::contact::{POSE_PARAMETERS, Press, Until, Workspace, pose_jacobian};
use bubbletouch::geometry::Pose;
use bubbletouch::world;
use glam::DVec3;
use numpy::{PyArrayDescr, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, dtype as dtype_of};
use pyo3::prelude::*;
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
    let presses = Presses::new(object, poses, goal)?;
    if wanted.jacobian {
        check_jacobian(presses.goal.kind(), patch.inner())?;
    }
    let batch = Batch {
        patch,
        presses,
        threads,
        wanted,
    };
    // The type of a given array is the type of the frames.
    let is_single = match (dtype, out) {
        (Some(dtype), _) => is_single(py, dtype)?,
        (None, Some(out)) => out.cast::<PyArrayDyn<f32>>().is_ok(),
        (None, None) => false,
    };
    match is_single {
        true => batch.fill::<f32>(py, out),
        false => batch.fill::<f64>(py, out),
    }
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

struct Batch<'a> {
    patch: &'a Patch,
    presses: Presses<'a>,
    threads: Option<usize>,
    wanted: Wanted,
}

impl Batch<'_> {
    /// Presses at all poses. Returns the array of the caller, or a new array, with the frames, and the other requested results.
    fn fill<'py, T: Real>(
        self,
        py: Python<'py>,
        out: Option<&Object<'py>>,
    ) -> PyResult<Object<'py>> {
        let mut shape = self.patch.sides().to_vec();
        if !self.presses.is_one {
            shape.insert(0, self.presses.n());
        }
        let array = match out {
            Some(out) => output_array::<T>("out", out, (&shape, T::NAME))?,
            None => PyArrayDyn::<T>::zeros(py, &shape[..], false),
        };
        let is_zero = out.is_none();
        let mut sides = shape;
        sides.extend(self.presses.objects.n_several);
        sides.push(POSE_PARAMETERS);
        let changes = self
            .wanted
            .jacobian
            .then(|| PyArrayDyn::<f64>::zeros(py, sides, false));
        let contacts = {
            let mut writable = writable("out", &array)?;
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
        let (patch, presses, wanted) = (self.patch.inner(), &self.presses, self.wanted);
        let found: Mutex<Vec<(usize, OfPose)>> = Mutex::new(Vec::new());
        type Item<'a, T> = (&'a mut [T], Option<&'a mut [f64]>);
        let work = |number: usize, (frame, changes): Item<T>, workspace: &mut Workspace| {
            let press = presses.press(number, patch);
            let row = T::row(frame);
            let pressed = match are_zero {
                true => press.write_onto_zeros(row, workspace),
                false => press.write(row, workspace),
            };
            let pressed = pressed.map_err(|error| presses.exception(number, error))?;
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
            let met = met.map_err(|error| presses.exception(number, error))?;
            if let (Some(changes), Some(pressed), Some(_)) = (changes, pressed, met) {
                let origin = |pose: &Pose| pose.translation - pressed.travel * DVec3::Z;
                let origins: Vec<DVec3> = presses.poses(number).iter().map(origin).collect();
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
                let n_objects = presses.objects.models.len();
                let changes = changes.chunks_exact_mut(n_taxels * n_objects * POSE_PARAMETERS);
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
