//! Class `Skin`: its arguments and results.

use super::contact_loads;
use super::poses::PoseSets;
use super::shear_state::ShearState;
use crate::arrays::{Object, array, each, read_optional, shape_of, whole_number};
use crate::batch::Spare;
use crate::errors::{bad_input, exception, guarded};
use crate::model::model_of;
use crate::output_array::Target;
use crate::patch::Patch;
use crate::press::output::Output;
use bubbletouch::geometry::Pose;
use bubbletouch::objects::Model;
use bubbletouch::skin::{self, Pressed, ReadOptions, SkinPoses, SkinReading, SkinRelations};
use bubbletouch::world::Shear;
use glam::DVec3;
use ndarray::ArrayView1;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Patches of skin and bodies that may touch them, read at given poses in one call.
///
/// `Skin(patches, bodies)` has a sequence of Patch and a sequence of Mesh or SphereUnion as arguments. If several bodies deflect a taxel, the largest
/// deflection counts. Several threads may read one skin at the same time.
///
/// objects: index of the rigid object to which each body belongs, (n_bodies,), from 0. If None, each body is an object. Requested forces act between
/// patches and objects, so the bodies of an object press a patch together.
/// can_touch: pairs of patch and body that can touch, (n_patches, n_bodies) bool; None for all pairs. A body never presses a patch that it cannot touch.
/// carriers: index of the rigid body that carries each patch, (n_patches,), from 0, for the argument loads of read(). If None, each patch has its own.
///
/// Raises ValueError if the sequence of patches is empty, if the indices of objects skip a number, or if can_touch has another shape.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Skin {
    inner: skin::Skin,
    arguments: Arguments,
    spare: Spare<SkinWorkspace>,
}

/// Arguments of the constructor, from which a skin is pickled and copied.
struct Arguments {
    patches: Vec<Py<Patch>>,
    bodies: Vec<Py<PyAny>>,
    objects: Option<Vec<usize>>,
    can_touch: Option<Vec<Vec<bool>>>,
    carriers: Option<Vec<usize>>,
}

/// Memory that successive calls of `read` reuse: copies of the arguments, and results.
#[derive(Default)]
struct SkinWorkspace {
    patch_poses: Vec<Pose>,
    body_poses: Vec<Pose>,
    /// Requested normal force of each pair, newtons; empty if every pair is read at its pose.
    forces: Vec<f64>,
    /// Direction of travel of each pair, three numbers per pair; empty if all directions are z.
    directions: Vec<f64>,
    reading: SkinReading,
}

#[pymethods]
impl Skin {
    #[new]
    #[pyo3(signature = (patches, bodies, *, objects=None, can_touch=None, carriers=None))]
    fn new(
        patches: Vec<Bound<Patch>>,
        bodies: Vec<Object>,
        objects: Option<Vec<i128>>,
        can_touch: Option<&Object>,
        carriers: Option<Vec<i128>>,
    ) -> PyResult<Self> {
        guarded(|| {
            let indices = |place: &str, all: Option<Vec<i128>>| {
                let all = all.map(|all| all.into_iter().map(|index| whole_number(place, index)));
                all.map(Iterator::collect::<PyResult<Vec<usize>>>)
                    .transpose()
            };
            let objects = indices("objects", objects)?;
            let carriers = indices("carriers", carriers)?;
            let models = bodies.iter().enumerate();
            let models = models
                .map(|(number, body)| Ok(model_of(&format!("bodies[{number}]"), body)?.clone()));
            let models: Vec<Model> = models.collect::<PyResult<_>>()?;
            let touching = |given| touching(given, patches.len(), bodies.len());
            let can_touch = can_touch.map(touching).transpose()?;
            let excluded = |row: &Vec<bool>| (0..row.len()).filter(|&body| !row[body]).collect();
            let relations = SkinRelations {
                objects: objects.clone(),
                carriers: carriers.clone(),
                excluded: can_touch
                    .as_ref()
                    .map(|rows| rows.iter().map(excluded).collect()),
            };
            let inner = patches.iter().map(|patch| patch.get().inner().clone());
            let inner = skin::Skin::new(inner.collect(), models, relations);
            Ok(Self {
                inner: inner.map_err(exception)?,
                arguments: Arguments {
                    patches: patches.into_iter().map(Bound::unbind).collect(),
                    bodies: bodies.into_iter().map(Bound::unbind).collect(),
                    objects,
                    can_touch,
                    carriers,
                },
                spare: Spare::new(),
            })
        })
    }

