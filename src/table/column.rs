//! What a column of a table is: its name, words, unit, scale and role.

use super::value::Value;
use bubbletouch_sim::text::numbers::{short_number, time_words};
use std::borrow::Cow;

/// A text that is mostly written in the program, and made where a study names its own axes.
pub type Words = Cow<'static, str>;

/// What a column is to whoever reads the table. The role is the only thing that report, page, advice and comparison look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A designer decides it: pitch, ensemble, C. Advice and every "best" choose among these, within a condition.
    Choice,
    /// The world sets it: noise, sensor errors, friction. It is given, never advised.
    Condition,
    /// What is looked at: an object, a trial, a touch.
    Subject,
    /// What was found, and which is better.
    Value(Better),
    /// What it takes: time, memory, spheres. Less is better.
    Cost,
    /// How it ended: right, diverged, refused.
    Outcome,
    /// It says how to read the others, counts, or bounds a value.
    Note,
}

/// Which of two values is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// The larger.
    More,
    /// The smaller.
    Less,
    /// Neither.
    Neither,
}

/// How the values of a column lie along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// They are words, in the order of their first rows.
    Words,
    /// Numbers, evenly.
    Linear,
    /// Numbers by their logarithm; where zero is among them, it stands apart at the beginning.
    Log,
    /// Shares of one, shown as percent or from 0 to 1; evenly.
    Share,
}

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name in the file: `pitch_mm`.
    pub name: Words,
    /// What people call it, without unit: `taxel pitch`.
    pub words: Words,
    /// Of its numbers: `mm`; empty without. Numbers of unit `%` are shares of one, shown times 100; those of unit `:1` are ratios; times
    /// (`s`, `ms`, `us`) are said in the unit that suits them where they span decades.
    pub unit: Words,
    /// How it lies along an axis.
    pub scale: Scale,
    /// What it is.
    pub role: Role,
    /// The columns that bound it, lower and upper: of a value with an interval.
    pub interval: Option<[Words; 2]>,
    /// What people call its words, where these are codes: `rbf_svm`, `RBF SVM`. Of others, underscores are spaces. Of numbers, those that
    /// are more than numbers: `0` bits, `none`.
    pub names: &'static [(&'static str, &'static str)],
    /// Whether it may be missing from a file: only some studies have it.
    pub is_optional: bool,
}

impl Column {
    /// One that every study of its kind has.
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
            is_optional: false,
        }
    }

    /// The same, bounded by two other columns.
    pub fn between(mut self, low: impl Into<Words>, high: impl Into<Words>) -> Self {
        self.interval = Some([low.into(), high.into()]);
        self
    }

    /// The same, that only some studies have.
    pub fn optional(mut self) -> Self {
        self.is_optional = true;
        self
    }

    /// The same, with what people call its words.
    pub fn named(mut self, names: &'static [(&'static str, &'static str)]) -> Self {
        self.names = names;
        self
    }

    /// The title of an axis: `taxel pitch (mm)`.
    pub fn title(&self) -> String {
        match (self.unit.as_ref(), self.is_time()) {
            ("" | ":1", _) | (_, true) => self.words.to_string(),
            (unit, false) => format!("{} ({unit})", self.words),
        }
    }

    /// Whether it has numbers that are more than numbers: between these and others there is nothing.
    pub fn has_named_numbers(&self) -> bool {
        self.scale != Scale::Words && self.names.iter().any(|(code, _)| !code.is_empty())
    }

    /// The name of one of its codes, or of one of its numbers.
    fn name_of(&self, code: &str) -> Option<&'static str> {
        let mut names = self.names.iter();
        names.find_map(|(known, name)| (*known == code).then_some(*name))
    }

    /// Whether its numbers are times over decades.
    fn is_time(&self) -> bool {
        self.scale == Scale::Log && matches!(self.unit.as_ref(), "s" | "ms" | "us" | "µs")
    }

    /// A number without its unit: `10`, `64:1`, `20 µs`.
    pub fn tick(&self, number: f64) -> String {
        if let Some(name) = self.name_of(&short_number(number)) {
            return name.to_owned();
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

    /// A number with its unit: `10 %`, `64:1`.
    pub fn number_words(&self, number: f64) -> String {
        let tick = self.tick(number);
        match self.unit.as_ref() {
            "" | ":1" => tick,
            _ if self.is_time() || self.name_of(&short_number(number)).is_some() => tick,
            "bits" if number == 1.0 => format!("{tick} bit"),
            unit => format!("{tick} {unit}"),
        }
    }

    /// What people call one of its words.
    pub fn word(&self, code: &str) -> String {
        let name = self.name_of(code);
        name.map_or_else(|| code.replace('_', " "), str::to_owned)
    }

    /// A value for a sentence: `10 %`, `RBF SVM`.
    pub fn value_words(&self, value: &Value) -> String {
        match value {
            Value::Number(number) => self.number_words(*number),
            Value::Word(code) => self.word(code),
        }
    }

    /// Name and value: `noise 10 %`, `m = 64`.
    pub fn phrase(&self, value: &Value) -> String {
        let is_symbol = self.words.chars().count() == 1;
        let between = if is_symbol { " = " } else { " " };
        format!("{}{between}{}", self.words, self.value_words(value))
    }
}

/// A row whose fields are columns, in their order.
pub trait Columns {
    /// All columns, those included that only some studies have.
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

/// A column as people may write it: `noise` stands for `noise_std`.
pub fn column_name(key: &str) -> &str {
    match key {
        "noise" => "noise_std",
        other => other,
    }
}
