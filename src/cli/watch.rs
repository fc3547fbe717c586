//! `ajar watch`.

use std::path::PathBuf;

use ajar_live::tev::Tev;
use ajar_scene::{Cause, Diagnostic, SceneFile, Setting, Severity};

use super::{
    Exit,
    appearance::Appearance,
    arguments::parse_exr,
    block::Block,
    demand::Demand,
    input::Input,
    log::{Format, Verbosity},
    page::{self, Door},
    signals::Signals,
};
use crate::{
    image::{Destination, Form},
    plan::Plan,
    session::{self, Reading},
    watch::{End, Options, Said, Subject, Watch},
};

/// Noise at which an image is done where nothing else is said.
const NOISE: f64 = 0.01;

#[derive(Clone, Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    #[command(flatten)]
    input: Input,
    /// Write each finished image here, with a PNG preview beside it
    #[arg(short, long, value_name = "OUT.exr", value_parser = parse_exr)]
    output: Option<PathBuf>,
    /// Keep the image of before as EXR in this folder at each change, and the last one at the end
    #[arg(long, value_name = "FOLDER")]
    snapshots: Option<PathBuf>,
    /// Run this command after each finished image; AJAR_EXR and AJAR_PNG name its files
    #[arg(long, value_name = "COMMAND")]
    exec: Option<String>,
    /// End after the first finished image
    #[arg(long)]
    once: bool,
    /// Look at files now and then instead of relying on the system to tell of changes
    #[arg(long)]
    poll: bool,
    /// Show images in tev too; its usual address is 127.0.0.1:14158
    #[arg(long, value_name = "HOST:PORT")]
    tev: Option<String>,
    #[command(flatten)]
    door: Door,
    #[command(flatten)]
    demand: Demand,
    #[command(flatten)]
    appearance: Appearance,
    #[command(flatten)]
    verbosity: Verbosity,
}

impl Subject for Args {
    fn path(&self) -> &std::path::Path {
        &self.input.file
    }

    fn open(&self, reading: &Reading<'_>) -> Result<SceneFile, Vec<Diagnostic>> {
        self.input.open_as(reading)
    }

    fn complete(&self, file: &mut SceneFile) {
        self.input.complete(self.demand.size, file);
    }

    fn plan(&self, file: &SceneFile) -> Result<Plan, Diagnostic> {
        let blame = |complaint| Setting::blame(&file.settings, complaint);
        let plan = self.demand.or_noise(&file.render, NOISE).plan(file, None).map_err(blame)?;
        plan.check_memory(self.input.memory_limit).map_err(blame)?;
        Ok(plan)
    }

    fn camera<'a>(&'a self, file: &'a SceneFile) -> Option<&'a str> {
        self.demand.camera.as_deref().or(file.render.camera.as_deref())
    }

    fn wants_images(&self) -> bool {
        self.output.is_some() || self.exec.is_some()
    }

    fn form(&self, file: &SceneFile) -> Result<Form, Diagnostic> {
        self.appearance.form(&file.output).map_err(|d| Setting::blame(&file.settings, d))
    }

    fn destination(&self, file: &SceneFile) -> Result<Destination, Diagnostic> {
        let form = self.form(file)?;
        let mut output = file.output.clone();
        if self.output.is_some() {
            (output.path, output.png) = (self.output.clone(), None);
        }
        let (exr, png) = session::output_paths(&self.input.file, &output);
        let destination = Destination { exr, png, form };
        destination.check(&file.files)?;
        Ok(destination)
    }

    fn said(&self, camera: &str) -> Said {
        let mut said = self.input.said();
        self.demand.say(camera, &mut said);
        self.appearance.say(&mut said);
        said
    }

    fn memory_limit(&self) -> u64 {
        self.input.memory_limit
    }
}

pub(super) fn run(args: &Args, log: Format) -> Exit {
    watch(args, log).unwrap_or_else(|error| {
        log.messages(std::slice::from_ref(&error), Severity::Error);
        Exit::after(&[error], Severity::Error)
    })
}

fn watch(args: &Args, log: Format) -> Result<Exit, Diagnostic> {
    args.demand.start_threads()?;
    let signals = Signals::new().map_err(|e| failed("handle signals", &e))?;
    let tev = args.tev.as_ref().map(|address| Tev::new(address, "ajar"));
    if let Some(folder) = &args.snapshots {
        std::fs::create_dir_all(folder)
            .map_err(|e| failed("make the folder", &e).in_file(folder).element("--snapshots"))?;
    }
    let options = Options { poll: args.poll, tev, snapshots: args.snapshots.clone(), once: args.once };
    let watch = Watch::new(args, options).map_err(|e| failed("watch files", &e))?;
    let server = if args.once { None } else { Some(page::open(&args.door, &args.input.file, &watch, log)?) };
    let url = server.as_ref().map(|server| server.url());
    let block = Block::new(log, args.verbosity.least(), url, args.exec.clone());
    let mut block = block.map_err(|e| failed("start a thread for the command", &e))?;
    let end = watch.run(signals.stop(), &mut block);
    block.end(signals.stop());
    Ok(match end {
        End::Asked if args.once => Exit::Interrupted,
        End::Asked | End::Finished => Exit::Ok,
        End::Failed(errors) => Exit::after(&errors, args.input.least()),
    })
}

fn failed(what: &str, error: &std::io::Error) -> Diagnostic {
    Diagnostic::error(format!("cannot {what}: {error}")).because(Cause::System)
}
