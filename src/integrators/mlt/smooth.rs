//! Averages over squares of pixels that hardly bleed across the edges of surfaces.

use std::ops::Range;

use glam::{DVec2, DVec3, DVec4, Vec3, Vec4Swizzles};
use rayon::prelude::*;

use super::path::Space;

/// Sine of the angle by which a surface that goes on may leave the plane of a pixel's own.
const FLAT: f32 = 0.3;
/// Least cosine between normals of a surface that goes on.
const ALIKE: f32 = 0.8;
/// How many times as bright as its own surface the surroundings of a pixel may make it. Some is good: chains pass an edge
/// more easily where brightness rises towards it.
const MOST_BLEEDING: f64 = 4.0;
/// Share of what the square holds that has to be of the pixel's own surface for it to be told apart: a blade of grass is
/// too small.
const LEAST_OWN: f64 = 0.2;

/// Three values of a pixel that are to be averaged, and 1; nothing but 0 where there are none.
pub type Values = DVec4;

/// Mean over the square of pixels around each, `reach` on each side, as far as they have values.
pub fn smooth(values: &[Values], width: usize, reach: usize) -> Vec<DVec3> {
    let squares = Squares::new(values, width, reach);
    (0..values.len()).into_par_iter().map(|pixel| mean(squares.sum(pixel))).collect()
}

/// What each pixel of the window sees first, at its centre.
pub struct Surfaces {
    seen: Vec<Seen>,
    width: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// 1 + number of the placed mesh; 0 where there is none.
    object: u32,
    normal: Vec3,
    position: Vec3,
}

impl Surfaces {
    /// Of one ray for each pixel.
    pub fn new(space: &Space<'_>) -> Self {
        let window = space.window;
        let width = window.width() as usize;
        let look = |pixel: usize| {
            let corner = DVec2::new((pixel % width) as f64, (pixel / width) as f64);
            let raster = corner + DVec2::new(window.x0.into(), window.y0.into()) + 0.5;
            let ray = space.world.camera.ray(raster, [0.5; 2]);
            let hit =
                if space.cancelled() { None } else { space.world.trace(ray.origin, ray.direction, true, 0) };
            hit.map_or_else(Seen::default, |hit| Seen {
                object: 1 + hit.site.instance,
                normal: (hit.ng * -hit.ng.dot(ray.direction).signum()).as_vec3(),
                position: hit.p.as_vec3(),
            })
        };
        Self { seen: (0..window.pixels()).into_par_iter().map(look).collect(), width }
    }

    /// As [`smooth`], but no less than the mean over those that see the same surface, and at most a few times that, unless
    /// they are few: light through a gap is not that on the door beside it.
    pub fn smooth(&self, values: &[Values], reach: usize) -> Vec<DVec3> {
        let squares = Squares::new(values, self.width, reach);
        let rows: Vec<Values> = (0..values.len())
            .into_par_iter()
            .map(|pixel| {
                let (x, row) = (pixel % self.width, pixel - pixel % self.width);
                self.sum_of_own(pixel, squares.columns(x).map(|x| row + x), values)
            })
            .collect();
        let join = |pixel: usize| {
            let (x, y) = (pixel % self.width, pixel / self.width);
            let own = self.sum_of_own(pixel, squares.rows(y).map(|y| y * self.width + x), &rows);
            let all = squares.sum(pixel);
            let few = own.w < LEAST_OWN * all.w;
            if few { mean(all) } else { mean(all).max(mean(own)).min(MOST_BLEEDING * mean(own)) }
        };
        (0..values.len()).into_par_iter().map(join).collect()
    }

    fn sum_of_own(&self, pixel: usize, others: impl Iterator<Item = usize>, values: &[Values]) -> Values {
        let own = |&other: &usize| other == pixel || self.goes_on(pixel, other);
        others.filter(own).map(|other| values[other]).sum()
    }

    /// Whether pixel `other` sees the surface that `pixel` sees.
    fn goes_on(&self, pixel: usize, other: usize) -> bool {
        let (here, there) = (&self.seen[pixel], &self.seen[other]);
        let way = there.position - here.position;
        here.object == there.object
            && (here.object == 0
                || here.normal.dot(there.normal) > ALIKE && here.normal.dot(way).abs() <= FLAT * way.length())
    }
}

/// Sums over squares of pixels, by a table of those over all rectangles from the first pixel on (Crow 1984).
struct Squares {
    table: Vec<Values>,
    width: usize,
    height: usize,
    reach: usize,
}

