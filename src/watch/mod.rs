//! Look development: a scene is rendered again whenever a file that it came from changes.
//!
//! One thread decides (`Watch`); it hears of changed files, of what pages want, and of how the render goes, each as an
//! `Event`. A change ends the render at once; the scene is read again, of which only what changed is work; a new render
//! begins. If the scene cannot be read, the old render goes on.

mod archive;
mod change;
mod clay;
mod describe;
mod draft;
mod edits;
mod finished;
mod gesture;
mod glance;
mod imports;
mod layer;
mod opened;
mod page;
mod screen;
mod snapshots;
mod state;
mod views;
mod worker;

pub use layer::Said;
pub use state::{Label, Phase, State};

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    },
    time::{Duration, Instant},
};

use ajar_integrators::Window;
use ajar_live::{
    files::Watcher,
    server::{Program, Reply, Stage},
    tev::Tev,
};
use ajar_scene::{Diagnostic, SceneFile};

use crate::{
    image::{Destination, Form},
    plan::Plan,
    session::Reading,
};
use archive::Archive;
use draft::Draft;
use gesture::Gesture;
use imports::Imports;
use layer::Layer;
use opened::{Opened, names};
use page::{Pages, Request};
use screen::Screen;
use snapshots::Snapshots;
use views::Views;
use worker::{News, Resting, Worker};

/// How long the interrupt of a user may go unnoticed.
const TICK: Duration = Duration::from_millis(100);

/// Shortest time between two words of one image.
const INTERVAL: Duration = Duration::from_millis(50);

/// How long after word of a file its writer may not be through: half a second after it began, of which the watcher took its
/// part until it was still.
const DOUBT: Duration = Duration::from_millis(440);

/// What is watched, and how it is to be rendered.
pub trait Subject {
    /// The file.
    fn path(&self) -> &Path;

    /// Reads it as it is.
    ///
    /// # Errors
    /// Everything that makes it unfit to render.
    fn open(&self, reading: &Reading<'_>) -> Result<SceneFile, Vec<Diagnostic>>;

    /// Adds the camera or light that it lacks.
    fn complete(&self, file: &mut SceneFile);

    /// What is to be rendered of it.
    ///
    /// # Errors
    /// It cannot be done.
    fn plan(&self, file: &SceneFile) -> Result<Plan, Diagnostic>;

    /// Name of the camera to look through; `None` is the first.
    fn camera<'a>(&'a self, file: &'a SceneFile) -> Option<&'a str>;

    /// Whether finished images are written.
    fn wants_images(&self) -> bool;

    /// Their form.
    ///
    /// # Errors
    /// It makes no sense.
    fn form(&self, file: &SceneFile) -> Result<Form, Diagnostic>;

    /// Where they are written.
    ///
    /// # Errors
    /// It makes no sense.
    fn destination(&self, file: &SceneFile) -> Result<Destination, Diagnostic>;

    /// What the command line says about its look, where the camera that is looked through has this name.
    fn said(&self, camera: &str) -> Said;

    /// Bytes that decoded textures may take.
    fn memory_limit(&self) -> u64;
}

/// Who is told.
pub trait View {
    /// Something about the scene or its files.
    fn say(&mut self, messages: &[Diagnostic]);

    /// What is going on.
    fn show(&mut self, state: &State);

    /// An image is as good as it was asked to be, and is written there if anywhere.
    fn finish(&mut self, state: &State, written: Option<&Destination>);
}

/// How to watch.
#[derive(Debug, Default)]
pub struct Options {
    /// Do not rely on the system to tell of changes.
    pub poll: bool,
    /// Where to show images besides pages.
    pub tev: Option<Tev>,
    /// The folder to keep images of before in.
    pub snapshots: Option<PathBuf>,
    /// End with the first finished image, or if there is none to come.
    pub once: bool,
}

/// How watching ended.
#[derive(Debug)]
pub enum End {
    /// The user ended it.
    Asked,
    /// The one image that was asked for is finished.
    Finished,
    /// It will not come.
    Failed(Vec<Diagnostic>),
}

enum Event {
    /// These files hold something else.
    Files(BTreeSet<PathBuf>),
    /// A page wants something.
    Page(Request, Reply),
    /// News of the render of this number.
    Render(u64, News),
    /// Something about files that were written.
    Said(Diagnostic),
}

/// A scene that is watched.
pub struct Watch<'a> {
    subject: &'a dyn Subject,
    once: bool,
    watcher: Watcher,
    events: (Sender<Event>, Receiver<Event>),
    /// Requests of pages that wait.
    waiting: Arc<AtomicUsize>,
    stage: Stage,
    screen: Arc<Screen>,
    snapshots: Arc<Snapshots>,
    views: Arc<Views>,
    /// Where images of before are kept besides memory.
    archive: Option<Archive>,
    imports: Imports,
    /// The last scene that could be read.
    opened: Option<Opened>,
    /// The render of it that is at work.
    worker: Option<Worker>,
    /// The render of it that is not at work.
    resting: Option<Resting>,
    /// Number of the worker.
    number: u64,
    /// Files that matter.
    files: BTreeSet<PathBuf>,
    /// Those that changed since the scene was read.
    changed: BTreeSet<PathBuf>,
    /// Whether the scene has to be read again.
    is_stale: bool,
    /// Until when what cannot be read may be a file that is being written.
    doubt: Option<Instant>,
    gesture: Gesture,
    draft: Draft,
    /// The changes that the scene was read with.
    sound_draft: Draft,
    /// Whether the last change that pages made could not be, and the errors that are shown say why.
    is_taken_back: bool,
    /// Where changes were saved.
    layer: Layer,
    region: Option<Window>,
    /// Whether the render goes on beyond what was asked for.
    is_endless: bool,
    /// The document that describes the scene.
    about: Arc<str>,
    state: State,
    /// Whether somebody has yet to be told.
    is_news: bool,
    /// When and of which image they were told last.
    told: (Instant, u64, Phase),
}

