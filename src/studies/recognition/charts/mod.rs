//! Charts, answers and further page sections of a recognition study.

pub(crate) mod answers;
pub(crate) mod sections;
pub(crate) mod table_charts;

pub use crate::studies::recognition::charts::answers::{answers, words};
pub use crate::studies::recognition::charts::sections::sections;
pub use crate::studies::recognition::charts::table_charts::charts;
pub use crate::studies::recognition::tables::table_files::{
    CONFIGURATIONS, TABLES, TABLES_OF_PARTS, read_tables, tables_of,
};
