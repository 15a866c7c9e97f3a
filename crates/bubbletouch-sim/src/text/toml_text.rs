//! Reading and writing of TOML files, with errors that state the location.

use super::toml_lines::line_of;
use super::toml_numbers::check_bounds;
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::Range;
use toml::de::{DeTable, DeValue};
use toml_parser::Source;
use toml_parser::lexer::TokenKind;

/// Maximum nesting of brackets in a TOML text. The TOML reader has its own limit (80), but ignores it in invalid text and recurses for each bracket. Thousands
/// of brackets would overflow a thread's stack.
const MAX_OPEN: usize = 200;

/// Maximum number of dots in a key of a TOML text. Each dot is a level of nesting that the TOML reader does not count, and dropping thousands of levels would
/// overflow a thread's stack.
const MAX_DOTS: usize = 20;

/// Parses a TOML text; an error contains `place` (the file), line and column.
///
/// # Errors
/// If the text is not valid TOML, has an unknown, missing or mistyped key, or has a number out of bounds.
pub fn read<T: DeserializeOwned>(place: &str, text: &str) -> Result<T> {
    check_nesting(place, text)?;
    check_numbers(place, text)?;
    toml::from_str(text).map_err(|error| Error::toml(place, text, &error))
}

/// Returns an error unless a TOML table can store all integers of a text, and all numbers are within the bounds of their units.
///
/// # Errors
/// If the text is not valid TOML, or a number in it is out of bounds.
pub fn check_numbers(place: &str, text: &str) -> Result<()> {
    let read = text.parse::<toml::Table>();
    read.map_err(|error| Error::toml(place, text, &error))?;
    check_bounds(place, text)
}

/// Returns the error of a list that is the value of a key with one number, with file, line and key; `None` for other errors.
pub(crate) fn list_for_number(place: &str, text: &str, error: &toml::de::Error) -> Option<Error> {
    let expected = error.message().trim();
    let number = match expected.strip_prefix("invalid type: sequence, expected ")? {
        "f64" => "number",
        "usize" | "u64" | "u32" => "whole number",
        _ => return None,
    };
    let span = error.span()?;
    let key = key_at("", DeTable::parse(text).ok()?.get_ref(), &span)?;
    let place = format!("{place}:{}, key {key}", line_of(text, span.start));
    let allowed = format!("one {number}: no list of this key in this kind of file");
    Some(Error::input(place, "a list", allowed))
}

/// Returns the path of the key whose value has a byte range of the text. An entry of a list has its number, counted from 1: `part[1].diameter_mm`.
fn key_at(prefix: &str, table: &DeTable, span: &Range<usize>) -> Option<String> {
    table.iter().find_map(|(name, value)| {
        let path = format!("{prefix}{}", name.get_ref());
        match value.get_ref() {
            _ if value.span() == *span => Some(path),
            DeValue::Table(inner) => key_at(&format!("{path}."), inner, span),
            DeValue::Array(values) => (1..).zip(values).find_map(|(number, value)| {
                let inner = value.get_ref().as_table()?;
                key_at(&format!("{path}[{number}]."), inner, span)
            }),
            _ => None,
        }
    })
}

/// Writes a study with all default values as TOML.
pub fn write(study: &impl Serialize) -> String {
    toml::to_string(study).expect("every field of a study has a TOML form")
}

/// Parses a text as a TOML table; `None` if it is not valid TOML.
pub fn table(text: &str) -> Option<toml::Table> {
    check_nesting("", text).ok()?;
    text.parse().ok()
}

/// Returns an error for invalid TOML text whose parsing would need a deep stack.
///
/// # Errors
/// If more than 200 brackets are open at once, or a key has more than 20 dots.
pub fn check_nesting(place: &str, text: &str) -> Result<()> {
    // Square and curly brackets are counted separately; in invalid text one kind may close the other.
    let mut open = [0_usize; 2];
    let mut n_dots = 0;
    for token in Source::new(text).lex() {
        match token.kind() {
            TokenKind::LeftSquareBracket => open[0] += 1,
            TokenKind::LeftCurlyBracket => open[1] += 1,
            TokenKind::RightSquareBracket => open[0] = open[0].saturating_sub(1),
            TokenKind::RightCurlyBracket => open[1] = open[1].saturating_sub(1),
            TokenKind::Dot => n_dots += 1,
            TokenKind::Equals | TokenKind::Comma | TokenKind::Newline => n_dots = 0,
            _ => {}
        }
        let n_open = open[0] + open[1];
        let (given, most) = match n_open > MAX_OPEN {
            true => (format!("{n_open} brackets that are still open"), MAX_OPEN),
            false if n_dots > MAX_DOTS => (format!("a key with {n_dots} dots"), MAX_DOTS),
            false => continue,
        };
        let line = line_of(text, token.span().start());
        let allowed = format!("at most {most}");
        return Err(Error::input(format!("{place}:{line}"), given, allowed));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the error of a TOML text that is parsed on a small thread stack.
    fn refused(text: &'static str) -> String {
        let read = move || read::<toml::Table>("study.toml", text).unwrap_err();
        let thread = std::thread::Builder::new().stack_size(2 << 20);
        let error = thread.spawn(read).unwrap().join().unwrap();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    }

    #[test]
    fn brackets_by_the_thousand_are_refused_with_their_line() {
        let part = "position_mm = [{a = {a = 1}}}, ";
        for text in [part, "[", "{", "a = [", "a = {b = ["] {
            let text: &'static str = ("# deep\na = [\n".to_owned() + &text.repeat(20_000)).leak();
            let said = refused(text);
            assert!(said.starts_with("study.toml:3: 201 brackets"), "{said}");
        }
        assert_eq!(table(&"[".repeat(100_000)), None);
    }

    #[test]
    fn keys_of_thousands_of_parts_are_refused_with_their_line() {
        for start in ["", "[", "a = {b.", "a = [1.5, 2.5]\n"] {
            let text = format!("# deep\n{start}{}=1", "a.".repeat(20_000));
            let said = refused(text.leak());
            let line = 2 + start.matches('\n').count();
            let expected = format!("study.toml:{line}: a key with 21 dots; at most 20");
            assert_eq!(said, expected);
        }
    }

    #[test]
    fn numbers_that_no_table_holds_are_refused_with_their_line() {
        #[derive(Debug, serde::Deserialize)]
        struct Spec {
            #[expect(dead_code, reason = "only read")]
            seed: u64,
        }
        assert!(read::<Spec>("study.toml", "seed = 9223372036854775807").is_ok());
        for number in ["9223372036854775808", "18446744073709551615"] {
            let error = read::<Spec>("study.toml", &format!("# large\nseed = {number}"));
            let said = error.unwrap_err().to_string();
            assert!(said.starts_with("study.toml:2"), "{said}");
            assert!(
                said.ends_with("too large; expected a number below 2⁶³"),
                "{said}"
            );
        }
    }

    #[test]
    fn brackets_in_texts_and_remarks_do_not_count() {
        let many = "[".repeat(1000);
        let text = format!("# {many}\na = \"{many}\"\nb = '''\n{many}'''\nc = [[[1]]]\n");
        let table: toml::Table = read("study.toml", &text).unwrap();
        assert_eq!(table["a"].as_str(), Some(&many[..]));
        let said = refused("a = [[1]\nb = 2\n");
        assert!(said.starts_with("study.toml:2:"), "{said}");
    }
}
