//! The program as users and scripts see it: files, exit codes, messages.

#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod bench;
mod commands;
mod convert;
mod diff;
mod exits;
mod images;
mod messages;
#[cfg(unix)]
mod plugins;
mod resume;
mod set;
#[cfg(unix)]
mod signals;
#[cfg(unix)]
mod usd_environment;
#[cfg(unix)]
mod watch;
