//! Description of a table column: name, display name, unit, scale and role.

use super::Value;
use bubbletouch_sim::text::numbers::{short_number, time_words};
use std::borrow::Cow;

/// Text that is constant, or created at run time for the axes that a study defines.
pub type Words = Cow<'static, str>;

/// Role of a table column, such as choice, condition, value or cost. Reports, pages, advice and comparisons depend only on roles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Choice of the designer, such as pitch, ensemble or C. For each condition, advice selects the best choices.
    Choice,
    /// Condition of the world that the designer cannot choose, such as noise, sensor errors or friction. Advice is given for each condition.
    Condition,
    /// Subject of a measurement, such as an object, a trial or a touch.
    Subject,
    /// Measured result. The content states whether larger or smaller values are better.
    Value(Better),
    /// Cost of a choice, such as time, memory or number of spheres. Smaller values are better.
    Cost,
    /// Outcome of a row as a text, such as right, diverged or refused.
    Outcome,
    /// Auxiliary column, such as a count, a bound of an interval, or a note.
    Note,
}

/// Direction in which a measured value is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// Larger values are better.
    More,
    /// Smaller values are better.
    Less,
    /// No direction is better.
    Neither,
}

/// Scale on which the values of a column are drawn along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Texts, ordered by their first occurrence.
    Words,
    /// Numbers on a linear scale.
    Linear,
    /// Numbers on a logarithmic scale. Zero has a separate place at the start of the axis.
    Log,
    /// Fractions on a linear scale, shown as percent or as numbers from 0 to 1.
    Share,
}

/// Description of a table column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the column in the CSV header, such as `pitch_mm`.
    pub name: Words,
    /// Display name in text and charts, without unit, such as `taxel pitch`.
    pub words: Words,
    /// Unit of the numbers, such as `mm`; empty if there is none. Fractions of one with the unit `%` are shown times 100. The unit `:1` marks ratios. Times
    /// (`s`, `ms`, `us`) on a logarithmic scale are shown in the unit that suits each value.
    pub unit: Words,
    /// Scale on which charts draw the values along an axis.
    pub scale: Scale,
    /// Role of the column in reports and advice.
    pub role: Role,
    /// Names of the columns that contain the lower and upper end of the value's interval; `None` for a value without an interval.
    pub interval: Option<[Words; 2]>,
    /// Display names of codes, such as `RBF SVM` for `rbf_svm`. In other words, underscores are shown as spaces. Numbers with a special meaning can also have
    /// names, such as `none` for `0` bits.
    pub names: &'static [(&'static str, &'static str)],
    /// Meaning of the values in one sentence, for the reference page of all tables.
    pub meaning: Words,
    /// Whether the column may be missing in a file, because only some studies have it.
    pub is_optional: bool,
    /// Rank of a setting among the settings that charts omit if other settings determine them. The smallest rank is omitted first; `None` is omitted last. Of
    /// equal ranks, the setting with more values is omitted first.
    pub gives_way: Option<u8>,
}

impl Column {
    /// Creates a column that exists in every study of its kind.
    pub fn new(
        name: impl Into<Words>,
        role: Role,
        words: impl Into<Words>,
        unit: impl Into<Words>,
        scale: Scale,
    ) -> Self {
        Self {
            name: name.into(),
            words: words.into(),
            unit: unit.into(),
            scale,
            role,
            interval: None,
            names: &[],
            meaning: Words::default(),
            is_optional: false,
            gives_way: None,
        }
    }

    /// Sets the names of the columns that contain the lower and upper end of the value's interval.
    pub fn between(mut self, low: impl Into<Words>, high: impl Into<Words>) -> Self {
        self.interval = Some([low.into(), high.into()]);
        self
    }

    /// Sets the meaning of the values, which the reference page of all tables shows.
    pub fn meaning(mut self, meaning: impl Into<Words>) -> Self {
        self.meaning = meaning.into();
        self
    }

    /// Marks the column as optional, because only some studies have it.
    pub fn optional(mut self) -> Self {
        self.is_optional = true;
        self
    }

    /// Sets the display names of the column's codes.
    pub fn named(mut self, names: &'static [(&'static str, &'static str)]) -> Self {
        self.names = names;
        self
    }

