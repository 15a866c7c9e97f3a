//! Guide: pages about what no single item explains.

#[doc = include_str!("statistics.md")]
pub mod statistics {}

#[doc = include_str!("memory_and_disk.md")]
pub mod memory_and_disk {}

#[doc = include_str!("events.md")]
pub mod events {}

#[doc = include_str!("limits.md")]
pub mod limits {}

#[doc = include_str!("own_objects.md")]
pub mod own_objects {}

#[doc = include_str!("many_machines.md")]
pub mod many_machines {}
