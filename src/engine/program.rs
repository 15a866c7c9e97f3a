//! Identity of the program that computes results.

/// Name and version of the program.
pub const PROGRAM: &str = concat!("bubbletouch ", env!("CARGO_PKG_VERSION"));

/// Hash of the source code from which the program was built. Programs with equal hashes compute equal results.
pub const SOURCE: &str = env!("BUBBLETOUCH_SOURCE");
