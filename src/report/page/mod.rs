//! `report.html`: one page with everything in it, that needs no network.
//!
//! In: tables, pictures, and what a study says of itself. Out: HTML. The numbers of a study of recognition are in the page once, as
//! JSON; a script draws from it charts that can be asked, filtered and arranged. Without script, pictures and tables that do not
//! move stand in their places.

mod about;
mod data;
mod frame;
mod picture;
mod provenance;
mod study;
mod touches;

pub use about::StudyAbout;
pub use frame::Section;
pub(super) use frame::definition;
pub(super) use study::{Beside, page as study_page};
pub(super) use touches::touches_html;