impl Squares {
    fn new(values: &[Values], width: usize, reach: usize) -> Self {
        let height = values.len() / width;
        let mut table = vec![Values::ZERO; (width + 1) * (height + 1)];
        for y in 0..height {
            let mut row = Values::ZERO;
            for x in 0..width {
                row += values[y * width + x];
                table[(y + 1) * (width + 1) + x + 1] = table[y * (width + 1) + x + 1] + row;
            }
        }
        Self { table, width, height, reach }
    }

    fn columns(&self, x: usize) -> Range<usize> {
        x.saturating_sub(self.reach)..(x + self.reach + 1).min(self.width)
    }

    fn rows(&self, y: usize) -> Range<usize> {
        y.saturating_sub(self.reach)..(y + self.reach + 1).min(self.height)
    }

    fn sum(&self, pixel: usize) -> Values {
        let (columns, rows) = (self.columns(pixel % self.width), self.rows(pixel / self.width));
        let at = |x: usize, y: usize| self.table[y * (self.width + 1) + x];
        let band = |y: usize| at(columns.end, y) - at(columns.start, y);
        // Rounding of large sums must not make little of nothing.
        (band(rows.end) - band(rows.start)).max(Values::ZERO)
    }
}

fn mean(sum: Values) -> DVec3 {
    if sum.w > 0.5 { sum.xyz() / sum.w } else { DVec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 12;

    /// A bright gap of two columns between two dark surfaces.
    fn gap() -> (Surfaces, Vec<Values>) {
        let in_gap = |pixel: usize| (5..7).contains(&(pixel % WIDTH));
        let seen = |pixel| Seen { object: 1 + u32::from(in_gap(pixel)), normal: Vec3::Z, ..Seen::default() };
        let values = |pixel| if in_gap(pixel) { Values::new(1000.0, 1.0, 0.0, 1.0) } else { Values::ONE };
        let pixels = 0..WIDTH * 6;
        (Surfaces { seen: pixels.clone().map(seen).collect(), width: WIDTH }, pixels.map(values).collect())
    }

    #[test]
    fn light_hardly_bleeds_beyond_its_surface() {
        let (surfaces, values) = gap();
        let smooth = surfaces.smooth(&values, 2);
        let at = |column: usize| smooth[24 + column].x;
        assert_eq!((at(2), at(9)), (1.0, 1.0));
        assert_eq!((at(3), at(4), at(7), at(8)), (4.0, 4.0, 4.0, 4.0));
        assert_eq!((at(5), at(6)), (1000.0, 1000.0));
        assert!(smooth.iter().all(|mean| mean.y == 1.0));
    }

    #[test]
    fn pixels_without_values_are_passed_over() {
        let (surfaces, mut values) = gap();
        for (pixel, value) in values.iter_mut().enumerate() {
            if pixel % WIDTH % 2 == 1 || pixel / WIDTH % 2 == 1 {
                *value = Values::ZERO;
            }
        }
        let smooth = surfaces.smooth(&values, 2);
        let at = |column: usize| smooth[24 + column].x;
        assert_eq!((at(2), at(3), at(4), at(5), at(6), at(7)), (1.0, 1.0, 4.0, 1000.0, 1000.0, 4.0));
    }

    #[test]
    fn a_surface_of_few_pixels_is_not_told_apart() {
        let (mut surfaces, values) = gap();
        let alone = 24 + 3;
        surfaces.seen[alone].object = 3;
        assert_eq!(surfaces.smooth(&values, 2)[alone].x, 200.8);
    }

    #[test]
    fn surfaces_end_at_edges_and_steps() {
        let (mut surfaces, _) = gap();
        surfaces.seen[0].position = Vec3::ZERO;
        let mut goes_on = |normal, position| {
            surfaces.seen[1] = Seen { object: 1, normal, position };
            surfaces.goes_on(0, 1)
        };
        assert!(goes_on(Vec3::Z, Vec3::new(1.0, 0.0, 0.1)));
        assert!(!goes_on(Vec3::X, Vec3::new(1.0, 0.0, 0.1)));
        assert!(!goes_on(Vec3::Z, Vec3::new(1.0, 0.0, 1.0)));
    }

    #[test]
    fn a_surface_is_averaged_as_a_square() {
        let (mut surfaces, values) = gap();
        surfaces.seen.iter_mut().for_each(|seen| seen.object = 1);
        let (aware, plain) = (surfaces.smooth(&values, 2), smooth(&values, WIDTH, 2));
        // Two of five columns, in any row, at the edge of the image as well.
        for pixel in [5, 24 + 5, 60 + 6] {
            assert_eq!((aware[pixel].x, plain[pixel].x), (400.6, 400.6));
        }
    }
}
