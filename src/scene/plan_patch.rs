//! Skin of a scene: layouts and taxels, and what carries them.

use super::mount::Mount;
use super::plan_robot::PlannedRobot;
use super::plan_signal::PlannedSignal;
use super::reader::{MM, Reader};
use super::spec::{LayoutSpec, ObjectSpec, PatchSpec};
use crate::error::Result;
use crate::mesh::SizeLimits;
use crate::random::Seed;
use crate::study::{positive, read_mesh};
use crate::world::{Grid, Layout, Patch, Shears};

/// A patch and where it is mounted.
#[derive(Clone, Debug)]
pub struct PlannedPatch {
    /// The patch.
    pub skin: Patch,
    /// What carries it.
    pub mount: Mount,
    /// The shear springs of its taxels, if it has friction.
    pub shears: Option<Shears>,
    /// Its signal, if it has any steps.
    pub signal: Option<PlannedSignal>,
}

impl PlannedPatch {
    /// Whether what was before decides what it feels: dampers and friction remember.
    pub fn remembers(&self) -> bool {
        let mut taxels = self.skin.taxels().all().iter();
        self.shears.is_some() || taxels.any(|taxel| taxel.damping > 0.0)
    }

    /// Whether objects can drag it sideways.
    pub fn has_friction(&self) -> bool {
        let shears = self.shears.iter().flat_map(|shears| shears.all());
        shears.into_iter().any(|shear| shear.friction > 0.0)
    }
}

impl LayoutSpec {
    /// Between neighbours, mm.
    pub fn pitch_mm(&self) -> f64 {
        match *self {
            Self::Grid { pitch_mm, .. }
            | Self::Hexagonal { pitch_mm, .. }
            | Self::Disc { pitch_mm, .. }
            | Self::Annulus { pitch_mm, .. }
            | Self::Cylinder { pitch_mm, .. }
            | Self::SphereCap { pitch_mm, .. }
            | Self::Draped { pitch_mm, .. } => pitch_mm,
        }
    }
}

impl Reader<'_> {
    pub fn patch(
        &self,
        spec: &mut PatchSpec,
        (robots, objects): (&[PlannedRobot], &[ObjectSpec]),
        seed: &Seed,
    ) -> Result<PlannedPatch> {
        let key = &format!("patches.{}", spec.name);
        let pitch_key = format!("{key}.layout.pitch_mm");
        let pitch_mm = spec.layout.pitch_mm();
        self.check
            .value(&pitch_key, pitch_mm, positive, "a positive number")?;
        let layout_key = &format!("{key}.layout");
        let layout = self.layout(layout_key, &spec.layout, &seed.named(&spec.name))?;
        let (taxels, shears) = self.taxels(key, spec, layout.n_taxels())?;
        let skin = self.under(key, Patch::new(&spec.name, layout, taxels))?;
        if let Some(shears) = &shears {
            self.under(key, shears.check_on(&skin))?;
        }
        Ok(PlannedPatch {
            signal: self.signal(key, &spec.signal, &skin, seed)?,
            skin,
            mount: self.mount_of_patch(key, spec, robots, objects)?,
            shears,
        })
    }

    fn layout(&self, key: &str, spec: &LayoutSpec, seed: &Seed) -> Result<Layout> {
        let pitch = spec.pitch_mm() * MM;
        let layout = match *spec {
            LayoutSpec::Grid { nx, ny, .. } => Layout::grid(&Grid { nx, ny, pitch }),
            LayoutSpec::Hexagonal { nx, ny, .. } => Layout::hexagonal(nx, ny, pitch),
            LayoutSpec::Disc { radius_mm, .. } => Layout::disc(radius_mm * MM, pitch),
            LayoutSpec::Annulus {
                inner_mm, outer_mm, ..
            } => Layout::annulus(inner_mm * MM, outer_mm * MM, pitch),
            LayoutSpec::Cylinder {
                radius_mm,
                length_mm,
                arc_deg,
                ..
            } => Layout::cylinder(radius_mm * MM, length_mm * MM, arc_deg.to_radians(), pitch),
            LayoutSpec::SphereCap {
                radius_mm,
                half_angle_deg,
                ..
            } => Layout::sphere_cap(radius_mm * MM, half_angle_deg.to_radians(), pitch),
            LayoutSpec::Draped { ref mesh, unit, .. } => {
                let (place, _) = self.open(&format!("{key}.mesh"), mesh)?;
                let read = read_mesh(&self.path(mesh), unit, &SizeLimits::ANY, None);
                let outward = read.and_then(|(mesh, orientation)| {
                    orientation.require(&place)?;
                    Ok(mesh)
                });
                Layout::draped(&self.under(key, outward)?, pitch, seed)
            }
        };
        self.under(key, layout)
    }
}
