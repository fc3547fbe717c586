//! Tests of whole surfaces. Every property is asked of every material in [`materials`].

mod chi2;
mod energy;
mod robustness;
mod symmetry;

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{Bsdf, LOBES, Mode, Side, SurfaceParameters};
use crate::{
    math::Rgb,
    rng::{Purpose, Rng},
    warp::{disc_to_square, square_to_sphere},
};

const PLAIN: SurfaceParameters = SurfaceParameters {
    base_color: Rgb::ONE,
    diffuse_roughness: 0.0,
    metallic: 0.0,
    roughness: 0.5,
    anisotropy: 0.0,
    anisotropy_rotation: 0.0,
    specular: 1.0,
    specular_color: Rgb::ONE,
    ior: 1.5,
    dispersion: 0.0,
    transmission: 0.0,
    diffuse_transmission: 0.0,
    diffuse_transmission_color: Rgb::ONE,
    sheen_color: Rgb::ZERO,
    sheen_roughness: 0.0,
    film: 0.0,
    film_ior: 1.3,
    film_thickness: 400.0,
    thin_walled: false,
    coat: 0.0,
    coat_roughness: 0.0,
    coat_ior: 1.5,
};

/// Every lobe alone and in company.
fn materials() -> Vec<(&'static str, SurfaceParameters)> {
    let color = Rgb::new(0.8, 0.5, 0.2);
    let tinted = SurfaceParameters { base_color: color, ..PLAIN };
    let glass = SurfaceParameters { transmission: 1.0, ..PLAIN };
    let metal = SurfaceParameters { metallic: 1.0, ..tinted };
    vec![
        ("lambert", SurfaceParameters { specular: 0.0, ..tinted }),
        ("rough diffuse", SurfaceParameters { specular: 0.0, diffuse_roughness: 0.8, ..tinted }),
        ("plastic", tinted),
        ("shiny plastic", SurfaceParameters { roughness: 0.2, ..tinted }),
        ("smooth plastic", SurfaceParameters { roughness: 0.0, ..tinted }),
        ("metal", metal),
        ("rough metal", SurfaceParameters { roughness: 1.0, ..metal }),
        ("mirror", SurfaceParameters { roughness: 0.0, ..metal }),
        (
            "brushed metal",
            SurfaceParameters { roughness: 0.4, anisotropy: 0.8, anisotropy_rotation: 0.7, ..metal },
        ),
        ("rough glass", SurfaceParameters { roughness: 0.6, ..glass }),
        ("satin glass", SurfaceParameters { roughness: 0.3, base_color: color, ..glass }),
        ("brushed glass", SurfaceParameters { anisotropy: 0.5, anisotropy_rotation: -0.4, ..glass }),
        ("glass", SurfaceParameters { roughness: 0.0, ..glass }),
        ("matched glass", SurfaceParameters { ior: 1.0, ..glass }),
        ("rough shell", SurfaceParameters { thin_walled: true, base_color: color, ..glass }),
        ("shell", SurfaceParameters { thin_walled: true, roughness: 0.0, ..glass }),
        ("prism", SurfaceParameters { roughness: 0.0, dispersion: 3.0, base_color: color, ..glass }),
        ("rough prism", SurfaceParameters { roughness: 0.4, dispersion: 3.0, base_color: color, ..glass }),
        (
            "leaf",
            SurfaceParameters { diffuse_transmission: 0.6, diffuse_transmission_color: color, ..tinted },
        ),
        ("velvet", SurfaceParameters { sheen_color: color, sheen_roughness: 0.4, ..tinted }),
        ("satin", SurfaceParameters { sheen_color: Rgb::ONE, sheen_roughness: 0.1, coat: 0.5, ..tinted }),
        ("pearl", SurfaceParameters { film: 1.0, film_thickness: 550.0, ..tinted }),
        ("anodized", SurfaceParameters { film: 0.8, film_ior: 1.8, roughness: 0.3, ..metal }),
        ("bubble", SurfaceParameters { film: 1.0, thin_walled: true, roughness: 0.0, ..glass }),
        ("frosted film", SurfaceParameters { film: 1.0, film_ior: 1.8, ..glass }),
        ("coated", SurfaceParameters { coat: 1.0, coat_roughness: 0.3, ..tinted }),
        ("lacquered", SurfaceParameters { coat: 0.7, coat_roughness: 0.0, ..metal }),
        (
            "everything",
            SurfaceParameters {
                diffuse_transmission: 0.3,
                sheen_color: color,
                sheen_roughness: 0.5,
                film: 0.5,
                diffuse_roughness: 0.5,
                metallic: 0.3,
                anisotropy: 0.4,
                anisotropy_rotation: 1.0,
                specular: 0.8,
                specular_color: Rgb::new(0.5, 0.9, 0.7),
                transmission: 0.5,
                coat: 0.6,
                coat_roughness: 0.4,
                ..tinted
            },
        ),
    ]
}

