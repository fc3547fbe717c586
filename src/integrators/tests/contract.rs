//! What every mutation promises (mlt.md §8 V3, V8), without running chains to their end.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use std::{
    collections::{BTreeMap, HashSet},
    sync::atomic::{AtomicU64, Ordering},
};

use ajar_integrators::mlt::{
    Aux, Mutation, Reject,
    chain::{Kernel, State, ratio},
    choice::{MAX_MUTATIONS, Selection, Table},
    manifold::{Walker, generalized_geometry},
    mutations::mutations,
    path::{Node, Path, Signature, Space},
    proposal::Proposal,
    target::{Aim, Target},
};
use ajar_integrators::{
    Window,
    bdpt::{self, Tracer},
    mlt::base::contribution,
    path::{Found, Visitor, walk},
};
use ajar_render::{
    math::{Frame, scalar},
    path::Vertex,
    rng::{Purpose, Rng},
    sampler::Sequence,
};
use common::{
    scenes::{IMAGES, SCENES},
    seeds, settings, sized,
};
use glam::{DVec2, DVec3};

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1e-300)
}

/// Proposals know their densities both ways, and nothing kept from the old path is stale in the new one.
#[test]
fn proposals_can_be_read_backwards() {
    let (list, _) = mutations(&BTreeMap::new());
    let mut made = vec![0; list.len()];
    for scene in SCENES.iter().chain([&IMAGES]) {
        let world = (scene.world)();
        let (space, paths) = seeds(&world, scene.depth, sized(4000));
        let (mut y, mut rng) = (Proposal::default(), Rng::new(3, Purpose::Test, 0, 0));
        for (mutation, made) in list.iter().zip(&mut made) {
            let mut proposals = 0;
            for x in paths.iter().filter(|x| mutation.applies(&x.signature)) {
                y.follow(x);
                let Ok(aux) = mutation.propose(&space, x, &mut y, &mut rng) else { continue };
                proposals += 1;
                let (forth, back) =
                    (mutation.q(&space, x, &y.path, &aux), mutation.q(&space, &y.path, x, &aux.reverse()));
                // A mirror between two diffuse surfaces can be deleted but, alone, never be made again.
                let no_way_back = x.density(aux.stem, aux.removed) == 0.0;
                assert!(forth.is_normal() && (back.is_normal() || no_way_back), "{}", mutation.name());
                assert!(mutation.applies(&y.path.signature), "{}: no way back", mutation.name());
                assert_eq!(aux.reverse().reverse(), aux);
                let mut again = y.path.clone();
                let k = again.edges();
                again.measure(&space, (0, k), None).unwrap();
                assert!(close(again.scalar(), y.path.scalar()), "{} {}", scene.name, mutation.name());
                if !world.has_alpha() {
                    assert!(close(again.density(0, k + 1), y.path.density(0, k + 1)), "{}", mutation.name());
                }
            }
            println!("{}: {} made {proposals} proposals", scene.name, mutation.name());
            *made += proposals;
        }
    }
    for (mutation, made) in list.iter().zip(made) {
        assert!(made > 200, "{} made {made} proposals: too few to tell", mutation.name());
    }
}

/// How much the light's direction turns when the end of a chain moves, by derivatives and by differences.
#[test]
fn chains_turn_as_their_derivatives_say() {
    const STEP: f64 = 2e-4;
    let scene = SCENES.iter().find(|scene| scene.name == "mirror and glass").unwrap();
    let world = (scene.world)();
    let (_, paths) = seeds(&world, scene.depth, 2000);
    let (mut checked, mut wrong) = (0, 0);
    for x in &paths {
        let k = x.edges();
        let Some(b) = (2..k).find(|&i| x.connectable(i) && !x.connectable(i - 1)) else { continue };
        let Some(c) = (0..b).rev().find(|&i| x.connectable(i)) else { continue };
        let chain: Vec<Vertex> = x.nodes[c..=b].iter().map(|node| node.vertex).collect();
        let Some(geometry) = generalized_geometry(&world, &chain) else { continue };
        let frame = Frame::from_z(chain[b - c].ng);
        let mut walker = Walker { world: &world, rays: 0 };
        let mut direction = |offset: DVec3| {
            let (mut moved, mut end) = (chain.clone(), chain[b - c]);
            (end.p, end.rounding) = (end.p + offset, 0.0);
            walker.move_end(&mut moved, &end).ok()?;
            Some((moved[1].p - moved[0].p).normalize())
        };
        let mut slope = |w: DVec3| Some((direction(w * STEP)? - direction(-w * STEP)?) / (2.0 * STEP));
        let (Some(s), Some(t)) = (slope(frame.x), slope(frame.y)) else { continue };
        let w = (chain[1].p - chain[0].p).normalize();
        let turned = s.cross(t).length() * chain[0].projected(w);
        checked += 1;
        wrong += usize::from((turned / geometry - 1.0).abs() > 0.02);
    }
    println!("{checked} chains, {wrong} of them over the edges of triangles");
    // Over an edge the surface turns at once, so that differences tell nothing.
    assert!(checked > 50 && wrong * 10 < checked, "{wrong} of {checked}");
}

