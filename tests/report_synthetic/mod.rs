//! Made-up result tables of realistic size: no simulation behind them, only a rule that gives plausible accuracies.
#![allow(dead_code)] // Each test file uses its own part.

use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::features::Features;
use bubbletouch::report::page::{Limit, ReportPage, Snapshots};
use bubbletouch::sensing::Ensemble;
use bubbletouch::signal::NoiseUnit;
use bubbletouch::signal::Quantity;
use bubbletouch::study::table::{
    Cell, CellScore, Comparison, Confused, Confusion, PStatus, Pareto, Published, StageTime,
    Tables, TrialScore, TrialTime,
};
use ndarray::Array2;

/// Names long and short, as a household set has them.
pub const OBJECTS: [&str; 24] = [
    "soup can",
    "mustard bottle",
    "bleach bottle",
    "scissors",
    "power drill",
    "mug",
    "bowl",
    "plate",
    "banana",
    "pear",
    "apple",
    "hammer",
    "screwdriver, flat",
    "adjustable wrench",
    "spring clamp, extra large",
    "marker",
    "padlock",
    "spatula",
    "tennis ball",
    "dice",
    "cracker box",
    "sugar box",
    "tuna can",
    "pitcher with lid",
];

/// A cell to start from: 64 × 64 taxels at 2 mm, 16:1.
pub fn cell() -> Cell {
    Cell {
        cell: 0,
        pitch_mm: 2.0,
        nx: 64,
        ny: 64,
        size_mm: 128.0,
        noise_std: 0.05,
        noise_unit: NoiseUnit::FullScale,
        smoothing_mm: 0.0,
        hysteresis_full_scale: None,
        crosstalk: None,
        gain_std: None,
        drift_std_full_scale: None,
        dead_fraction: None,
        stuck_fraction: None,
        scan_time_ms: None,
        adc_bits: None,
        tested_on: None,
        mislabelled_fraction: None,
        class_imbalance: None,
        ensemble: Ensemble::Gaussian,
        measurements: 256,
        ratio: 16.0,
        frames: 1,
        over_time: None,
        features: Features::Raw,
        classifier: ClassifierKind::LinearSvm,
        c: Some(1.0),
        train_touches: 75,
        fused_touches: 1,
    }
}

/// 2 pitches × 2 sizes × 4 ratios.
pub fn quickstart_cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for pitch_mm in [2.0, 4.0] {
        for size_mm in [64.0, 128.0] {
            for ratio in [4.0, 16.0, 64.0, 256.0] {
                let nx = (size_mm / pitch_mm) as usize;
                cells.push(Cell {
                    pitch_mm,
                    nx,
                    ny: nx,
                    size_mm,
                    ratio,
                    measurements: (nx * nx) / ratio as usize,
                    ..cell()
                });
            }
        }
    }
    cells
}

/// Noise × smoothing × classifier at one ratio.
pub fn noise_cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for noise_std in [0.0, 0.02, 0.05, 0.1, 0.2] {
        for smoothing_mm in [0.0, 2.0, 4.0] {
            for classifier in [ClassifierKind::LinearSvm, ClassifierKind::RbfSvm] {
                cells.push(Cell {
                    noise_std,
                    smoothing_mm,
                    classifier,
                    c: None,
                    ..cell()
                });
            }
        }
    }
    cells
}

/// 300 cells: 5 ratios × 3 pitches × 2 sizes × 2 noises × 5 ensembles.
pub fn many_cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for ensemble in [
        Ensemble::Gaussian,
        Ensemble::Sbhe,
        Ensemble::BlockAverage,
        Ensemble::Subsample,
        Ensemble::Identity,
    ] {
        for noise_std in [0.0, 0.1] {
            for pitch_mm in [2.0, 4.0, 8.0] {
                for size_mm in [64.0, 128.0] {
                    for ratio in [1.0, 4.0, 16.0, 64.0, 100.0] {
                        let nx = (size_mm / pitch_mm) as usize;
                        cells.push(Cell {
                            ensemble,
                            noise_std,
                            pitch_mm,
                            nx,
                            ny: nx,
                            size_mm,
                            ratio,
                            measurements: (nx as f64 * nx as f64 / ratio).ceil() as usize,
                            ..cell()
                        });
                    }
                }
            }
        }
    }
    cells
}

