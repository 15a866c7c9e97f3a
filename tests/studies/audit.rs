//! Faults are added to simulated data in three strengths each. The audit finds each of them, and finds no fault in clean data.

use bubbletouch::audit::{AuditData, AuditOptions, Finding, Verdict, audit};
use bubbletouch::contact::{Workspace, press_to_depth};
use bubbletouch::objects::Catalogue;
use bubbletouch::random::Seed;
use bubbletouch::world::{Grid, Patch, Placement, RestPoses, Spread, Taxel, touches};
use ndarray::{Array2, Axis};
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Poisson, StandardNormal};
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::sync::LazyLock;

const SIDE: usize = 20;
const N_TAXELS: usize = SIDE * SIDE;
const OBJECTS: [&str; 5] = ["golf", "dice", "soup_can", "banana", "croquet"];
const PER_OBJECT: usize = 60;
/// Noise, as a fraction of the full scale.
const NOISE: f64 = 0.02;
/// Number of permutations; fewer than the default keep the test short.
const N_PERMUTATIONS: usize = 399;

/// Simulated frames without noise, as fractions of the full scale, and the object of each frame.
static SIMULATED: LazyLock<(Array2<f64>, Vec<usize>)> = LazyLock::new(simulated);

fn simulated() -> (Array2<f64>, Vec<usize>) {
    let grid = Grid {
        nx: SIDE,
        ny: SIDE,
        pitch: 5e-3,
    };
    let stroke = 6e-3;
    let taxel = Taxel {
        radius: 2.5e-3,
        stiffness: 100.0,
        damping: 0.0,
        stroke,
    };
    let patch = Patch::grid(grid, taxel).unwrap();
    let catalogue = Catalogue::builtin().unwrap();
    let within = |low: f64, high: f64| Spread::Uniform { low, high };
    let placement = Placement {
        rest: RestPoses::AsModelled,
        offset_x: within(-10e-3, 10e-3),
        offset_y: within(-10e-3, 10e-3),
        yaw: within(0.0, TAU),
        tilt_x: Spread::Values(vec![0.0]),
        tilt_y: Spread::Values(vec![0.0]),
        depth: within(2e-3, 4e-3),
        per_object: Some(PER_OBJECT),
    };
    let mut frames = Array2::zeros((OBJECTS.len() * PER_OBJECT, N_TAXELS));
    let mut labels = Vec::new();
    let mut workspace = Workspace::new();
    for (label, name) in OBJECTS.into_iter().enumerate() {
        let object = catalogue.object(name).unwrap().build(0.5e-3).unwrap();
        let rests = placement.rest.poses(&object.model);
        let touches = touches(&placement, &rests, &Seed::new(3).named(name)).unwrap();
        for touch in touches {
            let pose = touch.patch_from_object(&rests[touch.rest]);
            let models = [object.model.clone()];
            press_to_depth(&patch, &models, &[pose], touch.depth, &mut workspace).unwrap();
            let mut frame = frames.row_mut(labels.len());
            for (reading, deflection) in frame.iter_mut().zip(workspace.deflections()) {
                *reading = deflection / stroke;
            }
            labels.push(label);
        }
    }
    (frames, labels)
}

/// Data of the test: frames of single-frame touches in random order, with random groups and sessions.
struct Planted {
    frames: Array2<f64>,
    /// Number of the simulated frame of each touch.
    numbers: Vec<usize>,
    n_frames: usize,
    /// Whether rows and columns are unknown.
    is_list: bool,
    labels: Vec<usize>,
    groups: Vec<usize>,
    sessions: Vec<usize>,
    rng: ChaCha8Rng,
}

impl Planted {
    fn clean(seed: u64) -> Self {
        Self::with_noise(seed, NOISE)
    }

    fn with_noise(seed: u64, noise: f64) -> Self {
        let (frames, labels) = &*SIMULATED;
        let mut rng = Seed::new(seed).named("planted").rng();
        let mut order: Vec<usize> = (0..labels.len()).collect();
        order.shuffle(&mut rng);
        let frames = frames.select(Axis(0), &order);
        let frames = frames.mapv(|reading| reading + noise * normal(&mut rng));
        let n = labels.len();
        Self {
            labels: order.iter().map(|&touch| labels[touch]).collect(),
            groups: (0..n).map(|_| rng.gen_range(0..30)).collect(),
            sessions: (0..n).map(|_| rng.gen_range(0..8)).collect(),
            n_frames: 1,
            is_list: false,
            numbers: order,
            frames,
            rng,
        }
    }

    /// Returns the frames without noise.
    fn truth(&self) -> Array2<f64> {
        SIMULATED.0.select(Axis(0), &self.numbers)
    }

