//! What a recording is of: everything that does not change with time.

use crate::error::{Error, Result};
use crate::signal::Quantity;
use crate::world::Grid;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use serde_json::Value;
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

/// A patch as a recording knows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedPatch {
    /// Unlike that of any other patch or object.
    pub name: String,
    /// Where the taxels rest, metres, patch frame; at least one.
    #[serde(skip)]
    pub centers: Vec<DVec3>,
    /// Unit vectors away from the substrate, one a taxel.
    #[serde(skip)]
    pub axes: Vec<DVec3>,
    /// The grid, where the taxels are one: taxel = row · nx + column.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
    /// What is recorded of the forces.
    pub force: ForceKind,
    /// What its signal is in, of a patch that has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signal: Option<Quantity>,
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
            signal: None,
        }
    }

    fn check(&self) -> Result<()> {
        let refuse = |given: String, allowed: &str| {
            let place = format!("recording, patch {}", self.name);
            Err(Error::input(place, given, allowed))
        };
        let (n_centers, n_axes) = (self.centers.len(), self.axes.len());
        if n_centers == 0 || n_centers != n_axes {
            let given = format!("{n_centers} centres and {n_axes} axes");
            return refuse(given, "at least one taxel, each with a centre and an axis");
        }
        if let Some(grid) = &self.grid {
            grid.check()?;
            if grid.n_taxels() != n_centers {
                let given = format!("{n_centers} taxels on a grid of {} × {}", grid.nx, grid.ny);
                return refuse(given, "as many taxels as the grid has");
            }
        }
        let broken = |vector: &&DVec3| !vector.is_finite();
        match self.centers.iter().chain(&self.axes).find(broken) {
            Some(vector) => refuse(vector.to_string(), "finite centres and axes"),
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
    pub about: Value,
}

/// Floats as NumPy names them, least significant byte first: `<f4`, `<f8`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Element {
    Single = 4,
    Double = 8,
}

/// A member of numbers, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Member {
    pub name: String,
    pub element: Element,
    /// Shape of one row.
    pub row: Vec<usize>,
}

impl Member {
    pub fn new(name: impl Into<String>, element: Element, row: &[usize]) -> Self {
        Self {
            name: name.into(),
            element,
            row: row.to_vec(),
        }
    }

    pub fn descr(&self) -> String {
        format!("<f{}", self.element as usize)
    }

    /// Of one row.
    pub fn n_numbers(&self) -> usize {
        self.row.iter().product()
    }

    pub fn row_bytes(&self) -> usize {
        self.n_numbers() * self.element as usize
    }

    /// The array of so many rows.
    pub fn shape(&self, n_rows: usize) -> Vec<usize> {
        [&[n_rows], &self.row[..]].concat()
    }
}

impl RecordingHeader {
    /// Whether it can be that of a recording.
    ///
    /// # Errors
    /// A patch that makes no sense, or a name that cannot be a member's.
    pub fn check(&self) -> Result<()> {
        self.patches.iter().try_for_each(RecordedPatch::check)?;
        let refuse = |given: String, allowed: &str| Err(Error::input("recording", given, allowed));
        let mut seen = HashSet::new();
        let patches = self.patches.iter().map(|patch| &patch.name);
        for name in patches.chain(&self.objects) {
            let is_plain = |c: char| !matches!(c, '/' | '\\' | ':') && !c.is_control();
            let is_good = !name.is_empty() && !name.starts_with('.') && name.chars().all(is_plain);
            if !is_good {
                let allowed = "a name without slashes, colons and control characters that does not start with a full stop";
                return refuse(format!("the name {name:?}"), allowed);
            }
            if !seen.insert(name) {
                let given = format!("two patches or objects called {name}");
                return refuse(given, "names that differ");
            }
        }
        Ok(())
    }

    /// Members with one row a frame: time, then deflection, force, signal (where there is one) and pose of each patch, then each object's pose.
    pub(super) fn members(&self) -> Vec<Member> {
        use Element::{Double, Single};
        let pose = |name: &String| Member::new(format!("{name}/pose"), Double, &[7]);
        let mut members = vec![Member::new("time", Double, &[])];
        for patch in &self.patches {
            let (name, n) = (&patch.name, patch.n_taxels());
            let force = match patch.force {
                ForceKind::Normal => &[n][..],
                ForceKind::Vector => &[n, 3],
            };
            members.push(Member::new(format!("{name}/deflection"), Single, &[n]));
            members.push(Member::new(format!("{name}/force"), Single, force));
            let signal = patch.signal.map(|_| format!("{name}/signal"));
            members.extend(signal.map(|name| Member::new(name, Single, &[n])));
            members.push(pose(name));
        }
        members.extend(self.objects.iter().map(pose));
        members
    }

    /// The member with what a patch reported.
    pub(super) fn member(&self, patch: usize, quantity: Quantity) -> Member {
        let name = format!("{}/{}", self.patches[patch].name, quantity.name());
        let mut members = self.members().into_iter();
        let member = members.find(|member| member.name == name);
        member.expect("a patch has a member of each quantity")
    }

    /// The text of `meta`.
    pub(super) fn meta(&self) -> String {
        let mut meta = serde_json::to_value(self).expect("strings and numbers make JSON");
        for (number, patch) in self.patches.iter().enumerate() {
            meta["patches"][number]["n_taxels"] = patch.n_taxels().into();
        }
        meta["format"] = FORMAT.into();
        meta["version"] = VERSION.into();
        meta.to_string()
    }

    /// The header that `meta` tells of, still without centres and axes; the error says what is wrong with it.
    pub(super) fn of_meta(text: &str) -> std::result::Result<Self, String> {
        let meta: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
        let (format, version) = (&meta["format"], &meta["version"]);
        if *format != FORMAT || *version != VERSION {
            return Err(format!("{format} of version {version}"));
        }
        serde_json::from_value(meta).map_err(|e| e.to_string())
    }
}

const FORMAT: &str = "bubbletouch recording";
const VERSION: u32 = 1;
