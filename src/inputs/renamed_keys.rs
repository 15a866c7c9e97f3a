//! Keys of study files that have been renamed.

use crate::error::{Error, Result};
use crate::toml_lines::line_of;
use toml::de::{DeTable, DeValue};

/// Former names of keys and columns, each with its current name.
const RENAMED: [(&str, &str); 15] = [
    ("choose_c", "c_grid"),
    ("choose_folds", "cv_folds"),
    ("choose_gamma", "gamma_grid"),
    ("choose_touches", "cv_touches"),
    ("foremost_full_scale", "depth_window_full_scale"),
    ("fused_touches", "touches_per_decision"),
    ("keep_together", "group_by"),
    ("keep_together_deg", "group_by_deg"),
    ("keep_together_mm", "group_by_mm"),
    ("over_time", "temporal_features"),
    ("share", "fraction"),
    ("tested_on", "test_sensor"),
    ("tilted_copies", "tilt_augmentation"),
    ("tilted_copies_deg", "tilt_augmentation_deg"),
    ("training_readings", "readings_per_touch"),
];

/// Checks that no key of a study, at any depth of its tables, has a former name. A key may be a dotted path, as in `[axes]`.
///
/// # Errors
/// If a key has a former name; the error contains its line and the current name.
pub fn check_renamed(place: &str, text: &str, table: &DeTable) -> Result<()> {
    for (key, value) in table {
        let former = |name: &str| RENAMED.iter().find(|(former, _)| *former == name);
        if let Some((former, current)) = key.get_ref().split('.').find_map(former) {
            let place = format!("{place}:{}", line_of(text, key.span().start));
            let given = format!("key `{former}`, a former name");
            return Err(Error::input(
                place,
                given,
                format!("its new name `{current}`"),
            ));
        }
        let inner = match value.get_ref() {
            DeValue::Table(inner) => vec![inner],
            DeValue::Array(values) => values
                .iter()
                .filter_map(|value| value.get_ref().as_table())
                .collect(),
            _ => Vec::new(),
        };
        for table in inner {
            check_renamed(place, text, table)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_former_name_is_refused_with_its_line_and_the_new_name() {
        for (text, line) in [
            ("a = 1\nchoose_c = [1.0]", 2),
            ("[recognition]\n\nchoose_c = [1.0]", 3),
            ("[axes]\n\"recognition.choose_c\" = [[1.0]]", 2),
            ("b = [{ choose_c = 1.0 }]", 1),
        ] {
            let table = DeTable::parse(text).unwrap();
            let error = check_renamed("s.toml", text, table.get_ref()).unwrap_err();
            let expected = format!("s.toml:{line}: key `choose_c`, a former name; ");
            assert!(error.to_string().contains(&expected), "{error}");
            assert!(error.to_string().contains("`c_grid`"), "{error}");
        }
        let table = DeTable::parse("c_grid = [1.0]").unwrap();
        check_renamed("s.toml", "", table.get_ref()).unwrap();
    }
}
