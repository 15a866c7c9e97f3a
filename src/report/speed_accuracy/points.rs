//! Points of charts: a setting, what it costs, and what it gives.

use super::words::{chain_setting, contact_setting, way_name};
use crate::quantile::quantile;
use crate::report::axis::classifier_name;
use crate::study::speed_accuracy::table::{PeerRow, SpeedAccuracyTables};
use crate::study::{Choice, unbeaten};
use serde::{Deserialize, Serialize};

/// Which chart a point is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChartKind {
    /// Deflection error (mm, less is better) against the time of a touch.
    Contact,
    /// Share of right answers against the time of a decision.
    Decision,
    /// Share of right answers against the time of a training.
    Training,
    /// Half the width of an interval (less is better) against the processor time of a study.
    Resolution,
}

/// A point of a chart: a row of `pareto.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChartPoint {
    /// Which chart.
    pub chart: ChartKind,
    /// What has one colour in it.
    pub group: String,
    /// The setting in words, told apart within the chart.
    pub setting: String,
    /// Who measured: this run, or a program with version and date.
    pub source: String,
    /// Microseconds.
    pub cost_us: f64,
    /// Millimetres, a share, or half a width: see [`ChartKind`].
    pub value: f64,
    /// Lower end of its spread: quartiles over objects, or a 95 % interval; the value itself where there is none.
    pub value_low: f64,
    /// Upper end.
    pub value_high: f64,
    /// Whether no other point of the chart beats it: at most as dear, at least as good, and better in one of both. (Widths of different
    /// intervals do not compare: each group of that chart has a front of its own. Nor do touches of scans with those of objects.)
    pub on_front: bool,
}

impl ChartPoint {
    /// What it is compared within: its chart, and where groups do not compare, its group; what touched scans and what touched the study's
    /// objects do not either.
    pub fn front(&self) -> (ChartKind, String) {
        match self.chart {
            ChartKind::Resolution => (self.chart, self.group.clone()),
            _ if self.is_of_scans() => (self.chart, SCANS.to_owned()),
            _ => (self.chart, String::new()),
        }
    }

    /// Whether it is of meshes that were touched beside the study's objects.
    pub fn is_of_scans(&self) -> bool {
        self.chart == ChartKind::Contact && self.setting.contains(SCANS)
    }
}

const HERE: &str = "this run";
/// What a setting says that touched scans.
pub(super) const SCANS: &str = ", scans";

impl ChartKind {
    /// All, in the order of the files.
    pub const ALL: [Self; 4] = [
        Self::Contact,
        Self::Decision,
        Self::Training,
        Self::Resolution,
    ];

    /// Whether a larger value is better.
    pub fn more_is_better(self) -> bool {
        matches!(self, Self::Decision | Self::Training)
    }
}

/// Every point of every chart. Settings of which an object has no number (a method that diverged) have none.
pub fn points(tables: &SpeedAccuracyTables) -> Vec<ChartPoint> {
    let mut points = contact_points(tables);
    points.extend(peer_points(&tables.peers));
    points.extend(chain_points(tables, ChartKind::Decision));
    points.extend(chain_points(tables, ChartKind::Training));
    points.extend(resolution_points(tables));
    mark_fronts(&mut points);
    points
}

/// Says of each point whether another one beats it that it can be compared with.
fn mark_fronts(points: &mut [ChartPoint]) {
    let mut fronts: Vec<(ChartKind, String)> = Vec::new();
    let choices: Vec<Choice> = points
        .iter()
        .map(|point| Choice {
            level: {
                let front = point.front();
                let known = fronts.iter().position(|known| *known == front);
                if known.is_none() {
                    fronts.push(front);
                }
                known.unwrap_or(fronts.len() - 1) as f64
            },
            costs: match point.chart.more_is_better() {
                true => [point.cost_us, -point.value],
                false => [point.cost_us, point.value],
            },
        })
        .collect();
    for (point, on_front) in points.iter_mut().zip(unbeaten(&choices)) {
        point.on_front = on_front;
    }
}

/// One setting over several objects: medians, and the quartiles of the errors.
fn of_objects(
    (group, setting, source): (&str, String, String),
    errors_mm: &mut [f64],
    costs_us: &mut [f64],
) -> ChartPoint {
    ChartPoint {
        chart: ChartKind::Contact,
        group: group.to_owned(),
        setting,
        source,
        cost_us: quantile(costs_us, 0.5),
        value: quantile(errors_mm, 0.5),
        value_low: quantile(errors_mm, 0.25),
        value_high: quantile(errors_mm, 0.75),
        on_front: false,
    }
}

fn contact_points(tables: &SpeedAccuracyTables) -> Vec<ChartPoint> {
    let rows = || tables.contact.iter().zip(&tables.contact_timing);
    let mut settings: Vec<String> = rows().map(|((cell, _), _)| contact_setting(cell)).collect();
    keep_first(&mut settings);
    let point = |setting: String| {
        let of_it = rows().filter(|((cell, _), _)| contact_setting(cell) == setting);
        let of_it: Vec<_> = of_it.collect();
        let errors = of_it.iter().map(|((_, score), _)| score.error_mm);
        let mut errors = errors.collect::<Option<Vec<f64>>>()?;
        let mut costs: Vec<f64> = of_it.iter().map(|(_, (_, t))| t.us_per_touch).collect();
        let group = way_name(of_it[0].0.0.way);
        let named = (group, setting, HERE.to_owned());
        Some(of_objects(named, &mut errors, &mut costs))
    };
    settings.into_iter().filter_map(point).collect()
}

