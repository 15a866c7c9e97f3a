//! Rows by what they are rows of.

/// Things of the same key together, keys in the order of their first.
pub(super) fn grouped<'a, T, K: PartialEq>(
    things: impl IntoIterator<Item = &'a T>,
    key: impl Fn(&T) -> K,
) -> Vec<(K, Vec<&'a T>)> {
    let mut groups: Vec<(K, Vec<&T>)> = Vec::new();
    for thing in things {
        let of_it = key(thing);
        match groups.iter_mut().find(|(known, _)| *known == of_it) {
            Some((_, group)) => group.push(thing),
            None => groups.push((of_it, vec![thing])),
        }
    }
    groups
}