/// 10,000 cells: 10 noises × 5 smoothings × 5 ensembles × 5 pitches × 8 ratios.
pub fn ten_thousand_cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for noise in 0..10 {
        for smoothing in 0..5 {
            for ensemble in [
                Ensemble::Gaussian,
                Ensemble::Sbhe,
                Ensemble::BlockAverage,
                Ensemble::Subsample,
                Ensemble::Sparse,
            ] {
                for pitch in 1..6 {
                    for ratio in 0..8 {
                        let ratio = f64::from(1 << ratio);
                        cells.push(Cell {
                            noise_std: 0.01 * f64::from(noise),
                            smoothing_mm: f64::from(smoothing),
                            ensemble,
                            pitch_mm: f64::from(pitch),
                            size_mm: 64.0 * f64::from(pitch),
                            ratio,
                            measurements: (4096.0 / ratio) as usize,
                            ..cell()
                        });
                    }
                }
            }
        }
    }
    cells
}

/// Tables for some cells with the names of `n_objects` objects.
pub fn tables(cells: Vec<Cell>, n_trials: usize, n_objects: usize) -> Tables {
    let mut tables = Tables::default();
    for (number, cell) in cells.into_iter().enumerate() {
        let cell = Cell {
            cell: number,
            ..cell
        };
        add_cell(&mut tables, cell, n_trials, n_objects);
    }
    add_comparison(&mut tables, n_trials);
    for (pitch_mm, nx) in [(2.0, 32), (2.0, 64), (4.0, 16), (4.0, 32)] {
        for (stage, us) in [("simulate", 31.25), ("measure", 8.5)] {
            tables.stages.push(StageTime {
                stage: stage.to_owned(),
                pitch_mm,
                nx,
                ny: nx,
                n_touches: 2400,
                cpu_s: us * 2400.0 * 1e-6,
                us_per_touch: us,
            });
        }
    }
    tables
}

/// Two published accuracies and two pairs that are often confused, with letters that HTML must not take for its own.
pub fn add_headlines(tables: &mut Tables) {
    let claims = [
        ("98 % of touches, noise < 1 %", 0.98, 1),
        (
            "78 % where a rather long sentence says what was claimed",
            0.78,
            4,
        ),
    ];
    for ((claim, published_accuracy, n_matching), row) in claims.into_iter().zip([5, 0]) {
        let (cell, score) = tables.summary[row].clone();
        let published = Published {
            claim: claim.to_owned(),
            source: "[CL]".to_owned(),
            published_accuracy,
            accuracy: score.accuracy,
            accuracy_low: score.accuracy_low,
            accuracy_high: score.accuracy_high,
            difference: score.accuracy - published_accuracy,
            n_matching,
        };
        tables.published.push((cell, published));
    }
    for (object, predicted, count) in [("mug", "bowl <&>", 24), ("bowl <&>", "mug", 9)] {
        tables.confused.push(Confused {
            cell: 0,
            object: object.to_owned(),
            predicted: predicted.to_owned(),
            count,
            n_test: 75,
            share: count as f64 / 75.0,
        });
    }
}

