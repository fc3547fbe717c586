//! Chains of mirrors and lenses between two given ends (Jakob & Marschner 2012, "Manifold Exploration: A Markov Chain
//! Monte Carlo Technique for Rendering Scenes with Difficult Specular Transport").
//!
//! At a Dirac vertex x_i the vector h_i = η w_l + w_e has no part along the surface, where η is the ratio of the indices
//! of refraction on the light's and on the eye's side and 1 for mirrors. Moving the last vertex of a chain therefore moves
//! all others, by the derivatives of these conditions: `A_i dx_{i-1} + B_i dx_i + C_i dx_{i+1} = 0`.

use ajar_render::{
    World,
    bsdf::{Mode, Side},
    math::Frame,
    path::Vertex,
};
use glam::{DMat2, DVec2, DVec3};

use super::Reject;

/// Most steps of Newton's method.
const STEPS: usize = 20;
/// Least part of a step that is tried.
const LEAST_STEP: f64 = 1.0 / 64.0;
/// How near the chain has to come to its end, relative to the last edge; points on triangles are kept to some 10⁻⁷.
const TOLERANCE: f64 = 2e-6;

/// The directions to both neighbours at a Dirac vertex, and how far these are.
struct Neighbours {
    w_l: DVec3,
    /// 1/metres; 0 for a light infinitely far.
    near_l: f64,
    w_e: DVec3,
    near_e: f64,
}

impl Neighbours {
    fn of([before, here, after]: [&Vertex; 3]) -> Self {
        let toward = |other: &Vertex| {
            let d = other.p - here.p;
            let length = d.length();
            (d / length, 1.0 / length)
        };
        let (w_l, near_l) = if before.infinite() { (before.p, 0.0) } else { toward(before) };
        let (w_e, near_e) = toward(after);
        Self { w_l, near_l, w_e, near_e }
    }
}

/// The part of the displacement `d` that turns the direction `w`.
fn across(w: DVec3, d: DVec3) -> DVec3 {
    d - w * w.dot(d)
}

/// How x_1 moves along its surface when the last vertex moves along its own: both in the orthonormal directions of
/// [`World::differential`], the last one in those of its geometric normal's frame. `chain` is x_0 x_1 … x_n x_{n+1}, from the
/// light's side, all but the ends Dirac events. `None` where a condition has no derivative.
fn derivative(world: &World, chain: &[Vertex]) -> Option<DMat2> {
    let mut total = DMat2::IDENTITY;
    let mut before = None::<([DVec3; 2], DMat2)>;
    for (i, here) in chain.iter().enumerate().take(chain.len() - 1).skip(1) {
        let at = Neighbours::of([&chain[i - 1], here, &chain[i + 1]]);
        let surface = world.differential(here)?;
        let along_after = if i + 2 == chain.len() {
            let Frame { x, y, .. } = Frame::from_z(chain[i + 1].ng);
            [x, y]
        } else {
            world.differential(&chain[i + 1])?.along
        };
        let known = here.frame.to_local(at.w_e);
        let eta = match here.mode {
            Mode::Smooth | Mode::DeltaReflect => 1.0,
            refracts => here.bsdf.delta(Side::TowardLight, known, refracts)?.eta_scale.sqrt(),
        };
        let height = (at.w_l * eta + at.w_e).dot(here.frame.z);
        let tangents = [here.frame.x, here.frame.y];
        let matrix = |column: &dyn Fn(usize) -> DVec3| {
            let entry = |j: usize| DVec2::from(tangents.map(|t| t.dot(column(j))));
            DMat2::from_cols(entry(0), entry(1))
        };
        let by_light = |d: DVec3| across(at.w_l, d) * (eta * at.near_l);
        let by_eye = |d: DVec3| across(at.w_e, d) * at.near_e;
        let own =
            matrix(&|j| -by_light(surface.along[j]) - by_eye(surface.along[j]) - surface.normal[j] * height);
        let from_before = match before {
            Some((along, moved)) => matrix(&|j| by_light(along[j])) * moved,
            None => DMat2::ZERO,
        };
        let system = own + from_before;
        let solved = system.inverse() * matrix(&|j| -by_eye(along_after[j]));
        if !solved.is_finite() {
            return None;
        }
        total *= solved;
        before = Some((surface.along, solved));
    }
    Some(total)
}

