//! Polygons into triangles by ear clipping.
//!
//! G. H. Meisters, "Polygons have ears", Amer. Math. Monthly 82 (1975); the test of an ear against reflex vertices only
//! is from D. Eberly, "Triangulation by ear clipping" (2002). A convex polygon becomes the fan from its first corner.

use glam::{DVec2, DVec3, Vec2Swizzles, Vec3};

/// Twice the vector area (M. Newell): the normal of a polygon that need not be planar, in f64.
#[inline]
pub(crate) fn vector_area(points: &[Vec3]) -> DVec3 {
    let origin = points.first().copied().unwrap_or_default().as_dvec3();
    points.windows(2).map(|edge| (edge[0].as_dvec3() - origin).cross(edge[1].as_dvec3() - origin)).sum()
}

/// Whether a polygon with this vector area has any that can be used.
pub(crate) fn has_area(area: DVec3) -> bool {
    let square = area.length_squared();
    square > 0.0 && square.is_finite()
}

/// Splits a polygon with a normal of any length into triangles of indices into `points`, wound like the polygon; triangles
/// without area are left out. `false`: it crosses itself, or is too intricate, and the triangles overlap.
pub(crate) fn triangulate(points: &[Vec3], normal: DVec3, out: &mut Vec<[u32; 3]>) -> bool {
    if points.len() == 3 {
        out.push([0, 1, 2]);
        return true;
    }
    Ring::new(points.iter().map(|p| flatten(p.as_dvec3(), normal)).collect()).clip(out)
}

/// Drops the axis that the normal follows most, so that the polygon turns counter-clockwise. Coordinates stay exact:
/// corners in line stay in line.
fn flatten(p: DVec3, normal: DVec3) -> DVec2 {
    let size = normal.abs();
    let (flat, along) = if size.x >= size.y && size.x >= size.z {
        (DVec2::new(p.y, p.z), normal.x)
    } else if size.y >= size.z {
        (DVec2::new(p.z, p.x), normal.y)
    } else {
        (DVec2::new(p.x, p.y), normal.z)
    };
    if along < 0.0 { flat.yx() } else { flat }
}

/// Twice the area of a triangle, positive when counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The corners that are left, linked in a circle.
struct Ring {
    points: Vec<DVec2>,
    next: Vec<u32>,
    previous: Vec<u32>,
    /// Whether a corner may lie in the way of an ear: it is reflex or in line with its neighbours.
    reflex: Vec<bool>,
    /// The corners that were reflex at first, by x: an ear asks only those between its ends. Rounding makes a third of the
    /// corners of a finely divided circle reflex, and each of them is far from all but a few ears.
    by_x: Vec<u32>,
}

impl Ring {
    fn new(points: Vec<DVec2>) -> Self {
        let n = points.len() as u32;
        let next = (0..n).map(|i| (i + 1) % n).collect();
        let previous = (0..n).map(|i| (i + n - 1) % n).collect();
        let mut ring = Self { points, next, previous, reflex: Vec::new(), by_x: Vec::new() };
        ring.reflex = (0..n).map(|i| ring.turn(i) <= 0.0).collect();
        ring.by_x = (0..n).filter(|&i| ring.reflex[i as usize]).collect();
        let Self { points, by_x, .. } = &mut ring;
        by_x.sort_by(|&i, &j| points[i as usize].x.total_cmp(&points[j as usize].x));
        ring
    }

    fn neighbours(&self, i: u32) -> (u32, u32) {
        (self.previous[i as usize], self.next[i as usize])
    }

    /// Twice the area that clipping corner `i` would take.
    fn turn(&self, i: u32) -> f64 {
        let (before, after) = self.neighbours(i);
        area(self.points[before as usize], self.points[i as usize], self.points[after as usize])
    }

