//! Ways to evaluate contact over all objects: what each costs, and how wrong it is.

use super::models::ContactRow;
use super::rows::{ContactPoint, ContactWay, PeerRow};
use crate::kinds::grouped;
use crate::quantile::quantile;

/// Medians over objects of every way to evaluate contact, and of those of other programs.
pub(super) fn contact_points(rows: &[ContactRow], peers: &[PeerRow]) -> Vec<ContactPoint> {
    let ours = grouped(rows, |(cell, ..)| ContactPoint {
        way: cell.way.words().to_owned(),
        tolerance_mm: cell.tolerance_mm,
        dt_ms: cell.dt_ms,
        source: "this run".to_owned(),
        touched: cell.touched,
        ..ContactPoint::default()
    });
    let ours = ours.into_iter().filter_map(|(setting, rows)| {
        let errors = rows.iter().map(|(_, score, _)| score.error_mm);
        let costs = rows.iter().map(|(.., time)| time.us_per_touch).collect();
        Some(over_objects(setting, errors.collect::<Option<_>>()?, costs))
    });
    // What the file says of ours was measured beside them; the table has ours as this run measures it.
    let others = peers.iter().filter(|row| row.program != "bubbletouch");
    let others = grouped(others, |row| ContactPoint {
        way: match row.method.as_str() {
            "mujoco_bodies" => "MuJoCo, taxels as bodies".to_owned(),
            "mujoco_tactile" => "MuJoCo, tactile sensor".to_owned(),
            method => format!("{}, {method}", row.program),
        },
        setting: Some(row.setting.clone()),
        source: format!("{} {}", row.program, row.version),
        ..ContactPoint::default()
    });
    let others = others.into_iter().map(|(setting, rows)| {
        let last = rows.iter().map(|row| row.date.as_str()).max();
        let dated = ContactPoint {
            source: format!("{}, {}", setting.source, last.unwrap_or_default()),
            ..setting
        };
        let errors = rows.iter().map(|row| row.error_mm).collect();
        let costs = rows.iter().map(|row| row.us_per_touch).collect();
        over_objects(dated, errors, costs)
    });
    ours.chain(others).collect()
}

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

/// A setting over several objects: medians, and the quartiles of the errors.
fn over_objects(setting: ContactPoint, mut errors: Vec<f64>, mut costs: Vec<f64>) -> ContactPoint {
    ContactPoint {
        us_per_touch: quantile(&mut costs, 0.5),
        error_mm: quantile(&mut errors, 0.5),
        error_q1_mm: quantile(&mut errors, 0.25),
        error_q3_mm: quantile(&mut errors, 0.75),
        ..setting
    }
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
