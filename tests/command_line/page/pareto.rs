//! Charts of accuracy against time: when they are drawn, and what they show.

use crate::command::says;
use crate::report_synthetic::{configuration, each, noise_cells, quickstart_cells, tables};
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::report::chart::draw;
use bubbletouch::studies::recognition::charts::{charts, tables_of};
use bubbletouch::study::table::Configuration;

fn of_three_classifiers() -> Vec<Configuration> {
    use ClassifierKind::{LinearSvm, PolynomialSvm, RbfSvm};
    let noises = each(vec![configuration()], [0.0, 0.1], |one, std| {
        one.noise_std = std
    });
    let kinds = [LinearSvm, RbfSvm, PolynomialSvm];
    let classifiers = each(noises, kinds, |one, kind| one.classifier = kind);
    measured(classifiers, [16, 64, 256])
}

/// Returns each configuration with each number of measurements.
fn measured<const N: usize>(
    configurations: Vec<Configuration>,
    measurements: [usize; N],
) -> Vec<Configuration> {
    each(configurations, measurements, |one, measurements| {
        (one.measurements, one.ratio) = (measurements, 4096.0 / measurements as f64);
    })
}

#[test]
fn accuracy_against_time_is_among_the_first_two_charts_of_every_study_of_three_designs() {
    let names = |configurations: Vec<Configuration>, asked: Option<bool>| -> Vec<String> {
        let made = tables_of(&tables(configurations, 3, 24)).unwrap();
        let specs = charts(&made, asked).into_iter();
        specs.map(|spec| spec.name).collect()
    };
    let place = |names: &[String], chart: &str| names.iter().position(|name| name == chart);
    let [decision, training] = ["pareto_prediction", "pareto_training"];
    for (configurations, asked, compares_classifiers) in [
        (of_three_classifiers(), None, true),
        (quickstart_cells(), None, false),
        (noise_cells(), None, false),
        (two_designs(), Some(true), true),
    ] {
        let names = names(configurations, asked);
        assert!(
            place(&names, decision).is_some_and(|place| place < 2),
            "{names:?}"
        );
        assert_eq!(
            place(&names, training).is_some(),
            compares_classifiers,
            "{names:?}"
        );
    }
    for (configurations, asked) in [
        (of_three_classifiers(), Some(false)),
        (two_designs(), None),
        (Vec::new(), Some(true)),
    ] {
        let names = names(configurations, asked);
        assert_eq!(place(&names, decision), None, "{names:?}");
    }
}

/// Returns two configurations that differ only in their number of measurements.
fn two_designs() -> Vec<Configuration> {
    measured(vec![configuration()], [16, 64])
}

#[test]
fn every_classifier_and_every_noise_is_named_on_the_chart() {
    let made = tables_of(&tables(of_three_classifiers(), 3, 24)).unwrap();
    let mut specs = charts(&made, None);
    specs.retain(|spec| spec.front);
    assert_eq!(specs.len(), 2);
    for spec in specs {
        let svg = draw(&spec, &made).unwrap().svg(&spec.title);
        says(
            &svg,
            &[
                "linear SVM",
                "RBF SVM",
                "polynomial SVM",
                "noise 0 %",
                "noise 10 %",
                "Pareto front",
            ],
        );
    }
}
