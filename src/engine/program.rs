//! Identity of the program that computed the results.

/// Name and version of this program, such as `bubbletouch 0.1.0`.
pub const PROGRAM: &str = concat!("bubbletouch ", env!("CARGO_PKG_VERSION"));

/// Hash of the source code of this program. Programs with equal hashes compute equal results.
pub const SOURCE: &str = env!("BUBBLETOUCH_SOURCE");
