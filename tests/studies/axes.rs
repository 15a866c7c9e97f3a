//! Studies with axes of their own: each combination equals the study with its values, and common parts are computed once.

use crate::command::{Case, says};
use crate::study::{Study, assert_reads_back, laid_out, run, scores};
use bubbletouch::kinds::Study as _;
use bubbletouch::studies::recognition::charts::tables_of;
use bubbletouch::study::progress::Silent;

const REST: &str = include_str!("../fixtures/texts/axes_rest.toml");

const HEAD: &str = "question = \"?\"\ntrials = 2\n";
const LEARNING: &str = "[recognition]\ntest_fraction = 0.25\n";

fn with_axes(axes: &str) -> String {
    format!("{HEAD}{REST}{LEARNING}[axes]\n{axes}")
}

#[test]
fn each_combination_scores_what_the_study_with_its_values_scores() {
    let axes = "touches.depth_mm = [1.0, 3.0]\nskin.stroke_mm = [2.0, 5.0]\n\
                recognition.classifier = [\"linear_svm\", \"k_nearest\"]\nrecognition.n_neighbours = [1, 3]\ntouches.yaw_deg = [0.0, 40.0]";
    let outcome = run(&with_axes(axes));
    let mut expected = Vec::new();
    for number in 0..16 {
        // The last axis changes fastest.
        let [depth, stroke, neighbours, yaw] = [3, 2, 1, 0].map(|bit| number >> bit & 1);
        let depth = format!("depth_mm = {:?}", [1.0, 3.0][depth]);
        let stroke = format!("stroke_mm = {:?}", [2.0, 5.0][stroke]);
        let yaw = format!("yaw_deg = {:?}", [0.0, 40.0][yaw]);
        let neighbours = [1, 3][neighbours];
        let rest = REST
            .replace("taxels = 8", &format!("taxels = 8\n{stroke}"))
            .replace("per_object", &format!("{depth}\n{yaw}\nper_object"));
        let classifiers = "classifier = [\"linear_svm\", \"k_nearest\"]";
        let text = format!("{HEAD}{rest}{LEARNING}{classifiers}\nn_neighbours = {neighbours}\n");
        expected.extend(scores(&Study::new(&text).run()));
    }
    assert_eq!(scores(&outcome), expected);
    let places = outcome.summary.iter().enumerate();
    for (place, (configuration, _)) in places {
        assert_eq!(configuration.configuration, place);
        let values = configuration.variant.values.iter();
        let columns: Vec<&str> = values.map(|value| &value.column.name[..]).collect();
        let expected = ["depth_mm", "stroke_mm", "n_neighbours", "yaw_deg"];
        assert_eq!(columns, expected);
    }
}

#[test]
fn what_does_not_change_is_made_once() {
    let stages = |axes: &str| {
        let outcome = run(&with_axes(axes));
        let stages = outcome.stages.iter();
        let counted = stages.map(|row| (row.stage.clone(), row.n_touches));
        counted.collect::<Vec<_>>()
    };
    let alone = "touches.depth_mm = [1.0]\nskin.stroke_mm = [5.0]\nrecognition.classifier = [\"linear_svm\"]\n";
    let once = [("simulate".to_owned(), 36), ("measure".to_owned(), 2 * 36)];
    // Only the fits differ.
    let learning = format!("{alone}recognition.scaling = [\"standard\", \"none\"]");
    assert_eq!(stages(&learning), once);
    // The touches are the same, and are measured for each value.
    let signal =
        format!("{alone}skin.damping_n_s_per_m = [0.1]\ntouches.speed_mm_per_s = [0.0, 5.0]");
    let measured = ("measure".to_owned(), 4 * 36);
    assert_eq!(stages(&signal), [once[0].clone(), measured]);
    // Flat layouts have no radius: three arrays of four.
    let curved = "skin.layout = [\"disc\", \"cap\"]\nskin.curvature_radius_mm = [30.0, 60.0]";
    let thrice = vec![once; 3].concat();
    assert_eq!(stages(&format!("{alone}{curved}")), thrice);
}

