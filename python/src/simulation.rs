//! `Simulation`: a scene, frame by frame.

use crate::arrays::to_column;
use crate::errors::{exception, guarded};
use crate::poses::seven;
use bubbletouch::scene::{self, Frame, Held, PatchReading, ScenePlan, SceneSpec, Stepping};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use self_cell::self_cell;
use std::path::PathBuf;
use std::sync::Arc;

type Going<'p> = scene::Simulation<'p>;

self_cell!(
    /// A scene on its way, and the plan that it follows.
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

/// A scene frame by frame, from its text: bubbletouch.simulate takes a file or a dict.
///
/// It is an iterator of frames, each a dict:
///
/// - time: seconds;
/// - patches: of each by name pose (7,) in the world, deflection (ny, nx) or (n_taxels,) in metres, force likewise in newtons, signal (or
///   None), wrench (6,) of force and torque on the patch in its frame, n_touched, n_saturated;
/// - objects: of each by name pose (7,) in the world, and held: imposed, pressed, at rest, unsettled or escaped.
#[pyclass(module = "bubbletouch")]
pub struct Simulation {
    plan: Arc<ScenePlan>,
    going: OnItsWay,
    n_done: usize,
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (text, place, folder))]
    fn new(py: Python, text: &str, place: &str, folder: PathBuf) -> PyResult<Self> {
        guarded(|| {
            let plan = py.detach(|| {
                let spec = SceneSpec::parse(place, text)?;
                ScenePlan::new(place, &folder, spec)
            });
            let plan = Arc::new(plan.map_err(exception)?);
            Ok(Self {
                going: begin(&plan),
                plan,
                n_done: 0,
            })
        })
    }

    /// Back to before the first frame.
    fn reset(&mut self) {
        self.going = begin(&self.plan);
        self.n_done = 0;
    }

    /// The next frame; None after the last. Raises ValueError.
    fn step<'py>(&mut self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        guarded(|| {
            let (going, plan) = (&mut self.going, &self.plan);
            let frame = py.detach(|| {
                going.with_dependent_mut(|_, simulation| {
                    let frame = simulation.next_frame().map_err(exception)?;
                    Ok::<_, PyErr>(frame.cloned())
                })
            })?;
            let Some(frame) = frame else {
                return Ok(None);
            };
            self.n_done += 1;
            frame_of(py, plan, frame).map(Some)
        })
    }

    fn __iter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __next__<'py>(&mut self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.step(py)
    }

    /// Of the whole scene.
    #[getter]
    fn n_frames(&self) -> usize {
        self.plan.n_frames
    }

    /// Frames a second of the scene's time.
    #[getter]
    fn output_rate(&self) -> f64 {
        self.plan.output_rate
    }

    /// Their names.
    #[getter]
    fn patches(&self) -> Vec<String> {
        let patches = self.plan.patches.iter();
        patches.map(|patch| patch.skin.name().to_owned()).collect()
    }

    /// Their names.
    #[getter]
    fn objects(&self) -> Vec<String> {
        let objects = self.plan.objects.iter();
        objects.map(|object| object.name.clone()).collect()
    }

    /// What the scene is about.
    #[getter]
    fn title(&self) -> &str {
        &self.plan.spec.title
    }

    fn __repr__(&self) -> String {
        let (place, n, done) = (&self.plan.place, self.plan.n_frames, self.n_done);
        format!("<bubbletouch.Simulation {place}: {done} of {n} frames>")
    }
}

fn frame_of<'py>(py: Python<'py>, plan: &ScenePlan, frame: Frame) -> PyResult<Bound<'py, PyDict>> {
    let (said, patches, objects) = (PyDict::new(py), PyDict::new(py), PyDict::new(py));
    for (patch, reading) in plan.patches.iter().zip(frame.patches) {
        let shape = patch.skin.layout().as_grid();
        let shape = shape.map_or(vec![patch.skin.n_taxels()], |grid| vec![grid.ny, grid.nx]);
        patches.set_item(patch.skin.name(), patch_of(py, &shape, reading)?)?;
    }
    for (object, reading) in plan.objects.iter().zip(&frame.objects) {
        let of_object = PyDict::new(py);
        let held = match reading.held {
            Held::Imposed => "imposed",
            Held::Pressed { .. } => "pressed",
            Held::AtRest => "at rest",
            Held::Unsettled => "unsettled",
            Held::Escaped { .. } => "escaped",
        };
        of_object.set_item("pose", to_column(py, seven(&reading.pose)))?;
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
    said.set_item("pose", to_column(py, seven(&reading.pose)))?;
    said.set_item("deflection", shaped(reading.deflection)?)?;
    said.set_item("force", shaped(reading.force)?)?;
    said.set_item("signal", reading.signal.map(shaped).transpose()?)?;
    said.set_item("wrench", to_column(py, wrench.concat()))?;
    said.set_item("n_touched", reading.n_touched)?;
    said.set_item("n_saturated", reading.n_saturated)?;
    Ok(said)
}
