//! Plan of a stability study: the checked keys and the list of configurations.

use crate::studies::prelude::*;
use crate::studies::stability::rows::*;
use crate::studies::stability::spec::*;
use std::path::{Path, PathBuf};

/// Checked keys of a stability study, with its configurations.
#[derive(Clone, Debug)]
pub struct StabilityPlan {
    /// Specification of the study, with the keys, values and units of the study file.
    pub spec: StabilityStudySpec,
    /// Configurations, ordered by part, each with its taxel parameters without damper. Methods that this build does not contain are omitted.
    pub configurations: Vec<(StabilityConfiguration, Taxel)>,
    /// Configurations of all methods, also of those that this build does not contain.
    pub(super) all_methods: Vec<(StabilityConfiguration, Taxel)>,
    /// Path of the table with results of other programs; `None` if there is none.
    pub peers: Option<PathBuf>,
}

/// Maximum number of taxels along a side of the array. Larger arrays take long and give no new information about stability.
const MAX_TAXELS: usize = 256;

impl StabilityPlan {
    /// Creates the plan of a study whose file is in `folder`, and checks all keys.
    ///
    /// # Errors
    /// If a key is out of its range; the error names `place` (the file) and the key.
    pub fn new(place: &str, folder: &Path, spec: StabilityStudySpec) -> Result<Self> {
        let check = Check { place };
        let wanted = &spec.stability;
        check.keys("stability", wanted, keys_of::<StabilityStudySpec>())?;
        check.list("stability.parts", wanted.parts.clone())?;
        let mut all_methods = Vec::new();
        for (number, part) in wanted.parts.iter().enumerate() {
            let taxel = |configuration: &StabilityConfiguration| Taxel {
                radius: 0.5 * wanted.pitch_mm * MM,
                stiffness: configuration.stiffness_n_per_m,
                damping: 0.0,
                stroke: part.stroke_mm * MM,
            };
            let of_part = check.stability_part(number + 1, part)?.into_iter();
            all_methods.extend(
                of_part.map(|configuration| (configuration.clone(), taxel(&configuration))),
            );
        }
        let mut configurations = all_methods.clone();
        configurations.retain(|(configuration, _)| configuration.method.is_built());
        Ok(Self {
            configurations,
            all_methods,
            peers: wanted.peers.as_ref().map(|path| path.within(folder)),
            spec,
        })
    }
}

impl Check<'_> {
    fn stability_part(
        &self,
        part: usize,
        wanted: &StabilityPartSpec,
    ) -> Result<Vec<StabilityConfiguration>> {
        let name = format!("stability.parts[{part}]");
        let error =
            |[key, given, allowed]: [&str; 3]| self.error(&format!("{name}.{key}"), given, allowed);
        self.keys(&name, wanted, keys_of::<StabilityStudySpec>())?;
        if wanted.methods.iter().any(|method| method.is_peer()) {
            let allowed =
                "methods of this program: other programs leave their rows in stability.peers";
            return Err(error(["methods", "MuJoCo", allowed]));
        }
        let sides = wanted.taxels.values();
        // The number is even, so that the ball lies between four taxels.
        if let Some(n) = sides.iter().find(|&&n| n % 2 != 0 || n > MAX_TAXELS) {
            let allowed = format!("even numbers from 2 to {MAX_TAXELS}");
            return Err(error(["taxels", &n.to_string(), &allowed]));
        }
        let masses = object_masses(wanted).map_err(error)?;
        let of_engines = wanted.solver_iterations.values();
        let iterations = |method: ContactMethod| match method.is_engine() {
            true => of_engines.iter().copied().map(Some).collect(),
            false => vec![None],
        };
        let methods = wanted.methods.clone();
        if !methods.iter().any(|method| method.is_engine()) && of_engines != [SOLVER_ITERATIONS] {
            let given = format!("{of_engines:?}, but no method of the part iterates");
            let allowed = "no such key, or a physics engine among methods";
            return Err(error(["solver_iterations", &given, allowed]));
        }
        let axes = [
            methods.iter().map(|&method| iterations(method).len()).sum(),
            sides.len(),
            wanted.stiffness_n_per_m.values().len(),
            masses.len(),
            wanted.taxel_mass_kg.values().len(),
            wanted.dt_s.values().len(),
        ];
        self.configurations(axes.iter().map(|&n| n as f64).product())?;
        let mut configurations = Vec::new();
        nested! {
            method in methods;
            solver_iterations in iterations(method);
            &taxels in &sides;
            stiffness_n_per_m in wanted.stiffness_n_per_m.values();
            &mass in &masses;
            taxel_mass_kg in wanted.taxel_mass_kg.values();
            dt_s in wanted.dt_s.values();
            {
                let n_carriers = match wanted.object_mass_per_taxel_kg {
                    Some(_) => taxels * taxels,
                    None => 1,
                };
                configurations.push(StabilityConfiguration {
                    part,
                    scene: wanted.scene,
                    method,
                    solver_iterations,
                    taxels,
                    stiffness_n_per_m,
                    taxel_mass_kg,
                    object_mass_kg: mass.map(|mass| n_carriers as f64 * mass),
                    dt_s,
                });
            }
        }
        Ok(configurations)
    }
}

/// Returns the possible masses M of the ball, kg; `None` if the motion of the ball is imposed. A given mass per taxel is converted. An error consists of the
/// key, the given value and the allowed values.
fn object_masses(
    part: &StabilityPartSpec,
) -> std::result::Result<Vec<Option<f64>>, [&'static str; 3]> {
    let [whole, per_taxel] = ["object_mass_kg", "object_mass_per_taxel_kg"];
    let imposed = "no such key: the ball's motion is imposed";
    let is_imposed = part.scene == StabilityScene::Press;
    match (&part.object_mass_kg, &part.object_mass_per_taxel_kg) {
        (None, None) if is_imposed => Ok(vec![None]),
        (Some(_), _) if is_imposed => Err([whole, "a mass", imposed]),
        (None, Some(_)) if is_imposed => Err([per_taxel, "a mass", imposed]),
        (None, None) => Err([whole, "none", "a mass: the ball is free"]),
        (Some(_), Some(_)) => Err([per_taxel, "a mass", "one of this key and object_mass_kg"]),
        (Some(axis), None) | (None, Some(axis)) => {
            Ok(axis.values().into_iter().map(Some).collect())
        }
    }
}
