//! From a change to a new render.

use std::{
    sync::Arc,
    time::{Instant, SystemTime},
};

use ajar_integrators::stop::StopRules;
use ajar_scene::{Cause, Diagnostic};

use super::{
    Event, Phase, View, Watch, describe,
    draft::Draft,
    edits,
    opened::{Desk, Opened, Read, names},
    state::Label,
    worker::{Job, Worker},
};
use crate::session::{Status, is_scene_file};

impl Watch<'_> {
    /// Ends the render at work.
    pub(super) fn rest(&mut self) {
        if let Some(worker) = self.worker.take() {
            self.resting = worker.rest();
            self.number += 1;
        }
    }

    /// Reads the scene and renders it; if it cannot be read, goes on with the old one.
    pub(super) fn read(&mut self, view: &mut dyn View) {
        let was_at_work = self.worker.is_some();
        self.rest();
        self.state.phase = Phase::Loading;
        self.tell(view);
        let mut read = self.attempt();
        while read.opened.is_err() && self.may_be_half_written(view) {
            read = self.attempt();
        }
        self.doubt = None;
        match read.opened {
            Ok(opened) => {
                self.imports.sweep();
                view.say(&read.messages);
                self.replace(opened, &read.messages, view);
            }
            Err(errors) => self.refuse(errors, was_at_work, view),
        }
    }

    /// Reads the scene as it is now, and watches what it depends on.
    fn attempt(&mut self) -> Read {
        self.is_stale = false;
        let since = SystemTime::now();
        let desk = Desk {
            subject: self.subject,
            imports: &self.imports,
            draft: self.draft.over(self.subject.path()),
            camera: self.draft.camera(),
            variants: if is_scene_file(self.subject.path()) { Vec::new() } else { self.draft.variants() },
            is_clay: self.draft.is_clay(),
            wants_output: self.subject.wants_images() || self.archive.is_some(),
            before: self.opened.as_ref().map(|opened| (&*opened.world, &self.changed)),
        };
        let mut read = desk.read();
        if read.opened.is_err() {
            // What was needed before may be needed again.
            read.files.extend(std::mem::take(&mut self.files));
        }
        self.files = std::mem::take(&mut read.files);
        self.watcher.watch(self.files.clone(), since);
        read
    }

    /// Whether what is wrong may be a file that is still being written; waits for more of it, or until it should be there.
    fn may_be_half_written(&mut self, view: &mut dyn View) -> bool {
        let Some(doubt) = self.doubt.filter(|doubt| Instant::now() < *doubt) else { return false };
        let mut later = Vec::new();
        while let Ok(event) = self.events.1.recv_timeout(doubt.saturating_duration_since(Instant::now())) {
            if matches!(event, Event::Files(_)) {
                self.hear(event, view);
                break;
            }
            later.push(event);
        }
        for event in later {
            // Received by this.
            let _ = self.events.0.send(event);
        }
        true
    }

    /// Renders a scene in place of the one before.
    fn replace(&mut self, mut opened: Opened, messages: &[Diagnostic], view: &mut dyn View) {
        if !self.gesture.has_moved_on() {
            self.keep_snapshot();
            self.keep_on_disk(view);
        }
        self.state.shown_for = std::mem::take(&mut self.state.waiting);
        self.changed.clear();
        self.sound_draft = self.draft.clone();
        self.state.errors.clear();
        self.is_taken_back = false;
        self.state.image += 1;
        self.state.edits = self.draft.text();
        self.state.is_clay = self.draft.is_clay();
        // The image may be smaller than the one that it was drawn on.
        self.region = self.region.and_then(|region| edits::cut(region, opened.plan.size));
        if let Some(region) = self.region {
            opened.plan.settings.window = region;
        }
        self.about = describe::scene(&opened, edits::pivot(&opened), messages).to_string().into();
        self.views.show(self.state.image, &opened.world);
        self.opened = Some(opened);
        self.resting = None;
        self.is_endless = false;
        self.work();
    }

    /// Stays with the scene before.
    fn refuse(&mut self, errors: Vec<Diagnostic>, was_at_work: bool, view: &mut dyn View) {
        let errors: Vec<_> = errors.into_iter().map(|error| self.about_draft(error)).collect();
        view.say(&errors);
        // Notes that came with them are no reason; where warnings are, there is nothing worse.
        let worst = errors.iter().map(|error| error.severity).max();
        self.state.errors = errors.into_iter().filter(|error| Some(error.severity) == worst).collect();
        self.is_taken_back = self.draft != self.sound_draft;
        if self.is_taken_back {
            // What cannot be is taken back, also on the pages that show it.
            self.draft = self.sound_draft.clone();
            self.about = self.about.to_string().into();
            self.state.waiting = names(&self.changed);
            self.is_stale = !self.changed.is_empty();
        }
        self.state.phase = match self.opened {
            None => Phase::Waiting,
            Some(_) if was_at_work => return self.work(),
            Some(_) if self.resting.as_ref().is_some_and(|it| it.rendered.reason.is_some()) => Phase::Done,
            Some(_) => Phase::Stopped,
        };
        self.is_news = true;
    }

    /// What is wrong with changes of pages is in no file.
    fn about_draft(&self, error: Diagnostic) -> Diagnostic {
        let is_of_draft =
            self.draft.over(self.subject.path()).is_some_and(|(path, _)| error.file == Some(path));
        if !is_of_draft {
            return error;
        }
        let is_new = self.draft != self.sound_draft;
        let hint = if is_new { "the last one is taken back" } else { "Drop takes them back" };
        let hint = [hint.to_owned()].into_iter().chain(error.hint).rev();
        let hint = hint.collect::<Vec<_>>().join("; ");
        Diagnostic { file: Some(Draft::NAME.into()), place: None, hint: Some(hint), ..error }
    }

    /// Renders, on from where it rests.
    pub(super) fn work(&mut self) {
        let Some(opened) = &self.opened else { return };
        self.state.plan(&opened.plan);
        self.number += 1;
        let (world, camera) = (Arc::clone(&opened.world), opened.camera.clone());
        let mut plan = opened.plan.clone();
        if self.is_endless {
            plan.rules = StopRules::default();
        }
        let rested = self.resting.take().and_then(|resting| resting.go_on(self.number, plan.rules));
        let worker = rested.map_or_else(
            || {
                self.state.status(&Status::default(), &plan);
                let job = Job { world, camera, plan, wants_glances: !self.once };
                Worker::start(self.number, job, Arc::clone(&self.screen), self.events.0.clone())
            },
            Ok,
        );
        match worker {
            Ok(worker) => (self.worker, self.state.phase) = (Some(worker), Phase::Rendering),
            Err(error) => {
                let message = format!("cannot start a thread to render: {error}");
                self.state.errors = vec![Diagnostic::error(message).because(Cause::System)];
                self.state.phase = Phase::Stopped;
            }
        }
        self.is_news = true;
    }

    /// What is shown becomes one of the images of before, if there is something.
    fn keep_snapshot(&mut self) {
        if self.state.samples > 0 && self.opened.is_some() {
            let (image, samples) = (self.state.image, self.state.samples);
            let label = Label { image, changed: self.state.shown_for.clone(), samples };
            self.snapshots.add(label, self.screen.frame());
            self.state.snapshots = self.snapshots.labels();
        }
    }

    /// Goes on, beyond what was asked for if that is reached.
    pub(super) fn go_on(&mut self) {
        self.is_endless |= self.state.phase == Phase::Done;
        self.work();
    }

    /// Renders anew.
    pub(super) fn begin_again(&mut self) {
        if let Some(worker) = &self.worker {
            worker.outdate();
        }
        self.rest();
        self.resting = None;
        self.is_endless = false;
        if !self.is_stale {
            self.work();
        }
    }
}
