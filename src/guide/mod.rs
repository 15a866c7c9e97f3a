//! Guide: the chapters of `guide/`, in the order of a reader.

#[doc = include_str!("../../guide/first_study.md")]
pub mod first_study {}

#[doc = include_str!("../../guide/study_file.md")]
pub mod study_file {}

#[doc = include_str!("../../guide/one_touch.md")]
pub mod one_touch {}

#[doc = include_str!("../../guide/sensor_errors.md")]
pub mod sensor_errors {}

#[doc = include_str!("../../guide/human_touch.md")]
pub mod human_touch {}

#[doc = include_str!("../../guide/reconstruction.md")]
pub mod reconstruction {}

#[doc = include_str!("../../guide/recorded_frames.md")]
pub mod recorded_frames {}

#[doc = include_str!("../../guide/scenes.md")]
pub mod scenes {}

#[doc = include_str!("../../guide/whole_body.md")]
pub mod whole_body {}

#[doc = include_str!("../../guide/objects_and_meshes.md")]
pub mod objects_and_meshes {}

#[doc = include_str!("../../guide/own_objects.md")]
pub mod own_objects {}

#[doc = include_str!("../../guide/long_runs.md")]
pub mod long_runs {}

#[doc = include_str!("../../guide/many_machines.md")]
pub mod many_machines {}

#[doc = include_str!("../../guide/memory_and_disk.md")]
pub mod memory_and_disk {}

#[doc = include_str!("../../guide/events.md")]
pub mod events {}

#[doc = include_str!("../../guide/statistics.md")]
pub mod statistics {}

#[doc = include_str!("../../guide/accuracy_and_time.md")]
pub mod accuracy_and_time {}

#[doc = include_str!("../../guide/where_methods_fail.md")]
pub mod where_methods_fail {}

#[doc = include_str!("../../guide/limits.md")]
pub mod limits {}

#[doc = include_str!("../../guide/benchmarks.md")]
pub mod benchmarks {}

#[doc = include_str!("../../guide/experiments.md")]
pub mod experiments {}

#[doc = include_str!("../../guide/architecture.md")]
pub mod architecture {}

#[doc = include_str!("../../guide/adding.md")]
pub mod adding {}
