//! Samples against densities: χ² on a grid of the sphere, and exact inverses.

use super::*;
use crate::chi2::{cell, integrals};

/// Probability that all tests together reject a right density.
const SIGNIFICANCE: f64 = 1e-3;

/// p-value of the hypothesis that `sample` has `density`; samples that fail are one more cell, which the rest of
/// the density must fill.
fn p_value(sample: &mut dyn FnMut() -> Option<DVec3>, samples: u32, density: &dyn Fn(DVec3) -> f64) -> f64 {
    let expected: Vec<f64> = integrals(density).iter().map(|p| p * f64::from(samples)).collect();
    let mut counts = vec![0.0; expected.len() + 1];
    for _ in 0..samples {
        counts[sample().map_or(expected.len(), cell)] += 1.0;
    }
    let failed = (f64::from(samples) - expected.iter().sum::<f64>()).max(0.0);
    crate::chi2::p_value(expected.into_iter().chain([failed]).zip(counts))
}

const DIRECTIONS: [f64; 4] = [0.95, 0.2, -0.8, -0.35];

/// One test: a material, a known direction, and a lobe or all of them.
type Case = (String, Bsdf, DVec3, Option<usize>);

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, p) in materials() {
        let bsdf = Bsdf::new(&p);
        for cos in
            DIRECTIONS.into_iter().filter(|&cos| cos > 0.0 || p.transmission > 0.0 || name == "plastic")
        {
            let known = at(cos, 0.6);
            let weights = bsdf.lobe_weights(Side::TowardLight, known);
            let smooth = |lobe: usize| {
                let sample = bsdf.sample_lobe(Side::TowardLight, known, lobe, [0.3, 0.4]);
                weights[lobe] > 0.0 && sample.is_none_or(|s| s.mode == Mode::Smooth)
            };
            let lobes = (0..LOBES).filter(|&lobe| smooth(lobe)).map(Some);
            cases.extend(lobes.chain([None]).map(|lobe| (name.to_owned(), bsdf, known, lobe)));
        }
    }
    cases
}

fn run(
    (_, bsdf, known, lobe): &Case,
    seed: u64,
    samples: u32,
    density: &dyn Fn(&Bsdf, DVec3, Option<usize>) -> f64,
) -> f64 {
    let mut rng = rng(seed);
    let side = Side::TowardLight;
    let mut sample = || {
        let u = rng.pair();
        let sample = match lobe {
            Some(lobe) => bsdf.sample_lobe(side, *known, *lobe, u),
            None => bsdf.sample(side, *known, rng.f64(), u),
        };
        sample.filter(|s| s.mode == Mode::Smooth).map(|s| s.direction)
    };
    p_value(&mut sample, samples, &|w| density(bsdf, w, *lobe))
}

#[test]
fn samples_follow_their_densities() {
    let cases = cases();
    // Šidák: so that all of them together reject with probability SIGNIFICANCE.
    let threshold = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / cases.len() as f64);
    let mut least = 1f64;
    for (i, case) in cases.iter().enumerate() {
        let known = case.2;
        let p = run(case, 100 + i as u64, 60_000, &|bsdf, w, lobe| match lobe {
            Some(lobe) => bsdf.lobe_pdf(Side::TowardLight, known, lobe, w),
            None => bsdf.pdf(Side::TowardLight, known, w),
        });
        least = least.min(p);
        assert!(p > threshold, "{} lobe {:?} from {}: p = {p}", case.0, case.3, case.2);
    }
    println!("{} tests, least p {least:.4}, threshold {threshold:.2e}", cases.len());
}

/// The test has teeth: densities that are slightly wrong are caught.
#[test]
fn wrong_densities_are_caught() {
    let known = at(0.7, 0.6);
    let side = Side::TowardLight;
    let rejected = |p: SurfaceParameters, lobe, wrong: &dyn Fn(&Bsdf, DVec3, Option<usize>) -> f64| {
        let case: Case = (String::new(), Bsdf::new(&p), known, Some(lobe));
        run(&case, 7, 400_000, wrong) < 1e-6
    };
    let metal = SurfaceParameters { metallic: 1.0, ..PLAIN };
    // α off by 5 %.
    let other = Bsdf::new(&SurfaceParameters { roughness: 0.5 * 1.05f64.sqrt(), ..metal });
    let specular = crate::bsdf::lobe::SPECULAR;
    assert!(rejected(metal, specular, &|_, w, _| other.lobe_pdf(side, known, specular, w)));
    let diffuse = crate::bsdf::lobe::DIFFUSE;
    assert!(rejected(PLAIN, diffuse, &|b, w, _| 0.97 * b.lobe_pdf(side, known, diffuse, w)));
    assert!(rejected(PLAIN, diffuse, &|_, w, _| w.z.max(0.0).powf(1.1) * 2.1 / TAU));
    let glass = SurfaceParameters { transmission: 1.0, ..PLAIN };
    let transmission = crate::bsdf::lobe::TRANSMISSION;
    let other = Bsdf::new(&SurfaceParameters { ior: 1.52, ..glass });
    assert!(rejected(glass, transmission, &|_, w, _| other.lobe_pdf(side, known, transmission, w)));
}

/// Densities integrate to what is not lost below the horizon and not in Dirac events.
#[test]
fn densities_integrate_to_the_chance_of_a_smooth_event() {
    for (name, bsdf, known, lobe) in cases().into_iter().filter(|case| case.3.is_none()) {
        assert!(lobe.is_none());
        let side = Side::TowardLight;
        let integral: f64 = integrals(&|w| bsdf.pdf(side, known, w)).iter().sum();
        let mut chance = 0.0;
        for (lobe, weight) in bsdf.lobe_weights(side, known).into_iter().enumerate().filter(|(_, w)| *w > 0.0)
        {
            let smooth = rule(200, 200).filter(|&(u, _)| {
                bsdf.sample_lobe(side, known, lobe, u).is_some_and(|s| s.mode == Mode::Smooth)
            });
            chance += weight * smooth.map(|(_, share)| share).sum::<f64>();
        }
        assert!((integral - chance).abs() < 2e-3, "{name} from {known}: {integral} {chance}");
        let whole = integral + dirac_probability(&bsdf, known);
        assert!(whole < 1.0 + 1e-4, "{name}: {whole}");
    }
}

#[test]
fn inverses_undo_samples() {
    let mut rng = rng(40);
    let mut worst = 0f64;
    for (name, bsdf, known, lobe) in cases().into_iter().filter_map(|(n, b, k, l)| Some((n, b, k, l?))) {
        for _ in 0..2000 {
            let side = Side::TowardEye;
            let u = rng.pair();
            let Some(sample) = bsdf.sample_lobe(side, known, lobe, u) else { continue };
            let back = bsdf.invert(side, known, lobe, sample.direction).unwrap();
            let error = (back[0] - u[0]).abs().max((back[1] - u[1]).abs());
            worst = worst.max(error);
            assert!(error < 1e-9, "{name} lobe {lobe} from {known}: {u:?} came back as {back:?}");
        }
    }
    println!("largest error of an inverse {worst:.1e}");
}
