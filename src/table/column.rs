//! What a column of a table is: its name, words, unit, scale and role.

use serde::Serialize;
use std::borrow::Cow;

/// A text that is mostly written in the program, and made where a study names its own axes.
pub type Words = Cow<'static, str>;

/// What a column is to whoever reads the table. The role is the only thing that report, page, advice and comparison look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Better {
    /// The larger.
    More,
    /// The smaller.
    Less,
    /// Neither.
    Neither,
}

/// How the values of a column lie along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
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
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Its name in the file: `pitch_mm`.
    pub name: Words,
    /// What people call it, without unit: `taxel pitch`.
    pub words: Words,
    /// Of its numbers: `mm`; empty without.
    pub unit: Words,
    /// How it lies along an axis.
    pub scale: Scale,
    /// What it is.
    pub role: Role,
    /// The columns that bound it, lower and upper: of a value with an interval.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<[Words; 2]>,
    /// Whether it may be missing from a file: only some studies have it.
    #[serde(skip)]
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

    /// The title of an axis: `taxel pitch (mm)`.
    pub fn title(&self) -> String {
        match self.unit.is_empty() {
            true => self.words.to_string(),
            false => format!("{} ({})", self.words, self.unit),
        }
    }
}

/// A row whose fields are columns, in their order.
pub trait Columns {
    /// All columns, those included that only some studies have.
    fn columns() -> Vec<Column>;
}

impl<A: Columns, B: Columns> Columns for (A, B) {
    fn columns() -> Vec<Column> {
        let mut columns = A::columns();
        columns.extend(B::columns());
        columns
    }
}

impl<A: Columns, B: Columns, C: Columns> Columns for (A, B, C) {
    fn columns() -> Vec<Column> {
        let mut columns = <(A, B)>::columns();
        columns.extend(C::columns());
        columns
    }
}
