//! Patches of an executable scene: layouts, taxels and carriers.

use super::link_surface::{LinkSurface, link_surface};
use super::planned::{Carrier, PlannedPatch, PlannedRobot};
use super::reader::Reader;
use super::spec::{DrapedSpec, FileLayoutSpec, LayoutSpec, PatchSpec, RegionSpec};
use super::spec_motion::metres;
use super::spec_patch::{DRAPED_RULES, PATCH_RULES, REGION_RULES};
use crate::error::Result;
use crate::geometry::Aabb;
use crate::inputs::layout_file::{LayoutFile, LayoutOptions};
use crate::inputs::object_files::read_surface;
use crate::inputs::units::MM;
use crate::mesh::{LengthUnit, MeshFormat, SizeLimits, TriangleMesh, obj_group};
use crate::random::Seed;
use crate::world::{DrapeRegion, Grid, Layout, Patch, PerTaxel};
use glam::DVec3;
use std::path::Path;

impl LayoutSpec {
    /// Returns the distance between neighbouring taxels, mm; `None` for layouts that list single taxels.
    pub fn pitch_mm(&self) -> Option<f64> {
        match self {
            Self::Grid(layout) => Some(layout.pitch_mm),
            Self::Hexagonal(layout) => Some(layout.pitch_mm),
            Self::Disc(layout) => Some(layout.pitch_mm),
            Self::Annulus(layout) => Some(layout.pitch_mm),
            Self::Cylinder(layout) => Some(layout.pitch_mm),
            Self::SphereCap(layout) => Some(layout.pitch_mm),
            Self::Draped(layout) => Some(layout.pitch_mm),
            Self::File(_) | Self::Sensor(_) => None,
        }
    }
}

/// Taxels of a patch, before their properties are known.
struct PlacedTaxels {
    layout: Layout,
    /// Default radii of the taxels, mm.
    radii_mm: PerTaxel<f64>,
    /// Link in whose frame the taxels are; `None` if the patch may be on any link.
    link: Option<String>,
    notes: Vec<String>,
}

impl PlacedTaxels {
    fn listed(file: LayoutFile) -> Self {
        let radii_mm = match &file.radii {
            Some(radii) => PerTaxel::Each(radii.iter().map(|radius| radius / MM).collect()),
            None => PerTaxel::Equal(file.default_radius() / MM),
        };
        Self {
            layout: file.layout,
            radii_mm,
            link: None,
            notes: file.notes,
        }
    }
}

