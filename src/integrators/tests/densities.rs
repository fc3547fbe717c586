//! Proposals land where their densities say (mlt.md §8 V4).
//!
//! Mutations that follow mirrors and lenses by force, or turn a direction before them, have no such test of their own here:
//! `stationarity.rs` and `contract.rs` hold their densities.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use std::{
    collections::BTreeMap,
    f64::consts::{PI, TAU},
};

use ajar_integrators::mlt::{
    Mutation,
    lens_subpaths::{LensSubpaths, Spread},
    mutations::{Bidirectional, EyeChain, Lens, LensSubpath},
    path::{Path, Space},
    proposal::Proposal,
    seeds::Bootstrap,
};
use ajar_render::{
    path::Site,
    rng::{Purpose, Rng},
};
use common::{scenes::SCENES, seeds, sized};
use glam::DVec2;

/// Where all vertices are replaced, the mean of f*/T over proposals of a length is what paths of that length
/// contribute to the image, from whatever path the proposal starts.
#[test]
fn bidirectional_densities_are_true() {
    let proposals = sized(2_000_000);
    let scene = &SCENES[0];
    let world = (scene.world)();
    let (space, paths) = seeds(&world, scene.depth, 64);
    let bootstrap = Bootstrap::new(space, (5, 0), 100_000);
    let mut by_length = [0.0; 16];
    for candidate in bootstrap.candidates() {
        by_length[candidate.edges()] += candidate.weight / 100_000.0;
    }
    let (mut y, mut rng) = (Proposal::default(), Rng::new(4, Purpose::Test, 0, 0));
    let x = paths.iter().find(|x| x.edges() == 3).unwrap();
    y.follow(x);
    let mut sums = [[0.0; 2]; 16];
    for _ in 0..proposals {
        let Ok(aux) = Bidirectional.propose(&space, x, &mut y, &mut rng) else { continue };
        if (aux.stem, aux.removed) == (0, x.edges() + 1) {
            // Splits are not summed over by the proposal, which chooses one of them: the density already does.
            let value = 1.0 / Bidirectional.q(&space, x, &y.path, &aux);
            let sum = &mut sums[y.path.edges()];
            sum[0] += value;
            sum[1] += value * value;
        }
    }
    for k in 2..=5 {
        let n = proposals as f64;
        let (mean, square) = (sums[k][0] / n, sums[k][1] / n);
        let z = (mean - by_length[k]) / ((square - mean * mean) / n).sqrt().hypot(0.01 * by_length[k]);
        println!("{k} edges: {mean:.4} by proposals, {:.4} by bidirectional samples, z {z:.2}", by_length[k]);
        assert!(z.abs() < 4.0, "{k} edges: {mean} {}", by_length[k]);
    }
}

/// Density of the raster position that a mutation moves by `offset` pixels.
type Kernel = fn(&Space<'_>, f64) -> f64;

/// That of the perturbations: even in direction, and in the logarithm of the distance (Veach & Guibas 1997 §4.3.1).
fn near(space: &Space<'_>, offset: f64) -> f64 {
    let largest = (0.05 * space.window.pixels() as f64 / PI).sqrt();
    let inside = (0.1..largest).contains(&offset);
    if inside { 1.0 / (TAU * offset * offset * (largest / 0.1).ln()) } else { 0.0 }
}

/// That of lens subpath mutations, which know nothing of the old position.
fn anywhere(space: &Space<'_>, _: f64) -> f64 {
    1.0 / space.window.pixels() as f64
}

/// How often the surface that the eye sees lands on each triangle is what the raster kernel and the camera say.
#[test]
fn what_the_eye_sees_lands_where_densities_say() {
    let cases: [(&dyn Mutation, Kernel, usize); 3] =
        [(&Lens, near, 400_000), (&EyeChain, near, 400_000), (&LensSubpath, anywhere, 400_000)];
    for (mutation, kernel, proposals) in cases {
        assert_lands(mutation, kernel, sized(proposals));
    }
}

fn assert_lands(mutation: &dyn Mutation, kernel: Kernel, proposals: usize) {
    let scene = &SCENES[0];
    let world = (scene.world)();
    let (space, paths) = seeds(&world, scene.depth, 256);
    // From one diffuse surface to others, well inside the image and near an edge of the box: several triangles are to be hit.
    let x =
        paths.iter().find(|x| x.edges() == 3 && (x.raster - DVec2::new(15.0, 20.0)).length() < 4.0).unwrap();
    let mut rng = Rng::new(6, Purpose::Test, 0, 0);
    let (mut y, mut landed, mut by_triangle) = (Proposal::default(), 0.0, BTreeMap::<_, f64>::new());
    y.follow(x);
    for i in 0..proposals {
        // Each a chain of its own: the eye's subpaths are not kept.
        y.lens_subpaths = LensSubpaths::new(Spread::AcrossChains, (1, 0), i as u32, proposals as u32);
        let Ok(_) = mutation.propose(&space, x, &mut y, &mut rng) else { continue };
        let site = y.path.nodes[2].vertex.site;
        *by_triangle.entry((site.instance, site.triangle)).or_default() += 1.0;
        landed += 1.0;
    }
    let mut checked = 0;
    for (triangle, count) in by_triangle.into_iter().filter(|(_, count)| *count > 0.02 * landed) {
        let (expected, error) = chance_to_land(&space, x, triangle, kernel, &mut rng);
        let found = count / proposals as f64;
        let z = (found - expected) / error.hypot((found / proposals as f64).sqrt());
        println!("{}, {triangle:?}: {found:.4} found, {expected:.4} expected, z {z:.2}", mutation.name());
        assert!(z.abs() < 4.0, "{}, {triangle:?}: {found} {expected}", mutation.name());
        checked += 1;
    }
    assert!(checked >= 2, "{}: {checked}", mutation.name());
}

/// Mean and standard error of the density over a triangle, times its area: uniform points of it, seen from the lens and by
/// the vertex before, in place of proposals.
fn chance_to_land(
    space: &Space<'_>,
    x: &Path,
    (instance, triangle): (u32, u32),
    kernel: Kernel,
    rng: &mut Rng,
) -> (f64, f64) {
    let (world, points) = (space.world, sized(200_000));
    let [a, b, c] = world.geometry().vertices(instance, triangle);
    let area = 0.5 * (b - a).cross(c - a).length();
    let (mut sum, mut squares) = (0.0, 0.0);
    let mut path = x.clone();
    for _ in 0..points {
        let uv = ajar_render::warp::square_to_triangle(rng.pair());
        path.clone_from(x);
        path.nodes[2].vertex = world.surface(Site { instance, triangle, uv });
        let Some(seen) = world.camera.connect(path.nodes[2].vertex.p, x.lens) else { continue };
        if space.pixel(seen.raster).is_none()
            || world.passed(&path.nodes[2].vertex, &path.nodes[3].vertex) == 0.0
            || path.measure(space, (1, 3), Some(1)).is_err()
        {
            continue;
        }
        let raster_per_area = path.nodes[3].to_light * space.window.pixels() as f64;
        let density = kernel(space, (seen.raster - x.raster).length()) * raster_per_area;
        sum += density;
        squares += density * density;
    }
    let n = points as f64;
    (area * sum / n, area * ((squares / n - (sum / n).powi(2)).max(0.0) / n).sqrt())
}
