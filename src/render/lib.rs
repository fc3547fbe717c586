//! What light can meet and how to sample it.
//!
//! A [`World`] is prepared from a scene once and then only read, by any number of threads: geometry, materials, lights
//! and camera. On top of it [`path`] defines what a light path is and what it contributes; integrators decide which paths
//! to build. All randomness comes from [`rng`] and [`sampler`], keyed by what a number is for, so that nothing depends on
//! threads or time.

pub mod bsdf;
pub mod bvh;
pub mod camera;
#[cfg(test)]
mod chi2;
pub mod distribution;
pub mod environment;
pub mod film;
pub mod light;
pub mod material;
pub mod math;
pub mod path;
pub mod ray;
pub mod rng;
pub mod sampler;
pub mod tangents;
pub mod texture;
pub mod warp;
pub mod world;

pub use world::World;
