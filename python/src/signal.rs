//! Classes `Step` and `Chain`: conversion of deflections to sensor signals, with sensor errors.

use crate::arrays::{Frames, Object, array, frames, is_of_frames, whole_number};
use crate::batch::{Spare, for_each, n_threads};
use crate::errors::{bad_input, check_number, exception, guarded, named};
use crate::patch::Patch;
use bubbletouch::random::Seed;
use bubbletouch::signal::{
    self, MAX_STRENGTHS, Noise, Quantity, Recording, SENSOR_ERRORS, SensorError, SignalStep,
    SignalWorkspace,
};
use ndarray::{Axis, Slice};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Step of a signal chain, created by one of the static methods. Chain checks whether a step is valid.
#[pyclass(frozen, module = "bubbletouch")]
#[derive(Clone)]
pub struct Step {
    kind: Kind,
    /// Text of the constructor call, used by `repr()`.
    call: String,
}

/// Kind of a step and its parameters, before the step is prepared for a patch.
#[derive(Clone)]
enum Kind {
    Plain(SignalStep),
    Error(SensorError, [f64; MAX_STRENGTHS]),
}

impl Step {
    fn of_skin(&self, skin: Seed) -> SignalStep {
        match self.kind {
            Kind::Plain(step) => step,
            Kind::Error(error, strengths) => {
                let step = error.step(&strengths[..error.about().strengths.len()], skin);
                step.expect("one number for each strength")
            }
        }
    }
}

/// Returns the names of all sensor errors as text for messages.
fn words() -> String {
    let words: Vec<&str> = SENSOR_ERRORS
        .iter()
        .map(|error| error.about().step)
        .collect();
    words.join(", ")
}

#[pymethods]
impl Step {
    /// Returns a step that converts deflections to forces k δ + c δ̇, newtons.
    #[staticmethod]
    fn force() -> Self {
        Self {
            kind: Kind::Plain(SignalStep::Force),
            call: "force()".to_owned(),
        }
    }

    /// Returns a step that adds Gaussian noise to every taxel.
    ///
    /// std: standard deviation, zero or more.
    /// unit: unit of std. full_scale is the fraction of the signal of a taxel at its stroke, mm is millimetres, n is newtons.
    #[staticmethod]
    #[pyo3(signature = (std, unit="full_scale"))]
    fn noise(std: f64, unit: &str) -> PyResult<Self> {
        let noise = Noise {
            std,
            unit: named("noise unit", unit)?,
        };
        Ok(Self {
            kind: Kind::Plain(SignalStep::Noise(noise)),
            call: format!("noise({std}, {unit:?})"),
        })
    }

    /// Returns a step that smooths frames with a Gaussian of standard deviation `width` (metres, zero or more).
    #[staticmethod]
    fn smoothing(width: f64) -> Self {
        Self {
            kind: Kind::Plain(SignalStep::Smoothing { width }),
            call: format!("smoothing({width})"),
        }
    }

    /// Returns a step with a sensor error, such as Step.error("gain", gain_std=0.07). If a name or a strength is invalid, raises ValueError, which
    /// lists the allowed ones.
    ///
    /// errors() returns all errors. Errors of an individual sensor (gain, drift, faults) are drawn from the chain's skin_seed.
    #[staticmethod]
    #[pyo3(signature = (name, **strengths))]
    fn error(name: &str, strengths: Option<&Bound<PyDict>>) -> PyResult<Self> {
        let error = SensorError::of_step(name)
            .ok_or_else(|| bad_input("sensor error", format!("`{name}`"), words()))?;
        let known = error.about().strengths;
        let keys: Vec<&str> = known.iter().map(|strength| strength.key).collect();
        let keys = keys.join(", ");
        let mut values = [0.0; MAX_STRENGTHS];
        let mut call = format!("error({name:?}");
        for (key, value) in strengths.into_iter().flatten() {
            let key: String = key.extract()?;
            let place = known.iter().position(|strength| strength.key == key);
            let place = place.ok_or_else(|| bad_input(name, format!("`{key}`"), &keys))?;
            let number = value.extract().ok();
            let number = number.filter(|number| known[place].is_allowed(*number));
            let allowed = known[place].allowed;
            values[place] = number.ok_or_else(|| bad_input(&key, &value, allowed))?;
            call += &format!(", {key}={value}");
        }
        Ok(Self {
            kind: Kind::Error(error, values),
            call: call + ")",
        })
    }

