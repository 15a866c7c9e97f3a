//! Laws of recognition studies, checked on generated studies. `BUBBLETOUCH_GENERATED_STUDIES` sets the number of studies per law.

mod alone_or_swept;
mod changed_keys;
mod charts;
mod edits;
mod exported_rows;
mod folders;
pub mod generator;
mod leaks;
mod order;
mod outcome;
pub mod recorded;
mod repeated;
