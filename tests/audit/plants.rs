//! Planted faults: each is found under its own name in all of five seeds.

use crate::sets::*;
use bubbletouch::audit::{Finding, Verdict};
use ndarray::{Axis, concatenate};
use rand::Rng;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A fault: its description, the checks under one of which it is found, whether it is a fault or a note, and the set that contains it.
struct Plant {
    about: &'static str,
    checks: &'static [(&'static str, &'static str)],
    is_fault: bool,
    make: fn(u64) -> Set,
}

const PLANTS: [Plant; 26] = [
    Plant {
        about: "windows of vibration recordings, each with a spectrum of its own",
        checks: &[("split", "group")],
        is_fault: true,
        make: |seed| vibrations(seed, 8, false),
    },
    Plant {
        about: "overlapping windows of recordings",
        checks: &[("split", "group")],
        is_fault: true,
        make: |seed| vibrations(seed, 8, true),
    },
    Plant {
        about: "two days with other sensors",
        checks: &[("split", "session")],
        is_fault: false,
        make: |seed| {
            let mut rng = rng("days", seed);
            let labels = shuffled_labels(&mut rng, 6, 40);
            let sessions: Vec<usize> = (0..240).map(|k| k / 120).collect();
            let patterns = [normals(&mut rng, 6, 24), normals(&mut rng, 6, 24)];
            let set = Set::new(rng, labels, 1, |touch, class, rng| {
                (0..24)
                    .map(|k| patterns[touch / 120][(class, k)] + 0.3 * normal(rng))
                    .collect()
            });
            Set {
                sessions: Some(sessions),
                ..set
            }
        },
    },
    Plant {
        about: "one subject of each class",
        checks: &[("split", "group")],
        is_fault: true,
        make: |seed| {
            let mut set = Set::discs(seed);
            let subjects = set.labels.clone();
            set.add_styles(&subjects, 0.1);
            Set {
                groups: Some(subjects),
                ..set
            }
        },
    },
    Plant {
        about: "subjects of one class each",
        checks: &[("split", "group")],
        is_fault: true,
        make: |seed| instances(seed, 4),
    },
    Plant {
        about: "instances of one class each",
        checks: &[("split", "group")],
        is_fault: true,
        make: |seed| instances(seed, 12),
    },
    Plant {
        about: "a test set that shares all groups with training",
        checks: &[("shared", "groups")],
        is_fault: true,
        make: |seed| {
            let mut set = instances(seed, 6);
            set.is_test = Some((0..set.n()).map(|_| set.rng.gen_bool(0.3)).collect());
            set
        },
    },
    Plant {
        about: "copies that cross from training to the test set",
        checks: &[("copies", "")],
        is_fault: true,
        make: |seed| {
            let mut set = Set::discs(seed);
            set.is_test = Some((0..set.n()).map(|k| k % 3 == 0).collect());
            copy(&mut set, 9, |k| (3 * k, 3 * k + 100), 0.0);
            set
        },
    },
    Plant {
        about: "copies with noise",
        checks: &[("copies", "")],
        is_fault: true,
        make: |seed| {
            let mut set = Set::discs(seed);
            copy(&mut set, 9, |k| (10 * k, 10 * k + 155), 0.002);
            set
        },
    },
    Plant {
        about: "copies of all touches, as after augmentation",
        checks: &[("copies", "")],
        is_fault: true,
        make: |seed| {
            let mut set = Set::discs(seed);
            let n = set.n();
            let noise = 0.002 * normals(&mut set.rng, n, 144);
            let copied = &set.frames + &noise;
            set.frames = concatenate(Axis(0), &[set.frames.view(), copied.view()]).unwrap();
            set.labels = [&set.labels[..], &set.labels[..]].concat();
            set
        },
    },
    Plant {
        about: "a class code in one taxel",
        checks: &[("single_taxel", "")],
        is_fault: false,
        make: |seed| {
            let mut set = Set::discs(seed);
            for k in 0..set.n() {
                set.frames[(k, 1)] = 0.02 * set.labels[k] as f64;
            }
            set
        },
    },
    Plant {
        about: "a class code in a taxel that the user names as untouched",
        checks: &[("untouched", "")],
        is_fault: true,
        make: |seed| {
            let mut set = Set::discs(seed);
            for k in 0..set.n() {
                set.frames[(k, 1)] += 0.02 * set.labels[k] as f64;
            }
            set.options.untouched = vec![0, 1, 12];
            set
        },
    },
    Plant {
        about: "an all-zero channel of four",
        checks: &[("constant_taxels", "")],
        is_fault: false,
        make: |seed| {
            let mut set = channels(seed, 4);
            set.frames.column_mut(2).fill(0.0);
            set
        },
    },
    Plant {
        about: "two equal channels",
        checks: &[("equal_taxels", "")],
        is_fault: false,
        make: |seed| {
            let mut set = channels(seed, 6);
            let own = set.frames.column(1).to_owned();
            set.frames.column_mut(4).assign(&own);
            set
        },
    },
    Plant {
        about: "two proportional channels",
        checks: &[("equal_taxels", "")],
        is_fault: false,
        make: |seed| {
            let mut set = channels(seed, 6);
            let own = set.frames.column(1).mapv(|x| -2.0 * x);
            set.frames.column_mut(4).assign(&own);
            set
        },
    },
    Plant {
        about: "contact that decays with exp(−t/30 s)",
        checks: &[("drift", "contact")],
        is_fault: false,
        make: |seed| {
            let mut set = Set::discs(seed);
            for (k, mut row) in set.frames.rows_mut().into_iter().enumerate() {
                row *= 0.4 + 0.6 * (-(k as f64) * 0.5 / 30.0).exp();
            }
            set
        },
    },
    Plant {
        about: "shuffled frames of slow sequences without groups",
        checks: &[("clusters", "")],
        is_fault: false,
        make: |seed| {
            let mut rng = rng("sequences", seed);
            let (starts, moves) = (normals(&mut rng, 20, 40), normals(&mut rng, 20, 40));
            let mut of: Vec<usize> = (0..400).collect();
            of.shuffle(&mut rng);
            let labels = of.iter().map(|k| k / 20 % 5).collect();
            Set::new(rng, labels, 1, |touch, _, rng| {
                let (sequence, t) = (of[touch] / 20, (of[touch] % 20) as f64 / 20.0);
                (0..40)
                    .map(|k| {
                        starts[(sequence, k)] + 0.3 * t * moves[(sequence, k)] + 0.02 * normal(rng)
                    })
                    .collect()
            })
        },
    },
    Plant {
        about: "wrong labels of 10 % of the touches",
        checks: &[("labels", "")],
        is_fault: false,
        make: |seed| {
            let mut set = channels(seed, 16);
            for k in (0..set.n()).step_by(10) {
                set.labels[k] = (set.labels[k] + 1) % 5;
            }
            set
        },
    },
    Plant {
        about: "an offset that drifts",
        checks: &[("drift", "level")],
        is_fault: true,
        make: |seed| {
            let mut set = Set::discs(seed);
            for (k, mut row) in set.frames.rows_mut().into_iter().enumerate() {
                row += 0.05 * k as f64 / 300.0;
            }
            set
        },
    },
    Plant {
        about: "clipped readings",
        checks: &[("saturation", "")],
        is_fault: false,
        make: |seed| {
            let mut set = Set::discs(seed);
            set.frames.mapv_inplace(|x| x.min(0.8));
            set
        },
    },
    Plant {
        about: "taxels that are stuck in one session",
        checks: &[("stuck_taxels", "")],
        is_fault: false,
        make: |seed| {
            let mut set = Set::discs(seed);
            set.sessions = Some((0..300).map(|k| k / 60).collect());
            (60..120).for_each(|k| set.frames[(k, 77)] = 0.31);
            set
        },
    },
    Plant {
        about: "dead taxels",
        checks: &[("constant_taxels", "")],
        is_fault: false,
        make: |seed| {
            let mut set = Set::discs(seed);
            for taxel in [14, 70, 71] {
                set.frames.column_mut(taxel).fill(0.0);
            }
            set
        },
    },
    Plant {
        about: "missing readings that −1 stands for",
        checks: &[("missing_readings", "")],
        is_fault: false,
        make: |seed| {
            let mut set = channels(seed, 16);
            set.frames.mapv_inplace(|x| 500.0 + 20.0 * x);
            (0..12).for_each(|k| set.frames[(19 * k, 5)] = -1.0);
            set
        },
    },
    Plant {
        about: "padding to the longest touch of the class",
        checks: &[("padding", "")],
        is_fault: true,
        make: |seed| {
            let mut rng = rng("padding", seed);
            let labels = shuffled_labels(&mut rng, 4, 50);
            Set::new(rng, labels, 30, |_, class, rng| {
                let end = rng.gen_range(14..18) + 3 * class;
                (0..30 * 6)
                    .map(|k| {
                        if k / 6 < end {
                            1.0 + 0.3 * normal(rng)
                        } else {
                            0.0
                        }
                    })
                    .collect()
            })
        },
    },
    Plant {
        about: "classes that were recorded one after the other, in two rounds",
        checks: &[("order", "")],
        is_fault: true,
        make: |seed| {
            let mut set = Set::discs(seed);
            set.sort_by(|set, k| 5 * (k / 150) + set.labels[k]);
            set
        },
    },
    Plant {
        about: "classes that were recorded in sessions of their own",
        checks: &[("session", "")],
        is_fault: true,
        make: |seed| {
            let mut set = Set::discs(seed);
            let sessions = set.labels.clone().into_iter().map(|class| {
                if set.rng.gen_bool(0.6) {
                    class
                } else {
                    set.rng.gen_range(0..5)
                }
            });
            set.sessions = Some(sessions.collect());
            set
        },
    },
];

