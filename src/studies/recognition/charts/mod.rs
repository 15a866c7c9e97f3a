//! Charts, answers and further page sections of a recognition study.

pub(crate) mod answers;
pub(crate) mod chance;
pub(crate) mod filled;
pub(crate) mod robustness;
pub(crate) mod sections;
pub(crate) mod table_charts;
pub(crate) mod tables;

pub use crate::studies::recognition::charts::answers::{answers, words};
pub use crate::studies::recognition::charts::sections::sections;
pub use crate::studies::recognition::charts::table_charts::charts;
pub use crate::studies::recognition::charts::tables::{
    CONFIGURATIONS, TABLES, TABLES_OF_PARTS, read_tables, tables_of,
};
