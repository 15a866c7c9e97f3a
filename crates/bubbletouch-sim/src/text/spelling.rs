//! Spelling suggestions, counted nouns and durations.

use crate::error::{Error, Result};

/// Maximum number of names suggested in an error message; longer lists are hard to read.
const OFFERED: usize = 8;

/// Formats a number with a noun in singular or plural, such as `1 thread` or `2 threads`.
pub fn counted(number: usize, one: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {one}{plural}")
}

/// Formats a time in seconds in words with few digits, for estimates.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "under 1 s".to_owned(),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5970.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.1} days", s / 86_400.0),
    }
}

/// Returns the index of a name among `names`, or an error with similar names.
///
/// # Errors
/// If the name is unknown; the error contains the most similar names.
pub fn known<'a>(
    place: impl ToString,
    name: &str,
    names: impl IntoIterator<Item = &'a str> + Clone,
) -> Result<usize> {
    let found = names.clone().into_iter().position(|known| known == name);
    found.ok_or_else(|| Error::input(place, format!("`{name}`"), nearest_names(name, names)))
}

/// Returns the end of the error message for an unknown name: similar names, otherwise the first names of the list.
pub fn nearest_names<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let all: Vec<&str> = names.into_iter().collect();
    let mut near: Vec<(usize, &str)> = all
        .iter()
        .map(|known| (distance(name, known), *known))
        .filter(|(far, known)| far * 3 <= known.chars().count().max(6))
        .collect();
    near.sort();
    if near.is_empty() {
        let more = if all.len() > OFFERED { ", …" } else { "" };
        return match all.len() {
            0 => "there is none".to_owned(),
            _ => format!("one of {}{more}", quoted(&all[..all.len().min(OFFERED)])),
        };
    }
    near.truncate(OFFERED);
    let near: Vec<&str> = near.into_iter().map(|(_, known)| known).collect();
    format!("perhaps {}", quoted(&near))
}

/// Returns the known word of which an unknown word is probably a misspelling. The two may differ by at most two edits, and by no more than a third of the
/// letters.
pub fn slip_of<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let near = |known: &&&str| {
        let far = distance(word, known);
        far <= 2 && far * 3 <= known.chars().count()
    };
    known.iter().find(near).copied()
}

/// Returns the edit distance of two words: the number of letters inserted, deleted, replaced or swapped, ignoring case.
fn distance(a: &str, b: &str) -> usize {
    strsim::damerau_levenshtein(&a.to_lowercase(), &b.to_lowercase())
}

fn quoted(names: &[&str]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_written_with_as_many_digits_as_they_deserve() {
        let words = [0.2, 1.0, 42.4, 99.6, 600.0, 7200.0, 259_200.0].map(duration);
        let expected = [
            "under 1 s",
            "1 s",
            "42 s",
            "2 min",
            "10 min",
            "2.0 h",
            "3.0 days",
        ];
        assert_eq!(words, expected);
    }

    #[test]
    fn a_slip_is_offered_what_was_meant_and_a_stranger_the_list() {
        let names = ["elbow", "wrist", "shoulder_pan"];
        assert_eq!(nearest_names("elbwo", names), "perhaps `elbow`");
        assert_eq!(
            nearest_names("Shoulder_Pan", names),
            "perhaps `shoulder_pan`"
        );
        assert_eq!(
            nearest_names("knee", ["hip"; 9]).matches("hip").count(),
            OFFERED
        );
        assert_eq!(nearest_names("knee", []), "there is none");
    }

    #[test]
    fn a_tag_of_another_tool_is_no_slip() {
        assert_eq!(slip_of("orgin", &["origin", "axis"]), Some("origin"));
        assert_eq!(slip_of("sensor", &["origin", "axis"]), None);
        assert_eq!(slip_of("xyz", &["rpy"]), None);
    }
}