/// Windows of 5 classes of vibrations; each of `n` recordings of a class has frequencies of its own, and the class little of it.
fn vibrations(seed: u64, n: usize, is_overlapping: bool) -> Set {
    let mut rng = rng("recordings", seed);
    let n_windows = 8;
    let mut order: Vec<usize> = (0..5 * n * n_windows).collect();
    order.shuffle(&mut rng);
    let recordings: Vec<usize> = order.iter().map(|k| k / n_windows).collect();
    let labels = recordings.iter().map(|recording| recording / n).collect();
    let turns: Vec<f64> = (0..5 * n).map(|_| rng.gen_range(4.0..50.0)).collect();
    let whole = normals(&mut rng, 5 * n, 128 + 16 * n_windows);
    let set = Set::new(rng, labels, 128, |touch, class, rng| {
        let recording = recordings[touch];
        let phase: f64 = rng.gen_range(0.0..TAU);
        let start = 16 * (order[touch] % n_windows);
        let frame = |t: usize, rng: &mut rand_chacha::ChaCha8Rng| match is_overlapping {
            // Windows of one recording of noise, at steps of an eighth of their length, with a weak level of the class.
            true => whole[(recording, start + t)] + 0.1 * class as f64,
            false => (TAU * turns[recording] * t as f64 / 128.0 + phase).sin() + 0.3 * normal(rng),
        };
        (0..128).map(|t| frame(t, rng)).collect()
    });
    Set {
        groups: Some(recordings),
        ..set
    }
}

