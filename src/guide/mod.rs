//! The chapters of `guide/` in three groups: how to use the program, what its terms mean, and how it was verified.

/// Declares an empty module for each chapter, documented by the file of its name in `guide/`.
macro_rules! chapters {
    ($($name:ident),* $(,)?) => {
        $(
            #[doc = include_str!(concat!("../../guide/", stringify!($name), ".md"))]
            pub mod $name {}
        )*
    };
}

chapters! {
    first_study,
    study_file,
    reference,
    tables,
    objects,
    recorded_frames,
    own_methods,
    audit,
    scenes,
    other_studies,
    whole_body,
    long_runs,
    adding,
    events,
    limits,
    architecture,
    statistics,
    one_touch,
    sensor_errors,
    where_methods_fail,
    benchmarks,
    experiments,
}
