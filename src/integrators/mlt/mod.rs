//! Metropolis light transport (Veach & Guibas 1997), seeded by bidirectional path tracing without start-up bias.

pub mod chain;
pub mod choice;
mod direct;
pub mod mutation;
pub mod mutations;
pub mod path;
mod perturb;
pub mod plain;
pub mod proposal;
pub mod seeds;
pub mod stats;
pub mod target;

pub use mutation::{Aux, Mutation, Reject};
pub use plain::Mlt;
