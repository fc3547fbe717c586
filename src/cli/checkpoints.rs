//! Options for renders that are saved, resumed and shared out.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use ajar_render::film::Film;
use ajar_scene::{Cause, Diagnostic, parse_duration};

use super::results::failed;
use crate::{
    checkpoint::{self, Saved, Subject},
    image::{Destination, Form, Run},
    shard::Shard,
};

#[derive(Clone, Debug, clap::Args)]
pub(super) struct Checkpoints {
    /// Save the render so far, again and again and at its end; --resume goes on with it
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Time between two savings
    #[arg(long, value_name = "TIME", value_parser = parse_duration, default_value = "1m")]
    checkpoint_interval: Duration,
    /// Go on with a render that was saved, given the same options; saves there too, unless --checkpoint names another file
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Render part I of N parts, counted from 0, each saved to a --checkpoint of its own: `ajar merge` puts them together
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
}

impl Checkpoints {
    /// Where the render is saved.
    pub fn path(&self) -> Option<&Path> {
        self.checkpoint.as_deref().or(self.resume.as_deref())
    }

    /// The image of a shard that no option names: beside its part, for other shards may render the same scene here.
    pub fn shard_image(&self) -> Option<PathBuf> {
        let mut name = self.shard.and(self.path())?.as_os_str().to_owned();
        name.push(".exr");
        Some(name.into())
    }

    /// Checks that a shard has a file, and every file a name of its own.
    pub fn check(&self, to: &Destination) -> Result<(), Diagnostic> {
        match self.path() {
            Some(path) => check_names(path, &to.exr, &to.png),
            None if self.shard.is_some() => {
                Err(Diagnostic::error("a shard is saved to a file: name it by --checkpoint")
                    .because(Cause::Usage))
            }
            None => Ok(()),
        }
    }

    /// The render to go on with.
    pub fn open(&self) -> Result<Option<Saved>, Diagnostic> {
        self.resume.as_deref().map(checkpoint::open).transpose()
    }

    /// The film of `saved` and the time it took, if it is of this subject and shard.
    pub fn resume(
        &self,
        saved: Saved,
        subject: &Subject,
        shard: Shard,
    ) -> Result<(Film, Duration), Vec<Diagnostic>> {
        let path = self.resume.as_deref().unwrap_or(Path::new(""));
        let mut differences = saved.subject.differences(subject, path);
        if saved.shard != shard {
            let other = format!("holds shard {}, not {shard}", saved.shard);
            differences.push(Diagnostic::error(other).because(Cause::Usage).in_file(path));
        }
        let time = Duration::try_from_secs_f64(saved.seconds).unwrap_or_default();
        if differences.is_empty() { Ok((saved.film, time)) } else { Err(differences) }
    }

    /// Begins to count the time.
    pub fn saving(&self) -> Saving<'_> {
        Saving { path: self.path(), interval: self.checkpoint_interval, last: Instant::now() }
    }
}

/// Saves from time to time.
pub(super) struct Saving<'a> {
    path: Option<&'a Path>,
    interval: Duration,
    last: Instant,
}

impl Saving<'_> {
    /// Whether it is time.
    pub fn is_due(&self) -> bool {
        self.path.is_some() && self.last.elapsed() >= self.interval
    }

    /// Saves, if a file was named for it.
    pub fn save(&mut self, run: &Run<'_>, form: &Form) -> Result<(), Diagnostic> {
        let saved = self.path.map_or(Ok(()), |path| checkpoint::save(path, run, form).map_err(failed));
        self.last = Instant::now();
        saved
    }
}

/// Checks that the image does not take the place of a checkpoint.
pub(super) fn check_names(checkpoint: &Path, exr: &Path, png: &Path) -> Result<(), Diagnostic> {
    if checkpoint == exr || checkpoint == png {
        let same = Diagnostic::error("the image would take the place of this checkpoint");
        return Err(same.because(Cause::Usage).in_file(checkpoint));
    }
    Ok(())
}
