//! One render on a thread of its own: a coarse image at once, a noisy one soon, then the image that `ajar render` makes.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};

use ajar_integrators::{Context, Rounds, stop::StopRules};
use ajar_render::{World, film::Film};
use rayon::prelude::*;

use super::{
    Event,
    glance::MoreGlances,
    screen::{Screen, Shot},
};
use crate::{
    plan::Plan,
    session::{self, Leg, Rendered, Status},
    shard::Shard,
};

#[cfg(test)]
mod tests;

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
    /// Whether somebody waits to see something before the first round.
    pub wants_glances: bool,
}

/// What is told of a render.
#[derive(Debug)]
pub(super) enum News {
    /// An image of so many eye samples a pixel is shown until there is a round.
    Glance(u64),
    /// A round is finished.
    Round(Status),
    /// It rests, or has failed.
    End,
}

/// To go on from there.
struct Order {
    number: u64,
    rules: StopRules,
    done: (Film, Duration),
}

/// A render at work, or one that rests: its thread keeps what was prepared. It ends when dropped.
pub(super) struct Worker {
    cancel: Arc<AtomicBool>,
    /// Raised where there is no more need of glances.
    is_seen: Arc<AtomicBool>,
    /// Raised where there is no more need of images.
    is_outdated: Arc<AtomicBool>,
    orders: Sender<Order>,
    rested: Receiver<Rendered>,
}

/// A render that rests, and who can go on with it.
pub(super) struct Resting {
    pub rendered: Rendered,
    worker: Worker,
}

impl Worker {
    /// Begins. `number` is what its events are called.
    pub fn start(number: u64, job: Job, screen: Arc<Screen>, events: Sender<Event>) -> std::io::Result<Self> {
        let (orders, ordered) = channel();
        let (rests, rested) = channel();
        let [cancel, is_seen, is_outdated] = [(); 3].map(|()| Arc::new(AtomicBool::new(false)));
        let flags = [Arc::clone(&cancel), Arc::clone(&is_seen)];
        let number = AtomicU64::new(number);
        let work = Arc::new(Work { job, screen, events, number, is_outdated: Arc::clone(&is_outdated) });
        thread::Builder::new().name("render".into()).spawn(move || {
            // Also when a panic ends it.
            let _end = End(&work);
            work.run(&flags, ordered, &rests);
        })?;
        Ok(Self { cancel, is_seen, is_outdated, orders, rested })
    }

    /// Asks it to rest at once.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
        self.is_seen.store(true, Ordering::Relaxed);
    }

    /// The same, since there is something else to render: what it made is not worth showing.
    pub fn outdate(&self) {
        self.is_outdated.store(true, Ordering::Relaxed);
        self.cancel();
    }

    /// Waits until it rests; `None` if it failed.
    pub fn rest(self) -> Option<Resting> {
        self.cancel();
        let rendered = self.rested.recv().ok()?;
        Some(Resting { rendered, worker: self })
    }
}

impl Resting {
    /// Goes on until one of the rules holds, with what is prepared; `None` if that never was. `number` is what its events
    /// are called from now on.
    pub fn go_on(self, number: u64, rules: StopRules) -> Option<Worker> {
        let Self { rendered, worker } = self;
        worker.cancel.store(false, Ordering::Relaxed);
        worker.is_outdated.store(false, Ordering::Relaxed);
        let done = (rendered.film, rendered.status.elapsed);
        worker.orders.send(Order { number, rules, done }).is_ok().then_some(worker)
    }
}

/// A render and those who are told of it.
pub(super) struct Work {
    pub job: Job,
    pub screen: Arc<Screen>,
    events: Sender<Event>,
    number: AtomicU64,
    is_outdated: Arc<AtomicBool>,
}

struct End<'a>(&'a Work);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.tell(News::End);
    }
}

impl Work {
    pub fn tell(&self, news: News) {
        // Who hears it may have ended.
        let _ = self.events.send(Event::Render(self.number.load(Ordering::Relaxed), news));
    }

    fn run(
        self: &Arc<Self>,
        [cancel, is_seen]: &[Arc<AtomicBool>; 2],
        orders: Receiver<Order>,
        rests: &Sender<Rendered>,
    ) {
        let Job { world, plan, .. } = &self.job;
        let cx = Context { world, settings: &plan.settings, cancel };
        let glance = if self.job.wants_glances { self.glance(cancel) } else { None };
        let mut glances = glance.map(|done| MoreGlances::start(Arc::clone(self), done, is_seen));
        let mut leg = Leg::begin(world, &plan.settings, None);
        let mut rules = plan.rules;
        let prepared = plan.integrator.prepare(cx);
        // What was prepared in part is worth nothing: no more orders can be given, from before others hear of the rest.
        let orders = (!cx.cancelled()).then_some(orders);
        let (mut pace, mut shown) = (Pace::new(), 0);
        loop {
            let each_round = |film: &Film, status: &Status, _: &dyn Rounds| {
                glances = None;
                self.tell(News::Round(*status));
                pace.keep(|| {
                    self.show(film);
                    shown = status.rounds;
                });
            };
            let rendered = session::advance(&*prepared, cx, &rules, Shard::WHOLE, leg, each_round);
            glances = None;
            if rendered.film.rounds() > shown {
                self.show(&rendered.film);
            }
            // Who gets it may have ended.
            let _ = rests.send(rendered);
            self.tell(News::End);
            let Some(Ok(order)) = orders.as_ref().map(Receiver::recv) else { return };
            self.number.store(order.number, Ordering::Relaxed);
            rules = order.rules;
            leg = Leg::begin(world, &plan.settings, Some(order.done));
        }
    }

    /// Shows what is rendered so far, as long as somebody wants to see it.
    pub fn show(&self, film: &Film) {
        let is_outdated = || self.is_outdated.load(Ordering::Relaxed);
        let Job { plan, camera, .. } = &self.job;
        let exposure = f64::from(camera.0.exposure);
        let errors = |p| film.variance_of_mean(p).map(|v| v.sqrt() * exposure).as_vec3().to_array();
        let errors = || (0..film.pixels()).into_par_iter().map(errors).collect();
        let pixels = (!is_outdated()).then(|| pixels(film, exposure));
        let errors = (!is_outdated()).then(errors);
        let Some(pixels) = pixels.filter(|_| !is_outdated()) else { return };
        self.screen.show(Shot { size: plan.size, window: plan.settings.window, pixels, errors });
    }
}

pub(super) fn pixels(film: &Film, exposure: f64) -> Vec<[f32; 3]> {
    (0..film.pixels()).into_par_iter().map(|p| (film.mean(p) * exposure).as_vec3().to_array()).collect()
}

/// Sees to it that showing takes little of the time.
pub(super) struct Pace(Instant);

impl Pace {
    pub fn new() -> Self {
        Self(Instant::now())
    }

    pub fn keep(&mut self, show: impl FnOnce()) {
        let began = Instant::now();
        if began >= self.0 {
            show();
            self.0 = began + INTERVAL.max(began.elapsed() * SHARE);
        }
    }
}
