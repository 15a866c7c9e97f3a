//! Objects of an executable scene: contact models and motions.

use super::plan_patch::PlannedPatch;
use super::plan_press::PlannedPress;
use super::plan_robot::PlannedRobot;
use super::reader::{MM, Reader};
use super::spec::{FreeSpec, ObjectSpec};
use crate::error::Result;
use crate::geometry::Pose;
use crate::inputs::object_files::{load_catalogue, load_mesh, load_spheres};
use crate::inputs::objects_spec::{ModelSpec, ObjectsSpec};
use crate::inputs::range::positive;
use crate::mesh::SizeLimits;
use crate::objects::{Catalogue, Model, Solid, pack};
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
    /// Bounding ball of the object (centre, radius), object frame, metres.
    pub(super) ball: (DVec3, f64),
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
    Imposed(Motion),
    /// Motion that is imposed relative to a link of a robot.
    Carried {
        /// Index of the robot in the scene.
        robot: usize,
        /// Index of the link that carries the object in the robot.
        link: usize,
        /// Motion of the object in the frame of the link.
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

impl Reader<'_> {
    /// Checks an object of a scene file and returns the object with its contact model. The finest pitch of all patches is `finest_mm`; `default` is the default
    /// contact model of a mesh.
    pub fn object(
        &self,
        spec: &ObjectSpec,
        (robots, patches): (&[PlannedRobot], &[PlannedPatch]),
        (finest_mm, default): (f64, ModelSpec),
    ) -> Result<(PlannedObject, Model)> {
        let key = &format!("objects.{}", spec.name);
        let for_mesh = spec.model.unwrap_or(default);
        let model = self.model(key, spec, finest_mm, for_mesh)?;
        let is_carried = spec.robot.is_some() || spec.link.is_some();
        if is_carried && spec.free.is_some() {
            let allowed = "robot or free, not both";
            return Err(self
                .check
                .error(key, "an object with two movements", allowed));
        }
        let movement = match (&spec.free, &spec.motion) {
            _ if is_carried => self.carried(key, spec, robots)?,
            (None, motion) => Movement::Imposed(self.motion(key, &spec.at, motion.as_ref())?),
            (Some(_), Some(_)) => {
                let allowed = "free or motion, not both";
                return Err(self
                    .check
                    .error(key, "a free object with a motion", allowed));
            }
            (Some(free), None) => self.free(key, spec, free, &model)?,
        };
        let press = spec.press.as_ref();
        let press = press.map(|press| self.press(key, press, patches));
        let object = PlannedObject {
            name: spec.name.clone(),
            movement,
            press: press.transpose()?,
            ball: ball(&model),
            surface_error: MM * spec.surface_error_or_default_mm(finest_mm, for_mesh),
        };
        Ok((object, model))
    }

    /// Checks an object that a robot's link carries, and returns its motion.
    pub fn carried(
        &self,
        key: &str,
        spec: &ObjectSpec,
        robots: &[PlannedRobot],
    ) -> Result<Movement> {
        let Some(name) = &spec.robot else {
            let given = format!("`{}` without a robot", spec.link.as_deref().unwrap_or(""));
            let allowed = "robot = \"NAME\" beside it";
            return Err(self.check.error(&format!("{key}.link"), given, allowed));
        };
        let (robot, link) = self.link(key, (name, spec.link.as_deref()), robots)?;
        Ok(Movement::Carried {
            robot,
            link,
            motion: self.motion(key, &spec.at, spec.motion.as_ref())?,
        })
    }

    /// Checks that each model given in memory belongs to an object of the scene.
    pub fn check_models(&self, objects: &[ObjectSpec]) -> Result<()> {
        let names = objects.iter().map(|object| object.name.as_str());
        for name in self.models.keys() {
            if names.clone().all(|known| known != name) {
                let given = format!("a model for `{name}`");
                let allowed = nearest_names(name, names);
                return Err(self.check.error("objects", given, allowed));
            }
        }
        Ok(())
    }

    /// Returns the contact model of an object; `model` selects how a mesh is represented.
    pub fn model(
        &self,
        key: &str,
        spec: &ObjectSpec,
        finest_mm: f64,
        model: ModelSpec,
    ) -> Result<Model> {
        if let Some(model) = self.models.get(&spec.name) {
            return self.model_in_memory(key, spec, model);
        }
        let has_file = spec.mesh.is_some() || spec.spheres.is_some();
        let is_solid = spec.object.is_some() || !spec.parts.is_empty();
        let misplaced = [
            (
                spec.model.is_some() && spec.mesh.is_none(),
                "model",
                "mesh = \"FILE\"",
            ),
            (spec.unit.is_some() && !has_file, "unit", "mesh or spheres"),
            (
                spec.objects.is_some() && spec.object.is_none(),
                "objects",
                "object = \"NAME\"",
            ),
            (spec.centered && !is_solid, "centered", "object or parts"),
        ];
        if let Some((_, what, beside)) = misplaced.into_iter().find(|(is_so, ..)| *is_so) {
            let given = format!("{what} without {beside}");
            return Err(self
                .check
                .error(key, given, format!("it only beside {beside}")));
        }
        let is_made_of_spheres = is_solid || (spec.mesh.is_some() && model == ModelSpec::Packed);
        if spec.surface_error_mm.is_some() && has_file && !is_made_of_spheres {
            let given = "given beside spheres, or a mesh that is not packed";
            let allowed = "it only beside object = \"NAME\" or model = \"packed\"";
            return Err(self
                .check
                .error(&format!("{key}.surface_error_mm"), given, allowed));
        }
        let error_mm = spec.surface_error_or_default_mm(finest_mm, model);
        let error_key = format!("{key}.surface_error_mm");
        let allowed = "a positive number of millimetres";
        let surface_error = MM * self.check.value(&error_key, error_mm, positive, allowed)?;
        let kinds = [is_solid, spec.spheres.is_some(), spec.mesh.is_some()];
        match (kinds, &spec.spheres, &spec.mesh) {
            ([true, false, false], ..) => {
                let mut solid = self.solid(key, spec)?;
                if spec.centered {
                    let middle = solid.bounds().center();
                    solid = solid.moved(&Pose::from_translation(-middle));
                }
                Ok(self.under(key, pack(&solid, surface_error))?.into())
            }
            ([false, true, false], Some(path), _) => {
                let key = &format!("{key}.spheres");
                self.open(key, path)?;
                let spheres = load_spheres(&self.path(path), spec.unit, &SizeLimits::ANY);
                Ok(self.under(key, spheres)?.into())
            }
            ([false, false, true], _, Some(path)) => {
                let key = &format!("{key}.mesh");
                self.open(key, path)?;
                let wanted = ObjectsSpec {
                    unit: spec.unit,
                    model: Some(model),
                    pitch: Some(MM * finest_mm),
                    surface_error_mm: Some(error_mm),
                    ..ObjectsSpec::default()
                };
                let mesh = load_mesh(&self.path(path), &wanted, None);
                Ok(self.under(key, mesh)?.model)
            }
            _ => Err(self.check.error(
                key,
                "none, or several, of object, parts, spheres and mesh",
                "one of them",
            )),
        }
    }

    /// Returns the solid of a built-in object, or the solid whose parts are given by the key `parts`.
    pub fn solid(&self, key: &str, spec: &ObjectSpec) -> Result<Solid> {
        let Some(name) = &spec.object else {
            let text = toml::to_string(&BTreeMap::from([("part", &spec.parts)]));
            let text = text.expect("tables that were read have a TOML form");
            let place = format!("{}, key {key}.parts", self.check.place);
            return Solid::parse_parts(&place, &text);
        };
        if !spec.parts.is_empty() {
            let given = "object and parts";
            return Err(self.check.error(key, given, "one of them"));
        }
        let catalogue = match &spec.objects {
            Some(path) => {
                let key = &format!("{key}.objects");
                self.open(key, path)?;
                self.under(key, load_catalogue(&self.path(path)))?
            }
            None => Catalogue::builtin()?,
        };
        let entry = self.under(&format!("{key}.object"), catalogue.object(name))?;
        Ok(entry.solid.clone())
    }

    /// Returns a model that is given in memory; returns an error if the object has keys that apply only to files.
    fn model_in_memory(&self, key: &str, spec: &ObjectSpec, model: &Model) -> Result<Model> {
        let shape = [
            ("object", spec.object.is_some()),
            ("objects", spec.objects.is_some()),
            ("parts", !spec.parts.is_empty()),
            ("centered", spec.centered),
            ("spheres", spec.spheres.is_some()),
            ("mesh", spec.mesh.is_some()),
            ("model", spec.model.is_some()),
            ("unit", spec.unit.is_some()),
            ("surface_error_mm", spec.surface_error_mm.is_some()),
        ];
        match shape.into_iter().find(|(_, is_given)| *is_given) {
            None => Ok(model.clone()),
            Some((name, _)) => {
                let given = "given beside an object in memory";
                let allowed = "no key of its shape: it is touched as it is";
                Err(self.check.error(&format!("{key}.{name}"), given, allowed))
            }
        }
    }

    fn free(
        &self,
        key: &str,
        spec: &ObjectSpec,
        free: &FreeSpec,
        model: &Model,
    ) -> Result<Movement> {
        if spec.press.is_some() {
            let given = "a free object that is pushed";
            let allowed = "free, or press beside a motion";
            return Err(self.check.error(&format!("{key}.press"), given, allowed));
        }
        let mass_key = format!("{key}.free.mass_kg");
        let Some(mass) = free.mass_kg else {
            let given = "a free object without mass";
            return Err(self.check.error(&mass_key, given, "a positive number"));
        };
        let center_key = format!("{key}.free.center_of_mass_mm");
        Ok(Movement::Free {
            start: self.pose(&format!("{key}.at"), &spec.at)?,
            mass: self
                .check
                .value(&mass_key, mass, positive, "a positive number")?,
            center_of_mass: match free.center_of_mass_mm {
                Some(center) => self.vector(&center_key, center, MM)?,
                None => model.center_of_mass(),
            },
        })
    }
}

/// Returns a bounding ball of the model (centre and radius), whose centre is the centre of the model's bounding box.
fn ball(model: &Model) -> (DVec3, f64) {
    let bounds = model.bounds();
    let center = bounds.center();
    let radius = match model {
        Model::Spheres(union) => union.reach_from(center),
        Model::Mesh(_) => 0.5 * bounds.size().length(),
    };
    (center, radius)
}
