//! Recognition: SVMs against LIBSVM and optimality conditions, splits, classifiers.

#[path = "../fixtures/svm_conditions/mod.rs"]
mod svm_conditions;

mod classifier;
mod engine;
mod hard_cases;
mod inseparable;
mod kinds;
mod libsvm;
mod limits;
mod linear;
mod next_touch;
mod splits;
mod svm;
