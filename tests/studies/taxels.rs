//! Taxels that a study reads: selected taxels, adaptive blocks, and arrays whose pitch varies.

use crate::study::{Study, changed, features, laid_out};
use bubbletouch::random::Seed;
use bubbletouch::sensing::{Projection, Selection, TrainingFrames};
use bubbletouch::studies::recognition::charts::{charts, tables_of};
use bubbletouch::study::progress::Silent;
use bubbletouch::table::ChartSpec;
use bubbletouch::world::ImageShape;
use ndarray::Axis;
use std::collections::BTreeSet;

const STUDY: &str = include_str!("../fixtures/texts/taxels.toml");

#[test]
fn every_method_selects_m_different_taxels_and_the_table_tells_where() {
    let methods = "ensemble = [\"selected\", \"block_average\"]\nselection = [\"greedy\", \"pivoted_qr\", \"random\"]";
    let text = STUDY.replace("ensemble = \"selected\"", methods);
    let tables = Study::new(&text).run();
    // Three methods and the block average, at two numbers of taxels each.
    assert_eq!(tables.summary.len(), 8);
    let methods = Selection::ALL.map(Some).into_iter().chain([None]);
    for (configuration, selection) in methods.flat_map(|one| [one, one]).enumerate() {
        let found = &tables.summary[configuration].0;
        assert_eq!(found.selection, Some(selection));
        let rows = tables.selected.iter();
        let own = rows.filter(|(of, _)| of.configuration == configuration);
        let own: Vec<_> = own.map(|(_, taxel)| taxel).collect();
        let expected = selection.map_or(0, |_| found.measurements);
        assert_eq!(own.len(), expected);
        assert!(own.iter().enumerate().all(|(k, row)| row.rank == k + 1));
        let different: BTreeSet<usize> = own.iter().map(|row| row.taxel).collect();
        assert_eq!(different.len(), expected);
        for row in own {
            let (x, y) = (row.taxel % 24, row.taxel / 24);
            let place = [x, y].map(|k| Some(4.0 * k as f64 - 46.0));
            assert_eq!([row.x_mm, row.y_mm], place);
        }
    }
    let charts = charts(&tables_of(&tables).unwrap(), None);
    let is_of_taxels = |chart: &&ChartSpec| chart.name.starts_with("selected_taxels");
    assert_eq!(charts.iter().filter(is_of_taxels).count(), 2);
}

#[test]
fn taxels_are_selected_on_training_touches_of_the_trial() {
    let [set, other] = [0, 1].map(|trial| features(STUDY, (0, trial)));
    assert_ne!(set.split.test, other.split.test);
    assert_ne!(set.data.records.row(0), other.data.records.row(0));
    // The deflections of the test touches do not change the features of the training touches.
    let deeper = format!("{STUDY}\n[test.touches]\ndepth_mm = 2.0\n");
    let changed = features(&deeper, (0, 0));
    assert_eq!(changed.split.train, set.split.train);
    for &touch in &set.split.train {
        assert_eq!(set.data.records.row(touch), changed.data.records.row(touch));
    }
    let differs = |&touch: &usize| set.data.records.row(touch) != changed.data.records.row(touch);
    assert!(set.split.test.iter().any(differs));
}

/// Law over all keys that reduce or relabel training touches: a learned ensemble is the one that the exported training rows give.
#[test]
fn ensembles_are_fitted_to_exactly_the_touches_that_train() {
    let reduced = [
        "train_touches = [1, 2, 12]",
        "train_touches = 12\nclass_imbalance = [1.0, 6.0]",
        "mislabelled_fraction = [0.0, 0.4]",
    ];
    let learned = "ensemble = [\"identity\", \"selected\", \"principal_components\", \"adaptive_learned\"]\nselection = \"greedy\"";
    let small = changed(
        STUDY,
        &[
            ("ensemble = \"selected\"", learned),
            ("measurements = [8, 24]", "measurements = 5"),
            ("size_mm = 96.0", "size_mm = 40.0"),
            ("per_object = 30", "per_object = 18"),
        ],
    );
    for reduced in reduced {
        let text = small.replace("classifier =", &format!("{reduced}\nclassifier ="));
        let study = laid_out(&text).unwrap();
        let configurations: Vec<_> = study.all_cells().cloned().collect();
        let n = configurations.len() / 4;
        let set = |number: usize| study.first().features((number, 1), &Silent).unwrap();
        let mut fits = BTreeSet::new();
        for (number, configuration) in configurations.iter().enumerate().skip(n) {
            let (frames, found) = (set(number % n), set(number));
            assert_eq!(frames.split, found.split);
            let train = &frames.split.train;
            let labels: Vec<usize> = train.iter().map(|&row| frames.data.targets[row]).collect();
            let trained = frames.data.records.select(Axis(0), train);
            let training = TrainingFrames {
                labels: &labels,
                groups: train,
                ..TrainingFrames::from(trained.view())
            };
            let ensemble = configuration.ensemble;
            let seed = Seed::new(2018).named("projection").numbered(1);
            let shape = ImageShape { ny: 10, nx: 10 };
            let projection = Projection::learned(ensemble, shape, 5, (training, &seed));
            let expected = projection.unwrap().measure(frames.data.records.view());
            assert_eq!(found.data.records, expected, "{number} of {text}");
            fits.insert(format!("{:?}", expected.row(0)));
        }
        // Only greedy selection uses labels.
        let n_fits = match reduced.starts_with("mislabelled") {
            true => 4,
            false => 3 * n,
        };
        assert_eq!(fits.len(), n_fits);
    }
}

