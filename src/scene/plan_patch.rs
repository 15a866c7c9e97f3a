//! Patches of an executable scene: layouts, taxels and mounts.

use super::link_surface::{LinkSurface, link_surface};
use super::mount::Mount;
use super::plan_robot::PlannedRobot;
use super::plan_signal::PlannedSignal;
use super::reader::{MM, Reader};
use super::spec::{
    AnnulusSpec, CylinderSpec, DiscSpec, DrapedSpec, FileLayoutSpec, GridSpec, HexagonalSpec,
    LayoutSpec, ObjectSpec, PatchSpec, ProjectedGridSpec, RegionSpec, SphereCapSpec,
};
use crate::error::Result;
use crate::geometry::Aabb;
use crate::inputs::layout_file::{LayoutFile, LayoutOptions};
use crate::inputs::object_files::read_mesh;
use crate::inputs::range::positive;
use crate::mesh::{MeshFormat, SizeLimits, TriangleMesh, obj_group};
use crate::random::Seed;
use crate::world::{DrapeRegion, Grid, Layout, Patch, PerTaxel, Shears};
use std::path::Path;

/// Patch of a scene, checked and ready for simulation.
#[derive(Clone, Debug)]
pub struct PlannedPatch {
    /// Taxels and layout of the patch.
    pub skin: Patch,
    /// Body to which the patch is fixed.
    pub mount: Mount,
    /// Tangential springs of the taxels; `None` if the patch has no friction.
    pub shears: Option<Shears>,
    /// Signal chain of the patch (conversion of deflections to sensor readings); `None` if it has no steps.
    pub signal: Option<PlannedSignal>,
    /// Notes on the layout file of the patch; empty for other layouts.
    pub notes: Vec<String>,
}

impl PlannedPatch {
    /// Returns whether the state of the patch depends on earlier steps, as with dampers or friction.
    pub fn remembers(&self) -> bool {
        let mut taxels = self.skin.taxels().all().iter();
        self.shears.is_some() || taxels.any(|taxel| taxel.damping > 0.0)
    }

    /// Returns whether any taxel has a positive friction coefficient.
    pub fn has_friction(&self) -> bool {
        let shears = self.shears.iter().flat_map(|shears| shears.all());
        shears.into_iter().any(|shear| shear.friction > 0.0)
    }
}

impl LayoutSpec {
    /// Returns the distance between neighbouring taxels, mm; `None` for layouts that list single taxels.
    pub fn pitch_mm(&self) -> Option<f64> {
        Some(match *self {
            Self::File(_) | Self::Sensor(_) => return None,
            Self::Grid(GridSpec { pitch_mm, .. })
            | Self::Hexagonal(HexagonalSpec { pitch_mm, .. })
            | Self::Disc(DiscSpec { pitch_mm, .. })
            | Self::Annulus(AnnulusSpec { pitch_mm, .. })
            | Self::Cylinder(CylinderSpec { pitch_mm, .. })
            | Self::SphereCap(SphereCapSpec { pitch_mm, .. })
            | Self::Draped(DrapedSpec { pitch_mm, .. }) => pitch_mm,
        })
    }
}