    /// Returns the title of the column with its unit, such as `taxel pitch (mm)`.
    pub fn title(&self) -> String {
        match (self.unit.as_ref(), self.is_time()) {
            ("" | ":1", _) | (_, true) => self.words.to_string(),
            (unit, false) => format!("{} ({unit})", self.words),
        }
    }

    /// Returns whether the column has display names for some numbers. A chart does not join the points of named numbers by lines.
    pub fn has_named_numbers(&self) -> bool {
        self.scale != Scale::Words && self.names.iter().any(|(code, _)| !code.is_empty())
    }

    /// Returns the display name of a code or a number; `None` if it has no name.
    fn name_of(&self, code: &str) -> Option<&'static str> {
        let mut names = self.names.iter();
        names.find_map(|(known, name)| (*known == code).then_some(*name))
    }

    /// Returns whether a number of the column has a name, such as `none` for 0 bits. Such a number has no position between other numbers.
    pub fn is_named(&self, number: f64) -> bool {
        self.name_of(&short_number(number)).is_some()
    }

    /// Returns whether the numbers of the column are times on a logarithmic scale.
    fn is_time(&self) -> bool {
        self.scale == Scale::Log && matches!(self.unit.as_ref(), "s" | "ms" | "us" | "µs")
    }

    /// Formats a number of the column for an axis tick, such as `10`, `64:1` or `20 µs`.
    pub fn tick(&self, number: f64) -> String {
        if let Some(name) = self.name_of(&short_number(number)) {
            return name.to_owned();
        }
        if matches!(&self.name[..], "p_value" | "p_holm") && number < 0.001 {
            return "< 0.001".to_owned();
        }
        match self.unit.as_ref() {
            // 100 × 0.07 is not 7 in floating point.
            "%" => short_number((number * 1e8).round() / 1e6),
            ":1" => format!("{}:1", short_number(number)),
            "s" if self.is_time() => time_words(number),
            "ms" if self.is_time() => time_words(1e-3 * number),
            "us" | "µs" if self.is_time() => time_words(1e-6 * number),
            _ => short_number(number),
        }
    }

    /// Formats a number of the column with its unit, such as `10 %` or `64:1`.
    pub fn number_words(&self, number: f64) -> String {
        let tick = self.tick(number);
        match self.unit.as_ref() {
            "" | ":1" => tick,
            _ if self.is_time() || self.is_named(number) => tick,
            "bits" if number == 1.0 => format!("{tick} bit"),
            unit => format!("{tick} {unit}"),
        }
    }

    /// Returns the display name of a text that the column contains; a file of an array has its name without the ending.
    pub fn word(&self, code: &str) -> String {
        let name = self.name_of(code);
        let code = code.strip_suffix(".npy").unwrap_or(code);
        name.map_or_else(|| code.replace('_', " "), str::to_owned)
    }

    /// Formats a value of the column for a sentence, such as `10 %` or `RBF SVM`.
    pub fn value_words(&self, value: &Value) -> String {
        match value {
            Value::Number(number) => self.number_words(*number),
            Value::Word(code) => self.word(code),
        }
    }

    /// Returns a value with the column's display name, such as `noise 10 %` or `m = 64`.
    pub fn phrase(&self, value: &Value) -> String {
        let is_symbol = self.words.chars().count() == 1;
        let between = if is_symbol { " = " } else { " " };
        format!("{}{between}{}", self.words, self.value_words(value))
    }
}

/// Type of table rows whose fields are the columns of the table, in their order.
pub trait Columns {
    /// Returns the columns of the table in order, including the optional columns.
    fn columns() -> Vec<Column>;
}

impl<A: Columns, B: Columns> Columns for (A, B) {
    fn columns() -> Vec<Column> {
        [A::columns(), B::columns()].concat()
    }
}

impl<A: Columns, B: Columns, C: Columns> Columns for (A, B, C) {
    fn columns() -> Vec<Column> {
        [A::columns(), B::columns(), C::columns()].concat()
    }
}

/// Returns the name of the column that belongs to a key of a study file; the key `noise` has the column `noise_std`.
pub fn column_name(key: &str) -> &str {
    match key {
        "noise" => "noise_std",
        other => other,
    }
}
