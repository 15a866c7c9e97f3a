//! Skin as it is written: `[[patches]]`.

use super::spec::{PoseSpec, hundred};
use crate::mesh::LengthUnit;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// `[[patches]]`: skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatchSpec {
    /// Its name in this scene.
    pub name: String,
    /// The robot that carries it; the world when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// The robot's link that carries it; its base when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Where it is on the link, or in the world.
    #[serde(default)]
    pub at: PoseSpec,
    /// Where its taxels are.
    pub layout: LayoutSpec,
    /// ρ; half the pitch when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taxel_radius_mm: Option<f64>,
    /// s.
    pub stroke_mm: f64,
    /// k.
    #[serde(default = "hundred")]
    pub stiffness_n_per_m: f64,
    /// c.
    #[serde(default)]
    pub damping_n_s_per_m: f64,
}

/// `layout = { grid = { nx = 64, ny = 64, pitch_mm = 2.0 } }`: see [`Layout`](crate::world::Layout).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LayoutSpec {
    /// A rectangle of square cells.
    Grid {
        /// Columns, along patch x.
        nx: usize,
        /// Rows, along patch y.
        ny: usize,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// A rectangle of staggered rows.
    Hexagonal {
        /// Taxels a row, along patch x.
        nx: usize,
        /// Rows, along patch y.
        ny: usize,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// Round.
    Disc {
        /// Of the disc.
        radius_mm: f64,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// A ring.
    Annulus {
        /// Inner radius.
        inner_mm: f64,
        /// Outer radius.
        outer_mm: f64,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// Around a forearm or finger.
    Cylinder {
        /// Of the cylinder.
        radius_mm: f64,
        /// Along its axis.
        length_mm: f64,
        /// How far around.
        arc_deg: f64,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// On a fingertip.
    SphereCap {
        /// Of the sphere.
        radius_mm: f64,
        /// From the pole to the rim.
        half_angle_deg: f64,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// Over a triangle mesh.
    Draped {
        /// Its file.
        mesh: PathBuf,
        /// Unit of the file's numbers; metres when left out.
        #[serde(default)]
        mesh_unit: LengthUnit,
        /// Between neighbours.
        pitch_mm: f64,
    },
}
