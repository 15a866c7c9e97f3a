//! Numbers that the README and the guide print from result tables equal the tables.
//!
//! A comment after the text names the cells: `<!-- FILE [where KEY=VALUE and …]: SHOWN = VALUE; … -->`. `FILE` is a CSV file, `SHOWN` the number as the text
//! prints it. `VALUE` is `[min|max|median|count] [COLUMN] [where …]`, a number, or a quotient `VALUE / VALUE`. `SHOWN < VALUE` states a bound.
//! Conditions compare with `=`, `<` or `>=`. Without `min`, `max`, `median` or `count`, exactly one row meets all conditions.
#![cfg(unix)]

use super::readme::documents;
use std::path::Path;

type Row = std::collections::BTreeMap<String, String>;

fn table(file: &str) -> Result<Vec<Row>, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let reader = csv::Reader::from_path(path).map_err(|error| error.to_string())?;
    let rows: Result<_, _> = reader.into_deserialize().collect();
    rows.map_err(|error| error.to_string())
}

/// Returns whether a row meets a condition such as `noise_std=0.1`.
fn meets(row: &Row, condition: &str) -> Result<bool, String> {
    let sign = [">=", "<", "="].into_iter().find(|s| condition.contains(s));
    let sign = sign.ok_or(format!("no condition: {condition}"))?;
    let (key, wanted) = condition.split_once(sign).unwrap();
    let cell = row.get(key.trim()).ok_or(format!("no column {key}"))?;
    Ok(
        match (cell.parse::<f64>(), wanted.trim().parse::<f64>(), sign) {
            (Ok(cell), Ok(wanted), ">=") => cell >= wanted,
            (Ok(cell), Ok(wanted), "<") => cell < wanted,
            (Ok(cell), Ok(wanted), _) => cell == wanted,
            _ => sign == "=" && cell == wanted.trim(),
        },
    )
}

fn conditions(text: &str) -> impl Iterator<Item = &str> {
    text.split(" and ").filter(|part| !part.trim().is_empty())
}

/// Returns the number that a term such as `max error_mm where method=rays` has in the rows that meet `common`.
fn value(rows: &[Row], common: &str, term: &str) -> Result<f64, String> {
    if let Some((above, below)) = term.split_once(" / ") {
        return Ok(value(rows, common, above)? / value(rows, common, below)?);
    }
    if let Ok(number) = term.trim().parse() {
        return Ok(number);
    }
    let (what, own) = term.split_once("where").unwrap_or((term, ""));
    let mut kept: Vec<&Row> = rows.iter().collect();
    for condition in conditions(common).chain(conditions(own)) {
        // A column that the table lacks is an error also if no row is left.
        meets(&rows[0], condition)?;
        kept.retain(|row| meets(row, condition).unwrap());
    }
    let mut words = what.split_whitespace();
    let aggregate = words.next().unwrap_or_default();
    if aggregate == "count" {
        return Ok(kept.len() as f64);
    }
    let column = words.next().unwrap_or(aggregate);
    let cell = |row: &&Row| row.get(column)?.parse().ok();
    let numbers: Option<Vec<f64>> = kept.iter().map(cell).collect();
    let mut numbers = numbers.ok_or(format!("no numbers in column {column}"))?;
    numbers.sort_by(f64::total_cmp);
    match (aggregate, numbers.as_slice()) {
        (_, []) => Err(format!("no row: {term}")),
        ("min", [first, ..]) => Ok(*first),
        ("max", [.., last]) => Ok(*last),
        ("median", all) => Ok(0.5 * (all[(all.len() - 1) / 2] + all[all.len() / 2])),
        (_, [only]) if aggregate == column => Ok(*only),
        _ => Err(format!("{} rows: {term}", numbers.len())),
    }
}

/// Returns half a unit of the last significant digit. Zeros at the end of a whole number are significant up to the second digit.
fn half_unit(shown: &str) -> f64 {
    let (digits, power) = shown.split_once('e').unwrap_or((shown, "0"));
    let power: i32 = power.parse().unwrap();
    let last = match digits.split_once('.') {
        Some((_, decimals)) => -(decimals.len() as i32),
        None => {
            let zeros = digits.len() - digits.trim_end_matches('0').len();
            zeros.min(digits.len().saturating_sub(2)) as i32
        }
    };
    0.5 * 10f64.powi(power + last) * (1.0 + 1e-9)
}

/// Checks a comment against its table and the text before it; returns how many numbers it names.
fn check(text: &str, comment: &str) -> Result<usize, String> {
    let (table_of, entries) = comment.split_once(':').ok_or("no `:`")?;
    let (file, common) = table_of.split_once(" where ").unwrap_or((table_of, ""));
    let rows = table(file.trim())?;
    let is_part = |c: char| c.is_ascii_digit() || c == '.' || c == ',';
    let tokens = text.split(|c: char| !is_part(c) && !"e-".contains(c));
    let tokens: Vec<&str> = tokens
        .map(|t| t.trim_matches([',', '.', 'e', '-']))
        .collect();
    let mut n_numbers = 0;
    for entry in entries.split([';', '\n']).filter(|e| !e.trim().is_empty()) {
        n_numbers += 1;
        let mut words = entry.split_whitespace();
        let (shown, sign) = (words.next().unwrap_or_default(), words.next());
        let value = value(&rows, common, &words.collect::<Vec<_>>().join(" "))?;
        let plain = shown.replace(',', "");
        let number: f64 = plain.parse().map_err(|_| format!("no number: {entry}"))?;
        let agrees = match sign {
            Some("=") => (value - number).abs() <= half_unit(&plain),
            Some("<") => number < value,
            _ => return Err(format!("no `=` or `<`: {entry}")),
        };
        if !agrees {
            return Err(format!("{entry}: the table has {value}"));
        }
        if !tokens.contains(&shown) {
            return Err(format!("{entry}: not in the text before the comment"));
        }
    }
    Ok(n_numbers)
}

#[test]
fn printed_numbers_equal_their_tables() {
    let mut n_numbers = 0;
    let mut errors = Vec::new();
    for (document, text) in documents() {
        let mut shown = "";
        for part in text.split("-->") {
            let Some((text, comment)) = part.split_once("<!-- results/") else {
                continue;
            };
            // Several comments may follow one text.
            if !text.trim().is_empty() {
                shown = text;
            }
            match check(shown, &format!("results/{comment}")) {
                Ok(n) => n_numbers += n,
                Err(error) => errors.push(format!("{document}: {error}")),
            }
        }
    }
    assert!(errors.is_empty(), "{}", errors.join("\n"));
    assert!(n_numbers > 100, "{n_numbers} numbers");
}

#[test]
fn a_wrong_number_is_noticed() {
    let of = |entry: &str| {
        let file = "results/stability/stability_summary.csv where scene=rest: ";
        check("257 of 257 right, 1.5 kg", &format!("{file}{entry}"))
    };
    assert_eq!(of("257 = n_correct where method=quasi_static"), Ok(1));
    for wrong in [
        "257 = n_correct where method=implicit_euler",
        "117 = n_correct where method=implicit_euler",
        "257 = n_correct",
        "257 = n_correct where method=no_method",
        "257 = no_column where method=quasi_static",
        "257 < n_correct where method=quasi_static",
    ] {
        assert!(of(wrong).is_err(), "{wrong}");
    }
}
