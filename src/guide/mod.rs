//! The chapters of `guide/` in three groups: how to use the program, what its terms mean, and how it was verified.

#[doc = include_str!("../../guide/first_study.md")]
pub mod first_study {}

#[doc = include_str!("../../guide/study_file.md")]
pub mod study_file {}

#[doc = include_str!("../../guide/reference.md")]
pub mod reference {}

#[doc = include_str!("../../guide/tables.md")]
pub mod tables {}

#[doc = include_str!("../../guide/objects.md")]
pub mod objects {}

#[doc = include_str!("../../guide/recorded_frames.md")]
pub mod recorded_frames {}

#[doc = include_str!("../../guide/own_methods.md")]
pub mod own_methods {}

#[doc = include_str!("../../guide/audit.md")]
pub mod audit {}

#[doc = include_str!("../../guide/scenes.md")]
pub mod scenes {}

#[doc = include_str!("../../guide/other_studies.md")]
pub mod other_studies {}

#[doc = include_str!("../../guide/whole_body.md")]
pub mod whole_body {}

#[doc = include_str!("../../guide/long_runs.md")]
pub mod long_runs {}

#[doc = include_str!("../../guide/adding.md")]
pub mod adding {}

#[doc = include_str!("../../guide/events.md")]
pub mod events {}

#[doc = include_str!("../../guide/limits.md")]
pub mod limits {}

#[doc = include_str!("../../guide/architecture.md")]
pub mod architecture {}

#[doc = include_str!("../../guide/statistics.md")]
pub mod statistics {}

#[doc = include_str!("../../guide/one_touch.md")]
pub mod one_touch {}

#[doc = include_str!("../../guide/sensor_errors.md")]
pub mod sensor_errors {}

#[doc = include_str!("../../guide/where_methods_fail.md")]
pub mod where_methods_fail {}

#[doc = include_str!("../../guide/benchmarks.md")]
pub mod benchmarks {}

#[doc = include_str!("../../guide/experiments.md")]
pub mod experiments {}
