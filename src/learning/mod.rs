//! Learning: labelled rows → classifiers and scores. Nothing here knows of touch.
//!
//! | room | in → out |
//! |---|---|
//! | [`data`] | labelled rows → checked data sets, splits, one scale |
//! | [`classifiers`] | training rows → trained classifiers of any kind |
//! | [`evaluation`] | predicted labels → confusion matrices, fused decisions, the next touch |

pub mod data;
pub mod evaluation;

pub use bubbletouch_svm::classifiers;