#[test]
fn an_axis_with_more_values_leaves_the_names_of_what_was_done() {
    let names = |depths: &str| {
        let axes = format!(
            "touches.depth_mm = {depths}\nskin.stroke_mm = [5.0]\nrecognition.classifier = [\"k_nearest\"]"
        );
        let pieces = laid_out(&with_axes(&axes)).unwrap().work_items();
        let names = pieces.into_iter().map(|piece| (piece.name, piece.inputs));
        names.collect::<Vec<_>>()
    };
    let (few, many) = (names("[1.0, 3.0]"), names("[0.5, 1.0, 3.0]"));
    assert!(few.iter().all(|name| many.contains(name)));
    let mut different = many.clone();
    different.sort();
    different.dedup();
    assert_eq!(different.len(), many.len());
}

#[test]
fn tables_of_a_study_with_axes_read_back_as_they_are() {
    let axes = "touches.depth_mm = [1.0, 3.0]\nskin.stroke_mm = [5.0]\nrecognition.classifier = [\"k_nearest\"]\nobjects.names = [[\"golf\", \"baseball\"]]";
    let text = with_axes(axes).replace("names = [\"golf\", \"tennis\", \"baseball\"]", "");
    let study = laid_out(&text).unwrap();
    let made = tables_of(&study.run(&Silent).unwrap()).unwrap();
    assert_reads_back(&study, &made);
    assert!(made[0].column("depth_mm").is_some());
}

#[test]
fn a_fit_is_counted_once_for_all_its_decisions_and_only_if_its_solver_has_a_cap() {
    let axes = "touches.depth_mm = [1.0]\nskin.stroke_mm = [5.0]\n\
                recognition.classifier = [\"linear_svm\", \"k_nearest\"]\n\
                recognition.touches_per_decision = [1, 2, 3]\nrecognition.c = [1.0, 10.0]";
    let mut limits = run(&with_axes(axes)).limits.into_iter();
    let fits = limits.find(|row| row.limit.starts_with("fits stopped"));
    // Two trials, two ratios and two values of C of the SVM.
    assert_eq!(fits.unwrap().total, 2 * 2 * 2);
}

#[test]
fn objects_of_the_command_and_an_axis_of_objects_exclude_each_other() {
    let case = Case::new();
    let axes = "objects.sets = [[\"balls\"], [\"balls\", \"cans\"]]\ntouches.depth_mm = [1.0]\n\
                skin.stroke_mm = [5.0]\nrecognition.classifier = [\"k_nearest\"]";
    let rest = REST.replace("sets = [\"balls\"]\n", "");
    case.file("sets.toml", format!("{HEAD}{rest}{LEARNING}[axes]\n{axes}"));
    case.succeeds("plan sets.toml");
    let said = case.refuses("plan sets.toml --objects own.toml");
    let wanted = "--objects: own.toml; no such option: objects.sets is an axis of the study";
    says(&said, &[wanted]);
}

#[test]
fn plan_and_page_state_all_values_of_an_axis_and_what_test_touches_differ_in() {
    let case = Case::new();
    let axes = "\"skin.stroke_mm\" = [3.0, 5.0]\n\"touches.per_object\" = [8, 12]\n\"recognition.test_fraction\" = [0.25, 0.5]\n";
    let rest = REST.replace("per_object = 12\n", "depth_mm = 2.0\n");
    let test = "[test]\nsignal.noise_std_n = 0.02\ntouches.depth_mm = 1.5\n";
    let recognition = "[recognition]\nclassifier = \"linear_svm\"\n";
    let study = format!("{HEAD}{rest}{recognition}{test}[axes]\n{axes}");
    case.file("study.toml", study);
    let (said, _) = case.succeeds("plan study.toml");
    let differs = "test.signal.noise_std_n = 0.02, test.touches.depth_mm = 1.5";
    says(&said, &["  touches  24; 36 on each of 2 arrays; "]);
    says(&said, &[&format!("; test touches with {differs}")]);
    case.succeeds("run study.toml --out found");
    let page = case.read("found/report.html");
    let (_, settings) = page.split_once("id=\"settings\"").unwrap();
    for (name, value) in [
        ("Touches", "24; 36"),
        ("Stroke", "3 mm; 5 mm"),
        ("Test touches differ in", differs),
    ] {
        let stated = format!("{name}</dt><dd>{value}");
        assert!(settings.contains(&stated), "{stated}");
    }
}
