//! Planted faults: each is found under its own name in all of five seeds.

use crate::sets::*;
use bubbletouch::audit::Verdict;
use ndarray::{Axis, concatenate};
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A planted fault.
struct Plant {
    /// Check and subject under which the fault is found.
    name: &'static str,
    about: &'static str,
    /// Least verdict with which it is found.
    verdict: Verdict,
    make: fn(u64) -> Set,
}

const fn fault(name: &'static str, about: &'static str, make: fn(u64) -> Set) -> Plant {
    Plant {
        name,
        about,
        verdict: Verdict::Fault,
        make,
    }
}

const fn note(name: &'static str, about: &'static str, make: fn(u64) -> Set) -> Plant {
    Plant {
        verdict: Verdict::Note,
        ..fault(name, about, make)
    }
}

const PLANTS: [Plant; 29] = [
    fault("split group", "windows of recordings", |seed| {
        vibrations(seed, 8, false)
    }),
    fault("split group", "overlapping windows", |seed| {
        vibrations(seed, 8, true)
    }),
    note("split session", "two days with other sensors", |seed| {
        let mut rng = rng("days", seed);
        let labels = shuffled_labels(&mut rng, 6, 40);
        let sessions: Vec<usize> = (0..240).map(|k| k / 120).collect();
        let patterns = [normals(&mut rng, 6, 24), normals(&mut rng, 6, 24)];
        let set = Set::new(rng, labels, 1, |touch, class, rng| {
            row(24, |k| {
                patterns[touch / 120][(class, k)] + 0.3 * normal(rng)
            })
        });
        set.sessions(sessions)
    }),
    fault("split group", "one subject of each class", |seed| {
        let mut set = Set::discs(seed);
        let subjects = set.labels.clone();
        set.add_styles(&subjects, 0.1);
        set.groups(subjects)
    }),
    fault("split group", "subjects of one class each", |seed| {
        instances(seed, 4)
    }),
    fault("split group", "instances of one class each", |seed| {
        instances(seed, 12)
    }),
    fault("shared groups", "a test set of all groups", |seed| {
        let mut set = instances(seed, 6);
        set.is_test = Some((0..set.n()).map(|_| set.rng.gen_bool(0.3)).collect());
        set
    }),
    fault("copies", "copies in the test set", |seed| {
        let mut set = Set::discs(seed);
        set.is_test = Some((0..set.n()).map(|k| k % 3 == 0).collect());
        copy(&mut set, 9, |k| (3 * k, 3 * k + 100), 0.0);
        set
    }),
    fault("copies", "copies with noise", |seed| {
        let mut set = Set::discs(seed);
        copy(&mut set, 9, |k| (10 * k, 10 * k + 155), 0.002);
        set
    }),
    fault("copies", "copies of all touches", |seed| {
        let mut set = Set::discs(seed);
        let n = set.n();
        let noise = 0.002 * normals(&mut set.rng, n, 144);
        let copied = &set.frames + &noise;
        set.frames = concatenate(Axis(0), &[set.frames.view(), copied.view()]).unwrap();
        set.labels = [&set.labels[..], &set.labels[..]].concat();
        set
    }),
    note("single_taxel", "a class code in one taxel", |seed| {
        let mut set = Set::discs(seed);
        for k in 0..set.n() {
            set.frames[(k, 1)] = 0.02 * set.labels[k] as f64;
        }
        set
    }),
    fault("untouched", "a class code in an untouched taxel", |seed| {
        let mut set = Set::discs(seed);
        for k in 0..set.n() {
            set.frames[(k, 1)] += 0.02 * set.labels[k] as f64;
        }
        set.options.untouched = vec![0, 1, 12];
        set
    }),
    note("constant_taxels", "an all-zero channel of four", |seed| {
        let mut set = channels(seed, 4);
        set.frames.column_mut(2).fill(0.0);
        set
    }),
    note("equal_taxels", "two equal channels", |seed| {
        let mut set = channels(seed, 6);
        let own = set.frames.column(1).to_owned();
        set.frames.column_mut(4).assign(&own);
        set
    }),
    note("equal_taxels", "two proportional channels", |seed| {
        let mut set = channels(seed, 6);
        let own = set.frames.column(1).mapv(|x| -2.0 * x);
        set.frames.column_mut(4).assign(&own);
        set
    }),
    note("drift contact", "contact that decays in 30 s", |seed| {
        let mut set = Set::discs(seed);
        for (k, mut row) in set.frames.rows_mut().into_iter().enumerate() {
            row *= 0.4 + 0.6 * (-(k as f64) * 0.5 / 30.0).exp();
        }
        set
    }),
    note("clusters", "shuffled frames of sequences", |seed| {
        let mut rng = rng("sequences", seed);
        let (starts, moves) = (normals(&mut rng, 20, 40), normals(&mut rng, 20, 40));
        let mut of: Vec<usize> = (0..400).collect();
        of.shuffle(&mut rng);
        let labels = of.iter().map(|k| k / 20 % 5).collect();
        Set::new(rng, labels, 1, |touch, _, rng| {
            let (sequence, t) = (of[touch] / 20, (of[touch] % 20) as f64 / 20.0);
            row(40, |k| {
                starts[(sequence, k)] + 0.3 * t * moves[(sequence, k)] + 0.02 * normal(rng)
            })
        })
    }),
    note("labels", "wrong labels of 10 % of touches", |seed| {
        let mut set = channels(seed, 16);
        for k in (0..set.n()).step_by(10) {
            set.labels[k] = (set.labels[k] + 1) % 5;
        }
        set
    }),
    fault("drift level", "an offset that drifts", |seed| {
        let mut set = Set::discs(seed);
        for (k, mut row) in set.frames.rows_mut().into_iter().enumerate() {
            row += 0.05 * k as f64 / 300.0;
        }
        set
    }),
    note("saturation", "clipped readings", |seed| {
        let mut set = Set::discs(seed);
        set.frames.mapv_inplace(|x| x.min(0.8));
        set
    }),
    note("stuck_taxels", "a taxel stuck in one session", |seed| {
        let mut set = Set::discs(seed);
        set.sessions = Some((0..300).map(|k| k / 60).collect());
        (60..120).for_each(|k| set.frames[(k, 77)] = 0.31);
        set
    }),
    note("constant_taxels", "dead taxels", |seed| {
        let mut set = Set::discs(seed);
        for taxel in [14, 70, 71] {
            set.frames.column_mut(taxel).fill(0.0);
        }
        set
    }),
    note("missing_readings", "missing readings as −1", |seed| {
        let mut set = channels(seed, 16);
        set.frames.mapv_inplace(|x| 500.0 + 20.0 * x);
        (0..12).for_each(|k| set.frames[(19 * k, 5)] = -1.0);
        set
    }),
    fault("padding", "padding by class", |seed| {
        Set::of("padding", seed, [4, 50], 30, |_, class, rng| {
            let end = rng.gen_range(14..18) + 3 * class;
            row(30 * 6, |k| match k / 6 < end {
                true => 1.0 + 0.3 * normal(rng),
                false => 0.0,
            })
        })
    }),
    fault("order", "classes one after the other", |seed| {
        let mut set = Set::discs(seed);
        set.sort_by(|set, k| 5 * (k / 150) + set.labels[k]);
        set
    }),
    fault("session", "classes in sessions of their own", |seed| {
        let mut set = Set::discs(seed);
        let classes = set.labels.clone().into_iter();
        let sessions = classes.map(|class| match set.rng.gen_bool(0.6) {
            true => class,
            false => set.rng.gen_range(0..5),
        });
        set.sessions = Some(sessions.collect());
        set
    }),
    fault("split group", "classes in groups unevenly", |seed| {
        // Each of 20 subjects has mostly one class, and a style of its own.
        let mut rng = rng("uneven", seed);
        let subjects: Vec<usize> = (0..300).map(|k| k % 20).collect();
        let class = |&subject: &usize| match rng.gen_bool(0.8) {
            true => subject % 5,
            false => rng.gen_range(0..5),
        };
        let labels = subjects.iter().map(class).collect();
        let mut set = Set::new(rng, labels, 1, |_, _, rng| row(24, |_| 0.4 * normal(rng)));
        set.add_styles(&subjects, 1.0);
        let labels = set.labels.clone();
        set.add_styles(&labels, 0.15);
        set.groups(subjects)
    }),
    fault("shared groups", "a test set of groups", |seed| {
        let mut set = instances(seed, 8);
        set.is_test = Some((0..set.n()).map(|k| k % 4 == 0).collect());
        set
    }),
    note("split group", "two days of alike touches", |seed| {
        let mut set = Set::of("two days", seed, [5, 40], 1, |_, _, rng| {
            row(24, |_| 0.3 * normal(rng))
        });
        let days: Vec<usize> = (0..set.n()).map(|k| k * 2 / set.n()).collect();
        let cells: Vec<usize> = (0..set.n()).map(|k| 2 * set.labels[k] + days[k]).collect();
        set.add_styles(&cells, 1.0);
        set.groups(days)
    }),
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
        row(128, |t| frame(t, rng))
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
        row(24, |k| 0.3 * classes[(class, k)] + 0.4 * normal(rng))
    });
    set.add_styles(&groups, 1.0);
    set.groups(groups)
}

fn channels(seed: u64, n: usize) -> Set {
    let patterns = patterns("channels", seed, 5, n);
    Set::of("channels", seed, [5, 50], 1, |_, class, rng| {
        row(n, |k| 2.0 * patterns[(class, k)] + 0.4 * normal(rng))
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
    let sets = PLANTS
        .par_iter()
        .flat_map(|plant| (0..5).into_par_iter().map(move |seed| (plant, seed)));
    let missed = sets.filter_map(|(plant, seed)| {
        let findings = (plant.make)(seed).findings();
        let is_found = findings.iter().any(|finding| {
            let name = format!("{} {}", finding.check, finding.subject);
            let is_own = plant.name == name.trim_end();
            is_own && finding.verdict <= plant.verdict && finding.verdict != Verdict::NotChecked
        });
        let others = faults(&findings);
        (!is_found).then(|| format!("{} ({}), seed {seed}: {others:#?}", plant.name, plant.about))
    });
    let missed: Vec<String> = missed.collect();
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
