//! Tests of the energy of free objects.

mod mesh_laws;
pub(super) mod tilted_bed;
