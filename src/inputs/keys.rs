//! Descriptions of the keys of study files: range, axis, role, title, unit and scale of each key, from its declaration (the macro `params!`).

use crate::inputs::range::Range;
use crate::inputs::toml_value::{has_only, is_at, number};
use crate::table::{Column, Role, Scale};
use std::any::Any;

/// Description of a key of study files, which also defines the key's table column and axis.
#[derive(Clone, Copy, Debug)]
pub struct KeyAbout {
    /// Path of the key, such as `skin.pitch_mm`. Entries of an array of tables share a path: `stability.parts.taxels`.
    pub path: &'static str,
    /// Place at which the key may have a list of values to sweep.
    pub axis: AxisPlace,
    /// Whether a list in the table of the key is an axis as those of `[axes]`. Otherwise, the kind of study sweeps a list itself, or a list is one value.
    pub is_swept_in_table: bool,
    /// Role that the key's column has in result tables.
    pub role: Role,
    /// Numbers that the key allows.
    pub range: Range,
    /// Value that has the effect of the absent key; `None` if there is none, or if the range of a classifier's parameter states it.
    pub usual: Option<fn() -> toml::Value>,
    /// Title of the key's column; `None` if it equals the name of the key.
    pub title: Option<&'static str>,
    /// Unit of the key's numbers; `None` if the name of the key ends with the unit.
    pub unit: Option<&'static str>,
    /// Scale of the key's column; if `None`, the scale depends on the swept values.
    pub scale: Option<Scale>,
    /// Display names of the key's values; see [`Column::names`].
    pub names: Option<&'static [(&'static str, &'static str)]>,
    /// Rank of the key's column among the settings that charts omit if other settings determine them; see [`Column::gives_way`].
    pub gives_way: Option<u8>,
    /// Key of the same table that this key replaces; a table must not contain both.
    pub replaces: Option<&'static str>,
    /// Conditions under which the key acts, from the macro [`acts!`](crate::acts). If it is `None`, the key always acts.
    pub acts: Option<&'static [Acts]>,
    /// Whether all kinds of studies that press one array use the key. Otherwise, only studies of recognition do.
    pub of_all_kinds: Option<bool>,
    /// Whether training touches and test touches share the value. Otherwise, the table `[test]` may contain the key.
    pub of_all_touches: Option<bool>,
}

/// Condition under which a key acts. It gets the key with its value, and a plan, a specification or a table of the study. Returns `None` if the value acts, or if
/// the condition looks at a table or plan of another type.
pub type Acts = fn(GivenKey, &dyn Any) -> Option<NoEffect>;

/// Key with a value other than the usual one.
#[derive(Clone, Copy, Debug)]
pub struct GivenKey<'a> {
    /// Description of the key.
    pub about: &'a KeyAbout,
    /// Value of the key, or all its values.
    pub value: &'a toml::Value,
}

/// Parts of the error of a value that has no effect.
#[derive(Clone, Debug)]
pub struct NoEffect {
    /// Value, and the reason why it has no effect.
    pub given: String,
    /// Description of what is allowed.
    pub allowed: String,
}

impl<'a> GivenKey<'a> {
    /// Creates the key with its value; `None` if the value has the effect of the absent key.
    pub(crate) fn new(about: &'a KeyAbout, value: &'a toml::Value) -> Option<Self> {
        let given = Self { about, value };
        given.first().map(|_| given)
    }

    /// Returns the value, or the first one of a list, that differs from the usual value.
    fn first(self) -> Option<&'a toml::Value> {
        let one = std::slice::from_ref(self.value);
        let mut values = self.value.as_array().map_or(one, Vec::as_slice).iter();
        values.find(|value| !self.about.is_usual(value))
    }

    /// Returns the value with the reason why it has no effect; without a reason, no value is allowed.
    pub fn but(self, reason: &str) -> String {
        match (reason, self.first().and_then(number), self.first()) {
            ("", ..) => "given".to_owned(),
            (_, Some(number), _) => format!("{number}, but {reason}"),
            (_, None, given) => format!("{}, but {reason}", given.unwrap_or(self.value)),
        }
    }

    /// Returns the first condition on the given values that is not met; `None` if the value acts.
    pub(crate) fn no_effect(self, seen: &[&dyn Any]) -> Option<NoEffect> {
        let mut conditions = self.about.acts.unwrap_or_default().iter();
        conditions.find_map(|acts| seen.iter().find_map(|seen| acts(self, *seen)))
    }
}

/// Declares the conditions under which a key acts. Each has the type of the value at which it looks: a plan, a specification or a table of a study. The reason
/// and what is allowed follow. A key of a `Plan` acts if its conditions are met in one variant of the study. Other conditions must be met in all variants.
#[macro_export]
macro_rules! acts {
    ($($type:ty: |$seen:ident| $acts:expr => $reason:expr, $allowed:expr);+ $(;)?) => {{
        const ACTS: &[$crate::inputs::keys::Acts] = &[$(|key, seen| {
            let $seen = seen.downcast_ref::<$type>()?;
            match $acts {
                true => None,
                false => Some($crate::inputs::keys::NoEffect { given: key.but($reason), allowed: $allowed.to_owned() }),
            }
        }),+];
        ACTS
    }};
}

/// Place at which a key may have a list of values that are swept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisPlace {
    /// The key may be swept in its own table or in `[axes]`.
    Table,
    /// The key may be swept only in the table `[axes]`.
    Axes,
    /// The key cannot be swept: it has one value in all configurations of a study.
    Never,
}

