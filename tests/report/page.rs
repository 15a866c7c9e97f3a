//! What people read: the terminal table and the page.

use crate::report_synthetic::{
    about, add_headlines, cell, many_cells, noise_cells, quickstart_cells, tables,
};
use bubbletouch::report::answer::Answer;
use bubbletouch::report::headlines;
use bubbletouch::report::offers::cell_offers;
use bubbletouch::report::page::{Limit, Picture, Pictures, ReportPage, page};
use bubbletouch::report::results::draw_charts;
use bubbletouch::report::terminal::summary_table;
use bubbletouch::study::advice::{Cost, Wish, advise, by_condition};
use bubbletouch::study::table::{Cell, Tables};

#[test]
fn the_terminal_table_fits_its_width_without_escape_codes() {
    for cells in [
        quickstart_cells(),
        vec![cell()],
        noise_cells(),
        many_cells(),
    ] {
        let made = tables(cells, 3, 24);
        for width in [80, 100, 120] {
            let text = summary_table(&made, width, "results/x/summary.csv");
            assert!(
                text.lines().all(|line| line.chars().count() <= width),
                "{width}\n{text}"
            );
            assert!(!text.contains('\u{1b}') && !text.contains('\u{a0}'));
        }
    }
}

#[test]
fn each_of_few_cells_has_one_line_with_its_interval() {
    for (cells, heading) in [
        (
            quickstart_cells(),
            "pitch  array size  compression     m   accuracy [95 %]  macro-F1",
        ),
        (noise_cells(), "noise  smoothing  classifier"),
    ] {
        let made = tables(cells, 3, 24);
        for width in [80, 100, 120] {
            let text = summary_table(&made, width, "summary.csv");
            let spaced = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(spaced(&text).contains(&spaced(heading)), "{text}");
            let intervals = text
                .lines()
                .filter(|line| line.contains("] ") && !line.starts_with(['B', 'W']));
            // The heading has a bracket too.
            assert_eq!(intervals.count(), made.summary.len() + 1, "{width}\n{text}");
        }
    }
}

#[test]
fn many_cells_stand_compactly_and_what_is_left_out_is_said() {
    let made = tables(many_cells(), 3, 24);
    let text = summary_table(&made, 100, "results/x/summary.csv");
    assert!(text.contains("100:1"));
    assert!(
        text.contains("Left out here: 20 of 60 lines, 0 of 5 columns; all 300 cells are in results/x/summary.csv"),
        "{text}"
    );
    let narrow = summary_table(&made, 60, "results/x/summary.csv");
    assert!(
        narrow.contains("of 5 columns") && !narrow.contains("0 of 5 columns"),
        "{narrow}"
    );
    let none = summary_table(&Tables::default(), 80, "x");
    assert_eq!(none, "No cell has been computed.\n");
}

#[test]
fn the_answer_names_the_best_the_frugal_and_each_effect() {
    let mut made = tables(quickstart_cells(), 3, 24);
    // Cell 4 is the best (0.76); let 16:1 there come within its interval.
    made.summary[5].1.accuracy = 0.74;
    let answer = Answer::of(&made).unwrap();
    assert_eq!(answer.best.0.cell, 4);
    assert_eq!(answer.findings.len(), 1);
    assert_eq!(answer.findings[0].frugal.0.cell, 5);
    let sentences = answer.sentences();
    assert!(
        sentences[0].starts_with("Best accuracy 0.76 ["),
        "{sentences:?}"
    );
    assert!(
        sentences[0].ends_with("at pitch 2 mm, array size 128 mm, compression 4:1, m = 1024."),
        "{sentences:?}"
    );
    assert!(
        sentences[1].ends_with("at pitch 2 mm, array size 128 mm, compression 16:1, m = 256."),
        "{sentences:?}"
    );
    // Each effect's means are those of a plain average over the other settings.
    for effect in &answer.effects {
        for (value, mean) in &effect.means {
            let rows = made
                .summary
                .iter()
                .filter(|(cell, _)| effect.axis.value(cell) == *value);
            let accuracies: Vec<f64> = rows.map(|(_, score)| score.accuracy).collect();
            assert_eq!(accuracies.len(), effect.n_combinations);
            let plain = accuracies.iter().sum::<f64>() / accuracies.len() as f64;
            assert!((plain - mean).abs() < 1e-12);
        }
    }
    assert_eq!(answer.effects.len(), 3);
    assert!(Answer::of(&Tables::default()).is_none());
}

