//! Class `Skin`: its arguments and results, and the loop over patches and bodies.

use super::contact_loads::ContactLoads;
use super::filled::{Target, read_optional};
use super::force_match::{WantedForce, press_pair};
use super::parts::{Body, RigidObject, SkinPatch, add_wrench, take_maximum};
use super::poses::{PoseSets, read_poses};
use super::shear_state::ShearState;
use crate::arrays::{each, shape_of, view, whole_number};
use crate::batch::Spare;
use crate::errors::{bad_input, exception, guarded};
use crate::model::model_of;
use crate::patch::Patch;
use crate::press::output::Output;
use bubbletouch::contact::{
    AssignedLoads, CarriedLoad, LoadPart, LoadWorkspace, PointLoad, Press, Until, Workspace,
    Wrench, carry_loads, share_friction, travel_direction,
};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::Model;
use bubbletouch::world::{Shear, Shears};
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::Arc;

/// Distance, metres, to which a body without contact is moved. The body keeps its index in the list of bodies.
const OUT_OF_REACH: f64 = 1e6;

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
    parts: Vec<SkinPatch>,
    bodies: Vec<Body>,
    /// Objects of each patch, with the bodies that can touch the patch.
    objects: Vec<Arc<[RigidObject]>>,
    /// Bodies that cannot touch each patch.
    excluded: Vec<Vec<usize>>,
    /// Contact models of all bodies in one sequence, as presses with shear springs need them.
    models: Vec<Model>,
    /// Number of taxels of all patches.
    n_taxels: usize,
    /// Rigid body that carries each patch.
    carriers: Vec<usize>,
    arguments: Arguments,
    spare: Spare<SkinWorkspace>,
}

/// Arguments of the constructor, from which a skin is pickled and copied.
struct Arguments {
    patches: Vec<Py<Patch>>,
    bodies: Vec<Py<PyAny>>,
    objects: Option<Vec<usize>>,
    can_touch: Option<Py<PyAny>>,
    carriers: Option<Vec<usize>>,
}

/// Memory that successive calls of `read` reuse: copies of the arguments, and results.
#[derive(Default)]
struct SkinWorkspace {
    workspace: Workspace,
    patch_poses: Vec<Pose>,
    body_poses: Vec<Pose>,
    /// Poses of all bodies in the frame of one patch.
    placed: Vec<Pose>,
    /// Scratch memory for the poses of one object, and for the deflections under it.
    object_poses: Vec<Pose>,
    object_frame: Vec<f64>,
    /// Requested normal force of each pair, newtons; empty if every pair is read at its pose.
    forces: Vec<f64>,
    /// Direction of travel of each pair, three numbers per pair; empty if all directions are z.
    directions: Vec<f64>,
    load_workspace: LoadWorkspace,
    /// Loads of one pair, and tangential force on each taxel in the frame of its patch, newtons; zero without friction loads.
    pair_loads: Vec<PointLoad>,
    tangential: Vec<DVec3>,
    taxel_forces: Vec<f64>,
    frame: Vec<f64>,
    wrenches: Vec<f64>,
    contacts: Vec<i64>,
    pairs: PairResults,
}

impl SkinWorkspace {
    /// Sets the results of `n` sets of poses to zero; counts, tangential forces and forces on the taxels are empty.
    fn clear_results(&mut self, [n, n_patches, n_objects, n_taxels]: [usize; 4]) {
        clear(&mut self.frame, n * n_taxels);
        clear(&mut self.wrenches, n * n_patches * 6);
        let PairResults {
            forces,
            residuals,
            travels,
        } = &mut self.pairs;
        for values in [forces, residuals, travels] {
            clear(values, n * n_patches * n_objects);
        }
        self.contacts.clear();
        self.tangential.clear();
        self.taxel_forces.clear();
    }
}

/// Results for each pair of patch and object.
#[derive(Default)]
struct PairResults {
    /// Force of the object alone, newtons.
    forces: Vec<f64>,
    /// Wanted minus reached force, newtons.
    residuals: Vec<f64>,
    /// Travel of the patch from its pose, metres.
    travels: Vec<f64>,
}

