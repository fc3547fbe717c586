//! The edges of a polygon mesh.

/// Sharpness from which on an edge or vertex is never smoothed (OpenSubdiv's convention).
pub(super) const INFINITE: f32 = 10.0;

/// Which vertices the faces have.
#[derive(Clone, Debug, Default)]
pub(super) struct Topology {
    /// First corner of each face, and the number of corners.
    pub first: Vec<u32>,
    /// The vertex of each corner.
    pub corners: Vec<u32>,
}

impl Topology {
    /// Corners of a face.
    pub fn face(&self, face: usize) -> std::ops::Range<usize> {
        self.first[face] as usize..self.first[face + 1] as usize
    }

    /// Number of faces.
    pub fn faces(&self) -> usize {
        self.first.len().saturating_sub(1)
    }
}

/// The edges, and where they are.
pub(super) struct Edges {
    /// The two vertices, the smaller one first.
    pub ends: Vec<[u32; 2]>,
    /// The edge that leads from each corner to the next one of its face.
    pub after: Vec<u32>,
    /// Number of faces at the edge.
    pub faces: Vec<u32>,
}

impl Edges {
    pub fn of(topology: &Topology) -> Self {
        let mut sides = Vec::with_capacity(topology.corners.len());
        for face in 0..topology.faces() {
            let range = topology.face(face);
            for corner in range.clone() {
                let next = if corner + 1 == range.end { range.start } else { corner + 1 };
                let (a, b) = (topology.corners[corner], topology.corners[next]);
                sides.push(([a.min(b), a.max(b)], corner as u32));
            }
        }
        sides.sort_unstable();
        let mut edges = Self { ends: Vec::new(), after: vec![0; topology.corners.len()], faces: Vec::new() };
        for (ends, corner) in sides {
            if edges.ends.last() != Some(&ends) {
                edges.ends.push(ends);
                edges.faces.push(0);
            }
            let edge = edges.ends.len() - 1;
            edges.faces[edge] += 1;
            edges.after[corner as usize] = edge as u32;
        }
        edges
    }

    /// The edge between two vertices.
    pub fn between(&self, a: u32, b: u32) -> Option<usize> {
        self.ends.binary_search(&[a.min(b), a.max(b)]).ok()
    }

    /// Sharpness of edges that only their faces decide: those with another number than two are never smoothed.
    pub fn boundaries(&self) -> Vec<f32> {
        self.faces.iter().map(|&faces| if faces == 2 { 0.0 } else { INFINITE }).collect()
    }
}
