//! What touches what: the checks of `[objects]`, `[skin]` and `[touches]`.

use super::axis::Axis;
use super::check::{Check, not_negative, positive};
use super::plan::{MM, millimetres};
use super::spec::{ModelSpec, ObjectsSpec, RangeSpec, RestSpec, SkinSpec, SpreadSpec, TouchesSpec};
use crate::error::Result;
use crate::mesh::SizeLimits;
use crate::world::{Grid, MOST_TOUCHES, Patch, Placement, RestPoses, Spread, Taxel};

/// How far spheres may be from a solid's surface, unless a study says: mm.
const SURFACE_ERROR_MM: f64 = 0.25;

impl ModelSpec {
    /// How far spheres may be from the surface when nobody says, mm: 0.25, or of a packed mesh a tenth of the pitch (mm).
    pub fn default_surface_error_mm(self, pitch_mm: f64) -> f64 {
        match self {
            Self::Packed => 0.1 * pitch_mm,
            Self::VertexSpheres | Self::Mesh => SURFACE_ERROR_MM,
        }
    }
}

impl ObjectsSpec {
    /// Says how far spheres may be from surfaces, where the study leaves it to the arrays.
    pub(crate) fn settle_surface_error(&mut self, arrays: &[Patch]) {
        let pitches = arrays.iter().map(|patch| patch.grid.pitch / MM);
        let finest = pitches.fold(f64::INFINITY, f64::min);
        let model = self.model.unwrap_or_default();
        let default = || model.default_surface_error_mm(finest);
        self.surface_error_mm = Some(self.surface_error_mm.unwrap_or_else(default));
        self.settle_sizes(arrays);
    }

    /// Says how large objects may be whose files have no unit.
    pub(crate) fn settle_sizes(&mut self, arrays: &[Patch]) {
        let feels = |patch: &Patch| {
            let n = patch.grid.nx.max(patch.grid.ny);
            (n as f64 * patch.grid.pitch, patch.taxel.radius)
        };
        self.sizes = Some(SizeLimits::of_arrays(arrays.iter().map(feels)));
    }

    /// How large objects may be whose files have no unit.
    pub(super) fn sizes(&self) -> SizeLimits {
        self.sizes.unwrap_or(SizeLimits::ANY)
    }

    /// The widest holes that are closed, metres.
    pub(super) fn close_holes(&self) -> Option<f64> {
        self.close_holes_mm.map(|width| width * MM)
    }

    /// How far spheres may be from a surface, metres.
    pub(super) fn surface_error(&self) -> f64 {
        self.surface_error_mm.unwrap_or(SURFACE_ERROR_MM) * MM
    }
}

fn axis_length<T: Clone>(axis: &Option<Axis<T>>) -> usize {
    axis.as_ref().map_or(0, |axis| axis.values().len())
}

