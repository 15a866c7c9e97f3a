//! Planted faults: each is found under its own name in all of five seeds.

use crate::sets::*;
use bubbletouch::audit::{Finding, Verdict};
use ndarray::{Axis, concatenate};
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A planted fault.
struct Plant {
    about: &'static str,
    /// Check and subject under which the fault is found.
    name: (&'static str, &'static str),
    /// Least verdict with which it is found.
    verdict: Verdict,
    make: fn(u64) -> Set,
}

const fn fault(
    about: &'static str,
    check: &'static str,
    subject: &'static str,
    make: fn(u64) -> Set,
) -> Plant {
    Plant {
        about,
        name: (check, subject),
        verdict: Verdict::Fault,
        make,
    }
}

const fn note(
    about: &'static str,
    check: &'static str,
    subject: &'static str,
    make: fn(u64) -> Set,
) -> Plant {
    Plant {
        verdict: Verdict::Note,
        ..fault(about, check, subject, make)
    }
}

const PLANTS: [Plant; 29] = [
    fault(
        "windows of vibration recordings, each with a spectrum of its own",
        "split",
        "group",
        |seed| vibrations(seed, 8, false),
    ),
    fault(
        "overlapping windows of recordings",
        "split",
        "group",
        |seed| vibrations(seed, 8, true),
    ),
    note("two days with other sensors", "split", "session", |seed| {
        let mut rng = rng("days", seed);
        let labels = shuffled_labels(&mut rng, 6, 40);
        let sessions: Vec<usize> = (0..240).map(|k| k / 120).collect();
        let patterns = [normals(&mut rng, 6, 24), normals(&mut rng, 6, 24)];
        let set = Set::new(rng, labels, 1, |touch, class, rng| {
            (0..24)
                .map(|k| patterns[touch / 120][(class, k)] + 0.3 * normal(rng))
                .collect()
        });
        set.sessions(sessions)
    }),
    fault("one subject of each class", "split", "group", |seed| {
        let mut set = Set::discs(seed);
        let subjects = set.labels.clone();
        set.add_styles(&subjects, 0.1);
        set.groups(subjects)
    }),
    fault("subjects of one class each", "split", "group", |seed| {
        instances(seed, 4)
    }),
    fault("instances of one class each", "split", "group", |seed| {
        instances(seed, 12)
    }),
    fault(
        "a test set that shares all groups with training",
        "shared",
        "groups",
        |seed| {
            let mut set = instances(seed, 6);
            set.is_test = Some((0..set.n()).map(|_| set.rng.gen_bool(0.3)).collect());
            set
        },
    ),
    fault(
        "copies that cross from training to the test set",
        "copies",
        "",
        |seed| {
            let mut set = Set::discs(seed);
            set.is_test = Some((0..set.n()).map(|k| k % 3 == 0).collect());
            copy(&mut set, 9, |k| (3 * k, 3 * k + 100), 0.0);
            set
        },
    ),
    fault("copies with noise", "copies", "", |seed| {
        let mut set = Set::discs(seed);
        copy(&mut set, 9, |k| (10 * k, 10 * k + 155), 0.002);
        set
    }),
    fault(
        "copies of all touches, as after augmentation",
        "copies",
        "",
        |seed| {
            let mut set = Set::discs(seed);
            let n = set.n();
            let noise = 0.002 * normals(&mut set.rng, n, 144);
            let copied = &set.frames + &noise;
            set.frames = concatenate(Axis(0), &[set.frames.view(), copied.view()]).unwrap();
            set.labels = [&set.labels[..], &set.labels[..]].concat();
            set
        },
    ),
    note("a class code in one taxel", "single_taxel", "", |seed| {
        let mut set = Set::discs(seed);
        for k in 0..set.n() {
            set.frames[(k, 1)] = 0.02 * set.labels[k] as f64;
        }
        set
    }),
    fault(
        "a class code in a taxel that the user names as untouched",
        "untouched",
        "",
        |seed| {
            let mut set = Set::discs(seed);
            for k in 0..set.n() {
                set.frames[(k, 1)] += 0.02 * set.labels[k] as f64;
            }
            set.options.untouched = vec![0, 1, 12];
            set
        },
    ),
    note(
        "an all-zero channel of four",
        "constant_taxels",
        "",
        |seed| {
            let mut set = channels(seed, 4);
            set.frames.column_mut(2).fill(0.0);
            set
        },
    ),
    note("two equal channels", "equal_taxels", "", |seed| {
        let mut set = channels(seed, 6);
        let own = set.frames.column(1).to_owned();
        set.frames.column_mut(4).assign(&own);
        set
    }),
    note("two proportional channels", "equal_taxels", "", |seed| {
        let mut set = channels(seed, 6);
        let own = set.frames.column(1).mapv(|x| -2.0 * x);
        set.frames.column_mut(4).assign(&own);
        set
    }),
    note(
        "contact that decays with exp(−t/30 s)",
        "drift",
        "contact",
        |seed| {
            let mut set = Set::discs(seed);
            for (k, mut row) in set.frames.rows_mut().into_iter().enumerate() {
                row *= 0.4 + 0.6 * (-(k as f64) * 0.5 / 30.0).exp();
            }
            set
        },
    ),
    note(
        "shuffled frames of slow sequences without groups",
        "clusters",
        "",
        |seed| {
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
    ),
    note(
        "wrong labels of 10 % of the touches",
        "labels",
        "",
        |seed| {
            let mut set = channels(seed, 16);
            for k in (0..set.n()).step_by(10) {
                set.labels[k] = (set.labels[k] + 1) % 5;
            }
            set
        },
    ),
    fault("an offset that drifts", "drift", "level", |seed| {
        let mut set = Set::discs(seed);
        for (k, mut row) in set.frames.rows_mut().into_iter().enumerate() {
            row += 0.05 * k as f64 / 300.0;
        }
        set
    }),
    note("clipped readings", "saturation", "", |seed| {
        let mut set = Set::discs(seed);
        set.frames.mapv_inplace(|x| x.min(0.8));
        set
    }),
    note(
        "taxels that are stuck in one session",
        "stuck_taxels",
        "",
        |seed| {
            let mut set = Set::discs(seed);
            set.sessions = Some((0..300).map(|k| k / 60).collect());
            (60..120).for_each(|k| set.frames[(k, 77)] = 0.31);
            set
        },
    ),
    note("dead taxels", "constant_taxels", "", |seed| {
        let mut set = Set::discs(seed);
        for taxel in [14, 70, 71] {
            set.frames.column_mut(taxel).fill(0.0);
        }
        set
    }),
    note(
        "missing readings that −1 stands for",
        "missing_readings",
        "",
        |seed| {
            let mut set = channels(seed, 16);
            set.frames.mapv_inplace(|x| 500.0 + 20.0 * x);
            (0..12).for_each(|k| set.frames[(19 * k, 5)] = -1.0);
            set
        },
    ),
    fault(
        "padding to the longest touch of the class",
        "padding",
        "",
        |seed| {
            Set::of("padding", seed, [4, 50], 30, |_, class, rng| {
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
    ),
    fault(
        "classes that were recorded one after the other, in two rounds",
        "order",
        "",
        |seed| {
            let mut set = Set::discs(seed);
            set.sort_by(|set, k| 5 * (k / 150) + set.labels[k]);
            set
        },
    ),
    fault(
        "classes that were recorded in sessions of their own",
        "session",
        "",
        |seed| {
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
    ),
    fault(
        "classes that share groups unevenly",
        "split",
        "group",
        |seed| {
            // Each of 20 subjects has mostly one class, and a style of its own.
            let mut rng = rng("uneven", seed);
            let subjects: Vec<usize> = (0..300).map(|k| k % 20).collect();
            let class = |subject: usize, rng: &mut ChaCha8Rng| match rng.gen_bool(0.8) {
                true => subject % 5,
                false => rng.gen_range(0..5),
            };
            let labels = subjects
                .iter()
                .map(|&subject| class(subject, &mut rng))
                .collect();
            let mut set = Set::new(rng, labels, 1, |_, _, rng| {
                (0..24).map(|_| 0.4 * normal(rng)).collect()
            });
            set.add_styles(&subjects, 1.0);
            let labels = set.labels.clone();
            set.add_styles(&labels, 0.15);
            set.groups(subjects)
        },
    ),
    fault(
        "groups of one class each that training and test share",
        "shared",
        "groups",
        |seed| {
            let mut set = instances(seed, 8);
            set.is_test = Some((0..set.n()).map(|k| k % 4 == 0).collect());
            set
        },
    ),
    note(
        "two days, in each of which the touches of a class are alike",
        "split",
        "group",
        |seed| {
            let mut set = Set::of("two days", seed, [5, 40], 1, |_, _, rng| {
                (0..24).map(|_| 0.3 * normal(rng)).collect()
            });
            let days: Vec<usize> = (0..set.n()).map(|k| k * 2 / set.n()).collect();
            let cells: Vec<usize> = (0..set.n()).map(|k| 2 * set.labels[k] + days[k]).collect();
            set.add_styles(&cells, 1.0);
            set.groups(days)
        },
    ),
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
        let frame = |t: usize, rng: &mut ChaCha8Rng| match is_overlapping {
            // Windows of one recording of noise, at steps of an eighth of their length, with a weak level of the class.
            true => whole[(recording, start + t)] + 0.1 * class as f64,
            false => (TAU * turns[recording] * t as f64 / 128.0 + phase).sin() + 0.3 * normal(rng),
        };
        (0..128).map(|t| frame(t, rng)).collect()
    });
    set.groups(recordings)
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
    set.groups(groups)
}

fn channels(seed: u64, n: usize) -> Set {
    let patterns = patterns("channels", seed, 5, n);
    Set::of("channels", seed, [5, 50], 1, |_, class, rng| {
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

#[test]
fn each_plant_is_found_under_its_own_name_in_five_seeds() {
    let missed = PLANTS
        .par_iter()
        .flat_map(|plant| (0..5).into_par_iter().map(move |seed| (plant, seed)));
    let missed = missed.filter_map(|(plant, seed)| {
        let findings = (plant.make)(seed).findings();
        let is_found = |finding: &Finding| {
            plant.name == (&finding.check[..], &finding.subject[..])
                && finding.verdict <= plant.verdict
                && finding.verdict != Verdict::NotChecked
        };
        (!findings.iter().any(is_found)).then(|| {
            let own = findings.into_iter().filter(|finding| {
                finding.check == plant.name.0 || finding.verdict == Verdict::Fault
            });
            format!(
                "{}, seed {seed}: {:#?}",
                plant.about,
                own.collect::<Vec<_>>()
            )
        })
    });
    let missed: Vec<String> = missed.collect();
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
