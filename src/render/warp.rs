//! Maps from the unit square to the domains that get sampled, area-preserving and with exact inverses.
//!
//! Every warp is a bijection up to sets of measure zero, and its inverse undoes it to rounding, because Metropolis moves
//! perturb a path by inverting the samplers that made it. Density is constant in the measure named with each warp, and
//! `u` lies in [0, 1)².

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, PI, TAU};

use glam::{DVec2, DVec3};

/// Concentric map to the unit disc (Shirley and Chiu 1997), uniform in area: density 1/π.
#[inline]
pub fn square_to_disc(u: [f64; 2]) -> DVec2 {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    if a.abs() > b.abs() {
        let (sin, cos) = sin_cos_of_eighth(FRAC_PI_4 * b / a);
        DVec2::new(a * cos, a * sin)
    } else {
        let (sin, cos) = sin_cos_of_eighth(FRAC_PI_4 * a / b);
        DVec2::new(b * sin, b * cos)
    }
}

/// Sine and cosine of |x| ≤ π/4, where Taylor's series to the order of x¹⁶ are exact but for rounding: a fraction of the
/// time that functions for all numbers take, and the same on every system.
#[inline]
fn sin_cos_of_eighth(x: f64) -> (f64, f64) {
    const SIN: [f64; 7] = [
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 1_307_674_368_000.0,
    ];
    const COS: [f64; 8] = [
        -1.0 / 2.0,
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        -1.0 / 87_178_291_200.0,
        1.0 / 20_922_789_888_000.0,
    ];
    let square = x * x;
    let (mut sin, mut cos) = (0.0, COS[7]);
    for k in (0..7).rev() {
        sin = sin * square + SIN[k];
        cos = cos * square + COS[k];
    }
    (x + x * square * sin, 1.0 + square * cos)
}

/// Inverse of [`square_to_disc`]; points outside the disc land outside the square or are clamped onto its border by
/// rounding only.
pub fn disc_to_square(p: DVec2) -> [f64; 2] {
    let radius = p.length();
    if radius == 0.0 {
        return [0.5; 2];
    }
    let (a, b) = if p.x.abs() > p.y.abs() {
        let a = radius.copysign(p.x);
        (a, a * (p.y / p.x).atan() / FRAC_PI_4)
    } else {
        let b = radius.copysign(p.y);
        (b * (p.x / p.y).atan() / FRAC_PI_4, b)
    };
    [inside(0.5 * (a + 1.0)), inside(0.5 * (b + 1.0))]
}

/// Keeps an inverse that rounding has pushed out of [0, 1) inside.
fn inside(u: f64) -> f64 {
    const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
    u.clamp(0.0, BELOW_ONE)
}

/// Direction around +Z with density [`cosine_hemisphere_pdf`] in solid angle (Malley's method).
#[inline]
pub fn square_to_cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let p = square_to_disc(u);
    p.extend((1.0 - p.length_squared()).max(0.0).sqrt())
}

/// Inverse of [`square_to_cosine_hemisphere`] for a unit vector with z ≥ 0.
pub fn cosine_hemisphere_to_square(w: DVec3) -> [f64; 2] {
    disc_to_square(w.truncate())
}

/// cosθ/π per steradian, 0 below the horizon.
pub fn cosine_hemisphere_pdf(cos: f64) -> f64 {
    cos.max(0.0) * FRAC_1_PI
}

/// Direction on the unit sphere, uniform in solid angle: density 1/4π. `u[0]` is height (0 at +Z), `u[1]` longitude.
pub fn square_to_sphere(u: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * u[0];
    let radius = 2.0 * (u[0] * (1.0 - u[0])).max(0.0).sqrt();
    let (sin, cos) = (TAU * u[1]).sin_cos();
    DVec3::new(radius * cos, radius * sin, z)
}

/// Inverse of [`square_to_sphere`] for a unit vector.
pub fn sphere_to_square(w: DVec3) -> [f64; 2] {
    let ring = w.truncate().length_squared();
    let height = if w.z > 0.0 { 0.5 * ring / (1.0 + w.z) } else { 1.0 - 0.5 * ring / (1.0 - w.z) };
    let longitude = w.y.atan2(w.x) / TAU;
    [inside(height), inside(if longitude < 0.0 { longitude + 1.0 } else { longitude })]
}

