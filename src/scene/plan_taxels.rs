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
        for (column, given, default) in [
            ("stiffness_n_per_m", &mut spec.stiffness_n_per_m, STIFFNESS),
            ("damping_n_s_per_m", &mut spec.damping_n_s_per_m, 0.0),
        ] {
            if table.position(column).is_none() {
                given.get_or_insert(Numbers::One(default));
            }
        }
        let given = [
            &spec.taxel_radius_mm,
            &spec.stroke_mm,
            &spec.stiffness_n_per_m,
            &spec.damping_n_s_per_m,
            &spec.friction,
            &spec.shear_stiffness_n_per_m,
        ];
        let mut found = [const { None }; COLUMNS.len()];
        for ((name, given), found) in COLUMNS.iter().zip(given).zip(&mut found) {
            let key = format!("{key}.{name}");
            *found = self.property(&key, given.as_ref(), (&table, name), n_taxels)?;
        }
        let [radius, stroke, stiffness, damping, friction, shear] = found;
        let radius = radius.unwrap_or(default_radius_mm);
        let (Some(stroke), Some(stiffness), Some(damping)) = (stroke, stiffness, damping) else {
            let allowed = "a number, a list, or a column of taxels_csv";
            return self.refuse(&format!("{key}.stroke_mm"), "nothing", allowed);
        };
        let taxels = [&radius, &stroke, &stiffness, &damping];
        let taxels = each_taxel(n_taxels, taxels, |taxel| Taxel {
            radius: radius.at(taxel) * MM,
            stiffness: *stiffness.at(taxel),
            damping: *damping.at(taxel),
            stroke: stroke.at(taxel) * MM,
        });
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
        let shears = each_taxel(n_taxels, [&friction, &shear], |taxel| Shear {
            stiffness: *shear.at(taxel),
            friction: *friction.at(taxel),
        });
        Ok((taxels, Some(shears)))
    }

    /// Returns a property of each taxel, given by its key or by the column `name` of a table; `None` if neither is given.
    fn property(
        &self,
        key: &str,
        given: Option<&Numbers>,
        (table, name): (&NumberTable, &str),
        n_taxels: usize,
    ) -> Result<Option<PerTaxel<f64>>> {
        Ok(match (given, table.position(name)) {
            (None, None) => None,
            (None, Some(column)) => Some(PerTaxel::Each(table.columns[column].clone())),
            (Some(_), Some(_)) => {
                let given = format!("here and as a column of {}", table.place);
                return self.refuse(key, given, "one of them");
            }
            (Some(Numbers::One(number)), None) => Some(PerTaxel::Equal(*number)),
            (Some(Numbers::Each(numbers)), None) if numbers.len() != n_taxels => {
                let given = format!("{} numbers", numbers.len());
                return self.refuse(key, given, one_each(n_taxels));
            }
            (Some(Numbers::Each(numbers)), None) => Some(PerTaxel::Each(numbers.clone())),
        })
    }
}

/// Computes one value per taxel from several properties. If all properties are equal for all taxels, makes a single value for all taxels.
fn each_taxel<T, const N: usize>(
    n_taxels: usize,
    properties: [&PerTaxel<f64>; N],
    make: impl Fn(usize) -> T,
) -> PerTaxel<T> {
    let are_equal = |numbers: &&PerTaxel<f64>| matches!(numbers, PerTaxel::Equal(_));
    match properties.iter().all(are_equal) {
        true => PerTaxel::Equal(make(0)),
        false => PerTaxel::Each((0..n_taxels).map(make).collect()),
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
