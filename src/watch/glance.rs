//! What can be seen before the first round is there: eye paths of few pixels, then of all, then more and more of them, for
//! integrators may have to learn for long.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use ajar_integrators::{
    Integrator, Rounds, Settings, Window, integrators,
    stop::{Reason, StopRules},
};
use ajar_render::{World, film::Film};
use rayon::ThreadPoolBuilder;

use super::worker::{News, Pace, Work, pixels};
use crate::{
    session::{self, Rendered, Start, Status},
    shard::Shard,
};

/// The first image has this many times fewer columns and rows.
const COARSE: u32 = 4;
/// One thread in so many goes on with eye paths, and rests as long as it works.
const THREADS: usize = 8;
/// How long its end may go unnoticed while it rests.
const TICK: Duration = Duration::from_millis(20);

impl Work {
    /// Shows what can be seen at once; returns one eye path a pixel and the time that they took.
    pub fn glance(&self, cancel: &AtomicBool) -> Option<(Film, Duration)> {
        let Self { job, screen, .. } = self;
        let (camera, plan) = (&job.camera, &job.plan);
        let window = plan.settings.window;
        let size = plan.size.map(|n| n.div_ceil(COARSE));
        if [window.width(), window.height()] == plan.size {
            let coarse = job.world.seen_by(&camera.0, &camera.1, size);
            let all = Window { x0: 0, y0: 0, x1: size[0], y1: size[1] };
            if let Some(rendered) = self.eye_paths(&coarse, all, cancel) {
                screen.show_coarse(size, &pixels(&rendered.film, camera.0.exposure.into()));
            }
        }
        let Rendered { film, status, .. } = self.eye_paths(&job.world, window, cancel)?;
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        self.show_glance(&film, &status);
        Some((film, status.elapsed))
    }

    /// One eye path a pixel.
    fn eye_paths(&self, world: &World, window: Window, cancel: &AtomicBool) -> Option<Rendered> {
        let settings = Settings { window, ..self.eye_settings() };
        let rules = StopRules { rounds: Some(1), ..StopRules::default() };
        let start = Start { shard: Shard::WHOLE, done: None };
        let rendered = session::render(world, eye_tracer()?, &settings, &rules, start, cancel, |_, _, _| ());
        (rendered.reason == Some(Reason::Rounds)).then_some(rendered)
    }

    fn eye_settings(&self) -> Settings {
        Settings { samples_per_round: 1, ..self.job.plan.settings.clone() }
    }

    fn show_glance(&self, film: &Film, status: &Status) {
        self.show(film);
        self.tell(News::Glance(status.samples));
    }

    /// Goes on with eye paths until this is over.
    fn go_on_with(&self, done: (Film, Duration), is_over: &AtomicBool) {
        rest(done.1, is_over);
        let (mut worked, mut pace) = (Instant::now(), Pace::new());
        let each_round = |film: &Film, status: &Status, _: &dyn Rounds| {
            pace.keep(|| self.show_glance(film, status));
            rest(worked.elapsed(), is_over);
            worked = Instant::now();
        };
        let start = Start { shard: Shard::WHOLE, done: Some(done) };
        let (settings, rules) = (self.eye_settings(), StopRules::default());
        if let Some(tracer) = eye_tracer() {
            session::render(&self.job.world, tracer, &settings, &rules, start, is_over, each_round);
        }
    }
}

/// The integrator that is the first to have something to show.
fn eye_tracer() -> Option<&'static dyn Integrator> {
    integrators().iter().copied().find(|integrator| integrator.name() == "path")
}

fn rest(time: Duration, is_over: &AtomicBool) {
    let began = Instant::now();
    while began.elapsed() < time && !is_over.load(Ordering::Relaxed) {
        thread::sleep(TICK.min(time));
    }
}

/// More and more eye paths, on a thread of its own with a small share of the machine. They end when this is dropped, or
/// when the flag is raised that it was started with.
pub(super) struct MoreGlances(Arc<AtomicBool>, Option<JoinHandle<()>>);

impl MoreGlances {
    /// Goes on from there until `is_over`. Where there are no threads to be had there is nothing.
    pub fn start(work: Arc<Work>, done: (Film, Duration), is_over: &Arc<AtomicBool>) -> Self {
        let over = Arc::clone(is_over);
        let threads = rayon::current_num_threads().div_ceil(THREADS);
        let run = move || {
            if let Ok(pool) = ThreadPoolBuilder::new().num_threads(threads).build() {
                pool.install(|| work.go_on_with(done, &over));
            }
        };
        Self(Arc::clone(is_over), thread::Builder::new().name("glances".into()).spawn(run).ok())
    }
}

impl Drop for MoreGlances {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
        if let Some(thread) = self.1.take() {
            // Without it there is less to see, and nothing else.
            let _ = thread.join();
        }
    }
}