    fn n(&self) -> usize {
        self.labels.len()
    }

    /// Replaces the touches by the touches with the given indices, in the given order.
    fn select(&mut self, order: &[usize]) {
        self.frames = self.frames.select(Axis(0), order);
        let lists = [
            &mut self.numbers,
            &mut self.labels,
            &mut self.groups,
            &mut self.sessions,
        ];
        for list in lists {
            *list = order.iter().map(|&touch| list[touch]).collect();
        }
    }

    /// Divides the touches of each class into `n` groups that contain no other class.
    fn nest_groups(&mut self, n: usize) {
        let mut counts = [0; OBJECTS.len()];
        for (group, &label) in self.groups.iter_mut().zip(&self.labels) {
            *group = label * n + counts[label] % n;
            counts[label] += 1;
        }
    }

    /// Adds a pattern of normal numbers for each value of `of`, times `size`, to the taxels for which `is_counted` is true.
    fn add_patterns(&mut self, of: &[usize], size: f64, is_counted: impl Fn(usize) -> bool) {
        let n = of.iter().max().unwrap() + 1;
        let rng = &mut self.rng;
        let patterns = Array2::from_shape_simple_fn((n, N_TAXELS), || size * normal(rng));
        for (mut frame, &of) in self.frames.rows_mut().into_iter().zip(of) {
            for (taxel, reading) in frame
                .iter_mut()
                .enumerate()
                .filter(|(taxel, _)| is_counted(*taxel))
            {
                *reading += patterns[(of, taxel)];
            }
        }
    }

    /// Draws different taxels of the middle 8 × 8.
    fn middle(&mut self, n: usize) -> Vec<usize> {
        let all: Vec<usize> = (0..64).map(|k| (6 + k / 8) * SIDE + 6 + k % 8).collect();
        all.choose_multiple(&mut self.rng, n).copied().collect()
    }

    fn audited(self) -> Vec<Finding> {
        let data = AuditData {
            frames: self.frames,
            n_frames: self.n_frames,
            grid: (!self.is_list).then_some((SIDE, SIDE)),
            labels: Some(self.labels),
            classes: OBJECTS.map(str::to_owned).to_vec(),
            groups: Some(self.groups),
            sessions: Some(self.sessions),
            ..AuditData::default()
        };
        let options = AuditOptions {
            n_permutations: N_PERMUTATIONS,
            ..AuditOptions::default()
        };
        audit(data, options).unwrap().findings
    }
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    rng.sample(StandardNormal)
}

fn faults(findings: &[Finding]) -> BTreeSet<&'static str> {
    let faults = findings.iter().filter(|f| f.verdict == Verdict::Fault);
    faults.map(|finding| finding.check).collect()
}

/// Fault of the test: the check that finds it, other checks that it affects, and the function that adds it with strength 0, 1 or 2.
struct Plant {
    check: &'static str,
    entails: &'static [&'static str],
    plant: fn(&mut Planted, usize),
}

const GROUPED: &[&str] = &[
    "accuracy_by_split",
    "random_labels",
    "sample_size",
    "method_order",
    // The touches of a group form a cluster.
    "near_duplicates",
    // The pattern of a group is also added to untouched taxels.
    "untouched_taxels",
    "hot_taxels",
];

