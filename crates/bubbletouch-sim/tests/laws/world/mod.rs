//! Placement, robots and whole bodies.

mod placement_rest;
mod placement_touches;
mod robot_mjcf;
mod robot_motion;
mod robot_public_files;
mod robot_urdf;
mod whole_body_laws;
mod whole_body_variants;
