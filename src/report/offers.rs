//! What a folder of results offers: settings with their accuracy and what they cost, for [`advise`](crate::study::advice::advise).

use crate::error::{Error, Result};
use crate::kinds::speed_accuracy::rows::{ChainCell, ChainScore, ChainTime};
use crate::report::csv_tables::{read_cell_rows, read_rows};
use crate::report::recognition::{costs_table, swept};
use crate::study::advice::{Costs, Offer};
use crate::study::table::{Cell, CellScore, Pareto};
use crate::study::{Role, agree, column_name, one_of, role_of};
use std::collections::{HashMap, HashSet};
use std::path::Path;
use toml::{Table, Value};

/// What settings cost and give, of studies of several kinds.
const PARETO_FILE: &str = "pareto.csv";

/// A condition that advice is given for: `noise=0.05`.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// A column of [`Cell`].
    column: String,
    /// Its value.
    value: Value,
}

impl Given {
    /// Reads `key=value`.
    ///
    /// # Errors
    /// Another text.
    pub fn parse(text: &str) -> Result<Self> {
        let refuse = || Error::input("--given", text, "a condition and its value: noise=0.05");
        let (key, value) = text.split_once('=').ok_or_else(refuse)?;
        let (key, value) = (key.trim(), value.trim());
        if key.is_empty() || value.is_empty() {
            return Err(refuse());
        }
        let number = value.parse().ok().map(Value::Float);
        Ok(Self {
            column: column_name(key).to_owned(),
            value: number.unwrap_or_else(|| Value::String(value.to_owned())),
        })
    }

    /// The cells that have it.
    ///
    /// # Errors
    /// A column that is a choice, or that no cell has; a value that none has.
    fn filter<'a>(&self, cells: &[&'a Cell]) -> Result<Vec<&'a Cell>> {
        let Self { column, value } = self;
        let place = format!("--given {column}");
        if role_of(column) == Some(Role::Choice) {
            let allowed = "a condition of the world; choices are what is advised";
            return Err(Error::input(place, "is a choice", allowed));
        }
        let conditions: Vec<Table> = cells.iter().map(|cell| cell.conditions()).collect();
        let known = conditions.iter().filter_map(|row| row.get(column));
        let known: Vec<String> = known.map(ToString::to_string).collect();
        if known.is_empty() {
            let columns = conditions.iter().flat_map(Table::keys).cloned();
            let allowed = one_of(columns);
            return Err(Error::input(
                place,
                "is no condition of this study",
                allowed,
            ));
        }
        let has_it = |row: &Table| row.get(column).is_some_and(|known| agree(known, value));
        let found = cells.iter().zip(&conditions);
        let found = found.filter(|(_, row)| has_it(row)).map(|(cell, _)| *cell);
        let found: Vec<&Cell> = found.collect();
        match found.is_empty() {
            true => Err(Error::input(place, value, one_of(known))),
            false => Ok(found),
        }
    }
}

/// The settings of a folder: the decisions of a study of what accuracy costs, or the cells of a study that recognises objects, those of
/// given conditions.
///
/// # Errors
/// A folder without such tables; a table that cannot be read, by its file and line; a condition that the study has not.
pub fn read_offers(folder: &Path, given: &[Given]) -> Result<Vec<Offer>> {
    let path = folder.join(PARETO_FILE);
    let header = first_line(&path)?;
    let has = |column: &str| header.split(',').any(|name| name == column);
    if has("decision_us") {
        if let Some(Given { column, .. }) = given.first() {
            let allowed = "no such option: the study was made in one condition";
            return Err(Error::input("--given", column, allowed));
        }
        let cells: Vec<ChainCell> = read_rows(&path)?;
        let (scores, times) = (read_rows(&path)?, read_rows(&path)?);
        let rows = cells.into_iter().zip(scores).zip(times);
        let offers: Vec<Offer> = rows.map(of_chain).collect();
        return match offers.is_empty() {
            true => Err(refusal(&path, "no decisions")),
            false => Ok(offers),
        };
    }
    if has("chart") {
        return Err(refusal(&path, "columns of an earlier version (chart)"));
    }
    if !has("predict_us_per_decision") || !has("accuracy") {
        return Err(refusal(&path, "other columns"));
    }
    let costs = read_cell_rows::<Pareto>(&path)?;
    let scores = read_cell_rows::<CellScore>(&folder.join("summary.csv"))?;
    let known: HashSet<usize> = scores.iter().map(|(cell, _)| cell.cell).collect();
    if let Some((cell, _)) = costs.iter().find(|(cell, _)| !known.contains(&cell.cell)) {
        let given = format!("cell {} that summary.csv has not", cell.cell);
        return Err(refusal(&path, &given));
    }
    cell_offers(&costs, &scores, given)
}

