//! Texts of doc comments for people who do not read the source.

/// Converts a doc comment to plain text: one line per paragraph, without links to items of the library.
pub(crate) fn plain(words: &str) -> String {
    let paragraphs = words.split("\n\n").map(|paragraph| {
        let words = paragraph.split_whitespace().collect::<Vec<_>>();
        words.join(" ")
    });
    let words = paragraphs.collect::<Vec<_>>().join("\n\n");
    let mut plain = String::new();
    let mut rest = words.as_str();
    while let Some(start) = rest.find('[') {
        let (before, link) = rest.split_at(start);
        plain.push_str(before);
        let is_escaped = before.ends_with('\\');
        match link_of(link).filter(|_| !is_escaped) {
            Some((words, after)) => {
                plain.push_str(words);
                rest = after;
            }
            None => {
                plain.push('[');
                rest = &link[1..];
            }
        }
    }
    plain.push_str(rest);
    plain.replace("\\[", "[").replace("\\]", "]")
}

/// Splits a text that begins with a documentation link into the words of the link and the rest of the text. A link is [`Type`] or [words](path).
fn link_of(text: &str) -> Option<(&str, &str)> {
    let end = text.find(']')?;
    let (words, after) = (&text[1..end], &text[end + 1..]);
    if let Some(target) = after.strip_prefix('(') {
        let (target, after) = target.split_once(')')?;
        return (!target.starts_with("http")).then_some((words, after));
    }
    let is_item = words.starts_with('`') && words.ends_with('`') && words.len() > 2;
    // `[signal]` in back quotes is the name of a TOML table.
    is_item.then_some((words, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_description_keeps_names_of_tables_and_loses_links() {
        for (given, expected) in [
            (
                "`[signal]`: noise\nand [`Noise`](crate::signal::Noise).",
                "`[signal]`: noise and `Noise`.",
            ),
            (
                "a rule of [`PoseSplit`]\n\n[x](y::z) as in \\[BT\\], [CL]",
                "a rule of `PoseSplit`\n\nx as in [BT], [CL]",
            ),
            (
                "see [the page](https://a.b) of [[robots]]",
                "see [the page](https://a.b) of [[robots]]",
            ),
        ] {
            assert_eq!(plain(given), expected);
        }
    }
}
