//! Table `[test]`: keys in which test touches differ from training touches.
//!
//! ```toml
//! [test]
//! touches.depth_mm = 1.0                             # instead of touches.depth_mm
//! signal.steps = ["noise", "smoothing", "faults"]    # a taxel that is dead in tests only
//! [axes]
//! "test.signal.dead_fraction" = [0.0, 0.1, 0.2]
//! ```
//! The study with these keys is planned as any other study. Test touches have the same numbers as the study's touches, so the splits are equal. Projections,
//! features and classifiers are fitted to the training touches.

use crate::inputs::keys::find;
use crate::inputs::sensor_errors::NOISES;
use crate::inputs::toml_value::table_of;
use crate::studies::prelude::*;
use crate::studies::recognition::plan::Condition;
use crate::studies::recognition::spec::{SignalAxis, recognition_keys};
use std::sync::Arc;
use toml::{Table, Value};

/// Names of the tables whose keys may also occur in `[test]`, in a study that places objects.
pub(crate) const TABLES: &[&str] = &["objects", "skin", "touches", "signal"];
const TABLES_OF_OTHERS: &[&str] = &["signal"];

impl Check<'_> {
    /// Returns the plan of the test touches, given the plan of the study without `[test]`; `None` if the study has no table `[test]`.
    ///
    /// # Errors
    /// If a key cannot differ for test touches or is out of its range. If a taxel of the test touches has no counterpart in training touches.
    pub(crate) fn tested(&self, plan: &Plan) -> Result<Option<Arc<Plan>>> {
        let spec = &plan.spec;
        if spec.test.is_empty() {
            return Ok(None);
        }
        let tables = match spec.places_objects() {
            true => TABLES,
            false => TABLES_OF_OTHERS,
        };
        let mut study = table_of(spec);
        study.remove("test");
        for (name, keys) in &spec.test {
            let Value::Table(keys) = keys else {
                let allowed = format!("a table: {}", tables.join(", "));
                return Err(self.error(&format!("test.{name}"), keys, allowed));
            };
            if !tables.contains(&&name[..]) {
                let allowed = format!("keys of {} of this study", tables.join(", "));
                return Err(self.error(&format!("test.{name}"), "given for test touches", allowed));
            }
            let own = study
                .entry(&name[..])
                .or_insert_with(|| Table::new().into());
            let Value::Table(own) = own else { continue };
            for (key, value) in keys {
                let path = format!("{name}.{key}");
                if find(recognition_keys(), &path)
                    .is_some_and(|key| key.of_all_touches == Some(true))
                {
                    let allowed = format!("{path}, which training and test touches share");
                    return Err(self.error(&format!("test.{path}"), value, allowed));
                }
                let is_noise = |key: &str| NOISES.iter().any(|(noise, _)| *noise == key);
                if is_noise(key) {
                    own.retain(|other, _| !is_noise(other));
                }
                own.insert(key.clone(), value.clone());
            }
        }
        let tested = study.try_into().map_err(|error: toml::de::Error| {
            let said = error.message().trim().replace('\n', " ");
            self.error("test", said, "keys and values of the study")
        })?;
        let tested = Plan::with_any_keys(self.place, tested);
        let tested = tested.map_err(|error| self.under_test(error, &spec.test))?;
        self.check_alike(plan, &tested)?;
        Ok(Some(Arc::new(tested)))
    }

    /// Changes the key in an error to its name in `[test]`, if the error concerns a key of that table.
    fn under_test(&self, error: Error, test: &Table) -> Error {
        let Error::Input {
            place,
            given,
            allowed,
        } = &error
        else {
            return error;
        };
        let (start, key) = match place.split_once("key ") {
            Some((start, key)) => (start, key),
            None => return error,
        };
        let is_of_test = key.split_once('.').is_some_and(|(table, key)| {
            let keys = test.get(table).and_then(Value::as_table);
            keys.is_some_and(|keys| keys.keys().any(|own| key.starts_with(&own[..])))
        });
        match is_of_test {
            true => Error::input(format!("{start}key test.{key}"), given, allowed),
            false => Error::input(format!("{place} of test touches"), given, allowed),
        }
    }

    /// Returns an error if test frames and training frames differ in their taxels or in their values per taxel. A key that is an axis of the study must not
    /// have a list in `[test]`.
    fn check_alike(&self, plan: &Plan, tested: &Plan) -> Result<()> {
        let (learned, shown) = (&plan.array, &tested.array);
        if (learned.shape(), learned.n_values()) != (shown.shape(), shown.n_values()) {
            let [given, allowed] = [shown, learned].map(|array| {
                let ImageShape { ny, nx } = array.shape();
                format!("{nx} x {ny}")
            });
            let allowed = format!("the taxels that are learned, {allowed}, with the same readings");
            return Err(self.error("test.skin", format!("{given} taxels"), allowed));
        }
        for (key, _, axis) in tested.own_signal(&plan.spec.test) {
            if let Axis::Many(values) = axis {
                let path = format!("test.signal.{key}");
                let given = format!("a list of {} values", values.len());
                let allowed = format!("one value, or several as an axis: [axes] \"{path}\"");
                return Err(self.error(&path, given, allowed));
            }
        }
        Ok(())
    }
}

impl Plan {
    /// Returns the signal axes whose values the table `[test]` sets.
    fn own_signal<'a>(&'a self, test: &'a Table) -> impl Iterator<Item = &'a SignalAxis> {
        let own = test.get("signal").and_then(Value::as_table);
        let given = self.spec.signal.axes.given();
        given.filter(move |(key, ..)| own.is_some_and(|own| own.contains_key(*key)))
    }

    /// Returns the signal condition of the test touches, given the condition `learned` of the training touches.
    pub fn tested_condition(&self, learned: Condition) -> Condition {
        let Some(tested) = &self.tested else {
            return learned;
        };
        let own = tested.own_signal(&self.spec.test);
        own.fold(learned, |condition, (key, step, axis)| {
            condition.with((key, *step), axis.values()[0])
        })
    }
}
