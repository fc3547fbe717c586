//! Reflectance and refraction at smooth boundaries between non-absorbing media.

use glam::DVec3;

use crate::math::Rgb;

/// Unpolarized reflectance for the incident cosine `cos` ≥ 0; `eta` is the index beyond over the index before the
/// boundary. 1 under total internal reflection.
pub fn dielectric(cos: f64, eta: f64) -> f64 {
    let sin2_beyond = (1.0 - cos * cos) / (eta * eta);
    if sin2_beyond >= 1.0 {
        return 1.0;
    }
    let cos_beyond = (1.0 - sin2_beyond).sqrt();
    let s = (cos - eta * cos_beyond) / (cos + eta * cos_beyond);
    let p = (eta * cos - cos_beyond) / (eta * cos + cos_beyond);
    (0.5 * (s * s + p * p)).min(1.0)
}

/// Schlick's weight of the grazing colour, (1 − cos)⁵.
pub fn edge_weight(cos: f64) -> f64 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Schlick's reflectance of a metal of colour `normal` at normal incidence.
pub fn metal(normal: Rgb, cos: f64) -> Rgb {
    normal + (Rgb::ONE - normal) * edge_weight(cos)
}

/// The direction into which `w` (pointing away from the boundary, on the side of the normal `n`) refracts, `None` under
/// total internal reflection; `eta` as in [`dielectric`].
pub fn refract(w: DVec3, n: DVec3, eta: f64) -> Option<DVec3> {
    let cos = w.dot(n);
    let sin2_beyond = (1.0 - cos * cos).max(0.0) / (eta * eta);
    if sin2_beyond >= 1.0 {
        return None;
    }
    let cos_beyond = (1.0 - sin2_beyond).sqrt();
    (n * (cos / eta - cos_beyond) - w / eta).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_has_its_known_values_and_is_reciprocal() {
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-15);
        assert_eq!(dielectric(0.0, 1.5), 1.0);
        assert_eq!(dielectric(0.5, 1.0 / 1.5), 1.0);
        for i in 1..100 {
            let cos = f64::from(i) / 100.0;
            let beyond = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
            assert!((dielectric(cos, 1.5) - dielectric(beyond, 1.0 / 1.5)).abs() < 1e-13);
            assert!((dielectric(cos, 1.0)).abs() < 1e-15);
        }
        let brewster = (1.0 / (1.0f64 + 2.25)).sqrt();
        let (sin, beyond) = ((1.0 - brewster * brewster).sqrt(), 1.5 * brewster);
        let s = (brewster - 1.5 * beyond.min(sin)) / (brewster + 1.5 * beyond.min(sin));
        assert!((dielectric(brewster, 1.5) - 0.5 * s * s).abs() < 1e-12);
    }

    #[test]
    fn refraction_obeys_snell() {
        let w = DVec3::new(0.6, 0.0, 0.8);
        let t = refract(w, DVec3::Z, 1.5).unwrap();
        assert!((t - DVec3::new(-0.4, 0.0, -(1.0f64 - 0.16).sqrt())).length() < 1e-15);
        assert!(refract(DVec3::new(0.8, 0.0, 0.6), DVec3::Z, 1.0 / 1.5).is_none());
        let back = refract(t, -DVec3::Z, 1.0 / 1.5).unwrap();
        assert!((back - w).length() < 1e-15);
    }
}
