//! One render on a thread of its own: a coarse image at once, a noisy one soon, then the image that `ajar render` makes.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::Sender,
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use ajar_integrators::{
    Integrator, Rounds, Settings, Window, integrators,
    stop::{Reason, StopRules},
};
use ajar_render::{World, film::Film};

use super::{
    Event,
    screen::{Screen, Shot},
};
use crate::{
    plan::Plan,
    session::{self, Rendered, Start, Status},
    shard::Shard,
};

/// The first image has this many times fewer columns and rows.
const COARSE: u32 = 4;
/// Shortest time between two images.
const INTERVAL: Duration = Duration::from_millis(100);
/// The share of the time that showing images may take: one in so many.
const SHARE: u32 = 10;

/// What is to be rendered.
pub(super) struct Job {
    pub world: Arc<World>,
    /// The camera and its place.
    pub camera: (ajar_scene::Camera, glam::DAffine3),
    pub plan: Plan,
    /// Rounds there are already, and the time they took.
    pub done: Option<(Film, Duration)>,
}

/// A render at work, or one that has ended.
pub(super) struct Worker {
    cancel: Arc<AtomicBool>,
    thread: JoinHandle<Rendered>,
}

impl Worker {
    /// Begins. `number` is what its events are called.
    pub fn start(number: u64, job: Job, screen: Arc<Screen>, events: Sender<Event>) -> std::io::Result<Self> {
        let cancel = Arc::new(AtomicBool::new(false));
        let cancelled = Arc::clone(&cancel);
        let thread = std::thread::Builder::new().name("render".into()).spawn(move || {
            // Also when a panic ends it.
            let _end = End(number, events.clone());
            let told = |status: &Status| drop(events.send(Event::Round(number, *status)));
            Work { job: &job, screen: &screen, cancel: &cancelled }.run(told)
        })?;
        Ok(Self { cancel, thread })
    }

    /// Asks it to end at once.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Ends it; `None` if it failed.
    pub fn end(self) -> Option<Rendered> {
        self.cancel();
        self.thread.join().ok()
    }
}

struct End(u64, Sender<Event>);

impl Drop for End {
    fn drop(&mut self) {
        let _ = self.1.send(Event::End(self.0));
    }
}

struct Work<'a> {
    job: &'a Job,
    screen: &'a Screen,
    cancel: &'a AtomicBool,
}

impl Work<'_> {
    fn run(&self, told: impl Fn(&Status)) -> Rendered {
        let Job { world, plan, done, .. } = self.job;
        if done.is_none() {
            self.preview();
        }
        let mut pace = Pace::new();
        let start = Start { shard: Shard::WHOLE, done: done.clone() };
        let each_round = |film: &Film, status: &Status, _: &dyn Rounds| {
            told(status);
            pace.keep(|| self.show(film));
        };
        let (integrator, settings) = (plan.integrator, &plan.settings);
        let rendered =
            session::render(world, integrator, settings, &plan.rules, start, self.cancel, each_round);
        if rendered.film.rounds() > 0 {
            self.show(&rendered.film);
        }
        rendered
    }

    fn show(&self, film: &Film) {
        let Job { plan, camera, .. } = self.job;
        let exposure = f64::from(camera.0.exposure);
        let errors = |p| film.variance_of_mean(p).map(|v| v.sqrt() * exposure).as_vec3().to_array();
        self.screen.show(Shot {
            size: plan.size,
            window: plan.settings.window,
            pixels: pixels(film, exposure),
            errors: Some((0..film.pixels()).map(errors).collect()),
        });
    }

    /// What can be seen soon: one eye path a pixel, first of few pixels, then of all.
    fn preview(&self) {
        let Job { world, camera, plan, .. } = self.job;
        let window = plan.settings.window;
        let size = plan.size.map(|n| n.div_ceil(COARSE));
        if [window.width(), window.height()] == plan.size {
            let coarse = world.seen_by(&camera.0, &camera.1, size);
            let all = Window { x0: 0, y0: 0, x1: size[0], y1: size[1] };
            if let Some(pixels) = self.glance(&coarse, all) {
                self.screen.show_coarse(size, &pixels);
            }
        }
        if let Some(pixels) = self.glance(world, window) {
            self.screen.show(Shot { size: plan.size, window, pixels, errors: None });
        }
    }

    fn glance(&self, world: &World, window: Window) -> Option<Vec<[f32; 3]>> {
        let Plan { settings, .. } = &self.job.plan;
        let settings = Settings { window, samples_per_round: 1, ..settings.clone() };
        let rules = StopRules { rounds: Some(1), ..StopRules::default() };
        let start = Start { shard: Shard::WHOLE, done: None };
        let rendered =
            session::render(world, eye_paths()?, &settings, &rules, start, self.cancel, |_, _, _| ());
        let is_whole = rendered.reason == Some(Reason::Rounds);
        is_whole.then(|| pixels(&rendered.film, self.job.camera.0.exposure.into()))
    }
}

/// The integrator that is the first to have something to show.
fn eye_paths() -> Option<&'static dyn Integrator> {
    integrators().iter().copied().find(|integrator| integrator.name() == "path")
}

fn pixels(film: &Film, exposure: f64) -> Vec<[f32; 3]> {
    (0..film.pixels()).map(|p| (film.mean(p) * exposure).as_vec3().to_array()).collect()
}

/// Sees to it that showing takes little of the time.
struct Pace(Instant);

impl Pace {
    fn new() -> Self {
        Self(Instant::now())
    }

    fn keep(&mut self, show: impl FnOnce()) {
        let began = Instant::now();
        if began >= self.0 {
            show();
            self.0 = began + INTERVAL.max(began.elapsed() * SHARE);
        }
    }
}