const PLANTS: &[Plant] = &[
    Plant {
        check: "near_duplicates",
        entails: &[],
        plant: |data, strength| {
            let n = data.n();
            for copy in 0..[3, 10, 30][strength] {
                let row = data
                    .frames
                    .row(copy)
                    .mapv(|x| x + 0.25 * NOISE * normal(&mut data.rng));
                data.frames.row_mut(n - 1 - copy).assign(&row);
                data.labels[n - 1 - copy] = data.labels[copy];
            }
        },
    },
    Plant {
        check: "accuracy_by_split",
        entails: GROUPED,
        plant: |data, strength| {
            data.nest_groups(6);
            let groups = data.groups.clone();
            data.add_patterns(&groups, [0.06, 0.1, 0.2][strength], |_| true);
        },
    },
    Plant {
        check: "method_order",
        entails: GROUPED,
        plant: |data, strength| {
            // A weak pattern depends on the class. A strong pattern depends on the group, and helps only a classifier that has seen the group in training.
            data.nest_groups(12);
            data.frames *= 0.1;
            let (labels, groups) = (data.labels.clone(), data.groups.clone());
            data.add_patterns(&labels, [0.035, 0.04, 0.045][strength], |_| true);
            data.add_patterns(&groups, 0.15, |_| true);
            let rng = &mut data.rng;
            data.frames.mapv_inplace(|x| x + 0.15 * normal(rng));
        },
    },
    Plant {
        check: "before_contact",
        entails: &["untouched_taxels", "hot_taxels"],
        plant: |data, strength| {
            before_contact(data);
            let size = [0.3, 0.6, 2.0][strength] * NOISE;
            let patterns: Vec<f64> = (0..OBJECTS.len() * N_TAXELS)
                .map(|_| size * normal(&mut data.rng))
                .collect();
            for (touch, &label) in data.labels.iter().enumerate() {
                for (taxel, x) in data.frames.row_mut(3 * touch).iter_mut().enumerate() {
                    *x += patterns[label * N_TAXELS + taxel];
                }
            }
        },
    },
    Plant {
        check: "untouched_taxels",
        entails: &["hot_taxels"],
        plant: |data, strength| {
            let is_border = |taxel: usize| {
                [taxel / SIDE, taxel % SIDE]
                    .iter()
                    .any(|&at| at == 0 || at == SIDE - 1)
            };
            let labels = data.labels.clone();
            data.add_patterns(&labels, [0.3, 0.6, 1.5][strength] * NOISE, is_border);
        },
    },
    Plant {
        check: "mean_reading",
        entails: &["label_noise"],
        plant: |data, strength| {
            // The label is the force with which any of the objects is pressed.
            for label in &mut data.labels {
                *label = data.rng.gen_range(0..OBJECTS.len());
            }
            let exponent = [1.0, 1.5, 2.0][strength];
            for (mut frame, &label) in data.frames.rows_mut().into_iter().zip(&data.labels) {
                let force = exponent * (label as f64 - 4.0) / 2.0;
                let sum = frame.sum();
                frame *= force.exp() * 10.0 / sum;
            }
        },
    },
    Plant {
        check: "row_order",
        entails: &[],
        plant: |data, strength| {
            let n = data.n();
            let mut places: Vec<usize> = (0..n).collect();
            places.shuffle(&mut data.rng);
            places.truncate(n * [40, 60, 90][strength] / 100);
            places.sort_unstable();
            let mut sorted = places.clone();
            sorted.sort_by_key(|&touch| data.labels[touch]);
            let mut order: Vec<usize> = (0..n).collect();
            for (place, touch) in places.into_iter().zip(sorted) {
                order[place] = touch;
            }
            data.select(&order);
        },
    },
    Plant {
        check: "session_labels",
        entails: &["accuracy_by_split"],
        plant: |data, strength| {
            for (session, &label) in data.sessions.iter_mut().zip(&data.labels) {
                if data.rng.gen_bool([0.3, 0.6, 0.9][strength]) {
                    *session = label;
                }
            }
        },
    },
    Plant {
        check: "random_labels",
        entails: GROUPED,
        plant: |data, strength| {
            data.nest_groups(10);
            let groups = data.groups.clone();
            data.add_patterns(&groups, [0.04, 0.06, 0.1][strength], |_| true);
        },
    },
    Plant {
        check: "sample_size",
        entails: GROUPED,
        plant: |data, strength| {
            data.nest_groups(6);
            let groups = data.groups.clone();
            data.add_patterns(&groups, [0.08, 0.12, 0.2][strength], |_| true);
        },
    },
    Plant {
        check: "label_noise",
        entails: &[],
        plant: |data, strength| {
            let n = data.n();
            for touch in 0..n * [8, 12, 20][strength] / 100 {
                data.labels[touch] = (data.labels[touch] + data.rng.gen_range(1..5)) % 5;
            }
        },
    },
    Plant {
        check: "class_balance",
        entails: &[],
        plant: |data, strength| {
            let all = 0..data.n();
            let kept = all.filter(|&touch| {
                data.labels[touch] != 2 || data.rng.gen_bool([0.4, 0.25, 0.1][strength])
            });
            let kept: Vec<usize> = kept.collect();
            data.select(&kept);
        },
    },
    Plant {
        check: "missing_readings",
        entails: &[],
        plant: |data, strength| {
            for _ in 0..[1, 20, 400][strength] {
                let place = (
                    data.rng.gen_range(0..data.n()),
                    data.rng.gen_range(0..N_TAXELS),
                );
                data.frames[place] = [f64::NAN, f64::INFINITY][place.0 % 2];
            }
        },
    },
    Plant {
        check: "saturation",
        entails: &[],
        plant: |data, strength| {
            let largest = data
                .frames
                .rows()
                .into_iter()
                .map(|row| row.iter().copied().fold(0.0, f64::max));
            let mut largest: Vec<f64> = largest.collect();
            largest.sort_by(f64::total_cmp);
            let level = largest[data.n() * [95, 85, 50][strength] / 100];
            data.frames.mapv_inplace(|x| x.min(level));
        },
    },
    Plant {
        check: "dead_taxels",
        entails: &[],
        plant: |data, strength| {
            for taxel in data.middle([1, 3, 8][strength]) {
                data.frames.column_mut(taxel).fill(0.0);
            }
        },
    },
    Plant {
        check: "dead_taxels",
        entails: &[],
        plant: |data, strength| {
            // The taxels are stuck at another level.
            for taxel in data.middle([1, 3, 8][strength]) {
                let level = data.rng.gen_range(0.1..0.9);
                data.frames.column_mut(taxel).fill(level);
            }
        },
    },
    Plant {
        check: "hot_taxels",
        entails: &[],
        plant: |data, strength| {
            for taxel in data.middle([1, 3, 6][strength]) {
                let level = [0.15, 0.2, 0.4][strength];
                data.frames.column_mut(taxel).mapv_inplace(|x| x + level);
            }
        },
    },
    Plant {
        check: "hot_taxels",
        entails: &[],
        plant: |data, strength| {
            // Strong noise.
            for taxel in data.middle([1, 3, 6][strength]) {
                let rng = &mut data.rng;
                let noise = [0.12, 0.2, 0.4][strength];
                data.frames
                    .column_mut(taxel)
                    .mapv_inplace(|x| x + noise * normal(rng));
            }
        },
    },
    Plant {
        check: "drift",
        entails: &[
            "sample_size",
            "hot_taxels",
            "accuracy_by_split",
            "random_labels",
        ],
        plant: |data, strength| {
            // The zero of each taxel is a random walk.
            let step = [0.02, 0.05, 0.1][strength] / (data.n() as f64).sqrt();
            let mut zero = vec![0.0; N_TAXELS];
            for mut frame in data.frames.rows_mut() {
                for (reading, zero) in frame.iter_mut().zip(&mut zero) {
                    *zero += step * normal(&mut data.rng);
                    *reading += *zero;
                }
            }
        },
    },
    Plant {
        check: "quantisation",
        // With few levels of readings, frames can be equal by chance.
        entails: &["near_duplicates"],
        plant: |data, strength| {
            let steps = [15.0, 7.0, 3.0][strength];
            data.frames
                .mapv_inplace(|x| (x.clamp(0.0, 1.0) * steps).round() / steps);
        },
    },
    Plant {
        // Copies with another gain and offset.
        check: "near_duplicates",
        entails: &[],
        plant: |data, strength| {
            let n = data.n();
            for copy in 0..[4, 10, 30][strength] {
                let (gain, offset) = (
                    data.rng.gen_range(0.8..1.2),
                    data.rng.gen_range(-0.05..0.05),
                );
                let row = data.frames.row(copy).mapv(|x| gain * x + offset);
                data.frames.row_mut(n - 1 - copy).assign(&row);
                data.labels[n - 1 - copy] = data.labels[copy];
            }
        },
    },
    Plant {
        // Some frames are without contact. Their levels depend on the class.
        check: "before_contact",
        entails: &[
            "untouched_taxels",
            "hot_taxels",
            "near_duplicates",
            "mean_reading",
        ],
        plant: |data, strength| {
            let share = [0.2, 0.4, 0.6][strength];
            for touch in 0..data.n() {
                if data.rng.gen_bool(share) {
                    let rng = &mut data.rng;
                    data.frames
                        .row_mut(touch)
                        .mapv_inplace(|_| NOISE * normal(rng));
                }
            }
            let labels = data.labels.clone();
            data.add_patterns(&labels, [0.5, 0.7, 1.0][strength] * NOISE, |_| true);
        },
    },
    Plant {
        // The number −1 stands for missing readings.
        check: "missing_readings",
        entails: &["saturation"],
        plant: |data, strength| {
            for _ in 0..[20, 200, 2000][strength] {
                let place = (
                    data.rng.gen_range(0..data.n()),
                    data.rng.gen_range(0..N_TAXELS),
                );
                data.frames[place] = -1.0;
            }
        },
    },
    Plant {
        // Some taxels are clipped at levels of their own.
        check: "saturation",
        entails: &["dead_taxels", "untouched_taxels"],
        plant: |data, strength| {
            for taxel in data.middle([2, 5, 10][strength]) {
                let mut readings = data.frames.column(taxel).to_vec();
                readings.sort_by(f64::total_cmp);
                let level = readings[data.n() * [95, 90, 80][strength] / 100];
                data.frames.column_mut(taxel).mapv_inplace(|x| x.min(level));
            }
        },
    },
    Plant {
        // The taxels are stuck for some time.
        check: "dead_taxels",
        entails: &["hot_taxels", "sample_size", "drift"],
        plant: |data, strength| {
            let n_stuck = data.n() * [20, 40, 70][strength] / 100;
            for taxel in data.middle([1, 2, 4][strength]) {
                let first = data.rng.gen_range(0..data.n() - n_stuck);
                let level = 0.2 + 1e-4 * taxel as f64;
                (first..first + n_stuck).for_each(|touch| data.frames[(touch, taxel)] = level);
            }
        },
    },
    Plant {
        // Each taxel is calibrated after rounding.
        check: "quantisation",
        entails: &["near_duplicates"],
        plant: |data, strength| {
            let steps = [31.0, 15.0, 3.0][strength];
            for mut readings in data.frames.columns_mut() {
                let gain = data.rng.gen_range(0.7..1.3);
                readings.mapv_inplace(|x| gain * (x.clamp(0.0, 1.0) * steps).round() / steps);
            }
        },
    },
    Plant {
        // Mirrored copies.
        check: "near_duplicates",
        entails: &[],
        plant: |data, strength| {
            let n = data.n();
            for copy in 0..[8, 15, 30][strength] {
                for taxel in 0..N_TAXELS {
                    let mirrored = taxel / SIDE * SIDE + SIDE - 1 - taxel % SIDE;
                    data.frames[(n - 1 - copy, mirrored)] =
                        data.frames[(copy, taxel)] + 0.25 * NOISE * normal(&mut data.rng);
                }
                data.labels[n - 1 - copy] = data.labels[copy];
            }
        },
    },
    Plant {
        // Touches of one class have the label of one other class.
        check: "label_noise",
        entails: &["class_balance"],
        plant: |data, strength| {
            let probability = [0.2, 0.25, 0.3][strength];
            for label in data.labels.iter_mut().filter(|label| **label == 2) {
                if data.rng.gen_bool(probability) {
                    *label = 3;
                }
            }
        },
    },
    Plant {
        // The gain falls.
        check: "drift",
        entails: &["sample_size", "accuracy_by_split", "random_labels"],
        plant: |data, strength| {
            let n = data.n() as f64;
            let fall = [0.25, 0.4, 0.7][strength];
            for (touch, mut frame) in data.frames.rows_mut().into_iter().enumerate() {
                frame *= 1.0 - fall * touch as f64 / n;
            }
        },
    },
    Plant {
        // The noise before the contact depends on the class.
        check: "before_contact",
        entails: &["untouched_taxels"],
        plant: |data, strength| {
            before_contact(data);
            for (touch, &label) in data.labels.iter().enumerate() {
                let noise = 1.0 + [0.1, 0.2, 0.3][strength] * label as f64;
                data.frames.row_mut(3 * touch).mapv_inplace(|x| noise * x);
            }
        },
    },
    Plant {
        // Touches are padded to the longest by frames of zeros. Their lengths depend on the class.
        check: "before_contact",
        // Means over frames of zeros have less noise.
        entails: &["missing_readings", "near_duplicates", "untouched_taxels"],
        plant: |data, strength| {
            let step = [0.5, 0.7, 1.0][strength];
            with_onsets(data, |_, rng| rng.gen_range(3..5));
            for (touch, &label) in data.labels.iter().enumerate() {
                let length = 5 + data.rng.gen_range(0..2) + (step * label as f64) as usize;
                for frame in length.min(9)..9 {
                    data.frames.row_mut(9 * touch + frame).fill(0.0);
                }
            }
        },
    },
    Plant {
        // Integers of 8 bits wrap around.
        check: "saturation",
        entails: &[
            "hot_taxels",
            "dead_taxels",
            "near_duplicates",
            "label_noise",
        ],
        plant: |data, strength| {
            let largest = data.frames.iter().copied().fold(0.0, f64::max);
            let factor = 256.0 * [1.15, 1.3, 1.6][strength] / largest;
            data.frames
                .mapv_inplace(|x| (factor * x + 8.0).round().rem_euclid(256.0));
        },
    },
    Plant {
        // Noise below zero wraps around at 16 bits.
        check: "saturation",
        entails: &[
            "hot_taxels",
            "dead_taxels",
            "near_duplicates",
            "untouched_taxels",
            "missing_readings",
            "drift",
            "quantisation",
        ],
        plant: |data, strength| {
            let factor = [300.0, 1000.0, 4000.0][strength];
            data.frames
                .mapv_inplace(|x| (factor * x).round().rem_euclid(65_536.0));
        },
    },
    Plant {
        // The taxels read only noise in one session.
        check: "dead_taxels",
        entails: &["hot_taxels", "drift", "sample_size"],
        plant: |data, strength| {
            data.sessions = (0..data.n()).map(|touch| touch * 4 / data.n()).collect();
            for (number, taxel) in data.middle([3, 5, 8][strength]).into_iter().enumerate() {
                for touch in (0..data.n()).filter(|&touch| data.sessions[touch] == number % 4) {
                    data.frames[(touch, taxel)] = NOISE * normal(&mut data.rng);
                }
            }
        },
    },
    Plant {
        // The taxels read only noise.
        check: "dead_taxels",
        entails: &["hot_taxels"],
        plant: |data, strength| {
            for taxel in data.middle([1, 3, 6][strength]) {
                let rng = &mut data.rng;
                data.frames
                    .column_mut(taxel)
                    .mapv_inplace(|_| NOISE * normal(rng));
            }
        },
    },
    Plant {
        // Pressures are rounded to few integers, which resemble counts of events.
        check: "quantisation",
        entails: &["near_duplicates", "saturation"],
        plant: |data, strength| {
            let steps = [15.0, 12.0, 4.0][strength];
            let largest = data.frames.iter().copied().fold(0.0, f64::max);
            data.frames
                .mapv_inplace(|x| (x / largest * steps).max(0.0).round());
        },
    },
    Plant {
        // The temperature raises all taxels.
        check: "drift",
        entails: &["sample_size", "accuracy_by_split"],
        plant: |data, strength| {
            let n = data.n() as f64;
            let rise = [0.01, 0.02, 0.05][strength];
            for (touch, mut frame) in data.frames.rows_mut().into_iter().enumerate() {
                frame += rise * touch as f64 / n;
            }
        },
    },
];

