//! Laws of every kind of study, checked on the results of one small study per kind.

use crate::browser::Browser;
use crate::command::{Case, says};
use crate::faults::{said, sha256};
use crate::kinds::Kind;
use crate::pieces::{Faults, planned};
use bubbletouch::kinds::read_tables;
use bubbletouch::table::{Better, Role, Table};
use serde_json::Value;
use std::collections::HashMap;
use std::fs;

/// Checks all laws for a kind of study.
fn obeys_all_laws(kind: &str) {
    let whole = Faults::new(Kind::named(kind));
    let case = &whole.case;
    whole.has_the_work_items_that_its_plan_counts();
    whole.has_the_same_tables_in_shards_at_any_number_of_threads();
    whole.has_a_resolved_study_that_runs_from_any_folder();
    is_advised(case, &whole.kind.choices);
    whole.is_compared_with_a_changed_study();
    has_tables_that_sort_and_can_be_searched(case);
    whole.is_verified_until_a_number_is_changed();
}

macro_rules! every_kind {
    ($($name:ident: $kind:literal;)*) => {
        $(#[test]
        fn $name() {
            obeys_all_laws($kind);
        })*
    };
}

every_kind! {
    a_study_of_recognition_obeys_all_laws: "recognition";
    a_study_with_axes_of_its_own_obeys_all_laws: "axes";
    a_study_of_reconstruction_obeys_all_laws: "reconstruction";
    a_study_of_object_detail_obeys_all_laws: "object_detail";
    a_study_of_a_whole_body_obeys_all_laws: "whole_body";
    a_study_of_stability_obeys_all_laws: "stability";
    a_study_with_test_touches_of_their_own_obeys_all_laws: "test_touches";
}

#[test]
fn sensor_errors_choices_and_touches_over_time_give_the_same_tables_in_shards_at_any_number_of_threads()
 {
    for kind in ["errors", "choices", "human"] {
        Faults::new(Kind::named(kind)).has_the_same_tables_in_shards_at_any_number_of_threads();
    }
}

impl Faults {
    fn has_the_work_items_that_its_plan_counts(&self) {
        let plan = ["plan", "study.toml", "--threads", "1"];
        let (said, error) = self.case.succeeds(&plan);
        assert!(
            said.starts_with("study: ") && error.is_empty(),
            "{said}{error}"
        );
        assert!(!self.case.path("results").exists(), "a plan writes nothing");
        for word in ["objects", "touches", "memory"] {
            assert!(!planned(&said, word).is_empty(), "{said}");
        }
        let memory = planned(&said, "memory").join(" ");
        assert!(memory.ends_with("on 1 thread"), "{said}");
        let n_items = format!("{},", self.n_pieces());
        assert_eq!(planned(&said, "items")[0], n_items, "{said}");
    }

    /// Compares three shards at 1, 2 and 7 threads, merged, with one run at all threads.
    fn has_the_same_tables_in_shards_at_any_number_of_threads(&self) {
        for (shard, threads) in [("2/3", "1"), ("1/3", "2"), ("3/3", "7")] {
            self.case.refuses("merge study.toml --out parts");
            let run = format!("run study.toml --out parts --shard {shard}");
            self.case.succeeds(&format!("{run} --threads {threads}"));
        }
        self.case.succeeds("merge study.toml --out parts");
        self.assert_same_tables("parts");
    }

    /// Runs a copy of the resolved study, whose paths are absolute, in another folder.
    fn has_a_resolved_study_that_runs_from_any_folder(&self) {
        let [whole, far] = ["whole/study.toml", "far/study.toml"].map(|file| self.case.path(file));
        fs::create_dir(self.case.path("far")).unwrap();
        fs::copy(whole, far).unwrap();
        let run = ["run", "study.toml", "--out", "../from_far"];
        let mut command = self.case.command(&run);
        let output = command.current_dir(self.case.path("far")).output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
        self.assert_same_tables("from_far");
    }

