//! The folder of a study of speed against accuracy: tables → points → charts.
//!
//! [`points`] makes a point of every setting; `pareto.csv` holds them all, and which are on a front. A chart numbers the points on its front
//! and names them below.

mod chart;
mod points;
mod results;
mod words;

pub use chart::draw_front_chart;
pub use points::{ChartKind, ChartPoint, points};
pub(super) use results::CHAINS_FILE;
pub use results::{PARETO_FILE, speed_accuracy_folder, speed_accuracy_summary};
pub(super) use words::chain_setting;