/// A mutation of a world with few states, told apart by their raster position: from state i to j with chance q_ij.
struct Discrete {
    q: Vec<Vec<f64>>,
    /// By the number of edges.
    applies: fn(usize) -> bool,
}

fn state(x: &Path) -> usize {
    x.raster.x as usize
}

impl Mutation for Discrete {
    fn name(&self) -> &'static str {
        "discrete"
    }
    fn applies(&self, x: &Signature) -> bool {
        (self.applies)(x.edges())
    }
    fn propose(&self, _: &Space<'_>, _: &Path, _: &mut Proposal, _: &mut Rng) -> Result<Aux, Reject> {
        Err(Reject::Unsuitable)
    }
    fn q(&self, _: &Space<'_>, x: &Path, y: &Path, _: &Aux) -> f64 {
        self.q[state(x)][state(y)] / y.scalar()
    }
}

/// A target that weighs states differently.
struct Weighed;

impl Target for Weighed {
    fn aim(&self, x: &Path) -> Aim {
        let weight = 1.0 + (state(x) % 3) as f64;
        Aim { weight, deposit: x.f / (x.scalar() * weight) }
    }
}

/// V8: the transition matrix that the driver's ratios make leaves f*·v as it is, to rounding.
#[test]
fn the_driver_keeps_the_target_of_a_discrete_world() {
    const STATES: usize = 24;
    let scene = &SCENES[2];
    let world = (scene.world)();
    let (space, mut paths) = seeds(&world, scene.depth, STATES);
    let mut rng = Rng::new(9, Purpose::Test, 0, 0);
    for (i, path) in paths.iter_mut().enumerate() {
        path.raster.x = i as f64;
    }
    let mut matrix = || -> Vec<Vec<f64>> {
        let row = |rng: &mut Rng| -> Vec<f64> {
            let row: Vec<f64> = (0..paths.len()).map(|_| rng.f64() + 0.01).collect();
            let sum: f64 = row.iter().sum();
            row.iter().map(|q| q / sum).collect()
        };
        (0..paths.len()).map(|_| row(&mut rng)).collect()
    };
    let (a, b) =
        (Discrete { q: matrix(), applies: |_| true }, Discrete { q: matrix(), applies: |edges| edges != 3 });
    let list: [&dyn Mutation; 2] = [&a, &b];
    let mut table = Table::uniform(&[0.4, 0.9]);
    for (class, row) in table.weights.iter_mut().enumerate() {
        row[0] += 0.3 * (class % 5) as f64;
    }
    let kernel = Kernel { space, mutations: &list, table: &table, target: &Weighed };
    assert!(list.len() < MAX_MUTATIONS);
    let aims: Vec<Aim> = paths.iter().map(|p| Weighed.aim(p)).collect();
    let selections: Vec<Selection> =
        paths.iter().map(|p| Selection::at(&p.signature, &list, &table)).collect();
    let at = |i: usize| State { path: &paths[i], aim: &aims[i], selection: &selections[i] };
    let target = |i: usize| paths[i].scalar() * aims[i].weight;
    let worst = |without_selection: bool| {
        let mut moved = vec![0.0; paths.len()];
        for i in 0..paths.len() {
            let mut stays = 1.0;
            for j in 0..paths.len() {
                for (m, q) in [&a.q, &b.q].into_iter().enumerate() {
                    // Both ends must allow the mutation, else there is no way back.
                    let chance = selections[i].probability(m) * q[i][j];
                    if chance == 0.0 {
                        continue;
                    }
                    let mut ratio = ratio(&kernel, &at(i), &at(j), m, &Aux::default());
                    if without_selection {
                        ratio *= selections[i].probability(m) / selections[j].probability(m).max(1e-9);
                    }
                    let flow = chance * ratio.min(1.0);
                    moved[j] += target(i) * flow;
                    stays -= flow;
                }
            }
            moved[i] += target(i) * stays;
        }
        (0..paths.len()).map(|i| (moved[i] / target(i) - 1.0).abs()).fold(0.0, f64::max)
    };
    assert!(worst(false) < 1e-12, "{}", worst(false));
    assert!(worst(true) > 1e-3, "a ratio without the choice of the mutation must fail: {}", worst(true));
}

/// Builds the paths that the path tracer finds, and compares.
struct Contributions<'a> {
    space: Space<'a>,
    walked: Vec<Vertex>,
    path: Path,
    seen: usize,
    off: usize,
}

