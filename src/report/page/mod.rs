//! Page `report.html`: one HTML file with all results, which works without a network.
//!
//! The inputs are tables, charts as SVG, pictures, and the name and question of the study. The output is HTML with all charts and tables. The script adds
//! tooltips, hides series, and sorts, searches and saves tables.

mod about;
mod choices;
mod frame;
mod picture;
mod provenance;
mod study;
mod table;

pub use about::StudyAbout;
pub use frame::Section;
pub(crate) use frame::definition;
pub(crate) use picture::png_element;
pub(crate) use study::{Beside, page as study_page};