    /// Number of taxels of all patches.
    #[getter]
    fn n_taxels(&self) -> usize {
        self.inner.n_taxels()
    }

    /// First and last index (exclusive) of each patch's taxels in a frame: a list of pairs, one per patch.
    #[getter]
    fn ranges(&self) -> Vec<(usize, usize)> {
        let ranges = self.inner.ranges();
        ranges.map(|range| (range.start, range.end)).collect()
    }

    /// Reads all patches under all bodies. Returns a frame of the skin, (n_taxels,) or (n, n_taxels) float64, patch after patch.
    ///
    /// patch_poses, body_poses: poses of the k patches and of the k bodies in the world, in their order. The shape is (k, 7) or (n, k, 7) of x, y, z, qw, qx,
    /// qy, qz, or (…, k, 4, 4). A pair (positions, rotations) is also allowed. Its positions are (…, k, 3). Its rotations are quaternions w, x, y, z,
    /// (…, k, 4), or matrices by rows, (…, k, 9) or (…, k, 3, 3), as in MuJoCo. A single patch or body needs no axis k. If only one of the two arguments
    /// has n sets, the other one applies to all of them.
    /// output: "deflection", metres, or "force", newtons along the axis of each taxel (stiffness times deflection).
    ///
    /// forces: requested normal forces of the pairs of patch and object, newtons, (n_patches, n_objects) or (n, n_patches, n_objects), zero or more. The
    /// normal force of a pair is the sum of the forces of the patch's taxels along their axes under this object alone. The patch travels from its pose
    /// until it has the requested force. A pair with force 0 has no contact, even if patch and object overlap. A pair with NaN is read at its pose.
    /// directions: directions of the travel in the patch frames, unit vectors, (…, n_patches, n_objects, 3); default z.
    /// loads: contact forces of an engine, instead of forces: a tuple of arrays with a row for each contact, for one set of poses. pairs: carrier of the patch
    /// and object, (m, 2). points: (m, 3), metres. normal forces on the carrier: (m, 3), newtons. Two more arrays are optional: friction forces, (m, 3),
    /// and torques about the points, (m, 3), N·m. All vectors are in the world. A contact acts on the nearest patch of the carrier that faces it: the normal
    /// force is within 60° of the nearest taxel's reversed axis, and the point within one spacing (or the radius) of the taxel's axis and
    /// within reach along it. Other contacts act on no patch. The taxels of a flat patch have the sum and the moment of the normal forces, those of a
    /// curved patch the sum along their axes. With friction forces, the sum and the moment of all forces on the patch are those of the contacts. A contact
    /// at the rim is up to half a spacing outside all taxels; wrenches contain the torque of this offset.
    ///
    /// reach: largest travel towards the object, metres. The default is the patch's largest stroke plus its largest taxel diameter. If the force is not
    /// reached, the press ends at this travel, or before the object is behind the substrate.
    /// shear: ShearState of this skin, which is advanced by one step. The wrenches then contain friction and the lateral forces of inclined contacts.
    ///
    /// The call fills the following arrays. They are float64 (contacts: int64), in C order, with a first axis n for n sets of poses.
    /// out: the frame; this array is returned.
    /// wrenches: (n_patches, 6), force and torque of the normal forces on each patch, in the patch's frame about its origin, newtons and newton metres.
    /// contacts: (n_patches, 2), numbers of touched taxels and of taxels at their stroke.
    /// taxel_forces: (n_taxels, 3), force on each taxel in the frame of its patch, newtons: along the axis and, with friction loads, tangential.
    /// pair_forces: (n_patches, n_objects), normal force of each pair, newtons.
    /// residuals: (n_patches, n_objects), requested force minus normal force of each pair, newtons; 0 for pairs that are read at their poses. A load
    /// that acts on no patch of its carrier belongs to the nearest one, if it is nearer than the diameter of the patch.
    /// travels: (n_patches, n_objects), travel of the patch of each pair, metres; NaN for pairs with force 0.
    #[pyo3(signature = (patch_poses, body_poses, *, output="deflection", forces=None, directions=None, loads=None, reach=None, shear=None, out=None, wrenches=None, contacts=None, taxel_forces=None, pair_forces=None, residuals=None, travels=None))]
    fn read<'py>(
        &self,
        py: Python<'py>,
        patch_poses: &Object<'py>,
        body_poses: &Object<'py>,
        output: &str,
        forces: Option<&Object<'py>>,
        directions: Option<&Object<'py>>,
        loads: Option<&Object<'py>>,
        reach: Option<f64>,
        shear: Option<&Bound<'py, ShearState>>,
        out: Option<Object<'py>>,
        wrenches: Option<&Object<'py>>,
        contacts: Option<&Object<'py>>,
        taxel_forces: Option<&Object<'py>>,
        pair_forces: Option<&Object<'py>>,
        residuals: Option<&Object<'py>>,
        travels: Option<&Object<'py>>,
    ) -> PyResult<Object<'py>> {
        guarded(|| {
            let output = Output::from_argument(output)?;
            let options = ReadOptions {
                reach,
                wants_pairs: pair_forces.is_some() || residuals.is_some() || travels.is_some(),
            };
            let mut scratch = self.spare.take().unwrap_or_default();
            let (of_patches, of_bodies) = (&mut scratch.patch_poses, &mut scratch.body_poses);
            let n_patches = self.inner.patches().len();
            let patch_sets = PoseSets::read("patch_poses", patch_poses, n_patches, of_patches)?;
            let n_bodies = self.inner.n_bodies();
            let body_sets = PoseSets::read("body_poses", body_poses, n_bodies, of_bodies)?;
            let n_sets = PoseSets::joined((patch_sets, of_patches), (body_sets, of_bodies))?;
            let shape = |last: &[usize]| -> Vec<usize> {
                n_sets.into_iter().chain(last.iter().copied()).collect()
            };
            let (n_objects, n_taxels) = (self.inner.n_objects(), self.inner.n_taxels());
            let pairs = shape(&[n_patches, n_objects]);
            read_optional("forces", forces, &pairs, &mut scratch.forces)?;
            let vectors = shape(&[n_patches, n_objects, 3]);
            read_optional("directions", directions, &vectors, &mut scratch.directions)?;
            if loads.is_some() && (n_sets.is_some() || forces.is_some()) {
                let given = match n_sets {
                    Some(_) => "poses with an axis of sets",
                    None => "loads beside forces",
                };
                let allowed = "one set of poses, without forces";
                return Err(bad_input("loads", given, allowed));
            }
            if directions.is_some() && forces.is_none() {
                let given = "directions without forces";
                return Err(bad_input("directions", given, "forces that are reached"));
            }
            let loads = loads.map(contact_loads::read).transpose()?;
            let directions: Vec<DVec3> = scratch
                .directions
                .chunks_exact(3)
                .map(DVec3::from_slice)
                .collect();
            let float = |place, array: Option<&Object<'py>>, last: &[usize]| {
                Target::<f64>::new(place, array, (&shape(last), "a float64"))
            };
            let out_target = float("out", out.as_ref(), &[n_taxels])?;
            let wrenches = float("wrenches", wrenches, &[n_patches, 6])?;
            let taxel_forces = float("taxel_forces", taxel_forces, &[n_taxels, 3])?;
            let pair_forces = float("pair_forces", pair_forces, &[n_patches, n_objects])?;
            let residuals = float("residuals", residuals, &[n_patches, n_objects])?;
            let travels = float("travels", travels, &[n_patches, n_objects])?;
            let counts = (&shape(&[n_patches, 2])[..], "an int64");
            let contacts = Target::<i64>::new("contacts", contacts, counts)?;
            let mut shear = match shear {
                None => None,
                Some(state) => {
                    let state = state.try_borrow_mut();
                    let state = state.map_err(|_| {
                        let given = "a state that another read uses";
                        bad_input("shear", given, "one read at a time")
                    })?;
                    state.check(n_sets)?;
                    Some(state)
                }
            };
            let pressed = match &loads {
                Some((loads, part)) => Pressed::ByLoads { loads, part: *part },
                None if forces.is_none() => Pressed::AtPoses,
                None => Pressed::ToForces {
                    forces: &scratch.forces,
                    directions: (!directions.is_empty()).then_some(&directions),
                },
            };
            let poses = SkinPoses {
                patches: &scratch.patch_poses,
                bodies: &scratch.body_poses,
            };
            let (reading, state) = (&mut scratch.reading, shear.as_deref_mut());
            let state = state.map(ShearState::inner_mut);
            py.detach(|| self.inner.read(poses, pressed, options, state, reading))
                .map_err(exception)?;
            taxel_forces.fill_with(|| {
                let forces = self.inner.forces_on_taxels(reading);
                forces.flat_map(|force| force.to_array())
            })?;
            wrenches.fill_with(|| {
                let wrenches = reading.wrenches.iter();
                wrenches.flat_map(|it| it.force.to_array().into_iter().chain(it.torque.to_array()))
            })?;
            pair_forces.fill_with(|| reading.pair_forces.iter().copied())?;
            residuals.fill_with(|| reading.residuals.iter().copied())?;
            travels.fill_with(|| reading.travels.iter().copied())?;
            contacts.fill_with(|| {
                let counts = reading.counts.iter();
                counts.flat_map(|of| [of.n_touched as i64, of.n_saturated as i64])
            })?;
            for frame in reading.deflections.chunks_exact_mut(n_taxels) {
                for (patch, taxels) in self.inner.patches().zip(self.inner.ranges()) {
                    output.convert(patch, &mut frame[taxels]);
                }
            }
            out_target.fill_with(|| reading.deflections.iter().copied())?;
            let frame = match out {
                Some(out) => out,
                None => {
                    let frame = PyArray1::from_slice(py, &reading.deflections);
                    match n_sets {
                        None => frame.into_any(),
                        Some(n) => {
                            let frame: Bound<PyArray2<f64>> = frame.reshape([n, n_taxels])?;
                            frame.into_any()
                        }
                    }
                }
            };
            self.spare.give_back(scratch);
            Ok(frame)
        })
    }

    /// Returns the state of untouched taxels with shear springs, for the argument `shear` of read().
    ///
    /// stiffness: stiffness of the shear springs, N/m, positive; one number, or (n_taxels,).
    /// friction: coefficient of friction, zero or more; one number, or (n_taxels,).
    /// n: number of sets of poses in each read; None for poses without an axis of sets.
    #[pyo3(signature = (stiffness, friction, *, n=None))]
    fn shear_state(
        &self,
        stiffness: &Object,
        friction: &Object,
        n: Option<usize>,
    ) -> PyResult<ShearState> {
        guarded(|| {
            let stiffness = each("stiffness", stiffness, self.inner.n_taxels())?;
            let friction = each("friction", friction, self.inner.n_taxels())?;
            let shear_of = |taxel: usize| Shear {
                stiffness: stiffness[taxel],
                friction: friction[taxel],
            };
            ShearState::new(&self.inner, shear_of, n).map_err(exception)
        })
    }

    fn __len__(&self) -> usize {
        self.inner.patches().len()
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let Arguments {
            patches,
            bodies,
            objects,
            can_touch,
            carriers,
        } = &self.arguments;
        let named = PyDict::new(py);
        named.set_item("objects", objects)?;
        named.set_item("can_touch", can_touch)?;
        named.set_item("carriers", carriers)?;
        Ok(((patches, bodies).into_pyobject(py)?, named))
    }

    fn __repr__(&self) -> String {
        format!(
            "<bubbletouch.Skin: {} patches of {} taxels, {} bodies>",
            self.inner.patches().len(),
            self.inner.n_taxels(),
            self.inner.n_bodies()
        )
    }
}

/// Reads the pairs of patch and body that can touch, a row for each patch.
fn touching(given: &Object, n_patches: usize, n_bodies: usize) -> PyResult<Vec<Vec<bool>>> {
    let shape = [n_patches, n_bodies];
    let allowed = format!("bool, {}", shape_of(&shape));
    let pairs = array("can_touch", given, &allowed, |is| is == shape)?.matrix();
    let row = |row: ArrayView1<f64>| row.iter().map(|pair| *pair != 0.0).collect();
    Ok(pairs.outer_iter().map(row).collect())
}
