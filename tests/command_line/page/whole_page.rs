//! Texts of a recognition study for readers: the terminal table, the answers and the page.

use crate::command::{contains, says};
use crate::report_synthetic::{
    ReportPage, about, add_headlines, configuration, each, many_cells, noise_cells,
    quickstart_cells, tables,
};
use crate::shown::html;
use bubbletouch::report::chart::draw;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::studies::recognition::charts::{answers, charts, tables_of, words};
use bubbletouch::study::table::{Configuration, Limit, Tables};

fn words_of(made: &Tables, width: usize) -> String {
    words(&tables_of(made).unwrap(), width)
}

fn answers_of(made: &Tables) -> Vec<String> {
    answers(&tables_of(made).unwrap())
}

/// Sets the accuracies of the configurations, each with an interval of ±0.01.
fn set_accuracies(made: &mut Tables, accuracies: impl IntoIterator<Item = f64>) {
    for ((_, score), accuracy) in made.summary.iter_mut().zip(accuracies) {
        score.accuracy = accuracy;
        (score.accuracy_low, score.accuracy_high) = (accuracy - 0.01, accuracy + 0.01);
    }
}

#[test]
fn the_terminal_table_fits_its_width_without_escape_codes() {
    for configurations in [
        quickstart_cells(),
        vec![configuration()],
        noise_cells(),
        many_cells(),
    ] {
        let mut made = tables(configurations, 3, 24);
        if made.summary.len() > 5 {
            add_headlines(&mut made);
        }
        for width in [80, 100, 120] {
            let text = words_of(&made, width);
            let widest = text.lines().map(|line| line.chars().count()).max();
            assert!(widest <= Some(width), "{widest:?} of {width}\n{text}");
            assert!(!text.contains('\u{1b}') && !text.contains('\u{a0}'));
        }
    }
}

#[test]
fn each_of_few_cells_has_one_line_with_its_interval() {
    let headings = [
        "pitch array m compression accuracy macro F1",
        "noise smoothing classifier accuracy",
    ];
    let studies = [quickstart_cells(), noise_cells()];
    for (configurations, heading) in studies.into_iter().zip(headings) {
        let made = tables(configurations, 3, 24);
        for width in [100, 120] {
            let text = words_of(&made, width);
            let spaced = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(width < 120 || spaced(&text).contains(heading), "{text}");
            let is_row =
                |line: &&str| line.contains("] ") && !line.starts_with(['B', 'W', 'a', 't']);
            let n_rows = text.lines().filter(is_row).count();
            assert_eq!(n_rows, made.summary.len(), "{width}\n{text}");
        }
    }
}

#[test]
fn a_narrow_terminal_keeps_the_values_and_says_what_it_leaves_out() {
    for configurations in [quickstart_cells(), noise_cells()] {
        let made = tables(configurations, 3, 24);
        let text = words_of(&made, 40);
        let (table, _) = text.split_once("Left out at this width").unwrap();
        assert_eq!(table.matches('[').count(), made.summary.len(), "{text}");
    }
}

#[test]
fn a_study_that_changes_single_settings_begins_with_what_each_costs() {
    let changed = |noise_std, smoothing_mm| Configuration {
        noise_std,
        smoothing_mm,
        ..configuration()
    };
    let settings = [(0.0, 0.0), (0.1, 0.0), (0.2, 0.0), (0.0, 4.0), (0.0, 8.0)];
    let configurations = settings.map(|(noise, smoothing)| changed(noise, smoothing));
    let mut made = tables(configurations.to_vec(), 3, 24);
    set_accuracies(&mut made, [0.90, 0.60, 0.30, 0.905, 0.895]);
    let costly = "Alone, these lower 0.90 [0.89, 0.91] the most: noise 20 % (to 0.30).";
    assert_eq!(answers_of(&made)[0], costly);
    let made = tables_of(&made).unwrap();
    let first = charts(&made, None).swap_remove(0);
    assert_eq!(first.name, "accuracy_by_change");
    let svg = draw(&first, &made).unwrap().svg("");
    let place = |text: &str| svg.find(&format!(">{text}<")).unwrap();
    assert!(place("noise") < place("smoothing"));
    assert!(svg.contains(">20 %<") && svg.contains("unchanged, 0.90"));
}

