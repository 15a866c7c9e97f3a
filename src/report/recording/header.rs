//! Header of a recording, which contains all data that do not change over time.

use crate::error::{Error, Result};
use crate::signal::Quantity;
use crate::world::Grid;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::HashSet;

/// Kind of the recorded forces: one number or one vector per taxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceKind {
    /// Force along the taxel's axis, one number per taxel.
    Normal,
    /// Force vector in the patch frame, three numbers per taxel.
    Vector,
}

/// Description of a patch in a recording: its name, its taxels, and the kinds of recorded data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedPatch {
    /// Name of the patch, unique among patches and objects.
    pub name: String,
    /// Rest centres of the taxels in the patch frame, metres; at least one.
    #[serde(skip)]
    pub centers: Vec<DVec3>,
    /// Unit axis vector of each taxel, pointing away from the substrate.
    #[serde(skip)]
    pub axes: Vec<DVec3>,
    /// Grid of the taxels (taxel = row · nx + column); `None` for other layouts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
    /// Kind of the recorded forces: one number or one vector per taxel.
    pub force: ForceKind,
    /// Physical quantity of the sensor signal; `None` if the patch has no signal chain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signal: Option<Quantity>,
}

impl RecordedPatch {
    /// Returns the number of taxels of the patch.
    pub fn n_taxels(&self) -> usize {
        self.centers.len()
    }

    /// Creates a patch without taxels, to be filled.
    pub(crate) fn empty(name: &str, force: ForceKind) -> Self {
        Self {
            name: name.to_owned(),
            centers: Vec::new(),
            axes: Vec::new(),
            grid: None,
            force,
            signal: None,
        }
    }

    /// Creates a patch whose taxels form a grid in the plane z = 0 and have axes along +z.
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

/// Header of a recording: patches, objects and metadata.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct RecordingHeader {
    /// Patches of skin whose readings are recorded.
    pub patches: Vec<RecordedPatch>,
    /// Names of the objects whose poses are recorded.
    pub objects: Vec<String>,
    /// Additional metadata as JSON, for example the seed, the time step and the scene.
    #[serde(default)]
    pub about: Value,
}

/// Floating-point type of recorded arrays, little-endian: `<f4` or `<f8` in NumPy's notation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Element {
    Single = 4,
    Double = 8,
}

/// Numeric array in a recording (a zip file), with one row per frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Member {
    pub name: String,
    pub element: Element,
    /// Shape of one row of the array, without the dimension of the frames.
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

    /// Returns NumPy's name of the element type: `<f4` or `<f8`.
    pub fn descr(&self) -> String {
        format!("<f{}", self.element as usize)
    }

    /// Returns the number of elements in one row of the array.
    pub fn n_numbers(&self) -> usize {
        self.row.iter().product()
    }

    /// Returns the size of one row of the array in bytes.
    pub fn row_bytes(&self) -> usize {
        self.n_numbers() * self.element as usize
    }

    /// Returns the shape of the complete array for `n_rows` rows.
    pub fn shape(&self, n_rows: usize) -> Vec<usize> {
        [&[n_rows], &self.row[..]].concat()
    }
}

impl RecordingHeader {
    /// Checks that a recording with this header can be written.
    ///
    /// # Errors
    /// If a patch is invalid, or if a name occurs twice or cannot be the name of an archive member.
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

    /// Returns the arrays of the recording that have one row per frame. The arrays contain the time, the deflection, force, signal (if any) and pose of each
    /// patch, and the pose of each object.
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

    /// Returns the array that contains the given quantity of a patch in all frames.
    pub(super) fn member(&self, patch: usize, quantity: Quantity) -> Member {
        let name = format!("{}/{}", self.patches[patch].name, quantity.name());
        let mut members = self.members().into_iter();
        let member = members.find(|member| member.name == name);
        member.expect("a patch has a member of each quantity")
    }

    /// Returns the header as JSON text, which is stored as the archive member `meta`.
    pub(super) fn meta(&self) -> String {
        let mut meta = serde_json::to_value(self).expect("strings and numbers make JSON");
        for (number, patch) in self.patches.iter().enumerate() {
            meta["patches"][number]["n_taxels"] = patch.n_taxels().into();
        }
        meta["format"] = FORMAT.into();
        meta["version"] = VERSION.into();
        meta.to_string()
    }

    /// Parses the JSON text of the archive member `meta`. The resulting header has no taxel centres and axes yet. An error describes the defect.
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
