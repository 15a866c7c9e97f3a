//! The page in a browser: what it answers to the mouse and to the keyboard.

use crate::browser::shown::{Shown, show};
use crate::browser::{ARROW_DOWN, ARROW_RIGHT, Browser};
use crate::report_synthetic::{about, noise_cells, quickstart_cells, tables};
use bubbletouch::report::offers::cell_offers;
use bubbletouch::study::advice::{Cost, Wish, advise, by_condition};
use serde_json::json;
use std::thread::sleep;
use std::time::Duration;

/// Where the first point of a chart stands in the window, after scrolling there.
fn first_point(browser: &Browser, chart: &str) -> (f64, f64) {
    let place = browser.run(&format!(
        "document.querySelector('{chart} .panels').scrollIntoView({{ block: 'center', behavior: 'instant' }});
         const box = document.querySelector('{chart} .panels svg > path[transform]').getBoundingClientRect();
         return [box.left + box.width / 2, box.top + box.height / 2]"
    ));
    (place[0].as_f64().unwrap(), place[1].as_f64().unwrap())
}

const TIP: &str =
    "return document.querySelector('.tip').hidden ? '' : document.querySelector('.tip').innerText";
const SPOKEN: &str = "return document.querySelector('[aria-live]').textContent";

/// What the first point of a chart tells the mouse. (A browser beside many others may still lay out its page when the mouse first comes.)
fn told_by_first_point(browser: &Browser, chart: &str) -> String {
    for _ in 0..20 {
        let (x, y) = first_point(browser, chart);
        browser.point_at(x, y);
        let said = browser.text(TIP);
        if !said.is_empty() {
            return said;
        }
        browser.point_at(5.0, 5.0);
        sleep(Duration::from_millis(200));
    }
    String::new()
}

#[test]
fn points_say_cell_interval_and_n_to_the_mouse_and_to_the_arrow_keys() {
    let made = tables(quickstart_cells(), 3, 24);
    let Some(Shown { browser, .. }) = show(&made, &about()) else {
        return;
    };
    assert_eq!(browser.text(TIP), "");
    let said = told_by_first_point(&browser, "#accuracy");
    let score = &made.summary[0].1;
    let interval = format!(
        "accuracy {:.3} [{:.3}, {:.3}] (95 %)",
        score.accuracy, score.accuracy_low, score.accuracy_high
    );
    for part in [
        "Cell 0: pitch 2 mm",
        "compression 4:1",
        &interval,
        "n = 600 test decisions, mean of 3 trials",
    ] {
        assert!(said.contains(part), "{part:?} in {said:?}");
    }
    browser.point_at(5.0, 5.0);
    assert_eq!(browser.text(TIP), "");
    // By keyboard, from the point that was asked last: along its line, then to the same place on the other line.
    browser.run("document.querySelector('#accuracy .panels svg').focus({ preventScroll: true })");
    for (key, cell) in [(ARROW_RIGHT, 1), (ARROW_RIGHT, 2), (ARROW_DOWN, 10)] {
        browser.press(key);
        let said = browser.text(SPOKEN);
        assert!(said.starts_with(&format!("Cell {cell}: ")), "{said}");
        assert!(browser.text(TIP).starts_with(&format!("Cell {cell}: ")));
    }
    browser.check_quiet();
}

#[test]
fn a_filter_leaves_what_is_chosen_in_the_table_and_in_the_chart() {
    let Some(Shown { browser, .. }) = show(&tables(quickstart_cells(), 3, 24), &about()) else {
        return;
    };
    let rows = "return document.querySelectorAll('#cells tbody tr').length";
    let markers =
        "return document.querySelectorAll('#accuracy .panels svg > path[transform]').length";
    assert_eq!((browser.count(rows), browser.count(markers)), (16, 16));
    for section in ["#cells", "#accuracy"] {
        browser.click(&format!("{section} summary"));
        browser.click(&format!(
            "{section} [aria-label='pitch'] .chip:nth-of-type(2)"
        ));
    }
    assert_eq!((browser.count(rows), browser.count(markers)), (8, 8));
    assert_eq!(
        browser.text("return document.querySelector('#cells .state').textContent"),
        "pitch 2 mm"
    );
    // The last value of an axis cannot be taken away: all come back.
    browser.click("#cells [aria-label='pitch'] .chip:nth-of-type(1)");
    assert_eq!(browser.count(rows), 16);
    // What stands along x, as lines and in panels can be exchanged, and every cell stays in the chart.
    browser.click("#accuracy .filter > .plain");
    for (role, name) in [
        (1, "m"),
        (2, "array size"),
        (1, "pitch"),
        (2, "compression"),
        (3, "none"),
    ] {
        browser.choose(
            &format!("#accuracy .controls label:nth-of-type({role}) select"),
            name,
        );
    }
    let shown = browser.count(markers);
    assert_eq!(
        shown, 8,
        "two pitches, four ratios, the array size of the best cell"
    );
    browser.check_quiet();
}

