//! What is seen of renders: by pages, by tev, and by who asks for a pixel.

use std::{
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, mpsc::Sender},
    time::Duration,
};

use ajar_integrators::Window;
use ajar_live::{frame::Frame, server::Stage, tev::Tev};
use ajar_scene::Diagnostic;

use super::Event;

/// How long the end of the program waits until tev has the last image.
const FAREWELL: Duration = Duration::from_secs(5);

/// Pixels of linear RGB, rows from the top.
pub(super) type Pixels = Vec<[f32; 3]>;

/// An image, or a part of it.
pub(super) struct Shot {
    /// Full frame, pixels.
    pub size: [u32; 2],
    /// The part.
    pub window: Window,
    /// Its pixels.
    pub pixels: Pixels,
    /// Their standard errors, where known.
    pub errors: Option<Pixels>,
}

/// A pixel with its standard error, where known.
pub(super) type Pixel = ([f32; 3], Option<[f32; 3]>);

pub(super) struct Screen {
    picture: Mutex<Picture>,
    stage: Stage,
    tev: Option<Arc<Mailbox>>,
}

#[derive(Default)]
struct Picture {
    size: [usize; 2],
    pixels: Pixels,
    errors: Pixels,
    frame: Arc<Frame>,
}

impl Screen {
    /// What is to be said about tev becomes an event.
    pub fn new(stage: Stage, tev: Option<Tev>, events: Sender<Event>) -> Self {
        Self { picture: Mutex::default(), stage, tev: tev.map(|tev| Mailbox::start(tev, events)) }
    }

    /// Shows an image; a part lies over what was shown before.
    pub fn show(&self, shot: Shot) {
        let mut picture = lock(&self.picture);
        picture.lay(shot);
        let [width, height] = picture.size;
        let frame = Arc::new(Frame::new(width, height, &picture.pixels, Some(&picture.frame)));
        picture.frame = Arc::clone(&frame);
        if let Some(tev) = &self.tev {
            tev.put(picture.size, &picture.pixels);
        }
        drop(picture);
        self.stage.show_frame(frame);
    }

    /// Shows a first, coarse image until there is a better one.
    pub fn show_coarse(&self, [width, height]: [u32; 2], pixels: &[[f32; 3]]) {
        let frame = Frame::new(width as usize, height as usize, pixels, None);
        self.stage.show_frame(Arc::new(frame));
    }

    /// Waits until tev has what is shown, but not for ever.
    pub fn end(&self) {
        if let Some(tev) = &self.tev {
            tev.empty();
        }
    }

    /// What is shown, coarse images left out.
    pub fn frame(&self) -> Arc<Frame> {
        Arc::clone(&lock(&self.picture).frame)
    }

    /// The standard errors of what is shown, NaN where they are not known, with its size.
    pub fn errors(&self) -> ([usize; 2], Pixels) {
        let picture = lock(&self.picture);
        (picture.size, picture.errors.clone())
    }

    pub fn pixel(&self, x: u32, y: u32) -> Option<Pixel> {
        let picture = lock(&self.picture);
        let [width, height] = picture.size;
        let (x, y) = (x as usize, y as usize);
        let at = (x < width && y < height).then_some(y * width + x)?;
        let error = picture.errors.get(at).copied().filter(|error| error.iter().all(|e| e.is_finite()));
        Some((*picture.pixels.get(at)?, error))
    }
}

impl Picture {
    fn lay(&mut self, shot: Shot) {
        let size = shot.size.map(|n| n as usize);
        let count = size[0] * size[1];
        if self.size != size {
            (self.size, self.pixels, self.errors) = (size, vec![[0.0; 3]; count], Vec::new());
        }
        self.errors.resize(count, [f32::NAN; 3]);
        let errors = shot.errors.unwrap_or_else(|| vec![[f32::NAN; 3]; shot.pixels.len()]);
        let width = shot.window.width() as usize;
        for (row, y) in (shot.window.y0..shot.window.y1).enumerate() {
            let from = row * width..(row + 1) * width;
            let start = y as usize * size[0] + shot.window.x0 as usize;
            for (all, part) in [(&mut self.pixels, &shot.pixels), (&mut self.errors, &errors)] {
                if let (Some(all), Some(part)) = (all.get_mut(start..start + width), part.get(from.clone())) {
                    all.copy_from_slice(part);
                }
            }
        }
    }
}

/// The last image that tev did not get yet: a tev that is slow or away holds nobody up.
#[derive(Default)]
struct Mailbox {
    post: Mutex<Post>,
    moved: Condvar,
}

#[derive(Default)]
struct Post {
    next: Option<([usize; 2], Pixels)>,
    /// Whether one is on its way.
    is_sending: bool,
}

impl Mailbox {
    fn start(mut tev: Tev, events: Sender<Event>) -> Arc<Self> {
        let mailbox = Arc::<Self>::default();
        let weak = Arc::downgrade(&mailbox);
        std::thread::spawn(move || {
            let mut is_away = false;
            while let Some(mailbox) = weak.upgrade() {
                let post = mailbox.moved.wait_while(lock(&mailbox.post), |post| post.next.is_none());
                let mut post = post.unwrap_or_else(PoisonError::into_inner);
                let Some(([width, height], pixels)) = post.next.take() else { continue };
                post.is_sending = true;
                drop(post);
                let shown = tev.show(width, height, &pixels);
                if let Some(message) = news(&tev, &shown, is_away) {
                    // Who hears it may have ended.
                    let _ = events.send(Event::Said(message));
                }
                is_away = shown.is_err();
                lock(&mailbox.post).is_sending = false;
                mailbox.moved.notify_all();
            }
        });
        mailbox
    }

    fn put(&self, size: [usize; 2], pixels: &[[f32; 3]]) {
        lock(&self.post).next = Some((size, pixels.to_vec()));
        self.moved.notify_all();
    }

    fn empty(&self) {
        let is_full = |post: &mut Post| post.next.is_some() || post.is_sending;
        // Who does not take it by then does not get it.
        let _ = self.moved.wait_timeout_while(lock(&self.post), FAREWELL, is_full);
    }
}

/// What is to be said where tev goes or comes.
fn news(tev: &Tev, shown: &io::Result<()>, was_away: bool) -> Option<Diagnostic> {
    let address = tev.address();
    match shown {
        Err(error) if !was_away => {
            let warning = Diagnostic::warning(format!("tev at {address} cannot be reached: {error}"));
            Some(warning.element("--tev").hint("start it; the next image tries again"))
        }
        Ok(()) if was_away => {
            Some(Diagnostic::note(format!("tev at {address} shows the image")).element("--tev"))
        }
        _ => None,
    }
}

/// What was written before a panic elsewhere is whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
