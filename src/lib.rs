//! The program: from the command line to files. The rooms below it are libraries: `ajar-scene`, `ajar-importers`,
//! `ajar-render`, `ajar-integrators`, `ajar-output`.

pub mod checkpoint;
pub mod cli;
pub mod image;
mod kept;
pub mod merge;
pub mod plan;
pub mod session;
pub mod shard;
mod viewer;
pub mod watch;
mod words;