#[test]
fn settings_that_break_recognition_are_small_charts_with_their_places_marked() {
    // Noise of tests, noise and smoothing are changed alone; each takes the accuracy from 0.9 to chance.
    let base = Configuration {
        mislabelled_fraction: Some(0.0),
        ..configuration()
    };
    let mut configurations = vec![base.clone()];
    for strength in [0.1, 0.2, 0.4] {
        let [mut noisy, mut smooth, mut mislabelled] = [(); 3].map(|()| base.clone());
        noisy.noise_std = strength;
        smooth.smoothing_mm = 10.0 * strength;
        mislabelled.mislabelled_fraction = Some(strength);
        configurations.extend([noisy, smooth, mislabelled]);
    }
    let mut made = tables(configurations, 3, 10);
    let accuracies = [0.9, 0.7, 0.7, 0.7, 0.3, 0.3, 0.3, 0.1, 0.1, 0.1];
    set_accuracies(&mut made, accuracies);
    let made = tables_of(&made).unwrap();
    let all = charts(&made, None);
    assert_eq!(all[0].name, "accuracy_by_setting");
    assert!(all.iter().all(|chart| chart.name != "accuracy_by_change"));
    let parts = &all[0].parts;
    let svg = draw(&all[0], &made).unwrap().svg("");
    for (title, note) in [
        ("noise (%)", "breaks at 15 %"),
        ("mislabelled (%)", "breaks at 15 %"),
        ("smoothing (mm)", "breaks at 1.5 mm"),
    ] {
        let part = parts.iter().find(|part| part.title == title).unwrap();
        assert_eq!(part.note, note);
        // Half-way from 0.9 to chance, 1 in 10, is 0.5.
        assert!((part.dots[0].at.1 - 0.5).abs() < 1e-12, "{:?}", part.dots);
        for text in [title, note] {
            assert!(svg.contains(&format!(">{text}<")), "{text}");
        }
    }
}

#[test]
fn of_many_cells_the_best_are_shown_and_what_is_left_out_is_said() {
    let mut made = tables(many_cells(), 3, 24);
    made.summary[217].1.accuracy = 0.99;
    made.summary[60].1.accuracy = 0.98;
    for width in [60, 100] {
        let text = words_of(&made, width);
        says(&text, &["The best 40 of 300 rows; all are in the tables."]);
        let has_interval = |line: &&str| line.contains("] ") || line.ends_with(']');
        let first: Vec<&str> = text.lines().filter(has_interval).take(2).collect();
        assert!(contains(&first.concat(), "0.99 [ … 0.98 ["), "{text}");
    }
    let none = words_of(&Tables::default(), 80);
    assert_eq!(none, "No configuration has been computed.\n");
}

#[test]
fn the_answer_names_the_best_the_frugal_and_each_effect() {
    let mut made = tables(quickstart_cells(), 3, 24);
    // Configuration 4 is the best (0.76); the configuration at 16:1 is within its interval.
    made.summary[5].1.accuracy = 0.74;
    let sentences = answers_of(&made);
    let frugal = "Within the interval of the best, for the least measurements a decision … compression 16:1 … m = 256";
    assert!(contains(&sentences[0], frugal), "{sentences:?}");
    assert!(
        sentences[1].starts_with("Best accuracy: 0.76 ["),
        "{sentences:?}"
    );
    let best = [
        "pitch 2 mm",
        "array size 128 mm",
        "compression 4:1",
        "m = 1024",
    ];
    says(&sentences[1], &best);
    assert!(!sentences.iter().any(|said| said.contains("Mean accuracy")));
    let none = answers_of(&Tables::default());
    assert_eq!(none, ["No configuration has been computed."]);
}

