//! χ² tests of what is sampled against the density that is claimed for it.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Cells of the sphere in polar angle and in azimuth around Z.
const HEIGHTS: usize = 32;
const AZIMUTHS: usize = 64;

/// The cell of a unit direction.
pub fn cell(w: DVec3) -> usize {
    let polar = (w.z.clamp(-1.0, 1.0).acos() / PI * HEIGHTS as f64) as usize;
    let azimuth = (w.y.atan2(w.x) / TAU).rem_euclid(1.0) * AZIMUTHS as f64;
    polar.min(HEIGHTS - 1) * AZIMUTHS + (azimuth as usize).min(AZIMUTHS - 1)
}

/// Integral of `density` over each cell in solid angle, by adaptive quadrature over the polar and azimuthal angle.
pub fn integrals(density: &dyn Fn(DVec3) -> f64) -> Vec<f64> {
    let (step_polar, step_azimuth) = (PI / HEIGHTS as f64, TAU / AZIMUTHS as f64);
    let integrand = |polar: f64, azimuth: f64| {
        let (sin, cos) = polar.sin_cos();
        density(DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)) * sin
    };
    (0..HEIGHTS * AZIMUTHS)
        .map(|i| {
            let polar = (i / AZIMUTHS) as f64 * step_polar;
            let azimuth = (i % AZIMUTHS) as f64 * step_azimuth;
            integrate(&integrand, [polar, azimuth], [step_polar, step_azimuth], 0)
        })
        .collect()
}

/// Gauss–Legendre with 4 × 4 points, split into four while the parts disagree with the whole.
fn integrate(f: &dyn Fn(f64, f64) -> f64, from: [f64; 2], size: [f64; 2], depth: usize) -> f64 {
    let whole = gauss(f, from, size);
    let half = size.map(|s| 0.5 * s);
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
        .map(|[x, y]| [from[0] + x * half[0], from[1] + y * half[1]]);
    let parts: f64 = corners.iter().map(|&c| gauss(f, c, half)).sum();
    if depth == 7 || (whole - parts).abs() < 3e-7 + 1e-4 * parts {
        return parts;
    }
    corners.iter().map(|&c| integrate(f, c, half, depth + 1)).sum()
}

fn gauss(f: &dyn Fn(f64, f64) -> f64, from: [f64; 2], size: [f64; 2]) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
        (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
    ];
    let mut sum = 0.0;
    for (x, wx) in NODES {
        for (y, wy) in NODES {
            sum += wx * wy * f(from[0] + x * size[0], from[1] + y * size[1]);
        }
    }
    sum * size[0] * size[1]
}

/// Cells of a triangle, all of the same area: it is split into four alike parts, and these again and again.
pub const TRIANGLE_CELLS: usize = 64;

/// The cell of the point with barycentric weights `b1` and `b2` of the second and third corner.
pub fn triangle_cell([b1, b2]: [f64; 2]) -> usize {
    let mut weights = [1.0 - b1 - b2, b1, b2];
    let mut cell = 0;
    for _ in 0..TRIANGLE_CELLS.ilog(4) {
        // At a corner, or in the middle, which is turned around.
        let corner = weights.iter().position(|&weight| weight >= 0.5);
        weights = match corner {
            Some(corner) => std::array::from_fn(|i| 2.0 * weights[i] - f64::from(u8::from(i == corner))),
            None => weights.map(|weight| 1.0 - 2.0 * weight),
        };
        cell = 4 * cell + corner.unwrap_or(3);
    }
    cell
}

const RINGS: usize = 6;
const SECTORS: usize = 12;
/// Cells of the unit disc, all of the same area.
pub const DISC_CELLS: usize = RINGS * SECTORS;

/// The cell of a point of the unit disc.
pub fn disc_cell(p: DVec2) -> usize {
    let ring = (p.length_squared() * RINGS as f64) as usize;
    let sector = (p.y.atan2(p.x) / TAU).rem_euclid(1.0) * SECTORS as f64;
    ring.min(RINGS - 1) * SECTORS + (sector as usize).min(SECTORS - 1)
}

/// p-value of `n` samples of which each cell of `cells` should get the same share.
pub fn p_value_of_even(cells: usize, n: u32, mut sample: impl FnMut() -> usize) -> f64 {
    let mut counts = vec![0.0; cells];
    for _ in 0..n {
        counts[sample()] += 1.0;
    }
    p_value(counts.into_iter().map(|count| (f64::from(n) / cells as f64, count)))
}

/// p-value of counts, each with the count that is expected; cells of small expectation are taken together.
pub fn p_value(cells: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let mut cells: Vec<(f64, f64)> = cells.into_iter().collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut degrees, mut pool) = (0.0, -1.0, (0.0, 0.0));
    for (e, c) in cells {
        pool = (pool.0 + e, pool.1 + c);
        if pool.0 > 5.0 {
            statistic += (pool.1 - pool.0) * (pool.1 - pool.0) / pool.0;
            degrees += 1.0;
            pool = (0.0, 0.0);
        }
    }
    // A remainder that no density expects.
    if pool.1 > 5.0 + 10.0 * pool.0 {
        return 0.0;
    }
    if degrees < 1.0 {
        return 1.0;
    }
    1.0 - ChiSquared::new(degrees).unwrap().cdf(statistic)
}
