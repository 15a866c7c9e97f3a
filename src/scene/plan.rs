//! Executable scene: the content of a [`SceneSpec`], checked and converted to SI units, with all files read.

use super::overlap::check_starts;
use super::plan_object::{Movement, PlannedObject, PlannedPress};
use super::planned::{PlannedPatch, PlannedRobot};
use super::reader::Reader;
use super::spec::{LayoutSpec, PlaneSpec, SceneSpec};
use super::spec_motion::metres;
use crate::contact::equilibrium::HalfSpace;
use crate::error::{Error, Result};
use crate::files::with_absolute_paths;
use crate::inputs::check::Check;
use crate::inputs::objects_spec::ModelSpec;
use crate::inputs::params::Described;
use crate::inputs::range::not_negative;
use crate::inputs::units::MM;
use crate::objects::Model;
use crate::random::Seed;
use crate::toml_lines::with_line;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Maximum number of steps of a scene; a larger number indicates a time step in the wrong unit.
const MAX_STEPS: f64 = 1e9;

/// Scene that is checked and ready for simulation: robots, skin, objects and the times of the frames.
#[derive(Clone, Debug)]
pub struct ScenePlan {
    /// File name of the scene, for error messages.
    pub place: String,
    /// Specification of the scene, with the duration filled in and all paths absolute.
    pub spec: SceneSpec,
    /// Number of frames per second of scene time, Hz.
    pub output_rate: f64,
    /// Number of frames, at least one. The time of frame k is k / output_rate seconds.
    pub n_frames: usize,
    /// Number of frames of the full scene, before [`cut`](Self::cut) shortened it. The drift of the sensors depends on this duration.
    pub n_frames_uncut: usize,
    /// Number of equal time steps between two frames, used by scenes whose state depends on earlier steps.
    pub n_substeps: usize,
    /// Gravitational acceleration, m/s², world frame.
    pub gravity: DVec3,
    /// Robots of the scene, in the order of the file.
    pub robots: Vec<PlannedRobot>,
    /// Patches of skin, in the order of the file.
    pub patches: Vec<PlannedPatch>,
    /// Objects of the scene, in the order of the file.
    pub objects: Vec<PlannedObject>,
    /// Contact model of each object.
    pub models: Vec<Model>,
    /// Rigid planes, such as tables.
    pub planes: Vec<HalfSpace>,
}