#[test]
fn each_condition_has_a_best_of_its_own_and_one_answer_to_fewest_measurements() {
    // For each of two noises, the most accurate configuration has the most measurements, and half as many are as good.
    let noises = each(vec![configuration()], [0.0, 0.1], |one, std| {
        one.noise_std = std
    });
    let configurations = each(noises, [512, 256, 128], |one, measurements| {
        (one.measurements, one.ratio) = (measurements, 4096.0 / measurements as f64);
    });
    let mut made = tables(configurations, 3, 24);
    set_accuracies(&mut made, [0.90, 0.895, 0.60, 0.50, 0.495, 0.30]);
    let said = answers_of(&made).join("\n");
    for (noise, best, frugal) in [
        (0, "0.90 [0.89, 0.91] at", "0.90 ["),
        (10, "0.50 [0.49, 0.51] at", "0.49 ["),
    ] {
        let best = format!("Best accuracy with noise {noise} %: {best}");
        let frugal = format!(
            "Within the interval of the best with noise {noise} %, for the least measurements a decision: {frugal}"
        );
        says(&said, &[best, frugal]);
    }
    assert!(
        !said.contains("at noise"),
        "a condition is not chosen: {said}"
    );
    assert_eq!(said.matches("m = 256").count(), 2, "{said}");
}

#[test]
fn too_few_trials_for_a_p_value_are_said() {
    let made = tables(noise_cells(), 1, 24);
    let said = answers_of(&made).join(" ");
    let few = "No p-values where trials are too few: 4 are needed.";
    says(&said, &[few]);
    assert!(html(&made, &about()).contains("too_few_trials"));
}

#[test]
fn the_page_says_what_it_is() {
    let made = tables(quickstart_cells(), 3, 24);
    let html = html(&made, &about());
    assert!(!html.contains("@import") && !html.contains("<link rel=\"stylesheet"));
    assert!(!html.contains("{{") && !html.contains("(no value for"));
    let question = "array size &amp; compression when m &lt; n?";
    says(
        &html,
        &["quickstart", question, "5120 of 9830400", "41.3 s"],
    );
    says(&html, &["Accuracy by compression", "Confusion matrix"]);
    assert!(html.len() < 2_000_000, "{}", html.len());
}

#[test]
fn nothing_a_user_writes_becomes_markup() {
    let evil = "<img src=x onerror=alert(1)>\"'&{{command}}".to_owned();
    let page = ReportPage {
        about: StudyAbout {
            name: evil.clone(),
            question: evil.clone(),
            expected: evil.clone(),
            command: evil.clone(),
            program: evil.clone(),
            wall_s: f64::NAN,
            ..StudyAbout::default()
        },
        settings: vec![(evil.clone(), evil.clone())],
        limits: vec![Limit {
            limit: evil.clone(),
            count: 1,
            total: 0,
            meaning: evil.clone(),
        }],
        ..ReportPage::default()
    };
    let mut made = tables(vec![configuration()], 1, 3);
    for row in &mut made.confusion {
        row.object = evil.clone();
    }
    made.stages[0].stage = evil;
    let html = html(&made, &page);
    assert!(!html.contains("<img src=x"));
    assert!(html.matches("&lt;img src=x onerror=alert(1)&gt;").count() > 10);
}

#[test]
fn a_study_without_anything_still_has_a_page() {
    let html = html(&Tables::default(), &ReportPage::default());
    assert!(html.contains("No configuration has been computed."));
}

#[test]
fn published_accuracies_and_confused_pairs_stand_on_the_terminal_and_on_the_page() {
    let mut made = tables(quickstart_cells(), 3, 24);
    assert!(!words_of(&made, 80).contains("Published accuracies"));
    add_headlines(&mut made);
    let words = ["Published accuracies", "98 % of touches, noise &lt; 1 %"];
    let html = html(&made, &about());
    says(&html, &words);
    says(&html, &["bowl &lt;&amp;&gt;"]);
    let text = words_of(&made, 120);
    says(
        &text,
        &[
            "Published accuracies",
            "0.98",
            "Most frequent confusions",
            "bowl <&>",
        ],
    );
    for accuracy in [made.summary[5].1.accuracy, made.confused[0].fraction] {
        says(&text, &[format!("{accuracy:.2}")]);
    }
}
