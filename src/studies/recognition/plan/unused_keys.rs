//! Keys without effect: the check that each given value acts in one variant of a study.

use crate::inputs::check::Effect;
use crate::inputs::toml_value::{is_at, value_at};
use crate::studies::prelude::*;
use crate::studies::recognition::plan::tested::TABLES;
use crate::studies::recognition::spec::recognition_keys;
use crate::world::Spread;
use std::collections::HashSet;

/// Start of the paths of the keys of test touches.
const OF_TESTS: &str = "test.";

/// Conditions under which keys act.
impl Plan {
    /// Returns whether an ensemble of the study measures a number of values that the study sets.
    pub(crate) fn counts_measurements(&self) -> bool {
        let sensing = &self.spec.sensing;
        let mut ensembles = sensing.ensemble.values().into_iter();
        let mut counts = sensing.measurements.iter().flat_map(Axis::values);
        ensembles.any(|ensemble| !ensemble.about().is_whole_frame)
            || sensing.ratio.is_none() && counts.all(|m| m == self.array.n_values())
    }

    /// Returns whether the groups of the split depend on drawn values of one of the given axes.
    pub(crate) fn draws_groups(&self, among: &[TouchAxis]) -> bool {
        let axes = self.group_by.map_or(&[][..], |groups| groups.kind.axes());
        let mut spreads = self.placement.spreads().into_iter();
        spreads.any(|(axis, spread)| {
            let is_drawn = matches!(spread, Spread::Uniform { .. });
            is_drawn && among.contains(&axis) && axes.contains(&axis)
        })
    }
}

impl Check<'_> {
    /// Returns the first key that has no effect in any variant of a study: the index of the variant that gives it, and the error.
    pub(crate) fn unused_key<'a>(
        &self,
        variants: impl IntoIterator<Item = &'a Plan>,
    ) -> Option<(usize, Error)> {
        let mut acting: HashSet<String> = HashSet::new();
        let mut unused: Vec<(String, usize, Error)> = Vec::new();
        for (number, plan) in variants.into_iter().enumerate() {
            for (path, error) in self.effects_of(plan) {
                match error {
                    None => drop(acting.insert(path)),
                    Some(error) if unused.iter().all(|(known, ..)| *known != path) => {
                        unused.push((path, number, error));
                    }
                    Some(_) => {}
                }
            }
        }
        let mut unused = unused.into_iter();
        let (_, number, error) = unused.find(|(path, ..)| !acting.contains(path))?;
        Some((number, error))
    }

    /// Returns the keys of a variant that may have no effect. One value of a list that has an effect suffices. A key that training touches and test touches
    /// share has an effect if it has one in either; all other keys must have an effect with the training touches. A key of `[test]` must have an effect in
    /// test touches.
    fn effects_of(&self, plan: &Plan) -> Vec<Effect> {
        let effects =
            |prefix, plan: &Plan| self.effects(prefix, &plan.spec, recognition_keys(), &[plan]);
        let mut given = effects("", plan);
        let Some(tested) = &plan.tested else {
            return given;
        };
        for (path, error) in effects(OF_TESTS, tested) {
            let key = &path[OF_TESTS.len()..];
            let is_own = value_at(&plan.spec.test, key).is_some();
            match given.iter_mut().find(|(known, _)| known == key) {
                _ if !TABLES.iter().any(|table| is_at(key, table)) => {}
                _ if is_own => given.push((path, error)),
                Some((_, known)) if error.is_none() => *known = None,
                _ => {}
            }
        }
        given
    }
}
