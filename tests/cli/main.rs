//! The program as users and scripts see it: files, exit codes, messages.

#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod bench;
mod commands;
mod exits;
mod images;
mod messages;
mod resume;
mod set;
#[cfg(unix)]
mod signals;
