//! What a body was asked to do, and what it does.

use super::table::{Bar, BodyCase, BodyCount, BodyTime, Series, Stage, WholeBodyTables};
use crate::whole_body::WORTH_THREADS;

/// Taxels from which on the step must not grow with the skin.
const LARGE_SKIN: usize = 100_000;
/// Touched taxels from which on the growth with the touch is fitted: below, what a step costs at all outweighs it.
const LARGE_TOUCH: f64 = 1_000.0;
/// Taxels of a body, and those of it that are touched, whose answer must be there within the millisecond.
const WHOLE_BODY: usize = 1_900_000;
const WHOLE_TOUCH: f64 = 9_000.0;

/// A case, what happened, and the median time of its press, µs.
type Pressed<'a> = (&'a BodyCase, &'a BodyCount, f64);

/// The bars of which everything was measured.
pub(super) fn bars(tables: &WholeBodyTables) -> Vec<Bar> {
    let pressed = pressed(tables);
    let of = |series: Series| -> Vec<Pressed> {
        let cases = pressed.iter().filter(|(case, ..)| case.series == series);
        cases.copied().collect()
    };
    let mut bars = Vec::new();
    bars.extend(growth_with_skin(&of(Series::Skin)));
    bars.extend(growth_with_touch(&of(Series::Touch)));
    for (case, count, us) in of(Series::Spheres) {
        let least = match case.n_spheres {
            1_000 => 5_000.0,
            10_000 => 2_000.0,
            _ => continue,
        };
        let what = format!(
            "steps with {} spheres, {:.0} of {} taxels touched",
            case.n_spheres, count.touched_mean, case.n_taxels
        );
        bars.push(at_least(what, 1e6 / us, "steps/s", least));
    }
    let untouched = pressed
        .iter()
        .filter(|(_, count, _)| count.touched_max == 0);
    for (case, _, us) in untouched {
        let what = format!("steps with nothing touched of {} taxels", case.n_taxels);
        bars.push(at_least(what, 1e6 / us, "steps/s", 100_000.0));
    }
    bars.extend(answers(tables));
    bars.extend(threads(tables));
    let bytes = tables.cases.iter().map(|(_, count)| count.bytes_per_taxel);
    if let Some(most) = bytes.reduce(f64::max) {
        let what = "memory of a body at rest".to_owned();
        bars.push(at_most(what, most, "bytes a taxel", 64.0));
    }
    bars
}

fn pressed(tables: &WholeBodyTables) -> Vec<Pressed<'_>> {
    let presses = tables.timing.iter();
    let mut presses = presses.filter(|(_, time)| time.stage == Stage::Press);
    tables
        .cases
        .iter()
        .filter_map(|(case, count)| {
            let (_, time) = presses.find(|(of, _)| of == case)?;
            Some((case, count, time.us_median))
        })
        .collect()
}

/// Of the largest touch that was measured on several large skins: the time on the largest over that on the smallest.
fn growth_with_skin(rungs: &[Pressed]) -> Option<Bar> {
    let large: Vec<&Pressed> = rungs
        .iter()
        .filter(|(case, ..)| case.n_taxels >= LARGE_SKIN * 9 / 10)
        .collect();
    let (_, most, _) = large.last()?;
    let same = large
        .iter()
        .filter(|(_, count, _)| (count.touched_mean / most.touched_mean - 1.0).abs() < 0.05);
    let same: Vec<_> = same.collect();
    let (first, last) = (same.first()?, same.last()?);
    let what = format!(
        "time of a step from {} to {} taxels, {:.0} touched",
        first.0.n_taxels, last.0.n_taxels, last.1.touched_mean
    );
    (last.0.n_taxels > first.0.n_taxels).then(|| at_most(what, last.2 / first.2, "times", 1.2))
}

/// The exponent of the time in the touched taxels.
fn growth_with_touch(rungs: &[Pressed]) -> Option<Bar> {
    let points: Vec<(f64, f64)> = rungs
        .iter()
        .filter(|(_, count, _)| count.touched_mean >= 0.9 * LARGE_TOUCH)
        .map(|(_, count, us)| (count.touched_mean.ln(), us.ln()))
        .collect();
    let what = format!("exponent of the time in touched taxels, from {LARGE_TOUCH} on");
    (points.len() > 1).then(|| at_most(what, slope(&points), "", 1.05))
}

/// The way from touch to answer, of each compression where it takes longest.
fn answers(tables: &WholeBodyTables) -> Vec<Bar> {
    let is_whole = |case: &BodyCase, time: &BodyTime| {
        let touched = tables.cases.iter().find(|(of, _)| of == case);
        time.stage == Stage::Whole
            && case.n_taxels >= WHOLE_BODY
            && touched.is_some_and(|(_, count)| count.touched_mean >= WHOLE_TOUCH)
    };
    let rows = tables.timing.iter();
    rows.filter(|(case, time)| is_whole(case, time))
        .map(|(case, time)| {
            let what = format!(
                "{}: press, compress ({}), classify",
                case.name, time.compression
            );
            at_most(what, 1e-3 * time.us_median, "ms", 1.0)
        })
        .collect()
}

/// Where a touch is small: the time with all threads over that with one. Both go the same way, so that single ratios tell what else
/// the machine did; the median tells whether threads cost anything.
fn threads(tables: &WholeBodyTables) -> Option<Bar> {
    let small = |case: &BodyCase| {
        let count = tables.cases.iter().find(|(of, _)| of == case);
        count.is_some_and(|(_, count)| count.touched_max < WORTH_THREADS)
    };
    let presses: Vec<_> = tables
        .timing
        .iter()
        .filter(|(case, time)| time.stage == Stage::Press && small(case))
        .collect();
    let mut ratios: Vec<f64> = presses
        .iter()
        .filter(|(_, time)| time.n_threads > 1)
        .filter_map(|(case, all)| {
            let is_it = |(of, time): &&&(BodyCase, BodyTime)| of == case && time.n_threads == 1;
            let (_, alone) = presses.iter().find(is_it)?;
            Some(all.us_median / alone.us_median)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let worst = *ratios.last()?;
    let what = format!(
        "time with all threads over that with one, median of {} small touches (worst: {worst:.2})",
        ratios.len()
    );
    Some(at_most(what, ratios[ratios.len() / 2], "times", 1.1))
}

/// Of the line through points that leaves the least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let rise: f64 = points
        .iter()
        .map(|point| (point.0 - x) * (point.1 - y))
        .sum();
    let run: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    rise / run
}

fn at_least(what: String, measured: f64, unit: &str, bar: f64) -> Bar {
    let unit = unit.to_owned();
    Bar {
        is_met: measured >= bar,
        at_least: true,
        what,
        measured,
        unit,
        bar,
    }
}

fn at_most(what: String, measured: f64, unit: &str, bar: f64) -> Bar {
    let unit = unit.to_owned();
    Bar {
        is_met: measured <= bar,
        at_least: false,
        what,
        measured,
        unit,
        bar,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_power_law_is_its_exponent() {
        let points = [1.0_f64, 3.0, 10.0, 40.0].map(|x| (x.ln(), (2.5 * x.powf(1.7)).ln()));
        assert!((slope(&points) - 1.7).abs() < 1e-12);
    }
}
