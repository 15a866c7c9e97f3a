//! Objects of an executable scene: contact models, motions and target forces.

use super::planned::Carrier;
use super::reader::Reader;
use super::spec::{MOVEMENT_RULES, Numbers, ObjectSpec, PressSpec, SHAPE_KEYS, SHAPE_RULES};
use super::spec_motion::metres;
use crate::error::Result;
use crate::geometry::Pose;
use crate::inputs::object_files::{load_catalogue, load_mesh, load_spheres};
use crate::inputs::objects_spec::{ModelSpec, ObjectsSpec};
use crate::inputs::toml_value::table_of;
use crate::inputs::units::MM;
use crate::mesh::SizeLimits;
use crate::objects::{Catalogue, Model, Solid, Sphere, pack};
use crate::spelling::nearest_names;
use crate::world::Motion;
use glam::DVec3;
use std::collections::BTreeMap;

/// Object of a scene, checked and ready for simulation.
#[derive(Clone, Debug)]
pub struct PlannedObject {
    /// Name of the object in the scene.
    pub name: String,
    /// Rule by which the pose of the object is determined: imposed, carried or free.
    pub movement: Movement,
    /// Control of the force on a patch, for an object with imposed motion and a target force; otherwise `None`.
    pub press: Option<PlannedPress>,
    /// Bounding ball of the object, object frame, metres.
    pub(super) ball: Sphere,
    /// Maximum distance between the spheres and the object's surface, metres.
    pub(super) surface_error: f64,
}

impl ObjectSpec {
    /// Returns the maximum distance between spheres and surface, mm: the key `surface_error_mm`, or a default derived from the smallest pitch.
    fn surface_error_or_default_mm(&self, finest_mm: f64, for_mesh: ModelSpec) -> f64 {
        let model = self.mesh.as_ref().map_or(ModelSpec::Mesh, |_| for_mesh);
        let default = || model.default_surface_error_mm(finest_mm);
        self.surface_error_mm.unwrap_or_else(default)
    }
}

/// Rule by which the pose of an object is determined.
#[derive(Clone, Debug)]
pub enum Movement {
    /// Imposed motion, which does not depend on contacts.
    Imposed {
        /// Body in whose frame the motion is given: the world or a link of a robot.
        carrier: Carrier,
        /// Motion of the object in the frame of the carrier.
        motion: Motion,
    },
    /// Free motion under gravity and contact forces.
    Free {
        /// Initial pose of the free object, `world_from_object`, before the first equilibrium.
        start: Pose,
        /// Mass of the free object, kilograms.
        mass: f64,
        /// Centre of mass of the free object, object frame, metres.
        center_of_mass: DVec3,
    },
}

/// Control of the force with which an object is pressed onto a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedPress {
    /// Index of the patch whose force is controlled.
    pub patch: usize,
    /// Direction of the travel, a unit vector in the world frame.
    pub direction: DVec3,
    /// Times at which target forces are given, seconds, strictly increasing; at least one.
    pub times: Vec<f64>,
    /// Target of the patch's total spring force at each time, N, at least 0. Between the times, the target is interpolated linearly; outside, it is constant.
    pub forces: Vec<f64>,
    /// Maximum speed of the object along the direction of travel, m/s, positive.
    pub speed: f64,
    /// Maximum distance of the object from the pose of its imposed motion, metres, positive.
    pub travel: f64,
}

impl PlannedPress {
    /// Returns the target force at a time (seconds), N.
    pub fn force_at(&self, time: f64) -> f64 {
        let after = self.times.partition_point(|&t| t <= time);
        match (after.checked_sub(1), self.forces.get(after)) {
            (Some(before), Some(next)) => {
                let share = (time - self.times[before]) / (self.times[after] - self.times[before]);
                self.forces[before] + share * (next - self.forces[before])
            }
            (Some(last), None) => self.forces[last],
            (None, _) => self.forces[0],
        }
    }

    /// Returns the time of the last given target force, seconds.
    pub fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

impl Reader<'_> {
    /// Checks an object of a scene file and returns the object with its contact model. The finest pitch of all patches is `finest_mm`; `default` is the default
    /// contact model of a mesh.
    pub fn object(
        &self,
        spec: &ObjectSpec,
        (finest_mm, default): (f64, ModelSpec),
    ) -> Result<(PlannedObject, Model)> {
        let key = &format!("objects.{}", spec.name);
        let for_mesh = spec.model.unwrap_or(default);
        let model = self.model(key, spec, finest_mm, for_mesh)?;
        self.check.rules(key, spec, MOVEMENT_RULES)?;
        let movement = match &spec.free {
            None => self.imposed(key, spec)?,
            Some(free) => {
                let Some(mass) = free.mass_kg else {
                    let key = format!("{key}.free.mass_kg");
                    return self.refuse(&key, "a free object without mass", "a positive number");
                };
                let center = free.center_of_mass_mm.map(metres);
                Movement::Free {
                    start: spec.at.pose(),
                    mass,
                    center_of_mass: center.unwrap_or_else(|| model.center_of_mass()),
                }
            }
        };
        let press = spec.press.as_ref();
        let press = press.map(|press| self.press(&format!("{key}.press"), press));
        let object = PlannedObject {
            name: spec.name.clone(),
            movement,
            press: press.transpose()?,
            ball: ball(&model),
            surface_error: MM * spec.surface_error_or_default_mm(finest_mm, for_mesh),
        };
        Ok((object, model))
    }

    /// Returns the imposed movement of an object, in the world or on a robot's link.
    pub fn imposed(&self, key: &str, spec: &ObjectSpec) -> Result<Movement> {
        let on = (spec.robot.as_deref(), spec.link.as_deref());
        Ok(Movement::Imposed {
            carrier: self.carrier(key, on)?,
            motion: self.motion(key, &spec.at, spec.motion.as_ref())?,
        })
    }

