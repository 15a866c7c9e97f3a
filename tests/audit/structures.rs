//! Clean designs that are often taken for faults: at most one of three seeds has a fault.

use crate::sets::*;
use bubbletouch::audit::Verdict;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

type Structure = (&'static str, fn(u64) -> Set);

const STRUCTURES: [Structure; 17] = [
    ("classes of Fz and Tz of a wrist", |seed| {
        Set::of("fz", seed, [4, 50], 1, |_, class, rng| {
            row(6, |k| {
                f64::from(k == 2 || k == 5) * class as f64 * rng.gen_range(0.8..1.2)
                    + 0.3 * normal(rng)
            })
        })
    }),
    ("tails of optical imprints", |seed| {
        let set = Set::of("tails", seed, [4, 50], 1, |_, class, rng| {
            let place: (f64, f64) = (rng.gen_range(5.0..7.0), rng.gen_range(5.0..7.0));
            let reading = |taxel: usize| {
                let away = ((taxel / 12) as f64 - place.0).hypot((taxel % 12) as f64 - place.1);
                (-away / (1.0 + class as f64)).exp()
            };
            row(144, |taxel| reading(taxel) + 0.01 * normal(rng))
        });
        set.grid((12, 12))
    }),
    ("crosstalk of 2 %", |seed| {
        let mut set = Set::discs(seed);
        for mut row in set.frames.rows_mut() {
            let all = row.sum();
            row.mapv_inplace(|x| x + 0.02 * all / 10.0);
        }
        set
    }),
    ("classes of stiffness with light contacts", |seed| {
        Set::of("stiffness", seed, [5, 40], 20, |_, class, rng| {
            let start = rng.gen_range(4..6);
            let reading = |t: usize, k: usize| {
                let depth = t.saturating_sub(start) as f64 / 16.0;
                (0.3 + class as f64) * depth * (1.0 - (k as f64 - 3.5).abs() / 8.0)
            };
            row(160, |k| reading(k / 8, k % 8) + 0.05 * normal(rng))
        })
    }),
    ("two random groups of each class", |seed| {
        let mut set = Set::discs(seed);
        let classes = set.labels.clone().into_iter();
        let groups = classes.map(|class| 2 * class + set.rng.gen_range(0..2));
        set.groups = Some(groups.collect());
        set
    }),
    ("a random half as test set", |seed| {
        let mut set = Set::discs(seed);
        set.is_test = Some((0..set.n()).map(|_| set.rng.r#gen()).collect());
        set
    }),
    ("sessions of runs of classes", |seed| {
        // Each session contains a run of each class, in random order; each run has a style.
        let mut rng = rng("runs", seed);
        let runs = (0..10).flat_map(|_| {
            let mut classes = vec![0, 1, 2, 3, 4];
            classes.shuffle(&mut rng);
            classes
        });
        let labels: Vec<usize> = runs.flat_map(|class| [class; 6]).collect();
        let mut set = Set::of_discs(rng, labels);
        let runs: Vec<usize> = (0..set.n()).map(|k| k / 6).collect();
        set.add_styles(&runs, 0.02);
        set.groups = Some((0..set.n()).map(|k| k / 30).collect());
        set
    }),
    ("four sides of ten independent touches", |seed| {
        let sides = patterns("sides", seed, 20, 30);
        Set::of("sides", seed, [5, 40], 1, |_, class, rng| {
            let side = 4 * class + rng.gen_range(0..4);
            row(30, |k| sides[(side, k)] + 0.2 * normal(rng))
        })
    }),
    ("objects that share a part", |seed| {
        let parts = patterns("parts", seed, 5, 30);
        Set::of("parts", seed, [4, 60], 1, |_, class, rng| {
            let part = if rng.gen_bool(0.3) { 4 } else { class };
            row(30, |k| parts[(part, k)] + 0.3 * normal(rng))
        })
    }),
    ("subjects with habits", |seed| {
        let mut rng = rng("habits", seed);
        let labels = shuffled_labels(&mut rng, 5, 60);
        let groups: Vec<usize> = (0..300).map(|_| rng.gen_range(0..15)).collect();
        let (classes, habits) = (normals(&mut rng, 5, 24), normals(&mut rng, 15, 24));
        let set = Set::new(rng, labels, 1, |touch, class, rng| {
            row(24, |k| {
                classes[(class, k)] + 0.5 * habits[(groups[touch], k)] + 0.4 * normal(rng)
            })
        });
        set.groups(groups)
    }),
    ("sessions sorted by class", |seed| {
        let mut set = Set::discs(seed);
        let n = set.n();
        set.sessions = Some((0..n).map(|k| k * 6 / n).collect());
        let sessions = set.sessions.clone().unwrap();
        set.add_styles(&sessions, 0.01);
        set.sort_by(|set, k| 100 * set.sessions.as_ref().unwrap()[k] + set.labels[k]);
        set
    }),
    ("twenty subjects, six classes, four touches", |seed| {
        let mut rng = rng("subjects", seed);
        let order = (0..20).flat_map(|_| {
            let mut classes: Vec<usize> = (0..24).map(|k| k % 6).collect();
            classes.shuffle(&mut rng);
            classes
        });
        let labels: Vec<usize> = order.collect();
        let classes = normals(&mut rng, 6, 24);
        let mut set = Set::new(rng, labels, 1, |_, class, rng| {
            row(24, |k| classes[(class, k)] + 0.5 * normal(rng))
        });
        let groups: Vec<usize> = (0..480).map(|k| k / 24).collect();
        set.add_styles(&groups, 0.4);
        let cells: Vec<usize> = (0..480).map(|k| 6 * groups[k] + set.labels[k]).collect();
        set.add_styles(&cells, 0.4);
        set.groups(groups)
    }),
    ("each subject touches each object once", |seed| {
        let objects = patterns("once", seed, 17, 24);
        let labels = (0..13 * 17).map(|k| k % 17).collect();
        let mut set = Set::new(rng("once", seed), labels, 1, |_, class, rng| {
            row(24, |k| objects[(class, k)] + 0.4 * normal(rng))
        });
        let subjects: Vec<usize> = (0..set.n()).map(|k| k / 17).collect();
        set.add_styles(&subjects, 0.2);
        set.groups(subjects)
    }),
    ("a subtracted first frame", |seed| {
        let patterns = patterns("subtracted", seed, 4, 12);
        Set::of("subtracted", seed, [4, 50], 8, |_, class, rng| {
            let force: f64 = rng.gen_range(0.8..1.2);
            let reading = |t: usize, k: usize, rng: &mut ChaCha8Rng| match t {
                0 => 0.0,
                t => force * (3.0 + patterns[(class, k)]) * t as f64 + 0.2 * normal(rng),
            };
            row(96, |k| reading(k / 12, k % 12, rng))
        })
    }),
    ("people lying still on a mat", |seed| {
        // 24 people, each still for 12 frames in a posture; a person has a weight and a place.
        let mut rng = rng("still", seed);
        let mut postures: Vec<usize> = (0..24).map(|k| k % 3).collect();
        postures.shuffle(&mut rng);
        let labels: Vec<usize> = postures.iter().flat_map(|&class| [class; 12]).collect();
        let ranges = [4.0..7.0, 4.0..7.0, 0.5..1.5];
        let mut person = || ranges.clone().map(|range| rng.gen_range(range));
        let people: Vec<[f64; 3]> = (0..24).map(|_| person()).collect();
        let set = Set::new(rng, labels, 1, |touch, class, rng| {
            let [y, x, weight] = people[touch / 12];
            let frame = disc(12, (y, x), 1.0 + class as f64, weight);
            frame.into_iter().map(|x| x + 0.01 * normal(rng)).collect()
        });
        set.grid((12, 12))
            .groups((0..288).map(|k| k / 12).collect())
    }),
    ("a few empty frames", |seed| {
        let mut set = Set::discs(seed);
        for k in [40, 170, 260] {
            for taxel in 0..144 {
                set.frames[(k, taxel)] = 0.02 * normal(&mut set.rng);
            }
        }
        set
    }),
    ("days with levels of their own", |seed| {
        let mut set = Set::discs(seed);
        let days: Vec<usize> = (0..set.n()).map(|k| k / 30).collect();
        set.add_styles(&days, 0.01);
        set.groups = Some(days.clone());
        set.sessions = Some(days);
        set
    }),
];

#[test]
fn clean_designs_have_at_most_one_fault_in_three_seeds() {
    for (name, make) in STRUCTURES {
        let found: Vec<_> = (0..3).map(|seed| faults(&make(seed).findings())).collect();
        let n_faulty = found.iter().filter(|faults| !faults.is_empty()).count();
        assert!(n_faulty <= 1, "{name}: {found:#?}");
    }
}

/// Frames that are each scaled by their own maximum have a note that says so, and no copies.
#[test]
fn frames_that_are_scaled_one_by_one_are_no_copies() {
    for seed in 0..5 {
        let mut set = Set::discs(seed);
        for mut row in set.frames.rows_mut() {
            let least = row.iter().copied().fold(f64::INFINITY, f64::min);
            let largest = row.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            row.mapv_inplace(|x| (x - least) / (largest - least));
        }
        let findings = set.findings();
        assert!(faults(&findings).is_empty(), "{:?}", faults(&findings));
        let mut sentences = findings.iter().map(|finding| &finding.sentence);
        assert!(sentences.any(|sentence| sentence.contains("scaled by its own maximum")));
    }
}

/// Right labels of objects that share a part are a list to look at, and the advice does not change them.
#[test]
fn shared_parts_are_no_wrong_labels() {
    let mut structures = STRUCTURES.iter();
    let parts = structures.find(|of| of.0 == "objects that share a part");
    let findings = (parts.unwrap().1)(5).findings();
    let mut findings = findings.iter();
    let labels = findings.find(|finding| finding.check == "labels").unwrap();
    assert_ne!(labels.verdict, Verdict::Fault);
    assert!(!labels.advice.contains("orrect"), "{}", labels.advice);
}
