//! Examples of intervals and tests, with values that other programs give.

use bubbletouch::Result;

#[test]
fn wilson_score_interval() -> Result<()> {
    use bubbletouch::recognition::statistics::interval::Interval;

    // 45 of 50 rows recognised.
    let interval = Interval::wilson(45, 50, 0.95)?;
    assert!((interval.low - 0.786).abs() < 1e-3 && (interval.high - 0.957).abs() < 1e-3);
    Ok(())
}

#[test]
fn interval_of_groups_of_rows() -> Result<()> {
    use bubbletouch::recognition::statistics::grouped::{
        GroupCount, GroupedTest, interval_of_groups,
    };

    // Numbers of recognised touches among ten touches for each of six yaws.
    let of_yaws = [9, 7, 10, 4, 10, 8].into_iter().enumerate();
    let groups: Vec<GroupCount> = of_yaws
        .map(|(group, n_correct)| GroupCount {
            group,
            n_rows: 10,
            n_correct,
        })
        .collect();
    let test = GroupedTest {
        n_rows: 60,
        n_correct: 48,
        groups: &groups,
    };
    let (interval, n_groups) = interval_of_groups(&[test], 0.95)?;
    // Wilson's interval of 48 of 60 would be 0.68 to 0.88.
    assert!(
        (interval.low - 0.478).abs() < 1e-3
            && (interval.high - 0.946).abs() < 1e-3
            && n_groups == 6
    );
    Ok(())
}

#[test]
fn bootstrap_interval_of_a_mean() -> Result<()> {
    use bubbletouch::recognition::statistics::bootstrap::Bootstrap;
    use ndarray::array;

    // Five trials, one a row.
    let accuracies = array![[0.91], [0.93], [0.90], [0.94], [0.92]];
    let interval = Bootstrap::default()
        .mean(accuracies.view(), 0.95)?
        .expect("there are five trials");
    assert!((interval.low - 0.902).abs() < 1e-9 && (interval.high - 0.938).abs() < 1e-9);
    Ok(())
}

#[test]
fn variance_components() -> Result<()> {
    use bubbletouch::recognition::statistics::variance::components;
    use ndarray::array;

    // Four splits (rows), three projections (columns).
    let accuracies = array![
        [0.80, 0.82, 0.78],
        [0.84, 0.88, 0.83],
        [0.75, 0.79, 0.77],
        [0.81, 0.80, 0.79]
    ];
    let found = components(accuracies.view(), 0.95)?;
    let [split, projection, rest] =
        [found.rows, found.columns, found.rest].map(|part| part.variance().sqrt());
    // The split moves the accuracy by 0.03, the projection by 0.014, the rest by as much again.
    assert!(
        (split - 0.032).abs() < 1e-3
            && (projection - 0.014).abs() < 1e-3
            && (rest - 0.014).abs() < 1e-3
    );
    // Three projections are too few to be sure of theirs.
    assert!(found.rows.p_value < Some(0.01) && found.columns.p_value > Some(0.05));
    Ok(())
}

#[test]
fn corrected_resampled_t_test() -> Result<()> {
    use bubbletouch::recognition::statistics::comparison::{TrialSize, compare};

    let (a, b) = (
        [0.91, 0.93, 0.90, 0.94, 0.92],
        [0.88, 0.92, 0.89, 0.90, 0.91],
    );
    let size = TrialSize {
        n_train: 300,
        n_test: 100,
        n_decisions: 100,
    };
    let test = compare(&a, &b, &[size], 0.95)?.expect("there are several trials");
    // The plain paired t-test would give p = 0.034.
    assert!((test.p_value - 0.125).abs() < 1e-3);
    Ok(())
}

#[test]
fn minimum_number_of_trials() -> Result<()> {
    use bubbletouch::recognition::statistics::comparison::{TrialSize, trials_needed};

    let size = TrialSize {
        n_train: 300,
        n_test: 100,
        n_decisions: 100,
    };
    assert_eq!(trials_needed(&[size], 0.95)?, Some(4));
    Ok(())
}

#[test]
fn holm_correction() {
    use bubbletouch::recognition::statistics::many_tests::holm;

    // Alone, the first two would count; among five, only the first does.
    let corrected = holm(&[0.001, 0.03, 0.2, 0.4, 0.9]);
    assert!(corrected[0] < 0.05 && corrected[1] > 0.05);
}
