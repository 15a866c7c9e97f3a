//! Test that recomputes the first trial of the quickstart study and compares it with the committed results.

use crate::command::skip;
use crate::study::Study;
use bubbletouch::report::csv_tables::read_rows;
use bubbletouch::study::table::TrialScore;
use std::fs;
use std::path::Path;

#[test]
fn the_quickstart_still_gives_its_committed_results() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let committed = root.join("results/quickstart/accuracy.csv");
    if !committed.exists() {
        skip(format!("there is no {}", committed.display()));
        return;
    }
    let committed: Vec<TrialScore> = read_rows(&committed).unwrap();
    let text = fs::read_to_string(root.join("experiments/quickstart.toml")).unwrap();
    assert!(text.contains("\ntrials = 4\n"));
    let text = text.replace("\ntrials = 4\n", "\ntrials = 1\n");
    let computed = Study::new(&text).run().accuracy;
    let committed: Vec<TrialScore> = committed.into_iter().filter(|s| s.trial == 0).collect();
    assert_eq!(computed.len(), committed.len());
    for ((configuration, score), old) in computed.iter().zip(&committed) {
        assert_eq!(
            (score.trial, score.n_train, score.n_test),
            (old.trial, old.n_train, old.n_test)
        );
        // Processors round differently, which can change the label of a row that is close to two objects.
        assert!(
            score.n_correct.abs_diff(old.n_correct) <= 1,
            "configuration {} trial {}: {} of {} are correct, {} were",
            configuration.configuration,
            score.trial,
            score.n_correct,
            score.n_test,
            old.n_correct
        );
    }
}
