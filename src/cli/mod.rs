//! The command line: one file a command. Exit codes as in [`Exit`].

mod arguments;
mod exit;
mod formats;
mod inspect;
mod progress;
mod render;
mod signals;
mod validate;

use std::{
    cmp::Reverse,
    io::{IsTerminal, Write},
    process::ExitCode,
};

use ajar_scene::{Diagnostic, Severity};
use clap::{Parser, Subcommand};

pub use exit::Exit;

/// What the help of every command ends with.
const EXIT_CODES: &str = "Exit codes: 0 ok, 1 render failed, 2 usage, 3 asset or scene invalid,\n\
    4 resource limit, 5 interrupted with a partial result saved.";

/// A renderer for asset pipelines: glTF, OBJ and scene.toml to OpenEXR.
#[derive(Debug, Parser)]
#[command(name = "ajar", version, max_term_width = 100, propagate_version = true)]
#[command(after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene or asset to an OpenEXR image and a PNG preview
    Render(Box<render::Args>),
    /// Show what a file holds: hierarchy, counts, materials, lights, cameras, textures, warnings
    Inspect(inspect::Args),
    /// Check that a file is fit to render, without rendering
    Validate(validate::Args),
    /// List the file formats that can be read, and what of each is supported
    Formats(formats::Args),
}

/// Runs the program on its arguments.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Nobody reads the message if the pipe is closed.
            let _ = error.print();
            return if error.use_stderr() { Exit::Usage.into() } else { Exit::Ok.into() };
        }
    };
    let exit = match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Validate(args) => validate::run(&args),
        Command::Formats(args) => formats::run(&args),
    };
    exit.into()
}

/// Prints the result of a command.
fn print(text: &str) {
    // Nobody reads it if the pipe is closed.
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Messages shown at most: a broken file can cause one a line.
const MOST_MESSAGES: usize = 100;

/// Prints messages for people, those of `least` severity or worse. Where there are too many, the worst are kept.
fn print_diagnostics(diagnostics: &[Diagnostic], least: Severity) {
    let mut shown: Vec<_> = diagnostics.iter().filter(|d| d.severity >= least).collect();
    if shown.len() > MOST_MESSAGES {
        shown.sort_by_key(|d| Reverse(d.severity));
    }
    let mut text: String = shown.iter().take(MOST_MESSAGES).map(|d| format!("{d}\n")).collect();
    if shown.len() > MOST_MESSAGES {
        text.push_str(&format!("… and {} more messages\n", shown.len() - MOST_MESSAGES));
    }
    // As above.
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// Whether progress may redraw its line.
fn interactive() -> bool {
    std::io::stderr().is_terminal()
}