/// Replaces each touch by three frames: before the contact, half of the press, and the whole press.
fn before_contact(data: &mut Planted) {
    let mut frames = Array2::zeros((3 * data.n(), N_TAXELS));
    for touch in 0..data.n() {
        for (frame, share) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            let noise = data
                .frames
                .row(touch)
                .mapv(|x| share * x + NOISE * normal(&mut data.rng));
            frames.row_mut(3 * touch + frame).assign(&noise);
        }
    }
    data.frames = frames;
    data.n_frames = 3;
}

#[test]
fn planted_faults_of_three_strengths_are_found() {
    let mut table = String::new();
    let mut is_right = true;
    for (
        number,
        Plant {
            check,
            entails,
            plant,
        },
    ) in PLANTS.iter().enumerate()
    {
        for strength in 0..3 {
            let mut data = Planted::clean(100 + number as u64);
            plant(&mut data, strength);
            let findings = data.audited();
            let found = faults(&findings);
            let others: Vec<&str> = found
                .iter()
                .copied()
                .filter(|f| f != check && !entails.contains(f))
                .collect();
            let is_found = found.contains(check);
            is_right &= is_found && others.is_empty();
            table += &format!("{check} {strength}: found {is_found}, others {others:?}\n");
            let is_shown =
                |f: &&Finding| others.contains(&f.check) || (!is_found && f.check == *check);
            for finding in findings.iter().filter(is_shown) {
                table += &format!("    {:?} {}\n", finding.p_value, finding.sentence);
            }
        }
    }
    assert!(is_right, "\n{table}");
}

