//! Class `ShearState`: shear springs with friction of all taxels of a skin, from one read to the next.

use super::parts::{RigidObject, SkinPatch, add_wrench};
use crate::arrays::{to_rows, whole_number};
use crate::errors::{bad_input, guarded};
use bubbletouch::contact::{
    ContactMode, FrictionState, NormalForce, Press, TaxelContact, Until, Workspace,
};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::Model;
use bubbletouch::world::{self, Shears};
use glam::DVec3;
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;

/// Shear springs with friction of all taxels of a skin. Skin.shear_state() creates the state, and each Skin.read advances it by one step.
///
/// Between two reads, a body in contact drags the taxels sideways until they slip. The shear force is at most the friction coefficient times the normal
/// force.
#[pyclass(module = "bubbletouch")]
#[derive(Clone)]
pub struct ShearState {
    /// State of each patch at rest, in the order of the skin.
    at_rest: Vec<FrictionState>,
    /// Indices of the first and last taxel (exclusive) of each patch in a frame of the skin.
    ranges: Vec<(usize, usize)>,
    /// States of the patches, set after set of poses.
    states: Vec<FrictionState>,
    /// Forces on the taxels in the patch frames, newtons, set after set.
    forces: Vec<DVec3>,
    /// Number of sets of poses, or `None` for one set without an axis of sets.
    n_sets: Option<usize>,
}

impl ShearState {
    /// Creates the state of untouched patches for `n_sets` sets of poses.
    ///
    /// # Errors
    /// If the shear springs do not fit a patch.
    pub fn new(
        parts: &[SkinPatch],
        shears: impl Fn(&SkinPatch) -> Shears,
        n_sets: Option<usize>,
    ) -> bubbletouch::Result<Self> {
        let at_rest = parts
            .iter()
            .map(|part| FrictionState::at_rest(&part.patch, shears(part)));
        let at_rest = at_rest.collect::<bubbletouch::Result<Vec<_>>>()?;
        let ranges = parts
            .iter()
            .map(|part| (part.first, part.first + part.patch.n_taxels()));
        let ranges: Vec<(usize, usize)> = ranges.collect();
        let (n, n_taxels) = (n_sets.unwrap_or(1), ranges.last().map_or(0, |last| last.1));
        Ok(Self {
            states: (0..n).flat_map(|_| at_rest.iter().cloned()).collect(),
            forces: vec![DVec3::ZERO; n * n_taxels],
            at_rest,
            ranges,
            n_sets,
        })
    }

    /// Checks that the state has been created by a skin with the same patches, for the same number of sets.
    ///
    /// # Errors
    /// If the numbers of taxels or of sets differ.
    pub fn check(&self, parts: &[SkinPatch], n_sets: Option<usize>) -> PyResult<()> {
        let ranges = parts
            .iter()
            .map(|part| (part.first, part.first + part.patch.n_taxels()));
        if !ranges.eq(self.ranges.iter().copied()) {
            let given = "a state of another skin";
            return Err(bad_input("shear", given, "shear_state() of this skin"));
        }
        if self.n_sets != n_sets {
            let words = |n: Option<usize>| n.map_or("one set".to_owned(), |n| format!("n = {n}"));
            let allowed = format!("a state of {}", words(n_sets));
            return Err(bad_input("shear", words(self.n_sets), allowed));
        }
        Ok(())
    }

    /// Returns the number of taxels of the skin.
    fn n_taxels(&self) -> usize {
        self.ranges.last().map_or(0, |last| last.1)
    }

