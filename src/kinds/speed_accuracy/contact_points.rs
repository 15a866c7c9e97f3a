//! Ways to evaluate contact over all objects: what each costs, and how wrong it is.

use super::models::ContactRow;
use super::rows::{ContactCell, ContactPoint, ContactWay, PeerRow, Touched};
use crate::quantile::quantile;

/// Medians over objects of every way to evaluate contact, and of those of other programs.
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
    points
}

const HERE: &str = "this run";

impl ContactWay {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::PackedSpheres => "packed spheres",
            Self::VertexSpheres => "a sphere a vertex",
            Self::ExactMesh => "mesh, exact",
            Self::SolidMarching => "solid, exact",
            Self::TimeSteps => "quasi-static, stepped",
            Self::SemiImplicit => "semi-implicit Euler",
            Self::ImplicitEuler => "implicit Euler",
            Self::Rapier => "rapier, tuned",
            Self::RowsInDoubles => "flat rows in doubles, pose given",
            Self::RowsInSingles => "flat rows in singles, pose given",
        }
    }
}

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
    }
}
