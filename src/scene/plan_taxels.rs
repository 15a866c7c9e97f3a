//! Taxel properties of a patch, given as one number for all taxels, as a list, or as a column of a CSV file.

use super::reader::Reader;
use super::spec::{Numbers, PatchSpec};
use crate::error::{Error, Result};
use crate::inputs::params::Described;
use crate::inputs::units::MM;
use crate::numbers_csv::NumberTable;
use crate::spelling::nearest_names;
use crate::world::{PerTaxel, Shear, Shears, Taxel, Taxels};

/// Default stiffness of a taxel, N/m.
const STIFFNESS: f64 = 100.0;

/// Keys of a patch that the CSV file of its taxels may have as columns.
const COLUMNS: [&str; 6] = [
    "taxel_radius_mm",
    "stroke_mm",
    "stiffness_n_per_m",
    "damping_n_s_per_m",
    "friction",
    "shear_stiffness_n_per_m",
];

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
                read_table(&place, file, n_taxels)?
            }
            None => NumberTable::default(),
        };
        let lookup = Lookup {
            reader: self,
            key,
            table,
            n_taxels,
        };
        let radius = lookup.find("taxel_radius_mm", &mut spec.taxel_radius_mm)?;
        let radius = radius.unwrap_or(default_radius_mm);
        let stroke = lookup.find("stroke_mm", &mut spec.stroke_mm)?;
        let Some(stroke) = stroke else {
            let allowed = "a number, a list, or a column of taxels_csv";
            return self.refuse(&format!("{key}.stroke_mm"), "nothing", allowed);
        };
        let stiffness = &mut spec.stiffness_n_per_m;
        let stiffness = lookup.find_or("stiffness_n_per_m", stiffness, STIFFNESS)?;
        let damping = &mut spec.damping_n_s_per_m;
        let damping = lookup.find_or("damping_n_s_per_m", damping, 0.0)?;
        let taxels = lookup.each([&radius, &stroke, &stiffness, &damping], |taxel| Taxel {
            radius: radius.at(taxel) * MM,
            stiffness: *stiffness.at(taxel),
            damping: *damping.at(taxel),
            stroke: stroke.at(taxel) * MM,
        });
        let friction = lookup.find("friction", &mut spec.friction)?;
        let shear = &mut spec.shear_stiffness_n_per_m;
        let shear = lookup.find("shear_stiffness_n_per_m", shear)?;
        let Some(friction) = friction else {
            return match shear {
                None => Ok((taxels, None)),
                Some(_) => {
                    let key = format!("{key}.shear_stiffness_n_per_m");
                    self.refuse(&key, "given without friction", "friction = μ beside it")
                }
            };
        };
        let shear = shear.unwrap_or(stiffness);
        let shears = lookup.each([&friction, &shear], |taxel| Shear {
            stiffness: *shear.at(taxel),
            friction: *friction.at(taxel),
        });
        Ok((taxels, Some(shears)))
    }
}

impl Lookup<'_> {
    /// Returns a property of each taxel, read from the scene file or from the CSV file; `None` if neither has it.
    fn find(
        &self,
        name: &'static str,
        given: &mut Option<Numbers>,
    ) -> Result<Option<PerTaxel<f64>>> {
        let key = format!("{}.{name}", self.key);
        Ok(match (given, self.table.position(name)) {
            (None, None) => None,
            (None, Some(column)) => Some(PerTaxel::Each(self.table.columns[column].clone())),
            (Some(_), Some(_)) => {
                let given = format!("here and as a column of {}", self.table.place);
                return self.reader.refuse(&key, given, "one of them");
            }
            (Some(Numbers::One(number)), None) => Some(PerTaxel::Equal(*number)),
            (Some(Numbers::Each(numbers)), None) if numbers.len() == self.n_taxels => {
                Some(PerTaxel::Each(numbers.clone()))
            }
            (Some(Numbers::Each(numbers)), None) => {
                let given = format!("{} numbers", numbers.len());
                return self.reader.refuse(&key, given, one_each(self.n_taxels));
            }
        })
    }

    /// Returns a property of each taxel. If neither file has the property, writes the default value to `given`.
    fn find_or(
        &self,
        name: &'static str,
        given: &mut Option<Numbers>,
        default: f64,
    ) -> Result<PerTaxel<f64>> {
        let found = self.find(name, given)?;
        Ok(found.unwrap_or_else(|| {
            *given = Some(Numbers::One(default));
            PerTaxel::Equal(default)
        }))
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

/// Returns the allowed number of values of a property, as text.
fn one_each(n_taxels: usize) -> String {
    format!("{n_taxels}, one a taxel")
}

/// Reads a CSV table with one row per taxel and one column per property. Errors name the line and the column; unknown and repeated column names are errors, as
/// are numbers out of the range of their key.
fn read_table(place: &str, source: impl std::io::Read, n_taxels: usize) -> Result<NumberTable> {
    let allowed = "a header and one row a taxel, of as many numbers";
    let table = NumberTable::read(place, source, allowed)?;
    for (index, given) in table.names.iter().enumerate() {
        if !COLUMNS.contains(&given.as_str()) {
            let offered = nearest_names(given, COLUMNS);
            return Err(table.refuse_header(format!("column `{given}`"), offered));
        }
        if table.names[..index].contains(given) {
            return Err(table.refuse_header(format!("column `{given}` twice"), "each once"));
        }
        let Some(range) = PatchSpec::range(given) else {
            continue;
        };
        for (line, &number) in table.lines.iter().zip(&table.columns[index]) {
            if !range.contains(number) {
                let place = format!("{place}, line {line}, column {given}");
                return Err(Error::input(place, number, range.words()));
            }
        }
    }
    match table.lines.len() {
        n if n == n_taxels => Ok(table),
        n => Err(Error::input(place, format!("{n} rows"), one_each(n_taxels))),
    }
}
