//! The command line: one file a command. Exit codes as in [`Exit`].

mod after;
mod appearance;
mod arguments;
mod block;
mod checkpoints;
mod convert;
mod demand;
mod diff;
mod exit;
mod formats;
mod frames;
mod input;
mod inspect;
mod job;
mod log;
mod merge;
mod metropolis;
mod page;
mod progress;
mod render;
mod results;
mod schema;
mod signals;
mod validate;
mod watch;

use std::{io::Write, process::ExitCode};

use clap::{Parser, Subcommand};

pub use exit::Exit;

/// What the help of every command ends with.
const EXIT_CODES: &str = "Exit codes: 0 ok, 1 render failed, 2 usage, 3 asset or scene invalid,\n\
    4 resource limit, 5 interrupted with a partial result saved.";

/// A renderer for asset pipelines: glTF, OBJ, USD and Ajar scenes to OpenEXR.
#[derive(Debug, Parser)]
#[command(name = "ajar", version, max_term_width = 100, propagate_version = true)]
#[command(after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// How messages and progress are written
    #[arg(long, global = true, value_name = "FORMAT", value_enum, default_value_t)]
    log_format: log::Format,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene or asset to an OpenEXR image and a PNG preview
    Render(Box<render::Args>),
    /// Show a scene in the browser and render it again whenever one of its files changes
    Watch(Box<watch::Args>),
    /// Put together the shards of a render, or make the image of a checkpoint
    Merge(merge::Args),
    /// Show what a file holds: hierarchy, counts, materials, lights, cameras, textures, warnings
    Inspect(inspect::Args),
    /// Check that a file is fit to render, without rendering
    Validate(validate::Args),
    /// Write a scene with all its textures into one file
    Convert(convert::Args),
    /// List the file formats that can be read, and what of each is supported
    Formats(formats::Args),
    /// Print the JSON Schema of scene.toml, for editors that complete and check it
    Schema,
    /// Compare an image with a reference, aware of noise
    Diff(diff::Args),
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
        Command::Render(args) => render::run(&args, cli.log_format),
        Command::Watch(args) => watch::run(&args, cli.log_format),
        Command::Merge(args) => merge::run(&args, cli.log_format),
        Command::Inspect(args) => inspect::run(&args, cli.log_format),
        Command::Validate(args) => validate::run(&args, cli.log_format),
        Command::Convert(args) => convert::run(&args, cli.log_format),
        Command::Formats(args) => formats::run(&args),
        Command::Schema => schema::run(),
        Command::Diff(args) => diff::run(&args),
    };
    exit.into()
}

/// Prints the result of a command.
fn print(text: &str) {
    // Nobody reads it if the pipe is closed.
    let _ = writeln!(std::io::stdout(), "{text}");
}