impl<'a> Watch<'a> {
    /// Begins to watch; nothing is read before [`Watch::run`].
    ///
    /// # Errors
    /// The system refuses threads.
    pub fn new(subject: &'a dyn Subject, options: Options) -> std::io::Result<Self> {
        let events = channel();
        let sender = events.0.clone();
        let watcher = Watcher::new(options.poll, move |files| drop(sender.send(Event::Files(files))))?;
        let stage = Stage::default();
        let screen = Arc::new(Screen::new(stage.clone(), options.tev, events.0.clone()));
        let archive = options.snapshots.map(|folder| Archive::start(folder, events.0.clone())).transpose()?;
        Ok(Self {
            subject,
            once: options.once,
            watcher,
            events,
            waiting: Arc::default(),
            views: Arc::new(Views::new(Arc::clone(&screen))),
            screen,
            stage,
            snapshots: Arc::default(),
            archive,
            imports: Imports::default(),
            opened: None,
            worker: None,
            resting: None,
            number: 0,
            files: BTreeSet::new(),
            changed: BTreeSet::new(),
            is_stale: true,
            doubt: None,
            gesture: Gesture::default(),
            draft: Draft::default(),
            sound_draft: Draft::default(),
            is_taken_back: false,
            layer: Layer::default(),
            region: None,
            is_endless: false,
            about: "{}".into(),
            state: State { scene: subject.path().display().to_string(), ..State::default() },
            is_news: true,
            told: (Instant::now(), 0, Phase::Waiting),
        })
    }

    /// What pages see, and what answers them.
    pub fn for_pages(&self) -> (Stage, Arc<dyn Program>) {
        let pages = Pages {
            events: self.events.0.clone(),
            snapshots: Arc::clone(&self.snapshots),
            views: Arc::clone(&self.views),
            waiting: Arc::clone(&self.waiting),
        };
        (self.stage.clone(), Arc::new(pages))
    }

    /// Reads and renders again and again until `stop` is raised.
    pub fn run(mut self, stop: &AtomicBool, view: &mut dyn View) -> End {
        let end = loop {
            if stop.load(Ordering::Relaxed) {
                break End::Asked;
            }
            if self.is_stale {
                self.read(view);
            }
            self.tell(view);
            if let Some(end) = self.is_over() {
                break end;
            }
            match self.events.1.recv_timeout(TICK) {
                Ok(event) => self.hear(event, view),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break End::Asked,
            }
            // Reading takes long: what piled up meanwhile is one change.
            while let Ok(event) = self.events.1.try_recv() {
                self.hear(event, view);
            }
        };
        self.rest();
        self.screen.end();
        self.keep_on_disk(view);
        if let Some(archive) = self.archive.take() {
            view.say(&archive.end(&self.events.1));
        }
        end
    }

    fn is_over(&self) -> Option<End> {
        match (self.once, self.state.phase) {
            (true, Phase::Done) => Some(End::Finished),
            (true, Phase::Waiting) => Some(End::Failed(self.state.errors.clone())),
            _ => None,
        }
    }

    fn hear(&mut self, event: Event, view: &mut dyn View) {
        match event {
            Event::Files(files) => {
                self.state.note(names(&files));
                self.imports.forget(&files);
                self.gesture.end();
                self.doubt.get_or_insert_with(|| Instant::now() + DOUBT);
                self.changed.extend(files);
                self.outdate();
            }
            Event::Page(request, reply) => {
                self.waiting.fetch_sub(1, Ordering::Relaxed);
                self.answer(request, &reply, view);
            }
            Event::Render(number, news) if number == self.number => self.learn(news, view),
            Event::Said(message) => view.say(&[message]),
            // Of a render before.
            Event::Render(..) => {}
        }
    }

    fn learn(&mut self, news: News, view: &mut dyn View) {
        let Some(opened) = &self.opened else { return };
        match news {
            News::Glance(samples) => self.state.samples = samples,
            News::Round(status) => self.state.status(&status, &opened.plan),
            News::End if self.worker.is_some() => return self.end_image(view),
            News::End => {}
        }
        self.is_news = true;
    }

    /// What is rendered is not what there is.
    fn outdate(&mut self) {
        if let Some(worker) = &self.worker {
            worker.outdate();
        }
        self.is_stale = true;
    }

    /// Tells what is new, of one image not too often.
    fn tell(&mut self, view: &mut dyn View) {
        let (at, image, phase) = self.told;
        let is_same = (image, phase) == (self.state.image, self.state.phase);
        if is_same && (!self.is_news || at.elapsed() < INTERVAL) {
            return;
        }
        self.is_news = false;
        self.told = (Instant::now(), self.state.image, self.state.phase);
        view.show(&self.state);
        // Cannot fail: numbers and strings.
        let state =
            serde_json::to_string(&page::Told { kind: "state", state: &self.state }).unwrap_or_default();
        self.stage.show_documents(vec![state.into(), Arc::clone(&self.about)]);
    }
}
