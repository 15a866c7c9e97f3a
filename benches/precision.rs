//! Accuracy and speed of a press in single precision compared with double precision, on one core.
//!
//! `cargo bench --bench precision` prints a table. With `-- --write`, the table is also written to `results/whole_body/precision.csv`, and a chart to
//! `precision.svg` beside it.
//!
//! Single and double precision use one kernel, `flat_press.rs`.

use bubbletouch::files::{CsvFile, write_bytes};
use bubbletouch::random::Seed;
use clock::seconds;
use flat_press::{press_f32, press_f64};
use precision_chart::draw;
use rand::Rng;
use serde::Serialize;
use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

mod clock;
mod flat_press;
mod precision_chart;

const PITCH: f64 = 2e-3;
/// Radius of the taxels, metres; included in S.
const RHO: f64 = 1e-3;
/// Number of spheres per touch.
const N_SPHERES: usize = 32;
/// Number of touches whose errors are evaluated; the first one is timed.
const N_TOUCHES: u64 = 20;
/// Minimum duration of each run; the time is the median over runs.
const LEAST: Duration = Duration::from_millis(5);
/// Radii of the spheres, metres.
const RADII: [f64; 7] = [2e-3, 1e-2, 4.5e-2, 0.1, 0.3, 1.0, 4.0];

/// Row of the result table.
#[derive(Serialize)]
pub struct Row {
    /// Number of taxels along a side of the patch.
    pub n: usize,
    /// Depth of the spheres: `light` (at most 3 mm) or `middle` (as deep as their centres).
    pub depth: &'static str,
    pub radius_m: f64,
    /// Number of touched taxels, averaged over touches.
    pub touched_mean: f64,
    pub f64_us: f64,
    pub f32_us: f64,
    /// Speed-up `f64_us / f32_us`.
    pub gain: f64,
    /// Largest deflection error over all touches and taxels, metres.
    pub error_max_m: f64,
    pub error_mean_m: f64,
}

/// Returns spheres of about the given radius at random positions over n × n taxels.
fn spheres(n: usize, radius: f64, is_light: bool, touch: u64) -> Vec<[f64; 4]> {
    let mut rng = Seed::new(11).named("precision").numbered(touch).rng();
    let half = 0.5 * PITCH * n as f64;
    let sphere = |_| {
        let s = RHO + radius * rng.gen_range(0.9..1.1);
        // A sphere as deep as its centre must not be deeper than the patch is wide.
        let height = match is_light {
            true => s - rng.gen_range(0.0..3e-3_f64.min(s)),
            false => rng.gen_range(-0.1..0.1) * s.min(half),
        };
        [
            rng.gen_range(-half..half),
            rng.gen_range(-half..half),
            height,
            s,
        ]
    };
    (0..N_SPHERES).map(sphere).collect()
}

fn measure(n: usize, radius: f64, is_light: bool, is_test: bool) -> Row {
    let places: Vec<f64> = (0..n)
        .map(|k| (k as f64 - 0.5 * (n - 1) as f64) * PITCH)
        .collect();
    let singles: Vec<f32> = places.iter().map(|&place| place as f32).collect();
    let (mut exact, mut rounded) = (vec![0.0; n * n], vec![0.0; n * n]);
    let (mut n_touched, mut most, mut sum) = (0, 0.0_f64, 0.0);
    for touch in 0..N_TOUCHES {
        let spheres = spheres(n, radius, is_light, touch);
        press_f64(&spheres, &places, &mut exact);
        press_f32(&spheres, &singles, &mut rounded);
        for (exact, rounded) in exact.iter().zip(&rounded) {
            let error = (exact - f64::from(*rounded)).abs();
            n_touched += usize::from(*exact > 0.0);
            most = most.max(error);
            sum += error;
        }
    }
    let spheres = spheres(n, radius, is_light, 0);
    let f64_us = 1e6
        * seconds(
            || press_f64(black_box(&spheres), &places, &mut exact),
            LEAST,
            is_test,
        );
    let f32_us = 1e6
        * seconds(
            || press_f32(black_box(&spheres), &singles, &mut rounded),
            LEAST,
            is_test,
        );
    Row {
        n,
        depth: if is_light { "light" } else { "middle" },
        radius_m: radius,
        touched_mean: n_touched as f64 / N_TOUCHES as f64,
        f64_us,
        f32_us,
        gain: f64_us / f32_us,
        error_max_m: most,
        error_mean_m: sum / n_touched.max(1) as f64,
    }
}

fn main() -> bubbletouch::Result<()> {
    let has = |flag: &str| std::env::args().any(|argument| argument == flag);
    // `cargo test --benches` and CI only check that the benchmark runs.
    let is_test = has("--test");
    println!("taxels  depth   radius m  touched    f64 us    f32 us  gain  largest error m");
    let mut rows = Vec::new();
    for n in if is_test { vec![64] } else { vec![64, 512] } {
        for is_light in [true, false] {
            for radius in RADII {
                let row = measure(n, radius, is_light, is_test);
                println!(
                    "{:>6}  {:6} {:>9} {:>8.0} {:>9.2} {:>9.2} {:>5.2} {:>16.1e}",
                    row.n,
                    row.depth,
                    row.radius_m,
                    row.touched_mean,
                    row.f64_us,
                    row.f32_us,
                    row.gain,
                    row.error_max_m
                );
                rows.push(row);
            }
        }
    }
    let drawing = draw(&rows);
    if has("--write") {
        let folder = Path::new("results/whole_body");
        std::fs::create_dir_all(folder).expect("a folder for results");
        let mut file = CsvFile::create(&folder.join("precision.csv"))?;
        for row in &rows {
            file.row(row)?;
        }
        file.commit()?;
        let title = "A press in singles: error and gain";
        write_bytes(&folder.join("precision.svg"), drawing.svg(title).as_bytes())?;
    }
    Ok(())
}
