//! Names of columns. Names that differ in numbers alone are a family, such as `taxel_0` and `taxel_1`. In a pattern, `*` stands for any text and `#` for a
//! number.

/// Maximum number of families that a message lists.
const MAX_LISTED: usize = 8;

/// Returns a list of the families of columns, and the pattern of the largest family; `None` if all columns are of one family.
pub fn column_families(names: &[String]) -> Option<(String, String)> {
    let families = families(names);
    let (largest, _) = families
        .iter()
        .rev()
        .max_by_key(|(_, members)| members.len())?;
    (families.len() > 1).then(|| (listed(names), largest.clone()))
}

/// Returns the families of names, in the order of their first names: a pattern that matches the names of the family alone, and these names.
fn families(names: &[String]) -> Vec<(String, Vec<&String>)> {
    let mut families: Vec<(String, Vec<&String>)> = Vec::new();
    for name in names {
        let numbered = with_digits_as(name, "#");
        match families.iter_mut().find(|(family, _)| *family == numbered) {
            Some((_, members)) => members.push(name),
            None => families.push((numbered, vec![name])),
        }
    }
    for (family, members) in &mut families {
        let (prefix, _) = family.split_once('#').unwrap_or((family, ""));
        let patterns = [format!("{prefix}*"), family.replace('#', "*")];
        let is_alone = |pattern: &&String| {
            let matched = names.iter().filter(|name| matches(pattern, name));
            matched.count() == members.len()
        };
        if let [only] = members[..] {
            only.clone_into(family);
        } else if let Some(pattern) = patterns.iter().find(is_alone) {
            pattern.clone_into(family);
        }
    }
    families
}

/// Returns the families of names as a list for messages, each with the number of its names.
pub fn listed(names: &[String]) -> String {
    let families = families(names);
    let word = |(family, members): &(String, Vec<&String>)| match members.len() {
        1 => format!("`{family}`"),
        n => format!("`{family}` ({n})"),
    };
    let words: Vec<String> = families.iter().take(MAX_LISTED).map(word).collect();
    let more = match families.len().saturating_sub(MAX_LISTED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    words.join(", ") + &more
}

/// Returns a text with `letter` in place of each run of digits.
fn with_digits_as(text: &str, letter: &str) -> String {
    let mut found = String::new();
    let mut was_digit = false;
    for own in text.chars() {
        let is_digit = own.is_ascii_digit();
        match (is_digit, was_digit) {
            (true, false) => found += letter,
            (true, true) => {}
            (false, _) => found.push(own),
        }
        was_digit = is_digit;
    }
    found
}

/// Returns whether a name matches a pattern, in which `*` stands for any text and `#` for a number.
pub fn matches(pattern: &str, name: &str) -> bool {
    let Some((before, after)) = pattern.split_once(['*', '#']) else {
        return pattern == name;
    };
    let Some(rest) = name.strip_prefix(before) else {
        return false;
    };
    let is_number = pattern[before.len()..].starts_with('#');
    let n_digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    match is_number {
        true => n_digits > 0 && matches(after, &rest[n_digits..]),
        false => rest
            .char_indices()
            .map(|(at, _)| at)
            .chain([rest.len()])
            .any(|at| matches(after, &rest[at..])),
    }
}