    /// Returns all sensor errors, as a dict from the name of an error to its strengths. The strengths are a dict from the name of a strength to its
    /// allowed values, as text.
    #[staticmethod]
    fn errors(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let all = PyDict::new(py);
        for error in SENSOR_ERRORS {
            let strengths = PyDict::new(py);
            for strength in error.about().strengths {
                strengths.set_item(strength.key, strength.allowed)?;
            }
            all.set_item(error.about().step, strengths)?;
        }
        Ok(all)
    }

    fn __repr__(&self) -> String {
        format!("Step.{}", self.call)
    }
}

/// Signal chain: a sequence of steps from deflections to sensor signals, prepared for a patch.
///
/// Example: Chain([Step.error("gain", gain_std=0.05), Step.noise(0.02), Step.smoothing(4e-3)], patch, skin_seed=7)
///
/// skin_seed: seed of the individual sensor's gains, drift and faults, 0 or above.
/// of_force: whether input frames are in newtons.
///
/// Raises ValueError if the patch, or the order of the steps, does not allow a step.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Chain {
    chain: signal::Chain,
    /// Numbers of rows and columns of the patch; `None` if its taxels form no image.
    sides: Option<[usize; 2]>,
    steps: Vec<Step>,
    spare: Spare<SignalWorkspace>,
}

#[pymethods]
impl Chain {
    #[new]
    #[pyo3(signature = (steps, patch, *, skin_seed=0, of_force=false))]
    fn new(
        steps: Vec<Bound<Step>>,
        patch: &Bound<Patch>,
        skin_seed: i128,
        of_force: bool,
    ) -> PyResult<Self> {
        guarded(|| {
            let skin_seed = whole_number("skin_seed", skin_seed)?;
            let steps: Vec<Step> = steps.iter().map(|step| step.get().clone()).collect();
            let skin = Seed::new(skin_seed);
            let prepared: Vec<SignalStep> = steps.iter().map(|step| step.of_skin(skin)).collect();
            let quantity = match of_force {
                true => Quantity::Force,
                false => Quantity::Deflection,
            };
            let patch = patch.get().inner();
            let chain = signal::Chain::with_quantity(&prepared, patch, quantity);
            Ok(Self {
                sides: patch.layout().sides(),
                chain: chain.map_err(exception)?,
                steps,
                spare: Spare::new(),
            })
        })
    }

