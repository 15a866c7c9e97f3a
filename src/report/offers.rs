//! What a folder of results offers: settings with their accuracy and what a decision costs, for [`advise`](crate::study::advice::advise).

use crate::error::{Error, Result};
use crate::report::axis::Axis;
use crate::report::csv_tables::{read_cell_rows, read_rows};
use crate::report::speed_accuracy::{ChartKind, ChartPoint, PARETO_FILE};
use crate::report::varying::Settings;
use crate::study::advice::Offer;
use crate::study::table::{Cell, CellScore, Pareto};
use std::path::Path;

/// The settings of a folder: the decisions of a study of what accuracy costs, or the cells of a study that recognises objects.
///
/// # Errors
/// A folder without such tables; a table that cannot be read, by its file and line.
pub fn read_offers(folder: &Path) -> Result<Vec<Offer>> {
    let path = folder.join(PARETO_FILE);
    let header = first_line(&path)?;
    let has = |column: &str| header.split(',').any(|name| name == column);
    if has("chart") && has("cost_us") {
        let points: Vec<ChartPoint> = read_rows(&path)?;
        let decisions = points
            .into_iter()
            .filter(|p| p.chart == ChartKind::Decision);
        let offers: Vec<Offer> = decisions.map(of_point).collect();
        return match offers.is_empty() {
            true => Err(refusal(&path, "no decisions")),
            false => Ok(offers),
        };
    }
    if !has("predict_us_per_decision") || !has("accuracy") {
        return Err(refusal(&path, "other columns"));
    }
    let costs = read_cell_rows::<Pareto>(&path)?;
    let scores = read_cell_rows::<CellScore>(&folder.join("summary.csv"))?;
    of_cells(&costs, &scores, &path)
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

fn of_point(point: ChartPoint) -> Offer {
    Offer {
        setting: point.setting,
        cost_us: point.cost_us,
        accuracy: point.value,
        accuracy_low: point.value_low,
        accuracy_high: point.value_high,
    }
}

fn of_cells(
    costs: &[(Cell, Pareto)],
    scores: &[(Cell, CellScore)],
    path: &Path,
) -> Result<Vec<Offer>> {
    let cells: Vec<&Cell> = costs.iter().map(|(cell, _)| cell).collect();
    let settings = Settings::of(&cells);
    let axes: Vec<Axis> = settings.varying.iter().map(|levels| levels.axis).collect();
    let offer = |(cell, row): &(Cell, Pareto)| {
        let score = scores.iter().find(|(of, _)| of.cell == cell.cell);
        let Some((_, score)) = score else {
            let given = format!("cell {} that summary.csv has not", cell.cell);
            return Err(refusal(path, &given));
        };
        let words: Vec<String> = axes.iter().map(|axis| axis.phrase(cell)).collect();
        let setting = match words.is_empty() {
            true => "the only setting".to_owned(),
            false => words.join(", "),
        };
        Ok(Offer {
            setting,
            cost_us: row.predict_us_per_decision,
            accuracy: score.accuracy,
            accuracy_low: score.accuracy_low,
            accuracy_high: score.accuracy_high,
        })
    };
    costs.iter().map(offer).collect()
}
