//! Do two images show the same? z-tests over blocks and over the whole image, from independent rounds.

use ajar_render::{film::Film, math::Rgb};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Mean of the square block at (x, y).
fn block(film: &Film, width: usize, x: usize, y: usize, side: usize) -> Rgb {
    let rows = (y..y + side).flat_map(|row| (x..x + side).map(move |column| row * width + column));
    rows.map(|pixel| film.mean(pixel)).sum::<Rgb>() / (side * side) as f64
}

/// The |z| that is as unlikely as the difference of two means, each with the variance of the mean and the number of rounds
/// that these come from (Welch 1947).
fn welch((ma, va, na): (f64, f64, f64), (mb, vb, nb): (f64, f64, f64)) -> f64 {
    let variance = va + vb + (2e-4 * ma.max(mb)).powi(2) + 1e-30;
    let freedom = variance * variance / (va * va / (na - 1.0) + vb * vb / (nb - 1.0) + 1e-60);
    let t = (ma - mb).abs() / variance.sqrt();
    let tail = StudentsT::new(0.0, 1.0, freedom.clamp(1.0, 1e6)).unwrap().sf(t);
    -Normal::standard().inverse_cdf(tail.max(1e-300))
}

/// Mean colours of blocks of 8 × 8 pixels, and of the image, in each round. Neighbouring pixels of a Metropolis image are
/// correlated; rounds are not.
pub struct Blocks {
    pub rounds: Vec<Vec<Rgb>>,
}

/// Side of a block, pixels.
pub const SIDE: usize = 8;

impl Blocks {
    /// Adds a film of a single round.
    pub fn add(&mut self, film: &Film, width: usize) {
        let height = film.pixels() / width;
        let mut means = Vec::new();
        for y in (0..height / SIDE * SIDE).step_by(SIDE) {
            for x in (0..width / SIDE * SIDE).step_by(SIDE) {
                means.push(block(film, width, x, y, SIDE));
            }
        }
        means.push(block(film, width, 0, 0, width.min(height)));
        self.rounds.push(means);
    }

    /// Mean and variance of the mean of a block; the last is the image.
    pub fn estimate(&self, block: usize) -> (Rgb, Rgb) {
        let n = self.rounds.len() as f64;
        let mean = self.rounds.iter().map(|r| r[block]).sum::<Rgb>() / n;
        let squares = self.rounds.iter().map(|r| (r[block] - mean).powf(2.0)).sum::<Rgb>();
        (mean, squares / (n * (n - 1.0)))
    }

    /// |z| of the worst block and of the image: Welch's t, which has heavy tails for few rounds, at the same level.
    pub fn z_scores(&self, other: &Self) -> (f64, f64) {
        let last = self.rounds[0].len() - 1;
        let z = |block| {
            let ((ma, va), (mb, vb)) = (self.estimate(block), other.estimate(block));
            let (na, nb) = (self.rounds.len() as f64, other.rounds.len() as f64);
            (0..3).map(|c| welch((ma[c], va[c], na), (mb[c], vb[c], nb))).fold(0.0, f64::max)
        };
        ((0..last).map(z).fold(0.0, f64::max), z(last))
    }
}

/// Fails unless the images agree: |z| < 4.5 in blocks (some hundred of them, heavy tails) and < 4 overall.
pub fn assert_blocks_agree(name: &str, a: &Blocks, b: &Blocks) {
    let (blocks, total) = a.z_scores(b);
    println!("{name}: largest block z {blocks:.2}, image z {total:.2}");
    assert!(blocks < 4.5 && total < 4.0, "{name}: largest block z {blocks:.2}, image z {total:.2}");
}
