//! Clean sets of twenty kinds: at most 5 % of them have any fault.

use crate::sets::*;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Poisson};
use rayon::prelude::*;
use std::f64::consts::TAU;

type Kind = (&'static str, fn(u64) -> Set);

const KINDS: [Kind; 20] = [
    ("wrist force and torque", wrist),
    ("optical images with vignetting", optical),
    ("electrodes with a common temperature", electrodes),
    ("capacitive counts", capacitive),
    ("vibration series", vibration),
    ("mats", mat),
    ("gloves of subjects", gloves),
    ("insoles", insoles),
    ("two hundred classes", many_classes),
    ("several sessions", sessions),
    ("bytes in a list", bytes),
    ("events", events),
    ("no noise", noiseless),
    // Kinds that were not used to choose a constant of the audit.
    ("gloves with the gains of subjects", gains),
    ("insoles of walkers with paces", walkers),
    ("wrist force and torque, mounted again", mountings),
    ("optical images under the lamp of the day", lamps),
    (
        "electrodes with the temperature of the session",
        temperatures,
    ),
    ("mats on five mornings", mornings),
    ("two hundred classes in five rounds", rounds),
];

/// Units of touches in the order of recording: `n` runs of equal length.
fn runs(n_touches: usize, n: usize) -> Vec<usize> {
    (0..n_touches).map(|k| k * n / n_touches).collect()
}

/// 14 subjects, each with gains of the taxels and an offset of the hand.
fn gains(seed: u64) -> Set {
    let (patterns, hands) = (
        patterns("gains", seed, 6, 22),
        patterns("hands", seed, 14, 22),
    );
    let subjects = runs(6 * 56, 14);
    let of = subjects.clone();
    let set = Set::of("gains", seed, [6, 56], 1, |touch, class, rng| {
        let force: f64 = rng.gen_range(0.6..1.4);
        let cell = |k: usize, rng: &mut ChaCha8Rng| {
            let gain = (0.25 * hands[(of[touch], k)]).exp();
            gain * force * (2.0 + patterns[(class, k)]) + 0.3 * normal(rng)
        };
        row(22, |k| cell(k, rng))
    });
    set.groups(subjects)
}

/// 10 walkers, each with a pace and a weight; four gaits.
fn walkers(seed: u64) -> Set {
    let (gaits, styles) = (
        patterns("gaits", seed, 4, 16),
        patterns("walkers", seed, 10, 2),
    );
    let walkers = runs(240, 10);
    let of = walkers.clone();
    let set = Set::of("walkers", seed, [4, 60], 24, |touch, class, rng| {
        let style = styles.row(of[touch]);
        let pace = 1.0 + 0.06 * style[0] + 0.03 * normal(rng);
        let weight = 80.0 * (1.0 + 0.15 * style[1]);
        let cell = |t: usize, k: usize, rng: &mut ChaCha8Rng| {
            let place = (pace * t as f64 / 24.0 - k as f64 / 16.0) * 3.0;
            let load = weight * (0.3 * gaits[(class, k)]).exp() * (-place * place).exp();
            (load + 2.0 * normal(rng)).max(0.0)
        };
        row(24 * 16, |k| cell(k / 16, k % 16, rng))
    });
    set.groups(walkers)
}

/// A wrist sensor that was mounted 9 times, each time with another zero.
fn mountings(seed: u64) -> Set {
    let axes = patterns("mountings", seed, 5, 6);
    let mut set = Set::of("mountings", seed, [5, 54], 1, |_, class, rng| {
        let force: f64 = rng.gen_range(2.0..6.0);
        row(6, |k| force * axes[(class, k)] + 0.4 * normal(rng))
    });
    let mountings = runs(set.n(), 9);
    set.add_styles(&mountings, 0.8);
    set.sessions(mountings)
}

/// Optical images with vignetting, on 10 days with a lamp of another brightness.
fn lamps(seed: u64) -> Set {
    let lamps = patterns("lamps", seed, 10, 1);
    let days = runs(240, 10);
    let of = days.clone();
    let set = Set::of("lamps", seed, [4, 60], 1, |touch, class, rng| {
        let place = (rng.gen_range(5.0..9.0), rng.gen_range(5.0..9.0));
        let (depth, radius) = (rng.gen_range(0.5..1.0), 1.0 + class as f64);
        let lamp = 100.0 * (0.05 * lamps[(of[touch], 0)]).exp();
        let reading = |taxel: usize, rng: &mut ChaCha8Rng| {
            let (y, x) = ((taxel / 14) as f64, (taxel % 14) as f64);
            let away = (y - place.0).hypot(x - place.1) / radius;
            let light = 1.0 - 0.6 * ((y - 6.5).hypot(x - 6.5) / 9.2).powi(2);
            lamp * light * (1.0 + depth / (1.0 + away * away)) + 1.5 * normal(rng)
        };
        row(196, |taxel| reading(taxel, rng))
    });
    set.grid((14, 14)).groups(days)
}

/// Electrodes whose common temperature differs from session to session.
fn temperatures(seed: u64) -> Set {
    let (patterns, warmth) = (
        patterns("temperatures", seed, 6, 19),
        patterns("warmth", seed, 12, 1),
    );
    let sessions = runs(288, 12);
    let of = sessions.clone();
    let set = Set::of("temperatures", seed, [6, 48], 1, |touch, class, rng| {
        let force: f64 = rng.gen_range(0.5..1.5);
        let level = 3000.0 + 40.0 * warmth[(of[touch], 0)];
        let electrode = |k: usize, rng: &mut ChaCha8Rng| {
            level + 50.0 * force * patterns[(class, k)] + 8.0 * normal(rng)
        };
        row(19, |k| electrode(k, rng))
    });
    set.sessions(sessions)
}

/// A mat on five mornings, each with a zero of its own, and one person of many postures.
fn mornings(seed: u64) -> Set {
    let mut set = mat(seed + 500);
    let mornings = runs(set.n(), 5);
    set.add_styles(&mornings, 1.0);
    set.sessions(mornings)
}

/// 200 classes in five rounds, each in another order and with a level of its own.
fn rounds(seed: u64) -> Set {
    let patterns = patterns("rounds", seed, 200, 24);
    let mut rng = rng("rounds", seed);
    let mut labels = Vec::new();
    for _ in 0..5 {
        labels.extend(shuffled_labels(&mut rng, 200, 1));
    }
    let mut set = Set::new(rng, labels, 1, |_, class, rng| {
        row(24, |k| patterns[(class, k)] + 0.4 * normal(rng))
    });
    let rounds = runs(set.n(), 5);
    set.add_styles(&rounds, 0.2);
    set.groups(rounds)
}

fn wrist(seed: u64) -> Set {
    let axes = patterns("wrist", seed, 6, 6);
    Set::of("wrist", seed, [6, 40], 1, |_, class, rng| {
        let force: f64 = rng.gen_range(2.0..8.0);
        row(6, |k| {
            force * axes[(class, k)] + 0.5 * normal(rng) + f64::from(k == 2) * force
        })
    })
}

fn optical(seed: u64) -> Set {
    let set = Set::of("optical", seed, [4, 60], 1, |_, class, rng| {
        let place = (rng.gen_range(5.0..10.0), rng.gen_range(5.0..10.0));
        let (depth, radius) = (rng.gen_range(0.5..1.0), 1.0 + class as f64);
        let reading = |taxel: usize, rng: &mut ChaCha8Rng| {
            let (y, x) = ((taxel / 16) as f64, (taxel % 16) as f64);
            let away = (y - place.0).hypot(x - place.1) / radius;
            let light = 1.0 - 0.5 * ((y - 7.5).hypot(x - 7.5) / 10.6).powi(2);
            120.0 * light * (1.0 + depth / (1.0 + away * away)) + (1.0 + light) * normal(rng)
        };
        row(256, |taxel| reading(taxel, rng))
    });
    set.grid((16, 16))
}

fn electrodes(seed: u64) -> Set {
    let patterns = patterns("electrodes", seed, 8, 19);
    Set::of("electrodes", seed, [8, 30], 1, |_, class, rng| {
        let (temperature, force): (f64, f64) = (normal(rng), rng.gen_range(0.5..1.5));
        row(19, |k| {
            3000.0 + 30.0 * temperature + 50.0 * force * patterns[(class, k)] + 8.0 * normal(rng)
        })
    })
}

fn capacitive(seed: u64) -> Set {
    let mut rng = rng("capacitive", seed);
    let labels = shuffled_labels(&mut rng, 5, 50);
    let base: Vec<f64> = (0..144).map(|_| rng.gen_range(90.0..210.0)).collect();
    let set = Set::new(rng, labels, 1, |_, class, rng| {
        let place = (rng.gen_range(2.0..9.0), rng.gen_range(2.0..9.0));
        let depth = rng.gen_range(20.0..60.0);
        let frame = disc(12, place, 1.0 + 0.5 * class as f64, depth);
        row(144, |k| (frame[k] + base[k] + 1.5 * normal(rng)).round())
    });
    set.grid((12, 12))
}

fn vibration(seed: u64) -> Set {
    let mut rng = rng("vibration", seed);
    let labels = shuffled_labels(&mut rng, 5, 40);
    let groups = (0..200).map(|_| rng.gen_range(0..20)).collect();
    let set = Set::new(rng, labels, 128, |_, class, rng| {
        let phase: f64 = rng.gen_range(0.0..TAU);
        let turns = rng.gen_range(0.95..1.05) * (5.0 + 4.0 * class as f64);
        let frame = |t: usize, rng: &mut ChaCha8Rng| {
            let wave = (TAU * turns * t as f64 / 128.0 + phase).sin();
            [wave + 0.5 * normal(rng), 0.6 * wave + 0.5 * normal(rng)]
        };
        (0..128).flat_map(|t| frame(t, rng)).collect()
    });
    set.groups(groups)
}

fn mat(seed: u64) -> Set {
    let set = Set::of("mat", seed, [4, 50], 1, |_, class, rng| {
        let mut frame = vec![0.0; 256];
        for part in 0..3 {
            let y = 3.0 + 4.0 * f64::from(part) + normal(rng) * 0.4;
            let x = 5.0 + (class * (part as usize + 1)) as f64 % 5.0 + 0.5 * normal(rng);
            let (radius, depth) = (rng.gen_range(1.0..2.0), rng.gen_range(20.0..60.0));
            let own = disc(16, (y, x), radius, depth);
            frame.iter_mut().zip(own).for_each(|(x, own)| *x += own);
        }
        row(256, |k| (frame[k] + 0.7 * normal(rng)).max(0.0))
    });
    set.grid((16, 16))
}

/// 12 subjects, each of 5 classes, whose styles are small beside the classes.
fn gloves(seed: u64) -> Set {
    let mut rng = rng("gloves", seed);
    let labels = shuffled_labels(&mut rng, 5, 60);
    let groups: Vec<usize> = (0..300).map(|_| rng.gen_range(0..12)).collect();
    let (patterns, gains) = (normals(&mut rng, 5, 30), normals(&mut rng, 1, 30));
    let mut set = Set::new(rng, labels, 1, |_, class, rng| {
        let force = rng.gen_range(0.5..1.5);
        row(30, |k| {
            gains[(0, k)].exp() * (force * patterns[(class, k)] + 0.4 * normal(rng))
        })
    });
    set.add_styles(&groups, 0.2);
    set.groups(groups)
}

fn insoles(seed: u64) -> Set {
    let mut rng = rng("insoles", seed);
    let labels = shuffled_labels(&mut rng, 4, 50);
    let groups = (0..200).map(|_| rng.gen_range(0..10)).collect();
    let patterns = normals(&mut rng, 4, 40).mapv(f64::abs);
    let set = Set::new(rng, labels, 20, |_, class, rng| {
        let (force, speed): (f64, f64) = (rng.gen_range(0.8..1.2), rng.gen_range(0.9..1.1));
        let cell = |t: usize, k: usize| {
            let place = (speed * t as f64 / 20.0 - k as f64 / 40.0) * 3.0;
            let load = 100.0 * force * patterns[(class, k)] * (-place * place).exp();
            if k < 36 { load } else { 0.0 }
        };
        let reading = |k: usize| (cell(k / 40, k % 40) + 2.0 * normal(rng)).max(0.0);
        row(800, reading)
    });
    set.groups(groups)
}

fn many_classes(seed: u64) -> Set {
    let patterns = patterns("many classes", seed, 200, 24);
    Set::of("many classes", seed, [200, 5], 1, |_, class, rng| {
        row(24, |k| patterns[(class, k)] + 0.5 * normal(rng))
    })
}

/// Six sessions with levels of their own, each with all classes in random order.
fn sessions(seed: u64) -> Set {
    let mut set = Set::discs(seed + 1000);
    let sessions: Vec<usize> = (0..set.n()).map(|k| k * 6 / set.n()).collect();
    set.add_styles(&sessions, 0.01);
    set.sessions(sessions)
}

fn bytes(seed: u64) -> Set {
    let patterns = patterns("bytes", seed, 5, 32);
    Set::of("bytes", seed, [5, 40], 1, |_, class, rng| {
        let force: f64 = rng.gen_range(0.5..1.0);
        row(32, |k| {
            (60.0 * force * (1.0 + 0.5 * patterns[(class, k)]) + 4.0 * normal(rng))
                .clamp(0.0, 255.0)
                .round()
        })
    })
}

fn events(seed: u64) -> Set {
    let rates = patterns("events", seed, 5, 36).mapv(f64::exp);
    Set::of("events", seed, [5, 40], 10, |_, class, rng| {
        let force: f64 = rng.gen_range(0.5..1.5);
        let one = |k: usize, rng: &mut ChaCha8Rng| {
            Poisson::new(force * rates[(class, k)]).unwrap().sample(rng)
        };
        row(360, |k| one(k % 36, rng))
    })
}

fn noiseless(seed: u64) -> Set {
    let mut rng = rng("no noise", seed);
    let mut labels = shuffled_labels(&mut rng, 4, 60);
    labels.shuffle(&mut rng);
    let set = Set::new(rng, labels, 1, |_, class, rng| {
        let place = (rng.gen_range(3.0..8.0), rng.gen_range(3.0..8.0));
        let radius = 1.0 + 0.6 * class as f64 + rng.gen_range(0.0..0.3);
        disc(12, place, radius, rng.gen_range(0.4..1.0))
    });
    set.grid((12, 12))
}

/// Audits `n` sets and returns those with faults.
fn with_faults(n: usize) -> Vec<String> {
    let sets = (0..n).into_par_iter().filter_map(|k| {
        let (name, kind) = KINDS[k % KINDS.len()];
        let faults = faults(&kind(k as u64).findings());
        (!faults.is_empty()).then(|| format!("{k} {name}: {}", faults.join(" | ")))
    });
    sets.collect()
}

#[test]
fn forty_clean_sets_have_at_most_two_faults() {
    let found = with_faults(40);
    assert!(found.len() <= 2, "{found:#?}");
}

#[test]
#[ignore = "long: run by .ci/long audit"]
fn of_three_hundred_clean_sets_at_most_five_percent_have_a_fault() {
    let found = with_faults(300);
    println!("{} of 300: {found:#?}", found.len());
    assert!(found.len() <= 15, "{found:#?}");
}
