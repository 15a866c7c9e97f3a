//! Options that several subcommands share.

pub(crate) mod classifier_parameters;
pub(crate) mod recorded_args;
pub(crate) mod results_folder;
pub(crate) mod study_args;
pub(crate) mod study_run;
pub(crate) mod unused;
pub(crate) mod which_object;
