//! Class `Simulation`: execution of a scene, frame by frame or in manual steps.

use crate::arrays::{Object, array, to_column, whole_number};
use crate::errors::{bad_input, exception, guarded, warn};
use crate::model::model_of;
use crate::output_array::{output_array, writable};
use crate::patch::{Patch, frame_shape};
use crate::poses::Poses;
use bubbletouch::scene::{
    self, Frame, ObjectReading, PatchReading, PlannedPatch, PoseControl, ScenePlan, SceneSpec,
    Stepping,
};
use glam::DVec3;
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::PyDict;
use self_cell::self_cell;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

type BorrowedSimulation<'p> = scene::Simulation<'p>;

self_cell!(
    /// Simulation that is running, with the plan of its scene.
    struct RunningSimulation {
        owner: Arc<ScenePlan>,
        #[not_covariant]
        dependent: BorrowedSimulation,
    }
);

fn begin(plan: &Arc<ScenePlan>) -> RunningSimulation {
    RunningSimulation::new(Arc::clone(plan), |plan| {
        scene::Simulation::new(plan, Stepping::AsNeeded)
    })
}

/// Simulation of a scene, created from the scene's text; use bubbletouch.simulate for a file or a dict.
///
/// The simulation is an iterator over the frames of the scene. Alternatively, a program moves objects and robots step by step with set_…(),
/// step(dt) and observe(). Threads that share a simulation wait for each other. A frame is a dict:
///
/// - time: seconds;
/// - patches: dict from the name of a patch to its reading, see below;
/// - objects: dict from the name of an object to a dict: pose (7,) in the world, and held: imposed, pressed, at rest, unsettled or escaped.
///
/// The reading of a patch is a dict:
///
/// - pose: (7,) in the world;
/// - deflection and force: metres and newtons, (ny, nx) for taxels in rows and columns, otherwise (n_taxels,);
/// - force3: force of the objects on each taxel, newtons, (n_taxels, 3), in the patch frame; the sum equals the force of the wrench;
/// - signal: sensor signals in the shape of the deflections, or None;
/// - wrench: force and torque on the patch, newtons and newton metres, (6,), in the patch frame;
/// - n_touched and n_saturated: numbers of taxels.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Simulation {
    plan: Arc<ScenePlan>,
    running: Mutex<RunningSimulation>,
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (text, place, folder, models))]
    fn new(
        py: Python,
        text: &str,
        place: &str,
        folder: PathBuf,
        models: &Bound<PyDict>,
    ) -> PyResult<Self> {
        guarded(|| {
            let mut in_memory = BTreeMap::new();
            for (name, object) in models {
                let name: String = name.extract()?;
                let model = model_of(&name, &object)?.clone();
                in_memory.insert(name, model);
            }
            let plan = py.detach(|| {
                let spec = SceneSpec::parse(place, text)?;
                ScenePlan::with_models(place, &folder, spec, &in_memory)
            });
            let plan = Arc::new(plan.map_err(exception)?);
            warn(py, plan.notes(), 2)?;
            Ok(Self {
                running: Mutex::new(begin(&plan)),
                plan,
            })
        })
    }

    /// Resets the simulation to the state before the first frame, and removes all manual settings. The sensor is unchanged. The noise of the readings
    /// is drawn from `seed` (default: the scene's seed). Raises ValueError if the seed is invalid.
    #[pyo3(signature = (seed=None))]
    fn reset(&self, py: Python, seed: Option<i128>) -> PyResult<()> {
        let seed = match seed {
            None => self.plan.spec.seed,
            Some(given) => whole_number("seed", given)?,
        };
        self.run(py, |simulation| {
            simulation.reset(seed);
            Ok(())
        })
    }

    /// Advances the simulation by `dt` seconds. Manually set poses are reached; all other motions follow the scene. Raises ValueError if `dt` is not
    /// positive, or a pose overflows.
    fn step(&self, py: Python, dt: f64) -> PyResult<()> {
        self.run(py, |simulation| simulation.step(dt))
    }

    /// Returns the current state as a frame. Before any step, the state is the first frame of the scene. Raises ValueError if a pose overflows.
    ///
    /// out: a frame that observe() of an equal simulation returned. Its arrays receive the new values, and the frame is returned. In a loop this is
    /// faster, because no arrays are allocated.
    #[pyo3(signature = (*, out=None))]
    fn observe<'py>(
        &self,
        py: Python<'py>,
        out: Option<Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        guarded(|| {
            let running = &mut *self.lock(py);
            py.detach(|| on(running, |simulation| simulation.observe().map(drop)))?;
            // The state was computed without the interpreter's lock; the second call only returns the frame.
            running.with_dependent_mut(|_, simulation| {
                let frame = simulation.observe().map_err(exception)?;
                match out {
                    Some(out) => fill_frame(&out, &self.plan, frame).map(|()| out),
                    None => frame_of(py, &self.plan, frame),
                }
            })
        })
    }

    /// Sets the pose of an object in the world from the next step on: (7,) or (4, 4). A free object comes to rest from this pose. Raises ValueError if
    /// an argument is invalid.
    fn set_object_pose(&self, py: Python, object: &str, pose: &Object) -> PyResult<()> {
        let pose = Poses::single("pose", pose)?;
        self.run(py, |simulation| simulation.set_object_pose(object, pose))
    }

    /// Sets the pose of a robot's base in the world from the next step on: (7,) or (4, 4). Raises ValueError if an argument is invalid.
    fn set_robot_pose(&self, py: Python, robot: &str, pose: &Object) -> PyResult<()> {
        let pose = Poses::single("pose", pose)?;
        self.run(py, |simulation| simulation.set_robot_pose(robot, pose))
    }

    /// Sets the joint positions of a robot from the next step on: (n_joints,) in the order of `robots`, radians and metres. Raises ValueError if an
    /// argument is invalid.
    fn set_joint_positions(&self, py: Python, robot: &str, positions: &Object) -> PyResult<()> {
        let is_shape = |shape: &[usize]| shape.len() == 1;
        let positions = array("positions", positions, "(n_joints,)", is_shape)?;
        let positions = positions.values();
        self.run(py, |simulation| {
            simulation.set_joint_positions(robot, positions)
        })
    }

    /// Returns the patch with this name, in the patch frame. If there is none, raises ValueError.
    fn patch(&self, name: &str) -> PyResult<Patch> {
        let patches = self.plan.patches.iter();
        let mut patches = patches.filter(|patch| patch.skin.name() == name);
        let found = patches
            .next()
            .map(|patch| Patch::from_patch(patch.skin.clone()));
        found.ok_or_else(|| bad_input("patch", format!("`{name}`"), self.patches().join(", ")))
    }

    /// Time since the start of the scene, seconds, in the current state.
    #[getter]
    fn time(&self, py: Python) -> PyResult<f64> {
        self.run(py, |simulation| Ok(simulation.time()))
    }

    /// Dict from the name of each robot to the names of its movable joints.
    #[getter]
    fn robots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let robots = PyDict::new(py);
        for robot in &self.plan.robots {
            let joints = robot.robot.coordinates().iter();
            let joints: Vec<&str> = joints.map(|joint| joint.name.as_str()).collect();
            robots.set_item(&robot.name, joints)?;
        }
        Ok(robots)
    }

    fn __iter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python) -> PyResult<Option<Py<PyDict>>> {
        let made = self.run(py, |simulation| {
            let frame = simulation.next_frame()?;
            let made =
                |frame| Python::attach(|py| frame_of(py, &self.plan, frame).map(Bound::unbind));
            Ok(frame.map(made))
        });
        made?.transpose()
    }

    /// Number of frames in the whole scene.
    #[getter]
    fn n_frames(&self) -> usize {
        self.plan.n_frames
    }

    /// Number of frames per second of simulated time.
    #[getter]
    fn output_rate(&self) -> f64 {
        self.plan.output_rate
    }

    /// Names of all patches of the scene.
    #[getter]
    fn patches(&self) -> Vec<String> {
        let patches = self.plan.patches.iter();
        patches.map(|patch| patch.skin.name().to_owned()).collect()
    }

    /// Names of all objects of the scene.
    #[getter]
    fn objects(&self) -> Vec<String> {
        let objects = self.plan.objects.iter();
        objects.map(|object| object.name.clone()).collect()
    }

    /// Title of the scene.
    #[getter]
    fn title(&self) -> &str {
        &self.plan.spec.title
    }

    fn __repr__(&self) -> String {
        let plan = &self.plan;
        let [patches, objects] = [plan.patches.len(), plan.objects.len()];
        format!(
            "<bubbletouch.Simulation {}: {patches} patches, {objects} objects, {} frames>",
            plan.place, plan.n_frames
        )
    }
}