#[test]
fn the_table_of_cells_sorts_by_any_column() {
    let made = tables(quickstart_cells(), 3, 24);
    let Some(Shown { browser, .. }) = show(&made, &about()) else {
        return;
    };
    let column = "const heads = [...document.querySelectorAll('#cells th')];
         const n = heads.findIndex((h) => h.textContent.startsWith('accuracy'));
         return [...document.querySelectorAll('#cells tbody tr')].map((r) => r.cells[n].textContent.slice(0, 5))";
    let mut expected: Vec<String> = made
        .summary
        .iter()
        .map(|(_, score)| format!("{:.3}", score.accuracy))
        .collect();
    assert_eq!(browser.run(column), json!(expected));
    let head = "#cells th:nth-of-type(6) button";
    browser.click(head);
    expected.sort();
    expected.reverse();
    assert_eq!(browser.run(column), json!(expected), "most accurate first");
    let order =
        "return document.querySelector('#cells th:nth-of-type(6)').getAttribute('aria-sort')";
    assert_eq!(browser.text(order), "descending");
    browser.click(head);
    expected.reverse();
    assert_eq!(browser.run(column), json!(expected));
    assert_eq!(browser.text(order), "ascending");
    browser.check_quiet();
}

#[test]
fn the_confusion_matrix_sorts_and_is_read_by_keyboard() {
    let made = tables(quickstart_cells(), 3, 24);
    let Some(Shown { browser, .. }) = show(&made, &about()) else {
        return;
    };
    let diagonal = "return [...document.querySelectorAll('#confusion tbody tr')].map((r, i) => Number(r.cells[i + 1].textContent))";
    let counts = |value: serde_json::Value| -> Vec<u64> {
        let list = value.as_array().unwrap().iter();
        list.map(|v| v.as_u64().unwrap()).collect()
    };
    let hits = made
        .confusion
        .iter()
        .filter(|row| row.cell == 4 && row.object == row.predicted);
    let hits: Vec<u64> = hits.map(|row| row.count as u64).collect();
    assert_eq!(counts(browser.run(diagonal)), hits, "as in the study");
    browser.choose("#confusion select", "hardest first");
    let sorted = counts(browser.run(diagonal));
    assert!(sorted.is_sorted() && sorted[0] < sorted[23], "{sorted:?}");
    let rows =
        "return [...document.querySelectorAll('#confusion tbody th')].map((h) => h.textContent)";
    browser.choose("#confusion select", "by name");
    let names: Vec<String> = serde_json::from_value(browser.run(rows)).unwrap();
    assert_eq!(
        (names[0].as_str(), names[2].as_str()),
        ("adjustable wrench", "banana")
    );
    // Confused together: an object's neighbour is one that it is taken for.
    browser.choose("#confusion select", "confused together");
    let beside = "const rows = [...document.querySelectorAll('#confusion tbody tr')];
         return rows.filter((r, i) => i > 0 && (r.cells[i].textContent || rows[i - 1].cells[i + 1].textContent)).length";
    assert!(browser.count(beside) >= 16, "{}", browser.count(beside));
    // A row's name brings what it is confused with to the front, and stays in focus.
    browser.click("#confusion tbody tr:nth-of-type(5) button");
    let first = browser.text("return document.querySelector('#confusion tbody th').textContent");
    assert_eq!(
        browser.text("return document.activeElement.textContent"),
        first
    );
    browser.run("document.querySelector('#confusion td[tabindex=\"0\"]').focus()");
    assert!(
        browser
            .text(SPOKEN)
            .contains(&format!("{first}: recognised"))
    );
    browser.press(ARROW_RIGHT);
    assert!(
        browser
            .text(SPOKEN)
            .starts_with(&format!("{first} taken for "))
    );
    browser.check_quiet();
}

