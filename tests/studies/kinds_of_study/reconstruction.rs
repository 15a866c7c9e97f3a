//! Reconstruction study: from its file to its tables and pictures.

use crate::command::Case;
use bubbletouch::kinds;
use bubbletouch::kinds::reconstruction::rows::{
    EnsembleStatistics, ReconstructionConfiguration, ReconstructionPareto, ReconstructionScore,
    ReconstructionTime,
};
use bubbletouch::kinds::reconstruction::{ReconstructionPlan, ReconstructionStudySpec};
use bubbletouch::report::csv_tables::read_rows;
use bubbletouch::sensing::{Basis, Ensemble, Solver};
use std::fs;

const SMALL: &str = r#"
question = "What comes back?"
seed = 7

[objects]
sets = ["household"]
names = ["mug", "banana", "scissors", "power_drill"]
surface_error_mm = 1.0

[skin]
pitch_mm = 4.0
taxels = 16
stroke_mm = 5.0

[touches]
per_object = 30
offset_x_mm = { uniform = [-8.0, 8.0] }
yaw_deg = { uniform = [0.0, 40.0] }
depth_mm = { uniform = [2.0, 4.0] }

[signal]
noise_std_full_scale = [0.0, 0.1]

[sensing]
ensemble = ["sbhe", "block_average", "identity"]
ratio = [4, 16]

[reconstruction]
solver = ["omp", "l1", "lmmse"]
dictionary = ["dct", "haar", "pca"]
atoms = 40
isometry_sparsity = [4, 8]
isometry_subsets = 30
"#;

fn rows<T: serde::de::DeserializeOwned>(case: &Case, name: &str) -> Vec<T> {
    read_rows(&case.path(name)).unwrap()
}

#[test]
fn the_tables_hold_every_cell_and_the_written_study_gives_them_again() {
    let case = Case::new();
    case.file("study.toml", SMALL);
    case.succeeds(&["run", "study.toml", "--out", "1"]);
    let read = |folder: &str, name: &str| fs::read(case.path(folder).join(name)).unwrap();
    case.succeeds(&["run", "1/study.toml", "--out", "again"]);
    assert!(read("1", "reconstruction.csv") == read("again", "reconstruction.csv"));

    let configurations: Vec<ReconstructionConfiguration> = rows(&case, "1/reconstruction.csv");
    let scores: Vec<ReconstructionScore> = rows(&case, "1/reconstruction.csv");
    // Two ensembles at two m and the identity at one m; two noise levels, three dictionaries, three solvers.
    assert_eq!(configurations.len(), 5 * 2 * 3 * 3);
    for (configuration, score) in configurations.iter().zip(&scores) {
        assert!(score.error_low <= score.error && score.error <= score.error_high);
        assert!((score.snr_db + 20.0 * score.error.log10()).abs() < 1e-9);
        assert_eq!(
            score.full_sampling_error == 0.0,
            configuration.noise_std == 0.0
        );
        assert_eq!(score.n_frames, 32, "a quarter of 30 each, rounded");
        // The linear estimate is better than the noisy frame even at a quarter of the measurements; with the coarse Haar dictionary hardly.
        let is_smooth = configuration.dictionary != Basis::Haar;
        if configuration.solver == Solver::Lmmse
            && is_smooth
            && configuration.ratio <= 4.0
            && configuration.noise_std > 0.0
        {
            assert!(
                score.error < score.full_sampling_error,
                "{configuration:?} {score:?}"
            );
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
        assert!(
            of(64, 0.1) < of(16, 0.1),
            "more measurements help, {basis:?}"
        );
        assert!(of(64, 0.0) < of(64, 0.1), "noise hurts, {basis:?}");
    }

    let times: Vec<ReconstructionTime> = rows(&case, "1/timing.csv");
    assert!(times.len() == configurations.len() && times.iter().all(|t| t.us_per_frame > 0.0));
    let pareto: Vec<ReconstructionPareto> = rows(&case, "1/pareto.csv");
    let best = scores
        .iter()
        .zip(&pareto)
        .min_by(|a, b| a.0.error.total_cmp(&b.0.error));
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
        assert_eq!(
            row.on_front,
            !is_beaten(row, configuration.noise_std),
            "{configuration:?}"
        );
    }
    let statistics: Vec<EnsembleStatistics> = rows(&case, "1/ensembles.csv");
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
    let (said, _) = case.succeeds(&["advise", "1", "--reach", "0.9"]);
    assert!(said.contains("error"), "{said}");
}

#[test]
fn a_study_says_which_kind_it_is_and_other_commands_say_what_they_take() {
    assert_eq!(kinds::about(SMALL).unwrap().table, "reconstruction");
    assert!(kinds::about("question = 1").is_none());
    assert!(kinds::about("not TOML [").is_none());
    let case = Case::new();
    case.file("study.toml", SMALL);
    let output = case.run(&["touches", "study.toml", "--out", "touches"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("a study that reconstructs frames"), "{said}");
}

#[test]
fn keys_out_of_range_are_named() {
    for (old, new, said) in [
        (
            "pitch_mm = 4.0",
            "pitch_mm = [4.0, 8.0]",
            "key skin: 2 arrays",
        ),
        ("taxels = 16", "taxels = 12", "12 × 12 taxels"),
        (
            "full_scale = [0.0, 0.1]",
            "full_scale = 0.1\nsmoothing_mm = 4.0",
            "no smoothing",
        ),
        (
            "full_scale = [0.0, 0.1]",
            "full_scale = 0.1\nsteps = [\"noise\", \"force\"]",
            "force after noise",
        ),
        (
            "\"sbhe\"",
            "\"principal_components\"",
            "key sensing.ensemble: principal components",
        ),
        ("atoms = 40", "atoms = 0", "key reconstruction.atoms: 0"),
        (
            "atoms = 40",
            "most_atoms = 0",
            "key reconstruction.most_atoms: 0",
        ),
        (
            "atoms = 40",
            "lambda_scale = 0.0",
            "key reconstruction.lambda_scale: 0",
        ),
        (
            "atoms = 40",
            "test_fraction = 1.0",
            "key reconstruction.test_fraction: 1",
        ),
        (
            "subsets = 30",
            "subsets = 0",
            "key reconstruction.isometry_subsets: 0",
        ),
        (
            "sparsity = [4, 8]",
            "sparsity = []",
            "key reconstruction.isometry_sparsity",
        ),
        ("[\"omp\", \"l1\", \"lmmse\"]", "\"magic\"", "magic"),
        ("\"dct\", \"haar\"", "\"dct\", \"dct\"", "twice"),
    ] {
        assert!(SMALL.contains(old), "{old}");
        let text = SMALL.replace(old, new);
        let plan = ReconstructionStudySpec::parse("study.toml", &text)
            .and_then(|spec| ReconstructionPlan::new("study.toml", spec));
        let error = plan.unwrap_err().to_string();
        assert!(
            error.contains(said) && error.starts_with("study.toml"),
            "{error}"
        );
    }
}
