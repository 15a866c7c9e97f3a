//! Studies of sensor errors: one error at a time, compared with all errors together and with touches that are read individually.

use crate::study::{Study, features, pressed, table, trials_of};
use bubbletouch::random::Seed;
use bubbletouch::report::chart::{draw, places};
use bubbletouch::signal::{Chain, Recording, SensorError, SignalWorkspace};
use bubbletouch::studies::recognition::charts::{charts, tables_of};
use bubbletouch::study::table::Configuration;
use bubbletouch::study::{FeatureSet, sample_frames};
use ndarray::Axis;
use rand::Rng;

const STUDY: &str = include_str!("../fixtures/texts/hardware.toml");

/// Returns the study with these keys of `[signal]`. A study without the step `scan` has no speed, which would have no effect.
fn with_signal(signal: &str) -> String {
    let study = STUDY.replace("SIGNAL", signal);
    match signal.contains("\"scan\"") {
        true => study,
        false => study.replace("speed_mm_per_s = 20.0\n", ""),
    }
}

const ALL: &str = include_str!("../fixtures/texts/hardware_all.toml");

#[test]
fn one_at_a_time_scores_what_all_combinations_score_there() {
    let signal = "steps = [\"gain\", \"drift\", \"noise\"]\ngain_std = [0.0, 0.5, 1.0]\n\
                  drift_std_full_scale = [0.05, 0.2]\nnoise_std_full_scale = [0.01, 0.3]";
    let all = Study::new(&with_signal(signal)).run();
    let alone = format!("{signal}\ncombine = \"one_at_a_time\"");
    let alone = Study::new(&with_signal(&alone)).run();
    assert_eq!(all.summary.len(), 3 * 2 * 2);
    let settings: Vec<&Configuration> = alone.summary.iter().map(|(of, _)| of).collect();
    let told = settings.iter().map(|of| {
        let [gain, drift] = ["gain_std", "drift_std_full_scale"].map(|key| of.strengths.get(key));
        (of.noise_std, gain, drift)
    });
    let told: Vec<_> = told.collect();
    let expected = [
        (0.01, Some(0.0), Some(0.05)),
        (0.3, Some(0.0), Some(0.05)),
        (0.01, Some(0.5), Some(0.05)),
        (0.01, Some(1.0), Some(0.05)),
        (0.01, Some(0.0), Some(0.2)),
    ];
    assert_eq!(told, expected);
    for configuration in settings {
        let trials = trials_of(&alone, configuration);
        assert_eq!(trials.len(), 2);
        assert_eq!(trials, trials_of(&all, configuration));
    }
}

#[test]
fn a_skin_without_strength_scores_as_one_without_the_keys_and_only_used_keys_are_columns() {
    let with = Study::new(&with_signal(ALL)).run();
    let without = Study::new(&with_signal("noise_std_full_scale = [0.0, 0.1]")).run();
    for (plain, score) in &without.accuracy {
        let same = |of: &Configuration| {
            of.noise_std == plain.noise_std && of.strengths.present().count() == 0
        };
        let mut rows = with.accuracy.iter();
        let found = rows.find(|(of, own)| same(of) && own.trial == score.trial);
        assert_eq!(&found.expect("a configuration of no strength").1, score);
        assert_eq!(plain.strengths.get("gain_std"), None);
    }
    let header = |tables: &_| {
        let accuracy = tables_of(tables).unwrap().swap_remove(0);
        let text = String::from_utf8(accuracy.csv).unwrap();
        text.lines().next().unwrap().to_owned()
    };
    assert!(!header(&without).contains("gain_std"));
    let named = "smoothing_mm,hysteresis_full_scale,crosstalk,gain_std,drift_std_full_scale,\
                 dead_fraction,stuck_fraction,scan_time_ms,adc_bits,ensemble";
    assert!(header(&with).contains(named));
}

