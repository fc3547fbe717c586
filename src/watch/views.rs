//! What pages can look at besides the image: what the camera sees first, and how sure the image is. Each is made when a page
//! asks for it, as codes for the screen, for nothing of it is light.

use std::sync::{Arc, Mutex, PoisonError};

use ajar_integrators::{
    Window,
    features::{Features, features_of},
};
use ajar_live::frame::Frame;
use ajar_output::srgb_encode;
use ajar_render::World;
use glam::Vec3;
use rayon::ThreadPoolBuilder;

use super::screen::{Pixels, Screen};
use crate::image::Aov;

/// Eye samples a pixel: files have more, pages cannot wait for them.
const SAMPLES: u32 = 4;
/// The share of values at either end that may lie outside what is told apart.
const TAIL: f64 = 0.02;

/// What there is to be looked at.
pub(super) struct Views {
    screen: Arc<Screen>,
    /// The number of the image and what it is of.
    shown: Mutex<Option<(u64, Arc<World>)>>,
    /// The view that was made last, of which image. Those who want one while another is made wait for each other.
    last: Mutex<Option<(u64, Aov, Arc<Frame>)>>,
}

impl Views {
    pub fn new(screen: Arc<Screen>) -> Self {
        Self { screen, shown: Mutex::default(), last: Mutex::default() }
    }

    /// From now on it is this.
    pub fn show(&self, image: u64, world: &Arc<World>) {
        *self.shown.lock().unwrap_or_else(PoisonError::into_inner) = Some((image, Arc::clone(world)));
    }

    /// The view of a name that `--aov` knows.
    pub fn get(&self, name: &str) -> Option<Arc<Frame>> {
        let aov = Aov::parse(name).ok()?;
        if aov == Aov::Variance {
            let ([width, height], errors) = self.screen.errors();
            return Some(Arc::new(at_once(|| Frame::new(width, height, &errors_of(errors), None))));
        }
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let (image, world) = self.shown.lock().unwrap_or_else(PoisonError::into_inner).clone()?;
        if let Some((.., frame)) = last.as_ref().filter(|it| (it.0, it.1) == (image, aov)) {
            return Some(Arc::clone(frame));
        }
        let (width, height) = (world.camera.width, world.camera.height);
        let window = Window { x0: 0, y0: 0, x1: width, y1: height };
        let frame = Arc::new(at_once(|| {
            let hits = features_of(&world, window, SAMPLES);
            Frame::new(width as usize, height as usize, &codes(aov, &hits), None)
        }));
        *last = Some((image, aov, Arc::clone(&frame)));
        Some(frame)
    }
}

/// Works on threads of its own: those of the render take nothing else on before the end of a round.
fn at_once<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match ThreadPoolBuilder::new().num_threads(rayon::current_num_threads()).build() {
        Ok(pool) => pool.install(work),
        // There are no threads to be had.
        Err(_) => work(),
    }
}

/// A view of first hits: codes for the screen, 0 to 1.
fn codes(aov: Aov, hits: &[Features]) -> Pixels {
    let each = |code: &dyn Fn(&Features) -> Vec3| hits.iter().map(|hit| code(hit).to_array()).collect();
    let direction = |v: Vec3, alpha: f32| (v + alpha) / 2.0;
    match aov {
        Aov::Albedo => each(&|hit| encoded(hit.albedo)),
        Aov::Normal => each(&|hit| direction(hit.normal, hit.alpha)),
        Aov::GeometricNormal => each(&|hit| direction(hit.geometric_normal, hit.alpha)),
        Aov::Depth => {
            let range = range(hits.iter().filter(|hit| hit.depth > 0.0).map(|hit| hit.depth));
            // Near is bright; the farthest are still told from nothing.
            each(&|hit| Vec3::splat(if hit.depth > 0.0 { 1.0 - 0.9 * within(hit.depth, range) } else { 0.0 }))
        }
        Aov::Position => {
            let seen = || hits.iter().filter(|hit| hit.object > 0);
            let ranges = [0, 1, 2].map(|axis| range(seen().map(|hit| hit.position[axis])));
            let code = |p: Vec3| Vec3::from_array([0, 1, 2].map(|axis| within(p[axis], ranges[axis])));
            each(&|hit| if hit.object > 0 { code(hit.position) } else { Vec3::ZERO })
        }
        Aov::Uv => each(&|hit| Vec3::new(hit.uv.x.rem_euclid(1.0), hit.uv.y.rem_euclid(1.0), 0.0)),
        Aov::MaterialId => each(&|hit| color_of(hit.material)),
        Aov::ObjectId => each(&|hit| color_of(hit.object)),
        Aov::Variance => Vec::new(),
    }
}

/// Standard errors, the largest white; black where they are not known.
fn errors_of(errors: Pixels) -> Pixels {
    let known = errors.iter().flatten().copied().filter(|error| error.is_finite());
    let (_, most) = range(known);
    let code = |error: [f32; 3]| encoded(Vec3::from_array(error.map(|e| within(e, (0.0, most)))));
    errors.into_iter().map(|error| code(error).to_array()).collect()
}

