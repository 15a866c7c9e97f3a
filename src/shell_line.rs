//! Functions that write command lines which can be pasted into a shell.

/// Joins words to a command line that a POSIX shell splits into the given words.
pub fn shell_line(words: &[impl AsRef<str>]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| quoted(word.as_ref())).collect();
    quoted.join(" ")
}

/// Quotes a word, unless all its characters are literal in every shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::shell_line;

    #[test]
    fn a_word_with_spaces_quotes_or_variables_is_one_word_to_the_shell() {
        let words = [
            "run",
            "results/it's $HOME",
            "",
            "a b.toml",
            "--out",
            "x/1.5",
        ];
        let expected = r"run 'results/it'\''s $HOME' '' 'a b.toml' --out x/1.5";
        assert_eq!(shell_line(&words), expected);
    }

    #[test]
    #[cfg(unix)]
    fn the_shell_splits_a_line_into_the_words_that_it_was_made_of() {
        let words = [
            "a b", "it's", "$HOME", "*", "~", "#x", "a\\b", "\"", "", "é", "x;y", "!",
        ];
        let line = format!("printf '%s\\n' {}", shell_line(&words));
        let output = std::process::Command::new("sh")
            .arg("-c")
            .arg(line)
            .output()
            .unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        assert_eq!(said.lines().collect::<Vec<_>>(), words);
    }
}
