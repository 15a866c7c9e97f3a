//! `Contacts`: for each touched taxel, the touching part, the contact point, and the force.

use crate::arrays::{to_column, to_rows};
use bubbletouch::contact::{Contact, TaxelContact, Workspace};
use bubbletouch::world::Patch;
use glam::DVec3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

/// Which part of the object touches which taxel: m contacts in the order of poses and taxels, and n poses.
#[pyclass(frozen, get_all, module = "bubbletouch")]
pub struct Contacts {
    /// (m,): number of the pose, from 0.
    pose: Py<PyArray1<i64>>,
    /// (m,): number of the taxel, in the order of the patch.
    taxel: Py<PyArray1<i64>>,
    /// (m,): number of the sphere, or of the triangle, that decides how far the taxel goes.
    part: Py<PyArray1<i64>>,
    /// (m,): metres; that of the frame to rounding.
    deflection: Py<PyArray1<f64>>,
    /// (m, 3): unit, from the object's surface to the taxel, in the frame of the patch.
    normal: Py<PyArray2<f64>>,
    /// (m, 3): where they touch, metres, in the frame of the patch.
    point: Py<PyArray2<f64>>,
    /// (m, 3): of the taxel's spring on the object without friction, newtons, in the frame of the patch.
    force: Py<PyArray2<f64>>,
    /// (m, 3): ∂δ/∂x for a motion x of the part in the frame of the patch, before the taxel's stop; its length is ∂δ/∂R of a sphere's radius.
    gradient: Py<PyArray2<f64>>,
    /// (n,): how far the patch went along its z, metres; NaN where no taxel met the object.
    travel: Py<PyArray1<f64>>,
    /// (n,): taxels with a deflection.
    n_touched: Py<PyArray1<i64>>,
    /// (n,): taxels at their stroke that the object would push further.
    n_saturated: Py<PyArray1<i64>>,
}

/// Contacts of a press at one pose.
pub struct OfPose {
    /// Result of the press; `None` if the patch touched nothing.
    pressed: Option<Contact>,
    contacts: Vec<(TaxelContact, DVec3)>,
}

impl OfPose {
    /// Collects the contacts of a press from the workspace.
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
    /// Combines the contacts of poses, each given with its number, in any order.
    ///
    /// # Errors
    /// Returns only errors of Python.
    pub fn of(py: Python, mut poses: Vec<(usize, OfPose)>) -> PyResult<Self> {
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
        let count = |of: fn(&Contact) -> usize| {
            let counts = poses.iter().map(|(_, of_pose)| of_pose.pressed);
            to_column(
                py,
                counts.map(|pressed| pressed.map_or(0, |contact| of(&contact)) as i64),
            )
            .unbind()
        };
        let travels = poses.iter().map(|(_, of_pose)| of_pose.pressed);
        let travels = travels.map(|pressed| pressed.map_or(f64::NAN, |contact| contact.travel));
        Ok(Self {
            pose: whole(|(number, ..)| *number),
            taxel: whole(|(_, contact, _)| contact.taxel),
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