/// Options of one read.
#[derive(Clone, Copy)]
struct ReadOptions {
    output: Output,
    /// Largest travel of a press to a force, metres; `None` for the patch's default.
    reach: Option<f64>,
    /// Whether the results of pairs are requested.
    wants_pairs: bool,
    /// Whether the forces on the taxels are requested.
    wants_taxel_forces: bool,
}

#[pymethods]
impl Skin {
    #[new]
    #[pyo3(signature = (patches, bodies, *, objects=None, can_touch=None, carriers=None))]
    fn new(
        patches: Vec<Bound<Patch>>,
        bodies: Vec<Bound<PyAny>>,
        objects: Option<Vec<i128>>,
        can_touch: Option<&Bound<PyAny>>,
        carriers: Option<Vec<i128>>,
    ) -> PyResult<Self> {
        guarded(|| {
            if patches.is_empty() {
                return Err(bad_input("patches", "none", "at least one Patch"));
            }
            let index = |object| whole_number("objects", object);
            let objects = objects.map(|all| all.into_iter().map(index).collect());
            let objects: Option<Vec<usize>> = objects.transpose()?;
            let index = |carrier| whole_number("carriers", carrier);
            let carriers = carriers.map(|all| all.into_iter().map(index).collect());
            let carriers: Option<Vec<usize>> = carriers.transpose()?;
            if let Some(carriers) = &carriers
                && carriers.len() != patches.len()
            {
                let allowed = format!("one for each of {} patches", patches.len());
                return Err(bad_input(
                    "carriers",
                    format!("{} indices", carriers.len()),
                    allowed,
                ));
            }
            let arguments = Arguments {
                patches: patches.iter().map(|patch| patch.clone().unbind()).collect(),
                bodies: bodies.iter().map(|body| body.clone().unbind()).collect(),
                objects: objects.clone(),
                can_touch: can_touch.map(|given| given.clone().unbind()),
                carriers: carriers.clone(),
            };
            let mut first = 0;
            let parts = patches.iter().map(|patch| {
                let part = SkinPatch::new(patch.get().inner().clone(), first);
                first += part.patch.n_taxels();
                part
            });
            let parts: Vec<SkinPatch> = parts.collect();
            let bodies = bodies.iter().enumerate().map(|(number, body)| {
                let model = model_of(&format!("bodies[{number}]"), body)?;
                Ok(Body::new(model.clone()))
            });
            let bodies: Vec<Body> = bodies.collect::<PyResult<_>>()?;
            let objects: Arc<[RigidObject]> = rigid_objects(&bodies, objects)?.into();
            let excluded = match can_touch {
                None => vec![Vec::new(); parts.len()],
                Some(given) => excluded_bodies(given, parts.len(), bodies.len())?,
            };
            let of_patch = |excluded: &Vec<usize>| match excluded.is_empty() {
                true => objects.clone(),
                false => objects.iter().map(|it| it.without(excluded)).collect(),
            };
            Ok(Self {
                objects: excluded.iter().map(of_patch).collect(),
                excluded,
                models: bodies.iter().map(|body| body.model.clone()).collect(),
                bodies,
                carriers: carriers.unwrap_or_else(|| (0..parts.len()).collect()),
                parts,
                n_taxels: first,
                arguments,
                spare: Spare::new(),
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
        let of = |part: &SkinPatch| (part.first, part.first + part.patch.n_taxels());
        self.parts.iter().map(of).collect()
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
    #[expect(clippy::too_many_arguments, reason = "named in Python")]
    fn read<'py>(
        &self,
        py: Python<'py>,
        patch_poses: &Bound<'py, PyAny>,
        body_poses: &Bound<'py, PyAny>,
        output: &str,
        forces: Option<&Bound<'py, PyAny>>,
        directions: Option<&Bound<'py, PyAny>>,
        loads: Option<&Bound<'py, PyAny>>,
        reach: Option<f64>,
        shear: Option<&Bound<'py, ShearState>>,
        out: Option<Bound<'py, PyAny>>,
        wrenches: Option<&Bound<'py, PyAny>>,
        contacts: Option<&Bound<'py, PyAny>>,
        taxel_forces: Option<&Bound<'py, PyAny>>,
        pair_forces: Option<&Bound<'py, PyAny>>,
        residuals: Option<&Bound<'py, PyAny>>,
        travels: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        guarded(|| {
            let options = ReadOptions {
                output: Output::from_argument(output)?,
                reach: reach_of(reach)?,
                wants_pairs: pair_forces.is_some() || residuals.is_some() || travels.is_some(),
                wants_taxel_forces: taxel_forces.is_some(),
            };
            let mut scratch = self.spare.take().unwrap_or_default();
            let n_sets = self.read_pose_sets((patch_poses, body_poses), &mut scratch)?;
            let shape = |last: &[usize]| -> Vec<usize> {
                n_sets.into_iter().chain(last.iter().copied()).collect()
            };
            let (n_patches, n_objects) = (self.parts.len(), self.objects[0].len());
            let pairs = shape(&[n_patches, n_objects]);
            read_optional("forces", forces, &pairs, &mut scratch.forces)?;
            let vectors = shape(&[n_patches, n_objects, 3]);
            read_optional("directions", directions, &vectors, &mut scratch.directions)?;
            check_pairs(&scratch.forces, &scratch.directions)?;
            let loads = self.read_loads(loads, n_sets, &mut scratch, (options, shear.is_some()))?;
            let float = |place, array: Option<&Bound<'py, PyAny>>, last: &[usize]| {
                Target::<f64>::new(place, array, (&shape(last), "a float64"))
            };
            let out_target = float("out", out.as_ref(), &[self.n_taxels])?;
            let wrenches = float("wrenches", wrenches, &[n_patches, 6])?;
            let taxel_forces = float("taxel_forces", taxel_forces, &[self.n_taxels, 3])?;
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
                        bad_input(
                            "shear",
                            "a state that another read uses",
                            "one read at a time",
                        )
                    })?;
                    state.check(&self.parts, n_sets)?;
                    Some(state)
                }
            };
            let (read, state) = (&mut scratch, shear.as_deref_mut());
            py.detach(|| match &loads {
                Some((loads, part)) if state.is_none() => self.carry(read, (loads, *part), options),
                _ => self.compute(read, n_sets.unwrap_or(1), options, state),
            });
            for (patch, object, force) in loads.iter().flat_map(|(loads, _)| &loads.beside) {
                scratch.pairs.residuals[patch * n_objects + object] += force;
            }
            taxel_forces.fill(&scratch.taxel_forces)?;
            wrenches.fill(&scratch.wrenches)?;
            pair_forces.fill(&scratch.pairs.forces)?;
            residuals.fill(&scratch.pairs.residuals)?;
            travels.fill(&scratch.pairs.travels)?;
            contacts.fill(&scratch.contacts)?;
            out_target.fill(&scratch.frame)?;
            let frame = match out {
                Some(out) => out,
                None => {
                    let frame = PyArray1::from_slice(py, &scratch.frame);
                    match n_sets {
                        None => frame.into_any(),
                        Some(n) => {
                            let frame: Bound<PyArray2<f64>> = frame.reshape([n, self.n_taxels])?;
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
        stiffness: &Bound<PyAny>,
        friction: &Bound<PyAny>,
        n: Option<usize>,
    ) -> PyResult<ShearState> {
        guarded(|| {
            let stiffness = each("stiffness", stiffness, self.n_taxels)?;
            let friction = each("friction", friction, self.n_taxels)?;
            let shears = |part: &SkinPatch| {
                let taxels = part.first..part.first + part.patch.n_taxels();
                let of = |taxel: usize| Shear {
                    stiffness: stiffness[taxel],
                    friction: friction[taxel],
                };
                Shears::Each(taxels.map(of).collect())
            };
            ShearState::new(&self.parts, shears, n).map_err(exception)
        })
    }

    fn __len__(&self) -> usize {
        self.parts.len()
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
            self.parts.len(),
            self.n_taxels,
            self.bodies.len()
        )
    }
}

/// Largest relative difference between required and carried force that counts as rounding.
const CARRIED: f64 = 1e-9;

impl Skin {
    /// Reads the poses of patches and bodies. Returns the number of sets, or `None` if the arrays have no axis of sets.
    fn read_pose_sets(
        &self,
        (of_patches, of_bodies): (&Bound<PyAny>, &Bound<PyAny>),
        scratch: &mut SkinWorkspace,
    ) -> PyResult<Option<usize>> {
        let n_patches = self.parts.len();
        let patches = read_poses(
            "patch_poses",
            of_patches,
            n_patches,
            &mut scratch.patch_poses,
        )?;
        let n_bodies = self.bodies.len();
        let bodies = read_poses("body_poses", of_bodies, n_bodies, &mut scratch.body_poses)?;
        PoseSets::joined(
            (patches, &mut scratch.patch_poses),
            (bodies, &mut scratch.body_poses),
        )
    }

    /// Reads contact loads and assigns them to patches. With shear springs, the forces and directions of the pairs follow from the loads.
    fn read_loads(
        &self,
        given: Option<&Bound<PyAny>>,
        n_sets: Option<usize>,
        scratch: &mut SkinWorkspace,
        (options, has_shear): (ReadOptions, bool),
    ) -> PyResult<Option<(AssignedLoads, LoadPart)>> {
        let Some(given) = given else { return Ok(None) };
        if n_sets.is_some() || !scratch.forces.is_empty() {
            let given = if n_sets.is_some() {
                "poses with an axis of sets"
            } else {
                "loads beside forces"
            };
            return Err(bad_input(
                "loads",
                given,
                "one set of poses, without forces",
            ));
        }
        let n_carriers = self.carriers.iter().max().map_or(0, |last| last + 1);
        let n_objects = self.objects[0].len();
        let loads = ContactLoads::read(given, n_carriers, n_objects)?;
        if has_shear && loads.part == LoadPart::Whole {
            let allowed = "normal forces only: friction forces of the engine and shear springs exclude each other";
            return Err(bad_input(
                "shear",
                "a state beside friction forces",
                allowed,
            ));
        }
        let found = loads.by_patch(
            &self.parts,
            &self.carriers,
            &scratch.patch_poses,
            options.reach,
        );
        if has_shear {
            let n_pairs = self.parts.len() * n_objects;
            clear(&mut scratch.forces, n_pairs);
            scratch.directions.clear();
            scratch
                .directions
                .extend(DVec3::Z.to_array().repeat(n_pairs));
            for pair in found.loads.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
                let (patch, object, _) = pair[0];
                let (at, loads) = (patch * n_objects + object, pair.iter().map(|it| it.2));
                scratch.forces[at] = loads.clone().map(|load| load.normal.length()).sum();
                if !self.parts[patch].is_flat {
                    let direction = travel_direction(&loads.collect::<Vec<_>>());
                    scratch.directions[3 * at..][..3].copy_from_slice(&direction.to_array());
                }
            }
        }
        Ok(Some((found, loads.part)))
    }

    /// Computes all results for one set of poses under contact loads into the scratch memory. An object without loads does not press.
    fn carry(
        &self,
        scratch: &mut SkinWorkspace,
        (loads, part): (&AssignedLoads, LoadPart),
        options: ReadOptions,
    ) {
        let (n_patches, n_objects) = (self.parts.len(), self.objects[0].len());
        scratch.clear_results([1, n_patches, n_objects, self.n_taxels]);
        scratch.pairs.travels.fill(f64::NAN);
        scratch.tangential.resize(self.n_taxels, DVec3::ZERO);
        for pair in loads.loads.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (number, object, _) = pair[0];
            let part_of = &self.parts[number];
            let reach = options.reach.unwrap_or(part_of.range.reach);
            scratch.pair_loads.clear();
            scratch
                .pair_loads
                .extend(pair.iter().map(|(_, _, load)| *load));
            let object_of = &self.objects[number][object];
            let patch_from_world = scratch.patch_poses[number].inverse();
            scratch.placed.clear();
            let placed = scratch
                .body_poses
                .iter()
                .map(|pose| patch_from_world.compose(pose));
            scratch.placed.extend(placed);
            let taxels = part_of.first..part_of.first + part_of.patch.n_taxels();
            let (frame, workspace) = (&mut scratch.frame[taxels.clone()], &mut scratch.workspace);
            let of_pair = &mut scratch.object_frame;
            of_pair.clear();
            of_pair.extend_from_slice(frame);
            let carried = if part_of.is_flat {
                scratch.object_poses.clear();
                let deeper = |member: &usize| {
                    let mut pose = scratch.placed[*member];
                    pose.translation.z -= reach;
                    pose
                };
                scratch
                    .object_poses
                    .extend(object_of.members.iter().map(deeper));
                let deeper = &scratch.object_poses;
                Press::new(&part_of.deep(reach), &object_of.models, deeper, Until::Pose)
                    .run(workspace)
                    .expect("checked poses");
                let deep = (workspace.deflections(), reach);
                carry_loads(
                    &part_of.patch,
                    deep,
                    (&scratch.pair_loads, part),
                    frame,
                    &mut scratch.load_workspace,
                )
            } else {
                let direction = travel_direction(&scratch.pair_loads);
                let force = scratch
                    .pair_loads
                    .iter()
                    .map(|load| load.normal.length())
                    .sum();
                let wanted = WantedForce {
                    force,
                    direction,
                    reach,
                };
                let poses = (&scratch.placed[..], &mut scratch.object_poses);
                let held = press_pair(part_of, object_of, poses, wanted, workspace);
                for (taxel, deflection) in workspace.deflections().iter().enumerate() {
                    let stroke = part_of.patch.taxels().at(taxel).stroke;
                    frame[taxel] = (frame[taxel] + deflection).min(stroke);
                }
                CarriedLoad {
                    force: held.force,
                    required: force,
                    travel: held.travel,
                }
            };
            let at = number * n_objects + object;
            scratch.pairs.forces[at] = carried.force;
            scratch.pairs.residuals[at] = carried.required - carried.force;
            scratch.pairs.travels[at] = carried.travel;
            of_pair
                .iter_mut()
                .zip(&*frame)
                .for_each(|(before, after)| *before = after - *before);
            let rest = share_friction(
                &part_of.patch,
                (&scratch.pair_loads, part),
                of_pair,
                &mut scratch.tangential[taxels],
            );
            // The wrench of forces that the taxels carry contains the torque of contacts on the rim.
            let is_carried = (carried.required - carried.force).abs() <= CARRIED * carried.required;
            if is_carried && (part == LoadPart::Whole || part_of.is_flat) {
                let torque = Wrench {
                    force: DVec3::ZERO,
                    ..rest
                };
                add_wrench(&mut scratch.wrenches[number * 6..][..6], torque);
            }
        }
        for (number, part) in self.parts.iter().enumerate() {
            let taxels = part.first..part.first + part.patch.n_taxels();
            let frame = &mut scratch.frame[taxels.clone()];
            let wrench = &mut scratch.wrenches[number * 6..][..6];
            part.add_normal_forces(frame, wrench);
            let centers = part.patch.layout().centers();
            for (center, force) in centers.iter().zip(&scratch.tangential[taxels]) {
                add_wrench(wrench, Wrench::at(*center, *force));
            }
            scratch.contacts.extend(part.count(frame));
        }
        self.write_readings(scratch, 1, options);
    }

    /// Writes the forces on all taxels from deflections and tangential forces, if they are requested, and converts the deflections of `n` sets to the output.
    fn write_readings(&self, scratch: &mut SkinWorkspace, n: usize, options: ReadOptions) {
        for (set, part) in (0..n).flat_map(|set| self.parts.iter().map(move |part| (set, part))) {
            let first = set * self.n_taxels + part.first;
            let frame = &mut scratch.frame[first..][..part.patch.n_taxels()];
            if options.wants_taxel_forces {
                let (axes, taxels) = (part.patch.layout().axes(), part.patch.taxels());
                for (taxel, axis) in axes.iter().enumerate() {
                    let tangential = scratch.tangential.get(first + taxel);
                    let axial = -taxels.at(taxel).stiffness * frame[taxel] * *axis;
                    let force = tangential.copied().unwrap_or_default() + axial;
                    scratch.taxel_forces.extend(force.to_array());
                }
            }
            options.output.convert(&part.patch, frame);
        }
    }

    /// Computes all results of `n` sets of poses into the scratch memory.
    fn compute(
        &self,
        scratch: &mut SkinWorkspace,
        n: usize,
        options: ReadOptions,
        mut shear: Option<&mut ShearState>,
    ) {
        let (n_patches, n_objects) = (self.parts.len(), self.objects[0].len());
        scratch.clear_results([n, n_patches, n_objects, self.n_taxels]);
        for index in 0..n * n_patches {
            let (set, number) = (index / n_patches, index % n_patches);
            let part = &self.parts[number];
            let taxels = set * self.n_taxels + part.first..;
            let is_near = self.press_pairs((index, number), scratch, options, shear.is_some());
            let frame = &mut scratch.frame[taxels][..part.patch.n_taxels()];
            let wrench = &mut scratch.wrenches[index * 6..][..6];
            if let Some(shear) = &mut shear {
                let bodies = match is_near {
                    true => (
                        &self.models[..],
                        &scratch.placed[..],
                        &self.objects[number][..],
                    ),
                    false => (&[][..], &[][..], &[][..]),
                };
                let patch = (set, number, &part.patch);
                shear.step(patch, bodies, wrench, &mut scratch.workspace);
                frame.copy_from_slice(scratch.workspace.deflections());
            } else if is_near {
                part.add_normal_forces(frame, wrench);
            }
            scratch.contacts.extend(match is_near {
                true => part.count(frame),
                false => [0, 0],
            });
        }
        self.write_readings(scratch, n, options);
    }

    /// Presses one patch under each object within reach, and writes the largest deflections into the frame of zeros. The poses of the bodies in the frame
    /// of the patch, after the travel, are in `placed` afterwards. Returns whether a body is within reach.
    ///
    /// If the call has a state of shear springs, the frame comes from a press under all bodies together. Only requested results of pairs are then computed.
    fn press_pairs(
        &self,
        (index, number): (usize, usize),
        scratch: &mut SkinWorkspace,
        options: ReadOptions,
        has_shear: bool,
    ) -> bool {
        let part = &self.parts[number];
        let set = index / self.parts.len();
        let n_bodies = self.bodies.len();
        let patch_from_world = scratch.patch_poses[index].inverse();
        let poses = &scratch.body_poses[set * n_bodies..][..n_bodies];
        scratch.placed.clear();
        let placed = poses.iter().map(|pose| patch_from_world.compose(pose));
        scratch.placed.extend(placed);
        for body in &self.excluded[number] {
            scratch.placed[*body].translation.z += OUT_OF_REACH;
        }
        let objects = &self.objects[number];
        let frame = &mut scratch.frame[set * self.n_taxels + part.first..][..part.patch.n_taxels()];
        let reads_pairs = !has_shear || !scratch.forces.is_empty() || options.wants_pairs;
        let reach = options.reach.unwrap_or(part.range.reach);
        let mut any_near = false;
        for (at, object) in (index * objects.len()..).zip(&objects[..]) {
            let wanted = scratch.forces.get(at).copied().unwrap_or(f64::NAN);
            let margin = if wanted.is_nan() { 0.0 } else { reach };
            let is_near = |placed: &[Pose], member: usize| {
                part.is_near(&self.bodies[member], &placed[member], margin)
            };
            let members = object.members.iter().copied();
            if wanted == 0.0 {
                for member in members {
                    scratch.placed[member].translation.z += OUT_OF_REACH;
                }
                scratch.pairs.travels[at] = f64::NAN;
                continue;
            }
            let first = members
                .clone()
                .position(|member| is_near(&scratch.placed, member));
            let Some(first) = first else {
                if !wanted.is_nan() {
                    scratch.pairs.travels[at] = reach;
                    scratch.pairs.residuals[at] = wanted;
                }
                continue;
            };
            any_near = true;
            if !reads_pairs {
                continue;
            }
            let workspace = &mut scratch.workspace;
            if wanted.is_nan() {
                let of_object = &mut scratch.object_frame;
                clear(of_object, frame.len());
                for member in members.skip(first) {
                    if is_near(&scratch.placed, member) {
                        let pose = scratch.placed[member];
                        part.press(&self.bodies[member], pose, of_object, workspace);
                    }
                }
                scratch.pairs.forces[at] = part.total_force(of_object);
                take_maximum(frame, of_object);
                continue;
            }
            let direction = match scratch.directions.get(3 * at..3 * at + 3) {
                Some(direction) => DVec3::from_slice(direction),
                None => DVec3::Z,
            };
            let wanted = WantedForce {
                force: wanted,
                direction,
                reach,
            };
            let poses = (&scratch.placed[..], &mut scratch.object_poses);
            let held = press_pair(part, object, poses, wanted, workspace);
            take_maximum(frame, workspace.deflections());
            for member in members {
                scratch.placed[member].translation -= held.travel * direction;
            }
            scratch.pairs.forces[at] = held.force;
            scratch.pairs.travels[at] = held.travel;
            scratch.pairs.residuals[at] = wanted.force - held.force;
        }
        any_near
    }
}

/// Returns the bodies that cannot touch each patch, given the argument `can_touch`.
fn excluded_bodies(
    given: &Bound<PyAny>,
    n_patches: usize,
    n_bodies: usize,
) -> PyResult<Vec<Vec<usize>>> {
    let shape = [n_patches, n_bodies];
    let allowed = format!("bool, {}", shape_of(&shape));
    view(
        "can_touch",
        given,
        &allowed,
        |is| is == shape,
        |array| {
            let rows = array.rows().into_iter();
            let excluded = rows.map(|row| {
                row.indexed_iter()
                    .filter(|(_, can)| **can == 0.0)
                    .map(|(body, _)| body)
                    .collect()
            });
            Ok(excluded.collect())
        },
    )
}

/// Groups bodies into rigid objects by the index of the object of each body.
fn rigid_objects(bodies: &[Body], objects: Option<Vec<usize>>) -> PyResult<Vec<RigidObject>> {
    let of_bodies = objects.unwrap_or_else(|| (0..bodies.len()).collect());
    if of_bodies.len() != bodies.len() {
        let given = format!("{} indices", of_bodies.len());
        let allowed = format!("one for each of {} bodies", bodies.len());
        return Err(bad_input("objects", given, allowed));
    }
    let n_objects = of_bodies.iter().max().map_or(0, |last| last + 1);
    let missing = |object: &usize| !of_bodies.contains(object);
    if let Some(object) = (0..n_objects.min(bodies.len() + 1)).find(missing) {
        let given = format!("no body of object {object}");
        return Err(bad_input("objects", given, "indices from 0 without a gap"));
    }
    let mut grouped: Vec<RigidObject> = Vec::new();
    grouped.resize_with(n_objects, RigidObject::default);
    for (number, (body, object)) in bodies.iter().zip(of_bodies).enumerate() {
        grouped[object].members.push(number);
        grouped[object].models.push(body.model.clone());
    }
    Ok(grouped)
}

/// Fills a vector with `n` zeros.
fn clear(values: &mut Vec<f64>, n: usize) {
    values.clear();
    values.resize(n, 0.0);
}

fn reach_of(reach: Option<f64>) -> PyResult<Option<f64>> {
    match reach {
        Some(reach) if !(reach.is_finite() && reach > 0.0) => {
            Err(bad_input("reach", reach, "a positive number of metres"))
        }
        reach => Ok(reach),
    }
}

/// Checks wanted forces, which may be NaN, and directions of all pairs.
fn check_pairs(forces: &[f64], directions: &[f64]) -> PyResult<()> {
    let is_force = |force: f64| force.is_nan() || (force.is_finite() && force >= 0.0);
    if let Some(at) = forces.iter().position(|force| !is_force(*force)) {
        let allowed = "newtons, zero or more; NaN for a pair that is read at its pose";
        let place = format!("forces, pair {at}");
        return Err(bad_input(place, forces[at], allowed));
    }
    let vectors = directions.chunks_exact(3).map(DVec3::from_slice);
    let is_unit = |vector: DVec3| (vector.length() - 1.0).abs() < 1e-9;
    match vectors.enumerate().find(|(_, vector)| !is_unit(*vector)) {
        Some((at, vector)) => {
            let place = format!("directions, pair {at}");
            Err(bad_input(place, vector, "a vector of length one"))
        }
        None => Ok(()),
    }
}
