//! Charts of accuracy against time: when they are drawn, and what they show.

use crate::report_synthetic::{configuration, noise_cells, tables};
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::report::chart::draw;
use bubbletouch::studies::recognition::charts::{charts, tables_of};
use bubbletouch::study::table::Configuration;
use bubbletouch::table::{ChartSpec, Table};

fn of_three_classifiers() -> Vec<Configuration> {
    use ClassifierKind::{LinearSvm, PolynomialSvm, RbfSvm};
    let mut configurations = Vec::new();
    for noise_std in [0.0, 0.1] {
        for classifier in [LinearSvm, RbfSvm, PolynomialSvm] {
            for measurements in [16, 64, 256] {
                configurations.push(Configuration {
                    noise_std,
                    classifier,
                    measurements,
                    ratio: 4096.0 / measurements as f64,
                    ..configuration()
                });
            }
        }
    }
    configurations
}

fn fronts(configurations: Vec<Configuration>, asked: Option<bool>) -> (Vec<Table>, Vec<ChartSpec>) {
    let made = tables_of(&tables(configurations, 3, 24)).unwrap();
    let mut specs = charts(&made, asked);
    specs.retain(|spec| spec.front);
    (made, specs)
}

#[test]
fn accuracy_is_charted_against_time_when_classifiers_are_compared_or_a_study_asks() {
    let names = |configurations: Vec<Configuration>, asked: Option<bool>| -> Vec<String> {
        fronts(configurations, asked)
            .1
            .into_iter()
            .map(|spec| spec.name)
            .collect()
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
    let (made, specs) = fronts(of_three_classifiers(), None);
    assert_eq!(specs.len(), 2);
    for spec in specs {
        let svg = draw(&spec, &made).unwrap().svg(&spec.title);
        for text in [
            "linear SVM",
            "RBF SVM",
            "polynomial SVM",
            "noise 0 %",
            "noise 10 %",
            "Pareto front",
        ] {
            assert!(svg.contains(text), "{} says {text}", spec.name);
        }
        if let Ok(folder) = std::env::var("BUBBLETOUCH_PICTURES") {
            let png = draw(&spec, &made).unwrap().png().unwrap();
            std::fs::write(format!("{folder}/{}.png", spec.name), png).unwrap();
        }
    }
}
