//! Taxel properties of a patch, given as one number for all taxels, as a list, or as a column of a CSV file.

use super::numbers::Numbers;
use super::reader::{MM, Reader};
use super::spec::PatchSpec;
use crate::error::{Error, Result};
use crate::inputs::range::{not_negative, positive};
use crate::numbers_csv::NumberTable;
use crate::spelling::nearest_names;
use crate::world::{PerTaxel, Shear, Shears, Taxel, Taxels};

/// Default stiffness of a taxel, N/m.
const STIFFNESS: f64 = 100.0;

const RADIUS: &str = "taxel_radius_mm";
const STROKE: &str = "stroke_mm";
const STIFF: &str = "stiffness_n_per_m";
const DAMPING: &str = "damping_n_s_per_m";
const FRICTION: &str = "friction";
const SHEAR: &str = "shear_stiffness_n_per_m";
const NAMES: [&str; 6] = [RADIUS, STROKE, STIFF, DAMPING, FRICTION, SHEAR];

/// Source of the taxel properties of a patch: its keys in the scene file, and its CSV file.
struct Lookup<'a> {
    reader: &'a Reader<'a>,
    /// Key of the patch in the scene file.
    key: &'a str,
    /// Table read from the CSV file, one row per taxel.
    table: NumberTable,
    n_taxels: usize,
}

impl Reader<'_> {
    /// Returns the taxels of a patch and, if the patch has friction, their tangential springs. Writes default values into the specification of the patch.
    pub fn taxels(
        &self,
        key: &str,
        spec: &mut PatchSpec,
        (n_taxels, default_radius_mm): (usize, PerTaxel<f64>),
    ) -> Result<(Taxels, Option<Shears>)> {
        let table = match &spec.taxels_csv {
            Some(path) => {
                let (place, file) = self.open(&format!("{key}.taxels_csv"), path)?;
                read_table(&place, file)?
            }
            None => NumberTable::default(),
        };
        let has = |name| table.position(name).is_some();
        let (has_stiffness, has_damping) = (has(STIFF), has(DAMPING));
        let default = |given: &mut Option<Numbers>, has_column: bool, value| {
            if given.is_none() && !has_column {
                *given = Some(Numbers::One(value));
            }
        };
        default(&mut spec.stiffness_n_per_m, has_stiffness, STIFFNESS);
        default(&mut spec.damping_n_s_per_m, has_damping, 0.0);
        let lookup = Lookup {
            reader: self,
            key,
            table,
            n_taxels,
        };
        let (above, from) = ("a positive number", "zero or a positive number");
        let radius = lookup.find(RADIUS, spec.taxel_radius_mm.as_ref(), positive, above)?;
        let radius = radius.unwrap_or(default_radius_mm);
        let stroke = lookup.needed(STROKE, spec.stroke_mm.as_ref(), positive, above)?;
        let stiffness = lookup.needed(STIFF, spec.stiffness_n_per_m.as_ref(), positive, above)?;
        let damping = spec.damping_n_s_per_m.as_ref();
        let damping = lookup.needed(DAMPING, damping, not_negative, from)?;
        let taxels = lookup.each([&radius, &stroke, &stiffness, &damping], |taxel| Taxel {
            radius: radius.at(taxel) * MM,
            stiffness: *stiffness.at(taxel),
            damping: *damping.at(taxel),
            stroke: stroke.at(taxel) * MM,
        });
        let friction = lookup.find(FRICTION, spec.friction.as_ref(), not_negative, from)?;
        let shear = spec.shear_stiffness_n_per_m.as_ref();
        let shear = lookup.find(SHEAR, shear, positive, above)?;
        let shears = match (friction, shear) {
            (None, None) => None,
            (None, Some(_)) => {
                let given = "given without friction";
                let allowed = "friction = μ beside it";
                return Err(self.check.error(&format!("{key}.{SHEAR}"), given, allowed));
            }
            (Some(friction), shear) => {
                let shear = shear.unwrap_or(stiffness);
                Some(lookup.each([&friction, &shear], |taxel| Shear {
                    stiffness: *shear.at(taxel),
                    friction: *friction.at(taxel),
                }))
            }
        };
        Ok((taxels, shears))
    }
}

