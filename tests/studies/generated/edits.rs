//! Law: `verify` and `compare` notice any edit of the results.

use super::folders::{n_folders, swept, tables};
use super::generator::Generator;
use crate::command::Case;
use rand::Rng;
use rand::seq::SliceRandom;
use std::fs;

/// Number of edits per study.
const N_EDITS: usize = 8;

/// Edits a table: an entry is changed or deleted, or a row is deleted or repeated. Returns a description of the edit, or `None` if the table has no row.
fn edited(csv: &[u8], generator: &mut Generator) -> Option<(String, Vec<u8>)> {
    let mut reader = csv::Reader::from_reader(csv);
    let head = reader.headers().unwrap().clone();
    let rows = reader
        .records()
        .map(|row| row.unwrap().iter().map(str::to_owned).collect());
    let mut rows: Vec<Vec<String>> = rows.collect();
    let rng = &mut generator.rng;
    let row = rng.gen_range(0..rows.len().max(1));
    let column = rng.gen_range(0..head.len());
    let entry = rows.get(row)?[column].clone();
    let what = match rng.gen_range(0..8) {
        0 if rows.len() > 1 => {
            rows.remove(row);
            "the row was deleted".to_owned()
        }
        1 => {
            rows.insert(row, rows[row].clone());
            "the row was repeated".to_owned()
        }
        kind => {
            let others = rows.iter().map(|row| row[column].clone());
            let others: Vec<String> = others.filter(|other| *other != entry).collect();
            let other = others.choose(rng).cloned();
            let value = match (kind, entry.parse::<i64>(), entry.parse::<f64>()) {
                (2, ..) if !entry.is_empty() => String::new(),
                (3, ..) if other.is_some() => other.unwrap_or_default(),
                (_, Ok(number), _) => (number + 1).to_string(),
                (4 | 5, _, Ok(number)) => (number + 1e-9 * number.abs().max(1.0)).to_string(),
                (.., Ok(number)) => (number + 1.0).to_string(),
                // A number replaces a number, and a word replaces a word.
                _ => match other {
                    Some(other) => other,
                    None => "7".to_owned(),
                },
            };
            rows[row][column] = value.clone();
            format!("{entry:?} became {value:?}")
        }
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&head).unwrap();
    for row in rows {
        writer.write_record(row).unwrap();
    }
    let what = format!("row {row}, {}: {what}", &head[column]);
    Some((what, writer.into_inner().unwrap()))
}

/// Edits the tables of studies several times, and checks that a command reports each edit.
fn check(law: &str, with_times: bool, is_noticed: impl Fn(&Case, &str) -> Result<(), String>) {
    for number in 0..n_folders() {
        let case = Case::new();
        let mut generator = Generator::new(law, number);
        let (study, ..) = swept(&case, &mut generator);
        fs::rename(case.path("fresh"), case.path("results")).unwrap();
        case.succeeds("run study.toml --out other");
        let mut files = tables(&case, "results");
        if with_times {
            for name in ["timing.csv", "pareto.csv", "stages.csv"] {
                let content = fs::read(case.path("results").join(name)).unwrap();
                // The folder is compared with itself, because times differ between runs.
                fs::write(case.path("other").join(name), &content).unwrap();
                files.insert(name.to_owned(), content);
            }
        }
        let files: Vec<(&String, &Vec<u8>)> = files.iter().collect();
        for _ in 0..N_EDITS {
            let (name, content) = files.choose(&mut generator.rng).copied().unwrap();
            let Some((what, changed)) = edited(content, &mut generator) else {
                continue;
            };
            if changed == *content {
                continue;
            }
            let path = format!("results/{name}");
            case.file(&path, changed);
            if let Err(said) = is_noticed(&case, name) {
                panic!("{name}, {what}: {said}\n{}", study.text());
            }
            case.file(&path, content);
        }
    }
}

#[test]
fn an_edited_table_is_noticed_by_verify() {
    check("edited tables", true, |case, name| {
        let verified = case.run("verify results --configurations 1");
        let error = String::from_utf8_lossy(&verified.stderr).into_owned();
        match !verified.status.success() && error.contains(name) {
            true => Ok(()),
            false => Err(error),
        }
    });
}

#[test]
fn an_edited_table_is_noticed_by_compare() {
    check("compared tables", true, |case, name| {
        let compared = |first: &str, second: &str| {
            let output = case.run(&["compare", first, second]);
            let said = String::from_utf8(output.stdout).unwrap();
            let error = String::from_utf8(output.stderr).unwrap();
            (output.status.success(), said.replace('\n', " ") + &error)
        };
        let (is_same, same) = compared("other", "other");
        assert!(is_same, "{same}");
        for (first, second) in [("other", "results"), ("results", "other")] {
            let (is_read, said) = compared(first, second);
            let names = said.replace(first, "other").replace(second, "other");
            // An unreadable table is refused by its name.
            if !said.contains(name) || is_read && names == same {
                return Err(said);
            }
        }
        Ok(())
    });
}
