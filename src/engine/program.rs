//! The program that computes results.

/// Program and version.
pub const PROGRAM: &str = concat!("bubbletouch ", env!("CARGO_PKG_VERSION"));

/// Hash of the sources that the program was built from: equal hashes, equal results.
pub const SOURCE: &str = env!("BUBBLETOUCH_SOURCE");
