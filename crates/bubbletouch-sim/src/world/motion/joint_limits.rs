//! Check that joints stay within their limits at all times.

use super::curve::{Curve, Extremes, Taken};
use super::way_points::WayPoints;
use crate::error::{Error, Result};
use crate::world::Robot;
use crate::world::robot::{Dimension, Limits};

/// Amount by which a joint may exceed its limits: rad or m for positions, rad/s or m/s for velocities. Files write limits with six digits, so a quarter turn
/// may be 3e-7 beyond 1.570796. If larger, visible violations are accepted; if smaller, rounded limits are refused.
const SLACK: f64 = 1e-6;

/// Checks the limits of all joints that have one coordinate; `curves` are the robot's positions over time. Returns a note for each mimicking joint that
/// leaves its own limits, because a mimicking joint follows its `<mimic>`. Joints that stay at their default position are not checked, because MuJoCo's `qpos0`
/// can be outside the range.
///
/// # Errors
/// If a joint that mimics no other joint leaves its limits; the error contains the first such joint and its largest violation.
pub(super) fn check_limits(
    robot: &Robot,
    curves: &[Curve],
    way_points: &WayPoints,
) -> Result<Vec<String>> {
    let mut notes = Vec::new();
    let rest = robot.rest_positions();
    for (index, joint) in robot.joints().iter().enumerate() {
        let (Some(limits), Some(drive)) = (joint.limits, robot.drive_of(index)) else {
            continue;
        };
        let (position, multiplier, offset) = drive;
        let extremes = curves[position].extremes(&way_points.times);
        let ends = [extremes.lowest, extremes.highest].map(|taken| taken.value);
        if joint.mimic.is_none() && ends == [rest[position]; 2] {
            continue;
        }
        let moved = extremes.driven(multiplier, offset);
        let unit = joint.kind.coordinates()[0].1;
        if let Some((taken, given, allowed)) = first_beyond(&moved, &limits, unit) {
            let beyond = Error::input(
                format!("{}: joint `{}`", way_points.origin.place(), joint.name),
                format!("{given} at {}", when(&taken, way_points)),
                allowed,
            );
            let Some(mimic) = joint.mimic else {
                return Err(beyond);
            };
            let followed = &robot.joints()[mimic.joint].name;
            notes.push(format!(
                "{beyond}: it mimics `{followed}`, whatever its own limits"
            ));
        }
    }
    Ok(notes)
}

/// Returns the largest violation of the first limit that a joint exceeds, with descriptions of the joint's motion and of the allowed range. Returns `None` if
/// there is no violation.
fn first_beyond(
    extremes: &Extremes,
    limits: &Limits,
    unit: Dimension,
) -> Option<(Taken, String, String)> {
    let Extremes {
        lowest,
        highest,
        fastest,
    } = *extremes;
    let at = |value| position(value, unit);
    let speed = |value: f64| format!("{value:.6} {}/s", unit.unit());
    if lowest.value < limits.lower - SLACK {
        let allowed = format!("at least {}", at(limits.lower));
        Some((lowest, at(lowest.value), allowed))
    } else if highest.value > limits.upper + SLACK {
        let allowed = format!("at most {}", at(limits.upper));
        Some((highest, at(highest.value), allowed))
    } else if fastest.value.abs() > limits.velocity + SLACK {
        let given = format!("velocity {}", speed(fastest.value));
        let allowed = format!("at most {}", speed(limits.velocity));
        Some((fastest, given, allowed))
    } else {
        None
    }
}

impl Extremes {
    /// Returns the extremes of a joint whose position is `multiplier` times the curve plus `offset`.
    fn driven(self, multiplier: f64, offset: f64) -> Self {
        let moved = |taken: Taken| Taken {
            value: multiplier * taken.value + offset,
            ..taken
        };
        let (lowest, highest) = match multiplier < 0.0 {
            true => (self.highest, self.lowest),
            false => (self.lowest, self.highest),
        };
        Self {
            lowest: moved(lowest),
            highest: moved(highest),
            fastest: Taken {
                value: multiplier * self.fastest.value,
                ..self.fastest
            },
        }
    }
}

/// Describes the time at which a value occurs, and the adjacent waypoints.
fn when(taken: &Taken, way_points: &WayPoints) -> String {
    let (times, origin) = (&way_points.times, &way_points.origin);
    let time = format!("{:.4} s", taken.time);
    match times.iter().position(|&time| time == taken.time) {
        Some(at) => format!("{time} ({})", origin.way_point(at)),
        None => {
            let [before, after] = [0, 1].map(|next| origin.way_point(taken.piece + next));
            format!("{time} (between {before} and {after})")
        }
    }
}

fn position(value: f64, unit: Dimension) -> String {
    match unit {
        Dimension::Angle => format!("{value:.6} rad ({:.2}°)", value.to_degrees()),
        Dimension::Length => format!("{value:.6} m"),
    }
}
