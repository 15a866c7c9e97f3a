//! Class `Simulation`: execution of a scene, frame by frame or in manual steps.

use crate::arrays::{to_column, to_rows, view, whole_number};
use crate::errors::{bad_input, exception, guarded};
use crate::model::model_of;
use crate::patch::Patch;
use crate::poses::Poses;
use bubbletouch::geometry::Pose;
use bubbletouch::scene::{self, Frame, PatchReading, PoseControl, ScenePlan, SceneSpec, Stepping};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use self_cell::self_cell;
use std::collections::BTreeMap;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::Arc;

type Going<'p> = scene::Simulation<'p>;

self_cell!(
    /// Simulation that is running, with the plan of its scene.
    struct OnItsWay {
        owner: Arc<ScenePlan>,
        #[not_covariant]
        dependent: Going,
    }
);

fn begin(plan: &Arc<ScenePlan>) -> OnItsWay {
    OnItsWay::new(Arc::clone(plan), |plan| {
        scene::Simulation::new(plan, Stepping::AsNeeded)
    })
}

/// Simulation of a scene, created from the scene's text; use bubbletouch.simulate for a file or a dict.
///
/// The simulation is an iterator over the frames of the scene. Alternatively, a program moves objects and robots step by step with set_…(),
/// step(dt) and observe(). A frame is a dict:
///
/// - time: seconds;
/// - patches: dict from the name of a patch to its reading, see below;
/// - objects: dict from the name of an object to a dict: pose (7,) in the world, and held: imposed, pressed, at rest, unsettled or escaped.
///
/// The reading of a patch is a dict:
///
/// - pose: (7,) in the world;
/// - deflection and force: metres and newtons, (ny, nx) for a grid, otherwise (n_taxels,);
/// - force3: force of the objects on each taxel, newtons, (n_taxels, 3), in the patch frame; the sum equals the force of the wrench;
/// - signal: sensor signals in the shape of the deflections, or None;
/// - wrench: force and torque on the patch, newtons and newton metres, (6,), in the patch frame;
/// - n_touched and n_saturated: numbers of taxels.
#[pyclass(module = "bubbletouch")]
pub struct Simulation {
    plan: Arc<ScenePlan>,
    going: OnItsWay,
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
            for note in plan.notes() {
                let note = CString::new(note).unwrap_or_default();
                PyErr::warn(py, &py.get_type::<PyUserWarning>(), &note, 2)?;
            }
            Ok(Self {
                going: begin(&plan),
                plan,
            })
        })
    }

    /// Resets the simulation to the state before the first frame, and removes all manual settings. The sensor is unchanged. The noise of the readings
    /// is drawn from `seed` (None: the scene's seed). Raises ValueError if the seed is invalid.
    #[pyo3(signature = (seed=None))]
    fn reset(&mut self, seed: Option<i128>) -> PyResult<()> {
        let seed = match seed {
            None => self.plan.spec.seed,
            Some(given) => whole_number("seed", given)?,
        };
        self.change(|simulation| {
            simulation.reset(seed);
            Ok(())
        })
    }

    /// Advances the simulation by `dt` seconds. Manually set poses are reached; all other motions follow the scene. Raises ValueError if `dt` is not
    /// positive, or a pose overflows.
    fn step(&mut self, py: Python, dt: f64) -> PyResult<()> {
        let going = &mut self.going;
        guarded(|| py.detach(|| on(going, |simulation| simulation.step(dt))))
    }

    /// Returns the current state as a frame. Before any step, the state is the first frame of the scene. Raises ValueError if a pose overflows.
    fn observe<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let going = &mut self.going;
        guarded(|| {
            let frame = py.detach(|| on(going, |simulation| simulation.observe().cloned()))?;
            frame_of(py, &self.plan, frame)
        })
    }

    /// Sets the pose of an object in the world from the next step on: (7,) or (4, 4). A free object comes to rest from this pose. Raises ValueError if
    /// an argument is invalid.
    fn set_object_pose(&mut self, object: &str, pose: &Bound<PyAny>) -> PyResult<()> {
        let pose = one_pose(pose)?;
        self.change(|simulation| simulation.set_object_pose(object, pose))
    }

    /// Sets the pose of a robot's base in the world from the next step on: (7,) or (4, 4). Raises ValueError if an argument is invalid.
    fn set_robot_pose(&mut self, robot: &str, pose: &Bound<PyAny>) -> PyResult<()> {
        let pose = one_pose(pose)?;
        self.change(|simulation| simulation.set_robot_pose(robot, pose))
    }

    /// Sets the joint positions of a robot from the next step on: (n_joints,) in the order of `robots`, radians and metres. Raises ValueError if an
    /// argument is invalid.
    fn set_joint_positions(&mut self, robot: &str, positions: &Bound<PyAny>) -> PyResult<()> {
        let is_shape = |shape: &[usize]| shape.len() == 1;
        view("positions", positions, "(n_joints,)", is_shape, |array| {
            let positions: Vec<f64> = array.iter().copied().collect();
            self.change(|simulation| simulation.set_joint_positions(robot, &positions))
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
    fn time(&mut self) -> f64 {
        self.going
            .with_dependent_mut(|_, simulation| simulation.time())
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

    fn __next__<'py>(&mut self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let (going, plan) = (&mut self.going, &self.plan);
        guarded(|| {
            let frame = py.detach(|| {
                on(going, |simulation| {
                    simulation.next_frame().map(|frame| frame.cloned())
                })
            });
            frame?.map(|frame| frame_of(py, plan, frame)).transpose()
        })
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
    fn change(
        &mut self,
        change: impl FnOnce(&mut Going) -> bubbletouch::Result<()>,
    ) -> PyResult<()> {
        guarded(|| on(&mut self.going, change))
    }
}

/// Calls a function with the running simulation, and converts its errors to Python exceptions.
fn on<T>(
    going: &mut OnItsWay,
    call: impl FnOnce(&mut Going) -> bubbletouch::Result<T>,
) -> PyResult<T> {
    going.with_dependent_mut(|_, simulation| call(simulation).map_err(exception))
}

/// Reads a single pose in the world frame, `world_from_…`.
fn one_pose(given: &Bound<PyAny>) -> PyResult<Pose> {
    let poses = Poses::from_argument("pose", given)?;
    match (poses.is_one, &poses.poses[..]) {
        (true, &[pose]) => Ok(pose),
        (_, several) => {
            let given = format!("{} poses", several.len());
            Err(bad_input("pose", given, "one, (7,) or (4, 4)"))
        }
    }
}

fn frame_of<'py>(py: Python<'py>, plan: &ScenePlan, frame: Frame) -> PyResult<Bound<'py, PyDict>> {
    let (said, patches, objects) = (PyDict::new(py), PyDict::new(py), PyDict::new(py));
    for (patch, reading) in plan.patches.iter().zip(frame.patches) {
        let shape = patch.skin.layout().as_grid();
        let shape = shape.map_or(vec![patch.skin.n_taxels()], |grid| vec![grid.ny, grid.nx]);
        let said = patch_of(py, &shape, reading)?;
        patches.set_item(patch.skin.name(), said)?;
    }
    for (object, reading) in plan.objects.iter().zip(&frame.objects) {
        let of_object = PyDict::new(py);
        let held = match reading.held {
            PoseControl::Imposed => "imposed",
            PoseControl::Pressed { .. } => "pressed",
            PoseControl::AtRest => "at rest",
            PoseControl::NotConverged => "unsettled",
            PoseControl::Escaped { .. } => "escaped",
        };
        of_object.set_item("pose", to_column(py, reading.pose.to_array()))?;
        of_object.set_item("held", held)?;
        objects.set_item(&object.name, of_object)?;
    }
    said.set_item("time", frame.time)?;
    said.set_item("patches", patches)?;
    said.set_item("objects", objects)?;
    Ok(said)
}

fn patch_of<'py>(
    py: Python<'py>,
    shape: &[usize],
    reading: PatchReading,
) -> PyResult<Bound<'py, PyDict>> {
    let said = PyDict::new(py);
    let shaped = |values: Vec<f64>| values.into_pyarray(py).reshape(shape.to_vec());
    let wrench = [
        reading.wrench.force.to_array(),
        reading.wrench.torque.to_array(),
    ];
    said.set_item("pose", to_column(py, reading.pose.to_array()))?;
    said.set_item("deflection", shaped(reading.deflection)?)?;
    said.set_item("force", shaped(reading.force)?)?;
    said.set_item("force3", to_rows(py, reading.force3.into_iter()))?;
    said.set_item("signal", reading.signal.map(shaped).transpose()?)?;
    said.set_item("wrench", to_column(py, wrench.concat()))?;
    said.set_item("n_touched", reading.n_touched)?;
    said.set_item("n_saturated", reading.n_saturated)?;
    Ok(said)
}
