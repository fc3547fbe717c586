//! One step of Catmull–Clark subdivision with semi-sharp creases.
//!
//! E. Catmull, J. Clark, "Recursively generated B-spline surfaces on arbitrary topological meshes", Computer-Aided Design
//! 10(6), 1978; T. DeRose, M. Kass, T. Truong, "Subdivision surfaces in character animation", SIGGRAPH 1998, section 3 and
//! appendix; limit positions from M. Halstead, M. Kass, T. DeRose, "Efficient, fair interpolation using Catmull–Clark
//! surfaces", SIGGRAPH 1993.

use std::ops::{Add, Mul};

use super::edges::{Edges, Topology};

/// What is interpolated: positions, texture coordinates, colours.
pub(super) trait Value: Copy + Default + Add<Output = Self> + Mul<f32, Output = Self> {}
impl<T: Copy + Default + Add<Output = T> + Mul<f32, Output = T>> Value for T {}

fn mix<T: Value>(a: T, b: T, share: f32) -> T {
    a * (1.0 - share) + b * share
}

/// Vertices of one attribute with what keeps them sharp.
pub(super) struct Net<T> {
    pub values: Vec<T>,
    pub topology: Topology,
    pub edges: Edges,
    /// One an edge; 0 is smooth.
    pub edge_sharpness: Vec<f32>,
    /// One a vertex; 0 is smooth.
    pub sharpness: Vec<f32>,
    /// Nothing is smoothed.
    pub linear: bool,
}

/// What is around a vertex, summed.
#[derive(Clone, Copy, Default)]
struct Around<T> {
    /// Over edges: their other ends.
    neighbours: T,
    edges: u32,
    /// Over faces: their centres, or the opposite corners.
    faces: T,
    /// Over sharp edges: their other ends, number and sharpness.
    crease: T,
    sharp: u32,
    sharpness: f32,
}

impl<T: Value> Net<T> {
    /// The net of the next level: old vertices, then one an edge, then one a face; a quad for each corner.
    pub fn refined(&self) -> Self {
        let centres: Vec<T> = (0..self.topology.faces()).map(|face| self.centre(face)).collect();
        let mut values = self.moved(
            &self.around(|face, _| centres[face]),
            |vertex, around| {
                let n = around.edges as f32;
                vertex * ((n - 2.0) / n) + (around.neighbours + around.faces) * (1.0 / (n * n))
            },
            6.0,
        );
        values.extend(self.edge_points(&centres));
        values.extend(centres);
        let topology = self.quads();
        let edges = Edges::of(&topology);
        let mut edge_sharpness = edges.boundaries();
        for (edge, ends) in self.edges.ends.iter().enumerate() {
            let less = self.edge_sharpness[edge] - 1.0;
            // Infinite sharpness stays.
            let child = if less + 1.0 >= super::edges::INFINITE { less + 1.0 } else { less.max(0.0) };
            let middle = (self.values.len() + edge) as u32;
            for half in ends.iter().filter_map(|&end| edges.between(end, middle)) {
                edge_sharpness[half] = edge_sharpness[half].max(child);
            }
        }
        let mut sharpness: Vec<_> = self
            .sharpness
            .iter()
            .map(|&s| if s >= super::edges::INFINITE { s } else { (s - 1.0).max(0.0) })
            .collect();
        sharpness.resize(values.len(), 0.0);
        Self { values, topology, edges, edge_sharpness, sharpness, linear: self.linear }
    }

    /// Where the vertices of a net of quads end after infinitely many steps.
    pub fn limit(&self) -> Vec<T> {
        let opposite = |face: usize, corner: usize| {
            let range = self.topology.face(face);
            let across = range.start + (corner - range.start + range.len() / 2) % range.len();
            self.values[self.topology.corners[across] as usize]
        };
        self.moved(
            &self.around(opposite),
            |vertex, around| {
                let n = around.edges as f32;
                (vertex * (n * n) + around.neighbours * 4.0 + around.faces) * (1.0 / (n * (n + 5.0)))
            },
            4.0,
        )
    }