impl Simulation {
    /// Waits, without the interpreter's lock, until no other thread uses the running simulation.
    fn lock(&self, py: Python) -> MutexGuard<'_, RunningSimulation> {
        let running = self.running.lock_py_attached(py);
        running.unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls a function with the running simulation, without the interpreter's lock.
    fn run<T: Send>(
        &self,
        py: Python,
        call: impl FnOnce(&mut BorrowedSimulation) -> bubbletouch::Result<T> + Send,
    ) -> PyResult<T> {
        guarded(|| {
            let running = &mut *self.lock(py);
            py.detach(|| on(running, call))
        })
    }
}

/// Calls a function with the running simulation, and converts its errors to Python exceptions.
fn on<T>(
    running: &mut RunningSimulation,
    call: impl FnOnce(&mut BorrowedSimulation) -> bubbletouch::Result<T>,
) -> PyResult<T> {
    running.with_dependent_mut(|_, simulation| call(simulation).map_err(exception))
}

/// Creates the dict of a frame.
fn frame_of<'py>(py: Python<'py>, plan: &ScenePlan, frame: &Frame) -> PyResult<Bound<'py, PyDict>> {
    let (said, patches, objects) = (PyDict::new(py), PyDict::new(py), PyDict::new(py));
    for (patch, reading) in plan.patches.iter().zip(&frame.patches) {
        let of_patch = PyDict::new(py);
        for (key, shape, values) in arrays_of(patch, reading) {
            let array = values.map(|values| values.into_owned().into_pyarray(py).reshape(shape));
            of_patch.set_item(key, array.transpose()?)?;
        }
        set_counts(&of_patch, reading)?;
        patches.set_item(patch.skin.name(), of_patch)?;
    }
    for (object, reading) in plan.objects.iter().zip(&frame.objects) {
        let of_object = PyDict::new(py);
        of_object.set_item("pose", to_column(py, reading.pose.to_array()))?;
        of_object.set_item("held", held(reading))?;
        objects.set_item(&object.name, of_object)?;
    }
    said.set_item("time", frame.time)?;
    said.set_item("patches", patches)?;
    said.set_item("objects", objects)?;
    Ok(said)
}

