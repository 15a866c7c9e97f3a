//! Laws of accuracy on a small real study: chance level, more measurements, less noise, no compression.
//!
//! A run is reproducible on one machine, but processors round differently, so every margin is several test rows.

use crate::study::Study;
use bubbletouch::sensing::Ensemble;
use bubbletouch::study::table::{Configuration, ConfigurationScore, Tables};

const STUDY: &str = include_str!("../fixtures/texts/accuracy.toml");

/// Number of objects; one guess in this number is correct.
const N_OBJECTS: f64 = 8.0;

fn score(outcome: &Tables, is_wanted: impl Fn(&Configuration) -> bool) -> &ConfigurationScore {
    let mut rows = outcome.summary.iter().filter(|(c, _)| is_wanted(c));
    let (_, score) = rows.next().expect("a configuration with these settings");
    assert!(rows.next().is_none(), "two configurations");
    score
}

#[test]
fn accuracy_obeys_chance_compression_and_noise() {
    let outcome = Study::new(STUDY).run();
    let noises = [0.0, 0.1, 0.4, 10.0];
    let counts = [1, 4, 16, 64, 256];
    let at =
        |noise: f64, m: usize| score(&outcome, |c| c.noise_std == noise && c.measurements == m);
    let table = noises.map(|noise| counts.map(|m| at(noise, m).accuracy));
    let deaf = at(10.0, 1);
    // One measurement of noise guesses.
    let chance = 1.0 / N_OBJECTS;
    let has_chance = deaf.accuracy_low < chance && chance < deaf.accuracy_high;
    assert!(has_chance, "{deaf:?}");
    // Four of 120 test rows.
    let margin = 4.0 / deaf.n_test as f64;
    for accuracies in &table[..3] {
        for pair in accuracies.windows(2) {
            assert!(pair[1] > pair[0] - margin, "falls with m: {accuracies:?}");
        }
        assert!(accuracies[4] > accuracies[0] + 0.2, "{accuracies:?}");
    }
    for column in 0..counts.len() {
        for pair in table.windows(2) {
            let (less, more) = (pair[0][column], pair[1][column]);
            assert!(more < less + margin, "rises with noise: {less} to {more}");
        }
        assert!(table[3][column] < table[0][column] - 0.1);
    }
}

#[test]
fn all_taxels_know_about_as_much_as_a_64th_of_them_or_more() {
    let text = STUDY.replace("[0.0, 0.1, 0.4, 10.0]", "0.1").replace(
        "measurements = [1, 4, 16, 64, 256]",
        "ensemble = [\"identity\", \"gaussian\", \"block_average\"]\nratio = [1, 64]",
    );
    let outcome = Study::new(&text).run();
    let whole = score(&outcome, |c| c.ensemble == Ensemble::Identity);
    let margin = 4.0 / whole.n_test as f64;
    for ensemble in [Ensemble::Gaussian, Ensemble::BlockAverage] {
        let at =
            |ratio: f64| score(&outcome, |c| c.ensemble == ensemble && c.ratio == ratio).accuracy;
        assert!(whole.accuracy > at(64.0) - margin, "{ensemble:?}");
        assert!(at(1.0) > at(64.0) - margin, "{ensemble:?}");
        assert!((at(1.0) - whole.accuracy).abs() < 0.1, "{ensemble:?}");
    }
}