    fn centre(&self, face: usize) -> T {
        let corners = &self.topology.corners[self.topology.face(face)];
        let sum = corners.iter().fold(T::default(), |sum, &vertex| sum + self.values[vertex as usize]);
        sum * (1.0 / corners.len().max(1) as f32)
    }

    /// Sums around each vertex; `of_face` is what a face adds at one of its corners.
    fn around(&self, of_face: impl Fn(usize, usize) -> T) -> Vec<Around<T>> {
        let mut around = vec![Around::default(); self.values.len()];
        for face in 0..self.topology.faces() {
            for corner in self.topology.face(face) {
                let at: &mut Around<T> = &mut around[self.topology.corners[corner] as usize];
                at.faces = at.faces + of_face(face, corner);
            }
        }
        for (ends, &sharpness) in self.edges.ends.iter().zip(&self.edge_sharpness) {
            for [from, to] in [[ends[0], ends[1]], [ends[1], ends[0]]] {
                let (at, other) = (&mut around[from as usize], self.values[to as usize]);
                at.neighbours = at.neighbours + other;
                at.edges += 1;
                if sharpness > 0.0 {
                    at.crease = at.crease + other;
                    at.sharp += 1;
                    at.sharpness += sharpness;
                }
            }
        }
        around
    }

    /// The vertices by the rule that their sharpness asks for; `weight` is that of the vertex itself on a crease, whose two
    /// neighbours count 1 each.
    fn moved(&self, around: &[Around<T>], smooth: impl Fn(T, &Around<T>) -> T, weight: f32) -> Vec<T> {
        let moved = |(vertex, &value): (usize, &T)| {
            let around = &around[vertex];
            if self.linear || around.edges == 0 {
                return value;
            }
            let soft = || smooth(value, around);
            let by_edges = match around.sharp {
                0 | 1 => soft(),
                sharp => {
                    let hard = if sharp == 2 {
                        (value * weight + around.crease) * (1.0 / (weight + 2.0))
                    } else {
                        value
                    };
                    let share = around.sharpness / sharp as f32;
                    if share >= 1.0 { hard } else { mix(soft(), hard, share) }
                }
            };
            mix(by_edges, value, self.sharpness[vertex].clamp(0.0, 1.0))
        };
        self.values.iter().enumerate().map(moved).collect()
    }

    fn edge_points(&self, centres: &[T]) -> Vec<T> {
        let mut beside = vec![T::default(); self.edges.ends.len()];
        for (face, &centre) in centres.iter().enumerate() {
            for corner in self.topology.face(face) {
                let sum = &mut beside[self.edges.after[corner] as usize];
                *sum = *sum + centre;
            }
        }
        let point = |(edge, ends): (usize, &[u32; 2])| {
            let sum = self.values[ends[0] as usize] + self.values[ends[1] as usize];
            let sharpness = if self.linear { 1.0 } else { self.edge_sharpness[edge].clamp(0.0, 1.0) };
            if sharpness >= 1.0 { sum * 0.5 } else { mix((sum + beside[edge]) * 0.25, sum * 0.5, sharpness) }
        };
        self.edges.ends.iter().enumerate().map(point).collect()
    }

    fn quads(&self) -> Topology {
        let (vertices, edges) = (self.values.len() as u32, self.edges.ends.len() as u32);
        let mut corners = Vec::with_capacity(4 * self.topology.corners.len());
        for face in 0..self.topology.faces() {
            let range = self.topology.face(face);
            for corner in range.clone() {
                let before = if corner == range.start { range.end - 1 } else { corner - 1 };
                corners.extend([
                    self.topology.corners[corner],
                    vertices + self.edges.after[corner],
                    vertices + edges + face as u32,
                    vertices + self.edges.after[before],
                ]);
            }
        }
        Topology { first: (0..=corners.len() as u32 / 4).map(|quad| 4 * quad).collect(), corners }
    }
}
