//! Albedos of anisotropic GGX interfaces, tabulated over both widths and the direction.
//!
//! How much facets hide from each other is smooth in the direction as the stretched, isotropic configuration sees it
//! (Heitz 2014, section 5.3), while in true directions it changes suddenly where the view leaves the brushed axis. How much
//! a facet reflects depends on the true cosine, which in turn changes suddenly in stretched directions. So the first is
//! tabulated over those, and the parts that are reflected and refracted over true ones.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3, DVec4};

use super::{
    albedo::{Albedo, integrate_direction},
    ggx::{Ggx, SMOOTH},
};

/// Nodes along √α of each axis, along √cosθ, along a quarter of the stretched azimuth, and along the square root of the
/// cosine of the true one.
const WIDTHS: usize = 16;
const COSINES: usize = 16;
const AZIMUTHS: usize = 7;
const TURNS: usize = 9;

/// Albedos of one side for all pairs of widths.
#[derive(Debug)]
pub struct Stretched {
    /// Wide axis first; the entries of pairs that are not in that order are empty.
    pairs: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    /// If facets reflected everything, over stretched directions.
    totals: [[f32; AZIMUTHS]; COSINES],
    /// All as parts of that, over true directions.
    parts: [[[f32; 4]; TURNS]; COSINES],
    average: DVec4,
}

impl Entry {
    const EMPTY: Self = Self {
        totals: [[0.0; AZIMUTHS]; COSINES],
        parts: [[[0.0; 4]; TURNS]; COSINES],
        average: DVec4::ZERO,
    };
}

/// The interval of `n` nodes spaced like squares that holds `x`, and where in it.
fn locate(x: f64, n: usize) -> Located {
    let last = (n - 1) as f64;
    let x = x.clamp(0.0, 1.0) * last * last;
    let index = (x.sqrt() as usize).min(n - 2);
    let i = index as f64;
    (index, (x - i * i) / (2.0 * i + 1.0))
}

fn node(i: usize, n: usize) -> f64 {
    (i as f64 / (n - 1) as f64).powi(2)
}

impl Stretched {
    /// For an index `eta` beyond over before.
    pub fn integrate(eta: f64) -> Self {
        let width = |i| node(i, WIDTHS).max(SMOOTH);
        let pairs = (0..WIDTHS * WIDTHS).map(|i| (i / WIDTHS, i % WIDTHS));
        let entry = |(i, j)| if j <= i { Entry::integrate(width(i), width(j), eta) } else { Entry::EMPTY };
        Self { pairs: pairs.map(entry).collect() }
    }

    /// Albedos of `ggx` in direction `w` with z > 0.
    pub fn albedo(&self, ggx: &Ggx, w: DVec3) -> Albedo {
        let place = Place::new(ggx, w);
        self.blend(ggx, |entry, swapped| entry.at(&place, swapped))
    }

    /// Cosine-weighted average over the hemisphere.
    pub fn average(&self, ggx: &Ggx) -> Albedo {
        self.blend(ggx, |entry, _| entry.average)
    }

    /// Interpolates between the widths; `read` is told whether the axes of an entry are swapped.
    fn blend(&self, ggx: &Ggx, read: impl Fn(&Entry, bool) -> DVec4) -> Albedo {
        let ((i, x), (j, y)) = (locate(ggx.wide(), WIDTHS), locate(ggx.narrow(), WIDTHS));
        let at = |i: usize, j: usize| {
            let swapped = j > i;
            read(&self.pairs[i.max(j) * WIDTHS + i.min(j)], swapped)
        };
        let along = |j| at(i, j) * (1.0 - x) + at(i + 1, j) * x;
        Albedo::from_table(along(j) * (1.0 - y) + along(j + 1) * y)
    }
}

impl Entry {
    fn integrate(wide: f64, narrow: f64, eta: f64) -> Self {
        let ggx = Ggx::along_tangent(wide, narrow);
        let at = |w: DVec3| integrate_direction(&ggx, w, eta, 12, TAU / 16.0, 16).to_table();
        let toward = |cos: f64, axis: DVec2| (axis * (1.0 - cos * cos).sqrt()).extend(cos);
        let cosines = std::array::from_fn(|i| node(i, COSINES).max(1e-5));
        let totals = cosines.map(|cos| {
            std::array::from_fn(|j| {
                let axis = DVec2::from_angle(FRAC_PI_2 * j as f64 / (AZIMUTHS - 1) as f64);
                at(ggx.unstretch(toward(cos, axis))).x as f32
            })
        });
        let parts = cosines.map(|cos| {
            std::array::from_fn(|j| {
                let along = node(j, TURNS);
                let found = at(toward(cos, DVec2::new(along, (1.0 - along * along).sqrt())));
                (found / found.x).to_array().map(|v| v as f32)
            })
        });
        let mut entry = Self { totals, parts, average: DVec4::ZERO };
        entry.average = entry.mean(&ggx);
        entry
    }

