//! Settings with what they cost and what they give, and which of them nothing beats.

use super::models::ContactRow;
use super::rows::{
    ChainCell, ChainPoint, ChainScore, ChainTime, ContactCell, ContactPoint, PeerRow,
    ResolutionPoint, Resolved, ResolvedBy, StudySize, StudyTime, Touched,
};
use crate::quantile::quantile;
use crate::table::front;

/// Of every way to evaluate contact, medians over objects; each set of objects has a front of its own.
pub(super) fn contact_points(rows: &[ContactRow], peers: &[PeerRow]) -> Vec<ContactPoint> {
    let setting = |cell: &ContactCell| (cell.way, cell.tolerance_mm, cell.dt_ms, cell.touched);
    let ours = by_key(rows, |(cell, ..)| setting(cell))
        .into_iter()
        .filter_map(|of_it| {
            let cell = &of_it[0].0;
            let errors = of_it.iter().map(|(_, score, _)| score.error_mm);
            let named = ContactPoint {
                way: cell.way.words().to_owned(),
                tolerance_mm: cell.tolerance_mm,
                dt_ms: cell.dt_ms,
                setting: None,
                source: HERE.to_owned(),
                touched: cell.touched,
                ..NOTHING
            };
            let costs = of_it.iter().map(|(.., time)| time.us_per_touch);
            Some(over_objects(
                named,
                errors.collect::<Option<_>>()?,
                costs.collect(),
            ))
        });
    let mut points: Vec<ContactPoint> = ours.collect();
    points.extend(peer_points(peers));
    for touched in [Touched::Object, Touched::Scan] {
        let of_them = points.iter_mut().filter(|point| point.touched == touched);
        mark_front(
            &mut of_them.collect::<Vec<_>>(),
            |point| (point.us_per_touch, point.error_mm),
            |a, b| a < b,
            |point| &mut point.on_front,
        );
    }
    points
}

const HERE: &str = "this run";

/// A point of which nothing is known.
const NOTHING: ContactPoint = ContactPoint {
    way: String::new(),
    tolerance_mm: None,
    dt_ms: None,
    setting: None,
    source: String::new(),
    touched: Touched::Object,
    us_per_touch: f64::NAN,
    error_mm: f64::NAN,
    error_q1_mm: f64::NAN,
    error_q3_mm: f64::NAN,
    on_front: false,
};

/// What the file says of ours was measured beside them; the table has ours as this run measures it.
fn peer_points(rows: &[PeerRow]) -> Vec<ContactPoint> {
    let of_others = rows.iter().filter(|row| row.program != "bubbletouch");
    let of_others: Vec<PeerRow> = of_others.cloned().collect();
    let key = |row: &PeerRow| {
        let PeerRow {
            program,
            version,
            method,
            ..
        } = row.clone();
        (program, version, method, row.setting.clone())
    };
    let points = by_key(&of_others, key).into_iter().map(|of_it| {
        let last = of_it.iter().map(|row| row.date.as_str()).max();
        let PeerRow {
            program, version, ..
        } = of_it[0];
        let named = ContactPoint {
            way: match of_it[0].method.as_str() {
                "mujoco_bodies" => "MuJoCo, taxels as bodies".to_owned(),
                "mujoco_tactile" => "MuJoCo, tactile sensor".to_owned(),
                method => format!("{program}, {method}"),
            },
            setting: Some(of_it[0].setting.clone()),
            source: format!("{program} {version}, {}", last.unwrap_or_default()),
            ..NOTHING
        };
        let errors = of_it.iter().map(|row| row.error_mm).collect();
        over_objects(
            named,
            errors,
            of_it.iter().map(|row| row.us_per_touch).collect(),
        )
    });
    points.collect()
}

