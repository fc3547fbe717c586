//! The program as users and scripts see it: files, exit codes, messages.

mod bench;
mod commands;
mod exits;
mod images;