    /// Checks that each model given in memory belongs to an object of the scene.
    pub fn check_models(&self) -> Result<()> {
        let names = self.objects.iter().map(|object| object.name.as_str());
        for name in self.models.keys() {
            if names.clone().all(|known| known != name) {
                let given = format!("a model for `{name}`");
                return self.refuse("objects", given, nearest_names(name, names));
            }
        }
        Ok(())
    }

    /// Returns the contact model of an object; `for_mesh` selects how a mesh is represented.
    pub fn model(
        &self,
        key: &str,
        spec: &ObjectSpec,
        finest_mm: f64,
        for_mesh: ModelSpec,
    ) -> Result<Model> {
        if let Some(model) = self.models.get(&spec.name) {
            let given = table_of(spec);
            let Some(name) = SHAPE_KEYS.iter().find(|name| given.contains_key(**name)) else {
                return Ok(model.clone());
            };
            let given = "given beside an object in memory";
            let allowed = "no key of its shape: it is touched as it is";
            return self.refuse(&format!("{key}.{name}"), given, allowed);
        }
        self.check.rules(key, spec, SHAPE_RULES)?;
        let is_unpacked = spec.mesh.is_some() && for_mesh != ModelSpec::Packed;
        let error_key = format!("{key}.surface_error_mm");
        if spec.surface_error_mm.is_some() && (spec.spheres.is_some() || is_unpacked) {
            let given = "given beside spheres, or a mesh that is not packed";
            let allowed = "it only beside object = \"NAME\" or model = \"packed\"";
            return self.refuse(&error_key, given, allowed);
        }
        let error_mm = spec.surface_error_or_default_mm(finest_mm, for_mesh);
        if let Some(path) = &spec.spheres {
            let spheres = self.read(&format!("{key}.spheres"), path, |path| {
                load_spheres(path, spec.unit, &SizeLimits::ANY)
            });
            return Ok(spheres?.into());
        }
        if let Some(path) = &spec.mesh {
            let key = &format!("{key}.mesh");
            let wanted = ObjectsSpec {
                unit: spec.unit,
                model: Some(for_mesh),
                pitch: Some(MM * finest_mm),
                surface_error_mm: Some(error_mm),
                ..ObjectsSpec::default()
            };
            let mesh = self.read(key, path, |path| load_mesh(path, &wanted, None));
            return Ok(mesh?.model);
        }
        let mut solid = self.solid(key, spec)?;
        if spec.centered {
            let middle = solid.bounds().center();
            solid = solid.moved(&Pose::from_translation(-middle));
        }
        Ok(self.under(key, pack(&solid, MM * error_mm))?.into())
    }

    /// Returns the solid of a built-in object, or the solid whose parts are given by the key `parts`.
    pub fn solid(&self, key: &str, spec: &ObjectSpec) -> Result<Solid> {
        let Some(name) = &spec.object else {
            let text = toml::to_string(&BTreeMap::from([("part", &spec.parts)]));
            let text = text.expect("tables that were read have a TOML form");
            let place = format!("{}, key {key}.parts", self.check.place);
            return Solid::parse_parts(&place, &text);
        };
        let catalogue = match &spec.objects {
            Some(path) => self.read(&format!("{key}.objects"), path, load_catalogue)?,
            None => Catalogue::builtin()?,
        };
        let entry = self.under(&format!("{key}.object"), catalogue.object(name))?;
        Ok(entry.solid.clone())
    }

    /// Checks the keys of a pressed object and returns the control of its force.
    fn press(&self, key: &str, spec: &PressSpec) -> Result<PlannedPress> {
        let names = self.patches.iter().map(|patch| patch.skin.name());
        let patch = self.known(&format!("{key}.patch"), &spec.patch, names)?;
        let direction = DVec3::from_array(spec.direction);
        if direction == DVec3::ZERO {
            let allowed = "a vector that is not zero";
            return self.refuse(&format!("{key}.direction"), direction, allowed);
        }
        let (times, forces) = match &spec.force_n {
            Numbers::One(force) if spec.time_s.is_empty() => (vec![0.0], vec![*force]),
            Numbers::One(_) => {
                let allowed = "a list, one a time; or no time_s";
                let key = format!("{key}.force_n");
                return self.refuse(&key, "one force beside time_s", allowed);
            }
            Numbers::Each(forces) => (spec.time_s.clone(), forces.clone()),
        };
        if forces.is_empty() || forces.len() != times.len() {
            let given = format!("{} forces", forces.len());
            let allowed = format!("{}, one a time of time_s, and at least one", times.len());
            return self.refuse(&format!("{key}.force_n"), given, allowed);
        }
        if let Some(pair) = times.windows(2).find(|pair| pair[0] >= pair[1]) {
            let given = format!("{} s after {} s", pair[1], pair[0]);
            let key = format!("{key}.time_s");
            return self.refuse(&key, given, "strictly ascending times");
        }
        Ok(PlannedPress {
            patch,
            direction: direction.normalize(),
            times,
            forces,
            speed: spec.speed_mm_per_s * MM,
            travel: spec.travel_mm * MM,
        })
    }
}

/// Returns a bounding ball of the model, whose centre is the centre of the model's bounding box.
fn ball(model: &Model) -> Sphere {
    let around = Sphere::around(&model.bounds());
    match model {
        Model::Spheres(union) => Sphere {
            radius: union.reach_from(around.center),
            ..around
        },
        Model::Mesh(_) => around,
    }
}