/// Direction in the cone around +Z with cosθ ≥ `cos_max`, uniform in solid angle: density [`cone_pdf`]. Concentric, so
/// neighbours in the square stay neighbours; accurate for cones as thin as the sun's and as wide as the sphere.
pub fn square_to_cone(u: [f64; 2], cos_max: f64) -> DVec3 {
    disc_to_cone(square_to_disc(u), cos_max)
}

/// The second half of [`square_to_cone`]: from a point of the unit disc.
pub fn disc_to_cone(p: DVec2, cos_max: f64) -> DVec3 {
    let height = (1.0 - cos_max) * p.length_squared();
    let xy = p * ((1.0 - cos_max) * (2.0 - height)).max(0.0).sqrt();
    xy.extend(1.0 - height)
}

/// Inverse of [`square_to_cone`] for a unit vector; `None` outside the cone.
pub fn cone_to_square(w: DVec3, cos_max: f64) -> Option<[f64; 2]> {
    let ring = w.truncate().length_squared();
    let height = if w.z > 0.0 { ring / (1.0 + w.z) } else { 1.0 - w.z };
    let rest = if w.z > 0.0 { 1.0 + w.z } else { ring / (1.0 - w.z) };
    if height > (1.0 - cos_max) * (1.0 + 1e-9) {
        return None;
    }
    let scale = ((1.0 - cos_max) * rest).sqrt();
    Some(disc_to_square(if scale > 0.0 { w.truncate() / scale } else { DVec2::ZERO }))
}

/// Density per steradian inside the cone with cosθ ≥ `cos_max`.
pub fn cone_pdf(cos_max: f64) -> f64 {
    1.0 / (2.0 * PI * (1.0 - cos_max))
}

/// Barycentric weights `[b1, b2]` of a triangle's second and third corner (the first has `1 − b1 − b2`), uniform in area:
/// density 1/area.
#[inline]
pub fn square_to_triangle(u: [f64; 2]) -> [f64; 2] {
    let root = u[0].sqrt();
    [1.0 - root, u[1] * root]
}

