//! `ajar diff`: runs the comparison of `tools/ajar_tools`, which Ajar carries with it.

mod program;

use std::{
    ffi::OsString,
    io::{self, Write},
    process::{Command, ExitStatus, Stdio},
};

use ajar_scene::{Cause, Diagnostic};

use self::program::{PROGRAM, SPOKEN};
use super::Exit;

#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
#[command(override_usage = "ajar diff [OPTIONS] NEW.exr REFERENCE.exr")]
#[command(after_help = "Exit codes: 0 the same picture, 1 a different one, 2 they cannot be compared.")]
pub(super) struct Args {
    /// NEW.exr REFERENCE.exr and options; --help lists them
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        required = true,
        value_name = "NEW.exr REFERENCE.exr"
    )]
    arguments: Vec<OsString>,
}

pub(super) fn run(args: &Args) -> Exit {
    match compare(&args.arguments) {
        Ok(status) => match status.code().map(|code| code - i32::from(SPOKEN)) {
            Some(0) => Exit::Ok,
            Some(1) => Exit::Failed,
            Some(2) => Exit::Usage,
            _ => {
                eprintln!("error: its Python ended without a verdict ({status})");
                Exit::Usage
            }
        },
        Err(problem) => {
            eprintln!("{problem}");
            Exit::Usage
        }
    }
}

fn compare(arguments: &[OsString]) -> Result<ExitStatus, Diagnostic> {
    let (mut command, input) = PROGRAM.command()?;
    command.args(arguments).stdin(Stdio::piped());
    run_with(&mut command, &input).map_err(|error| {
        let python = command.get_program().display();
        Diagnostic::error(format!("{python} cannot be run: {error}")).because(Cause::System)
    })
}

fn run_with(command: &mut Command, input: &[u8]) -> io::Result<ExitStatus> {
    let mut child = command.spawn()?;
    // One that ends early says why itself.
    let _ = child.stdin.take().map(|mut pipe| pipe.write_all(input));
    child.wait()
}
