//! Charts of accuracy against time: when they are drawn, and what stands on them.

use crate::report_synthetic::{cell, noise_cells, tables};
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::report::results::draw_pareto_charts;
use bubbletouch::study::table::Cell;

fn of_three_classifiers() -> Vec<Cell> {
    use ClassifierKind::{LinearSvm, PolynomialSvm, RbfSvm};
    let mut cells = Vec::new();
    for noise_std in [0.0, 0.1] {
        for classifier in [LinearSvm, RbfSvm, PolynomialSvm] {
            for measurements in [16, 64, 256] {
                cells.push(Cell {
                    noise_std,
                    classifier,
                    measurements,
                    ratio: 4096.0 / measurements as f64,
                    ..cell()
                });
            }
        }
    }
    cells
}

#[test]
fn accuracy_is_charted_against_time_when_classifiers_are_compared_or_a_study_asks() {
    let names = |cells: Vec<Cell>, asked: Option<bool>| -> Vec<String> {
        let charts = draw_pareto_charts(&tables(cells, 3, 24), asked);
        charts.into_iter().map(|(name, _, _)| name).collect()
    };
    let both = ["pareto_training", "pareto_prediction"];
    assert_eq!(names(of_three_classifiers(), None), both);
    assert!(names(of_three_classifiers(), Some(false)).is_empty());
    assert!(names(noise_cells(), None).is_empty(), "two classifiers");
    assert_eq!(names(noise_cells(), Some(true)), both);
    assert!(names(Vec::new(), Some(true)).is_empty());
}

#[test]
fn every_classifier_and_every_noise_is_named_on_the_chart() {
    let made = tables(of_three_classifiers(), 3, 24);
    let again = draw_pareto_charts(&made, None);
    for (place, (name, title, drawing)) in draw_pareto_charts(&made, None).iter().enumerate() {
        let svg = drawing.svg(title);
        for text in [
            "linear SVM",
            "RBF SVM",
            "polynomial SVM",
            "noise 0 %",
            "noise 10 %",
            "Pareto front",
        ] {
            assert!(svg.contains(text), "{name} says {text}");
        }
        assert_eq!(svg, again[place].2.svg(title), "equal tables, equal bytes");
        if let Ok(folder) = std::env::var("BUBBLETOUCH_PICTURES") {
            std::fs::write(format!("{folder}/{name}.png"), drawing.png().unwrap()).unwrap();
        }
    }
}
