//! Boxes in two groups at the least expected cost: the surface area heuristic over bins (I. Wald, "On fast construction of
//! SAH-based bounding volume hierarchies", 2007).

use glam::Vec3A;
use rayon::prelude::*;

use super::bounds::Bounds;

/// Bins along an axis, for few boxes and for many.
const FEW: usize = 8;
const MANY: usize = 32;
/// Boxes from which on all threads count.
const PARALLEL: usize = 1 << 16;

/// What is in the `N` bins of each axis.
struct Bins<const N: usize> {
    bounds: [[Bounds; N]; 3],
    counts: [[u32; N]; 3],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self { bounds: [[Bounds::EMPTY; N]; 3], counts: [[0; N]; 3] };

    fn add(&mut self, bounds: Bounds, bins: [usize; 3]) {
        for (axis, bin) in bins.into_iter().enumerate() {
            self.bounds[axis][bin] = self.bounds[axis][bin].union(bounds);
            self.counts[axis][bin] += 1;
        }
    }

    fn union(mut self, other: Self) -> Self {
        for axis in 0..3 {
            for bin in 0..N {
                self.bounds[axis][bin] = self.bounds[axis][bin].union(other.bounds[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    /// The axis and the first bin of the second group at the least cost; `None` where no cost is finite.
    fn best(&self, used: usize) -> Option<(usize, usize)> {
        let mut best = (f32::INFINITY, None);
        for axis in 0..3 {
            let (bounds, counts) = (&self.bounds[axis][..used], &self.counts[axis][..used]);
            let mut above = [f32::INFINITY; N];
            let (mut all, mut count) = (Bounds::EMPTY, 0);
            for bin in (1..used).rev() {
                all = all.union(bounds[bin]);
                count += counts[bin];
                above[bin] = if count > 0 { all.half_area() * count as f32 } else { f32::INFINITY };
            }
            (all, count) = (Bounds::EMPTY, 0);
            for bin in 1..used {
                all = all.union(bounds[bin - 1]);
                count += counts[bin - 1];
                if count > 0 {
                    let cost = all.half_area() * count as f32 + above[bin];
                    if cost < best.0 {
                        best = (cost, Some((axis, bin)));
                    }
                }
            }
        }
        best.1
    }
}

/// Which bin a box belongs to.
struct Grid {
    low: Vec3A,
    scale: Vec3A,
    used: usize,
}

impl Grid {
    /// For boxes whose doubled centres lie in `centers`.
    fn new(centers: Bounds, used: usize) -> Self {
        let scale = Vec3A::splat(used as f32 * (1.0 - f32::EPSILON)) / (centers.high - centers.low);
        // An axis without extent has one bin.
        Self {
            low: centers.low,
            scale: Vec3A::select(scale.cmplt(Vec3A::INFINITY), scale, Vec3A::ZERO),
            used,
        }
    }

    #[inline]
    fn bins(&self, bounds: Bounds) -> [usize; 3] {
        let place = (bounds.double_center() - self.low) * self.scale;
        place.to_array().map(|x| (x as usize).min(self.used - 1))
    }
}

/// Reorders `members`, which are two boxes or more, into two groups that are not empty; answers with the size of the
/// first. It depends on the order of `members`, never on the number of threads.
pub(super) fn split(boxes: &[Bounds], members: &mut [u32]) -> usize {
    let used = 4 + members.len() / 20;
    if members.len() == 2 {
        1
    } else if used <= FEW {
        split_in::<FEW>(boxes, members, used)
    } else {
        split_in::<MANY>(boxes, members, used.min(MANY))
    }
}

fn split_in<const N: usize>(boxes: &[Bounds], members: &mut [u32], used: usize) -> usize {
    let bounds = |member: &u32| boxes[*member as usize];
    let add = |all: &mut Bounds, member: &u32| {
        let center = bounds(member).double_center();
        *all = all.union(Bounds { low: center, high: center });
    };
    let grid = Grid::new(fold(members, || Bounds::EMPTY, add, Bounds::union), used);
    let add = |bins: &mut Bins<N>, member: &u32| bins.add(bounds(member), grid.bins(bounds(member)));
    let bins = fold(members, || Bins::<N>::EMPTY, add, Bins::union);
    let Some((axis, bin)) = bins.best(used) else { return members.len() / 2 };
    partition(members, |member| grid.bins(bounds(member))[axis] < bin)
}

/// Everything added up, in any order.
fn fold<T: Send>(
    members: &[u32],
    empty: impl Fn() -> T + Sync + Send,
    add: impl Fn(&mut T, &u32) + Sync + Send,
    union: impl Fn(T, T) -> T + Sync + Send,
) -> T {
    let all = |members: &[u32]| {
        let mut all = empty();
        members.iter().for_each(|member| add(&mut all, member));
        all
    };
    if members.len() < PARALLEL {
        return all(members);
    }
    members.par_chunks(PARALLEL / 2).map(all).reduce(&empty, union)
}

/// Moves what `is_first` to the front; answers with how many there are.
fn partition(members: &mut [u32], is_first: impl Fn(&u32) -> bool) -> usize {
    let (mut start, mut end) = (0, members.len());
    loop {
        while start < end && is_first(&members[start]) {
            start += 1;
        }
        while start < end && !is_first(&members[end - 1]) {
            end -= 1;
        }
        if start >= end {
            return start;
        }
        members.swap(start, end - 1);
    }
}
