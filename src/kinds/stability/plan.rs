//! A study of stability that can run: every key checked, its cells laid out.

use super::rows::StabilityCell;
use super::spec::{ContactMethod, StabilityPartSpec, StabilityScene, StabilityStudySpec};
use crate::error::Result;
use crate::study::MM;
use crate::study::check::{COUNT, Check, Range};
use crate::study::sweep::nested;
use std::path::{Path, PathBuf};

/// Settings of a study of stability, ready to run.
#[derive(Clone, Debug)]
pub struct StabilityPlan {
    /// As it was written.
    pub spec: StabilityStudySpec,
    /// Between neighbouring taxels, metres.
    pub pitch: f64,
    /// What is tried, in this order.
    pub parts: Vec<StabilityPart>,
    /// Where the rows of other programs are.
    pub peers: Option<PathBuf>,
}

/// Cells that share what no axis says.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityPart {
    /// s, metres.
    pub stroke: f64,
    /// What is simulated; methods that this build does not have are left out.
    pub cells: Vec<StabilityCell>,
}

/// Taxels a side, at most: a million and more of bodies is no question of stability.
const MOST_TAXELS: usize = 256;

/// What the numbers of a part may be.
const KEYS: [(&str, Range); 9] = [
    ("methods", Range::Any),
    ("taxels", COUNT),
    ("stroke_mm", Range::Positive),
    ("stiffness_n_per_m", Range::Positive),
    ("taxel_mass_kg", Range::Positive),
    ("object_mass_kg", Range::Positive),
    ("object_mass_per_taxel_kg", Range::Positive),
    ("dt_s", Range::Positive),
    ("solver_iterations", COUNT),
];

impl StabilityPlan {
    /// Checks a study that lies in `folder`; the error names `place` (the file) and the first key that is out of its range.
    pub fn new(place: &str, folder: &Path, spec: StabilityStudySpec) -> Result<Self> {
        let check = Check { place };
        let wanted = &spec.stability;
        check.keys("stability", wanted, [("pitch_mm", Range::Positive)])?;
        check.list("stability.parts", wanted.parts.clone())?;
        let parts = wanted.parts.iter().enumerate();
        let parts = parts.map(|(number, part)| {
            let part = PartCheck {
                check: &check,
                number,
                part,
            };
            part.lay_out()
        });
        let parts = parts.collect::<Result<Vec<_>>>()?;
        Ok(Self {
            pitch: wanted.pitch_mm * MM,
            parts,
            peers: wanted.peers.as_ref().map(|path| folder.join(path)),
            spec,
        })
    }

    /// All cells, each with its stroke, metres.
    pub fn cells(&self) -> impl Iterator<Item = (&StabilityCell, f64)> {
        let parts = self.parts.iter();
        parts.flat_map(|part| part.cells.iter().map(|cell| (cell, part.stroke)))
    }
}

/// One part, and what it is called in errors.
struct PartCheck<'a> {
    check: &'a Check<'a>,
    number: usize,
    part: &'a StabilityPartSpec,
}

impl PartCheck<'_> {
    fn key(&self, name: &str) -> String {
        format!("stability.parts[{}].{name}", self.number + 1)
    }

    fn lay_out(&self) -> Result<StabilityPart> {
        let part = self.part;
        let name = format!("stability.parts[{}]", self.number + 1);
        self.check.keys(&name, part, KEYS)?;
        if part.methods.iter().any(|method| method.is_peer()) {
            let allowed =
                "methods of this program: other programs leave their rows in stability.peers";
            return Err(self.check.error(&self.key("methods"), "MuJoCo", allowed));
        }
        let sides = self.sides()?;
        let stiffnesses = part.stiffness_n_per_m.values();
        let taxel_masses = part.taxel_mass_kg.values();
        let masses = self.object_masses()?;
        let dts = part.dt_s.values();
        let iterations = part.solver_iterations.values();
        let built = part.methods.iter().filter(|method| method.is_built());
        let ways = built.flat_map(|&method| {
            let engine = iterations.iter().map(|&n| Some(n)).collect();
            let counts: Vec<_> = if method.is_engine() {
                engine
            } else {
                vec![None]
            };
            counts.into_iter().map(move |n| (method, n))
        });
        let ways: Vec<(ContactMethod, Option<usize>)> = ways.collect();
        let axes = [
            ways.len(),
            sides.len(),
            stiffnesses.len(),
            masses.len(),
            taxel_masses.len(),
            dts.len(),
        ];
        let n_all = axes.iter().map(|&n| n as f64).product();
        self.check.configurations(n_all)?;
        let mut cells = Vec::new();
        nested! {
            (method, solver_iterations) in ways;
            &taxels in &sides;
            &stiffness_n_per_m in &stiffnesses;
            &mass in &masses;
            &taxel_mass_kg in &taxel_masses;
            &dt_s in &dts;
            {
                let mut cell = StabilityCell {
                    part: self.number + 1,
                    scene: part.scene,
                    method,
                    solver_iterations,
                    taxels,
                    stiffness_n_per_m,
                    taxel_mass_kg,
                    object_mass_kg: mass,
                    dt_s,
                };
                if part.object_mass_per_taxel_kg.is_some() {
                    cell.object_mass_kg = mass.map(|mass| cell.n_taxels() as f64 * mass);
                }
                cells.push(cell);
            }
        }
        Ok(StabilityPart {
            stroke: part.stroke_mm * MM,
            cells,
        })
    }

    /// Even, so that the ball lies between four taxels and not on one.
    fn sides(&self) -> Result<Vec<usize>> {
        let key = self.key("taxels");
        let sides = self.part.taxels.values();
        match sides.iter().find(|&&n| n % 2 != 0 || n > MOST_TAXELS) {
            Some(n) => {
                let allowed = format!("even numbers from 2 to {MOST_TAXELS}");
                Err(self.check.error(&key, n, allowed))
            }
            None => Ok(sides),
        }
    }

    /// M or, where it is given so, M over the number of taxels; none where the ball's motion is imposed.
    fn object_masses(&self) -> Result<Vec<Option<f64>>> {
        let part = self.part;
        let given = [
            ("object_mass_kg", part.object_mass_kg.as_ref()),
            (
                "object_mass_per_taxel_kg",
                part.object_mass_per_taxel_kg.as_ref(),
            ),
        ];
        let mut given = given
            .into_iter()
            .filter_map(|(name, axis)| Some((name, axis?)));
        let (first, second) = (given.next(), given.next());
        let (name, given, allowed) = match (first, second, part.scene) {
            (None, _, StabilityScene::Press) => return Ok(vec![None]),
            (Some((name, _)), _, StabilityScene::Press) => {
                (name, "a mass", "no such key: the ball's motion is imposed")
            }
            (None, ..) => ("object_mass_kg", "none", "a mass: the ball is free"),
            (_, Some((name, _)), _) => (name, "a mass", "one of this key and object_mass_kg"),
            (Some((_, axis)), None, _) => {
                return Ok(axis.values().into_iter().map(Some).collect());
            }
        };
        Err(self.check.error(&self.key(name), given, allowed))
    }
}
