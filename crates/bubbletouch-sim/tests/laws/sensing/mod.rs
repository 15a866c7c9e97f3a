//! Signals and sensing: noise, sensor errors, projections and reconstruction.

mod body_readout;
mod sensing_dictionaries;
mod sensing_projection;
mod sensing_reconstruction;
mod signal_allocation;
mod signal_chain;
mod signal_imperfections;
mod signal_layouts;
mod signal_limits;
