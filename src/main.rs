//! The `ajar` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    ajar::cli::run()
}
