//! Contact: a patch, an object and a pose → deflections.