/// In a list without rows and columns, correlated taxels stand for the taxels around a taxel.
#[test]
fn faulty_taxels_of_lists_are_found() {
    let is_listed = |check: &str| ["dead_taxels", "hot_taxels", "drift"].contains(&check);
    let mut order: Vec<usize> = (0..N_TAXELS).collect();
    order.shuffle(&mut Seed::new(1).named("list").rng());
    let plants = PLANTS.iter().enumerate();
    for (number, plant) in plants.filter(|(_, plant)| is_listed(plant.check)) {
        let mut data = Planted::clean(200 + number as u64);
        (plant.plant)(&mut data, 2);
        data.frames = data.frames.select(Axis(1), &order);
        data.is_list = true;
        let found = faults(&data.audited());
        // A taxel that is stuck for most of the time, or only reads noise, is not correlated with others.
        if ![24, PLANTS.len() - 3].contains(&number) {
            assert!(
                found.contains(plant.check),
                "{number} {}: {found:?}",
                plant.check
            );
        }
    }
    let mut data = Planted::clean(300);
    data.frames = data.frames.select(Axis(1), &order);
    data.is_list = true;
    let found = faults(&data.audited());
    assert!(found.is_empty(), "{found:?}");
    // Row by row, the ends of rows are next to taxels that are touched more.
    let mut data = Planted::clean(301);
    data.is_list = true;
    let found = faults(&data.audited());
    assert!(found.is_empty(), "{found:?}");
    // Without noise, untouched taxels are constant.
    let mut data = Planted::clean(302);
    data.frames.mapv_inplace(|x| if x > 0.1 { x } else { 0.0 });
    data.is_list = true;
    let found = faults(&data.audited());
    assert!(!found.contains("dead_taxels"), "{found:?}");
}