    /// Whether no corner lies in or on the triangle at corner `i`, and how many were asked. Corners at the place of one of
    /// its own are let through: polygons with holes are written with a seam that is walked twice.
    fn is_empty(&self, i: u32) -> (bool, usize) {
        let (before, after) = self.neighbours(i);
        let [a, b, c] = [before, i, after].map(|i| self.points[i as usize]);
        let x = |&r: &u32| self.points[r as usize].x;
        let (low, high) = (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
        let first = self.by_x.partition_point(|r| x(r) < low);
        let last = self.by_x.partition_point(|r| x(r) <= high);
        let inside = |r: u32| {
            let p = self.points[r as usize];
            let apart = p != a && p != b && p != c;
            apart && area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0
        };
        let near = &self.by_x[first..last];
        (!near.iter().any(|&r| self.reflex[r as usize] && inside(r)), near.len())
    }

    fn clip(mut self, out: &mut Vec<[u32; 3]>) -> bool {
        let mut left = self.points.len();
        // Quadratic time is fine for polygons that people draw; a hostile file must not get more.
        let mut tests = (1_000_000 + 4000 * left).min(200_000_000);
        let convex = self.by_x.is_empty();
        let (mut simple, mut i, mut tried) = (true, 1, 0);
        while left >= 3 {
            // Each round without success asks for less: an ear, a corner without area, any corner that turns left, any.
            let rounds = if tests == 0 { 3 } else { tried / left };
            tests = tests.saturating_sub(1);
            let turn = self.turn(i);
            let fits = match rounds {
                0 if turn > 0.0 => {
                    let (empty, asked) = self.is_empty(i);
                    tests = tests.saturating_sub(asked);
                    empty
                }
                0 => false,
                1 => turn == 0.0,
                2 => turn > 0.0,
                _ => true,
            };
            let (before, after) = self.neighbours(i);
            if fits {
                simple &= rounds < 2;
                if turn != 0.0 {
                    out.push([before, i, after]);
                }
                self.unlink(i);
                (left, tried) = (left - 1, 0);
                // A fan where the polygon is convex; else every other corner, which keeps triangles short.
                i = if convex { after } else { self.next[after as usize] };
            } else {
                tried += 1;
                i = after;
            }
        }
        simple
    }

    fn unlink(&mut self, i: u32) {
        let (before, after) = self.neighbours(i);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.reflex[i as usize] = false;
        // Clipping only ever straightens the neighbours.
        for corner in [before, after] {
            self.reflex[corner as usize] &= self.turn(corner) <= 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangulates and returns (simple, number of triangles, sum of signed areas, area of the polygon).
    fn check(points: &[[f32; 2]]) -> (bool, usize, f64, f64) {
        // Lifted onto a slanted plane, so that no axis is special.
        let lifted: Vec<_> = points.iter().map(|p| Vec3::new(p[0], p[1], 0.25 * p[0] - 0.5 * p[1])).collect();
        let normal = vector_area(&lifted);
        let mut out = Vec::new();
        let simple = triangulate(&lifted, normal, &mut out);
        let signed = |t: &[u32; 3]| vector_area(&t.map(|i| lifted[i as usize])).dot(normal.normalize());
        assert!(out.iter().all(|t| !simple || signed(t) > 0.0), "a triangle is turned over: {out:?}");
        (simple, out.len(), out.iter().map(signed).sum(), normal.length())
    }

    #[test]
    fn convex_polygons_become_fans() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let mut out = Vec::new();
        assert!(triangulate(&square, vector_area(&square), &mut out));
        assert_eq!(out, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_dart_is_cut_at_its_reflex_corner_wherever_it_starts() {
        let dart = [[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]];
        for start in 0..4 {
            let mut turned = dart;
            turned.rotate_left(start);
            let (simple, count, sum, whole) = check(&turned);
            assert!(simple && count == 2 && (sum - whole).abs() < 1e-6, "{start}: {sum} {whole}");
        }
    }

    #[test]
    fn corners_in_line_are_used() {
        // The last corner lies on the edge between two others: a fan from the first would leave a gap's width there.
        let (simple, count, sum, whole) = check(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.5]]);
        assert!(simple && count == 2 && (sum - whole).abs() < 1e-6);
    }

    #[test]
    fn a_hole_with_a_seam_stays_open() {
        let ring = [
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [2.0, 2.0],
            [2.0, 1.0],
            [1.0, 1.0],
        ];
        let (simple, _, sum, whole) = check(&ring);
        assert!(simple && (sum - whole).abs() < 1e-5, "{sum} {whole}");
    }

    #[test]
    fn combs_and_stars_keep_their_area() {
        for n in [5_u32, 8, 33, 200, 1001] {
            let comb: Vec<_> = (0..n)
                .map(|i| [i as f32, if i % 2 == 0 { 0.0 } else { 1.0 }])
                .chain([[n as f32, -1.0], [-1.0, -1.0]])
                .rev()
                .collect();
            let star: Vec<_> = (0..2 * n)
                .map(|i| {
                    let (s, c) = (std::f32::consts::PI * i as f32 / n as f32).sin_cos();
                    let r = if i % 2 == 0 { 3.0 } else { 1.0 + 0.5 * (i as f32).sin() };
                    [r * c, r * s]
                })
                .collect();
            for polygon in [comb, star] {
                let (simple, count, sum, whole) = check(&polygon);
                assert!(simple && count == polygon.len() - 2, "{n}: {count}");
                assert!((sum / whole - 1.0).abs() < 1e-5, "{n}: {sum} {whole}");
            }
        }
    }

    /// Rounding to f32 makes a third of the corners reflex.
    #[test]
    fn circles_of_many_corners_are_whole() {
        for n in [100_000_u32, 100_001] {
            let circle: Vec<_> = (0..n)
                .map(|i| (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos())
                .map(|(s, c)| Vec3::new(c as f32 + 3.0, s as f32, 0.0))
                .collect();
            let normal = vector_area(&circle);
            let mut out = Vec::new();
            assert!(triangulate(&circle, normal, &mut out) && out.len() > 90_000, "{n}: {}", out.len());
            let areas = out.iter().map(|t| vector_area(&t.map(|i| circle[i as usize])).z);
            assert!(areas.clone().all(|area| area > 0.0), "{n}: a triangle is turned over");
            let (sum, whole) = (areas.sum::<f64>(), normal.z);
            assert!((sum / whole - 1.0).abs() < 1e-9, "{n}: {sum} {whole}");
        }
    }

    #[test]
    fn crossing_polygons_end_and_say_so() {
        let (simple, ..) = check(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]]);
        assert!(!simple);
        let tangle: Vec<_> =
            (0..20_000_u32).map(|i| [((i * 7919) % 10_007) as f32, ((i * 104_729) % 9973) as f32]).collect();
        assert!(!check(&tangle).0);
    }
}
