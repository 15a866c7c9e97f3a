//! What a recording is of: everything that does not change with time.

use super::npy::Element;
use crate::error::{Error, Result};
use crate::world::Grid;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// What is known of the force on a taxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceKind {
    /// One number: along the axis.
    Normal,
    /// Three numbers, patch frame.
    Vector,
}

impl ForceKind {
    /// Numbers a taxel.
    pub fn n_components(self) -> usize {
        match self {
            Self::Normal => 1,
            Self::Vector => 3,
        }
    }
}

/// A patch as a recording knows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedPatch {
    /// Unlike that of any other patch or object.
    pub name: String,
    /// Where the taxels rest, metres, patch frame; at least one.
    #[serde(rename = "n_taxels", serialize_with = "length", skip_deserializing)]
    pub centers: Vec<DVec3>,
    /// Unit vectors away from the substrate, one a taxel.
    #[serde(skip)]
    pub axes: Vec<DVec3>,
    /// The grid, where the taxels are one: taxel = row · nx + column.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
    /// What is recorded of the forces.
    pub force: ForceKind,
}

impl RecordedPatch {
    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        self.centers.len()
    }

    /// A patch whose taxels are a grid in the plane z = 0, axes along +z.
    pub fn of_grid(name: impl Into<String>, grid: Grid, force: ForceKind) -> Self {
        let centers = (0..grid.n_taxels())
            .map(|taxel| DVec3::new(grid.x(taxel % grid.nx), grid.y(taxel / grid.nx), 0.0))
            .collect();
        Self {
            name: name.into(),
            centers,
            axes: vec![DVec3::Z; grid.n_taxels()],
            grid: Some(grid),
            force,
        }
    }

    fn check(&self) -> Result<()> {
        let place = || format!("recording, patch {}", self.name);
        let (n_centers, n_axes) = (self.centers.len(), self.axes.len());
        if n_centers == 0 || n_centers != n_axes {
            return Err(Error::input(
                place(),
                format!("{n_centers} centres and {n_axes} axes"),
                "at least one taxel, each with a centre and an axis",
            ));
        }
        if let Some(grid) = &self.grid {
            grid.check()?;
            if grid.n_taxels() != n_centers {
                return Err(Error::input(
                    place(),
                    format!("{n_centers} taxels on a grid of {} × {}", grid.nx, grid.ny),
                    "as many taxels as the grid has",
                ));
            }
        }
        let broken = |vector: &&DVec3| !vector.is_finite();
        match self.centers.iter().chain(&self.axes).find(broken) {
            Some(vector) => Err(Error::input(place(), vector, "finite centres and axes")),
            None => Ok(()),
        }
    }
}

/// What a recording is of.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct RecordingHeader {
    /// The skin.
    pub patches: Vec<RecordedPatch>,
    /// Names of the objects whose poses are recorded.
    pub objects: Vec<String>,
    /// What else is to be known of it (seed, step, scene …), any JSON.
    #[serde(default)]
    pub about: serde_json::Value,
}

/// A member that has one row a frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stream {
    pub name: String,
    pub element: Element,
    /// Shape of one row.
    pub row: Vec<usize>,
}

impl Stream {
    fn new(name: impl Into<String>, element: Element, row: &[usize]) -> Self {
        Self {
            name: name.into(),
            element,
            row: row.to_vec(),
        }
    }

    pub fn row_bytes(&self) -> usize {
        self.row.iter().product::<usize>() * self.element.n_bytes()
    }

    /// The array of so many rows.
    pub fn shape(&self, n_frames: usize) -> Vec<usize> {
        [&[n_frames], &self.row[..]].concat()
    }
}

impl RecordingHeader {
    /// The error names a patch that makes no sense, or a name that cannot be a member's.
    pub fn check(&self) -> Result<()> {
        self.patches.iter().try_for_each(RecordedPatch::check)?;
        let mut seen = HashSet::new();
        let patches = self.patches.iter().map(|patch| &patch.name);
        for name in patches.chain(&self.objects) {
            let is_plain = |c: char| !matches!(c, '/' | '\\' | ':') && !c.is_control();
            let is_good = !name.is_empty() && !name.starts_with('.') && name.chars().all(is_plain);
            if !is_good {
                return Err(Error::input(
                    "recording",
                    format!("the name {name:?}"),
                    "a name without slashes, colons and control characters that does not start with a full stop",
                ));
            }
            if !seen.insert(name) {
                return Err(Error::input(
                    "recording",
                    format!("two patches or objects called {name}"),
                    "names that differ",
                ));
            }
        }
        Ok(())
    }

    /// Members with one row a frame: time, then deflection, force and pose of each patch, then each object's pose.
    pub(super) fn streams(&self) -> Vec<Stream> {
        let element = Element::Single;
        let mut streams = vec![Stream::new("time", Element::Double, &[])];
        for patch in &self.patches {
            let (name, n) = (&patch.name, patch.n_taxels());
            let force = match patch.force {
                ForceKind::Normal => vec![n],
                ForceKind::Vector => vec![n, 3],
            };
            streams.push(Stream::new(format!("{name}/deflection"), element, &[n]));
            streams.push(Stream::new(format!("{name}/force"), element, &force));
            streams.push(Stream::new(format!("{name}/pose"), Element::Double, &[7]));
        }
        let poses = self.objects.iter();
        streams
            .extend(poses.map(|name| Stream::new(format!("{name}/pose"), Element::Double, &[7])));
        streams
    }

    /// The text of `meta`.
    pub(super) fn meta(&self) -> String {
        let meta = Meta {
            format: FORMAT.to_owned(),
            version: VERSION,
            header: self,
        };
        serde_json::to_string(&meta).expect("strings and numbers make JSON")
    }

    /// The header that `meta` tells of, still without centres and axes; the error says what is wrong with it.
    pub(super) fn of_meta(text: &str) -> std::result::Result<Self, String> {
        let meta: Meta<Self> = serde_json::from_str(text).map_err(|e| e.to_string())?;
        match (&meta.format[..], meta.version) {
            (FORMAT, VERSION) => Ok(meta.header),
            (format, version) => Err(format!("{format} of version {version}")),
        }
    }
}

const FORMAT: &str = "bubbletouch recording";
const VERSION: u32 = 1;

#[derive(Serialize, Deserialize)]
struct Meta<H> {
    format: String,
    version: u32,
    #[serde(flatten)]
    header: H,
}

/// Places stand in members of their own.
fn length<S: serde::Serializer>(
    places: &[DVec3],
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    places.len().serialize(serializer)
}
