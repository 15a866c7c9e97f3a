//! Laws of support vector machines: optimality conditions, agreement with LIBSVM, and the choice of C and γ.

mod drawn;
mod engine;
mod every_classifier;
mod foreign;
mod inseparable;
mod libsvm;
mod limits;
mod linear;
#[cfg(feature = "linfa-svm")]
mod linfa;
mod linfa_svm;
mod pipelines;
mod probabilities;
mod svm;
mod svm_conditions;
