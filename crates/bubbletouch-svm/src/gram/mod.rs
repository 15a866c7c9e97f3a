//! Kernel values between rows, each computed once for all problems that need it.

pub(crate) mod between;
pub(crate) mod extent;
pub(crate) mod points;
pub(crate) mod product_kernel;
pub(crate) mod sorted;
