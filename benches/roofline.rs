//! Roofline measurement: the fraction of the machine's peak performance that the hot paths reach on one core.
//!
//! `cargo bench --bench roofline` prints a table. With `-- --write`, the table is also written to `results/whole_body/roofline.csv`, and a page to
//! `roofline.md` beside it.
//!
//! The ceilings of the machine are measured first: operations per second, roots per second, and bytes per second of the triad a[i] = b[i] + 3 c[i]. A fused
//! multiply-add counts as two operations. Separate multiplications and additions are also measured, because results that are equal on every processor cannot
//! use fused operations. The arrays of the triad are together as large as the working set of a path.
//!
//! The minimum time of a path is the largest of three times: of its operations at the fused peak, of its roots, and of its bytes. The fraction is the minimum
//! time divided by the measured time. The fraction exceeds one if a path skips work that its equations contain, such as roots that cannot increase a
//! deflection.

use bubbletouch::files::CsvFile;
use clock::seconds;
use hot_paths::{HotPath, Make, decision, dense_body, dense_press, sensing};
use multiversion::multiversion;
use serde::Serialize;
use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

mod clock;
mod hot_paths;

/// Minimum duration of each run; the time is the median over runs.
const LEAST: Duration = Duration::from_millis(10);

/// Row of the table: a ceiling of the machine, or a path compared with the ceilings.
#[derive(Default, Serialize)]
struct Row {
    name: String,
    /// Number of operations per step.
    operations: Option<f64>,
    roots: Option<f64>,
    bytes: Option<f64>,
    working_set_bytes: Option<f64>,
    /// Median time per step, µs.
    time_us: Option<f64>,
    giga_operations_per_s: Option<f64>,
    giga_roots_per_s: Option<f64>,
    gb_per_s: Option<f64>,
    /// Name of the ceiling that limits the path.
    bound: Option<&'static str>,
    fraction_of_roofline: Option<f64>,
}

/// Ceilings of the machine, per second.
struct Ceilings {
    fused: f64,
    roots: f64,
}

macro_rules! loops {
    ($fused:ident, $unfused:ident, $roots:ident, $real:ty, $lanes:expr) => {
        /// Applies fused multiply-adds to each number, for the given number of rounds.
        #[multiversion(targets(
            "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma",
            "x86_64+avx2+fma"
        ))]
        fn $fused(n: usize) -> $real {
            let mut values: [$real; $lanes] = black_box([1.0; $lanes]);
            let factor = black_box(0.999);
            for _ in 0..n {
                for x in &mut values {
                    *x = x.mul_add(factor, 1e-3);
                }
            }
            // Returns the numbers in memory; with a sum, the compiler might compute them one by one.
            black_box(&values)[0]
        }

        /// Applies separate multiplications and additions to each number, for the given number of rounds.
        #[multiversion(targets(
            "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma",
            "x86_64+avx2+fma"
        ))]
        fn $unfused(n: usize) -> $real {
            let mut values: [$real; $lanes] = black_box([1.0; $lanes]);
            let factor = black_box(0.999);
            for _ in 0..n {
                for x in &mut values {
                    *x = *x * factor + 1e-3;
                }
            }
            // Returns the numbers in memory; with a sum, the compiler might compute them one by one.
            black_box(&values)[0]
        }

        /// Computes the root of each number, for the given number of rounds.
        #[multiversion(targets(
            "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma",
            "x86_64+avx2+fma"
        ))]
        fn $roots(n: usize) -> $real {
            let mut values: [$real; $lanes] = black_box([2.0; $lanes]);
            for _ in 0..n {
                for x in &mut values {
                    *x = x.sqrt();
                }
            }
            // Returns the numbers in memory; with a sum, the compiler might compute them one by one.
            black_box(&values)[0]
        }
    };
}

// Twelve 256-bit registers or six 512-bit registers: enough for the latency of the units, few enough to stay in registers.
loops!(fused_f64, unfused_f64, roots_f64, f64, 48);
loops!(fused_f32, unfused_f32, roots_f32, f32, 96);

#[multiversion(targets(
    "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma",
    "x86_64+avx2+fma"
))]
fn triad(a: &mut [f64], b: &[f64], c: &[f64]) {
    for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
        *a = b + 3.0 * c;
    }
}

/// Returns the bytes per second of a triad whose arrays together have the given number of bytes.
fn bandwidth(working_set: f64, is_test: bool) -> f64 {
    let n = (working_set / 24.0).ceil() as usize;
    let (mut a, b, c) = (vec![0.0; n], vec![1.0; n], vec![2.0; n]);
    let call = || triad(black_box(&mut a), black_box(&b), black_box(&c));
    24.0 * n as f64 / seconds(call, LEAST, is_test)
}

fn ceiling(
    rows: &mut Vec<Row>,
    name: &str,
    per_call: f64,
    call: impl FnMut(),
    is_test: bool,
) -> f64 {
    let rate = per_call / seconds(call, LEAST, is_test);
    let giga = Some(rate * 1e-9);
    let is_root = name.starts_with("roots");
    rows.push(Row {
        name: name.into(),
        giga_operations_per_s: giga.filter(|_| !is_root),
        giga_roots_per_s: giga.filter(|_| is_root),
        ..Row::default()
    });
    rate
}