impl ScenePlan {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// If the file cannot be read, or a key is invalid.
    pub fn read(path: &Path) -> Result<Self> {
        let place = path.display().to_string();
        let text = crate::files::read_to_string(path).map_err(|e| {
            Error::input(&place, format!("cannot be read ({e})"), "a scene in TOML")
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let plan = Self::new(&place, folder, SceneSpec::parse(&place, &text)?);
        plan.map_err(|error| with_line(&place, &text, error))
    }

    /// Checks a scene and reads its files; paths are relative to `folder`.
    ///
    /// # Errors
    /// If a key is invalid or a file cannot be read. The error begins with `place` (the file name) and the key.
    pub fn new(place: &str, folder: &Path, spec: SceneSpec) -> Result<Self> {
        Self::with_models(place, folder, spec, &BTreeMap::new())
    }

    /// Checks a scene in which some objects, given by name, are passed in memory. For these objects, the scene must not have `object`, `spheres` or `mesh`.
    ///
    /// # Errors
    /// If a key is invalid, a file cannot be read, or the scene has no object with the name of a model.
    pub fn with_models(
        place: &str,
        folder: &Path,
        mut spec: SceneSpec,
        models: &BTreeMap<String, Model>,
    ) -> Result<Self> {
        let check = &Check { place };
        spec.check(check, "", None)?;
        check_names(check, &spec)?;
        let mut reader = Reader {
            models,
            objects: &spec.objects,
            ..Reader::new(place, folder)
        };
        reader.check_models()?;
        let robots = spec.robots.iter().map(|robot| reader.robot(robot));
        reader.robots = robots.collect::<Result<_>>()?;
        let seed = Seed::new(spec.seed);
        let patches = spec.patches.iter_mut();
        let patches = patches.map(|patch| reader.patch(patch, &seed));
        reader.patches = patches.collect::<Result<_>>()?;
        let pitches = spec.patches.iter().zip(&reader.patches);
        let pitches = pitches.map(|(spec, patch)| {
            let radii = patch.skin.taxels().all().iter().map(|taxel| taxel.radius);
            let listed = 2.0 * radii.fold(f64::INFINITY, f64::min) / MM;
            spec.layout.pitch_mm().unwrap_or(listed)
        });
        let finest_mm = pitches.fold(f64::INFINITY, f64::min);
        // Packed spheres are smoother than scans, on which a mesh of another scan meets one facet after another.
        let default_model = match spec.objects.iter().any(|object| object.free.is_some()) {
            true => ModelSpec::Packed,
            false => ModelSpec::Mesh,
        };
        let objects = spec.objects.iter();
        let objects = objects.map(|object| reader.object(object, (finest_mm, default_model)));
        let (objects, models): (Vec<_>, Vec<_>) =
            objects.collect::<Result<Vec<_>>>()?.into_iter().unzip();
        check_presses(check, &spec)?;
        let gravity = DVec3::from_array(spec.gravity_m_per_s2);
        let is_free = |object: &&PlannedObject| matches!(object.movement, Movement::Free { .. });
        let free = objects.iter().find(is_free);
        if gravity == DVec3::ZERO && free.is_some() {
            let allowed = "not zero in a scene with a free object";
            return reader.refuse("gravity_m_per_s2", gravity, allowed);
        }
        check_planes(check, &spec, free.is_some())?;
        check_starts(check, &objects, &models, &reader.robots)?;
        let planes = spec.planes.iter().map(|plane| half_space(&reader, plane));
        let planes = planes.collect::<Result<Vec<_>>>()?;
        let Reader {
            robots, patches, ..
        } = reader;
        let duration = *spec
            .duration_s
            .get_or_insert_with(|| end(&robots, &objects));
        let clock = Clock::new(check, &spec, duration)?;
        let spec = with_absolute_paths(place, &spec, folder)?;
        Ok(Self {
            place: place.to_owned(),
            output_rate: spec.output_hz,
            spec,
            n_frames: clock.n_frames,
            n_frames_uncut: clock.n_frames,
            n_substeps: clock.n_substeps,
            gravity,
            robots,
            patches,
            objects,
            models,
            planes,
        })
    }

    /// Ends the scene at `until` seconds if it would last longer. The remaining frames equal the first frames of the whole scene.
    ///
    /// # Errors
    /// If the time is negative or not finite.
    pub fn cut(&mut self, place: &str, until: f64) -> Result<()> {
        if !not_negative(until) {
            let allowed = "zero or a positive number of seconds";
            return Err(Error::input(place, until, allowed));
        }
        self.n_frames = self.n_frames.min(Clock::frames(until, self.output_rate));
        Ok(())
    }

    /// Returns the time of the frame with this number, seconds.
    pub fn time(&self, frame: usize) -> f64 {
        frame as f64 / self.output_rate
    }

    /// Returns notes about parts of the robot and layout files that are used or ignored; each note starts with the key of the robot or patch.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        let of_robot = |robot: &PlannedRobot| {
            let trajectory = robot.joints.iter().flat_map(|joints| joints.notes());
            let sensors = robot.robot.tactile_sensors().iter();
            let unused = sensors.filter(|sensor| !self.has_sensor(&robot.name, &sensor.name));
            let unused = unused.map(|sensor| {
                format!(
                    "tactile sensor `{0}` on link `{1}` is not read: layout = {{ sensor = \"{0}\" }} of a patch reads its {2} taxels",
                    sensor.name,
                    sensor.link,
                    sensor.taxels.len()
                )
            });
            let notes = robot.robot.notes().iter().chain(trajectory).cloned();
            let of = |note: String| format!("robots.{}: {note}", robot.name);
            notes.chain(unused).map(of).collect::<Vec<_>>()
        };
        let of_patch = |patch: &PlannedPatch| {
            let of = |note: &String| format!("patches.{}: {note}", patch.skin.name());
            patch.notes.iter().map(of).collect::<Vec<_>>()
        };
        let of_robots = self.robots.iter().flat_map(of_robot);
        of_robots.chain(self.patches.iter().flat_map(of_patch))
    }

    /// Returns whether a patch uses the taxels of the tactile sensor with this name in the file of this robot.
    fn has_sensor(&self, robot: &str, sensor: &str) -> bool {
        let mut patches = self.spec.patches.iter();
        patches.any(|patch| {
            let is_of_sensor = matches!(&patch.layout, LayoutSpec::Sensor(name) if name == sensor);
            is_of_sensor && patch.robot.as_deref() == Some(robot)
        })
    }

    /// Returns whether the frames depend on time steps between them. This is the case if the scene has dampers, friction, free objects or pressed objects.
    pub fn needs_steps(&self) -> bool {
        let remembers = |object: &PlannedObject| {
            matches!(object.movement, Movement::Free { .. }) || object.press.is_some()
        };
        self.patches.iter().any(PlannedPatch::remembers) || self.objects.iter().any(remembers)
    }
}

/// Number of frames of a scene, and number of time steps between two frames.
struct Clock {
    n_frames: usize,
    n_substeps: usize,
}

