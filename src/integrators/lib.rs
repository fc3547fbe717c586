//! How light is gathered into an image.
//!
//! An [`Integrator`] advances in *rounds*. A round is a pure function of world, settings, seed and round index; it writes
//! no file and prints nothing. Rounds are independent, so their spread is the error of their mean ([`stats`]), and any
//! split of the round numbers over threads or machines gives the same image.

pub mod bdpt;
pub mod features;
mod integrator;
pub mod mlt;
pub mod path;
mod pilot;
pub mod stats;
pub mod stop;

pub use integrator::{Context, Integrator, Report, Rounds, Settings, Window, integrators};
pub use pilot::brightness;
