//! A path in the making: x_0 … x_l of the old one, new vertices from both ends, x_m … x_k of the old one.
//!
//! Nothing here knows densities: walks choose directions and cast rays, [`Proposal::join`] measures the result.
//!
//! Most proposals change two or three vertices and most are rejected, so a proposal is a copy of the path that it comes
//! from and remembers which of its nodes may differ: only these are copied back for the next one.

mod walks;

use std::ops::Range;

use ajar_render::path::{Kind, Vertex};
use glam::{DVec2, DVec3};

use super::{
    Reject,
    lens_subpaths::LensSubpaths,
    path::{Node, Path, Space},
};

/// A path in the making; keeps its memory.
#[derive(Debug)]
pub struct Proposal {
    /// The path: whole after [`Proposal::join`].
    pub path: Path,
    /// Nodes that may differ from those of the path that it follows; all others are the same.
    changed: Range<usize>,
    /// Those of them whose vertices are others; at the rest only what was measured may differ.
    new: Range<usize>,
    /// Vertices on the light's side so far, kept ones included.
    light: usize,
    /// Index of the last vertex on the eye's side so far; the number of vertices if there is none.
    eye: usize,
    /// Directions from the ends to the vertices before them.
    to_light: DVec3,
    to_eye: DVec3,
    /// Whether the lens of the eye's side is new.
    new_lens: bool,
    /// What lens subpath mutations are offered.
    pub lens_subpaths: LensSubpaths,
    /// Rays cast so far.
    pub rays: u64,
}

impl Default for Proposal {
    fn default() -> Self {
        Self {
            path: Path::with_capacity(),
            changed: 0..0,
            new: 0..0,
            light: 0,
            eye: 0,
            to_light: DVec3::ZERO,
            to_eye: DVec3::ZERO,
            new_lens: false,
            lens_subpaths: LensSubpaths::default(),
            rays: 0,
        }
    }
}

impl Proposal {
    /// From now on proposals come from `x`.
    pub fn follow(&mut self, x: &Path) {
        self.path.copy_from(x);
        self.changed = 0..0;
    }

    /// `x`, which it follows, becomes the path that it proposes.
    pub fn accept(&mut self, x: &mut Path) {
        std::mem::swap(x, &mut self.path);
    }

    /// Keeps the first `stem` vertices of `x` and those from `kept` on, and makes room for `added` between them.
    ///
    /// # Errors
    /// The path would be too short or too long.
    pub fn begin(
        &mut self,
        space: &Space<'_>,
        x: &Path,
        (stem, kept, added): (usize, usize, usize),
    ) -> Result<(), Reject> {
        let (old, new) = (x.nodes.len(), stem..stem + added);
        let len = new.end + old - kept;
        if len < 3 || len > space.max_depth + 1 {
            return Err(Reject::Unsuitable);
        }
        self.restore(x, if len == old { new.clone() } else { 0..0 });
        self.changed = stem.saturating_sub(1)..(new.end + 1).min(len);
        if len != old {
            self.path.nodes.truncate(stem);
            self.path.nodes.resize(new.end, x.nodes[0]);
            self.path.nodes.extend_from_slice(&x.nodes[kept..]);
            self.changed.end = usize::MAX;
        }
        (self.light, self.eye) = (stem, new.end);
        self.new = new;
        if stem >= 2 {
            self.to_light = -x.nodes[stem - 2].edge.to_eye;
        }
        if let Some(node) = x.nodes.get(kept) {
            self.to_eye = node.edge.to_eye;
        }
        self.new_lens = false;
        Ok(())
    }

    /// Becomes a copy of `x`, which it follows, again, but for the nodes that are going to be `new`.
    fn restore(&mut self, x: &Path, new: Range<usize>) {
        let nodes = &mut self.path.nodes;
        if nodes.len() == x.nodes.len() {
            for i in self.changed.clone().filter(|i| !new.contains(i)) {
                if self.new.contains(&i) {
                    nodes[i] = x.nodes[i];
                } else {
                    nodes[i].copy_measured(&x.nodes[i]);
                }
            }
        } else {
            nodes.truncate(self.changed.start);
            nodes.extend_from_slice(&x.nodes[self.changed.start..]);
        }
        self.path.copy_rest_from(x);
        debug_assert!(
            self.path.nodes.iter().zip(&x.nodes).enumerate().all(|(i, (a, b))| new.contains(&i) || a.is(b)),
            "a proposal has to follow the path it comes from"
        );
    }

    /// The last vertex of the light's side.
    pub fn light_end(&self) -> Option<&Vertex> {
        self.light.checked_sub(1).map(|end| &self.path.nodes[end].vertex)
    }

