//! How light is gathered into an image.
//!
//! An [`Integrator`] advances in *rounds*. A round is a pure function of world, settings, seed and round index; it writes
//! no file and prints nothing. Each is an unbiased image and none knows the others, so any split of the round numbers over
//! threads or machines gives the same image, and their spread tells the error of their mean ([`stats`]): of independent
//! rounds the error itself, of rounds that share the sequence of a pixel more than it.

pub mod bdpt;
pub mod features;
mod integrator;
pub mod mlt;
pub mod path;
mod pilot;
pub mod stats;
pub mod stop;

pub use integrator::{Context, Integrator, Metropolis, Report, Rounds, Settings, Window, integrators};
pub use pilot::brightness;