/// Groups of one class each, `n` of each class, whose styles are larger than the differences of the classes.
fn instances(seed: u64, n: usize) -> Set {
    let mut rng = rng("instances", seed);
    let labels = shuffled_labels(&mut rng, 5, 60);
    let classes = normals(&mut rng, 5, 24);
    let groups: Vec<usize> = labels
        .iter()
        .map(|class| n * class + rng.gen_range(0..n))
        .collect();
    let mut set = Set::new(rng, labels, 1, |_, class, rng| {
        (0..24)
            .map(|k| 0.3 * classes[(class, k)] + 0.4 * normal(rng))
            .collect()
    });
    set.add_styles(&groups, 1.0);
    Set {
        groups: Some(groups),
        ..set
    }
}

fn channels(seed: u64, n: usize) -> Set {
    let mut rng = rng("channels", seed);
    let labels = shuffled_labels(&mut rng, 5, 50);
    let patterns = normals(&mut rng, 5, n);
    Set::new(rng, labels, 1, |_, class, rng| {
        (0..n)
            .map(|k| 2.0 * patterns[(class, k)] + 0.4 * normal(rng))
            .collect()
    })
}

/// Replaces touches by copies of others, with the label of the other touch and noise.
fn copy(set: &mut Set, n: usize, pair: fn(usize) -> (usize, usize), noise: f64) {
    for k in 0..n {
        let (from, to) = pair(k);
        let row = set.frames.row(from).to_owned();
        let row = row.mapv(|x| x + noise * normal(&mut set.rng));
        set.frames.row_mut(to).assign(&row);
        set.labels[to] = set.labels[from];
    }
}

fn is_found(plant: &Plant, findings: &[Finding]) -> bool {
    findings.iter().any(|finding| {
        let is_named = plant
            .checks
            .contains(&(finding.check, &finding.subject[..]));
        is_named
            && matches!(
                (finding.verdict, plant.is_fault),
                (Verdict::Fault, true) | (Verdict::Fault | Verdict::Note, false)
            )
    })
}

#[test]
fn each_plant_is_found_under_its_own_name_in_five_seeds() {
    let missed = PLANTS.par_iter().filter_map(|plant| {
        let seeds: Vec<u64> = (0..5)
            .filter(|&seed| !is_found(plant, &(plant.make)(seed).findings()))
            .collect();
        (!seeds.is_empty()).then(|| {
            let findings = (plant.make)(seeds[0]).findings();
            let own = findings.iter().filter(|finding| {
                plant.checks.iter().any(|check| check.0 == finding.check)
                    || finding.verdict == Verdict::Fault
            });
            let own: Vec<String> = own
                .map(|finding| {
                    format!(
                        "{} {} {:?} {:?} {}",
                        finding.check,
                        finding.subject,
                        finding.verdict,
                        finding.p_holm,
                        finding.sentence
                    )
                })
                .collect();
            format!("{}: seeds {seeds:?}: {own:#?}", plant.about)
        })
    });
    let missed: Vec<String> = missed.collect();
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
