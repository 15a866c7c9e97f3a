//! Summary of the results over all objects, for each method and tolerance.

use crate::quantile::quantile;
use crate::studies::grouped;
use crate::studies::object_detail::rows::{
    DetailConfiguration, DetailScore, DetailSummary, DetailTime, LevelTime,
};
use crate::studies::object_detail::spec::DetailMethod;
use crate::studies::object_detail::variants::Level;

type Row = (DetailConfiguration, DetailScore);

fn level(configuration: &DetailConfiguration) -> Level {
    (configuration.method, configuration.tolerance_mm)
}

/// Returns one row for each method and tolerance, which summarises all objects, in the order of first occurrence.
pub(super) fn summary(rows: &[Row]) -> Vec<DetailSummary> {
    let levels = grouped(rows, |(configuration, _)| level(configuration)).into_iter();
    levels
        .map(|(level, of_level)| summary_row(level, &of_level, rows))
        .collect()
}

fn summary_row((method, tolerance_mm): Level, of_level: &[&Row], rows: &[Row]) -> DetailSummary {
    let quartiles = |value: &dyn Fn(&Row) -> f64| {
        let mut values: Vec<f64> = of_level.iter().map(|row| value(row)).collect();
        [0.25, 0.5, 0.75, 1.0].map(|part| quantile(&mut values, part))
    };
    let spheres = quartiles(&|(configuration, _)| configuration.n_spheres as f64);
    let surface = quartiles(&|(_, score)| score.surface_error_mm);
    let farthest = quartiles(&|(_, score)| score.protrusion_max_mm.max(score.gap_max_mm));
    let error = quartiles(&|(_, score)| score.error_mm);
    let after = quartiles(&|(_, score)| score.error_after_offset_mm);
    let own = quartiles(&|(_, score)| score.error_own_contact_mm);
    let ratios = of_level.iter().filter_map(|(configuration, score)| {
        let packing = rows.iter().find(|(other, _)| {
            other.object == configuration.object
                && level(other) == (DetailMethod::Packing, tolerance_mm)
        })?;
        Some(score.error_after_offset_mm / packing.1.error_after_offset_mm)
    });
    let mut ratios: Vec<f64> = ratios.collect();
    DetailSummary {
        method,
        tolerance_mm,
        n_objects: of_level.len(),
        n_spheres_q1: spheres[0],
        n_spheres_median: spheres[1],
        n_spheres_q3: spheres[2],
        surface_error_q1_mm: surface[0],
        surface_error_median_mm: surface[1],
        surface_error_q3_mm: surface[2],
        surface_error_max_q1_mm: farthest[0],
        surface_error_max_median_mm: farthest[1],
        surface_error_max_q3_mm: farthest[2],
        error_q1_mm: error[0],
        error_median_mm: error[1],
        error_q3_mm: error[2],
        error_worst_mm: error[3],
        error_after_offset_q1_mm: after[0],
        error_after_offset_median_mm: after[1],
        error_after_offset_q3_mm: after[2],
        error_after_offset_worst_mm: after[3],
        error_own_contact_median_mm: own[1],
        error_own_contact_worst_mm: own[3],
        times_packing: (!ratios.is_empty()).then(|| quantile(&mut ratios, 0.5)),
    }
}

/// Returns the computing time per touch for each method and tolerance.
pub(super) fn costs(
    summary: &[DetailSummary],
    timing: &[(DetailConfiguration, DetailTime)],
) -> Vec<(DetailSummary, LevelTime)> {
    let cost = |row: &DetailSummary| {
        let of_level = (row.method, row.tolerance_mm);
        let times = timing
            .iter()
            .filter(|(configuration, _)| level(configuration) == of_level);
        let mut times: Vec<f64> = times.map(|(_, time)| time.us_per_touch).collect();
        let us_per_touch_median = quantile(&mut times, 0.5);
        (
            row.clone(),
            LevelTime {
                us_per_touch_median,
            },
        )
    };
    summary.iter().map(cost).collect()
}
