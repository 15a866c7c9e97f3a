//! Page `report.html`: one HTML file with all results, which works without a network.
//!
//! The inputs are tables, charts as SVG, pictures, and the name and question of the study. The output is HTML with all charts and tables. The script adds
//! tooltips, hides series, and sorts, searches and saves tables.

mod frame;
mod study;
mod table;

pub use crate::report::study_folder::StudyAbout;
pub use frame::Section;
pub(crate) use frame::{definition, png_element, sentences_html};
pub(crate) use study::{Beside, page as study_page};
