//! From a primitive's corners to triangles over the vertices that they use.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use gltf::json::mesh::Mode;
use rayon::prelude::*;

/// The triangles of a primitive with these corners, counter-clockwise (specification, section 3.7.2.1).
pub(super) fn triangles(mode: Mode, mut corners: Vec<u32>) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .filter_map(|(i, corners)| {
                let &[a, b, c] = corners else { return None };
                Some(if i % 2 == 0 { [a, b, c] } else { [a, c, b] })
            })
            .collect(),
        Mode::TriangleFan => {
            let Some((&hub, rim)) = corners.split_first() else { return Vec::new() };
            rim.windows(2)
                .filter_map(|edge| {
                    let &[a, b] = edge else { return None };
                    Some([a, b, hub])
                })
                .collect()
        }
        Mode::Triangles => {
            corners.truncate(corners.len() - corners.len() % 3);
            // Without a copy where its memory can be divided by three too.
            bytemuck::allocation::try_cast_vec(corners)
                .unwrap_or_else(|(_, corners)| bytemuck::cast_slice(&corners).to_vec())
        }
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}

/// Renumbers the corners so that they use all of the returned vertices, which are in increasing order. Primitives often
/// share one long array of which each uses a part.
pub(super) fn compact(triangles: &mut [[u32; 3]], count: u32) -> Vec<u32> {
    // A table over all vertices is fast, but a small primitive over a long array must not pay for the array.
    if count as usize / 4 > triangles.len() * 3 { by_sorting(triangles) } else { by_table(triangles, count) }
}

fn by_table(triangles: &mut [[u32; 3]], count: u32) -> Vec<u32> {
    let is_used: Vec<AtomicBool> = (0..count).map(|_| AtomicBool::new(false)).collect();
    triangles.as_flattened().par_iter().for_each(|&corner| {
        if let Some(entry) = is_used.get(corner as usize) {
            entry.store(true, Relaxed);
        }
    });
    let used: Vec<u32> =
        (0..count).zip(&is_used).filter(|(_, is_used)| is_used.load(Relaxed)).map(|(i, _)| i).collect();
    if used.len() < count as usize {
        let mut table = vec![0; count as usize];
        for (new, &vertex) in (0..).zip(&used) {
            if let Some(entry) = table.get_mut(vertex as usize) {
                *entry = new;
            }
        }
        let renumber = |corner: &mut u32| *corner = table.get(*corner as usize).copied().unwrap_or_default();
        triangles.as_flattened_mut().par_iter_mut().for_each(renumber);
    }
    used
}

fn by_sorting(triangles: &mut [[u32; 3]]) -> Vec<u32> {
    let mut used = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    for corner in triangles.as_flattened_mut() {
        *corner = used.binary_search(corner).unwrap_or_default() as u32;
    }
    used
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_the_winding() {
        let corners = vec![0, 1, 2, 3, 4];
        assert_eq!(triangles(Mode::TriangleStrip, corners.clone()), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(Mode::TriangleFan, corners.clone()), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        assert_eq!(triangles(Mode::Triangles, corners.clone()), [[0, 1, 2]]);
        assert!(triangles(Mode::Lines, corners).is_empty());
    }

    #[test]
    fn both_ways_of_renumbering_agree() {
        let (mut one, mut other) = ([[7, 2, 90], [2, 7, 4]], [[7, 2, 90], [2, 7, 4]]);
        assert_eq!(by_table(&mut one, 100), [2, 4, 7, 90]);
        assert_eq!(by_sorting(&mut other), [2, 4, 7, 90]);
        assert_eq!((one, other), ([[2, 0, 3], [0, 2, 1]], [[2, 0, 3], [0, 2, 1]]));
    }
}