    /// The last vertex of the eye's side, and the direction to the one before it.
    pub fn eye_end(&self) -> Option<(&Vertex, DVec3)> {
        self.path.nodes.get(self.eye).map(|node| (&node.vertex, self.to_eye))
    }

    /// Direction from the last vertex of the light's side to the one before it.
    pub fn light_known(&self) -> DVec3 {
        self.to_light
    }

    /// Whether the eye's side has only a kept vertex so far, the lens.
    pub fn starts_at_kept_lens(&self) -> bool {
        self.eye == self.new.end && self.eye_end().is_some_and(|(end, _)| end.kind == Kind::Lens)
    }

    /// Adds `x0` as the new light end.
    pub fn push_light(&mut self, x0: Vertex) {
        self.path.nodes[self.light] = Node::new(x0);
        self.light += 1;
    }

    /// Adds a new lens vertex at the lens point `lens`. Its place may depend on the raster position.
    pub fn push_lens(&mut self, space: &Space<'_>, lens: [f64; 2]) {
        (self.path.lens, self.new_lens) = (lens, true);
        let origin = space.world.camera.ray(self.path.raster, lens).origin;
        self.eye -= 1;
        self.path.nodes[self.eye] = Node::new(space.world.lens_vertex(origin));
    }

    /// Keeps the first `stem` vertices of `x` and takes the next lens subpath that is offered; answers with the number of
    /// its vertices.
    ///
    /// # Errors
    /// The subpath got lost, or the path would be too long.
    pub fn begin_lens_subpath(&mut self, space: &Space<'_>, x: &Path, stem: usize) -> Result<usize, Reject> {
        let mut subpaths = std::mem::take(&mut self.lens_subpaths);
        let offered = subpaths.next(space);
        self.rays += offered.rays;
        let count = offered.vertices.len();
        let begun = if count == 0 {
            Err(Reject::Lost)
        } else {
            self.begin(space, x, (stem, x.nodes.len(), count)).map(|()| {
                (self.path.raster, self.path.lens) = (offered.raster, offered.lens);
                for (node, vertex) in self.path.nodes[stem..].iter_mut().rev().zip(&offered.vertices) {
                    node.vertex = *vertex;
                    node.arrived();
                }
                (self.eye, self.new_lens) = (stem, true);
                count
            })
        };
        self.lens_subpaths = subpaths;
        begun
    }

    /// Adds vertices with their modes to the light's side.
    pub fn place_from_light(&mut self, vertices: &[Vertex]) {
        for vertex in vertices {
            self.path.nodes[self.light].vertex = *vertex;
            self.path.nodes[self.light].arrived();
            self.light += 1;
        }
    }

    /// Joins both sides, and measures the new path. A connection to the lens finds its raster position.
    ///
    /// # Errors
    /// Why the path carries no light.
    pub fn join(&mut self, space: &Space<'_>) -> Result<(), Reject> {
        debug_assert_eq!(self.light, self.eye, "vertices are missing");
        let (k, connection) = (self.path.edges(), self.light.checked_sub(1));
        if connection == Some(k - 1) {
            self.connect_lens(space)?;
        }
        if connection.is_none() && self.path.nodes[0].vertex.emitter == Vertex::NO_EMITTER {
            return Err(Reject::Black);
        }
        // The surroundings end a path; they are nowhere else.
        let inner = self.new.start.max(1)..self.new.end.max(1);
        if self.path.nodes[inner].iter().any(|node| node.vertex.infinite()) {
            return Err(Reject::Lost);
        }
        self.rays += u64::from(connection.is_some());
        self.path.measure(space, (self.new.start.saturating_sub(1), self.new.end.min(k)), connection)
    }

    fn connect_lens(&mut self, space: &Space<'_>) -> Result<(), Reject> {
        let lens = self.path.lens;
        let [.., last, end] = self.path.nodes.as_mut_slice() else { return Err(Reject::Unsuitable) };
        if last.vertex.infinite() {
            return Err(Reject::Lost);
        }
        let seen = space.world.camera.connect(last.vertex.p, lens).ok_or(Reject::Outside)?;
        if space.pixel(seen.raster).is_none() {
            return Err(Reject::Outside);
        }
        end.vertex.p = seen.lens;
        self.path.raster = seen.raster;
        Ok(())
    }

    /// Moves the raster position by `offset` pixels.
    ///
    /// # Errors
    /// It leaves the window.
    pub fn move_raster(&mut self, space: &Space<'_>, offset: DVec2) -> Result<(), Reject> {
        self.path.raster += offset;
        space.pixel(self.path.raster).map(|_| ()).ok_or(Reject::Outside)
    }
}