    fn at(&self, place: &Place, swapped: bool) -> DVec4 {
        let (column, step) = (place.column, place.step);
        let total = |column: usize, step: usize| {
            let step = if swapped { AZIMUTHS - 1 - step } else { step };
            DVec4::splat(f64::from(self.totals[column][step]))
        };
        let part = |column: usize, turn: usize| DVec4::from_array(self.parts[column][turn].map(f64::from));
        between(column, step, total) * between(place.cosine, place.turns[usize::from(swapped)], part)
    }

    /// Cosine-weighted average over a quarter of the hemisphere.
    fn mean(&self, ggx: &Ggx) -> DVec4 {
        const N: u32 = 24;
        let directions = (0..N * N).map(|i| {
            let [u, v] = [i / N, i % N].map(|k| (f64::from(k) + 0.5) / f64::from(N));
            (DVec2::from_angle(FRAC_PI_2 * u) * v.sqrt()).extend((1.0 - v).sqrt())
        });
        directions.map(|w| self.at(&Place::new(ggx, w), false)).sum::<DVec4>() / f64::from(N * N)
    }
}

/// Interpolates between four nodes.
fn between((i, x): Located, (j, y): Located, at: impl Fn(usize, usize) -> DVec4) -> DVec4 {
    let along = |j| at(i, j) * (1.0 - x) + at(i + 1, j) * x;
    along(j) * (1.0 - y) + along(j + 1) * y
}

/// An interval between nodes, and where in it.
type Located = (usize, f64);

/// A direction located in an entry.
struct Place {
    /// Cosine and azimuth of the stretched direction.
    column: Located,
    step: Located,
    /// Cosine of the true one, and that of its azimuth from the wide and from the narrow axis.
    cosine: Located,
    turns: [Located; 2],
}

impl Place {
    fn new(ggx: &Ggx, w: DVec3) -> Self {
        let stretched = ggx.stretch(w).abs();
        let turn = stretched.y.atan2(stretched.x) / FRAC_PI_2 * (AZIMUTHS - 1) as f64;
        let step = (turn as usize).min(AZIMUTHS - 2);
        let across = (stretched.truncate() / DVec2::new(ggx.wide(), ggx.narrow())).normalize_or(DVec2::X);
        Self {
            column: locate(stretched.z, COSINES),
            step: (step, turn - step as f64),
            cosine: locate(w.z.abs(), COSINES),
            turns: [locate(across.x, TURNS), locate(across.y, TURNS)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        rng::{Purpose, Rng},
        warp::square_to_cosine_hemisphere,
    };

    fn exact(ggx: &Ggx, w: DVec3) -> Albedo {
        integrate_direction(ggx, w, 1.5, 96, TAU / 96.0, 96)
    }

    /// Between nodes, too, and where the view leaves the brushed axis.
    #[test]
    fn albedos_are_those_of_the_lobe() {
        let table = Stretched::integrate(1.5);
        let mut rng = Rng::new(11, Purpose::Test, 0, 70);
        let mut worst = [0f64; 2];
        for _ in 0..300 {
            let wide = 0.05 + 0.95 * rng.f64();
            let ggx = Ggx::along_tangent(wide, wide * (0.02 + 0.98 * rng.f64()));
            let w = square_to_cosine_hemisphere(rng.pair());
            let (found, exact) = (table.albedo(&ggx, w), exact(&ggx, w));
            worst[0] = worst[0].max((found.total - exact.total).abs());
            worst[1] = worst[1].max((found.reflected - exact.reflected).abs());
        }
        println!("total within {:.4}, reflected within {:.4}", worst[0], worst[1]);
        assert!(worst[0] < 0.02 && worst[1] < 0.008, "{worst:?}");
    }

    #[test]
    fn averages_are_those_of_the_lobe() {
        let table = Stretched::integrate(1.5);
        for (wide, narrow) in [(0.366, 0.01), (0.5, 0.06), (1.0, 0.3)] {
            let ggx = Ggx::along_tangent(wide, narrow);
            let n = 16;
            let directions = (0..n * n).map(|i| {
                let [u, v] = [i / n, i % n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                (DVec2::from_angle(FRAC_PI_2 * u) * v.sqrt()).extend((1.0 - v).sqrt())
            });
            let mean = directions.map(|w| exact(&ggx, w).to_table()).sum::<DVec4>() / f64::from(n * n);
            let found = table.average(&ggx).to_table();
            assert!((found - mean).abs().max_element() < 0.006, "{wide} {narrow}: {found} {mean}");
        }
    }
}