#[test]
fn no_fault_is_invented_in_clean_data() {
    let mut variants: Vec<(String, Planted)> = Vec::new();
    for seed in 0..6 {
        variants.push((format!("noise {seed}"), Planted::clean(seed)));
    }
    let mut data = Planted::clean(7);
    data.frames.mapv_inplace(|x| x.max(0.0));
    variants.push(("clipped at zero".to_owned(), data));
    let mut data = Planted::clean(8);
    data.frames
        .mapv_inplace(|x| (255.0 * x.clamp(0.0, 1.0)).round());
    variants.push(("8 bits".to_owned(), data));
    let mut data = Planted::clean(9);
    data.frames.mapv_inplace(|x| 5000.0 + 1000.0 * x);
    variants.push(("offset".to_owned(), data));
    let mut data = Planted::clean(10);
    before_contact(&mut data);
    variants.push(("frames before contact".to_owned(), data));
    let mut data = Planted::clean(11);
    before_contact(&mut data);
    // The first frame of each touch has a quarter of the contact.
    for touch in 0..data.n() {
        let first = data.frames.row(3 * touch + 2).mapv(|x| 0.25 * x);
        data.frames.row_mut(3 * touch).assign(&first);
    }
    variants.push(("light first contact".to_owned(), data));
    variants.push(("no noise".to_owned(), Planted::with_noise(12, 0.0)));
    let mut data = Planted::clean(13);
    let mut order: Vec<usize> = (0..data.n()).collect();
    order.sort_by_key(|&touch| data.labels[touch]);
    data.select(&order);
    variants.push(("sorted by class".to_owned(), data));
    for (number, rate) in [3.0, 12.0].into_iter().enumerate() {
        let mut data = Planted::clean(14 + number as u64);
        let (clean, rng) = (data.truth(), &mut data.rng);
        data.frames = clean.mapv(|x| Poisson::new(rate * x + 0.2).unwrap().sample(rng));
        variants.push((format!("counts of {rate} events"), data));
    }
    let mut data = Planted::clean(16);
    data.frames.mapv_inplace(|x| 1.0 - x);
    variants.push(("contact reduces readings".to_owned(), data));
    let mut data = Planted::clean(17);
    let largest = data.frames.iter().copied().fold(0.0, f64::max);
    data.frames
        .mapv_inplace(|x| (255.0 * (x / largest).max(0.0)).round());
    variants.push(("all of 8 bits".to_owned(), data));
    for (name, data) in variants {
        let findings = data.audited();
        let invented: Vec<String> = findings
            .iter()
            .filter(|finding| finding.verdict == Verdict::Fault)
            .map(|finding| format!("{}: {}", finding.check, finding.sentence))
            .collect();
        assert!(invented.is_empty(), "{name}: {invented:#?}");
    }
}

