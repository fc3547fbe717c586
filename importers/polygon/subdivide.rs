//! Subdivision of a polygon mesh with all its attributes.

use std::borrow::Cow;

use ajar_scene::{Cause, Diagnostic};

use super::{
    Attribute, Polygons, Subdivision,
    catmull_clark::{Net, Value},
    edges::{Edges, INFINITE, Topology},
    normals,
};
use crate::budget::Budget;

/// How the boundary of the mesh behaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Boundary {
    /// Faces at the boundary are dropped.
    None,
    /// The boundary is a smooth curve.
    Edges,
    /// And its corners with one face are sharp.
    #[default]
    Corners,
}

/// Where attributes per corner are interpolated linearly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Linear {
    /// Everywhere.
    All,
    /// At seams and boundaries.
    Boundary,
    /// Nowhere: seams are smooth curves.
    None,
    /// At corners of seams.
    #[default]
    Corners,
}

impl Polygons<'_> {
    /// The mesh refined, positions at the limit, with smooth normals. A mesh without subdivision is returned as it is.
    ///
    /// # Errors
    /// The result needs more than is left of `budget`.
    pub fn refined(mut self, budget: &Budget) -> Result<Self, Diagnostic> {
        let Some(subdivision) = self.subdivision.take() else { return Ok(self) };
        let quads =
            (self.corners.len() as u64).saturating_mul(4_u64.saturating_pow(subdivision.levels.max(1) - 1));
        let values = 2 + self.uvs.len() as u64 + u64::from(self.colors.is_some());
        // Corners, edges and values of each attribute while it is refined.
        if !budget.take(quads.saturating_mul(80 * values)) {
            let message = format!("{quads} faces after subdivision need more memory than the limit");
            return Err(Diagnostic::error(message).because(Cause::Resource));
        }
        let topology =
            Topology { first: self.first(), corners: std::mem::take(&mut self.corners).into_owned() };
        let edges = Edges::of(&topology);
        let creases = subdivision.edge_sharpness(&edges);
        self.open(&subdivision, &topology, &edges);

        let channel = Channel { subdivision: &subdivision, creases: &creases, edges: &edges };
        self.uvs = self.uvs.into_iter().map(|uv| channel.refined(uv, &topology)).collect();
        self.colors = self.colors.map(|colors| channel.refined(colors, &topology));

        let boundary = edges.boundaries();
        let edge_sharpness = creases.iter().zip(&boundary).map(|(a, b)| a.max(*b)).collect();
        let sharpness = subdivision.vertex_sharpness(&edges, &topology, self.positions.len());
        let net = Net {
            values: self.positions.into_owned(),
            topology,
            edges,
            edge_sharpness,
            sharpness,
            linear: false,
        };
        let origin = (0..net.topology.faces() as u32).collect();
        let (net, origin) = refine(net, origin, subdivision.levels);
        self.positions = if subdivision.levels > 0 { net.limit() } else { net.values }.into();
        self.normals = Some(normals::smooth(&self.positions, &net.topology, &net.edges, &net.edge_sharpness));
        self.faces = net.topology.first.windows(2).map(|pair| pair[1] - pair[0]).collect();
        self.corners = net.topology.corners.into();
        self.part_of =
            origin.iter().map(|&face| self.part_of.get(face as usize).copied().unwrap_or(0)).collect();
        self.is_hole =
            origin.iter().map(|&face| self.is_hole.get(face as usize).copied().unwrap_or(false)).collect();
        Ok(self)
    }

    /// Makes holes of the faces at the boundary where it is not interpolated.
    fn open(&mut self, subdivision: &Subdivision, topology: &Topology, edges: &Edges) {
        if subdivision.boundary != Boundary::None {
            return;
        }
        let mut outside = vec![false; self.positions.len()];
        for (ends, &faces) in edges.ends.iter().zip(&edges.faces) {
            if faces < 2 {
                ends.iter().for_each(|&end| outside[end as usize] = true);
            }
        }
        for face in 0..topology.faces() {
            self.is_hole[face] |= topology.corners[topology.face(face)].iter().any(|&v| outside[v as usize]);
        }
    }
}

/// Refines `levels` times; `origin` tells for each face from which one it comes.
fn refine<T: Value>(mut net: Net<T>, mut origin: Vec<u32>, levels: u32) -> (Net<T>, Vec<u32>) {
    for _ in 0..levels {
        origin = (0..net.topology.faces())
            .flat_map(|face| std::iter::repeat_n(origin[face], net.topology.face(face).len()))
            .collect();
        net = net.refined();
    }
    (net, origin)
}

impl Subdivision {
    /// Sharpness of creases, one an edge of the mesh.
    fn edge_sharpness(&self, edges: &Edges) -> Vec<f32> {
        let mut sharpness = vec![0.0_f32; edges.ends.len()];
        for (&[a, b], &sharp) in self.creases.iter().zip(&self.crease_sharpness) {
            if let Some(edge) = edges.between(a, b) {
                sharpness[edge] = sharpness[edge].max(sharp);
            }
        }
        sharpness
    }