fn add_cell(tables: &mut Tables, cell: Cell, n_trials: usize, n_objects: usize) {
    let n_test = 25 * n_objects;
    let mut accuracies = Vec::new();
    for trial in 0..n_trials {
        let accuracy = (rule(&cell) + 0.004 * ((trial * 7 + cell.cell * 3) % 5) as f64).min(1.0);
        let n_correct = (accuracy * n_test as f64).round() as usize;
        let accuracy = n_correct as f64 / n_test as f64;
        let (low, high) = wilson(accuracy, n_test);
        accuracies.push(accuracy);
        tables.accuracy.push((
            cell.clone(),
            TrialScore {
                trial,
                split: None,
                projection: None,
                n_train: 75 * n_objects,
                n_test,
                n_left_out: 0,
                n_correct,
                accuracy,
                accuracy_low: low,
                accuracy_high: high,
                macro_f1: accuracy - 0.004,
                c_used: Some(cell.c.unwrap_or(10.0)),
                gamma_used: (cell.classifier == ClassifierKind::RbfSvm).then_some(1.0 / 64.0),
                n_capped: 0,
            },
        ));
        let fit_s = 1e-4 * cell.measurements as f64;
        tables.timing.push((
            cell.clone(),
            TrialTime {
                trial,
                fit_s,
                predict_s: 4e-6 * n_test as f64,
                predict_us_per_touch: 4.0,
            },
        ));
    }
    let mean = accuracies.iter().sum::<f64>() / n_trials as f64;
    let variance = accuracies.iter().map(|a| (a - mean).powi(2)).sum::<f64>();
    let (accuracy_low, accuracy_high) = wilson(mean, n_test);
    add_confusion(tables, &cell, mean, n_trials, n_objects);
    let fit_s = 1e-4 * cell.measurements as f64;
    tables.pareto.push((
        cell.clone(),
        Pareto {
            accuracy: mean,
            fit_s,
            fit_us_per_touch: 1e6 * fit_s / (75 * n_objects) as f64,
            predict_us_per_decision: 4.0,
            on_training_front: cell.cell.is_multiple_of(2),
            on_prediction_front: cell.cell == 0,
        },
    ));
    tables.summary.push((
        cell,
        CellScore {
            n_trials,
            n_test,
            accuracy: mean,
            accuracy_std: (variance / (n_trials as f64 - 1.0).max(1.0)).sqrt(),
            accuracy_low,
            accuracy_high,
            bootstrap_low: (n_trials >= 5).then_some(mean - 0.01),
            bootstrap_high: (n_trials >= 5).then_some(mean + 0.01),
            macro_f1: mean - 0.004,
            n_capped: 0,
        },
    ));
}

/// Falls with the ratio, the pitch and the noise; rises with the size and the smoothing of noise.
fn rule(cell: &Cell) -> f64 {
    let loss = 0.035 * cell.ratio.ln()
        + 0.03 * cell.pitch_mm
        + 2.2 * cell.noise_std / (1.0 + cell.smoothing_mm)
        + 6.0 / cell.size_mm
        - if cell.classifier == ClassifierKind::RbfSvm {
            0.05
        } else {
            0.0
        }
        + 0.01 * cell.smoothing_mm
        + if cell.ensemble == Ensemble::Subsample {
            0.15
        } else {
            0.0
        };
    (1.02 - loss).clamp(0.05, 0.985)
}

fn add_confusion(
    tables: &mut Tables,
    cell: &Cell,
    accuracy: f64,
    n_trials: usize,
    n_objects: usize,
) {
    let per_object = 25 * n_trials;
    for object in 0..n_objects {
        let hard = 1.0 - (1.0 - accuracy) * (0.4 + 1.2 * (object % 5) as f64 / 4.0);
        let right = (hard * per_object as f64).round().max(0.0) as usize;
        let wrong = per_object - right.min(per_object);
        let rows = [
            (object, right.min(per_object)),
            ((object + 1) % n_objects, wrong - wrong / 3),
            ((object * 5 + 3) % n_objects, wrong / 3),
        ];
        for (predicted, count) in rows.into_iter().filter(|(_, count)| *count > 0) {
            tables.confusion.push(Confusion {
                cell: cell.cell,
                object: object_name(object),
                predicted: object_name(predicted),
                count,
            });
        }
    }
}

fn object_name(object: usize) -> String {
    match OBJECTS.get(object) {
        Some(name) => (*name).to_owned(),
        None => format!("object {object}"),
    }
}

