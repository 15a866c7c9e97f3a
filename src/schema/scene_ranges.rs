//! Allowed numbers of the keys of a scene file, from which its JSON Schema is built.
//!
//! [`ScenePlan`](crate::scene::ScenePlan) checks the numbers where it uses them; a test compares both.

use crate::inputs::range::{not_negative, positive};

/// Type of functions that return whether a key allows a number.
type Allowed = fn(f64) -> bool;

const COUNT: Allowed = |number| number >= 1.0;

/// Allowed numbers of each key of a scene file, by key path.
pub(super) const RANGES: &[(&str, Allowed)] = &[
    ("dt_ms", positive),
    ("output_hz", positive),
    ("duration_s", not_negative),
    ("robots.motion.phases.duration_s", not_negative),
    ("objects.motion.phases.duration_s", not_negative),
    ("objects.surface_error_mm", positive),
    ("objects.free.mass_kg", positive),
    ("objects.press.force_n", not_negative),
    ("objects.press.speed_mm_per_s", positive),
    ("objects.press.travel_mm", positive),
    ("patches.layout.grid.nx", COUNT),
    ("patches.layout.grid.ny", COUNT),
    ("patches.layout.grid.pitch_mm", positive),
    ("patches.layout.hexagonal.nx", COUNT),
    ("patches.layout.hexagonal.ny", COUNT),
    ("patches.layout.hexagonal.pitch_mm", positive),
    ("patches.layout.disc.radius_mm", positive),
    ("patches.layout.disc.pitch_mm", positive),
    ("patches.layout.annulus.inner_mm", positive),
    ("patches.layout.annulus.outer_mm", positive),
    ("patches.layout.annulus.pitch_mm", positive),
    ("patches.layout.cylinder.radius_mm", positive),
    ("patches.layout.cylinder.length_mm", not_negative),
    ("patches.layout.cylinder.arc_deg", |deg| {
        deg > 0.0 && deg <= 360.0
    }),
    ("patches.layout.cylinder.pitch_mm", positive),
    ("patches.layout.sphere_cap.radius_mm", positive),
    ("patches.layout.sphere_cap.half_angle_deg", |deg| {
        deg > 0.0 && deg <= 180.0
    }),
    ("patches.layout.sphere_cap.pitch_mm", positive),
    ("patches.layout.draped.pitch_mm", positive),
    ("patches.layout.draped.grid.nx", COUNT),
    ("patches.layout.draped.grid.ny", COUNT),
    ("patches.taxel_radius_mm", positive),
    ("patches.stroke_mm", positive),
    ("patches.stiffness_n_per_m", positive),
    ("patches.damping_n_s_per_m", not_negative),
    ("patches.friction", not_negative),
    ("patches.shear_stiffness_n_per_m", positive),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ScenePlan, SceneSpec};
    use toml::Value;

    /// Test scenes that together contain every key with an allowed range; all their numbers are allowed.
    const SCENES: [&str; 3] = [
        r#"title = "a"
dt_ms = 1.0
output_hz = 10.0
duration_s = 0.1
robots = [{ name = "r", floating = true, motion = { phases = [{ duration_s = 0.1 }] } }]
[[patches]]
name = "p"
robot = "r"
layout = { grid = { nx = 4, ny = 4, pitch_mm = 2.0 } }
taxel_radius_mm = 1.0
stroke_mm = 2.0
stiffness_n_per_m = 100.0
damping_n_s_per_m = 0.0
friction = 0.5
shear_stiffness_n_per_m = 50.0
[[objects]]
name = "o"
object = "golf"
surface_error_mm = 0.5
at.position_mm = [0.0, 0.0, 40.0]
motion = { phases = [{ duration_s = 0.1 }] }
press = { patch = "p", direction = [0.0, 0.0, -1.0], force_n = 1.0, speed_mm_per_s = 1.0, travel_mm = 1.0 }
"#,
        r#"title = "b"
duration_s = 0.1
[[patches]]
name = "a"
stroke_mm = 1.0
layout = { hexagonal = { nx = 3, ny = 3, pitch_mm = 2.0 } }
[[objects]]
name = "o"
object = "golf"
at.position_mm = [0.0, 0.0, 40.0]
free = { mass_kg = 0.1 }
"#,
        r#"title = "c"
duration_s = 0.1
patches = [
    { name = "a", stroke_mm = 1.0, layout = { disc = { radius_mm = 5.0, pitch_mm = 2.0 } } },
    { name = "b", stroke_mm = 1.0, layout = { annulus = { inner_mm = 5.0, outer_mm = 9.0, pitch_mm = 2.0 } } },
    { name = "c", stroke_mm = 1.0, layout = { cylinder = { radius_mm = 20.0, length_mm = 9.0, arc_deg = 90.0, pitch_mm = 2.0 } } },
    { name = "d", stroke_mm = 1.0, layout = { sphere_cap = { radius_mm = 20.0, half_angle_deg = 30.0, pitch_mm = 2.0 } } },
]
"#,
    ];

    /// Returns the value at a dotted path of keys; in a list, the first entry that contains the path is used.
    fn at<'v>(value: &'v mut Value, path: &str) -> Option<&'v mut Value> {
        if let Value::Array(values) = value {
            return values.iter_mut().find_map(|value| at(value, path));
        }
        match path.split_once('.') {
            None => value.get_mut(path),
            Some((name, rest)) => at(value.get_mut(name)?, rest),
        }
    }

    #[test]
    fn the_plan_refuses_numbers_out_of_range_and_accepts_the_others() {
        let plan = |scene: &Value| {
            let text = toml::to_string(scene).unwrap();
            let spec = SceneSpec::parse("s.toml", &text)?;
            ScenePlan::new("s.toml", std::path::Path::new(""), spec)
        };
        for (path, is_allowed) in RANGES.iter().filter(|(path, _)| !path.contains("draped")) {
            let mut is_known = false;
            for text in SCENES {
                let scene = Value::Table(text.parse().unwrap());
                plan(&scene).unwrap();
                for number in [-1.0, 0.0] {
                    let mut scene = scene.clone();
                    let Some(key) = at(&mut scene, path) else {
                        continue;
                    };
                    is_known = true;
                    *key = match key.is_integer() {
                        true => Value::Integer(number as i64),
                        false => Value::Float(number),
                    };
                    assert_eq!(
                        plan(&scene).is_ok(),
                        is_allowed(number),
                        "{path} = {number}"
                    );
                }
            }
            assert!(is_known, "{path}");
        }
    }
}
