//! Reading and writing of TOML files, with errors that state the location.

use super::toml_lines::line_of;
use super::toml_numbers::{Bound, check_numbers, each_value};
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::Range;
use toml::Spanned;
use toml::de::DeTable;
use toml_parser::Source;
use toml_parser::lexer::TokenKind;

/// Maximum nesting of brackets in a TOML text. The TOML reader has its own limit (80), but ignores it in invalid text and recurses for each bracket. Thousands
/// of brackets would overflow a thread's stack.
const MAX_OPEN: usize = 200;

/// Maximum number of dots in a key of a TOML text. Each dot is a level of nesting that the TOML reader does not count, and dropping thousands of levels would
/// overflow a thread's stack.
const MAX_DOTS: usize = 20;

/// TOML text that has been parsed once: a table in which each value carries its position in the text.
pub struct TomlText<'t> {
    place: &'t str,
    text: &'t str,
    /// Table of the file; spans are byte ranges of the text.
    pub table: Spanned<DeTable<'t>>,
}

impl<'t> TomlText<'t> {
    /// Parses a TOML text, whose file is `place`.
    ///
    /// # Errors
    /// If the text is not valid TOML, is nested too deeply, or has a number out of the bounds of its unit; the error contains file and line.
    pub fn parse(place: &'t str, text: &'t str) -> Result<Self> {
        check_nesting(place, text)?;
        let table = DeTable::parse(text).map_err(|error| refused(place, text, &error))?;
        check_numbers(place, text, table.get_ref())?;
        Ok(Self { place, text, table })
    }

    /// Converts the table to a type.
    ///
    /// # Errors
    /// If a key is unknown, missing or of another type; the error contains file, line and column.
    pub fn read<T: DeserializeOwned>(self) -> Result<T> {
        let read = T::deserialize(toml::Deserializer::from(self.table));
        read.map_err(|error| refused(self.place, self.text, &error))
    }
}

/// Parses a TOML text; an error contains `place` (the file), line and column.
///
/// # Errors
/// If the text is not valid TOML, has an unknown, missing or mistyped key, or has a number out of bounds.
pub fn read<T: DeserializeOwned>(place: &str, text: &str) -> Result<T> {
    TomlText::parse(place, text)?.read()
}

/// Creates an input error from an error of the TOML reader. The error contains file, line and column, or the key if its value is a list in place of a number.
pub fn refused(place: &str, text: &str, error: &toml::de::Error) -> Error {
    // Names of Rust types become plain words.
    const WORDS: [(&str, &str); 5] = [
        ("\n", " "),
        ("expected usize", "expected a whole number"),
        ("expected u64", "expected a whole number"),
        ("expected u32", "expected a whole number"),
        ("expected f64", "expected a number"),
    ];
    let replaced = |message: String, (old, new): &(&str, &str)| message.replace(old, new);
    let message = WORDS
        .iter()
        .fold(error.message().trim().to_owned(), replaced);
    let (given, allowed) = match message.split_once(", expected ") {
        Some((given, allowed)) => (given.to_owned(), format!("expected {allowed}")),
        None => (message, "TOML as in experiments/ and objects/".to_owned()),
    };
    let Some(span) = error.span() else {
        return Error::input(place, given, allowed);
    };
    let line = line_of(text, span.start);
    if let ("invalid type: sequence", "expected a number" | "expected a whole number") =
        (given.as_str(), allowed.as_str())
        && let Some(key) = key_at(text, &span)
    {
        let number = allowed.trim_start_matches("expected a ");
        let place = format!("{place}:{line}, key {key}");
        let allowed = format!("one {number}: no list of this key in this kind of file");
        return Error::input(place, "a list", allowed);
    }
    let before = &text[..span.start.min(text.len())];
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    Error::input(format!("{place}:{line}:{column}"), given, allowed)
}

/// Returns the path of the key whose value has a byte range of the text.
fn key_at(text: &str, span: &Range<usize>) -> Option<String> {
    let table = DeTable::parse(text).ok()?;
    each_value(
        "",
        Bound::PLAIN,
        table.get_ref(),
        &mut |path, _, value| match value.span() == *span {
            true => Err(path.to_owned()),
            false => Ok(()),
        },
    )
    .err()
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
fn check_nesting(place: &str, text: &str) -> Result<()> {
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
