//! Class `Contacts`: touching part, contact point and force for each touched taxel.

use crate::arrays::{to_column, to_rows};
use bubbletouch::contact::{Contact, TaxelContact, Workspace};
use bubbletouch::world::Patch;
use glam::DVec3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

/// Contacts of presses at n poses, ordered by pose and taxel. Each of the m contacts is a pair of a taxel and the sphere or triangle of an object that
/// touches it.
#[pyclass(frozen, get_all, module = "bubbletouch")]
pub struct Contacts {
    /// For each contact (m,), the number of its pose, from 0.
    pose: Py<PyArray1<i64>>,
    /// For each contact (m,), the number of its taxel in the patch, from 0.
    taxel: Py<PyArray1<i64>>,
    /// For each contact (m,), the number of the object that touches the taxel, from 0; always 0 for a single object.
    object: Py<PyArray1<i64>>,
    /// For each contact (m,), the number of the sphere or triangle of the object that determines the taxel's deflection.
    part: Py<PyArray1<i64>>,
    /// For each contact (m,), the deflection of its taxel, metres; equals the deflection in the frame up to rounding.
    deflection: Py<PyArray1<f64>>,
    /// For each contact (m, 3), the contact normal: unit vector from the object's surface to the taxel, in the patch frame.
    normal: Py<PyArray2<f64>>,
    /// For each contact (m, 3), the contact point, metres, in the patch frame.
    point: Py<PyArray2<f64>>,
    /// For each contact (m, 3), the frictionless force of the taxel's spring on the object, newtons, in the patch frame.
    force: Py<PyArray2<f64>>,
    /// For each contact (m, 3), the gradient ∂δ/∂x of the deflection δ for a motion x of the touching part in the patch frame. The gradient ignores the
    /// limit of the stroke. For a sphere of radius R, the length of the gradient is ∂δ/∂R.
    gradient: Py<PyArray2<f64>>,
    /// For each pose (n,), the travel of the patch along its z axis, metres; NaN if no taxel touched the object.
    travel: Py<PyArray1<f64>>,
    /// For each pose (n,), the number of deflected taxels.
    n_touched: Py<PyArray1<i64>>,
    /// For each pose (n,), the number of saturated taxels: their deflection equals the stroke, and the object pushes further.
    n_saturated: Py<PyArray1<i64>>,
}

/// Contacts of a press at a single pose.
pub struct OfPose {
    /// Result of the press; `None` if the patch did not touch the object.
    pressed: Option<Contact>,
    contacts: Vec<(TaxelContact, DVec3)>,
}

impl OfPose {
    /// Copies the contacts of a press from the workspace that it used.
    pub fn new(
        patch: &Patch,
        (pressed, met): (Option<Contact>, Option<Contact>),
        workspace: &Workspace,
    ) -> Self {
        let force = |contact: &TaxelContact| {
            let stiffness = patch.taxels().at(contact.taxel).stiffness;
            contact.push(stiffness * contact.deflection).force
        };
        let contacts = if met.is_some() {
            workspace.contacts()
        } else {
            &[]
        };
        Self {
            pressed,
            contacts: contacts.iter().map(|one| (*one, force(one))).collect(),
        }
    }
}

impl Contacts {
    /// Combines the contacts of several poses, which are given with their numbers in any order.
    ///
    /// # Errors
    /// Returns only errors of Python.
    pub fn from_poses(py: Python, mut poses: Vec<(usize, OfPose)>) -> PyResult<Self> {
        poses.sort_unstable_by_key(|(number, _)| *number);
        let all: Vec<(usize, &TaxelContact, DVec3)> = poses
            .iter()
            .flat_map(|(number, of_pose)| {
                let contacts = of_pose.contacts.iter();
                contacts.map(move |(contact, force)| (*number, contact, *force))
            })
            .collect();
        let whole = |of: fn(&(usize, &TaxelContact, DVec3)) -> usize| {
            to_column(py, all.iter().map(|one| of(one) as i64)).unbind()
        };
        let vectors = |of: fn(&(usize, &TaxelContact, DVec3)) -> DVec3| {
            to_rows(py, all.iter().map(of)).unbind()
        };
        let pressed: Vec<Option<Contact>> = poses.iter().map(|(_, one)| one.pressed).collect();
        let count = |of: fn(&Contact) -> usize| {
            let counts = pressed.iter().map(|one| one.as_ref().map_or(0, of) as i64);
            to_column(py, counts).unbind()
        };
        let travels = pressed
            .iter()
            .map(|one| one.map_or(f64::NAN, |contact| contact.travel));
        Ok(Self {
            pose: whole(|(number, ..)| *number),
            taxel: whole(|(_, contact, _)| contact.taxel),
            object: whole(|(_, contact, _)| contact.object),
            part: whole(|(_, contact, _)| contact.part),
            deflection: to_column(py, all.iter().map(|(_, contact, _)| contact.deflection))
                .unbind(),
            normal: vectors(|(_, contact, _)| contact.normal),
            point: vectors(|(_, contact, _)| contact.point),
            force: vectors(|(.., force)| *force),
            gradient: vectors(|(_, contact, _)| contact.gradient()),
            travel: to_column(py, travels).unbind(),
            n_touched: count(|contact| contact.n_touched),
            n_saturated: count(|contact| contact.n_saturated),
        })
    }
}

#[pymethods]
impl Contacts {
    /// Number m of contacts.
    fn __len__(&self, py: Python) -> PyResult<usize> {
        self.taxel.bind(py).len()
    }

    fn __repr__(&self, py: Python) -> PyResult<String> {
        let n_poses = self.travel.bind(py).len()?;
        let n = self.taxel.bind(py).len()?;
        Ok(format!(
            "<bubbletouch.Contacts: {n} taxels touched at {n_poses} poses>"
        ))
    }
}
