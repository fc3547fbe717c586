//! Light paths: vertices, edges, walks, connections, and the densities of every way to build a path.
//!
//! A path is written from light to eye, `x_0 … x_k`. There is one definition of its contribution f(x), whichever end it
//! was built from: the product of emission, `Vertex::evaluate` and geometric terms. One sweep over the path gives the
//! density of all techniques ([`sweep`]); multiple importance sampling reads nothing else.

mod edge;
mod scatter;
mod subpath;
pub mod sweep;
mod vertex;

pub use edge::Edge;
pub use scatter::{ROULETTE_DEPTH, Step, oriented, survival};
pub use subpath::{Stop, Subpath};
pub use vertex::{DiracStep, Kind, MIN_COSINE, Site, Vertex};