/// All Dirac events.
const DELTAS: [Mode; 4] =
    [Mode::DeltaReflect, Mode::DeltaTransmit, Mode::DeltaTransmitRed, Mode::DeltaTransmitBlue];

fn rng(index: u64) -> Rng {
    Rng::new(11, Purpose::Test, 0, index)
}

fn at(cos: f64, azimuth: f64) -> DVec3 {
    let sin = (1.0 - cos * cos).sqrt();
    DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
}

/// Points of the square with weights that sum to 1, crowding where warps of the disc reach its rim and integrands their
/// extremes.
fn rule(radii: u32, azimuths: u32) -> impl Iterator<Item = ([f64; 2], f64)> {
    (0..radii * azimuths).map(move |i| {
        let t = (f64::from(i / azimuths) + 0.5) / f64::from(radii);
        let azimuth = TAU * (f64::from(i % azimuths) + 0.5) / f64::from(azimuths);
        let u = disc_to_square(DVec2::from_angle(azimuth) * (1.0 - t * t * t).sqrt());
        (u, 3.0 * t * t / f64::from(radii * azimuths))
    })
}

/// Total probability of the Dirac events.
fn dirac_probability(bsdf: &Bsdf, known: DVec3) -> f64 {
    DELTAS
        .into_iter()
        .filter_map(|mode| bsdf.delta(Side::TowardLight, known, mode))
        .map(|event| event.probability)
        .sum()
}

/// Parameters with everything random, corners of their ranges included.
fn random_parameters(rng: &mut Rng) -> SurfaceParameters {
    let unit = |rng: &mut Rng| match rng.below(4) {
        0 => 0.0,
        1 => 1.0,
        _ => rng.f64(),
    };
    SurfaceParameters {
        base_color: Rgb::new(unit(rng), unit(rng), unit(rng)),
        diffuse_roughness: unit(rng),
        metallic: unit(rng),
        roughness: unit(rng) * if rng.below(4) == 0 { 0.05 } else { 1.0 },
        anisotropy: unit(rng),
        anisotropy_rotation: 6.0 * rng.f64(),
        specular: unit(rng),
        specular_color: Rgb::new(unit(rng), unit(rng), unit(rng)),
        ior: [1.0, 1.0005, 1.002, 1.33, 1.5, 2.4, 20.0][rng.below(7)],
        // Every index has tables of its own.
        dispersion: [0.0, 1.0, 5.0][rng.below(3)],
        transmission: unit(rng),
        diffuse_transmission: if rng.below(2) == 0 { 0.0 } else { unit(rng) },
        diffuse_transmission_color: Rgb::new(unit(rng), unit(rng), unit(rng)),
        sheen_color: if rng.below(2) == 0 { Rgb::ZERO } else { Rgb::new(unit(rng), unit(rng), unit(rng)) },
        sheen_roughness: unit(rng),
        film: if rng.below(2) == 0 { 0.0 } else { unit(rng) },
        film_ior: [1.0, 1.3, 1.8, 2.5][rng.below(4)],
        film_thickness: unit(rng) * 1200.0,
        thin_walled: rng.below(3) == 0,
        coat: unit(rng),
        coat_roughness: unit(rng),
        coat_ior: [1.0, 1.5, 1.8][rng.below(3)],
    }
}

/// A direction, sometimes grazing, normal or in the plane.
fn random_direction(rng: &mut Rng) -> DVec3 {
    let w = square_to_sphere(rng.pair());
    match rng.below(6) {
        0 => DVec3::new(w.x, w.y, w.z * 10f64.powi(-(rng.below(12) as i32))).normalize(),
        1 => DVec3::new(0.0, 0.0, 1f64.copysign(w.z)),
        2 => DVec3::new(w.x, w.y, 0.0).normalize(),
        _ => w,
    }
}