impl Reader<'_> {
    /// Checks a patch of a scene file and returns its taxels, carrier, friction and signal chain. Writes default values into the specification of the patch.
    pub fn patch(&self, spec: &mut PatchSpec, seed: &Seed) -> Result<PlannedPatch> {
        let key = &format!("patches.{}", spec.name);
        self.check.rules(key, spec, PATCH_RULES)?;
        let layout_key = &format!("{key}.layout");
        let placed = self.place_taxels(layout_key, spec, &seed.named(&spec.name))?;
        if let Some(link) = placed.link {
            let given = spec.link.get_or_insert_with(|| link.clone());
            if *given != link {
                let given = format!("`{given}`, but the taxels are in the frame of link `{link}`");
                let allowed = "the link of the taxels, or no such key";
                return self.refuse(&format!("{key}.link"), given, allowed);
            }
        }
        let n_taxels = placed.layout.n_taxels();
        let (taxels, shears) = self.taxels(key, spec, (n_taxels, placed.radii_mm))?;
        let skin = self.under(key, Patch::new(&spec.name, placed.layout, taxels))?;
        if let Some(shears) = &shears {
            self.under(key, shears.check_on(&skin))?;
        }
        Ok(PlannedPatch {
            signal: self.signal(key, &spec.signal, &skin, seed)?,
            skin,
            carrier: self.carrier_of_patch(key, spec)?,
            at: spec.at.pose(),
            shears,
            notes: placed.notes,
        })
    }

    /// Returns the body that carries a patch: an object, a robot link, or the world.
    fn carrier_of_patch(&self, key: &str, spec: &PatchSpec) -> Result<Carrier> {
        let Some(name) = &spec.object else {
            let on = (spec.robot.as_deref(), spec.link.as_deref());
            return self.carrier(key, on);
        };
        let key = &format!("{key}.object");
        let names = self.objects.iter().map(|object| object.name.as_str());
        let object = self.known(key, name, names)?;
        if self.objects[object].free.is_some() || self.objects[object].press.is_some() {
            let given = format!("`{name}`, which does not go where it is told");
            return self.refuse(key, given, "an object that is neither free nor pushed");
        }
        Ok(Carrier::Object(object))
    }

    /// Returns the robot that a patch names; its surface or sensor is used by the key `key`.
    fn robot_of_patch(&self, key: &str, spec: &PatchSpec) -> Result<&PlannedRobot> {
        let Some(name) = &spec.robot else {
            let allowed = "robot = \"NAME\" of the patch";
            return self.refuse(key, "a patch without a robot", allowed);
        };
        let names = self.robots.iter().map(|robot| robot.name.as_str());
        let key = format!("patches.{}.robot", spec.name);
        Ok(&self.robots[self.known(&key, name, names)?])
    }

    /// Returns the layout of a patch, and the properties of its taxels that the layout determines.
    fn place_taxels(&self, key: &str, spec: &PatchSpec, seed: &Seed) -> Result<PlacedTaxels> {
        let pitch_mm = spec.layout.pitch_mm().unwrap_or_default();
        let pitch = pitch_mm * MM;
        let mut link = None;
        let layout = match &spec.layout {
            LayoutSpec::File(file) => {
                let file = self.layout_file(&format!("{key}.file"), file)?;
                return Ok(PlacedTaxels::listed(file));
            }
            LayoutSpec::Sensor(sensor) => {
                let key = &format!("{key}.sensor");
                let sensors = self.robot_of_patch(key, spec)?;
                let sensors = sensors.robot.tactile_sensors();
                let names = sensors.iter().map(|sensor| sensor.name.as_str());
                let sensor = &sensors[self.known(key, sensor, names)?];
                return Ok(PlacedTaxels {
                    link: Some(sensor.link.clone()),
                    // The robot has these notes.
                    notes: Vec::new(),
                    ..PlacedTaxels::listed(LayoutFile::of_sensor(self.check.place, sensor)?)
                });
            }
            LayoutSpec::Grid(grid) => {
                let (nx, ny) = (grid.nx, grid.ny);
                Layout::grid(&Grid { nx, ny, pitch })
            }
            LayoutSpec::Hexagonal(rows) => Layout::hexagonal(rows.nx, rows.ny, pitch),
            LayoutSpec::Disc(disc) => Layout::disc(disc.radius_mm * MM, pitch),
            LayoutSpec::Annulus(ring) => {
                Layout::annulus(ring.inner_mm * MM, ring.outer_mm * MM, pitch)
            }
            LayoutSpec::Cylinder(cylinder) => {
                let (radius, length) = (cylinder.radius_mm * MM, cylinder.length_mm * MM);
                Layout::cylinder(radius, length, cylinder.arc_deg.to_radians(), pitch)
            }
            LayoutSpec::SphereCap(cap) => {
                let half_angle = cap.half_angle_deg.to_radians();
                Layout::sphere_cap(cap.radius_mm * MM, half_angle, pitch)
            }
            LayoutSpec::Draped(draped) => {
                let (layout, own) = self.draped(key, (spec, draped), seed)?;
                link = own;
                Ok(layout)
            }
        };
        Ok(PlacedTaxels {
            layout: self.under(key, layout)?,
            radii_mm: PerTaxel::Equal(0.5 * pitch_mm),
            link,
            notes: Vec::new(),
        })
    }

    /// Returns taxels on the surface of a mesh or of a robot's link, and the name of this link.
    fn draped(
        &self,
        key: &str,
        (spec, draped): (&PatchSpec, &DrapedSpec),
        seed: &Seed,
    ) -> Result<(Layout, Option<String>)> {
        self.check.rules(key, draped, DRAPED_RULES)?;
        let pitch = draped.pitch_mm * MM;
        let region_key = &format!("{key}.region");
        let region = draped.region.as_deref().cloned().unwrap_or_default();
        self.check.rules(region_key, &region, REGION_RULES)?;
        let link_key = &match draped.on {
            Some(_) => format!("{key}.on"),
            None => format!("{region_key}.link"),
        };
        let (mesh, link) = match (&draped.mesh, draped.on, &region.link) {
            (Some(path), None, None) => {
                let key = format!("{key}.mesh");
                (self.surface(&key, path, draped.unit)?, None)
            }
            (None, Some(_), None) | (None, None, Some(_)) => {
                let PlannedRobot { robot, meshes, .. } = self.robot_of_patch(link_key, spec)?;
                let own = || spec.link.as_deref();
                let link = region.link.as_deref().or_else(own);
                let link = link.unwrap_or(&robot.links()[robot.base()].name);
                let role = draped.on.or(region.shapes);
                let surface = LinkSurface { link, role };
                let mesh = self.under(link_key, link_surface(robot, meshes, &surface, pitch))?;
                (mesh, Some(link.to_owned()))
            }
            (mesh, ..) => {
                let given = match (mesh, &region.link) {
                    (None, None) => "neither mesh nor a link",
                    (Some(_), _) => "mesh and region.link",
                    (None, Some(_)) => "on and region.link",
                };
                let allowed = "mesh = \"FILE\", on = \"collision\" for the patch's own link, or region = { link = \"NAME\" }, a link of the patch's robot";
                return self.refuse(key, given, allowed);
            }
        };
        let region = self.region(region_key, &region, draped.mesh.as_deref())?;
        let layout = match &draped.grid {
            None => Layout::draped_on(&mesh, pitch, &region, seed),
            Some(_) if region != DrapeRegion::default() => {
                let allowed = "a grid alone: its taxels cover the surface below it";
                let given = "a part of the surface beside a grid";
                return self.refuse(region_key, given, allowed);
            }
            Some(grid) => {
                let (nx, ny) = (grid.nx, grid.ny);
                let flat = Grid { nx, ny, pitch };
                let missing = grid.missing.into();
                let projected = Layout::projected(&mesh, &grid.at.pose(), &flat, missing);
                projected.map(|projected| projected.layout)
            }
        };
        Ok((self.under(key, layout)?, link))
    }

    /// Reads a mesh over which taxels are draped, or whose normals are their axes.
    fn surface(&self, key: &str, path: &Path, unit: Option<LengthUnit>) -> Result<TriangleMesh> {
        self.read(key, path, |path| read_surface(path, unit, &SizeLimits::ANY))
    }

    fn layout_file(&self, key: &str, spec: &FileLayoutSpec) -> Result<LayoutFile> {
        let (path, parts) = match spec {
            FileLayoutSpec::Path(path) => (path, None),
            FileLayoutSpec::Parts(parts) => (&parts.path, Some(parts)),
        };
        let mesh = parts.and_then(|parts| Some((parts.mesh.as_ref()?, parts.unit)));
        let mesh = mesh.map(|(mesh, unit)| self.surface(&format!("{key}.mesh"), mesh, unit));
        let mesh = mesh.transpose()?;
        let options = LayoutOptions {
            mesh: mesh.as_ref(),
            unit: None,
            sensor: parts.and_then(|parts| parts.sensor.as_deref()),
        };
        self.read(key, path, |path| LayoutFile::read(path, options))
    }

    /// Returns the part of a surface on which taxels are placed. The surface is a mesh file, or a robot link if `mesh` is `None`.
    fn region(&self, key: &str, spec: &RegionSpec, mesh: Option<&Path>) -> Result<DrapeRegion> {
        let bounds = spec.box_min_mm.zip(spec.box_max_mm);
        let triangles = match (&spec.group, spec.triangles, mesh) {
            (Some(group), _, Some(mesh)) => {
                let key = &format!("{key}.group");
                if MeshFormat::from_path(mesh)? != MeshFormat::Obj {
                    let given = format!("`{group}` of {}", mesh.display());
                    return self.refuse(key, given, "a group of an OBJ file");
                }
                let (place, file) = self.open(key, mesh)?;
                Some(self.under(key, obj_group(&place, file, group))?)
            }
            (_, Some([first, last]), _) if first > last => {
                let given = "triangles that end before they begin";
                return self.refuse(key, given, "first and last");
            }
            (_, triangles, _) => triangles.map(|[first, last]| (first..=last).collect()),
        };
        Ok(DrapeRegion {
            bounds: bounds.map(|(min, max)| Aabb {
                min: metres(min),
                max: metres(max),
            }),
            beyond: spec.plane_normal.map(|normal| {
                let point = metres(spec.plane_point_mm.unwrap_or_default());
                (point, DVec3::from_array(normal))
            }),
            triangles,
        })
    }
}