/// Two keys are equal if their paths are equal.
impl PartialEq for KeyAbout {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path
    }
}

/// Suffixes of key names that state a unit, each with the unit; longer suffixes first.
const UNITS: [(&str, &str); 18] = [
    ("_m_per_s2", "m/s²"),
    ("_deg_per_s", "°/s"),
    ("_n_s_per_m", "N·s/m"),
    ("_mm_per_s", "mm/s"),
    ("_n_per_m", "N/m"),
    ("_per_s", "1/s"),
    ("_deg", "°"),
    ("_gib", "GiB"),
    ("_mm", "mm"),
    ("_ms", "ms"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_us", "µs"),
    ("_pa", "Pa"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
    ("_g", "g"),
];

impl KeyAbout {
    /// Creates the description of a key whose title and unit follow from its name.
    pub const fn new(path: &'static str, axis: AxisPlace, role: Role, range: Range) -> Self {
        Self {
            path,
            axis,
            is_swept_in_table: false,
            role,
            range,
            usual: None,
            title: None,
            unit: None,
            scale: None,
            names: None,
            gives_way: None,
            replaces: None,
            acts: None,
            of_all_kinds: None,
            of_all_touches: None,
        }
    }

    /// Returns the name of the key: the last part of its path.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// Returns the value that has the effect of the absent key; `None` if there is none.
    pub fn usual_value(&self) -> Option<toml::Value> {
        match (self.usual, self.range) {
            (Some(usual), _) => Some(usual()),
            (None, range) => range.declared_default(),
        }
    }

    /// Returns whether a value, or each value of a list, has the effect of the absent key.
    pub(crate) fn is_usual(&self, value: &toml::Value) -> bool {
        let usual = self.usual_value();
        usual.is_some_and(|usual| has_only(value, &usual))
    }

    /// Returns the name of the key without its unit suffix, and the unit.
    fn name_and_unit(&self) -> (&'static str, &'static str) {
        let name = self.name();
        let found = UNITS.iter().find_map(|(suffix, unit)| {
            let words = name.strip_suffix(suffix)?;
            (!words.is_empty()).then_some((words, *unit))
        });
        found.unwrap_or((name, ""))
    }

    /// Returns the title of the key's column without unit, such as `depth`.
    pub fn title(&self) -> String {
        if let Some(title) = self.title {
            return title.to_owned();
        }
        let words = self.name_and_unit().0.replace('_', " ");
        match (words.starts_with("per "), self.path.split_once('.')) {
            (true, Some((table, _))) => format!("{table} {words}"),
            _ => words,
        }
    }

    /// Returns the unit of the key's numbers; empty if there is none. The unit `%` marks fractions of one, the unit `:1` marks ratios.
    pub fn unit(&self) -> &'static str {
        self.unit.unwrap_or(self.name_and_unit().1)
    }

    /// Returns the column of the key in result tables; `name` is the name of the column.
    ///
    /// # Panics
    /// If the key has no scale.
    pub fn column(&self, name: &'static str) -> Column {
        let scale = self.scale.expect("a key with a column has a scale");
        let column = Column::new(name, self.role, self.title(), self.unit(), scale);
        Column {
            gives_way: self.gives_way,
            ..column.named(self.names.unwrap_or_default())
        }
    }
}

/// Returns the unit in the name of a key; empty if there is none.
pub(crate) fn unit_of(name: &str) -> &'static str {
    let found = UNITS.iter().find(|(suffix, _)| name.ends_with(suffix));
    found.map_or("", |(_, unit)| unit)
}

/// Returns the description of a key, or of the key above it: `touches.depth_mm` for `touches.depth_mm.within`. Returns `None` if the list has no such key.
pub fn find<'k>(keys: &'k [KeyAbout], path: &str) -> Option<&'k KeyAbout> {
    let exact = keys.iter().find(|key| key.path == path);
    exact.or_else(|| keys.iter().find(|key| is_at(path, key.path)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn title_and_unit_come_from_the_name_unless_they_are_given() {
        let key = |path| KeyAbout::new(path, AxisPlace::Axes, Role::Choice, Range::Any);
        let keys = [
            key("skin.damping_n_s_per_m"),
            key("touches.per_object"),
            key("a.m"),
            KeyAbout {
                title: Some("noise"),
                unit: Some("%"),
                scale: Some(Scale::Share),
                ..key("a.noise_mm")
            },
        ];
        let shown = keys.iter().map(|key| (key.title(), key.unit()));
        let expected = [
            ("damping", "N·s/m"),
            ("touches per object", ""),
            ("m", ""),
            ("noise", "%"),
        ];
        let expected = expected.map(|(title, unit)| (title.to_owned(), unit));
        assert_eq!(shown.collect::<Vec<_>>(), expected);
        assert_eq!(keys[3].column("n").scale, Scale::Share);
    }

    #[test]
    fn a_key_below_a_described_key_has_its_description() {
        let keys = ["a.b", "a.b_mm"];
        let keys = keys.map(|path| KeyAbout::new(path, AxisPlace::Axes, Role::Choice, Range::Any));
        let path = |path: &str| find(&keys, path).map(|key| key.path);
        assert_eq!(path("a.b"), Some("a.b"));
        assert_eq!(path("a.b_mm.within"), Some("a.b_mm"));
        assert_eq!((path("a"), path("a.bc")), (None, None));
    }
}