/// Writes a frame into the dict of an earlier frame. If the dict is not suitable, returns an error and changes nothing.
fn fill_frame(out: &Bound<PyDict>, plan: &ScenePlan, frame: &Frame) -> PyResult<()> {
    for is_written in [false, true] {
        let patches = part(out, "out", "patches")?;
        for (patch, reading) in plan.patches.iter().zip(&frame.patches) {
            let of_patch = part(&patches, "out, patches", patch.skin.name())?;
            for (key, shape, values) in arrays_of(patch, reading) {
                if let Some(values) = values {
                    let place = ["patches", patch.skin.name(), key];
                    fill(&of_patch, place, (&shape, &values), is_written)?;
                }
            }
            if is_written {
                set_counts(&of_patch, reading)?;
            }
        }
        let objects = part(out, "out", "objects")?;
        for (object, reading) in plan.objects.iter().zip(&frame.objects) {
            let of_object = part(&objects, "out, objects", &object.name)?;
            let pose = (&[7][..], &reading.pose.to_array()[..]);
            fill(
                &of_object,
                ["objects", &object.name, "pose"],
                pose,
                is_written,
            )?;
            if is_written {
                of_object.set_item("held", held(reading))?;
            }
        }
    }
    out.set_item("time", frame.time)
}

/// Allowed values of the argument `out` of `observe`, for error messages.
const EARLIER_FRAME: &str = "a frame that observe() of an equal simulation returned";

