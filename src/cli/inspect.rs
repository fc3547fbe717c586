//! `ajar inspect`.

mod contents;
mod optics;
mod text;
mod words;

use std::path::PathBuf;

use ajar_scene::Severity;
use serde_json::json;

use super::{Exit, arguments::parse_bytes, print, print_diagnostics};
use crate::session;

use contents::Contents;

#[derive(Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    /// scene.toml, or any file that `ajar formats` lists
    file: PathBuf,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// Show the whole hierarchy, however long
    #[arg(long)]
    all: bool,
    /// Treat everything that was approximated or dropped as an error
    #[arg(long)]
    strict: bool,
    /// Most memory for what the file holds: 512M, 8G
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes, default_value = "8G")]
    memory_limit: u64,
}

pub(super) fn run(args: &Args) -> Exit {
    match session::load(&args.file, 16.0 / 9.0, args.strict, args.memory_limit) {
        Ok(loaded) => {
            let contents = Contents::new(&args.file, &loaded);
            if args.json {
                print(&format!("{:#}", json!(contents)));
            } else {
                print(&text::describe(&contents, args.all));
            }
            Exit::Ok
        }
        Err(diagnostics) => {
            if args.json {
                print(&format!("{:#}", json!({ "file": args.file, "diagnostics": diagnostics })));
            }
            print_diagnostics(&diagnostics, Severity::Note);
            Exit::Invalid
        }
    }
}