/// A setting over several objects: medians, and the quartiles of the errors.
fn over_objects(point: ContactPoint, mut errors: Vec<f64>, mut costs: Vec<f64>) -> ContactPoint {
    ContactPoint {
        us_per_touch: quantile(&mut costs, 0.5),
        error_mm: quantile(&mut errors, 0.5),
        error_q1_mm: quantile(&mut errors, 0.25),
        error_q3_mm: quantile(&mut errors, 0.75),
        ..point
    }
}

/// Every chain, with both fronts.
pub(super) fn chain_points(
    rows: &[(ChainCell, ChainScore, ChainTime)],
) -> Vec<(ChainCell, ChainPoint)> {
    let points = rows.iter().map(|(cell, score, time)| {
        let point = ChainPoint {
            decision_us: time.decision_us,
            fit_s: time.fit_s,
            accuracy: score.accuracy,
            accuracy_low: score.accuracy_low,
            accuracy_high: score.accuracy_high,
            on_decision_front: false,
            on_training_front: false,
        };
        (cell.clone(), point)
    });
    let mut points: Vec<_> = points.collect();
    let mut all: Vec<&mut ChainPoint> = points.iter_mut().map(|(_, point)| point).collect();
    mark_front(
        &mut all,
        |point| (point.decision_us, point.accuracy),
        |a, b| a > b,
        |point| &mut point.on_decision_front,
    );
    mark_front(
        &mut all,
        |point| (point.fit_s, point.accuracy),
        |a, b| a > b,
        |point| &mut point.on_training_front,
    );
    points
}

/// Every size of study by both intervals.
pub(super) fn resolution_points(
    rows: &[(StudySize, Resolved, StudyTime)],
) -> Vec<(StudySize, ResolutionPoint)> {
    let kinds = [ResolvedBy::OneAccuracy, ResolvedBy::Difference];
    let points = rows.iter().flat_map(|(size, found, time)| {
        kinds.map(|interval| {
            let point = ResolutionPoint {
                interval,
                cpu_s: time.cpu_s,
                half_width: match interval {
                    ResolvedBy::OneAccuracy => found.accuracy_half_width,
                    ResolvedBy::Difference => found.difference_half_width,
                },
                on_front: false,
            };
            (size.clone(), point)
        })
    });
    let mut points: Vec<_> = points.collect();
    for interval in kinds {
        let of_it = points.iter_mut().map(|(_, point)| point);
        let of_it = of_it.filter(|point| point.interval == interval);
        mark_front(
            &mut of_it.collect::<Vec<_>>(),
            |point| (point.cpu_s, point.half_width),
            |a, b| a < b,
            |point| &mut point.on_front,
        );
    }
    points
}

/// Says of each point whether nothing beats it.
fn mark_front<P>(
    points: &mut [&mut P],
    cost_and_value: impl Fn(&P) -> (f64, f64),
    is_better: impl Fn(f64, f64) -> bool,
    mark: impl Fn(&mut P) -> &mut bool,
) {
    let places: Vec<(f64, f64)> = points.iter().map(|point| cost_and_value(point)).collect();
    for (point, on_front) in points.iter_mut().zip(front(&places, is_better)) {
        *mark(point) = on_front;
    }
}

/// Things of the same key together, keys in the order of their first.
fn by_key<T, K: PartialEq>(things: &[T], key: impl Fn(&T) -> K) -> Vec<Vec<&T>> {
    let mut groups: Vec<(K, Vec<&T>)> = Vec::new();
    for thing in things {
        let of_it = key(thing);
        match groups.iter_mut().find(|(known, _)| *known == of_it) {
            Some((_, group)) => group.push(thing),
            None => groups.push((of_it, vec![thing])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let points = contact_points(&[], &rows);
        assert_eq!(points.len(), 1);
        assert_eq!((points[0].us_per_touch, points[0].error_mm), (350.0, 0.2));
        assert_eq!(points[0].source, "MuJoCo 4.0.0, 2026-11-22");
        assert!(points[0].on_front);
    }
}
