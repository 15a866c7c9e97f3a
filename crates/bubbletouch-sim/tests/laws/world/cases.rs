//! Tables of cases as text: one case a line, with its columns separated by ` |`. Written line breaks (`\n`) are line breaks.

/// Returns the cases of a table with N columns.
pub fn cases<const N: usize>(table: &str) -> Vec<[String; N]> {
    let lines = table.lines().filter(|line| !line.trim().is_empty());
    let case = |line: &str| {
        let columns = line.split(" |").map(|it| it.trim().replace("\\n", "\n"));
        let columns: Vec<String> = columns.collect();
        let columns = <[String; N]>::try_from(columns);
        columns.unwrap_or_else(|_| panic!("{N} columns: {line}"))
    };
    lines.map(case).collect()
}

/// Returns a text in which `old` is replaced by `new`, once.
pub fn replaced(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "a text that is there: {old}");
    text.replacen(old, new, 1)
}