impl Clock {
    fn new(check: &Check, spec: &SceneSpec, duration: f64) -> Result<Self> {
        let (dt, rate) = (spec.dt_ms * MM, spec.output_hz);
        if duration * rate.max(1.0 / dt) > MAX_STEPS {
            let dt_ms = spec.dt_ms;
            let given = format!("{duration} s with dt_ms = {dt_ms} and output_hz = {rate}");
            return Err(check.error("duration_s", given, format!("at most {MAX_STEPS} steps")));
        }
        // The tolerance keeps a whole number of steps whole after conversion of units.
        let substeps = (1.0 / (rate * dt) - 1e-9).ceil().max(1.0);
        if substeps > MAX_STEPS {
            let given = format!("{} beside output_hz = {rate}", spec.dt_ms);
            return Err(check.error("dt_ms", given, format!("at most {MAX_STEPS} steps a frame")));
        }
        Ok(Self {
            n_frames: Self::frames(duration, rate),
            n_substeps: substeps as usize,
        })
    }

    /// Returns the number of frames of a scene with this duration (seconds) and frame rate (Hz).
    fn frames(duration: f64, rate: f64) -> usize {
        (duration * rate + 1e-9).floor() as usize + 1
    }
}

fn check_names(check: &Check, spec: &SceneSpec) -> Result<()> {
    if spec.patches.is_empty() {
        return Err(check.error("patches", "none", "at least one"));
    }
    let robots = spec.robots.iter().map(|robot| ("robots", &robot.name));
    let patches = spec.patches.iter().map(|patch| ("patches", &patch.name));
    let objects = spec.objects.iter().map(|object| ("objects", &object.name));
    let planes = spec.planes.iter().map(|plane| ("planes", &plane.name));
    let mut seen = BTreeSet::new();
    for (key, name) in robots.chain(patches).chain(objects).chain(planes) {
        if name.trim().is_empty() {
            return Err(check.error(key, "an empty name", "a name"));
        }
        if !seen.insert(name) {
            let given = format!("a second thing called `{name}`");
            let allowed = "each name once over robots, patches, objects and planes";
            return Err(check.error(key, given, allowed));
        }
    }
    Ok(())
}

/// Converts a plane of a scene file to a half-space in SI units with a unit normal.
fn half_space(reader: &Reader, plane: &PlaneSpec) -> Result<HalfSpace> {
    let normal = DVec3::from_array(plane.normal);
    let Some(normal) = normal.try_normalize() else {
        let key = format!("planes.{}.normal", plane.name);
        return reader.refuse(&key, normal, "a direction of any length above zero");
    };
    Ok(HalfSpace {
        normal,
        height: normal.dot(metres(plane.point_mm)),
    })
}

/// Checks that planes occur only together with free objects.
fn check_planes(check: &Check, spec: &SceneSpec, has_free: bool) -> Result<()> {
    match spec.planes.first() {
        Some(plane) if !has_free => {
            let given = format!("plane `{}` in a scene without free objects", plane.name);
            let allowed = "planes beside free objects: nothing else rests on them";
            Err(check.error("planes", given, allowed))
        }
        _ => Ok(()),
    }
}

/// Checks that each patch has at most one pressed object, and that pressed and free objects do not occur together.
fn check_presses(check: &Check, spec: &SceneSpec) -> Result<()> {
    let free = spec.objects.iter().find(|object| object.free.is_some());
    let mut seen: BTreeMap<&str, &str> = BTreeMap::new();
    for object in &spec.objects {
        let Some(press) = &object.press else { continue };
        let key = format!("objects.{}.press", object.name);
        if let Some(free) = free {
            let given = format!(
                "an object that is pushed beside the free object `{}`",
                free.name
            );
            return Err(check.error(&key, given, "no free objects in the scene"));
        }
        if let Some(other) = seen.insert(&press.patch, &object.name) {
            let given = format!("patch `{}`, which `{other}` is pushed onto", press.patch);
            return Err(check.error(&format!("{key}.patch"), given, "one object a patch"));
        }
    }
    Ok(())
}

/// Returns the time at which all imposed motions and all changes of target forces have ended, seconds.
fn end(robots: &[PlannedRobot], objects: &[PlannedObject]) -> f64 {
    let objects = objects.iter().map(|object| {
        let press = object.press.as_ref().map_or(0.0, PlannedPress::end);
        match &object.movement {
            Movement::Imposed { motion, .. } => motion.end().max(press),
            Movement::Free { .. } => 0.0,
        }
    });
    let robots = robots.iter().map(PlannedRobot::end);
    robots.chain(objects).fold(0.0, f64::max)
}