#[test]
fn the_page_advises_in_each_condition_what_the_library_advises() {
    let mut made = tables(noise_cells(), 3, 24);
    for (cell, row) in &mut made.pareto {
        row.predict_us_per_decision = 2.0 + 40.0 * row.accuracy + ((cell.cell * 7) % 5) as f64;
        row.fit_s = 0.01 + 0.001 * ((cell.cell * 11) % 13) as f64;
    }
    let Some(Shown { browser, .. }) = show(&made, &about()) else {
        return;
    };
    let offers = cell_offers(&made.pareto, &made.summary, &[]).unwrap();
    let conditions = by_condition(&offers);
    assert_eq!(conditions.len(), 5, "noises");
    let costs = [
        (Cost::DecisionTime, "time of a decision"),
        (Cost::TrainingTime, "time to train"),
        (Cost::Taxels, "taxels"),
        (Cost::Measurements, "measurements"),
    ];
    let mut n_advised = 0;
    for (cost, name) in costs {
        browser.choose("#pareto .advice select", name);
        // Just below the best of each condition: the noisier ones do not fulfil the wish of the others.
        for offers in &conditions {
            let best = offers
                .iter()
                .map(|offer| offer.accuracy)
                .fold(0.0, f64::max);
            let wish = (100.0 * best - 1.0).floor() / 100.0;
            browser.run(&format!(
                "const wish = document.querySelector('#pareto input'); wish.value = {wish}; wish.dispatchEvent(new Event('input'))"
            ));
            let advised = conditions.iter().map(|offers| {
                let advice = advise(offers, Wish::Accuracy(wish), cost);
                advice.map_or(String::new(), |advice| {
                    advice.choice.cell.unwrap().to_string()
                })
            });
            let advised: Vec<String> = advised.collect();
            n_advised += advised.iter().filter(|cell| !cell.is_empty()).count();
            let on_page =
                browser.text("return document.querySelector('#pareto .advice').dataset.cell");
            assert_eq!(on_page, advised.join(","), "{name}, {wish}");
        }
    }
    assert!(n_advised > 20 && n_advised < 100, "{n_advised}");
    let words = browser.text("return document.querySelector('#pareto .advice').innerText");
    assert!(words.contains("With noise 20 %:"), "{words}");
    browser.check_quiet();
}

#[test]
fn tables_on_a_phone_show_that_they_scroll_and_the_page_does_not() {
    let Some(Shown { browser, .. }) = show(&tables(noise_cells(), 3, 24), &about()) else {
        return;
    };
    browser.resize(390, 844);
    let wide = browser.count("return document.documentElement.scrollWidth");
    assert_eq!(wide, browser.count("return innerWidth"));
    let shaded = "return [...document.querySelectorAll('.wide')].filter((box) => box.scrollWidth > box.clientWidth + 1)
        .map((box) => getComputedStyle(box)).map((style) => [style.backgroundImage.split('linear-gradient').length - 1, style.backgroundAttachment])";
    let shaded = browser.run(shaded);
    let shaded = shaded.as_array().unwrap();
    assert!(shaded.len() > 1, "{shaded:?}");
    for box_ in shaded {
        assert_eq!(box_[0], 4, "two covers and two shadows");
        assert_eq!(box_[1], "local, local, scroll, scroll, scroll");
    }
    browser.check_quiet();
}

#[test]
fn the_front_is_what_no_cell_beats_and_the_advice_lies_on_it() {
    let mut made = tables(quickstart_cells(), 3, 24);
    for (cell, row) in &mut made.pareto {
        row.predict_us_per_decision = 2.0 + 40.0 * row.accuracy + ((cell.cell * 7) % 5) as f64;
    }
    let Some(Shown { browser, .. }) = show(&made, &about()) else {
        return;
    };
    let beaten = |i: usize| {
        // A page holds four decimals of an accuracy and four digits of a time: what differs by less is equal.
        let cost = |j: usize| {
            let accuracy = (made.summary[j].1.accuracy * 1e4).round();
            let time = format!("{:.3e}", made.pareto[j].1.predict_us_per_decision);
            (time.parse::<f64>().unwrap(), accuracy)
        };
        let ((time, accuracy), all) = (cost(i), 0..made.pareto.len());
        all.map(cost)
            .any(|(t, a)| t <= time && a >= accuracy && (t < time || a > accuracy))
    };
    let mut front: Vec<usize> = (0..16).filter(|&i| !beaten(i)).collect();
    front.sort_by(|&a, &b| {
        made.summary[a]
            .1
            .accuracy
            .total_cmp(&made.summary[b].1.accuracy)
    });
    let words: Vec<String> = front.iter().map(usize::to_string).collect();
    let drawn = "return document.querySelector('#pareto svg .front[data-cells]').dataset.cells";
    assert_eq!(browser.text(drawn), words.join(","));
    assert!(front.len() > 2 && front.len() < 16);
    // A wish between two cells of the front is fulfilled by the upper.
    let wish = 0.5 * (made.summary[front[0]].1.accuracy + made.summary[front[1]].1.accuracy);
    browser.run(&format!(
        "const wish = document.querySelector('#pareto input'); wish.value = {wish}; wish.dispatchEvent(new Event('input'))"
    ));
    let advised = "return document.querySelector('#pareto .advice').dataset.cell";
    assert_eq!(browser.text(advised), words[1]);
    assert!(told_by_first_point(&browser, "#pareto").contains("a decision"));
    browser.check_quiet();
}