/// Replaces each touch by nine frames. The contact begins with frame `onset`.
fn with_onsets(data: &mut Planted, onset: impl Fn(usize, &mut ChaCha8Rng) -> usize) {
    let mut frames = Array2::zeros((9 * data.n(), N_TAXELS));
    for touch in 0..data.n() {
        let onset = onset(data.labels[touch], &mut data.rng);
        for frame in 0..9 {
            let share = if frame >= onset { 1.0 } else { 0.0 };
            let row = data.frames.row(touch);
            let row = row.mapv(|x| share * x + NOISE * normal(&mut data.rng));
            frames.row_mut(9 * touch + frame).assign(&row);
        }
    }
    data.frames = frames;
    data.n_frames = 9;
}

#[test]
fn the_time_of_the_first_contact_names_the_class_only_if_it_depends_on_the_class() {
    let mut data = Planted::clean(30);
    with_onsets(&mut data, |label, rng| {
        (4 + label / 2 + rng.gen_range(0..2)).min(8)
    });
    let findings = data.audited();
    let is_onset = |finding: &&Finding| finding.subject == "number of frames";
    let found = findings.iter().find(is_onset).unwrap();
    assert_eq!(found.verdict, Verdict::Fault, "{}", found.sentence);
    assert!(found.value > 0.3, "{}", found.value);
    let mut data = Planted::clean(31);
    with_onsets(&mut data, |_, rng| rng.gen_range(4..8));
    let findings = data.audited();
    assert_eq!(
        findings.iter().find(is_onset).unwrap().verdict,
        Verdict::Passed
    );
    assert!(faults(&findings).is_empty(), "{:?}", faults(&findings));
}