/// Law: the export, which measures one configuration, gives the accuracy of the run, which shares measurements between configurations.
#[test]
fn taxels_selected_on_one_touch_of_each_object_are_those_of_a_study_of_one_touch() {
    let curve = |touches: &str| {
        let keys = format!("train_touches = {touches}\nclassifier =");
        let tables = Study::new(&STUDY.replace("classifier =", &keys)).run();
        let scores = tables.accuracy.iter();
        let of_one = scores.filter(|(configuration, _)| configuration.train_touches == 1);
        of_one.map(|(_, score)| score.clone()).collect::<Vec<_>>()
    };
    assert_eq!(curve("[1, 20]"), curve("1"));
}

#[test]
fn a_selection_at_random_gives_the_rows_of_a_subsample() {
    let random = "ensemble = \"selected\"\nselection = \"random\"";
    let random = features(&STUDY.replace("ensemble = \"selected\"", random), (1, 0));
    let drawn = features(&STUDY.replace("\"selected\"", "\"subsample\""), (1, 0));
    assert_eq!(random.data.records, drawn.data.records);
}

#[test]
fn adaptive_blocks_give_a_frame_per_touch_at_any_budget() {
    let text = STUDY.replace("\"selected\"", "\"adaptive\"");
    let text = text.replace("measurements =", "readings_per_s = 16000.0\nmeasurements =");
    let images = "features = [\"raw\", \"descriptors\"]\nclassifier =";
    let text = text.replace("classifier =", images);
    let tables = Study::new(&text).run();
    let summary = tables.summary.iter();
    let costs = summary.map(|(c, _)| (c.measurements, c.readout_ms));
    let costs: Vec<_> = costs.collect();
    let expected = [(8, 0.5), (8, 0.5), (24, 1.5), (24, 1.5)].map(|(m, ms)| (m, Some(ms)));
    assert_eq!(costs, expected);
    let coarse = features(&text, (0, 0)).data.records;
    let fine = features(&text, (2, 0)).data.records;
    assert_eq!((coarse.ncols(), fine.ncols()), (576, 576));
    let n_different = |row: ndarray::ArrayView1<f64>| {
        let values: BTreeSet<u64> = row.iter().map(|value| value.to_bits()).collect();
        values.len()
    };
    for (row, most) in [(coarse.row(3), 8), (fine.row(3), 24)] {
        assert!(n_different(row) <= most && n_different(row) > most / 2);
    }
}

#[test]
fn a_learned_estimate_of_adaptive_blocks_is_a_frame_of_equal_readings() {
    let text = STUDY.replace("\"selected\"", "[\"adaptive\", \"adaptive_learned\"]");
    let text = text.replace("classifier =", "features = \"descriptors\"\nclassifier =");
    let tables = Study::new(&text).run();
    let accuracies = tables.summary.iter().map(|(_, score)| score.accuracy);
    let accuracies: Vec<f64> = accuracies.collect();
    assert_eq!(accuracies.len(), 4);
    assert!(accuracies.iter().all(|&one| one > 0.3), "{accuracies:?}");
    let text = STUDY.replace("\"selected\"", "\"adaptive_learned\"");
    assert_eq!(features(&text, (0, 0)).data.records.ncols(), 576);
}

#[test]
fn with_all_readings_adaptive_blocks_are_the_identity() {
    let text = STUDY.replace("measurements = [8, 24]", "measurements = 576");
    let images = "features = [\"raw\", \"descriptors\"]\nclassifier =";
    let text = text.replace("classifier =", images);
    for configuration in [0, 1] {
        let [adaptive, identity] = ["\"adaptive\"", "\"identity\""].map(|ensemble| {
            let text = text.replace("\"selected\"", ensemble);
            features(&text, (configuration, 0)).data.records
        });
        assert_eq!(adaptive, identity);
    }
}

#[test]
fn a_foveated_array_has_the_taxels_of_the_grid_and_its_blocks() {
    let text = STUDY.replace("stroke_mm", "layout = \"foveated\"\nstroke_mm");
    let ensembles = "[\"adaptive\", \"block_average\", \"selected\"]";
    let text = text.replace("\"selected\"", ensembles);
    let text = text.replace("classifier =", "features = \"descriptors\"\nclassifier =");
    let tables = Study::new(&text).run();
    assert_eq!(tables.summary.len(), 6);
    assert!(tables.summary.iter().all(|(c, _)| (c.nx, c.ny) == (24, 24)));
    assert!(tables.summary.iter().any(|(_, score)| score.accuracy > 0.4));
}
