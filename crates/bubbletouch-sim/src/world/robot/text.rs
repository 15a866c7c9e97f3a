//! Text of a robot's file: repairs the text for a strict XML parser without changing line numbers.
//!
//! Many public files are not well-formed XML, although other tools accept them. Examples are comments or spaces before `<?xml`, `--` inside
//! a comment, undeclared namespace prefixes, a second end tag of the root, and NUL bytes at the end.

use crate::text::xml::{Lines, parsed};
use roxmltree::Error;

/// Largest number of undeclared namespace prefixes in one file; robot files have far fewer.
const MAX_PREFIXES: usize = 100;

/// Returns the text with spaces in place of comments and of an XML declaration that is not at the beginning. Undeclared namespace prefixes are declared. Line
/// numbers are unchanged.
pub(super) fn repaired(place: &str, text: &str, lines: &Lines) -> String {
    let text = text.trim_start_matches('\u{feff}').trim_end_matches('\0');
    let mut repaired = without(text, "<!--", "-->");
    let begins_late = |text: &str| text.match_indices("<?xml").any(is_late_declaration(text));
    if begins_late(&repaired) {
        lines.note(format!(
            "{place}: a comment or space before the XML declaration: not well-formed XML, read all the same"
        ));
        let starts = repaired.match_indices("<?xml");
        let late: Vec<usize> = starts
            .filter(|found| is_late_declaration(&repaired)(*found))
            .map(|(start, _)| start)
            .collect();
        for start in late.into_iter().rev() {
            let rest = without(&repaired[start..], "<?xml", "?>");
            repaired.replace_range(start.., &rest);
        }
    }
    for _ in 0..MAX_PREFIXES {
        let Err(Error::UnknownNamespace(prefix, _)) = parsed(&repaired) else {
            break;
        };
        let Some(end) = root_name_end(&repaired) else {
            break;
        };
        repaired.insert_str(end, &format!(" xmlns:{prefix}=\"{prefix}\""));
    }
    without_second_end(repaired, place, lines)
}

/// Returns the text without end tags of the root element that follow the end of the root element.
fn without_second_end(mut text: String, place: &str, lines: &Lines) -> String {
    let end_tag = format!("</{}>", root_name(&text).unwrap_or_default());
    if parsed(&text).is_err() {
        while let Some(before) = text.trim_end().strip_suffix(&end_tag)
            && before.trim_end().ends_with(&end_tag)
        {
            text.truncate(before.len());
            lines.note(format!(
                "{place}: a second {end_tag} at the end: not well-formed XML, read all the same"
            ));
        }
    }
    text
}

/// Returns a predicate for pairs of a byte position and the text `<?xml` found there. The predicate is true for an XML declaration that is not at the
/// beginning of the text, and false for other instructions such as `<?xml-model`.
fn is_late_declaration(text: &str) -> impl Fn((usize, &str)) -> bool + '_ {
    move |(start, found)| {
        let after = text[start + found.len()..].chars().next();
        start > 0 && after.is_some_and(char::is_whitespace)
    }
}

/// Returns the text with spaces in place of each section from `open` to the next `close`.
fn without(text: &str, open: &str, close: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(open) {
        let Some(length) = rest[start..].find(close) else {
            break;
        };
        let end = start + length + close.len();
        kept += &rest[..start];
        kept.extend(
            rest[start..end]
                .chars()
                .map(|c| if c == '\n' { c } else { ' ' }),
        );
        rest = &rest[end..];
    }
    kept + rest
}

/// Returns the name of the first element of a text, which can contain comments.
pub(super) fn root_name(text: &str) -> Option<String> {
    let text = without(text, "<!--", "-->");
    let end = root_name_end(&text)?;
    let start = text[..end].rfind('<')?;
    Some(text[start + 1..end].to_owned())
}

/// Returns the byte position after the name of the first element.
fn root_name_end(text: &str) -> Option<usize> {
    let is_name = |start: usize| {
        let after = text[start + 1..].chars().next();
        after.is_some_and(|c| c.is_alphabetic() || c == '_')
    };
    let (start, _) = text.match_indices('<').find(|(start, _)| is_name(*start))?;
    let ends = |c: char| c.is_whitespace() || c == '>' || c == '/';
    text[start..].find(ends).map(|length| start + length)
}
