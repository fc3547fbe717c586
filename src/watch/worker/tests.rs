use std::sync::atomic::AtomicUsize;

use ajar_integrators::{Integrator, Settings, Window, path::PathTracer};
use ajar_live::server::Stage;
use ajar_scene::Choice;

use super::*;
use crate::session::{LoadOptions, Start};

/// A path tracer that is prepared once it is let.
#[derive(Default)]
struct Gate {
    is_open: AtomicBool,
    prepared: AtomicUsize,
}

impl Integrator for Gate {
    fn name(&self) -> &'static str {
        "gate"
    }

    fn description(&self) -> &'static str {
        "waits"
    }

    fn max_depth(&self) -> usize {
        8
    }

    fn prepare<'a>(&self, cx: Context<'a>) -> Box<dyn Rounds + 'a> {
        while !self.is_open.load(Ordering::SeqCst) && !cx.cancelled() {
            thread::sleep(Duration::from_millis(1));
        }
        self.prepared.fetch_add(1, Ordering::SeqCst);
        PathTracer.prepare(cx)
    }
}

fn job(integrator: &'static dyn Integrator, rounds: Option<u64>) -> Job {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tile.obj");
    std::fs::write(&file, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
    let choice = Choice::default();
    let (set, allow, size) = (&[][..], &[][..], [8, 6]);
    let options =
        LoadOptions { size: Some(size), set, strict: false, allow, memory_limit: 1 << 20, choice: &choice };
    let scene = session::load(&file, &options).unwrap().file.scene;
    let id = session::choose_camera(&scene, None).unwrap();
    let camera = (scene.cameras[id.0].clone(), id.1);
    let world = Arc::new(session::prepare_world(scene, id, size, 1 << 20).unwrap().0);
    let window = Window { x0: 0, y0: 0, x1: size[0], y1: size[1] };
    let settings = Settings {
        seed: 0,
        max_depth: 4,
        samples_per_round: 2,
        window,
        metropolis: ajar_integrators::Metropolis::default(),
    };
    let rules = StopRules { rounds, ..StopRules::default() };
    Job { world, camera, plan: Plan { integrator, size, settings, rules }, wants_glances: true }
}

/// What `ajar render` makes of it.
fn fresh(job: &Job, rounds: u64) -> Film {
    let rules = StopRules { rounds: Some(rounds), ..StopRules::default() };
    let start = Start { shard: Shard::WHOLE, done: None };
    let (cancel, settings) = (AtomicBool::new(false), &job.plan.settings);
    session::render(&job.world, &PathTracer, settings, &rules, start, &cancel, |_, _, _| ()).film
}

fn start(number: u64, job: Job) -> (Worker, Receiver<Event>) {
    let (events, heard) = channel();
    let screen = Arc::new(Screen::new(Stage::default(), None, events.clone()));
    (Worker::start(number, job, screen, events).unwrap(), heard)
}

fn next(heard: &Receiver<Event>) -> (u64, News) {
    match heard.recv_timeout(Duration::from_secs(60)).unwrap() {
        Event::Render(number, news) => (number, news),
        _ => panic!("something else happened"),
    }
}

fn is_same(a: &Film, b: &Film) -> bool {
    (0..a.pixels()).all(|p| a.mean(p) == b.mean(p) && a.variance_of_mean(p) == b.variance_of_mean(p))
}

#[test]
fn there_are_more_and_more_eye_paths_until_the_first_round() {
    let gate: &'static Gate = Box::leak(Box::default());
    let wanted = fresh(&job(gate, None), 3);
    let (worker, heard) = start(1, job(gate, Some(3)));
    let mut samples = 0;
    while samples < 3 {
        let (1, News::Glance(more)) = next(&heard) else { panic!("nothing is prepared yet") };
        assert!(more > samples);
        samples = more;
    }
    gate.is_open.store(true, Ordering::SeqCst);
    let mut rounds = 0;
    loop {
        match next(&heard).1 {
            News::Glance(_) => assert_eq!(rounds, 0, "the image is not taken back"),
            News::Round(status) => rounds = status.rounds,
            News::End => break,
        }
    }
    let Resting { rendered, .. } = worker.rest().unwrap();
    assert_eq!((rounds, rendered.status.rounds), (3, 3));
    assert!(rendered.film.mean(24).x > 0.0 && is_same(&rendered.film, &wanted));
}

#[test]
fn what_was_prepared_is_kept_at_rest() {
    let gate: &'static Gate = Box::leak(Box::default());
    gate.is_open.store(true, Ordering::SeqCst);
    let (worker, heard) = start(1, job(gate, None));
    while !matches!(next(&heard).1, News::Round(_)) {}
    let resting = worker.rest().unwrap();
    assert!(resting.rendered.reason.is_none());
    let rounds = resting.rendered.film.rounds() + 2;
    let rules = StopRules { rounds: Some(rounds), ..StopRules::default() };
    let worker = resting.go_on(2, rules).unwrap();
    while !matches!(next(&heard), (2, News::End)) {}
    let rendered = worker.rest().unwrap().rendered;
    assert_eq!((rendered.film.rounds(), gate.prepared.load(Ordering::SeqCst)), (rounds, 1));
    assert!(is_same(&rendered.film, &fresh(&job(gate, None), rounds)));
}

#[test]
fn what_was_prepared_in_part_is_worth_nothing() {
    let gate: &'static Gate = Box::leak(Box::default());
    let (worker, heard) = start(1, job(gate, None));
    let (1, News::Glance(1)) = next(&heard) else { panic!("a glance is first") };
    let resting = worker.rest().unwrap();
    assert_eq!(resting.rendered.film.rounds(), 0);
    assert!(resting.go_on(2, StopRules::default()).is_none());
}

/// Whatever it adds to the image is not a number.
struct Broken;

impl Integrator for Broken {
    fn name(&self) -> &'static str {
        "broken"
    }

    fn description(&self) -> &'static str {
        "adds what is not a number"
    }

    fn max_depth(&self) -> usize {
        8
    }

    fn prepare<'a>(&self, _: Context<'a>) -> Box<dyn Rounds + 'a> {
        Box::new(Self)
    }
}

impl Rounds for Broken {
    fn render(&self, _: u32, film: &ajar_render::film::RoundFilm) {
        film.add(0, ajar_render::math::Rgb::splat(f64::NAN));
    }

    fn scale(&self) -> f64 {
        1.0
    }
}

#[test]
fn what_is_left_out_is_counted() {
    let (worker, heard) = start(1, job(&Broken, Some(2)));
    let mut counts = Vec::new();
    loop {
        match next(&heard).1 {
            News::Round(status) => counts.push(status.rejected),
            News::Glance(_) => {}
            News::End => break,
        }
    }
    assert_eq!((counts, worker.rest().unwrap().rendered.status.rejected), (vec![1, 2], 2));
}
