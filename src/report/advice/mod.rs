//! Advice from a result table, based on the roles of its columns.
//!
//! For each condition, the advised row is the cheapest choice whose value meets a bound, or the best choice within a budget.

mod candidate_texts;
mod candidates;
mod column_selector;
mod given_condition;

pub use candidates::{Advice, AdviceQuery, Candidate, Candidates, Requirement};
