//! What a study of recognition shows of its tables: charts, sentences, and what its page has beside those of any study.

mod answers;
mod charts;
mod sections;
mod tables;

pub use answers::{answers, words};
pub use charts::charts;
pub use sections::sections;
pub use tables::{CELLS, read_tables, tables_of};
