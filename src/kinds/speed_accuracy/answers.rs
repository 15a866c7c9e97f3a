//! What was found, in sentences: the two ends of each front.

use super::plan::SpeedAccuracyPlan;
use super::rows::{ChainCell, ChainPoint, ContactPoint, Touched};
use super::study::{CHAINS, CONTACT};
use crate::kinds::rows_of;
use crate::study::advice::cost_in_words;
use crate::table::Table;

/// The fastest and the best of contact, of decisions and of trainings, and what was left out.
pub(super) fn answers(plan: &SpeedAccuracyPlan, tables: &[Table]) -> Vec<String> {
    let contact: Vec<ContactPoint> = rows_of(tables, CONTACT[2].0);
    let of_objects = contact
        .iter()
        .filter(|point| point.touched == Touched::Object);
    let of_objects: Vec<&ContactPoint> = of_objects.collect();
    let fronts = of_objects
        .iter()
        .filter(|point| point.on_front)
        .map(|point| {
            let error = match point.error_mm {
                0.0 => "no error".to_owned(),
                mm => format!("{} mm", two_digits(mm)),
            };
            (point.us_per_touch, point.words(), error)
        });
    let about = format!(
        "Contact, from the fastest to the most accurate of {} settings",
        of_objects.len()
    );
    let mut said: Vec<String> = ends(&about, fronts.collect()).into_iter().collect();
    let cells: Vec<ChainCell> = rows_of(tables, CHAINS[2].0);
    let points: Vec<ChainPoint> = rows_of(tables, CHAINS[2].0);
    let chains: Vec<_> = cells.iter().zip(&points).collect();
    let front_of = |is_on: fn(&ChainPoint) -> bool, cost_us: fn(&ChainPoint) -> f64| {
        let front = chains.iter().filter(|(_, point)| is_on(point));
        let front = front.map(|(cell, point)| {
            let ChainPoint {
                accuracy,
                accuracy_low,
                accuracy_high,
                ..
            } = point;
            let accuracy = format!("{accuracy:.3} ({accuracy_low:.3} to {accuracy_high:.3})");
            (cost_us(point), cell.words(), accuracy)
        });
        front.collect()
    };
    let n = chains.len();
    let decisions = front_of(|point| point.on_decision_front, |point| point.decision_us);
    let about = format!("Decisions, from the fastest to the best of {n} settings");
    said.extend(ends(&about, decisions));
    let trainings = front_of(|point| point.on_training_front, |point| 1e6 * point.fit_s);
    let about = format!("Training, from the fastest to the best of {n} settings");
    said.extend(ends(&about, trainings));
    said.extend(missing(plan));
    said
}

/// What the study names and is not there.
fn missing(plan: &SpeedAccuracyPlan) -> Vec<String> {
    let peers = plan.peers.as_ref().filter(|path| !path.exists());
    let peers =
        peers.map(|path| format!("Without other programs: there is no {}.", path.display()));
    let scans = plan.scans().filter(|scans| !scans.meshes.is_dir());
    let scans = scans.map(|scans| {
        let folder = scans.meshes.display();
        format!("Without scans: there is no folder {folder}; --objects names one.")
    });
    peers.into_iter().chain(scans).collect()
}

/// The ends of a front of microseconds, settings and what they give.
fn ends(about: &str, mut front: Vec<(f64, String, String)>) -> Option<String> {
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let end = |(us, setting, value): &(f64, String, String)| {
        format!("{setting} ({value} at {})", cost_in_words(*us))
    };
    Some(format!(
        "{about}: {} … {}.",
        end(front.first()?),
        end(front.last()?)
    ))
}

/// Millimetres with two digits that say something.
fn two_digits(value: f64) -> String {
    let digits = (1.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}