    /// Compares a folder with itself, and with the folder of a changed study.
    fn is_compared_with_a_changed_study(&self) {
        let [old, new, _] = self.kind.change.each_ref().map(String::as_str);
        let (old, new) = match old {
            // The number of touches stays the same, because it is a setting.
            "per_object = 24" => ("[0.0, 360.0]", "[0.0, 90.0]"),
            old => (old, new),
        };
        let case = &self.case;
        assert!(self.kind.study.contains(old));
        case.file("changed.toml", self.kind.study.replacen(old, new, 1));
        case.succeeds("run changed.toml --out changed");
        let (said, same) = compared(case, ["whole", "whole"]);
        assert!(!same.is_empty() && said.contains("rows of both"), "{said}");
        let is_same = |row: &DifferenceRow| row.difference == 0.0 && row.significance == "same";
        assert!(same.iter().all(is_same));
        let (said, moved) = compared(case, ["whole", "changed"]);
        let (_, tables) = read_tables(&case.path("changed")).unwrap();
        let mut columns: Vec<(&str, &str)> = Vec::new();
        for row in &moved {
            let table = tables.iter().find(|table| table.file == row.table).unwrap();
            if row.n_trials == 1 {
                let value = table.number(&row.column, row.row);
                assert_eq!(row.second, value, "{}: {}", row.table, row.column);
            }
            let column = (&row.table[..], &row.column[..]);
            if !columns.contains(&column) {
                columns.push(column);
            }
        }
        // Values and costs are compared separately.
        assert!(columns.len() > 1, "{columns:?}");
        says(&said, &["Columns that differ"]);
        let page = case.read("moved.html");
        assert!(page.contains("in both runs") && page.contains("Costs of both runs"));
    }

    fn is_verified_until_a_number_is_changed(&self) {
        let n = self.n_pieces();
        let few = n.min(5);
        let verify = format!("verify whole --configurations {few}");
        let (output, _) = self.case.succeeds(&verify);
        let expected = format!("{few} of {n} work items ran again");
        says(&output, &[&expected]);
        let path = self.case.path("whole").join(&self.kind.repeatable[0]);
        let manifest = self.case.path("whole/manifest.json");
        let text = fs::read_to_string(&path).unwrap();
        let changed = text.replacen(['1', '2', '3'], "4", 60);
        fs::write(&path, &changed).unwrap();
        let all = ["verify", "whole", "--configurations", &n.to_string()];
        let error = self.case.refuses(&all);
        says(&error, &["was changed after its run"]);
        // If the manifest was changed too, only a second computation of the work items detects the edit.
        let written = fs::read_to_string(&manifest).unwrap();
        let [before, after] = [&text, &changed].map(|text| sha256(text.as_bytes()));
        fs::write(&manifest, written.replace(&before, &after)).unwrap();
        let error = self.case.refuses(&all);
        says(&error, &["again it is"]);
    }
}

fn advice(case: &Case, arguments: &[&str]) -> Value {
    let (said, _) = case.succeeds(&[&["advise", "whole", "--json"], arguments].concat());
    serde_json::from_str(&said).unwrap()
}