fn peer_points(rows: &[PeerRow]) -> Vec<ChartPoint> {
    // What the file says of ours was measured beside them; the chart has ours as this run measures it.
    let peers: Vec<&PeerRow> = rows
        .iter()
        .filter(|row| row.program != "bubbletouch")
        .collect();
    let key = |row: &PeerRow| {
        (
            row.program.clone(),
            row.version.clone(),
            row.method.clone(),
            row.setting.clone(),
        )
    };
    let mut keys: Vec<_> = peers.iter().map(|row| key(row)).collect();
    keep_first(&mut keys);
    let point = |wanted: (String, String, String, String)| {
        let of_it: Vec<_> = peers.iter().filter(|row| key(row) == wanted).collect();
        let mut errors: Vec<f64> = of_it.iter().map(|row| row.error_mm).collect();
        let mut costs: Vec<f64> = of_it.iter().map(|row| row.us_per_touch).collect();
        let last = of_it.iter().map(|row| row.date.as_str()).max();
        let (program, version, method, setting) = wanted;
        let source = format!("{program} {version}, {}", last.unwrap_or_default());
        let group = match method.as_str() {
            "mujoco_bodies" => "MuJoCo, taxels as bodies".to_owned(),
            "mujoco_tactile" => "MuJoCo, tactile sensor".to_owned(),
            _ => format!("{program}, {method}"),
        };
        let setting = format!("{group}, {setting}");
        of_objects((&group, setting, source), &mut errors, &mut costs)
    };
    keys.into_iter().map(point).collect()
}

fn chain_points(tables: &SpeedAccuracyTables, chart: ChartKind) -> Vec<ChartPoint> {
    let rows = tables.recognition.iter().zip(&tables.recognition_timing);
    let point = rows.map(|((cell, score), (_, time))| ChartPoint {
        chart,
        group: classifier_name(cell.classifier).to_owned(),
        setting: chain_setting(cell),
        source: HERE.to_owned(),
        cost_us: match chart {
            ChartKind::Training => 1e6 * time.fit_s,
            _ => time.decision_us,
        },
        value: score.accuracy,
        value_low: score.accuracy_low,
        value_high: score.accuracy_high,
        on_front: false,
    });
    point.collect()
}

fn resolution_points(tables: &SpeedAccuracyTables) -> Vec<ChartPoint> {
    let mut points = Vec::new();
    for ((size, found), (_, time)) in tables.resolution.iter().zip(&tables.resolution_timing) {
        let halves = [
            ("one accuracy", found.accuracy_half_width),
            ("a difference of two settings", found.difference_half_width),
        ];
        points.extend(halves.map(|(group, value)| ChartPoint {
            chart: ChartKind::Resolution,
            group: group.to_owned(),
            setting: format!(
                "{group}, {} touches an object, {} trials",
                size.touches, size.trials
            ),
            source: HERE.to_owned(),
            cost_us: 1e6 * time.cpu_s,
            value,
            value_low: value,
            value_high: value,
            on_front: false,
        }));
    }
    points
}

fn keep_first<T: PartialEq + Clone>(values: &mut Vec<T>) {
    let mut found: Vec<T> = Vec::new();
    values.retain(|value| {
        let is_new = !found.contains(value);
        if is_new {
            found.push(value.clone());
        }
        is_new
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(chart: ChartKind, cost_us: f64, value: f64) -> ChartPoint {
        ChartPoint {
            chart,
            group: String::new(),
            setting: String::new(),
            source: HERE.to_owned(),
            cost_us,
            value,
            value_low: value,
            value_high: value,
            on_front: false,
        }
    }

    #[test]
    fn fronts_are_of_one_chart_and_less_error_is_better() {
        let mut points = vec![
            point(ChartKind::Contact, 1.0, 0.5),
            point(ChartKind::Contact, 2.0, 0.5), // dearer, no better
            point(ChartKind::Contact, 3.0, 0.0),
            point(ChartKind::Decision, 5.0, 0.5),
            point(ChartKind::Decision, 5.0, 0.6),
            point(ChartKind::Decision, 9.0, 0.9),
        ];
        mark_fronts(&mut points);
        let on: Vec<bool> = points.iter().map(|point| point.on_front).collect();
        assert_eq!(on, [true, false, true, false, true, true]);
    }

    #[test]
    fn peers_are_medians_over_objects_and_our_own_rows_beside_them_are_left_out() {
        let row = |program: &str, object: &str, us, error| PeerRow {
            date: "2026-11-22".to_owned(),
            program: program.to_owned(),
            version: "4.0.0".to_owned(),
            method: "mujoco_tactile".to_owned(),
            setting: "octree depth 6".to_owned(),
            object: object.to_owned(),
            us_per_touch: us,
            error_mm: error,
        };
        let rows = [
            row("MuJoCo", "mug", 400.0, 0.1),
            row("bubbletouch", "mug", 5.0, 0.05),
            row("MuJoCo", "pear", 300.0, 0.3),
        ];
        let points = peer_points(&rows);
        assert_eq!(points.len(), 1);
        assert_eq!((points[0].cost_us, points[0].value), (350.0, 0.2));
        assert_eq!(points[0].source, "MuJoCo 4.0.0, 2026-11-22");
    }
}
