//! `ajar diff`: hands over to `ajar-compare`, the Python package in `tools/`, which has OpenImageIO.

use std::{ffi::OsString, io::ErrorKind, process::Command};

use ajar_scene::Diagnostic;

use super::Exit;

/// The program that compares.
const PROGRAM: &str = "ajar-compare";

#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
#[command(after_help = "Exit codes: 0 the same picture, 1 a different one, 2 they cannot be compared.")]
pub(super) struct Args {
    /// NEW.exr REFERENCE.exr and options; --help lists them
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, required = true, value_name = "ARGUMENTS")]
    arguments: Vec<OsString>,
}

pub(super) fn run(args: &Args) -> Exit {
    match Command::new(PROGRAM).args(&args.arguments).status() {
        Ok(status) => match status.code() {
            Some(0) => Exit::Ok,
            Some(1) => Exit::Failed,
            _ => Exit::Usage,
        },
        Err(error) => {
            let mut message = Diagnostic::error(format!("{PROGRAM} cannot be started: {error}"));
            if error.kind() == ErrorKind::NotFound {
                message = message.hint("pip install ./tools, in a copy of Ajar's source");
            }
            eprintln!("{message}");
            Exit::Usage
        }
    }
}
