//! Piecewise-constant distributions, sampled by inverting their cumulative sums.
//!
//! Every map from random numbers is monotone and has an exact inverse, which Metropolis moves need (`invert`). No alias
//! tables for that reason: they have no inverse worth the name.

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// A choice among indices with probabilities proportional to weights. The default chooses nothing.
#[derive(Clone, Debug, Default)]
pub struct Discrete {
    /// Cumulative probabilities, from 0 to exactly 1, one more than there are indices; all 0 if nothing can be chosen.
    cdf: Vec<f64>,
    total: f64,
}

impl Discrete {
    /// Weights that are negative or not finite count as zero.
    pub fn new(weights: &[f64]) -> Self {
        let mut cdf = vec![0.0; weights.len() + 1];
        let total = accumulate(weights, &mut cdf);
        Self { cdf, total }
    }

    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Index, its probability, and what is left of `u` in [0, 1), uniform given the index. `None` if all weights are
    /// zero.
    #[inline]
    pub fn sample(&self, u: f64) -> Option<(usize, f64, f64)> {
        (self.total > 0.0).then(|| sample_cdf(&self.cdf, u))
    }

    /// Probability of `index`, 0 beyond the end.
    #[inline]
    pub fn pmf(&self, index: usize) -> f64 {
        pmf_cdf(&self.cdf, index)
    }

    /// The number in [0, 1) that [`sample`](Self::sample) maps to `index` and `remapped`.
    pub fn invert(&self, index: usize, remapped: f64) -> f64 {
        invert_cdf(&self.cdf, index, remapped)
    }
}

/// A density over the unit square, constant in the cells of a regular grid.
#[derive(Clone, Debug)]
pub struct Grid2d {
    columns: usize,
    /// Cumulative probabilities of the rows.
    marginal: Vec<f64>,
    total: f64,
    /// `columns + 1` cumulative probabilities a row.
    conditional: Vec<f64>,
}

impl Grid2d {
    /// A density proportional to `weights`, rows of `columns` cells, the first row at y = 0. Weights that are negative
    /// or not finite count as zero. `None` if nothing is left or the weights fill no whole rows.
    pub fn new(columns: usize, weights: &[f64]) -> Option<Self> {
        if columns == 0 || !weights.len().is_multiple_of(columns) {
            return None;
        }
        let mut conditional = vec![0.0; weights.len() / columns * (columns + 1)];
        let sums: Vec<f64> = weights
            .chunks_exact(columns)
            .zip(conditional.chunks_exact_mut(columns + 1))
            .map(|(weights, cdf)| accumulate(weights, cdf))
            .collect();
        let mut marginal = vec![0.0; sums.len() + 1];
        let total = accumulate(&sums, &mut marginal);
        (total > 0.0).then_some(Self { columns, marginal, total, conditional })
    }

    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    fn rows(&self) -> usize {
        self.marginal.len() - 1
    }

    /// A point in [0, 1)² and its density. `u[0]` drives x and `u[1]` drives y.
    pub fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        let (row, row_pmf, v) = sample_cdf(&self.marginal, u[1]);
        let (column, column_pmf, w) = sample_cdf(self.row(row), u[0]);
        let (columns, rows) = (self.columns as f64, self.rows() as f64);
        let x = ((column as f64 + w) / columns).min(BELOW_ONE);
        let y = ((row as f64 + v) / rows).min(BELOW_ONE);
        ([x, y], row_pmf * column_pmf * columns * rows)
    }

    /// Density at a point; 0 outside the unit square.
    pub fn pdf(&self, point: [f64; 2]) -> f64 {
        let Some((column, row)) = self.cell(point) else { return 0.0 };
        let pmf = pmf_cdf(&self.marginal, row.index) * pmf_cdf(self.row(row.index), column.index);
        pmf * (self.columns * self.rows()) as f64
    }

    /// The numbers in [0, 1)² that [`sample`](Self::sample) maps to `point`; `None` where the density is 0.
    pub fn invert(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        let (column, row) = self.cell(point)?;
        if self.pdf(point) <= 0.0 {
            return None;
        }
        let u = invert_cdf(self.row(row.index), column.index, column.inside);
        Some([u, invert_cdf(&self.marginal, row.index, row.inside)])
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.conditional[row * (self.columns + 1)..(row + 1) * (self.columns + 1)]
    }

    fn cell(&self, [x, y]: [f64; 2]) -> Option<(Cell, Cell)> {
        Some((Cell::new(x, self.columns)?, Cell::new(y, self.rows())?))
    }
}

/// One coordinate in units of cells.
struct Cell {
    index: usize,
    /// Position inside the cell, in [0, 1).
    inside: f64,
}

impl Cell {
    fn new(coordinate: f64, count: usize) -> Option<Self> {
        if !(0.0..1.0).contains(&coordinate) {
            return None;
        }
        let scaled = coordinate * count as f64;
        // Rounding can lift the product to `count` itself.
        let index = (scaled as usize).min(count - 1);
        Some(Self { index, inside: (scaled - index as f64).min(BELOW_ONE) })
    }
}

/// Writes the cumulative probabilities of `weights` to `cdf` (zeros if there is no weight) and returns the weights' sum.
fn accumulate(weights: &[f64], cdf: &mut [f64]) -> f64 {
    let mut total = 0.0;
    for (&weight, sum) in weights.iter().zip(&mut cdf[1..]) {
        if weight > 0.0 && weight.is_finite() {
            total += weight;
        }
        *sum = total;
    }
    if total > 0.0 {
        cdf.iter_mut().for_each(|sum| *sum /= total);
    }
    total
}

#[inline]
fn sample_cdf(cdf: &[f64], u: f64) -> (usize, f64, f64) {
    // The last entry not above u starts the interval: empty intervals are never chosen.
    let u = u.clamp(0.0, BELOW_ONE);
    let index = cdf.partition_point(|&sum| sum <= u).clamp(1, cdf.len() - 1) - 1;
    let pmf = cdf[index + 1] - cdf[index];
    (index, pmf, ((u - cdf[index]) / pmf).clamp(0.0, BELOW_ONE))
}

#[inline]
fn pmf_cdf(cdf: &[f64], index: usize) -> f64 {
    cdf.get(index + 1).map_or(0.0, |sum| sum - cdf[index])
}

fn invert_cdf(cdf: &[f64], index: usize, remapped: f64) -> f64 {
    (cdf[index] + remapped * pmf_cdf(cdf, index)).min(BELOW_ONE)
}

#[cfg(test)]
mod tests;
