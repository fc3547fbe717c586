//! Albedos of anisotropic GGX interfaces, tabulated over both widths and the direction as the stretched, isotropic
//! configuration sees it (Heitz 2014, section 5.3): there they are smooth, while in true directions they change suddenly
//! where the view leaves the brushed axis.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3, DVec4};

use super::{
    albedo::{Albedo, integrate_direction},
    ggx::{Ggx, SMOOTH},
};

/// Nodes along √α of each axis, along √cosθ, and along a quarter of the azimuth.
const WIDTHS: usize = 16;
const COSINES: usize = 16;
const AZIMUTHS: usize = 7;

/// Albedos of one side for all pairs of widths.
#[derive(Debug)]
pub struct Stretched {
    /// Wide axis first; the entries of pairs that are not in that order are empty.
    pairs: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    albedos: [[[f32; 4]; AZIMUTHS]; COSINES],
    average: DVec4,
}

/// The interval of `n` nodes spaced like squares that holds `x`, and where in it.
fn locate(x: f64, n: usize) -> (usize, f64) {
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
        let empty = Entry { albedos: [[[0.0; 4]; AZIMUTHS]; COSINES], average: DVec4::ZERO };
        let pairs = (0..WIDTHS * WIDTHS).map(|i| (i / WIDTHS, i % WIDTHS));
        let entry = |(i, j)| if j <= i { Entry::integrate(width(i), width(j), eta) } else { empty.clone() };
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
        let albedos: [[[f32; 4]; AZIMUTHS]; COSINES] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let cos = node(i, COSINES).max(1e-5);
                let axis = DVec2::from_angle(FRAC_PI_2 * j as f64 / (AZIMUTHS - 1) as f64);
                let seen = (axis * (1.0 - cos * cos).sqrt()).extend(cos);
                let w = ggx.unstretch(seen);
                let found = integrate_direction(&ggx, w, eta, 12, TAU / 16.0, 16);
                found.to_table().to_array().map(|v| v as f32)
            })
        });
        let mut entry = Self { albedos, average: DVec4::ZERO };
        entry.average = entry.mean(&ggx);
        entry
    }

    fn at(&self, place: &Place, swapped: bool) -> DVec4 {
        let Place { column, x, step, y } = *place;
        let read = |column: usize, step: usize| {
            let step = if swapped { AZIMUTHS - 1 - step } else { step };
            DVec4::from_array(self.albedos[column][step].map(f64::from))
        };
        let along = |step| read(column, step) * (1.0 - x) + read(column + 1, step) * x;
        along(step) * (1.0 - y) + along(step + 1) * y
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

/// A direction located in an entry.
struct Place {
    column: usize,
    x: f64,
    step: usize,
    y: f64,
}

impl Place {
    fn new(ggx: &Ggx, w: DVec3) -> Self {
        let stretched = ggx.stretch(w).abs();
        let (column, x) = locate(stretched.z, COSINES);
        let turn = stretched.y.atan2(stretched.x) / FRAC_PI_2 * (AZIMUTHS - 1) as f64;
        let step = (turn as usize).min(AZIMUTHS - 2);
        Self { column, x, step, y: turn - step as f64 }
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
        assert!(worst[0] < 0.012 && worst[1] < 0.006, "{worst:?}");
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