/// Asserts that `advise` finds the choices by the roles of the columns; returns the best choice under each condition.
fn is_advised(case: &Case, choices: &[String; 3]) {
    let [file, value, cost] = choices.each_ref().map(String::as_str);
    let columns = ["--value", value, "--cost", cost];
    let all = advice(case, &[&columns[..], &["--budget", "1e12"]].concat());
    assert_eq!([&all["table"], &all["value"]], [file, value]);
    let cost_column = all["cost"].as_str().unwrap().to_owned();
    let (_, tables) = read_tables(&case.path("whole")).unwrap();
    let table = tables.iter().find(|table| table.file == file).unwrap();
    let best = best_of_each_condition(table, value);
    let answers = all["answers"].as_array().unwrap();
    assert_eq!(answers.len(), best.len(), "{file}: {all}");
    for (place, (answer, best)) in answers.iter().zip(&best).enumerate() {
        let choice = &answer["choice"];
        assert_eq!(choice[value].as_f64(), Some(*best), "{file}");
        assert!(answer["next_up"].is_null(), "{file}");
        // A requirement of the best value leads to an equally good choice that costs no more.
        let reach = best.to_string();
        let again = advice(case, &[&columns[..], &["--reach", &reach]].concat());
        let again = &again["answers"][place]["choice"];
        assert_eq!(again[value], choice[value], "{file}");
        assert_eq!(again[&cost_column], choice[&cost_column]);
    }
    let colour = ["advise", "whole", "--budget", "1", "--cost", "colour"];
    let error = case.refuses(&colour);
    says(&error, &["--cost: colour; one of"]);
    if best.len() > 1 {
        let worst = [&columns[..], &["--budget", "1e12", "--worst"]].concat();
        let worst = advice(case, &worst);
        assert_eq!(worst["answers"].as_array().unwrap().len(), 1, "{file}");
    }
}

/// Returns the best values in the order in which conditions first occur.
fn best_of_each_condition(table: &Table, value: &str) -> Vec<f64> {
    let (column, _) = table.column(value).unwrap();
    let wants_less = column.role == Role::Value(Better::Less);
    let conditions = table.groups(&table.of_role(Role::Condition), 0..table.n_rows);
    let best = |rows: &Vec<usize>| {
        let values = rows.iter().map(|&row| table.number(value, row));
        values
            .filter(|value| value.is_finite())
            .reduce(|a, b| if wants_less { a.min(b) } else { a.max(b) })
    };
    conditions.iter().filter_map(best).collect()
}

/// Row of the table that `compare` writes.
#[derive(serde::Deserialize)]
struct DifferenceRow {
    table: String,
    column: String,
    row: usize,
    n_trials: usize,
    second: f64,
    difference: f64,
    significance: String,
}

fn compared(case: &Case, [first, second]: [&str; 2]) -> (String, Vec<DifferenceRow>) {
    let files = ["--out", "moved.csv", "--html", "moved.html"];
    let (said, _) = case.succeeds(&[&["compare", first, second], &files[..]].concat());
    (said, case.rows("moved.csv"))
}

/// Script that sorts a table by each of its columns, twice, and searches it for its first cell; returns the shown rows each time.
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

/// Sorts and searches tables in a browser; does nothing if no browser is installed.
fn has_tables_that_sort_and_can_be_searched(case: &Case) {
    let Some(browser) = Browser::start() else {
        return;
    };
    browser.open(&case.path("whole/report.html"));
    let tried = browser.run(TRIED);
    let mut n_sorted = 0;
    for table in tried.as_array().unwrap() {
        let file = table["file"].as_str().unwrap();
        // A table derived from others has no file.
        let path = format!("whole/{file}");
        let rows = case.path(&path).exists().then(|| case.rows(&path));
        for sort in table["sorts"].as_array().unwrap() {
            check_sorted(file, sort, rows.as_deref());
            n_sorted += 1;
        }
        let n = table["n"].as_u64().unwrap();
        let said = |n_shown| serde_json::json!([n_shown, format!("{n_shown} of {n} rows")]);
        assert!(table["found"][0].as_u64() > Some(0), "{file}");
        let found = (&table["none"], &table["again"]);
        assert_eq!(found, (&said(0), &said(n)), "{file}");
    }
    assert!(n_sorted > 8, "{n_sorted}");
    browser.check_quiet();
}

/// Row of a CSV file by column names.
type Row = HashMap<String, String>;

/// Asserts that rows are sorted in ascending and in descending order, with rows without a number last in both cases.
fn check_sorted(file: &str, sort: &Value, rows: Option<&[Row]>) {
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
            let is_in_order = match is_up {
                true => pair[0] <= pair[1],
                false => pair[1] <= pair[0],
            };
            let is_right = is_in_order || pair[1].is_nan();
            assert!(is_right, "{file}, {column}: {numbers:?}");
        }
    }
}