/// Inverse of [`square_to_triangle`].
pub fn triangle_to_square(bary: [f64; 2]) -> [f64; 2] {
    let root = 1.0 - bary[0];
    [inside(root * root), if root > 0.0 { inside(bary[1] / root) } else { 0.0 }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        chi2::{
            DISC_CELLS, TRIANGLE_CELLS, cell, disc_cell, integrals, p_value, p_value_of_even, triangle_cell,
        },
        rng::{Purpose, Rng},
    };

    const SAMPLES: u32 = 200_000;

    fn close(a: [f64; 2], b: [f64; 2]) {
        assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9, "{a:?} {b:?}");
    }

    #[test]
    fn inverses_undo_the_warps() {
        let mut rng = Rng::new(1, Purpose::Test, 0, 0);
        for _ in 0..20_000 {
            let u = rng.pair();
            close(disc_to_square(square_to_disc(u)), u);
            close(cosine_hemisphere_to_square(square_to_cosine_hemisphere(u)), u);
            close(sphere_to_square(square_to_sphere(u)), u);
            close(triangle_to_square(square_to_triangle(u)), u);
            for cos_max in [0.999_99, 0.7, 0.0, -0.6] {
                close(cone_to_square(square_to_cone(u, cos_max), cos_max).unwrap(), u);
            }
        }
        for u in [[0.5; 2], [0.0, 0.0], [0.0, 0.5], [0.5, 0.0], [0.25, 0.25], [0.75, 0.25]] {
            close(disc_to_square(square_to_disc(u)), u);
        }
    }

    #[test]
    fn short_series_are_sine_and_cosine() {
        for i in -1000..=1000 {
            let x = FRAC_PI_4 * f64::from(i) / 1000.0;
            let (sin, cos) = sin_cos_of_eighth(x);
            assert!((sin - x.sin()).abs() <= 2e-16 && (cos - x.cos()).abs() <= 2.3e-16, "{x}");
        }
    }

    #[test]
    fn directions_are_unit_and_inside() {
        let mut rng = Rng::new(2, Purpose::Test, 0, 0);
        for _ in 0..20_000 {
            let u = rng.pair();
            assert!(square_to_disc(u).length() <= 1.0 + 1e-15);
            assert!(square_to_cosine_hemisphere(u).z >= 0.0);
            let [b1, b2] = square_to_triangle(u);
            assert!(b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0 + 1e-15);
            for w in [
                square_to_cosine_hemisphere(u),
                square_to_sphere(u),
                square_to_cone(u, 0.9),
                square_to_cone(u, -1.0),
            ] {
                assert!((w.length() - 1.0).abs() < 1e-12);
            }
            assert!(square_to_cone(u, 0.9).z >= 0.9 - 1e-15);
        }
        assert!(cone_to_square(DVec3::X, 0.5).is_none());
    }

    /// Means of a few polynomials, to four digits.
    #[test]
    fn moments_match_the_densities() {
        let n = 512;
        let mut sums = [0.0; 8];
        for i in 0..n * n {
            let u = [((i % n) as f64 + 0.5) / n as f64, ((i / n) as f64 + 0.5) / n as f64];
            let disc = square_to_disc(u);
            let (cosine, sphere, cone) =
                (square_to_cosine_hemisphere(u), square_to_sphere(u), square_to_cone(u, 0.5));
            let [b1, b2] = square_to_triangle(u);
            let terms = [
                disc.x * disc.x,
                disc.x.powi(2) * disc.y.powi(2),
                cosine.z,
                sphere.z * sphere.z,
                sphere.x * sphere.x,
                cone.z,
                b1 * b2,
                b2 * b2,
            ];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term / (n * n) as f64);
        }
        let expected =
            [1.0 / 4.0, 1.0 / 24.0, 2.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 3.0 / 4.0, 1.0 / 12.0, 1.0 / 6.0];
        for (sum, expected) in sums.iter().zip(expected) {
            assert!((sum - expected).abs() < 1e-4, "{sum} {expected}");
        }
    }

    /// Cells are told from the points alone: an uneven warp with the right inverse would fill its own evenly.
    #[test]
    fn discs_and_triangles_are_filled_evenly() {
        let mut rng = Rng::new(3, Purpose::Test, 0, 0);
        let mut disc = |bend: f64| {
            p_value_of_even(DISC_CELLS, SAMPLES, || {
                let p = square_to_disc(rng.pair());
                disc_cell(p * p.length().powf(bend))
            })
        };
        let (even, uneven) = (disc(0.0), disc(0.05));
        assert!(even > 1e-4 && uneven < 1e-4, "{even} {uneven}");
        let mut triangle = |bend: f64| {
            p_value_of_even(TRIANGLE_CELLS, SAMPLES, || {
                let [u, v] = rng.pair();
                triangle_cell(square_to_triangle([u.powf(1.0 + bend), v]))
            })
        };
        let (even, uneven) = (triangle(0.0), triangle(0.05));
        assert!(even > 1e-4 && uneven < 1e-4, "{even} {uneven}");
    }

    #[test]
    fn directions_follow_their_densities() {
        const COS_MAX: f64 = std::f64::consts::FRAC_1_SQRT_2;
        let mut rng = Rng::new(4, Purpose::Test, 0, 0);
        let mut check = |sample: &dyn Fn([f64; 2]) -> DVec3, density: &dyn Fn(DVec3) -> f64| {
            let expected = integrals(density);
            let mut counts = vec![0.0; expected.len()];
            (0..SAMPLES).for_each(|_| counts[cell(sample(rng.pair()))] += 1.0);
            p_value(expected.into_iter().map(|p| p * f64::from(SAMPLES)).zip(counts))
        };
        let cone = |w: DVec3| if w.z > COS_MAX { cone_pdf(COS_MAX) } else { 0.0 };
        for (name, p, wrong) in [
            (
                "hemisphere",
                check(&square_to_cosine_hemisphere, &|w| cosine_hemisphere_pdf(w.z)),
                check(&square_to_cosine_hemisphere, &|w| w.z.max(0.0).powf(1.1) * 1.05 * FRAC_1_PI),
            ),
            (
                "sphere",
                check(&square_to_sphere, &|_| 0.25 * FRAC_1_PI),
                check(&square_to_sphere, &|w| 0.25 * FRAC_1_PI * (1.0 + 0.1 * w.x)),
            ),
            (
                "cone",
                check(&|u| square_to_cone(u, COS_MAX), &cone),
                check(&|u| square_to_cone(u, COS_MAX), &|w| cone(w) * (1.0 + 0.1 * w.x)),
            ),
        ] {
            assert!(p > 1e-4 && wrong < 1e-4, "{name}: {p} {wrong}");
        }
    }
}
