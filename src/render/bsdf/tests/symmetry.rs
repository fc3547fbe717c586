//! Both ways of walking a path must see the same surface.

use super::*;

/// Index of refraction of each channel on the side of `w`.
fn index(p: &SurfaceParameters, w: DVec3) -> Rgb {
    let solid = p.transmission > 0.0 && p.metallic < 1.0 && !p.thin_walled;
    let [red, blue] = p.dispersed_indices().unwrap_or([p.ior; 2]);
    let inside = Rgb::new(red, p.ior, blue).map(|n| if n < 1.001 { 1.0 } else { n });
    if solid && w.z < 0.0 { inside } else { Rgb::ONE }
}

/// f(a→b)/η_b² = f(b→a)/η_a².
#[test]
fn surfaces_are_reciprocal() {
    let mut rng = rng(20);
    let mut nonzero = 0;
    for _ in 0..100_000 {
        let mut p = random_parameters(&mut rng);
        if p.transmission > 0.0 {
            p.diffuse_transmission = 0.0;
        }
        let bsdf = Bsdf::new(&p);
        let (a, b) = (random_direction(&mut rng), random_direction(&mut rng));
        let there = bsdf.eval(a, b) / index(&p, b).powf(2.0);
        let back = bsdf.eval(b, a) / index(&p, a).powf(2.0);
        let scale = there.max_element().max(1e-12);
        assert!((there - back).abs().max_element() < 1e-8 * scale, "{there} {back} {a} {b} {p:?}");
        nonzero += u32::from(scale > 1e-12);
    }
    assert!(nonzero > 40_000);
}

#[test]
fn opaque_surfaces_look_alike_from_both_sides() {
    let flip = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
    let mut rng = rng(21);
    for _ in 0..10_000 {
        let p = SurfaceParameters { transmission: 0.0, ..random_parameters(&mut rng) };
        let bsdf = Bsdf::new(&p);
        let (a, b) = (random_direction(&mut rng), random_direction(&mut rng));
        assert_eq!(bsdf.eval(a, b), bsdf.eval(flip(a), flip(b)));
        assert_eq!(bsdf.pdf(Side::TowardLight, a, b), bsdf.pdf(Side::TowardLight, flip(a), flip(b)));
        if a.z * b.z < 0.0 && p.diffuse_transmission == 0.0 {
            assert_eq!(bsdf.eval(a, b), Rgb::ZERO);
        }
    }
}

#[test]
fn one_evaluation_equals_three() {
    let mut rng = rng(22);
    for _ in 0..20_000 {
        let bsdf = Bsdf::new(&random_parameters(&mut rng));
        let (l, e) = (random_direction(&mut rng), random_direction(&mut rng));
        let all = bsdf.evaluate(l, e);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs();
        assert_eq!(all.value, bsdf.eval(l, e));
        assert!(close(all.toward_light, bsdf.pdf(Side::TowardLight, e, l)));
        assert!(close(all.toward_eye, bsdf.pdf(Side::TowardEye, l, e)));
    }
}

#[test]
fn dirac_events_are_the_same_from_both_sides() {
    let mut rng = rng(23);
    let mut seen = [0; 4];
    for _ in 0..50_000 {
        let p = random_parameters(&mut rng);
        let p = SurfaceParameters { roughness: 0.0, anisotropy: 0.0, ..p };
        let bsdf = Bsdf::new(&p);
        let w_e = square_to_sphere(rng.pair());
        for (i, mode) in DELTAS.into_iter().enumerate() {
            let Some(event) = bsdf.delta(Side::TowardLight, w_e, mode) else { continue };
            // Grazing directions lose their digits on the way.
            if event.reflectance == Rgb::ZERO || event.direction.z.abs().min(w_e.z.abs()) < 1e-3 {
                continue;
            }
            let back = bsdf.delta(Side::TowardEye, event.direction, mode).unwrap();
            assert!((back.direction - w_e).length() < 1e-10, "{p:?}");
            assert!((back.reflectance - event.reflectance).abs().max_element() < 1e-9, "{p:?}");
            assert_eq!(back.eta_scale, 1.0);
            let ratio = index(&p, event.direction) / index(&p, w_e);
            let ratio = [ratio.y, ratio.y, ratio.x, ratio.z][i];
            assert!((event.eta_scale / (ratio * ratio) - 1.0).abs() < 1e-12, "{p:?}");
            seen[i] += 1;
        }
    }
    assert!(seen[0] > 10_000 && seen[1] > 5_000 && seen[2] > 1_000 && seen[3] > 1_000, "{seen:?}");
}

/// Lossless glass: choosing by Fresnel makes every Dirac sample worth exactly 1.
#[test]
fn smooth_glass_is_sampled_perfectly() {
    let bsdf = Bsdf::new(&SurfaceParameters { roughness: 0.0, transmission: 1.0, ..PLAIN });
    for cos in [1.0, 0.5, 0.1, -0.1, -0.5, -0.9] {
        let w = at(cos, 1.0);
        for mode in [Mode::DeltaReflect, Mode::DeltaTransmit] {
            if let Some(event) = bsdf.delta(Side::TowardEye, w, mode) {
                assert!((event.reflectance.x / event.probability - 1.0).abs() < 1e-12);
            }
        }
        assert!((dirac_probability(&bsdf, w) - 1.0).abs() < 1e-12);
        assert!(bsdf.has_delta());
    }
}
