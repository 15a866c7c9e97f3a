//! The page of a small study of each kind.

use crate::browser::Browser;
use crate::kinds::Kind;
use serde_json::Value;

/// Sorts a table by each of its columns, once and again, and shuts out the first value of each column that filters; gives the rows
/// that are shown each time.
const TRIED: &str = r#"
    const table = (host) => {
        const shown = () => [...host.querySelectorAll("tbody tr")].map((row) => Number(row.dataset.row));
        const all = shown();
        const sorts = [...host.querySelectorAll("th")].map((head) => {
            const turn = () => { head.querySelector("button").click(); return [head.getAttribute("aria-sort"), shown()]; };
            return { column: head.querySelector("button").title, isNumber: !head.classList.contains("word"), turns: [turn(), turn()] };
        });
        const filter = host.querySelector(".filter");
        filter.open = true;
        filter.dispatchEvent(new Event("toggle"));
        const groups = [...host.querySelectorAll(".chip-group[role=group]")].map((group) => group.getAttribute("aria-label"));
        const filters = groups.map((name) => {
            const chip = () => [...host.querySelectorAll(".chip-group[role=group]")].find((group) => group.getAttribute("aria-label") === name).querySelector(".chip");
            chip().click();
            const without = [shown().length, host.querySelector(".state").textContent];
            host.querySelector(".plain").click();
            return { name, without, again: [shown().length, host.querySelector(".state").textContent] };
        });
        return { file: host.dataset.table, n: all.length, sorts, filters };
    };
    return [...document.querySelectorAll("[data-table]")].map(table);
"#;

#[test]
fn the_tables_of_each_kind_of_study_sort_and_filter() {
    let Some(browser) = Browser::start() else {
        return;
    };
    for kind in Kind::ALL {
        let case = kind.case();
        case.succeeds(&["run", "study.toml", "--out", "found", "--quiet"]);
        browser.open(&case.path("found/report.html"));
        let tried = browser.run(TRIED);
        let (mut n_sorted, mut n_filtered) = (0, 0);
        for table in tried.as_array().unwrap() {
            let file = table["file"].as_str().unwrap();
            // A table that is made of others has no file.
            let path = case.path(&format!("found/{file}"));
            let rows = path.exists().then(|| csv_rows(&path));
            for sort in table["sorts"].as_array().unwrap() {
                check_sorted(file, sort, rows.as_deref());
                n_sorted += 1;
            }
            let n = table["n"].as_u64().unwrap();
            for filter in table["filters"].as_array().unwrap() {
                let (without, again) = (&filter["without"], &filter["again"]);
                let n_without = without[0].as_u64().unwrap();
                assert!(0 < n_without && n_without <= n, "{file}: {filter}");
                assert!(n_without < n || n == 50, "{file}: {filter}");
                assert!(without[1] != "all rows", "{file}: {filter}");
                assert_eq!(*again, serde_json::json!([n, "all rows"]), "{file}");
                n_filtered += 1;
            }
        }
        assert!(n_sorted > 8 && n_filtered > 0, "{}", kind.study);
        browser.check_quiet();
    }
}

/// Rows by the names of their columns.
fn csv_rows(path: &std::path::Path) -> Vec<std::collections::HashMap<String, String>> {
    let rows = csv::Reader::from_path(path).unwrap().into_deserialize();
    rows.map(Result::unwrap).collect()
}

/// Up in one turn and down in the other, and rows without a number last in both.
fn check_sorted(
    file: &str,
    sort: &Value,
    rows: Option<&[std::collections::HashMap<String, String>]>,
) {
    let column = sort["column"].as_str().unwrap();
    let turns = sort["turns"].as_array().unwrap();
    let mut orders: Vec<&str> = turns.iter().map(|turn| turn[0].as_str().unwrap()).collect();
    orders.sort_unstable();
    assert_eq!(orders, ["ascending", "descending"], "{file}, {column}");
    let (true, Some(rows)) = (sort["isNumber"] == true, rows) else {
        return;
    };
    for turn in turns {
        let shown = turn[1].as_array().unwrap().iter();
        let numbers = shown.map(|row| {
            let text = &rows[row.as_u64().unwrap() as usize][column];
            text.parse::<f64>().unwrap_or(f64::NAN)
        });
        let numbers: Vec<f64> = numbers.collect();
        let is_up = turn[0] == "ascending";
        for pair in numbers.windows(2) {
            let (a, b) = if is_up {
                (pair[0], pair[1])
            } else {
                (pair[1], pair[0])
            };
            let is_in_order = a <= b || pair[1].is_nan();
            assert!(is_in_order, "{file}, {column}: {numbers:?}");
        }
    }
}
