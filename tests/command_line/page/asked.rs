//! The page of a study of recognition in a browser: what it answers to the mouse and to the keyboard.

use crate::browser::shown::{Shown, show};
use crate::browser::{ARROW_RIGHT, Browser};
use crate::report_synthetic::{about, noise_cells, quickstart_cells, tables};
use bubbletouch::report::advice::{Asked, Offers, Wish};
use bubbletouch::report::recognition::{CELLS, tables_of};
use std::thread::sleep;
use std::time::Duration;

const TIP: &str =
    "return document.querySelector('.tip').hidden ? '' : document.querySelector('.tip').innerText";
const SPOKEN: &str = "return document.querySelector('[aria-live]').textContent";

/// Where the point of a row stands in the window, after scrolling there.
fn point(browser: &Browser, chart: &str, row: usize) -> (f64, f64) {
    let place = browser.run(&format!(
        "document.querySelector('{chart} .panels').scrollIntoView({{ block: 'center', behavior: 'instant' }});
         const box = document.querySelector('{chart} .panels [data-row=\"{row}\"]').getBoundingClientRect();
         return [box.left + box.width / 2, box.top + box.height / 2]"
    ));
    (place[0].as_f64().unwrap(), place[1].as_f64().unwrap())
}

/// What a point tells the mouse. (A browser beside many others may still lay out its page when the mouse first comes.)
fn told(browser: &Browser, chart: &str, row: usize) -> String {
    for _ in 0..20 {
        let (x, y) = point(browser, chart, row);
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
fn points_say_setting_interval_and_cost_to_the_mouse_and_to_the_arrow_keys() {
    let made = tables(quickstart_cells(), 3, 24);
    let Some(Shown { browser, .. }) = show(&made, &about()) else {
        return;
    };
    assert_eq!(browser.text(TIP), "");
    let chart = "[data-chart=\"0\"]";
    let said = told(&browser, chart, 0);
    for part in [
        "pitch 2 mm",
        "compression 4:1",
        "m = 256",
        "accuracy 0.",
        "time of a decision",
    ] {
        assert!(said.contains(part), "{part:?} in {said:?}");
    }
    browser.point_at(5.0, 5.0);
    assert_eq!(browser.text(TIP), "");
    browser.run(
        "document.querySelector('[data-chart=\"0\"] .panels svg').focus({ preventScroll: true })",
    );
    browser.press(ARROW_RIGHT);
    assert!(
        browser.text(SPOKEN).contains("compression 16:1"),
        "{}",
        browser.text(SPOKEN)
    );
    browser.check_quiet();
}

#[test]
fn what_was_taken_for_what_is_read_by_keyboard_and_for_any_cell() {
    let made = tables(quickstart_cells(), 3, 24);
    let Some(Shown { browser, .. }) = show(&made, &about()) else {
        return;
    };
    let confusion = browser.count("return [...document.querySelectorAll('h3')].find((h) => h.id === 'chart-confusion').parentNode ? [...document.querySelectorAll('#charts h3')].findIndex((h) => h.id === 'chart-confusion') : 0");
    let host = format!("[data-chart=\"{confusion}\"]");
    browser.run(&format!(
        "document.querySelector('{host}').scrollIntoView()"
    ));
    sleep(Duration::from_millis(300));
    let tiles = format!("return document.querySelectorAll('{host} .tile').length");
    let of_cell = |cell: usize| made.confusion.iter().filter(|row| row.cell == cell).count() as u64;
    assert_eq!(browser.count(&tiles), of_cell(4), "of the best cell");
    browser.run(&format!(
        "document.querySelector('{host} .panels svg').focus({{ preventScroll: true }})"
    ));
    browser.press(ARROW_RIGHT);
    let said = browser.text(SPOKEN);
    assert!(
        said.contains("soup can") && said.contains("test rows"),
        "{said}"
    );
    browser.click(&format!("{host} summary"));
    browser.click(&format!("{host} [aria-label='cell'] .chip:nth-of-type(5)"));
    browser.click(&format!("{host} [aria-label='cell'] .chip:nth-of-type(1)"));
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
    let tables = tables_of(&made).unwrap();
    let cells = tables.iter().find(|table| table.file == CELLS).unwrap();
    let costs = [
        ("decision_time", "time of a decision"),
        ("training_time", "time to train"),
    ];
    let mut n_advised = 0;
    for (cost, name) in costs {
        browser.choose("#choices label:nth-of-type(3) select", name);
        let asked = Asked {
            cost: Some(cost.to_owned()),
            ..Asked::default()
        };
        let offers = Offers::of(&tables, &asked).unwrap();
        let conditions = offers.by_condition();
        assert_eq!(conditions.len(), 5, "noises");
        // Just below the best of each condition: the noisier ones do not fulfil the wish of the others.
        for choices in &conditions {
            let best = choices.iter().map(|offer| offer.value).fold(0.0, f64::max);
            let wish = (100.0 * best - 1.0).floor() / 100.0;
            browser.run(&format!(
                "const wish = document.querySelector('#choices input'); wish.value = {wish}; wish.dispatchEvent(new Event('input'))"
            ));
            let advised = conditions.iter().map(|choices| {
                let advice = offers.advise(choices, Wish::Value(wish));
                advice.map_or(String::new(), |advice| {
                    cells.number("cell", advice.choice.row).to_string()
                })
            });
            let advised: Vec<String> = advised.collect();
            n_advised += advised.iter().filter(|cell| !cell.is_empty()).count();
            let on_page =
                browser.text("return document.querySelector('#choices .advice').dataset.rows");
            assert_eq!(on_page, advised.join(","), "{name}, {wish}");
        }
    }
    assert!(n_advised > 10 && n_advised < 50, "{n_advised}");
    let words = browser.text("return document.querySelector('#choices .advice').innerText");
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