#[test]
fn each_condition_has_a_best_of_its_own_and_one_answer_to_fewest_measurements() {
    // Two noises; in each the most accurate has most measurements, and half as many are as good.
    let mut cells = Vec::new();
    for noise_std in [0.0, 0.1] {
        for measurements in [512, 256, 128] {
            cells.push(Cell {
                noise_std,
                measurements,
                ratio: 4096.0 / measurements as f64,
                ..cell()
            });
        }
    }
    let mut made = tables(cells, 3, 24);
    for (number, accuracy) in [0.90, 0.895, 0.60, 0.50, 0.495, 0.30]
        .into_iter()
        .enumerate()
    {
        let score = &mut made.summary[number].1;
        (score.accuracy, score.accuracy_low, score.accuracy_high) =
            (accuracy, accuracy - 0.01, accuracy + 0.01);
        made.pareto[number].1.accuracy = accuracy;
    }
    let answer = Answer::of(&made).unwrap();
    let found: Vec<(&str, usize, usize)> = answer
        .findings
        .iter()
        .map(|f| (&f.condition[..], f.best.0.cell, f.frugal.0.cell))
        .collect();
    assert_eq!(found, [("noise 0 %", 0, 1), ("noise 10 %", 3, 4)]);
    let said = answer.sentences().join("\n");
    assert!(
        said.contains("Best accuracy with noise 0 % 0.90 [0.89, 0.91] at"),
        "{said}"
    );
    assert!(
        said.contains("Best accuracy with noise 10 % 0.50 [0.49, 0.51] at"),
        "{said}"
    );
    assert!(
        !said.contains("at noise"),
        "a condition is not chosen: {said}"
    );
    let remarks: Vec<&str> = made
        .summary
        .iter()
        .map(|(cell, score)| answer.remark(cell, score))
        .collect();
    assert_eq!(remarks, ["best", "as good", "", "best", "as good", ""]);
    // The sentences, the table of choices and advice name the same cell as of fewest measurements.
    let html = page(&about(), &made, &Pictures::default()).unwrap();
    for (condition, cell) in [("noise 0 %", 1), ("noise 10 %", 4)] {
        let row = html.split("<tr>").find(|row| {
            row.contains(&format!("<td>{condition}</td>")) && row.contains("fewest measurements")
        });
        let row = row.unwrap_or_else(|| panic!("no row for {condition}"));
        assert!(row.contains(&format!("(cell {cell})")), "{row}");
    }
    let offers = cell_offers(&made.pareto, &made.summary, &[]).unwrap();
    for (offers, finding) in by_condition(&offers).iter().zip(&answer.findings) {
        let wish = Wish::Accuracy(finding.best.1.accuracy_low);
        let advice = advise(offers, wish, Cost::Measurements).unwrap();
        assert_eq!(advice.choice.cell, Some(finding.frugal.0.cell));
    }
}

#[test]
fn too_few_trials_for_a_p_value_are_said_and_no_p_value_is() {
    let made = tables(noise_cells(), 1, 24);
    let html = page(&about(), &made, &Pictures::default()).unwrap();
    assert!(
        html.contains("No p-values: 1 trial a cell are too few"),
        "the page says so"
    );
    assert!(html.contains("<td>too few trials</td>"));
}

#[test]
fn an_effect_leaves_out_settings_that_lack_a_value() {
    let mut made = tables(quickstart_cells(), 1, 24);
    // Without the finest array's 256:1, that array must not lift the other ratios' means.
    made.summary
        .retain(|(cell, _)| !(cell.nx == 64 && cell.ratio == 256.0));
    let answer = Answer::of(&made).unwrap();
    let ratio = answer
        .effects
        .iter()
        .find(|effect| effect.means.len() == 4)
        .unwrap();
    assert_eq!(ratio.n_combinations, 3);
}

