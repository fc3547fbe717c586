//! From a change to a new render.

use std::{
    sync::Arc,
    time::{Duration, SystemTime},
};

use ajar_integrators::stop::StopRules;
use ajar_scene::{Cause, Diagnostic};

use super::{
    Phase, View, Watch, describe, edits,
    opened::{Desk, Opened},
    state::Label,
    worker::{Job, Worker},
};
use crate::session::{Status, is_scene_file};

impl Watch<'_> {
    /// Ends the render at work.
    pub(super) fn rest(&mut self) {
        if let Some(worker) = self.worker.take() {
            self.resting = worker.end();
            self.number += 1;
        }
    }

    /// Reads the scene and renders it; if it cannot be read, goes on with the old one.
    pub(super) fn read(&mut self, view: &mut dyn View) {
        let was_at_work = self.worker.is_some();
        self.rest();
        self.is_stale = false;
        self.state.phase = Phase::Loading;
        self.tell(view);
        let since = SystemTime::now();
        let desk = Desk {
            subject: self.subject,
            imports: &self.imports,
            draft: self.draft.at(&self.layer, self.subject.path()),
            variants: if is_scene_file(self.subject.path()) { Vec::new() } else { self.draft.variants() },
            is_clay: self.draft.is_clay(),
            wants_output: self.subject.wants_images() || self.archive.is_some(),
            before: self.opened.as_ref().map(|opened| (&*opened.world, &self.changed)),
        };
        let read = desk.read();
        match read.opened {
            Ok(opened) => {
                self.files = read.files;
                self.watcher.watch(self.files.clone(), since);
                self.imports.sweep();
                view.say(&read.messages);
                self.replace(opened, &read.messages, view);
            }
            Err(errors) => {
                // What was needed before may be needed again.
                self.files.extend(read.files);
                self.watcher.watch(self.files.clone(), since);
                self.refuse(errors, was_at_work, view);
            }
        }
    }

    /// Renders a scene in place of the one before.
    fn replace(&mut self, mut opened: Opened, messages: &[Diagnostic], view: &mut dyn View) {
        self.keep_snapshot();
        self.keep_on_disk(view);
        self.state.shown_for = self.state.changed.clone();
        self.changed.clear();
        self.sound_draft = self.draft.clone();
        self.state.errors.clear();
        self.state.image += 1;
        self.state.edits = self.draft.text();
        self.state.is_clay = self.draft.is_clay();
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
        view.say(&errors);
        // Notes that came with them are no reason; where warnings are, there is nothing worse.
        let worst = errors.iter().map(|error| error.severity).max();
        self.state.errors = errors.into_iter().filter(|error| Some(error.severity) == worst).collect();
        if self.draft != self.sound_draft {
            // A page that asks for what cannot be has to take it back.
            self.draft = self.sound_draft.clone();
            self.is_stale = !self.changed.is_empty();
        }
        self.state.phase = match self.opened {
            None => Phase::Waiting,
            Some(_) if was_at_work => return self.work(),
            Some(_) if self.resting.as_ref().is_some_and(|it| it.reason.is_some()) => Phase::Done,
            Some(_) => Phase::Stopped,
        };
        self.is_news = true;
    }

    /// Renders, on from where it rests.
    pub(super) fn work(&mut self) {
        let Some(opened) = &self.opened else { return };
        let resting = self.resting.take().filter(|it| it.film.rounds() > 0);
        let done = resting.map(|it| (it.film, it.status.elapsed));
        if done.is_none() {
            self.state.status(
                &Status { rounds: 0, samples: 0, elapsed: Duration::ZERO, noise: None },
                &opened.plan,
            );
        }
        self.state.plan(&opened.plan);
        self.number += 1;
        let (world, camera) = (Arc::clone(&opened.world), opened.camera.clone());
        let mut plan = opened.plan.clone();
        if self.is_endless {
            plan.rules = StopRules::default();
        }
        let job = Job { world, camera, plan, done };
        match Worker::start(self.number, job, Arc::clone(&self.screen), self.events.0.clone()) {
            Ok(worker) => (self.worker, self.state.phase) = (Some(worker), Phase::Rendering),
            Err(error) => {
                let message = format!("cannot start a thread to render: {error}");
                self.state.errors = vec![Diagnostic::error(message).because(Cause::System)];
                self.state.phase = Phase::Stopped;
            }
        }
        self.is_news = true;
    }

    /// What is shown becomes one of the images of before, if it came beyond the first glance.
    fn keep_snapshot(&mut self) {
        if self.state.rounds > 0 && self.opened.is_some() {
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
        self.rest();
        self.resting = None;
        self.is_endless = false;
        if !self.is_stale {
            self.work();
        }
    }
}