/// The cells of a study that recognises objects, those of given conditions; cells without a score are left out.
///
/// # Errors
/// A condition that the study has not.
pub fn cell_offers(
    costs: &[(Cell, Pareto)],
    scores: &[(Cell, CellScore)],
    given: &[Given],
) -> Result<Vec<Offer>> {
    let mut cells: Vec<&Cell> = costs.iter().map(|(cell, _)| cell).collect();
    let table = costs_table(costs)?;
    let rows: Vec<usize> = (0..table.n_rows).collect();
    let settings = swept(&table, &rows);
    for given in given {
        cells = given.filter(&cells)?;
    }
    let cells: HashSet<usize> = cells.iter().map(|cell| cell.cell).collect();
    let scores: HashMap<usize, &CellScore> = scores.iter().map(|(c, s)| (c.cell, s)).collect();
    let offer = |(number, (cell, row)): (usize, &(Cell, Pareto))| {
        let score = scores.get(&cell.cell)?;
        let setting = match settings.choice_words(number) {
            words if words.is_empty() => "the only setting".to_owned(),
            words => words,
        };
        Some(Offer {
            cell: Some(cell.cell),
            setting,
            condition: settings.condition_words(number),
            costs: Costs {
                decision_us: row.predict_us_per_decision,
                training_s: row.fit_s,
                taxels: (cell.nx * cell.ny) as f64,
                measurements: cell.measurements_of_decision() as f64,
            },
            accuracy: score.accuracy,
            accuracy_low: score.accuracy_low,
            accuracy_high: score.accuracy_high,
        })
    };
    let of_given = costs.iter().enumerate();
    let of_given = of_given.filter(|(_, (cell, _))| cells.contains(&cell.cell));
    Ok(of_given.filter_map(offer).collect())
}

fn first_line(path: &Path) -> Result<String> {
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(text.lines().next().unwrap_or_default().to_owned()),
        Err(error) => Err(refusal(path, &format!("cannot be read ({error})"))),
    }
}

fn refusal(path: &Path, given: &str) -> Error {
    let allowed = "pareto.csv of a study of what accuracy costs (bubbletouch run experiments/speed_accuracy.toml), or of one that recognises \
                   objects";
    Error::input(path.display(), given, allowed)
}

/// A chain of a study of what accuracy costs.
fn of_chain(((cell, score), time): ((ChainCell, ChainScore), ChainTime)) -> Offer {
    Offer {
        cell: None,
        setting: format!(
            "{}, {}, m = {}, pitch {} mm, spheres within {} mm",
            cell.classifier.about().words,
            cell.ensemble.about().words,
            cell.measurements,
            cell.pitch_mm,
            cell.tolerance_mm
        ),
        condition: String::new(),
        costs: Costs {
            decision_us: time.decision_us,
            training_s: time.fit_s,
            taxels: cell.n_taxels as f64,
            measurements: cell.measurements as f64,
        },
        accuracy: score.accuracy,
        accuracy_low: score.accuracy_low,
        accuracy_high: score.accuracy_high,
    }
}