#[test]
fn another_skin_reads_test_touches_and_nothing_else() {
    let signal =
        "steps = [\"gain\"]\ngain_std = 0.5\ntest_sensor = [\"same_skin\", \"another_skin\"]";
    let text = with_signal(signal);
    let [same, other, later] = [(0, 0), (1, 0), (1, 1)].map(|cell| features(&text, cell));
    assert_eq!(same.split, other.split);
    let rows = |touches: &[usize], set: &FeatureSet| set.data.records.select(Axis(0), touches);
    let (train, test) = (&same.split.train, &same.split.test);
    assert_eq!(rows(train, &same), rows(train, &other));
    // If two skins have the gains g and h, the same press gives g x and h x.
    let (one, another) = (rows(test, &same), rows(test, &other));
    let mut ratios = vec![None; one.ncols()];
    for ((place, a), b) in one.indexed_iter().zip(&another) {
        assert_eq!(*a == 0.0, *b == 0.0);
        if *a != 0.0 {
            let ratio = *ratios[place.1].get_or_insert(b / a);
            assert!((b / a / ratio - 1.0).abs() < 1e-12);
        }
    }
    let known: Vec<f64> = ratios.into_iter().flatten().collect();
    assert!(known.len() > 100 && known.iter().all(|&ratio| (ratio - 1.0).abs() > 1e-6));
    // Each trial has another test skin.
    let mut tested = other.split.test.iter();
    let both = tested.find(|touch| later.split.test.contains(touch));
    let touch = *both.expect("a touch that two trials test");
    let [a, b] = [&other, &later].map(|set| set.data.records.row(touch));
    assert_ne!(a, b);
}

#[test]
fn a_touch_is_read_as_a_press_that_goes_on_after_another_touch() {
    let signal =
        "steps = [\"hysteresis\", \"scan\"]\nhysteresis_full_scale = 0.2\nscan_time_ms = 30.0";
    let study = Study::new(&with_signal(signal));
    let array = &study.plan.array;
    let n = array.n_taxels();
    let touches = study.touches();
    let press = |row: usize, share: f64| {
        let depth = touches[row].1.depth * share;
        pressed(array, touches[row], depth).1
    };
    let steps = [
        SensorError::Hysteresis.step(&[0.2], Seed::new(1)).unwrap(),
        SensorError::Scan.step(&[30.0], Seed::new(1)).unwrap(),
    ];
    let chain = Chain::new(&steps, array.patch()).unwrap();
    let trial = 1;
    let rows = features(&with_signal(signal), (0, trial)).data.records;
    let names = Seed::new(2018).named("signal").numbered(trial as u64);
    for (row, &(object, touch)) in touches.iter().enumerate() {
        let number = row % object.touches.len();
        let name = names.named(&object.object.name).numbered(number as u64);
        let before = name.named("before").rng().gen_range(0..touches.len());
        let mut frames = press(before, 1.0);
        frames.extend(vec![0.0; n]);
        frames.extend(press(row, 0.5));
        frames.extend(press(row, 1.0));
        let recording = Recording {
            frames: &mut frames,
            rates: None,
            n_before: 2,
            interval: Some(touch.depth / 0.02 / 2.0),
            time: None,
        };
        chain.apply_recording(recording, &name, &mut SignalWorkspace::default());
        assert_eq!(rows.row(row).to_vec(), frames[2 * n..], "touch {row}");
    }
}

#[test]
fn every_strength_gets_its_small_chart_and_every_imperfection_its_picture() {
    let study = Study::new(&with_signal(ALL));
    let made = tables_of(&study.run()).unwrap();
    // The study without strengths, each strength alone, and two noises.
    assert_eq!(table(&made, "summary.csv").n_rows, 1 + 8 + 2);
    let all = charts(&made, None);
    let sheet = all.iter().find(|spec| spec.name == "accuracy_by_setting");
    let sheet = sheet.unwrap();
    let parts = &sheet.parts;
    let mut names: Vec<&str> = parts.iter().map(|spec| &spec.x[..]).collect();
    names.sort_unstable();
    let expected = "adc_bits crosstalk dead_fraction drift_std_full_scale gain_std \
                    hysteresis_full_scale noise_std scan_time_ms stuck_fraction";
    assert_eq!(names.join(" "), expected);
    let svg = draw(sheet, &made).unwrap().svg("");
    for part in parts {
        assert!(svg.contains(&format!(">{}<", part.title)), "{}", part.title);
        assert!(places(part, &made).unwrap().len() >= 2, "{}", part.x);
    }
    let samples = sample_frames(&study.plan, &study.sweep.groups, &study.touched).unwrap();
    let shown = samples.shown.frames.iter();
    let names: Vec<&str> = shown.map(|(name, _)| &name[..]).collect();
    let expected = "ideal, hysteresis 20 %, crosstalk 40 %, gain mismatch 50 %, drift 10 %, \
                    dead taxels 20 %, stuck taxels 10 %, converter 2 bits";
    assert_eq!(names.join(", "), expected);
    for (name, frame) in &samples.shown.frames[1..] {
        assert_ne!(frame, &samples.shown.frames[0].1, "{name}");
    }
}