fn ceilings(rows: &mut Vec<Row>, is_test: bool) -> Ceilings {
    const N: usize = 1000;
    let (f64s, f32s) = (48.0 * N as f64, 96.0 * N as f64);
    let mut measure =
        |name, per_call, call: &mut dyn FnMut()| ceiling(rows, name, per_call, call, is_test);
    let fused = measure("peak_fused_f64", 2.0 * f64s, &mut || {
        _ = black_box(fused_f64(N))
    });
    measure("peak_unfused_f64", 2.0 * f64s, &mut || {
        _ = black_box(unfused_f64(N))
    });
    let roots = measure("roots_f64", f64s, &mut || _ = black_box(roots_f64(N)));
    measure("peak_fused_f32", 2.0 * f32s, &mut || {
        _ = black_box(fused_f32(N))
    });
    measure("peak_unfused_f32", 2.0 * f32s, &mut || {
        _ = black_box(unfused_f32(N))
    });
    measure("roots_f32", f32s, &mut || _ = black_box(roots_f32(N)));
    for (name, bytes) in [
        ("16_kB", 16e3),
        ("256_kB", 256e3),
        ("4_MB", 4e6),
        ("200_MB", 200e6),
    ] {
        rows.push(Row {
            name: format!("triad_{name}"),
            working_set_bytes: Some(bytes),
            gb_per_s: Some(bandwidth(bytes, is_test) * 1e-9),
            ..Row::default()
        });
    }
    Ceilings { fused, roots }
}

fn achieved(mut path: HotPath, ceilings: &Ceilings, is_test: bool) -> Row {
    let work = path.work;
    let time = seconds(&mut path.step, LEAST, is_test);
    let least = [
        ("operations", work.operations / ceilings.fused),
        ("roots", work.roots / ceilings.roots),
        ("bytes", work.bytes / bandwidth(work.working_set, is_test)),
    ];
    let (bound, least) = least
        .into_iter()
        .fold(("", 0.0), |a, b| if b.1 > a.1 { b } else { a });
    Row {
        name: path.name,
        operations: Some(work.operations),
        roots: Some(work.roots),
        bytes: Some(work.bytes),
        working_set_bytes: Some(work.working_set),
        time_us: Some(time * 1e6),
        giga_operations_per_s: Some(work.operations / time * 1e-9),
        giga_roots_per_s: Some(work.roots / time * 1e-9),
        gb_per_s: Some(work.bytes / time * 1e-9),
        bound: Some(bound),
        fraction_of_roofline: Some(least / time),
    }
}

fn print(row: &Row) {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.2}"));
    println!(
        "{:42} {:>10} {:>10} {:>10} {:>10} {:>11} {:>7}",
        row.name,
        number(row.time_us),
        number(row.giga_operations_per_s),
        number(row.giga_roots_per_s),
        number(row.gb_per_s),
        row.bound.unwrap_or_default(),
        number(row.fraction_of_roofline),
    );
}

/// Returns the rows as a Markdown page: the ceilings, then the work and the performance of each path.
fn page(rows: &[Row]) -> String {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.3}"));
    let count = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.0}"));
    let mut page = String::from(
        "# Roofline\n\nOne core; `cargo bench --bench roofline -- --write`. What is counted is said in benches/README.md.\n\n\
         ## Ceilings of the machine\n\n| ceiling | 10⁹ operations/s | 10⁹ roots/s | GB/s |\n|---|---|---|---|\n",
    );
    let (ceilings, paths): (Vec<&Row>, Vec<&Row>) = rows
        .iter()
        .partition(|row| row.fraction_of_roofline.is_none());
    for row in ceilings {
        let per_s = [
            row.giga_operations_per_s,
            row.giga_roots_per_s,
            row.gb_per_s,
        ]
        .map(number);
        page += &format!("| {} | {} |\n", row.name, per_s.join(" | "));
    }
    page += "\n## Hot paths, a step\n\n| path | operations | roots | bytes | µs | 10⁹ operations/s | 10⁹ roots/s | GB/s | bound by | share of the roofline |\n\
             |---|---|---|---|---|---|---|---|---|---|\n";
    for row in paths {
        let asked = [row.operations, row.roots, row.bytes].map(count);
        let time = number(row.time_us);
        let per_s = [
            row.giga_operations_per_s,
            row.giga_roots_per_s,
            row.gb_per_s,
        ]
        .map(number);
        let (asked, per_s) = (asked.join(" | "), per_s.join(" | "));
        let (bound, share) = (
            row.bound.unwrap_or_default(),
            number(row.fraction_of_roofline),
        );
        page += &format!(
            "| {} | {asked} | {time} | {per_s} | {bound} | {share} |\n",
            row.name
        );
    }
    page
}

fn main() -> bubbletouch::Result<()> {
    let has = |flag: &str| std::env::args().any(|argument| argument == flag);
    // `cargo test --benches` and CI only check that the benchmark runs.
    let is_test = has("--test");
    let columns = [
        "path",
        "us a step",
        "Gop/s",
        "Groot/s",
        "GB/s",
        "bound",
        "share",
    ];
    let [path, time, operations, roots, bytes, bound, share] = columns;
    println!(
        "{path:42} {time:>10} {operations:>10} {roots:>10} {bytes:>10} {bound:>11} {share:>7}"
    );
    let mut rows = Vec::new();
    let machine = ceilings(&mut rows, is_test);
    rows.iter().for_each(print);
    let paths: [Make; 6] = [
        || dense_press(64, 32),
        || dense_press(512, 32),
        || dense_body(64, 32),
        || dense_body(512, 32),
        sensing,
        decision,
    ];
    for path in paths {
        let row = achieved(path(), &machine, is_test);
        print(&row);
        rows.push(row);
    }
    if has("--write") {
        std::fs::create_dir_all("results/whole_body").expect("a folder for results");
        let mut file = CsvFile::create(Path::new("results/whole_body/roofline.csv"))?;
        for row in &rows {
            file.row(row)?;
        }
        file.commit()?;
        let path = Path::new("results/whole_body/roofline.md");
        bubbletouch::files::write_bytes(path, page(&rows).as_bytes())?;
    }
    Ok(())
}
