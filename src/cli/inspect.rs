//! `ajar inspect`.

mod contents;
mod optics;
mod text;

use ajar_scene::Severity;
use serde_json::json;

use super::{Exit, input::Input, log::Format, print};

use contents::Contents;

#[derive(Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    #[command(flatten)]
    input: Input,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// Show the whole hierarchy, however long
    #[arg(long)]
    all: bool,
}

pub(super) fn run(args: &Args, log: Format) -> Exit {
    let file = &args.input.file;
    match args.input.load(None) {
        Ok(loaded) => {
            let contents = Contents::new(file, &loaded);
            if args.json {
                print(&format!("{:#}", json!(contents)));
            } else {
                print(&text::describe(&contents, args.all));
            }
            Exit::Ok
        }
        Err(diagnostics) => {
            if args.json {
                let file = file.to_string_lossy();
                print(&format!("{:#}", json!({ "file": file, "diagnostics": diagnostics })));
            }
            log.messages(&diagnostics, Severity::Note);
            Exit::after(&diagnostics, args.input.least())
        }
    }
}