/// |dω⊥/dA|: projected solid angle at x_0 for each area at the last vertex of a chain; for a light infinitely far area
/// perpendicular to its direction.
pub fn generalized_geometry(world: &World, chain: &[Vertex]) -> Option<f64> {
    let [first, second, ..] = chain else { return None };
    let spread = derivative(world, chain)?.determinant().abs();
    if first.infinite() {
        return Some(spread * second.projected(first.p));
    }
    let d = second.p - first.p;
    let square = d.length_squared();
    let w = d / square.sqrt();
    Some(spread * first.projected(w) * second.projected(w) / square)
}

/// Looks for chains.
pub struct Walker<'w> {
    /// The scene.
    pub world: &'w World,
    /// Rays cast.
    pub rays: u64,
}

impl Walker<'_> {
    /// Moves the end of `chain` (as in [`derivative`]) to `target` while its beginning stays, by Newton's method: `chain`
    /// becomes the new one, its last vertex `target`.
    ///
    /// # Errors
    /// No chain of the same kind of events was found.
    pub fn move_end(&mut self, chain: &mut Vec<Vertex>, target: &Vertex) -> Result<(), Reject> {
        let mut part = 1.0;
        let mut trial = Vec::with_capacity(chain.len());
        for _ in 0..STEPS {
            let [.., before, end] = chain.as_slice() else { return Err(Reject::Unsuitable) };
            let missing = target.p - end.p;
            if missing.length() <= TOLERANCE * (end.p - before.p).length() + target.rounding {
                chain.pop();
                chain.push(*target);
                return Ok(());
            }
            let moved = derivative(self.world, chain).ok_or(Reject::Unsuitable)?;
            let frame = Frame::from_z(end.ng);
            let step = moved * DVec2::new(missing.dot(frame.x), missing.dot(frame.y)) * part;
            let along = self.world.differential(&chain[1]).ok_or(Reject::Unsuitable)?.along;
            let aim = chain[1].p + along[0] * step.x + along[1] * step.y;
            let nearer = self.trace(chain, aim, &mut trial).is_some_and(|end| {
                end.ng.dot(target.ng) > 0.0 && (target.p - end.p).length() < missing.length()
            });
            if nearer {
                std::mem::swap(chain, &mut trial);
                part = f64::min(1.0, 2.0 * part);
            } else {
                part *= 0.5;
                if part < LEAST_STEP {
                    break;
                }
            }
        }
        Err(Reject::Lost)
    }

    /// Follows the events of `chain` from its first vertex by way of `aim`, into `found`; answers with the end.
    fn trace<'f>(&mut self, chain: &[Vertex], aim: DVec3, found: &'f mut Vec<Vertex>) -> Option<&'f Vertex> {
        let first = chain[0];
        found.clear();
        found.push(first);
        let (mut origin, mut direction);
        if first.infinite() {
            direction = -first.p;
            origin = aim - direction * (2.0 * self.world.lights.reach());
        } else {
            direction = (aim - first.p).try_normalize()?;
            origin = first.leave(direction);
        }
        for old in &chain[1..] {
            self.rays += 1;
            let mut vertex = self.world.trace(origin, direction, false, 0)?;
            if old.mode != Mode::Smooth {
                let step = vertex.dirac_step(Side::TowardEye, -direction, old.mode)?;
                vertex.mode = old.mode;
                direction = step.direction;
                origin = vertex.leave(direction);
            }
            found.push(vertex);
        }
        found.last()
    }
}
