//! A path contributes the same whichever end it was built from (mlt.md §1.3, §2.4 d, §8 V1).
//!
//! f is written down here once more, from textbooks, as radiance gathers it and as particles carry it; and it is read off
//! the walks of bidirectional samples, whose light ends scatter towards the eye.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use ajar_integrators::{
    bdpt::{Found, Tracer},
    mlt::path::{Node, Path, Space},
};
use ajar_render::{
    World,
    math::Rgb,
    rng::{Purpose, Rng},
};
use common::{
    scenes::{IMAGES, SCENES},
    settings, sized,
};
use glam::DVec3;

const SAMPLES: usize = 4000;
/// Edges of the longest path without Russian roulette.
const MAX_EDGES: usize = 5;

/// |cos| of `w` to the shading and to the geometric normal of x_i.
fn cosines(x: &Path, i: usize, w: DVec3) -> [f64; 2] {
    let vertex = &x.nodes[i].vertex;
    [vertex.frame.z, vertex.ng].map(|n| n.dot(w).abs())
}

/// Directions from x_i to the light's side and to the eye's.
fn directions(x: &Path, i: usize) -> [DVec3; 2] {
    [-x.nodes[i - 1].edge.to_eye, x.nodes[i].edge.to_eye]
}

/// BSDF of radiance at x_i.
fn bsdf(x: &Path, i: usize) -> Rgb {
    let vertex = &x.nodes[i].vertex;
    let [w_l, w_e] = directions(x, i).map(|w| vertex.frame.to_local(w));
    vertex.bsdf.eval(w_l, w_e)
}

/// What both ends have in common: emission, importance and absorption.
fn ends(world: &World, x: &Path) -> Rgb {
    let k = x.edges();
    let seen = world.camera.connect(x.nodes[k - 1].vertex.p, x.lens).unwrap();
    let absorbed = x.nodes[..k].iter().fold(Rgb::ONE, |all, node| all * node.absorption);
    world.emitted(&x.nodes[0].vertex, x.nodes[0].edge.to_eye) * absorbed * seen.importance
}

/// f as radiance gathers it: at each vertex BSDF · |w_l·Ns| per solid angle, which is measured by the area of the next
/// vertex towards the light.
fn gathered(world: &World, x: &Path) -> Rgb {
    let k = x.edges();
    let mut f = ends(world, x) * cosines(x, k - 1, directions(x, k - 1)[1])[1];
    for i in (1..k).rev() {
        let [w_l, _] = directions(x, i);
        f *= bsdf(x, i) * cosines(x, i, w_l)[0] * x.nodes[i - 1].edge.falloff;
        f *= x.nodes[i - 1].vertex.projected(w_l);
    }
    f
}

/// f as particles carry it: at each vertex the adjoint BSDF · |w_e·Ns| per solid angle, which is measured by the area of
/// the next vertex towards the eye. `adjoint` is what it has more than the BSDF (Veach 1997 §5.3.2).
fn carried(world: &World, x: &Path, adjoint: impl Fn([f64; 2], [f64; 2]) -> f64) -> Rgb {
    let mut f = ends(world, x) * x.nodes[0].vertex.projected(x.nodes[0].edge.to_eye);
    for i in 1..x.edges() {
        let [at_l, at_e] = directions(x, i).map(|w| cosines(x, i, w));
        f *= bsdf(x, i) * at_l[1] * x.nodes[i - 1].edge.falloff * (adjoint(at_l, at_e) * at_e[0]);
    }
    f
}

/// f as the walks of a bidirectional sample have it: what its technique found times the technique's density.
fn walked(x: &Path, found: &Found<'_>) -> Rgb {
    let mut density = 0.0;
    x.splits(0, x.edges() + 1, |s, p| density += if s == found.s { p } else { 0.0 });
    found.contribution.value * density
}

/// Largest relative difference of a channel.
fn difference(a: Rgb, b: Rgb) -> f64 {
    ((a - b).abs() / a.max(b).max(Rgb::splat(1e-300))).max_element()
}

/// How many paths were compared, and how many differ.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    walked: usize,
    /// Of those, paths with scattering on the light's side.
    from_light: usize,
    walked_off: usize,
    smooth: usize,
    gathered_off: usize,
    carried_off: usize,
    without_adjoint_off: usize,
}

impl Count {
    fn compare(&mut self, space: &Space<'_>, found: &Found<'_>, x: &mut Path) {
        let (world, k) = (space.world, found.s + found.t - 1);
        if !(2..=MAX_EDGES).contains(&k) {
            return;
        }
        x.nodes.clear();
        found.vertices(|vertex| x.nodes.push(Node::new(vertex)));
        (x.raster, x.lens) = (found.raster, found.lens);
        if x.measure(space, (0, k), found.s.checked_sub(1)).is_err() {
            return;
        }
        if !world.has_alpha() {
            self.walked += 1;
            self.from_light += usize::from(found.s > 2);
            self.walked_off += usize::from(difference(walked(x, found), x.f) > 1e-4);
        }
        if (1..k).all(|i| x.connectable(i)) {
            self.smooth += 1;
            let off = |f| usize::from(difference(f, x.f) > 1e-9);
            self.gathered_off += off(gathered(world, x));
            self.carried_off += off(carried(world, x, |[s_l, g_l], [s_e, g_e]| s_l * g_e / (g_l * s_e)));
            self.without_adjoint_off += off(carried(world, x, |_, _| 1.0));
        }
    }
}

fn count(world: &World, depth: usize) -> Count {
    let settings = settings(world, 1, depth, 1);
    let space = Space::new(world, settings.window, depth);
    let (mut tracer, mut x) = (Tracer::new(world, depth, 1.0), Path::with_capacity());
    let mut count = Count::default();
    for sample in 0..sized(SAMPLES) as u64 {
        let mut rng = Rng::new(8, Purpose::Test, 0, sample);
        let (raster, lens) = (space.raster(rng.pair()), rng.pair());
        tracer.sample(raster, lens, &mut rng, |found| count.compare(&space, found, &mut x));
    }
    count
}

#[test]
fn paths_are_worth_the_same_from_both_sides() {
    for scene in SCENES.iter().chain([&IMAGES]) {
        let world = (scene.world)();
        let count = count(&world, scene.depth);
        println!("{}: {count:?}", scene.name);
        assert!(count.smooth > 1000, "{}: {count:?}", scene.name);
        assert!(world.has_alpha() || count.from_light > 200, "{}: {count:?}", scene.name);
        assert_eq!((count.gathered_off, count.carried_off), (0, 0), "{}", scene.name);
        // Directions are found again from points, which are rounded: between neighbours in a corner that shows.
        assert!(count.walked_off * 100 <= count.walked, "{}: {count:?}", scene.name);
    }
}

/// Teeth: where normals are mapped, f without the adjoint's factor is another one.
#[test]
fn a_missing_adjoint_factor_shows() {
    let count = count(&(IMAGES.world)(), IMAGES.depth);
    assert!(count.without_adjoint_off * 2 > count.smooth, "{count:?}");
}
