//! A study of stability that can run: every key checked, its cells laid out.

use super::spec::{ContactMethod, StabilityPartSpec, StabilityScene, StabilityStudySpec};
use super::table::StabilityCell;
use crate::error::Result;
use crate::study::axis::Axis;
use crate::study::check::{Check, positive};
use crate::study::plan::MM;
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

impl StabilityPlan {
    /// Checks a study that lies in `folder`; the error names `place` (the file) and the first key that is out of its range.
    pub fn new(place: &str, folder: &Path, spec: StabilityStudySpec) -> Result<Self> {
        let check = Check { place };
        let wanted = &spec.stability;
        let millimetres = "a positive number of millimetres";
        let pitch = check.value("stability.pitch_mm", wanted.pitch_mm, positive, millimetres)?;
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
            pitch: pitch * MM,
            parts,
            peers: wanted.peers.as_ref().map(|path| folder.join(path)),
            spec,
        })
    }

    /// All cells.
    pub fn n_cells(&self) -> usize {
        self.parts.iter().map(|part| part.cells.len()).sum()
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

    fn positive(&self, name: &str, axis: &Axis<f64>) -> Result<Vec<f64>> {
        let allowed = "positive numbers";
        self.check.axis(&self.key(name), axis, positive, allowed)
    }

    fn lay_out(&self) -> Result<StabilityPart> {
        let part = self.part;
        let methods = self
            .check
            .list(&self.key("methods"), part.methods.clone())?;
        if methods.iter().any(|method| method.is_peer()) {
            let allowed =
                "methods of this program: other programs leave their rows in stability.peers";
            return Err(self.check.error(&self.key("methods"), "MuJoCo", allowed));
        }
        let sides = self.sides()?;
        let stroke = self.positive("stroke_mm", &Axis::One(part.stroke_mm))?[0];
        let stiffnesses = self.positive("stiffness_n_per_m", &part.stiffness_n_per_m)?;
        let taxel_masses = self.positive("taxel_mass_kg", &part.taxel_mass_kg)?;
        let masses = self.object_masses()?;
        let dts = self.positive("dt_s", &part.dt_s)?;
        let iterations = self.key("solver_iterations");
        let iterations = self.check.counts(&iterations, &part.solver_iterations)?;
        let axes = [
            sides.len(),
            stiffnesses.len(),
            masses.len(),
            taxel_masses.len(),
            dts.len(),
        ];
        let of_axes: f64 = axes.iter().map(|&n| n as f64).product();
        let ways = methods.iter().filter(|method| method.is_built());
        let ways = ways.map(|&method| of_method(method, &iterations).len());
        self.check
            .configurations(ways.sum::<usize>() as f64 * of_axes)?;
        let mut cells = Vec::new();
        for method in methods.into_iter().filter(|method| method.is_built()) {
            for iterations in of_method(method, &iterations) {
                for &taxels in &sides {
                    for &stiffness_n_per_m in &stiffnesses {
                        for object_mass_kg in masses.iter().map(|mass| mass.on(taxels)) {
                            for &taxel_mass_kg in &taxel_masses {
                                cells.extend(dts.iter().map(|&dt_s| StabilityCell {
                                    part: self.number + 1,
                                    scene: part.scene,
                                    method,
                                    solver_iterations: iterations,
                                    taxels,
                                    stiffness_n_per_m,
                                    taxel_mass_kg,
                                    object_mass_kg,
                                    dt_s,
                                }));
                            }
                        }
                    }
                }
            }
        }
        Ok(StabilityPart {
            stroke: stroke * MM,
            cells,
        })
    }

    /// Even, so that the ball lies between four taxels and not on one.
    fn sides(&self) -> Result<Vec<usize>> {
        let key = self.key("taxels");
        let sides = self.check.counts(&key, &self.part.taxels)?;
        match sides.iter().find(|&&n| n % 2 != 0 || n > MOST_TAXELS) {
            Some(n) => {
                let allowed = format!("even numbers from 2 to {MOST_TAXELS}");
                Err(self.check.error(&key, n, allowed))
            }
            None => Ok(sides),
        }
    }

    fn object_masses(&self) -> Result<Vec<ObjectMass>> {
        let part = self.part;
        let (given, per_taxel) = (&part.object_mass_kg, &part.object_mass_per_taxel_kg);
        let (one, other) = ("object_mass_kg", "object_mass_per_taxel_kg");
        let refuse = |name: &str, given: &str, allowed: &str| {
            Err(self.check.error(&self.key(name), given, allowed))
        };
        match (given, per_taxel, part.scene) {
            (None, None, StabilityScene::Press) => Ok(vec![ObjectMass::None]),
            (Some(_), _, StabilityScene::Press) => {
                refuse(one, "a mass", "no such key: the ball's motion is imposed")
            }
            (None, Some(_), StabilityScene::Press) => {
                refuse(other, "a mass", "no such key: the ball's motion is imposed")
            }
            (None, None, _) => refuse(one, "none", "a mass: the ball is free"),
            (Some(_), Some(_), _) => refuse(other, "a mass", "one of this key and object_mass_kg"),
            (Some(axis), None, _) => {
                let masses = self.positive(one, axis)?;
                Ok(masses.into_iter().map(ObjectMass::Of).collect())
            }
            (None, Some(axis), _) => {
                let masses = self.positive(other, axis)?;
                Ok(masses.into_iter().map(ObjectMass::PerTaxel).collect())
            }
        }
    }
}

/// M, kg.
#[derive(Clone, Copy)]
enum ObjectMass {
    /// Its motion is imposed.
    None,
    Of(f64),
    /// Over the number of taxels.
    PerTaxel(f64),
}

impl ObjectMass {
    /// On so many taxels a side.
    fn on(self, taxels: usize) -> Option<f64> {
        match self {
            Self::None => None,
            Self::Of(mass) => Some(mass),
            Self::PerTaxel(mass) => Some((taxels * taxels) as f64 * mass),
        }
    }
}

fn of_method(method: ContactMethod, iterations: &[usize]) -> Vec<Option<usize>> {
    match method.is_engine() {
        true => iterations.iter().copied().map(Some).collect(),
        false => vec![None],
    }
}
