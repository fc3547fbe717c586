//! Averages over neighbouring pixels that hardly bleed across the edges of surfaces.

use rayon::prelude::*;

use super::path::Space;
use crate::features::{Features, features_of};

/// How far a point may lie off the plane of a surface that goes on there, relative to its depth.
const FLAT: f32 = 0.03;
/// Least cosine between normals of a surface that goes on.
const ALIKE: f32 = 0.8;
/// How many times as bright as its own surface the surroundings of a pixel may make it. Some is good: chains pass an edge
/// more easily where brightness rises towards it.
const MOST_BLEEDING: f64 = 4.0;
/// Share of the square that has to see the pixel's own surface for it to be told apart: a blade of grass is too small.
const LEAST_OWN: f64 = 0.2;

/// What each pixel of the window sees first.
pub struct Surfaces {
    seen: Vec<Features>,
    width: usize,
}

impl Surfaces {
    /// Of one eye path for each pixel.
    pub fn new(space: &Space<'_>) -> Self {
        let seen = features_of(space.world, space.window, 1);
        Self { seen, width: space.window.width() as usize }
    }

    /// Mean over the square of pixels around each, `reach` on each side; but where others see another surface, at most a
    /// few times the mean over those that see the same, if they are not few: light through a gap is not that on the door
    /// beside it.
    pub fn smooth(&self, values: &[f64], reach: usize) -> Vec<f64> {
        let own = self.mean(values, reach, |pixel, other| self.goes_on(pixel, other));
        let all = self.mean(values, reach, |_, _| true);
        let join = |((own, some), (all, square)): ((f64, usize), (f64, usize))| {
            let few = (some as f64) < LEAST_OWN * square as f64;
            if few { all } else { all.max(own).min(MOST_BLEEDING * own) }
        };
        own.into_iter().zip(all).map(join).collect()
    }

    /// Whether pixel `other` sees the surface that `pixel` sees.
    fn goes_on(&self, pixel: usize, other: usize) -> bool {
        let (here, there) = (&self.seen[pixel], &self.seen[other]);
        let normal = here.geometric_normal;
        here.object == there.object
            && (here.object == 0
                || normal.dot(there.geometric_normal) > ALIKE
                    && normal.dot(there.position - here.position).abs() <= FLAT * here.depth)
    }

    /// Mean over those pixels of the square that `belongs` lets in, along rows and then along columns; and their number.
    fn mean(
        &self,
        values: &[f64],
        reach: usize,
        belongs: impl Fn(usize, usize) -> bool + Sync,
    ) -> Vec<(f64, usize)> {
        let (width, height) = (self.width, values.len() / self.width);
        let span = |i: usize, n: usize| i.saturating_sub(reach)..(i + reach + 1).min(n);
        let belongs = |pixel, other| pixel == other || belongs(pixel, other);
        let add = |(a, n): (f64, usize), (b, m): (f64, usize)| (a + b, n + m);
        let across = |pixel: usize| {
            let (x, row) = (pixel % width, pixel - pixel % width);
            let others = span(x, width).map(|x| row + x).filter(|&other| belongs(pixel, other));
            others.map(|other| (values[other], 1)).fold((0.0, 0), add)
        };
        let rows: Vec<(f64, usize)> = (0..values.len()).into_par_iter().map(across).collect();
        let down = |pixel: usize| {
            let (x, y) = (pixel % width, pixel / width);
            let others = span(y, height).map(|y| y * width + x).filter(|&other| belongs(pixel, other));
            let (sum, count) = others.map(|other| rows[other]).fold((0.0, 0), add);
            (sum / count as f64, count)
        };
        (0..values.len()).into_par_iter().map(down).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bright gap of two columns between two dark surfaces.
    fn gap() -> (Surfaces, Vec<f64>) {
        let width = 12;
        let column = |pixel: usize| pixel % width;
        let object = |pixel| if (5..7).contains(&column(pixel)) { 2 } else { 1 };
        let seen = |pixel| Features {
            object: object(pixel),
            geometric_normal: glam::Vec3::Z,
            ..Features::default()
        };
        let value = |pixel| if object(pixel) == 2 { 1000.0 } else { 1.0 };
        let pixels = 0..width * 6;
        (Surfaces { seen: pixels.clone().map(seen).collect(), width }, pixels.map(value).collect())
    }

    #[test]
    fn light_hardly_bleeds_beyond_its_surface() {
        let (surfaces, values) = gap();
        let smooth = surfaces.smooth(&values, 2);
        let row = |column: usize| smooth[24 + column];
        assert_eq!((row(2), row(9)), (1.0, 1.0));
        assert_eq!((row(3), row(4), row(7), row(8)), (4.0, 4.0, 4.0, 4.0));
        assert_eq!((row(5), row(6)), (1000.0, 1000.0));
    }

    #[test]
    fn a_surface_of_few_pixels_is_not_told_apart() {
        let (mut surfaces, values) = gap();
        let alone = 24 + 3;
        surfaces.seen[alone].object = 3;
        assert_eq!(surfaces.smooth(&values, 2)[alone], 200.8);
    }

    #[test]
    fn a_surface_is_averaged_as_a_square() {
        let (mut surfaces, values) = gap();
        surfaces.seen.iter_mut().for_each(|seen| seen.object = 1);
        let smooth = surfaces.smooth(&values, 2);
        // Two of five columns, in any row, at the edge of the image as well.
        assert_eq!((smooth[5], smooth[24 + 5], smooth[60 + 6]), (400.6, 400.6, 400.6));
    }
}