    /// Sharpness of vertices: what is said, and the corners of the boundary.
    fn vertex_sharpness(&self, edges: &Edges, topology: &Topology, vertices: usize) -> Vec<f32> {
        let mut sharpness = vec![0.0_f32; vertices];
        if self.boundary == Boundary::Corners {
            sharpen_corners(edges, topology, &mut sharpness);
        }
        for (&vertex, &sharp) in self.sharp_positions.iter().zip(&self.position_sharpness) {
            if let Some(sharpness) = sharpness.get_mut(vertex as usize) {
                *sharpness = sharpness.max(sharp);
            }
        }
        sharpness
    }
}

/// Makes the vertices at the boundary that have one face sharp.
fn sharpen_corners(edges: &Edges, topology: &Topology, sharpness: &mut [f32]) {
    let mut faces = vec![0_u32; sharpness.len()];
    topology.corners.iter().for_each(|&vertex| faces[vertex as usize] += 1);
    for (ends, _) in edges.ends.iter().zip(&edges.faces).filter(|(_, faces)| **faces == 1) {
        for &end in ends.iter().filter(|&&end| faces[end as usize] == 1) {
            sharpness[end as usize] = INFINITE;
        }
    }
}

/// What attributes take over from the mesh.
struct Channel<'a> {
    subdivision: &'a Subdivision,
    creases: &'a [f32],
    edges: &'a Edges,
}

