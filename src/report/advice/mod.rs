//! Advice from a result table, based on the roles of its columns.
//!
//! For each condition, the advised row is the cheapest choice whose value meets a bound, or the best choice within a budget.

mod answers;
mod candidates;
mod query;

pub use answers::{Answer, answers, answers_json};
pub use candidates::{Advice, Candidate, Candidates, Requirement};
pub use query::AdviceQuery;
