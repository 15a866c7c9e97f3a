//! The page of a small study of each kind.

use crate::browser::Browser;
use crate::kinds::Kind;
use serde_json::Value;

/// Sorts a table by each of its columns, twice, and searches it for its first cell; returns the rows that are shown each time.
const TRIED: &str = r#"
    const tried = (table) => {
        const shown = () => [...table.tBodies[0].rows].filter((row) => !row.hidden).map((row) => Number(row.dataset.row));
        const all = shown();
        const sorts = [...table.querySelectorAll("th")].map((head) => {
            const turn = () => { head.querySelector("button").click(); return [head.getAttribute("aria-sort"), shown()]; };
            return { column: head.title, isNumber: !head.classList.contains("word"), turns: [turn(), turn()] };
        });
        const below = table.parentNode.nextElementSibling;
        const search = below.querySelector("input");
        const find = (text) => {
            search.value = text;
            search.dispatchEvent(new Event("input"));
            return [shown().length, below.querySelector("[role=status]").textContent];
        };
        const words = table.tBodies[0].rows[0].textContent.slice(0, 12);
        return { file: table.dataset.table, n: all.length, sorts, found: find(words), none: find("no cell has this"), again: find("") };
    };
    return [...document.querySelectorAll("table[data-table]")].map(tried);
"#;

#[test]
fn the_tables_of_each_kind_of_study_sort_and_can_be_searched() {
    let Some(browser) = Browser::start() else {
        return;
    };
    for kind in Kind::ALL {
        let case = kind.case();
        case.succeeds(&["run", "study.toml", "--out", "found", "--quiet"]);
        browser.open(&case.path("found/report.html"));
        let tried = browser.run(TRIED);
        let mut n_sorted = 0;
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
            let said = |n_shown| serde_json::json!([n_shown, format!("{n_shown} of {n} rows")]);
            assert!(table["found"][0].as_u64() > Some(0), "{file}");
            assert_eq!(
                (&table["none"], &table["again"]),
                (&said(0), &said(n)),
                "{file}"
            );
        }
        assert!(n_sorted > 8, "{}", kind.study);
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