impl Reader<'_> {
    /// Checks a patch of a scene file and returns its taxels, mount, friction and signal chain.
    pub fn patch(
        &self,
        spec: &mut PatchSpec,
        (robots, objects): (&[PlannedRobot], &[ObjectSpec]),
        seed: &Seed,
    ) -> Result<PlannedPatch> {
        let key = &format!("patches.{}", spec.name);
        let pitch_key = format!("{key}.layout.pitch_mm");
        if let Some(pitch_mm) = spec.layout.pitch_mm() {
            self.check
                .value(&pitch_key, pitch_mm, positive, "a positive number")?;
        }
        let layout_key = &format!("{key}.layout");
        self.drape_on_own_link(layout_key, spec, robots)?;
        let (layout, radii, notes) = match self.listed_taxels(layout_key, spec, robots)? {
            Some((file, radii)) => (file.layout, radii, file.notes),
            None => {
                let layout = self.layout(layout_key, spec, robots, &seed.named(&spec.name))?;
                let half_pitch = spec.layout.pitch_mm().map(|pitch_mm| 0.5 * pitch_mm);
                let radii = PerTaxel::Equal(half_pitch.unwrap_or_default());
                (layout, radii, Vec::new())
            }
        };
        self.mount_on_draped_link(layout_key, spec)?;
        let (taxels, shears) = self.taxels(key, spec, (layout.n_taxels(), radii))?;
        let skin = self.under(key, Patch::new(&spec.name, layout, taxels))?;
        if let Some(shears) = &shears {
            self.under(key, shears.check_on(&skin))?;
        }
        Ok(PlannedPatch {
            signal: self.signal(key, &spec.signal, &skin, seed)?,
            skin,
            mount: self.mount_of_patch(key, spec, robots, objects)?,
            shears,
            notes,
        })
    }

    fn layout(
        &self,
        key: &str,
        spec: &PatchSpec,
        robots: &[PlannedRobot],
        seed: &Seed,
    ) -> Result<Layout> {
        let pitch = spec.layout.pitch_mm().unwrap_or_default() * MM;
        let layout = match spec.layout {
            LayoutSpec::File(_) | LayoutSpec::Sensor(_) => unreachable!("taxels that are listed"),
            LayoutSpec::Grid(GridSpec { nx, ny, .. }) => Layout::grid(&Grid { nx, ny, pitch }),
            LayoutSpec::Hexagonal(HexagonalSpec { nx, ny, .. }) => Layout::hexagonal(nx, ny, pitch),
            LayoutSpec::Disc(DiscSpec { radius_mm, .. }) => Layout::disc(radius_mm * MM, pitch),
            LayoutSpec::Annulus(AnnulusSpec {
                inner_mm, outer_mm, ..
            }) => Layout::annulus(inner_mm * MM, outer_mm * MM, pitch),
            LayoutSpec::Cylinder(CylinderSpec {
                radius_mm,
                length_mm,
                arc_deg,
                ..
            }) => Layout::cylinder(radius_mm * MM, length_mm * MM, arc_deg.to_radians(), pitch),
            LayoutSpec::SphereCap(SphereCapSpec {
                radius_mm,
                half_angle_deg,
                ..
            }) => Layout::sphere_cap(radius_mm * MM, half_angle_deg.to_radians(), pitch),
            LayoutSpec::Draped(DrapedSpec {
                mesh: ref path,
                unit,
                ref region,
                ref grid,
                ..
            }) => {
                let region_key = &format!("{key}.region");
                let link = region.as_ref().and_then(|region| region.link.as_deref());
                let mesh = match (path, link) {
                    (Some(path), None) => {
                        let (place, _) = self.open(&format!("{key}.mesh"), path)?;
                        let read = read_mesh(&self.path(path), unit, &SizeLimits::ANY, None);
                        let outward = read.and_then(|(mesh, orientation)| {
                            orientation.require(&place)?;
                            Ok(mesh)
                        });
                        self.under(key, outward)?
                    }
                    (None, Some(link)) => {
                        let key = &format!("{region_key}.link");
                        if unit.is_some() {
                            let allowed = "no unit: the robot's file has metres and scales";
                            return Err(self.check.error(key, "a link beside unit", allowed));
                        }
                        let Some(name) = &spec.robot else {
                            let given = format!("`{link}` without a robot");
                            return Err(self.check.error(
                                key,
                                given,
                                "robot = \"NAME\" of the patch",
                            ));
                        };
                        let names = robots.iter().map(|robot| robot.name.as_str());
                        let robot =
                            self.known(&format!("patches.{}.robot", spec.name), name, names)?;
                        let role = region.as_ref().and_then(|region| region.shapes);
                        let surface = LinkSurface { link, role };
                        let PlannedRobot { robot, meshes, .. } = &robots[robot];
                        self.under(key, link_surface(robot, meshes, &surface, pitch))?
                    }
                    (both_or_neither, _) => {
                        let given = match both_or_neither {
                            Some(_) => "mesh and region.link",
                            None => "neither mesh nor a link",
                        };
                        let allowed = "mesh = \"FILE\", on = \"collision\" for the patch's own link, or region = { link = \"NAME\" }, a link of the patch's robot";
                        return Err(self.check.error(key, given, allowed));
                    }
                };
                let region = match region {
                    Some(region) => self.region(region_key, region, path.as_deref())?,
                    None => DrapeRegion::default(),
                };
                match grid {
                    Some(grid) => self.projected(key, (&mesh, &region), pitch, grid),
                    None => Layout::draped_on(&mesh, pitch, &region, seed),
                }
            }
        };
        self.under(key, layout)
    }

    /// Returns a flat grid of taxels that is wrapped around a surface.
    fn projected(
        &self,
        key: &str,
        (surface, region): (&TriangleMesh, &DrapeRegion),
        pitch: f64,
        spec: &ProjectedGridSpec,
    ) -> Result<Layout> {
        if *region != DrapeRegion::default() {
            let allowed = "a grid alone: its taxels cover the surface below it";
            return Err(self.check.error(
                &format!("{key}.region"),
                "a part of the surface beside a grid",
                allowed,
            ));
        }
        let at = self.pose(&format!("{key}.grid.at"), &spec.at)?;
        let (nx, ny) = (spec.nx, spec.ny);
        let projected =
            Layout::projected(surface, &at, &Grid { nx, ny, pitch }, spec.missing.into());
        projected.map(|projected| projected.layout)
    }

    /// Returns the taxels of a layout file or of a robot's tactile sensor, their radii in mm, and the notes on the file; `None` for other layouts. A patch with
    /// the taxels of a sensor is mounted on the link of the sensor.
    fn listed_taxels(
        &self,
        key: &str,
        spec: &mut PatchSpec,
        robots: &[PlannedRobot],
    ) -> Result<Option<(LayoutFile, PerTaxel<f64>)>> {
        let file = match &spec.layout {
            LayoutSpec::File(file) => self.layout_file(&format!("{key}.file"), file)?,
            LayoutSpec::Sensor(sensor) => {
                let key = &format!("{key}.sensor");
                let Some(name) = &spec.robot else {
                    let given = format!("`{sensor}` without a robot");
                    return Err(self
                        .check
                        .error(key, given, "robot = \"NAME\" of the patch"));
                };
                let names = robots.iter().map(|robot| robot.name.as_str());
                let robot = &robots[self.known(key, name, names)?].robot;
                let sensors = robot.tactile_sensors();
                let names = sensors.iter().map(|sensor| sensor.name.as_str());
                let sensor = &sensors[self.known(key, sensor, names)?];
                let link = spec.link.get_or_insert_with(|| sensor.link.clone());
                if *link != sensor.link {
                    let given = format!("a sensor of link `{}` on link `{link}`", sensor.link);
                    return Err(self.check.error(key, given, "the link of the sensor"));
                }
                LayoutFile {
                    // The robot has these notes.
                    notes: Vec::new(),
                    ..LayoutFile::of_sensor(self.check.place, sensor)?
                }
            }
            _ => return Ok(None),
        };
        let radii = match &file.radii {
            Some(radii) => PerTaxel::Each(radii.iter().map(|radius| radius / MM).collect()),
            None => PerTaxel::Equal(file.default_radius() / MM),
        };
        Ok(Some((file, radii)))
    }

    fn layout_file(&self, key: &str, spec: &FileLayoutSpec) -> Result<LayoutFile> {
        let (path, parts) = match spec {
            FileLayoutSpec::Path(path) => (path, None),
            FileLayoutSpec::Parts(parts) => (&parts.path, Some(parts)),
        };
        let mesh = parts.and_then(|parts| Some((parts.mesh.as_ref()?, parts.unit)));
        let mesh = mesh.map(|(mesh, unit)| -> Result<_> {
            let (place, _) = self.open(&format!("{key}.mesh"), mesh)?;
            let (mesh, orientation) = self.under(
                key,
                read_mesh(&self.path(mesh), unit, &SizeLimits::ANY, None),
            )?;
            self.under(key, orientation.require(&place))?;
            Ok(mesh)
        });
        let mesh = mesh.transpose()?;
        let options = LayoutOptions {
            mesh: mesh.as_ref(),
            unit: None,
            sensor: parts.and_then(|parts| parts.sensor.as_deref()),
        };
        self.under(key, LayoutFile::read(&self.path(path), options))
    }

    /// Replaces `on`, the shapes of the patch's own link, by the region of this link.
    fn drape_on_own_link(
        &self,
        key: &str,
        spec: &mut PatchSpec,
        robots: &[PlannedRobot],
    ) -> Result<()> {
        let LayoutSpec::Draped(DrapedSpec {
            mesh, on, region, ..
        }) = &mut spec.layout
        else {
            return Ok(());
        };
        let Some(role) = on.take() else {
            return Ok(());
        };
        let key = &format!("{key}.on");
        let region = region.get_or_insert_default();
        if mesh.is_some() || region.link.is_some() || region.shapes.is_some() {
            let given = "beside mesh, region.link or region.shapes";
            return Err(self
                .check
                .error(key, given, "one surface: on = \"collision\" alone"));
        }
        let Some(name) = &spec.robot else {
            let allowed = "robot = \"NAME\" of the patch";
            return Err(self.check.error(key, "a patch without a robot", allowed));
        };
        let names = robots.iter().map(|robot| robot.name.as_str());
        let robot = &robots[self.known(key, name, names)?].robot;
        let base = || robot.links()[robot.base()].name.clone();
        region.link = Some(spec.link.clone().unwrap_or_else(base));
        region.shapes = Some(role);
        Ok(())
    }

    /// Mounts a patch whose taxels are draped over a robot link on this link.
    fn mount_on_draped_link(&self, key: &str, spec: &mut PatchSpec) -> Result<()> {
        let LayoutSpec::Draped(DrapedSpec { region, .. }) = &spec.layout else {
            return Ok(());
        };
        let Some(draped) = region.as_ref().and_then(|region| region.link.as_ref()) else {
            return Ok(());
        };
        let carrier = spec.link.get_or_insert_with(|| draped.clone());
        match carrier == draped {
            true => Ok(()),
            false => {
                let given = format!("`{draped}` of a patch that link `{carrier}` carries");
                let allowed = "one link: the link that skin is draped over carries the patch";
                Err(self
                    .check
                    .error(&format!("{key}.region.link"), given, allowed))
            }
        }
    }

    /// Returns the part of a surface on which taxels are placed. The surface is a mesh file, or a robot link if `mesh` is `None`.
    fn region(&self, key: &str, spec: &RegionSpec, mesh: Option<&Path>) -> Result<DrapeRegion> {
        let refuse = |given: &str, allowed: &str| Err(self.check.error(key, given, allowed));
        if spec.shapes.is_some() && spec.link.is_none() {
            return refuse("shapes alone", "link beside them");
        }
        if mesh.is_none() && (spec.group.is_some() || spec.triangles.is_some()) {
            let allowed = "a box or a plane: groups and triangles are of a mesh file";
            return refuse("group or triangles beside link", allowed);
        }
        let mesh = mesh.unwrap_or(Path::new(""));
        let vector = |name: &str, numbers| self.vector(&format!("{key}.{name}"), numbers, MM);
        let bounds = match (spec.box_min_mm, spec.box_max_mm) {
            (Some(min), Some(max)) => Some(Aabb {
                min: vector("box_min_mm", min)?,
                max: vector("box_max_mm", max)?,
            }),
            (None, None) => None,
            _ => return refuse("one corner of a box", "box_min_mm and box_max_mm"),
        };
        let beyond = match (spec.plane_normal, spec.plane_point_mm) {
            (Some(normal), point) => Some((
                vector("plane_point_mm", point.unwrap_or_default())?,
                self.vector(&format!("{key}.plane_normal"), normal, 1.0)?,
            )),
            (None, None) => None,
            (None, Some(_)) => return refuse("plane_point_mm alone", "plane_normal beside it"),
        };
        let triangles = match (&spec.group, spec.triangles) {
            (Some(_), Some(_)) => return refuse("group and triangles", "one of them"),
            (Some(group), None) => {
                let key = &format!("{key}.group");
                if MeshFormat::from_path(mesh)? != MeshFormat::Obj {
                    let given = format!("`{group}` of {}", mesh.display());
                    return Err(self.check.error(key, given, "a group of an OBJ file"));
                }
                let (place, file) = self.open(key, mesh)?;
                Some(self.under(key, obj_group(&place, file, group))?)
            }
            (None, Some([first, last])) if first <= last => Some((first..=last).collect()),
            (None, Some(_)) => {
                return refuse("triangles that end before they begin", "first and last");
            }
            (None, None) => None,
        };
        Ok(DrapeRegion {
            bounds,
            beyond,
            triangles,
        })
    }
}