fn encoded(light: Vec3) -> Vec3 {
    Vec3::from_array(light.to_array().map(|x| srgb_encode(x.clamp(0.0, 1.0))))
}

/// Between which values most are.
fn range(values: impl Iterator<Item = f32>) -> (f32, f32) {
    let mut values: Vec<f32> = values.collect();
    values.sort_unstable_by(f32::total_cmp);
    let at = |share: f64| values.get((share * values.len().saturating_sub(1) as f64) as usize).copied();
    (at(TAIL).unwrap_or(0.0), at(1.0 - TAIL).unwrap_or(0.0))
}

/// Where a value is in a range, 0 to 1; NaN is at its beginning.
fn within(value: f32, (low, high): (f32, f32)) -> f32 {
    if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0).max(0.0) } else { 0.0 }
}

/// A colour for a number, far from those of its neighbours; black for 0, which is nothing.
fn color_of(number: u32) -> Vec3 {
    if number == 0 {
        return Vec3::ZERO;
    }
    // Steps of the golden ratio around the colour wheel never come close to where they were soon.
    let hue = (f64::from(number) * 0.618_033_988_749_895).fract() as f32 * 6.0;
    let part = |offset: f32| ((hue + offset).rem_euclid(6.0) - 3.0).abs() - 1.0;
    let wheel = Vec3::new(part(0.0), part(4.0), part(2.0)).clamp(Vec3::ZERO, Vec3::ONE);
    let shade = if number.is_multiple_of(2) { 0.7 } else { 0.95 };
    (wheel * 0.75 + 0.25) * shade
}

#[cfg(test)]
mod tests {
    use std::{
        sync::atomic::{AtomicBool, AtomicUsize, Ordering},
        time::{Duration, Instant},
    };

    use ajar_live::server::Stage;
    use rayon::prelude::*;

    use super::*;
    use crate::watch::screen::Shot;

    fn hit(depth: f32, object: u32) -> Features {
        Features { depth, object, material: object, alpha: 1.0, normal: Vec3::Y, ..Features::default() }
    }

    #[test]
    fn what_is_asked_for_comes_while_others_work() {
        let (sender, _events) = std::sync::mpsc::channel();
        let screen = Arc::new(Screen::new(Stage::default(), None, sender));
        let size = [130, 70];
        let window = Window { x0: 0, y0: 0, x1: size[0], y1: size[1] };
        let values = vec![[1.0; 3]; 130 * 70];
        screen.show(Shot { size, window, pixels: values.clone(), errors: Some(values) });
        let views = Views::new(screen);
        // Every thread of the render is busy until told, or for as long as nobody should wait.
        let busy = Arc::new((AtomicBool::new(true), AtomicUsize::new(0)));
        for _ in 0..rayon::current_num_threads() {
            let busy = Arc::clone(&busy);
            rayon::spawn(move || {
                let started = Instant::now();
                while busy.0.load(Ordering::SeqCst) && started.elapsed() < Duration::from_secs(20) {
                    std::thread::yield_now();
                }
                busy.1.fetch_add(usize::from(busy.0.load(Ordering::SeqCst)), Ordering::SeqCst);
            });
        }
        let sum: usize = at_once(|| (0..100usize).into_par_iter().sum());
        let has_errors = views.get("variance").is_some();
        busy.0.store(false, Ordering::SeqCst);
        assert_eq!((sum, has_errors, busy.1.load(Ordering::SeqCst)), (4950, true, 0));
    }

    #[test]
    fn near_is_bright_and_nothing_is_black() {
        let hits = [hit(1.0, 1), hit(2.0, 2), hit(4.0, 3), Features::default()];
        let seen: Vec<_> = codes(Aov::Depth, &hits).iter().map(|code| code[0]).collect();
        assert!(seen[0] > seen[1] && seen[1] >= seen[2] && seen[2] > 0.0 && seen[3] == 0.0, "{seen:?}");
    }

    #[test]
    fn normals_are_centred_where_something_is() {
        assert_eq!(codes(Aov::Normal, &[hit(1.0, 1), Features::default()]), [[0.5, 1.0, 0.5], [0.0; 3]]);
    }

    #[test]
    fn numbers_have_colours_of_their_own() {
        let colors: Vec<_> = (0..100).map(color_of).collect();
        assert_eq!(colors[0], Vec3::ZERO);
        let near = |a: Vec3, b: Vec3| (a - b).abs().max_element() < 0.01;
        for (i, color) in colors.iter().enumerate().skip(1) {
            assert!(color.min_element() >= 0.0 && color.max_element() <= 1.0 && !near(*color, Vec3::ZERO));
            assert!(colors.iter().skip(i + 1).take(12).all(|other| !near(*color, *other)), "{i}");
        }
    }

    #[test]
    fn errors_that_are_not_known_are_black() {
        let codes = errors_of(vec![[f32::NAN; 3], [0.0; 3], [1.0; 3], [2.0; 3]]);
        assert_eq!((codes[0], codes[1]), ([0.0; 3], [0.0; 3]));
        assert!(codes[2][0] > 0.0 && codes[3][0] >= codes[2][0]);
        assert!(errors_of(Vec::new()).is_empty());
    }
}
