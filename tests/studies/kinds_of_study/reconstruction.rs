//! Reconstruction study: from its file to its tables and pictures.

use crate::command::{Case, says};
use bubbletouch::kinds::reconstruction::rows::{
    EnsembleStatistics, ReconstructionConfiguration, ReconstructionPareto, ReconstructionScore,
    ReconstructionTime,
};
use bubbletouch::sensing::{Basis, Ensemble, Solver};

const SMALL: &str = include_str!("../../fixtures/texts/reconstruction_small.toml");

#[test]
fn the_tables_hold_every_cell_and_the_written_study_gives_them_again() {
    let case = Case::with("study.toml", SMALL);
    case.succeeds("run study.toml --out 1");
    let read = |folder: &str, name: &str| case.bytes(&format!("{folder}/{name}"));
    case.succeeds("run 1/study.toml --out again");
    assert!(read("1", "reconstruction.csv") == read("again", "reconstruction.csv"));

    let configurations: Vec<ReconstructionConfiguration> = case.rows("1/reconstruction.csv");
    let scores: Vec<ReconstructionScore> = case.rows("1/reconstruction.csv");
    // Two ensembles at two m and the identity at one m; two noise levels, three dictionaries, three solvers.
    assert_eq!(configurations.len(), 5 * 2 * 3 * 3);
    for (configuration, score) in configurations.iter().zip(&scores) {
        assert!(score.error_low <= score.error && score.error <= score.error_high);
        assert!((score.snr_db + 20.0 * score.error.log10()).abs() < 1e-9);
        let is_exact = score.full_sampling_error == 0.0;
        assert_eq!(is_exact, configuration.noise_std == 0.0);
        assert_eq!(score.n_frames, 32, "a quarter of 30 each, rounded");
        // The linear estimate is better than the noisy frame even at a quarter of the measurements; with the coarse Haar dictionary hardly.
        let is_smooth = configuration.dictionary != Basis::Haar;
        let is_linear = configuration.solver == Solver::Lmmse;
        if is_linear && is_smooth && configuration.ratio <= 4.0 && !is_exact {
            let is_better = score.error < score.full_sampling_error;
            assert!(is_better, "{configuration:?} {score:?}");
        }
    }
    let error = |ensemble, dictionary, measurements, noise_std| {
        let mut found = configurations.iter().zip(&scores).filter(|(c, _)| {
            (c.ensemble, c.dictionary, c.measurements) == (ensemble, dictionary, measurements)
                && c.solver == Solver::Lmmse
                && c.noise_std == noise_std
        });
        found.next().unwrap().1.error
    };
    for basis in [Basis::Dct, Basis::Haar, Basis::Pca] {
        let of = |m, noise| error(Ensemble::Sbhe, basis, m, noise);
        assert!(of(64, 0.1) < of(16, 0.1), "measurements help, {basis:?}");
        assert!(of(64, 0.0) < of(64, 0.1), "noise hurts, {basis:?}");
    }

    let times: Vec<ReconstructionTime> = case.rows("1/timing.csv");
    assert!(times.len() == configurations.len() && times.iter().all(|t| t.us_per_frame > 0.0));
    let pareto: Vec<ReconstructionPareto> = case.rows("1/pareto.csv");
    let rows = scores.iter().zip(&pareto);
    let best = rows.min_by(|a, b| a.0.error.total_cmp(&b.0.error));
    assert!(best.unwrap().1.on_front, "nothing beats the least error");
    let is_beaten = |row: &ReconstructionPareto, noise: f64| {
        let others = pareto.iter().zip(&configurations);
        let mut others = others.filter(|(_, configuration)| configuration.noise_std == noise);
        others.any(|(other, _)| {
            let costs = |row: &ReconstructionPareto| [row.error, row.us_per_frame];
            let mut pairs = costs(other).into_iter().zip(costs(row));
            pairs.all(|(other, own)| other <= own) && costs(other) != costs(row)
        })
    };
    for (row, configuration) in pareto.iter().zip(&configurations) {
        let is_beaten = is_beaten(row, configuration.noise_std);
        assert_eq!(row.on_front, !is_beaten, "{configuration:?}");
    }
    let statistics: Vec<EnsembleStatistics> = case.rows("1/ensembles.csv");
    assert_eq!(statistics.len(), 5 * 3 * 2);
    for row in &statistics {
        assert!(row.coherence + 1e-9 >= row.welch_bound && row.coherence <= 1.0 + 1e-9);
        assert!(row.low_min <= row.low_median && row.high_median <= row.high_max);
        assert!(row.deviation_median <= row.delta_lower_bound);
    }
    for name in [
        "frames.png",
        "error_sbhe_noise_0.1.svg",
        "error_by_time.svg",
    ] {
        assert!(!read("1", name).is_empty(), "{name}");
    }
    // Choices are weighed by their error, which the first chart shows against time.
    let page = String::from_utf8(read("1", "report.html")).unwrap();
    let first = page.split("id=\"chart-").nth(1).unwrap();
    assert!(first.starts_with("error_by_time"));
    let (said, _) = case.succeeds("advise 1 --reach 0.9");
    says(&said, &["error"]);
}
