//! Level of each test: in sets of labels that name nothing, 3 to 7 % of the p-values are at most 0.05.

use crate::sets::*;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Number of sets of each design.
const N: usize = 200;
/// Most sets of one design with a p-value of at most 0.05. By the binomial distribution, a larger number has a probability of 1.9e-4 in one of the 55 tests of all
/// designs, and of 1 % in any of them.
const MOST: usize = 22;
/// Tests whose p-values are rarely small. Their statistics have few values, such as the sessions of groups that all contain each class; or, for copies, the p-value
/// is an upper bound.
const DISCRETE: [&str; 3] = ["Sessions", "Length and padding", "Copies"];

/// Design: its name, and a function that draws its cells. The numbers of a cell are its group, its session, its class, and its number of touches, which follow
/// each other.
type Design = (&'static str, fn(&mut ChaCha8Rng) -> Vec<[usize; 4]>);

const DESIGNS: [Design; 4] = [
    // Each of 20 groups contains all classes; two groups make a session.
    ("crossed", |rng| {
        let mut cells = Vec::new();
        for group in 0..20 {
            cells.extend(shuffled(rng, 4).map(|class| [group, group / 2, class, 2]));
        }
        cells
    }),
    // Each of 32 groups contains one class; groups are assigned to 10 sessions at random.
    ("nested", |rng| {
        let groups = shuffled(rng, 32).map(|group| [group, rng.gen_range(0..10), group % 4, 4]);
        let mut groups: Vec<_> = groups.collect();
        groups.sort_by_key(|group| group[1]);
        groups
    }),
    // Classes of 1 to 7 touches a group; groups that lack classes.
    ("unbalanced", |rng| {
        let mut cells = Vec::new();
        for group in 0..16 {
            let n = rng.gen_range(1..=4);
            for class in shuffled(rng, 4).take(n) {
                cells.push([group, group / 2, class, 1 + 2 * (3 - class)]);
            }
        }
        cells
    }),
    // Each of 8 groups comes back in each of 3 sessions.
    ("repeated", |rng| {
        let mut cells = Vec::new();
        for session in 0..3 {
            for group in shuffled(rng, 8) {
                cells.extend(shuffled(rng, 4).map(|class| [group, session, class, 2]));
            }
        }
        cells
    }),
];

fn shuffled(rng: &mut ChaCha8Rng, n: usize) -> std::vec::IntoIter<usize> {
    let mut numbers: Vec<usize> = (0..n).collect();
    numbers.shuffle(rng);
    numbers.into_iter()
}

/// Series of 6 frames of 4 × 5 taxels. Sessions, groups and cells have levels, sizes of noise and lengths of their own; classes have none.
fn without_classes(name: &str, cells: fn(&mut ChaCha8Rng) -> Vec<[usize; 4]>, seed: u64) -> Set {
    let mut rng = rng(name, seed);
    let cells = cells(&mut rng);
    let n_cells = cells.len();
    let of: Vec<usize> = (0..n_cells)
        .flat_map(|cell| vec![cell; cells[cell][3]])
        .collect();
    let list = |place: usize| -> Vec<usize> { of.iter().map(|&cell| cells[cell][place]).collect() };
    let (groups, sessions, labels) = (list(0), list(1), list(2));
    let style = |rng: &mut ChaCha8Rng, n: usize| {
        (0..n)
            .map(|_| rng.gen_range(0.5..1.5))
            .collect::<Vec<f64>>()
    };
    let (sizes, ends) = (style(&mut rng, n_cells), style(&mut rng, n_cells));
    let mut set = Set::new(rng, labels, 6, |touch, _, rng| {
        let end = (2.0 + 3.0 * ends[of[touch]]).round() as usize;
        let reading = |k: usize, rng: &mut ChaCha8Rng| match k / 20 < end {
            true => sizes[of[touch]] * normal(rng),
            false => f64::NAN,
        };
        row(120, |k| reading(k, rng))
    });
    for (list, size) in [(&sessions, 0.5), (&groups, 0.5), (&of, 1.0)] {
        set.add_styles(list, size);
    }
    set.options.before_contact = Some(0..2);
    set.options.untouched = vec![0, 7, 19];
    set.options.n_permutations = 399;
    set.grid((4, 5)).groups(groups).sessions(sessions)
}

/// Classes that can be recognised, in groups and sessions without a style.
fn without_groups(seed: u64) -> Set {
    let mut rng = rng("no groups", seed);
    let labels = shuffled_labels(&mut rng, 4, 40);
    let patterns = normals(&mut rng, 4, 12);
    let mut list = |n: usize| -> Vec<usize> { (0..160).map(|_| rng.gen_range(0..n)).collect() };
    let (groups, sessions) = (list(12), list(6));
    let set = Set::new(rng, labels, 1, |_, class, rng| {
        row(12, |k| 0.5 * patterns[(class, k)] + normal(rng))
    });
    set.groups(groups).sessions(sessions)
}

/// Counts the p-values of at most 0.05 of each test.
fn counts(make: impl Fn(u64) -> Set + Sync) -> BTreeMap<String, [usize; 2]> {
    let found = (0..N as u64)
        .into_par_iter()
        .map(|seed| make(seed).findings());
    let mut counts = BTreeMap::<String, [usize; 2]>::new();
    for finding in found.collect::<Vec<_>>().into_iter().flatten() {
        if let Some(p_value) = finding.p_value {
            let [n_small, n] = counts.entry(finding.title()).or_default();
            *n_small += usize::from(p_value <= 0.05);
            *n += 1;
        }
    }
    counts
}

#[test]
#[ignore = "long: run by .ci/long audit"]
fn three_to_seven_percent_of_the_p_values_without_a_fault_are_small() {
    let mut all = BTreeMap::<String, [usize; 2]>::new();
    let mut wrong = Vec::new();
    let of_designs =
        DESIGNS.map(|(name, cells)| (name, counts(|seed| without_classes(name, cells, seed))));
    for (design, counts) in of_designs
        .into_iter()
        .chain([("no groups", counts(without_groups))])
    {
        for (test, [n_small, n]) in counts {
            // Cells have a level, so that units do cost accuracy; and without groups, readings name the class.
            let is_split = test.starts_with("Accuracy");
            let is_of_readings = ["Mean reading", "One taxel"].contains(&&test[..]);
            let is_null = match design {
                "no groups" => !is_of_readings,
                _ => !is_split,
            };
            println!(
                "{design:12} {test:48} {n_small:4} of {n} {}",
                if is_null { "" } else { "(not null)" }
            );
            if is_null {
                let [all_small, all] = all.entry(test.clone()).or_default();
                (*all_small, *all) = (*all_small + n_small, *all + n);
                if n_small > MOST {
                    wrong.push(format!("{design}, {test}: {n_small} of {n}"));
                }
            }
        }
    }
    for (test, [n_small, n]) in all {
        let share = n_small as f64 / n as f64;
        println!("all          {test:48} {n_small:4} of {n} = {share:.3}");
        // Of 200 sets, 3 to 7 % is narrower than the binomial distribution.
        let room = if n > N { 0.0 } else { 0.02 };
        if share > 0.07 + room || (share < 0.03 - room && !DISCRETE.contains(&&test[..])) {
            wrong.push(format!("{test}: {n_small} of {n}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