#[test]
fn the_page_needs_no_network() {
    let html = whole_page(&about(), &tables(quickstart_cells(), 3, 24));
    assert!(
        !html.contains(" src=\"http")
            && !html.contains("@import")
            && !html.contains("<link rel=\"stylesheet")
    );
    let without_names = html.replace("http://www.w3.org/2000/svg", "");
    assert!(!without_names.contains("http://") && !without_names.contains("https://"));
    assert!(!html.contains("{{") && !html.contains("(no value for"));
    for part in [
        "quickstart",
        "array size &amp; compression when m &lt; n?",
        "5120 of 9830400",
        "41.3 s",
        "recognise with linear SVM",
        "7 more charts lie beside this page",
    ] {
        assert!(html.contains(part), "{part}");
    }
    // Every row of the summary.
    assert_eq!(
        html.matches("<tr><td>2 mm</td>").count() + html.matches("<tr><td>4 mm</td>").count(),
        15
    );
    assert_eq!(html.matches("<tr class=\"best\">").count(), 1);
}

#[test]
fn nothing_a_user_writes_becomes_markup() {
    let evil = "<img src=x onerror=alert(1)>\"'&{{command}}".to_owned();
    let page = ReportPage {
        name: evil.clone(),
        question: evil.clone(),
        expected: evil.clone(),
        settings: vec![(evil.clone(), evil.clone())],
        limits: vec![Limit {
            what: evil.clone(),
            count: 1,
            of: 0,
            meaning: evil.clone(),
        }],
        command: evil.clone(),
        program: evil.clone(),
        ..ReportPage::default()
    };
    let mut made = tables(vec![cell()], 1, 3);
    for row in &mut made.confusion {
        row.object = evil.clone();
    }
    made.stages[0].stage = evil;
    let html = whole_page(&page, &made);
    assert!(!html.contains("<img src=x"));
    assert_eq!(
        html.matches("&lt;img src=x onerror=alert(1)&gt;").count(),
        11
    );
}

#[test]
fn a_study_without_anything_still_has_a_page() {
    let html = whole_page(&ReportPage::default(), &Tables::default());
    assert!(html.contains("No cell has been computed."));
}

#[test]
fn the_page_of_300_cells_stays_small() {
    let html = whole_page(&about(), &tables(many_cells(), 3, 24));
    assert!(html.len() < 1_000_000, "{}", html.len());
}

fn whole_page(about: &ReportPage, made: &Tables) -> String {
    let charts = draw_charts(made);
    let pictures = Pictures {
        charts: charts
            .iter()
            .map(|(_, title, drawing)| Picture::of(drawing, title))
            .collect(),
        n_more_charts: 7,
        ..Pictures::default()
    };
    page(about, made, &pictures).unwrap()
}

#[test]
fn published_accuracies_and_confused_pairs_stand_on_the_terminal_and_on_the_page() {
    let mut made = tables(quickstart_cells(), 3, 24);
    let without = page(&about(), &made, &Pictures::default()).unwrap();
    assert!(!without.contains("Beside what was published") && !without.contains("Most often"));
    assert_eq!(headlines::text(&made, 80), "");
    add_headlines(&mut made);
    let (cell, score) = &made.summary[5];
    let ours = format!(
        "{:.3} [{:.3}, {:.3}]",
        score.accuracy, score.accuracy_low, score.accuracy_high
    );
    let difference = format!("{:+.3}", score.accuracy - 0.98);
    let html = page(&about(), &made, &Pictures::default()).unwrap();
    for text in [
        "Beside what was published",
        "98 % of touches, noise &lt; 1 % [CL]",
        "(best of 4 cells)",
        &ours,
        &difference,
        "Most often confused",
        "bowl &lt;&amp;&gt;",
        "24 of 75",
    ] {
        assert!(html.contains(text), "the page says {text}");
    }
    assert!(
        html.find("Beside what").unwrap() < html.find("<section id=\"accuracy\"").unwrap(),
        "what was published comes right after the answer"
    );
    let text = headlines::text(&made, 100);
    let m = format!("m = {}", cell.measurements);
    for said in ["[CL]", "0.98", &ours, &difference, "24 of 75", "0.32", &m] {
        assert!(text.contains(said), "the terminal says {said}:\n{text}");
    }
    for width in [80, 100, 120] {
        let text = headlines::text(&made, width);
        let widest = text.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(width), "{widest:?}\n{text}");
    }
}
