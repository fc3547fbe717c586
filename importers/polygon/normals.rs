//! Smooth normals that break at sharp edges.

use glam::{DVec3, Vec3};

use super::{
    Attribute,
    edges::{Edges, Topology},
};

/// One normal for each fan of faces that no sharp edge parts, weighted by area.
pub(super) fn smooth(
    positions: &[Vec3],
    topology: &Topology,
    edges: &Edges,
    sharpness: &[f32],
) -> Attribute<'static, Vec3> {
    let fans = fans(topology, edges, sharpness);
    let mut of_root = vec![u32::MAX; fans.len()];
    let mut sums: Vec<DVec3> = Vec::with_capacity(positions.len());
    let mut indices = Vec::with_capacity(topology.corners.len());
    for face in 0..topology.faces() {
        let range = topology.face(face);
        let points: Vec<_> = topology.corners[range.clone()].iter().map(|&v| positions[v as usize]).collect();
        let area = super::ears::vector_area(&points);
        for corner in range {
            let root = &mut of_root[fans[corner] as usize];
            if *root == u32::MAX {
                *root = sums.len() as u32;
                sums.push(DVec3::ZERO);
            }
            sums[*root as usize] += area;
            indices.push(*root);
        }
    }
    Attribute {
        values: sums.into_iter().map(|sum| sum.normalize_or(DVec3::Y).as_vec3()).collect(),
        indices: Some(indices.into()),
    }
}

/// For each corner one that stands for all corners of its fan.
fn fans(topology: &Topology, edges: &Edges, sharpness: &[f32]) -> Vec<u32> {
    let mut fan: Vec<u32> = (0..topology.corners.len() as u32).collect();
    // The two corners at either end of an edge, of the first face that has it.
    let mut seen: Vec<Option<[u32; 2]>> = vec![None; edges.ends.len()];
    for face in 0..topology.faces() {
        let range = topology.face(face);
        for corner in range.clone() {
            let edge = edges.after[corner] as usize;
            // Below 1 the last step would have smoothed it.
            if sharpness[edge] >= 1.0 {
                continue;
            }
            let next = if corner + 1 == range.end { range.start } else { corner + 1 };
            let mut ends = [corner as u32, next as u32];
            // Ordered as the edge's own ends, for neighbours walk it the other way round.
            if topology.corners[corner] != edges.ends[edge][0] {
                ends.reverse();
            }
            match seen[edge] {
                None => seen[edge] = Some(ends),
                Some(other) => (0..2).for_each(|end| join(&mut fan, other[end], ends[end])),
            }
        }
    }
    (0..fan.len() as u32).map(|corner| root(&mut fan, corner)).collect()
}

fn root(fan: &mut [u32], mut corner: u32) -> u32 {
    while fan[corner as usize] != corner {
        let above = fan[fan[corner as usize] as usize];
        fan[corner as usize] = above;
        corner = above;
    }
    corner
}

fn join(fan: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(fan, a), root(fan, b));
    fan[a.max(b) as usize] = a.min(b);
}