impl Visitor for Contributions<'_> {
    fn leave(&mut self, vertex: &Vertex) {
        self.walked.push(*vertex);
    }

    fn found(&mut self, found: &Found<'_>) {
        if found.edges < 2 {
            return;
        }
        let ends = std::iter::once(found.x0).chain(found.seen_from);
        self.path.nodes.clear();
        self.path.nodes.extend(ends.chain(self.walked.iter().rev()).map(|vertex| Node::new(*vertex)));
        self.path.measure(&self.space, (0, found.edges), found.seen_from.map(|_| 0)).unwrap();
        let error = contribution(&self.path) / scalar(found.value) - 1.0;
        self.seen += 1;
        self.off += usize::from(error.abs() > 1e-4);
    }
}

/// The shares of base and chains add up to 1 only if both compute the same C.
#[test]
fn paths_contribute_to_the_base_what_chains_think() {
    for scene in SCENES.iter().chain([&IMAGES]) {
        let world = (scene.world)();
        let settings = settings(&world, 3, scene.depth, 1);
        let space = Space::new(&world, settings.window, scene.depth);
        let path = Path::with_capacity();
        let mut all = Contributions { space, walked: Vec::new(), path, seen: 0, off: 0 };
        let mut rng = Rng::new(3, Purpose::Test, 0, 0);
        for sample in 0..2000 {
            all.walked.clear();
            let raster = space.raster(rng.pair());
            let mut sampler = Sequence::new(3, 0, sample).sample(0);
            walk(&world, scene.depth, raster, &mut sampler, &mut all);
        }
        println!("{}: {} paths, C differs for {}", scene.name, all.seen, all.off);
        // Directions are found again from points, which are rounded: between neighbours in a corner that shows.
        assert!(all.seen > 0 && all.off * 100 < all.seen, "{}: {} of {}", scene.name, all.off, all.seen);
    }
}

/// C of the path that a technique found, unless it is of a single edge or rounding lost it.
fn contribution_of(space: &Space<'_>, found: &bdpt::Found<'_>, path: &mut Path) -> Option<f64> {
    path.nodes.clear();
    found.vertices(|vertex| path.nodes.push(Node::new(vertex)));
    (path.raster, path.lens) = (found.raster, found.lens);
    path.measure(space, (0, path.edges()), found.s.checked_sub(1)).ok()?;
    (path.edges() > 1).then(|| contribution(path))
}

/// A filter of bidirectional samples is asked with the C of the very path, in a part of the film too, or with more where
/// something may dim the connection; and nothing else is filtered.
#[test]
fn bidirectional_samples_find_what_is_wanted() {
    for scene in SCENES.iter().chain([&IMAGES]) {
        let world = (scene.world)();
        let window = Window { x1: world.camera.width / 2, ..settings(&world, 3, scene.depth, 1).window };
        let space = Space::new(&world, window, scene.depth);
        let sample = |wanted: bdpt::Wanted<'_>, visit: &mut dyn FnMut(u64, &bdpt::Found<'_>)| {
            let mut tracer = Tracer::new(&world, scene.depth, 1.0 / space.film_ratio).only(wanted);
            for i in 0..500 {
                let mut rng = Rng::new(3, Purpose::Test, 0, i);
                let raster = space.raster(rng.pair());
                tracer.sample(raster, rng.pair(), &mut rng, |found| visit(i, found));
            }
        };
        let asked = AtomicU64::new(0);
        let all_wanted = |_: DVec2, alone: f64| {
            asked.store(alone.to_bits(), Ordering::Relaxed);
            true
        };
        let (mut path, mut all) = (Path::with_capacity(), Vec::new());
        let (mut less, mut more) = (0, 0);
        sample(&all_wanted, &mut |i, found| {
            let Some(c) = contribution_of(&space, found, &mut path) else { return };
            let alone = f64::from_bits(asked.load(Ordering::Relaxed));
            less += usize::from(alone < 0.96 * c);
            more += usize::from(alone > 1.05 * c);
            all.push(((i, found.s, found.t), alone));
        });
        println!("{}: {} paths, {less} less, {more} more", scene.name, all.len());
        // Directions are found again from points, which are rounded.
        assert!(less * 1000 <= all.len(), "{}: {less} of {}", scene.name, all.len());
        let dims = world.has_alpha() || scene.name == "cloth, leaf and pearl";
        assert!(dims || more * 1000 <= all.len(), "{}: {more} of {}", scene.name, all.len());

        let wanted = |_: DVec2, alone: f64| alone > 0.1;
        let mut kept = HashSet::new();
        sample(&wanted, &mut |i, found| {
            kept.insert((i, found.s, found.t));
        });
        assert!(all.iter().all(|(id, alone)| kept.contains(id) == (*alone > 0.1)), "{}", scene.name);
    }
}