impl Channel<'_> {
    /// The attribute of the refined mesh. It has its own vertices: where it differs across an edge is a seam.
    fn refined<'v, T: Value>(&self, attribute: Attribute<'v, T>, mesh: &Topology) -> Attribute<'v, T> {
        let in_turn = || (0..mesh.corners.len() as u32).collect();
        let corners = attribute.indices.map_or_else(in_turn, Cow::into_owned);
        let topology = Topology { first: mesh.first.clone(), corners };
        let edges = Edges::of(&topology);
        let mut edge_sharpness = edges.boundaries();
        for (corner, &edge) in edges.after.iter().enumerate() {
            let sharpness = &mut edge_sharpness[edge as usize];
            *sharpness = sharpness.max(self.creases[self.edges.after[corner] as usize]);
        }
        let mut sharpness = vec![0.0; attribute.values.len()];
        match self.subdivision.linear {
            Linear::All | Linear::None => {}
            Linear::Corners => sharpen_corners(&edges, &topology, &mut sharpness),
            Linear::Boundary => {
                for (ends, _) in edges.ends.iter().zip(&edges.faces).filter(|(_, faces)| **faces != 2) {
                    ends.iter().for_each(|&end| sharpness[end as usize] = INFINITE);
                }
            }
        }
        let linear = self.subdivision.linear == Linear::All;
        let net =
            Net { values: attribute.values.into_owned(), topology, edges, edge_sharpness, sharpness, linear };
        let levels = self.subdivision.levels;
        let (net, _) = refine(net, vec![0; mesh.first.len()], levels);
        let values = if levels > 0 { net.limit() } else { net.values };
        Attribute { values: values.into(), indices: Some(net.topology.corners.into()) }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;

    fn cube() -> Polygons<'static> {
        let positions =
            (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0);
        Polygons {
            positions: positions.collect(),
            faces: vec![4; 6].into(),
            corners: vec![0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5].into(),
            part_of: vec![0; 6],
            is_hole: vec![false; 6],
            ..Polygons::default()
        }
    }

    fn grid(n: u32) -> Polygons<'static> {
        let at = |x: u32, y: u32| y * (n + 1) + x;
        let cells = || (0..n * n).map(|i| (i % n, i / n));
        Polygons {
            positions: (0..(n + 1) * (n + 1))
                .map(|i| Vec3::new((i % (n + 1)) as f32, (i / (n + 1)) as f32, 0.0))
                .collect(),
            faces: vec![4; (n * n) as usize].into(),
            corners: cells()
                .flat_map(|(x, y)| [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)])
                .collect(),
            part_of: vec![0; (n * n) as usize],
            is_hole: vec![false; (n * n) as usize],
            ..Polygons::default()
        }
    }

    fn subdivided(mut mesh: Polygons<'_>, subdivision: Subdivision) -> Polygons<'_> {
        mesh.subdivision = Some(subdivision);
        mesh.refined(&Budget::new(1 << 30)).expect("fits")
    }

    fn levels(levels: u32) -> Subdivision {
        Subdivision { levels, ..Subdivision::default() }
    }

    /// The limit of a cube's corner: v = (n² v + 4 Σ e + Σ f) / (n (n + 5)) with n = 3 on the cube itself.
    #[test]
    fn a_cube_has_its_known_limit_at_every_level() {
        for n in 1..=4 {
            let ball = subdivided(cube(), levels(n));
            assert_eq!(ball.faces.len(), 6 << (2 * n));
            // Neighbours of (1,1,1) on the cube sum to (1,1,1), the corners across its faces to (-1,-1,-1).
            let expected = (9.0 + 4.0 - 1.0) / 24.0;
            for (limit, at) in ball.positions.iter().zip(cube().positions.iter()) {
                assert!((*limit - *at * expected).length() < 1e-5, "{n}: {limit}");
            }
        }
    }

    #[test]
    fn the_limit_does_not_depend_on_the_level() {
        let (coarse, fine) = (subdivided(cube(), levels(2)), subdivided(cube(), levels(4)));
        for (a, b) in coarse.positions.iter().zip(fine.positions.iter()) {
            assert!((*a - *b).length() < 1e-5);
        }
    }

    #[test]
    fn a_flat_grid_stays_flat_and_keeps_what_its_boundary_says() {
        let inside = |mesh: &Polygons| mesh.is_hole.iter().filter(|&&hole| !hole).count();
        let corners = subdivided(grid(4), levels(2));
        assert_eq!(corners.positions[0], Vec3::ZERO);
        assert!(corners.positions.iter().all(|p| p.z == 0.0));
        let normals = corners.normals.as_ref().expect("normals");
        assert!(normals.values.iter().all(|n| (*n - Vec3::Z).length() < 1e-6));
        assert_eq!(inside(&corners), 16 * 16);
        let edges = subdivided(grid(4), Subdivision { boundary: Boundary::Edges, ..levels(2) });
        assert!(edges.positions[0].length() > 0.1);
        assert_eq!(edges.positions[2], Vec3::new(2.0, 0.0, 0.0));
        let none = subdivided(grid(4), Subdivision { boundary: Boundary::None, ..levels(2) });
        assert_eq!(inside(&none), 4 * 16);
    }

    #[test]
    fn creases_keep_a_cube_a_cube_and_half_a_crease_lies_between() {
        let all = |sharpness: f32| {
            let creases: Vec<_> =
                (0..8_u32).flat_map(|a| [1, 2, 4].map(|bit| [a, a ^ bit])).filter(|e| e[0] < e[1]).collect();
            Subdivision { crease_sharpness: vec![sharpness; creases.len()], creases, ..levels(3) }
        };
        let volume = |mesh: &Polygons<'_>| {
            let quads = mesh
                .corners
                .chunks(4)
                .map(|quad| quad.iter().map(|&v| mesh.positions[v as usize]).collect::<Vec<_>>());
            quads.map(|q| (q[0].dot(q[1].cross(q[2])) + q[0].dot(q[2].cross(q[3]))) / 6.0).sum::<f32>()
        };
        let volumes: Vec<_> =
            [0.0, 0.5, 1.0, 2.0, 10.0].map(|s| volume(&subdivided(cube(), all(s)))).to_vec();
        assert!((volumes[4] - 8.0).abs() < 1e-4, "{volumes:?}");
        assert!(volumes.windows(2).all(|pair| pair[1] > pair[0] + 0.1), "{volumes:?}");
        // Normals break at sharp edges.
        let sharp = subdivided(cube(), all(10.0));
        let normals = sharp.normals.expect("normals").values;
        assert!(normals.iter().all(|n| (n.abs().max_element() - 1.0).abs() < 1e-6));
    }

    #[test]
    fn seams_of_texture_coordinates_follow_their_rule() {
        // Each face of the cube has the whole square.
        let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let unfolded = |linear: Linear| {
            let mut mesh = cube();
            mesh.uvs = vec![Attribute { values: square.repeat(6).into(), indices: None }];
            subdivided(mesh, Subdivision { linear, ..levels(2) }).uvs.remove(0).values.into_owned()
        };
        for linear in [Linear::All, Linear::Boundary, Linear::Corners] {
            assert_eq!(unfolded(linear)[..4], square, "{linear:?}");
        }
        assert!(unfolded(Linear::None)[0].length() > 0.1);
    }

    #[test]
    fn attributes_follow_positions_where_they_have_the_same_seams() {
        let mut mesh = cube();
        let indices = Some(mesh.corners.clone());
        mesh.uvs = vec![Attribute { values: mesh.positions.iter().map(|p| p.truncate()).collect(), indices }];
        let ball = subdivided(mesh, levels(3));
        for (uv, p) in ball.uvs[0].values.iter().zip(ball.positions.iter()) {
            assert!((*uv - p.truncate()).length() < 1e-6);
        }
        assert_eq!(ball.uvs[0].indices.as_deref(), Some(&*ball.corners));
    }

    #[test]
    fn normals_are_those_of_the_surface() {
        let ball = subdivided(cube(), levels(5));
        let normals = ball.normals.expect("normals");
        let indices = normals.indices.expect("indices");
        for (&vertex, &normal) in ball.corners.iter().zip(indices.iter()) {
            let (p, n) = (ball.positions[vertex as usize], normals.values[normal as usize]);
            assert!((n.length() - 1.0).abs() < 1e-5 && n.dot(p.normalize()) > 0.95, "{p} {n}");
        }
    }

    #[test]
    fn too_many_faces_are_an_error() {
        let mut mesh = grid(50);
        mesh.subdivision = Some(levels(6));
        let error = mesh.refined(&Budget::new(1 << 20)).expect_err("too large");
        assert_eq!(error.cause, Cause::Resource);
    }
}
