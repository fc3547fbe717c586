//! Nothing a scene can say may produce a number that is not one.

use super::*;

fn sound(x: f64) -> bool {
    x.is_finite() && x >= 0.0
}

#[test]
fn no_input_gives_nan_infinity_or_negative_light() {
    let mut rng = rng(30);
    for _ in 0..250_000 {
        let p = random_parameters(&mut rng);
        let bsdf = Bsdf::new(&p);
        let known = random_direction(&mut rng);
        for _ in 0..4 {
            let (u_lobe, u) = (rng.f64(), corner_or_inside(&mut rng));
            let other = random_direction(&mut rng);
            let sample = bsdf.sample(Side::TowardLight, known, u_lobe, u);
            if let Some(sample) = sample {
                assert!((sample.direction.length() - 1.0).abs() < 1e-9, "{p:?} {known} {u:?}");
            }
            for new in [Some(other), sample.map(|s| s.direction), Some(-known)].into_iter().flatten() {
                let all = bsdf.evaluate(new, known);
                let ok = all.value.is_finite()
                    && all.value.min_element() >= 0.0
                    && sound(all.toward_eye)
                    && sound(all.toward_light);
                assert!(ok, "{all:?} {p:?} {known} {new}");
            }
        }
        let weights = bsdf.lobe_weights(Side::TowardLight, known);
        let sum: f64 = weights.iter().sum();
        assert!(weights.iter().all(|&w| sound(w)) && (sum == 0.0 || (sum - 1.0).abs() < 1e-12), "{p:?}");
        let bound = bsdf.albedo_bound();
        assert!((0.0..=1.0).contains(&bound) && bsdf.albedo().is_finite());
    }
}

fn corner_or_inside(rng: &mut Rng) -> [f64; 2] {
    let one = |rng: &mut Rng| match rng.below(8) {
        0 => 0.0,
        1 => 0.5,
        2 => 1.0 - f64::EPSILON / 2.0,
        _ => rng.f64(),
    };
    [one(rng), one(rng)]
}

#[test]
fn parameters_out_of_range_are_brought_inside() {
    let bad = [f64::NAN, f64::INFINITY, -f64::INFINITY, -1.0, 7.0];
    for x in bad {
        let bsdf = Bsdf::new(&SurfaceParameters {
            base_color: Rgb::splat(x),
            diffuse_roughness: x,
            metallic: x,
            roughness: x,
            anisotropy: x,
            anisotropy_rotation: x,
            specular: x,
            specular_color: Rgb::splat(x),
            ior: x,
            dispersion: x,
            transmission: x,
            diffuse_transmission: x,
            diffuse_transmission_color: Rgb::splat(x),
            sheen_color: Rgb::splat(x),
            sheen_roughness: x,
            film: x,
            film_ior: x,
            film_thickness: x,
            thin_walled: false,
            coat: x,
            coat_roughness: x,
            coat_ior: x,
        });
        let all = bsdf.evaluate(at(0.5, 0.0), at(0.6, 2.0));
        assert!(all.value.is_finite() && sound(all.toward_eye));
    }
}

#[test]
fn surfaces_are_small_enough_to_copy() {
    assert!(size_of::<Bsdf>() <= 336, "{}", size_of::<Bsdf>());
}
