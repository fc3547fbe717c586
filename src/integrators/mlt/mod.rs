//! Metropolis light transport (Veach & Guibas 1997), seeded by bidirectional path tracing without start-up bias.

pub mod base;
pub mod chain;
pub mod chains;
pub mod choice;
mod direct;
mod estimator;
mod first_look;
mod gain;
pub mod lens_subpaths;
pub mod manifold;
pub mod mutation;
pub mod mutations;
pub mod path;
mod perturb;
mod pilot;
pub mod plain;
pub mod proposal;
pub mod seeds;
mod smooth;
pub mod stats;
pub mod target;

pub use estimator::Ajar;
pub use mutation::{Aux, Mutation, Reject};
pub use plain::Mlt;