fn add_comparison(tables: &mut Tables, n_trials: usize) {
    let best_of = |noise_std: f64| {
        let rows = tables.summary.iter();
        let mut rows = rows.filter(|(cell, _)| cell.noise_std == noise_std);
        let first = rows.next().expect("the cell itself");
        let better = |best: &'_ (Cell, CellScore), row: &'_ (Cell, CellScore)| {
            row.1.accuracy > best.1.accuracy
        };
        rows.fold(
            first,
            |best, row| if better(best, row) { row } else { best },
        )
    };
    let mut comparison = Vec::new();
    for (cell, score) in &tables.summary {
        let (best, best_score) = best_of(cell.noise_std);
        let difference = score.accuracy - best_score.accuracy;
        let several = n_trials > 1;
        comparison.push(Comparison {
            cell: cell.cell,
            best_cell: best.cell,
            n_trials,
            difference,
            difference_low: several.then_some(difference - 0.01),
            difference_high: several.then_some(difference + 0.01),
            p_value: several.then_some((-100.0 * difference.abs()).exp()),
            p_holm: None,
            p_status: match several {
                true => PStatus::Tested,
                false => PStatus::TooFewTrials,
            },
            n_trials_needed: Some(2),
        });
    }
    tables.comparison = comparison;
}

fn wilson(p: f64, n: usize) -> (f64, f64) {
    let (n, z) = (n as f64, 1.959_963_984_540_054);
    let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    (middle - half, middle + half)
}

/// A round press with a rule-made noise, metres: ny × nx.
pub fn press(nx: usize, ny: usize, shape: usize, noise_m: f64) -> Array2<f64> {
    let mut state = 12345 + shape as u64;
    Array2::from_shape_fn((ny, nx), |(row, column)| {
        let x = (column as f64 + 0.5) / nx as f64 - 0.5;
        let y = (row as f64 + 0.5) / ny as f64 - 0.4;
        let depth = match shape {
            0 => 0.005 - 0.08 * (x * x + y * y),
            1 => {
                if x.abs() < 0.08 && y.abs() < 0.4 {
                    0.004
                } else {
                    0.0
                }
            }
            2 => 0.004 - 0.4 * ((x * x + y * y).sqrt() - 0.25).powi(2),
            _ => {
                if (x + y).abs() < 0.1 {
                    0.003
                } else {
                    0.0
                }
            }
        };
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        let uniform = (state >> 40) as f64 / (1u64 << 24) as f64 - 0.5;
        depth.max(0.0) + noise_m * uniform
    })
}

/// What a quickstart would say of itself, with letters that HTML must not take for its own.
pub fn about() -> ReportPage {
    ReportPage {
        name: "quickstart".to_owned(),
        question: "How does recognition depend on resolution, array size & compression when m < n?"
            .to_owned(),
        expected: "Accuracy falls slowly up to 64:1, and faster at the coarser pitch.".to_owned(),
        settings: vec![
            ("objects".to_owned(), "household (24)".to_owned()),
            (
                "touches an object".to_owned(),
                "100: offset ±10 mm, yaw 0–360°, tilt ±5°, depth 4 mm".to_owned(),
            ),
            ("seed".to_owned(), "1".to_owned()),
        ],
        limits: vec![
            Limit {
                what: "taxels reached their stroke".to_owned(),
                count: 5120,
                of: 9_830_400,
                meaning: "Deeper detail of the object is lost there.".to_owned(),
            },
            Limit {
                what: "touches missed the array".to_owned(),
                count: 3,
                of: 9600,
                meaning: "Their frames hold noise only.".to_owned(),
            },
        ],
        snapshots: Some(Snapshots {
            frames: (0..4)
                .map(|shape| (OBJECTS[shape * 3].to_owned(), press(64, 64, shape, 0.0008)))
                .collect(),
            pitch_mm: 2.0,
            quantity: Quantity::Deflection,
            caption: "Pressed 4 mm deep; noise standard deviation 5 % of full scale".to_owned(),
        }),
        pareto: None,
        wall_s: Some(41.3),
        command: "bubbletouch run experiments/quickstart.toml --seed 1 --out results/quickstart"
            .to_owned(),
        program: "bubbletouch 0.1.0".to_owned(),
        ..ReportPage::default()
    }
}