/// Returns the dict with a key in another dict.
fn part<'py>(dict: &Bound<'py, PyDict>, place: &str, key: &str) -> PyResult<Bound<'py, PyDict>> {
    let found = dict.get_item(key)?;
    let found = found.and_then(|found| found.cast_into::<PyDict>().ok());
    found.ok_or_else(|| bad_input(place, format!("no dict `{key}`"), EARLIER_FRAME))
}

/// Writes values into the array with a key in a dict, or only checks that the array is suitable.
fn fill(
    dict: &Bound<PyDict>,
    [kind, name, key]: [&str; 3],
    (shape, values): (&[usize], &[f64]),
    is_written: bool,
) -> PyResult<()> {
    let Some(found) = dict.get_item(key)? else {
        let (place, given) = (format!("out, {kind}, {name}"), format!("no array `{key}`"));
        return Err(bad_input(place, given, EARLIER_FRAME));
    };
    let place = format_args!("out, {kind}, {name}, {key}");
    let array = output_array::<f64>(place, &found, (shape, "a float64"))?;
    let mut target = writable(place, &array)?;
    if is_written {
        target.as_slice_mut()?.copy_from_slice(values);
    }
    Ok(())
}

/// Array of a reading: its key, shape and values; the values are `None` for a signal that does not exist.
type ReadingArray<'a> = (&'static str, Vec<usize>, Option<Cow<'a, [f64]>>);

/// Returns the arrays of a patch's reading.
fn arrays_of<'a>(patch: &PlannedPatch, reading: &'a PatchReading) -> [ReadingArray<'a>; 6] {
    let shape = frame_shape(patch.skin.layout());
    let of_vectors = |vectors: &[DVec3]| {
        vectors
            .iter()
            .flat_map(|vector| vector.to_array())
            .collect()
    };
    let (force3, wrench) = (&reading.force3, &reading.wrench);
    let force3: Vec<f64> = of_vectors(force3);
    let wrench: Vec<f64> = of_vectors(&[wrench.force, wrench.torque]);
    let pose = reading.pose.to_array().to_vec();
    let signal = reading.signal.as_deref();
    [
        ("pose", vec![7], Some(pose.into())),
        (
            "deflection",
            shape.clone(),
            Some((&reading.deflection).into()),
        ),
        ("force", shape.clone(), Some((&reading.force).into())),
        (
            "force3",
            vec![patch.skin.n_taxels(), 3],
            Some(force3.into()),
        ),
        ("signal", shape, signal.map(Cow::from)),
        ("wrench", vec![6], Some(wrench.into())),
    ]
}

fn set_counts(of_patch: &Bound<PyDict>, reading: &PatchReading) -> PyResult<()> {
    of_patch.set_item("n_touched", reading.n_touched)?;
    of_patch.set_item("n_saturated", reading.n_saturated)
}

/// Returns the rule that determines the pose of an object, as the word in the dict of a frame.
fn held(reading: &ObjectReading) -> &'static str {
    match reading.held {
        PoseControl::Imposed => "imposed",
        PoseControl::Pressed { .. } => "pressed",
        PoseControl::AtRest => "at rest",
        PoseControl::NotConverged => "unsettled",
        PoseControl::Escaped { .. } => "escaped",
    }
}
