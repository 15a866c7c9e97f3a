//! The page of a recognition study in a browser: its reactions to mouse and keyboard.

use crate::browser::{ARROW_RIGHT, Browser};
use crate::command::says;
use crate::report_synthetic::{about, noise_cells, quickstart_cells, tables};
use crate::shown::{Shown, html, show};
use bubbletouch::report::advice::{AdviceQuery, Candidates};
use bubbletouch::studies::recognition::charts::tables_of;
use std::thread::sleep;
use std::time::Duration;

const TIP: &str =
    "return document.querySelector('.tip').hidden ? '' : document.querySelector('.tip').innerText";
const SPOKEN: &str = "return document.querySelector('[aria-live]').textContent";

/// Scrolls to the point of a row and returns its position in the window.
fn point(browser: &Browser, chart: &str, row: usize) -> (f64, f64) {
    let place = browser.run(&format!(
        "document.querySelector('{chart}').scrollIntoView({{ block: 'center', behavior: 'instant' }});
         const box = document.querySelector('{chart} [data-row=\"{row}\"]').getBoundingClientRect();
         return [box.left + box.width / 2, box.top + box.height / 2]"
    ));
    (place[0].as_f64().unwrap(), place[1].as_f64().unwrap())
}

/// Returns the tooltip of a point under the mouse. (On a busy machine, a browser may still lay out its page when the mouse arrives.)
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
    let chart = "figure.chart";
    let said = told(&browser, chart, 0);
    says(
        &said,
        &[
            "pitch 2 mm",
            "compression 4:1",
            "m = 256",
            "accuracy 0.",
            "time of a decision",
        ],
    );
    browser.point_at(5.0, 5.0);
    assert_eq!(browser.text(TIP), "");
    browser.run("document.querySelector('.chart svg').focus({ preventScroll: true })");
    browser.press(ARROW_RIGHT);
    assert!(
        browser.text(SPOKEN).contains("compression 16:1"),
        "{}",
        browser.text(SPOKEN)
    );
    browser.check_quiet();
}

#[test]
fn what_was_taken_for_what_is_read_by_keyboard() {
    let made = tables(quickstart_cells(), 3, 24);
    let Some(Shown { browser, .. }) = show(&made, &about()) else {
        return;
    };
    let tiles = "return document.querySelectorAll('.tiles [data-row]').length";
    let of_cell = |configuration: usize| {
        made.confusion
            .iter()
            .filter(|row| row.configuration == configuration)
            .count() as u64
    };
    assert_eq!(
        browser.count(tiles),
        of_cell(4),
        "of the best configuration"
    );
    browser.run("document.querySelector('.tiles svg').focus({ preventScroll: true })");
    browser.press(ARROW_RIGHT);
    let said = browser.text(SPOKEN);
    says(&said, &["soup can", "test rows"]);
    browser.check_quiet();
}

#[test]
fn the_page_lists_the_front_of_each_condition() {
    let mut made = tables(noise_cells(), 3, 24);
    for (configuration, row) in &mut made.pareto {
        row.predict_us_per_decision =
            2.0 + 40.0 * row.accuracy + ((configuration.configuration * 7) % 5) as f64;
        row.fit_s = 0.01 + 0.001 * ((configuration.configuration * 11) % 13) as f64;
    }
    let page = html(&made, &about());
    let (_, choices) = page.split_once("<section id=\"choices\"").unwrap();
    let (choices, _) = choices.split_once("</section>").unwrap();
    let tables = tables_of(&made).unwrap();
    let offers = Candidates::new(&tables, &AdviceQuery::default()).unwrap();
    let conditions = offers.by_condition();
    assert_eq!(conditions.len(), 5, "noises");
    let (_, front) = choices
        .split_once("Pareto front of each condition")
        .unwrap();
    let (front, _) = front.split_once("</table>").unwrap();
    let listed: Vec<&str> = front
        .lines()
        .filter(|row| row.starts_with("<tr data-row"))
        .collect();
    let wanted: Vec<_> = conditions
        .iter()
        .flat_map(|of_one| offers.front(of_one))
        .collect();
    assert_eq!(listed.len(), wanted.len());
    for (row, offer) in listed.iter().zip(&wanted) {
        let cost = offers.cost.number_words(offer.cost);
        assert!(row.contains(&cost), "{cost}: {row}");
        let noise = offers.table.words("noise_std", offer.row);
        assert!(row.contains(&noise), "{noise}: {row}");
    }
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