impl Check<'_> {
    pub fn objects(&self, objects: &ObjectsSpec) -> Result<()> {
        if objects.sets.is_empty() && objects.meshes.is_none() {
            return Err(self.error(
                "objects",
                "neither sets nor meshes",
                "sets = [...] or meshes = \"FOLDER\" (or --objects FOLDER)",
            ));
        }
        if let Some(error) = objects.surface_error_mm {
            let allowed = "a positive number of millimetres";
            self.value("objects.surface_error_mm", error, positive, allowed)?;
        }
        if objects.meshes.is_none() && (objects.model.is_some() || objects.unit.is_some()) {
            return Err(self.error(
                "objects",
                "model or unit without meshes",
                "them only beside meshes = \"FOLDER\": solids are spheres within surface_error_mm",
            ));
        }
        if let Some(width) = objects.close_holes_mm {
            let allowed = "a positive number of millimetres";
            self.value("objects.close_holes_mm", width, positive, allowed)?;
            if objects.meshes.is_none() {
                return Err(self.error(
                    "objects.close_holes_mm",
                    "no meshes",
                    "it only beside meshes = \"FOLDER\"",
                ));
            }
        }
        if objects.names.as_ref().is_some_and(Vec::is_empty) {
            return Err(self.error(
                "objects.names",
                "an empty list",
                "names of objects, or no such key for all",
            ));
        }
        Ok(())
    }

    pub fn arrays(&self, skin: &SkinSpec) -> Result<Vec<Patch>> {
        let pitches = self.axis(
            "skin.pitch_mm",
            &skin.pitch_mm,
            positive,
            "a positive number of millimetres",
        )?;
        // Two that tables show alike would be taken for one.
        let shown = pitches.iter().map(|&mm| millimetres(mm * MM)).collect();
        self.list("skin.pitch_mm", shown)?;
        let positive_key = |key, value| self.value(key, value, positive, "a positive number");
        let stroke = positive_key("skin.stroke_mm", skin.stroke_mm)? * MM;
        let stiffness = positive_key("skin.stiffness_n_per_m", skin.stiffness_n_per_m)?;
        let damping = self.value(
            "skin.damping_n_s_per_m",
            skin.damping_n_s_per_m,
            not_negative,
            "zero or a positive number",
        )?;
        let sizes = [axis_length(&skin.size_mm), axis_length(&skin.taxels)];
        let n_sizes = sizes.into_iter().max().unwrap_or(1);
        self.configurations(pitches.len() as f64 * n_sizes as f64)?;
        let mut arrays = Vec::new();
        for &pitch_mm in &pitches {
            let radius_mm = skin.taxel_radius_mm.unwrap_or(0.5 * pitch_mm);
            let radius = positive_key("skin.taxel_radius_mm", radius_mm)? * MM;
            for n in self.taxels_a_side(skin, pitch_mm)? {
                let grid = Grid {
                    nx: n,
                    ny: n,
                    pitch: pitch_mm * MM,
                };
                let taxel = Taxel {
                    radius,
                    stiffness,
                    damping,
                    stroke,
                };
                arrays.push(Patch::new(grid, taxel)?);
            }
        }
        Ok(arrays)
    }

    /// Approach speed at the moment of reading, m/s.
    pub fn speed(&self, touches: &TouchesSpec) -> Result<f64> {
        let speed = self.value(
            "touches.speed_mm_per_s",
            touches.speed_mm_per_s,
            not_negative,
            "zero or a positive number",
        )?;
        Ok(speed * MM)
    }

    /// The array of a study that has no axis of arrays; `allowed` says so.
    pub fn one_array(&self, skin: &SkinSpec, allowed: &str) -> Result<Patch> {
        let arrays = self.arrays(skin)?;
        match arrays[..] {
            [patch] => Ok(patch),
            _ => Err(self.error("skin", format!("{} arrays", arrays.len()), allowed)),
        }
    }

    fn taxels_a_side(&self, skin: &SkinSpec, pitch_mm: f64) -> Result<Vec<usize>> {
        match (&skin.size_mm, &skin.taxels) {
            (Some(sizes), None) => self
                .axis(
                    "skin.size_mm",
                    sizes,
                    positive,
                    "a positive number of millimetres",
                )?
                .iter()
                .map(|&size_mm| self.whole_pitches(size_mm, pitch_mm))
                .collect(),
            (None, Some(counts)) => {
                let counts = self.list("skin.taxels", counts.values())?;
                for &count in &counts {
                    self.array_side("skin.taxels", count)?;
                }
                Ok(counts)
            }
            (given, _) => Err(self.error(
                "skin",
                if given.is_some() {
                    "both size_mm and taxels"
                } else {
                    "neither size_mm nor taxels"
                },
                "one of them",
            )),
        }
    }

    fn whole_pitches(&self, size_mm: f64, pitch_mm: f64) -> Result<usize> {
        let n = (size_mm / pitch_mm).round();
        if n < 1.0 || (n * pitch_mm - size_mm).abs() > 1e-6 * pitch_mm {
            return Err(self.error(
                "skin.size_mm",
                format!("{size_mm} mm at a pitch of {pitch_mm} mm"),
                "a whole number of pitches",
            ));
        }
        self.array_side("skin.size_mm", n as usize)
    }

    fn array_side(&self, key: &str, n: usize) -> Result<usize> {
        const MOST: usize = 4096;
        if (1..=MOST).contains(&n) {
            return Ok(n);
        }
        Err(self.error(
            key,
            format!("{n} taxels along a side"),
            format!("1 to {MOST}"),
        ))
    }

    pub fn placement(&self, touches: &TouchesSpec) -> Result<Placement> {
        let degree = std::f64::consts::PI / 180.0;
        let any =
            |key, spread, unit| self.spread(key, spread, unit, f64::is_finite, "finite numbers");
        let depth = self.spread(
            "touches.depth_mm",
            &touches.depth_mm,
            MM,
            positive,
            "positive numbers of millimetres",
        )?;
        if let Some(count) = touches.per_object {
            self.count("touches.per_object", count, MOST_TOUCHES)?;
        }
        Ok(Placement {
            rest: match touches.rest {
                RestSpec::AsModelled => RestPoses::AsModelled,
                RestSpec::Stable => RestPoses::Stable,
            },
            offset_x: any("touches.offset_x_mm", &touches.offset_x_mm, MM)?,
            offset_y: any("touches.offset_y_mm", &touches.offset_y_mm, MM)?,
            yaw: any("touches.yaw_deg", &touches.yaw_deg, degree)?,
            tilt_x: any("touches.tilt_x_deg", &touches.tilt_x_deg, degree)?,
            tilt_y: any("touches.tilt_y_deg", &touches.tilt_y_deg, degree)?,
            depth,
            per_object: touches.per_object,
        })
    }

    fn spread(
        &self,
        key: &str,
        spread: &SpreadSpec,
        unit: f64,
        is_allowed: fn(f64) -> bool,
        allowed: &str,
    ) -> Result<Spread> {
        let values = match *spread {
            SpreadSpec::Range(RangeSpec::Uniform(low, high)) => {
                self.value(key, low, is_allowed, allowed)?;
                self.value(key, high, is_allowed, allowed)?;
                if low >= high {
                    return Err(self.error(
                        key,
                        format!("uniform from {low} to {high}"),
                        "low below high",
                    ));
                }
                return Ok(Spread::Uniform {
                    low: low * unit,
                    high: high * unit,
                });
            }
            SpreadSpec::Range(RangeSpec::Grid(first, last, count)) => {
                self.positive_count(key, count)?;
                self.axis_length(key, count)?;
                let step = if count > 1 {
                    (last - first) / (count - 1) as f64
                } else {
                    0.0
                };
                (0..count).map(|k| first + k as f64 * step).collect()
            }
            SpreadSpec::List(ref values) => values.clone(),
            SpreadSpec::One(value) => vec![value],
        };
        for &value in &values {
            self.value(key, value, is_allowed, allowed)?;
        }
        let values = self.list(key, values)?;
        Ok(Spread::Values(values.iter().map(|v| v * unit).collect()))
    }
}