    /// Presses a patch under all bodies at their poses and advances its shear springs by one step; the deflections are in the workspace. Adds the force and
    /// the torque on the patch to `wrench`. `patch` is the number of the patch in the set of poses number `set`. Bodies of one rigid object drag a taxel
    /// as one body.
    pub fn step(
        &mut self,
        (set, number, patch): (usize, usize, &world::Patch),
        (models, poses, objects): (&[Model], &[Pose], &[RigidObject]),
        wrench: &mut [f64],
        workspace: &mut Workspace,
    ) {
        Press::new(patch, models, poses, Until::Pose)
            .with_contacts()
            .run(workspace)
            .expect("checked poses");
        // A rigid object moves with its first body.
        let object_of = |body: usize| {
            objects
                .iter()
                .position(|object| object.members.contains(&body))
        };
        let of_object = |contact: &TaxelContact| TaxelContact {
            object: object_of(contact.object).expect("each body that presses belongs to an object"),
            ..*contact
        };
        let contacts: Vec<TaxelContact> = workspace.contacts().iter().map(of_object).collect();
        let first = |object: &RigidObject| object.members.first().and_then(|body| poses.get(*body));
        let object_poses = objects
            .iter()
            .map(|object| first(object).copied().unwrap_or_default());
        let object_poses: Vec<Pose> = object_poses.collect();
        let n_taxels = self.n_taxels();
        let state = &mut self.states[set * self.ranges.len() + number];
        state.step(patch, &contacts, &object_poses, NormalForce::Springs);
        let (first, last) = self.ranges[number];
        let forces = &mut self.forces[set * n_taxels..][first..last];
        forces.fill(DVec3::ZERO);
        for contact in &contacts {
            forces[contact.taxel] = force_on_taxel(patch, state, contact);
        }
        add_wrench(wrench, -state.load(patch, &contacts).on_object);
    }
}

/// Returns the force of the object on a taxel in the patch frame, newtons: frictionless force and friction.
fn force_on_taxel(patch: &world::Patch, state: &FrictionState, contact: &TaxelContact) -> DVec3 {
    let taxel = contact.taxel;
    let spring = patch.taxels().at(taxel).stiffness * contact.deflection;
    let friction = state.friction(taxel).extend(0.0);
    patch.layout().frame(taxel) * friction - contact.push(spring).force
}

#[pymethods]
impl ShearState {
    /// Force of the bodies on each taxel after the last read, newtons, (n_taxels, 3) or (n, n_taxels, 3), in the frame of the taxel's patch. It is the sum
    /// of the normal force, the friction, and the lateral force of an inclined contact.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows = to_rows(py, self.forces.iter().copied());
        match self.n_sets {
            None => Ok(rows.into_any()),
            Some(n) => Ok(rows.reshape([n, self.n_taxels(), 3])?.into_any()),
        }
    }

    /// Whether each taxel slipped during the last step, (n_taxels,) or (n, n_taxels).
    #[getter]
    fn slipping<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let modes = self.states.iter().flat_map(FrictionState::contact_modes);
        let slipping: Vec<bool> = modes.map(|mode| *mode == ContactMode::Slip).collect();
        let slipping = slipping.into_pyarray(py);
        match self.n_sets {
            None => Ok(slipping.into_any()),
            Some(n) => Ok(slipping.reshape([n, self.n_taxels()])?.into_any()),
        }
    }

    /// Sets the shear forces to zero, as before the first read. `sets` contains the indices of the sets of poses; None selects all sets.
    #[pyo3(signature = (sets=None))]
    fn reset(&mut self, sets: Option<Vec<i128>>) -> PyResult<()> {
        guarded(|| {
            let n = self.n_sets.unwrap_or(1);
            let sets: Vec<usize> = match sets {
                None => (0..n).collect(),
                Some(sets) => {
                    let read = sets.into_iter().map(|set| match whole_number("sets", set) {
                        Ok(set) if set < n => Ok(set),
                        _ => Err(bad_input("sets", set, format!("0 to {}", n - 1))),
                    });
                    read.collect::<PyResult<_>>()?
                }
            };
            let (n_patches, n_taxels) = (self.ranges.len(), self.n_taxels());
            for set in sets {
                self.states[set * n_patches..][..n_patches].clone_from_slice(&self.at_rest);
                self.forces[set * n_taxels..][..n_taxels].fill(DVec3::ZERO);
            }
            Ok(())
        })
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<PyAny>) -> Self {
        self.clone()
    }

    fn __repr__(&self) -> String {
        let n_taxels = self.n_taxels();
        match self.n_sets {
            None => format!("<bubbletouch.ShearState: {n_taxels} taxels>"),
            Some(n) => format!("<bubbletouch.ShearState: {n} × {n_taxels} taxels>"),
        }
    }
}