impl Lookup<'_> {
    /// Returns a taxel property that is required; returns an error if the property is missing.
    fn needed(
        &self,
        name: &'static str,
        given: Option<&Numbers>,
        is_allowed: fn(f64) -> bool,
        allowed: &str,
    ) -> Result<PerTaxel<f64>> {
        let found = self.find(name, given, is_allowed, allowed)?;
        found.ok_or_else(|| {
            let allowed = "a number, a list, or a column of taxels_csv";
            self.error(name, "nothing", allowed)
        })
    }

    /// Returns a property of each taxel, read from the scene file or from the CSV file, after a check of each number.
    fn find(
        &self,
        name: &'static str,
        given: Option<&Numbers>,
        is_allowed: fn(f64) -> bool,
        allowed: &str,
    ) -> Result<Option<PerTaxel<f64>>> {
        let check = &self.reader.check;
        let key = format!("{}.{name}", self.key);
        match (given, self.table.position(name)) {
            (None, None) => Ok(None),
            (Some(_), Some(_)) => {
                let given = format!("here and as a column of {}", self.table.place);
                Err(check.error(&key, given, "one of them"))
            }
            (Some(Numbers::One(number)), None) => {
                let number = check.value(&key, *number, is_allowed, allowed)?;
                Ok(Some(PerTaxel::Equal(number)))
            }
            (Some(Numbers::Each(numbers)), None) => {
                self.check_count(numbers.len(), "numbers", |given, allowed| {
                    check.error(&key, given, allowed)
                })?;
                for (index, &number) in numbers.iter().enumerate() {
                    let key = format!("{key}, taxel {}", index + 1);
                    check.value(&key, number, is_allowed, allowed)?;
                }
                Ok(Some(PerTaxel::Each(numbers.clone())))
            }
            (None, Some(column)) => {
                let (place, column) = (&self.table.place, &self.table.columns[column]);
                self.check_count(column.len(), "rows", |given, allowed| {
                    Error::input(place, given, allowed)
                })?;
                for (line, &number) in self.table.lines.iter().zip(column) {
                    if !is_allowed(number) {
                        let place = format!("{place}, line {line}, column {name}");
                        return Err(Error::input(place, number, allowed));
                    }
                }
                Ok(Some(PerTaxel::Each(column.clone())))
            }
        }
    }

    fn check_count(
        &self,
        n: usize,
        what: &str,
        error: impl Fn(String, String) -> Error,
    ) -> Result<()> {
        if n == self.n_taxels {
            return Ok(());
        }
        let allowed = format!("{}, one a taxel", self.n_taxels);
        Err(error(format!("{n} {what}"), allowed))
    }

    fn error(&self, name: &str, given: &str, allowed: &str) -> Error {
        let key = format!("{}.{name}", self.key);
        self.reader.check.error(&key, given, allowed)
    }

    /// Computes one value per taxel from several properties. If all properties are equal for all taxels, makes a single value for all taxels.
    fn each<T, const N: usize>(
        &self,
        of: [&PerTaxel<f64>; N],
        make: impl Fn(usize) -> T,
    ) -> PerTaxel<T> {
        let are_equal = |numbers: &&PerTaxel<f64>| matches!(numbers, PerTaxel::Equal(_));
        match of.iter().all(are_equal) {
            true => PerTaxel::Equal(make(0)),
            false => PerTaxel::Each((0..self.n_taxels).map(make).collect()),
        }
    }
}

/// Reads a CSV table with one row per taxel and one column per property. Errors name the line and the column; unknown and repeated column names are errors.
fn read_table(place: &str, source: impl std::io::Read) -> Result<NumberTable> {
    let allowed = "a header and one row a taxel, of as many numbers";
    let table = NumberTable::read(place, source, allowed)?;
    for (index, given) in table.names.iter().enumerate() {
        if !NAMES.contains(&given.as_str()) {
            let offered = nearest_names(given, NAMES);
            return Err(table.refuse_header(format!("column `{given}`"), offered));
        }
        if table.names[..index].contains(given) {
            return Err(table.refuse_header(format!("column `{given}` twice"), "each once"));
        }
    }
    Ok(table)
}