/// Touches of one class in one group share a pattern, as frames of one sequence do. The pattern also covers taxels that nothing touches. It names the
/// sequence, not the class.
#[test]
fn copies_of_a_sequence_are_no_confound_of_the_class() {
    let mut data = Planted::clean(32);
    let mut order: Vec<usize> = (0..data.n()).collect();
    order.sort_by_key(|&touch| data.labels[touch]);
    data.select(&order);
    // Each group has four touches of each class, one after the other.
    data.groups = (0..data.n()).map(|touch| touch % PER_OBJECT / 4).collect();
    let cells: Vec<usize> = (0..data.n()).map(|touch| touch / 4).collect();
    data.add_patterns(&cells, 0.1, |_| true);
    let mut order: Vec<usize> = (0..data.n()).collect();
    order.sort_by_key(|&touch| (data.groups[touch], data.labels[touch]));
    data.select(&order);
    let found = faults(&data.audited());
    for check in ["untouched_taxels", "row_order", "before_contact"] {
        assert!(!found.contains(check), "{found:?}");
    }
    assert!(found.contains("accuracy_by_split"), "{found:?}");
}

#[test]
fn a_given_test_set_is_a_split_that_can_reverse_the_order_of_methods() {
    let mut data = Planted::clean(33);
    data.nest_groups(10);
    let groups = data.groups.clone();
    let labels = data.labels.clone();
    data.add_patterns(&labels, 0.015, |_| true);
    data.add_patterns(&groups, 0.3, |_| true);
    let is_test: Vec<bool> = groups.iter().map(|group| group % 10 < 4).collect();
    let data = AuditData {
        frames: data.frames,
        n_frames: 1,
        grid: Some((SIDE, SIDE)),
        labels: Some(data.labels),
        classes: OBJECTS.map(str::to_owned).to_vec(),
        groups: Some(groups),
        is_test: Some(is_test.clone()),
        ..AuditData::default()
    };
    let options = AuditOptions {
        n_permutations: N_PERMUTATIONS,
        ..AuditOptions::default()
    };
    let found = audit(data, options).unwrap();
    let of = |check: &str| {
        let mut findings = found.findings.iter();
        let is_given = |f: &&Finding| f.check == check && f.subject == "given split";
        findings.find(is_given).unwrap()
    };
    let split = of("accuracy_by_split");
    assert_eq!(split.verdict, Verdict::Fault, "{}", split.sentence);
    assert!(
        split.sentence.contains("the given test set held out"),
        "{}",
        split.sentence
    );
    assert!(split.value + 0.2 < split.baseline, "{}", split.sentence);
    assert!(of("method_order").p_value.is_some());
    let table = found
        .tables
        .iter()
        .find(|table| table.file == "accuracy_by_split.csv");
    let table = String::from_utf8(table.unwrap().csv.clone()).unwrap();
    let n = is_test.iter().filter(|&&is_test| is_test).count();
    let given = table.lines().filter(|line| line.starts_with("given,"));
    assert!(given.clone().count() >= 3, "{table}");
    assert!(
        given.clone().all(|line| line.contains(&format!(",{n}"))),
        "{table}"
    );
}

#[test]
fn an_audit_depends_on_data_and_seed_alone() {
    let tables = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| Planted::clean(3).audited())
    };
    let [first, second] = [1, 3].map(tables).map(|findings| format!("{findings:?}"));
    assert_eq!(first, second);
}

/// Law: times of a clock that wraps around continue, and times that fall back otherwise are sorted by value.
#[test]
fn a_clock_that_wraps_around_continues() {
    let sorted = |time: &dyn Fn(usize) -> f64| {
        let mut data = AuditData {
            frames: Array2::from_shape_fn((60, 1), |(touch, _)| touch as f64),
            n_frames: 1,
            ..AuditData::default()
        };
        data.sort_by_time(&(0..60).map(time).collect::<Vec<_>>());
        data.frames.into_raw_vec_and_offset().0
    };
    let in_order: Vec<f64> = (0..60).map(|touch| touch as f64).collect();
    let start = 4_294_967_296.0 - 20_500.0;
    for factor in [1.0, 1e-3, 1e-6] {
        let wrapped = |touch: usize| (start + 1000.0 * touch as f64) % 4_294_967_296.0 * factor;
        assert_eq!(sorted(&wrapped), in_order);
    }
    // Signed counters, and 16 bits.
    assert_eq!(
        sorted(&|touch| f64::from((2_147_480_000 + 500 * touch as u32) as i32)),
        in_order
    );
    assert_eq!(
        sorted(&|touch| f64::from((60_000 + 500 * touch as u32) as u16)),
        in_order
    );
    // Touches that are listed by class.
    let by_class = sorted(&|touch| (touch % 20 * 3 + touch / 20) as f64);
    let expected: Vec<f64> = (0..60).map(|k| (k / 3 + 20 * (k % 3)) as f64).collect();
    assert_eq!(by_class, expected);
}
