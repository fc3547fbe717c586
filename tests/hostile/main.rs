//! Files that are broken or mean harm: each must be refused with a message, or read with warnings, in little time and
//! memory, and never by a panic.

#![allow(clippy::unwrap_used, reason = "a failing test panics; a skipped one says so")]

mod ajar;
mod corpus;
mod damaged;
mod gltf;
mod images;
mod jail;
#[cfg(unix)]
mod links;
mod obj;
#[cfg(unix)]
mod plug_in;
mod scene_file;
#[cfg(target_os = "linux")]
mod traced;
mod usd;