    /// Returns the sensor signals of frames; each frame is treated as a separate touch at rest.
    ///
    /// frames: deflections, metres, shape (n, …) with n_taxels numbers per frame, (n, ny, nx) for a grid, or one frame. The array is not changed.
    /// seed: seed of the random values that change from touch to touch. Frame i uses the random numbers of touch `first` + i, independently of other
    /// frames.
    /// rates: deflection rates δ̇, m/s, in the shape of the frames. Default: 0.
    /// threads: maximum number of threads; all cores if None.
    ///
    /// Returns a float64 array of the shape of the frames, in the unit of `quantity`. Raises ValueError if an argument is invalid.
    #[pyo3(signature = (frames, *, seed=0, first=0, rates=None, threads=None))]
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        frames: &Object<'py>,
        seed: i128,
        first: i128,
        rates: Option<&Object<'py>>,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        guarded(|| {
            let seed = Seed::new(whole_number("seed", seed)?);
            let first: u64 = whole_number("first", first)?;
            let n_taxels = self.chain.n_taxels();
            let Frames { mut values, shape } =
                self::frames("frames", frames, n_taxels, self.sides)?;
            let rates = self.rates(rates, values.nrows())?;
            let work = |number: usize, frame: &mut [f64], scratch: &mut SignalWorkspace| {
                let touch = seed.numbered(first + number as u64);
                let rates = rates
                    .as_ref()
                    .map(|rates| &rates[number * n_taxels..][..n_taxels]);
                self.chain.apply(frame, rates, &touch, scratch);
                Ok(())
            };
            let rows = values.as_slice_mut().expect("frames are whole");
            let rows = rows.chunks_exact_mut(n_taxels).collect();
            let (threads, spare) = (n_threads(threads)?, &self.spare);
            for_each(py, rows, threads, spare, SignalWorkspace::default, work)?;
            values.into_pyarray(py).reshape(shape)
        })
    }

    /// Returns the sensor signals of the frames of one touch, in order of time. With hysteresis or a scan order, a signal depends on several frames.
    ///
    /// n_before: number of leading frames that affect later frames, but are not returned.
    /// interval: time between frames, seconds. Default: the press stops at each frame until all taxels are read.
    /// time: elapsed fraction of the session, 0 to 1, for drift. Default: random, from the seed.
    ///
    /// Returns (n − n_before, …). Raises ValueError if an argument is invalid.
    #[pyo3(signature = (frames, *, seed=0, n_before=0, interval=None, time=None, rates=None))]
    fn read_touch<'py>(
        &self,
        py: Python<'py>,
        frames: &Object<'py>,
        seed: i128,
        n_before: i128,
        interval: Option<f64>,
        time: Option<f64>,
        rates: Option<&Object<'py>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        guarded(|| {
            let seed = whole_number("seed", seed)?;
            let n_before: usize = whole_number("n_before", n_before)?;
            let n_taxels = self.chain.n_taxels();
            let Frames {
                mut values,
                mut shape,
            } = self::frames("frames", frames, n_taxels, self.sides)?;
            let n_frames = values.nrows();
            if n_before >= n_frames {
                let given = format!("{n_before} of {n_frames} frames");
                return Err(bad_input("n_before", given, "fewer than there are"));
            }
            let allowed = "a positive number of seconds, or None";
            let is_interval = |seconds: f64| seconds.is_finite() && seconds > 0.0;
            check_number("interval", interval, allowed, is_interval)?;
            let is_share = |share| (0.0..=1.0).contains(&share);
            check_number("time", time, "0 to 1, or None", is_share)?;
            let rates = self.rates(rates, n_frames)?;
            let recording = Recording {
                frames: values.as_slice_mut().expect("frames are whole"),
                rates: rates.as_deref(),
                n_before,
                interval,
                time,
            };
            let (touch, mut scratch) = (Seed::new(seed), SignalWorkspace::default());
            py.detach(|| self.chain.apply_recording(recording, &touch, &mut scratch));
            // A single frame without an axis of frames has none before it.
            shape[0] -= n_before;
            let read = values.slice_axis(Axis(0), Slice::from(n_before..));
            read.to_pyarray(py).reshape(shape)
        })
    }

    /// Physical quantity of the returned signals: deflection (metres) or force (newtons).
    #[getter]
    fn quantity(&self) -> &'static str {
        self.chain.quantity().name()
    }

    /// Steps of the chain, in order.
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.steps.iter().cloned())
    }

    fn __repr__(&self) -> String {
        let steps: Vec<String> = self.steps.iter().map(Step::__repr__).collect();
        format!("<bubbletouch.Chain: [{}]>", steps.join(", "))
    }
}

impl Chain {
    /// Reads deflection rates, one for each value of the frames, m/s; returns `None` if no rates are given.
    fn rates(&self, given: Option<&Object>, n_frames: usize) -> PyResult<Option<Vec<f64>>> {
        let n_taxels = self.chain.n_taxels();
        let n = n_frames * n_taxels;
        let is_shape = |shape: &[usize]| {
            shape.iter().product::<usize>() == n && is_of_frames(shape, n_taxels, self.sides)
        };
        let allowed = "one for each value of frames";
        let read = |given| {
            let rates = array("rates", given, allowed, is_shape)?;
            let rates = rates.finite("rates", "finite numbers of m/s")?;
            Ok(rates.values().to_vec())
        };
        given.map(read).transpose()
    }
}
