//! The mutations, one a file.

mod bidirectional;
mod caustic;
mod eye_chain;
mod inversion;

pub use bidirectional::Bidirectional;
pub use caustic::Caustic;
pub use eye_chain::{Lens, MultiChain};
pub use inversion::{Technique, Window};
