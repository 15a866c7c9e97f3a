//! Small and fast whole-body studies.

use crate::command::{Case, says};
use crate::study::changed;
use bubbletouch::kinds::whole_body::rows::{
    BodyCase, BodyCount, BodyRecognition, BodySensed, BodyStage, BodyTouch, Series, StepPart,
    StepTime,
};

const ROBOT: &str = include_str!("../../fixtures/texts/whole_body_robot.urdf");

const STUDY: &str = include_str!("../../fixtures/texts/whole_body.toml");

fn case(study: &str) -> Case {
    let case = Case::with("study.toml", study);
    case.file("robots/post.urdf", ROBOT);
    case
}

#[test]
fn tables_obey_their_laws() {
    let case = case(STUDY);
    let (said, _) = case.succeeds("run study.toml --threads 1 --out 1");
    let body = "From touch to answer on 18118 taxels";
    says(&said, &[body, "bytes a taxel"]);
    let cases: Vec<BodyCase> = case.rows("1/whole_body.csv");
    let counts: Vec<BodyCount> = case.rows("1/whole_body.csv");
    // 900 of 2,000 taxels are too many for a cushion.
    assert_eq!(cases.len(), 3 + 3 + 2 + 2);
    for (case, count) in cases.iter().zip(&counts) {
        assert_eq!(count.n_steps, 20);
        assert!(count.touched_min <= count.touched_max && count.bytes_per_taxel < 64.0);
        match (case.series, case.name.as_str()) {
            (Series::Scene, "nothing") => {
                assert_eq!((count.touched_max, count.deflection_sum_mm), (0, 0.0));
            }
            (Series::Scene, _) => assert!(count.touched_min > 3, "{case:?} {count:?}"),
            _ => {
                let asked: f64 = match case.series {
                    Series::Skin if case.name.ends_with(" 200 touched") => 200.0,
                    Series::Skin => 900.0,
                    Series::Touch if case.name == "100 touched" => 100.0,
                    _ => 400.0,
                };
                assert!((count.touched_mean / asked - 1.0).abs() < 0.1, "{case:?}");
            }
        }
        assert!(count.patches_touched_mean <= count.patches_visited_mean);
    }
    let sensed: Vec<BodySensed> = case.rows("1/sensed.csv");
    assert_eq!(sensed.len(), 3 * 3, "scenes and compressions");
    for row in &sensed {
        let is_untouched = row.measurement_sum_mm == 0.0;
        assert_eq!(is_untouched, row.scene == "nothing", "{row:?}");
    }
    let learned: Vec<BodyRecognition> = case.rows("1/recognition.csv");
    assert_eq!(learned.len(), 3);
    for row in &learned {
        assert_eq!((row.n_objects, row.n_training, row.n_test), (2, 40, 20));
        // A ball and a box feel different.
        assert!(row.accuracy >= 0.9, "{row:?}");
    }
    // Larger blocks read more.
    assert!(learned[0].read_fraction < learned[1].read_fraction);
    let timed: Vec<BodyCase> = case.rows("1/timing.csv");
    let stages: Vec<BodyStage> = case.rows("1/timing.csv");
    let times: Vec<StepTime> = case.rows("1/timing.csv");
    assert_eq!(times.len(), 3 * (1 + 3 * 3) + 7);
    for ((case, of), time) in timed.iter().zip(&stages).zip(&times) {
        assert!(time.us_p05 <= time.us_median && time.us_median <= time.us_p95);
        let is_press = of.stage == StepPart::Press;
        assert_eq!(of.compression.is_empty(), is_press, "{case:?}");
    }
    let steps: Vec<BodyTouch> = case.rows("1/steps.csv");
    let times: Vec<StepTime> = case.rows("1/steps.csv");
    assert_eq!(steps.len(), cases.len(), "one with all threads of each");
    for ((step, time), count) in steps.iter().zip(&times).zip(&counts) {
        assert_eq!(step.touched_mean, count.touched_mean);
        assert!((step.touched - step.touched_mean).abs() <= 0.05 * step.touched_mean);
        assert!((time.steps_per_s * time.us_median / 1e6 - 1.0).abs() < 1e-12);
    }
    for by in ["taxels", "touched", "spheres", "stage"] {
        let svg = case.read(&format!("1/time_by_{by}.svg"));
        says(&svg, &["time of a step", "a millisecond"]);
    }
    let page = case.read("1/report.html");
    says(&page, &["What does a post of skin cost?", "timing.csv"]);
    assert!(!page.contains("{{") && !page.contains("(no value"));
}

#[test]
fn scaling_points_are_named_and_grouped_by_what_was_measured() {
    let changes = [
        ("taxels = [2000, 20000]", "taxels = [20000, 5000, 2000]"),
        ("at_taxels = [200, 900]", "at_taxels = [200, 6000]"),
        ("touched = [100, 400]", "touched = [100, 30000]"),
        ("steps = 20", "steps = 5"),
    ];
    let case = case(&changed(STUDY, &changes));
    let (said, _) = case.succeeds("plan study.toml");
    says(&said, &["on a body of about 18118 taxels"]);
    case.succeeds("run study.toml --out 1");
    let cases: Vec<BodyCase> = case.rows("1/steps.csv");
    let steps: Vec<BodyTouch> = case.rows("1/steps.csv");
    let number = |text: &str| -> f64 { text.split(' ').next().unwrap().parse().unwrap() };
    let mut groups = Vec::new();
    for (case, step) in cases.iter().zip(&steps) {
        let about = format!("{case:?} {step:?}");
        match case.series {
            Series::Touch => {
                let named = number(&case.name);
                assert!((named / step.touched_mean - 1.0).abs() <= 0.05, "{about}");
            }
            Series::Skin => {
                assert_eq!(number(&case.name), case.n_taxels as f64, "{about}");
                let (_, touched) = case.name.split_once(", ").unwrap();
                assert_eq!(number(touched), step.touched, "{about}");
                groups.push(step.touched);
            }
            _ => {}
        }
    }
    // Of the sizes of one touch, all belong to one group.
    assert_eq!(groups[..3], [200.0; 3]);
    assert_eq!(groups.len(), 4);
}

#[test]
fn a_study_of_a_body_takes_no_objects_and_misses_none() {
    let case = case(STUDY);
    for command in ["plan", "run"] {
        case.refuses(&[command, "study.toml", "--objects", "robots"]);
    }
    let away = STUDY.replace("[30.0, 0.0, -100.0]", "[900.0, 900.0, 0.0]");
    case.file("away.toml", away);
    let error = case.refuses("run away.toml --out 1 --fail-fast");
    says(&error, &["scene ball, approach: no contact"]);
}
