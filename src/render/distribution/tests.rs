use super::*;
use crate::{
    chi2,
    rng::{Purpose, Rng},
};

/// p-value of counts against expected counts; cells without expectation must be empty.
fn chi_square(counts: &[f64], expected: &[f64]) -> f64 {
    let cells = expected.iter().copied().zip(counts.iter().copied());
    assert!(cells.clone().all(|(expected, count)| expected > 0.0 || count == 0.0));
    chi2::p_value(cells)
}

#[test]
fn discrete_follows_its_weights_and_never_picks_zero() {
    let weights = [0.0, 3.0, 0.0, 0.5, 1e-3, 0.0, 7.0, f64::NAN, -4.0, f64::INFINITY, 0.0];
    let discrete = Discrete::new(&weights);
    assert_eq!(discrete.total(), 10.501);
    let mut rng = Rng::new(1, Purpose::Test, 0, 0);
    let n = 400_000;
    let mut counts = [0.0; 11];
    for _ in 0..n {
        counts[discrete.sample(rng.f64()).unwrap().0] += 1.0;
    }
    let expected: Vec<f64> = (0..11).map(|i| discrete.pmf(i) * f64::from(n)).collect();
    assert!((expected[6] / f64::from(n) - 7.0 / 10.501).abs() < 1e-12);
    assert!(chi_square(&counts, &expected) > 1e-4);
    assert_eq!((discrete.sample(0.0).unwrap().0, discrete.sample(1.0 - 1e-16).unwrap().0), (1, 6));
    assert_eq!(discrete.pmf(11), 0.0);
}

#[test]
fn discrete_inverts_with_a_million_entries() {
    let mut rng = Rng::new(2, Purpose::Test, 0, 0);
    let weights: Vec<f64> = (0..1_000_000).map(|_| (8.0 * rng.f64()).exp() - 2.0).collect();
    let discrete = Discrete::new(&weights);
    let mut remapped_mean = 0.0;
    for _ in 0..10_000 {
        let u = rng.f64();
        let (index, pmf, remapped) = discrete.sample(u).unwrap();
        assert!((0.0..1.0).contains(&remapped));
        assert!((pmf * discrete.total() / weights[index] - 1.0).abs() < 1e-3);
        assert!((discrete.invert(index, remapped) - u).abs() < 1e-15);
        remapped_mean += remapped / 10_000.0;
    }
    assert!((remapped_mean - 0.5).abs() < 0.015);
}

#[test]
fn nothing_to_choose_from_gives_none() {
    assert!(Discrete::default().sample(0.5).is_none());
    assert_eq!(Discrete::default().pmf(0), 0.0);
    assert!(Discrete::new(&[]).sample(0.5).is_none());
    assert!(Discrete::new(&[0.0, -1.0, f64::NAN]).sample(0.5).is_none());
    assert!(Grid2d::new(2, &[0.0; 4]).is_none());
    assert!(Grid2d::new(0, &[]).is_none());
    assert!(Grid2d::new(2, &[1.0; 3]).is_none());
}

const WEIGHTS: [f64; 15] = [1.0, 0.0, 5.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 40.0, 0.0, 2.0, 9.0];

#[test]
fn grid_follows_its_density() {
    let grid = Grid2d::new(5, &WEIGHTS).unwrap();
    let total: f64 = WEIGHTS.iter().sum();
    let mut rng = Rng::new(3, Purpose::Test, 0, 0);
    // Quarter cells show that points are uniform inside cells.
    let mut counts = vec![0.0; 60];
    for _ in 0..300_000 {
        let (p, pdf) = grid.sample(rng.pair());
        assert!((pdf - grid.pdf(p)).abs() < 1e-12);
        counts[(p[1] * 6.0) as usize * 10 + (p[0] * 10.0) as usize] += 1.0;
    }
    let expected: Vec<f64> =
        (0..60).map(|i| 300_000.0 / 4.0 * WEIGHTS[i / 20 * 5 + i % 10 / 2] / total).collect();
    assert!(chi_square(&counts, &expected) > 1e-4);
    assert!((grid.pdf([0.3, 0.99]) - 15.0 * 40.0 / total).abs() < 1e-12);
    assert_eq!((grid.pdf([0.5, 0.5]), grid.pdf([1.0, 0.1]), grid.pdf([f64::NAN, 0.1])), (0.0, 0.0, 0.0));
}

#[test]
fn grid_inverts_and_has_no_inverse_where_it_is_zero() {
    let grid = Grid2d::new(5, &WEIGHTS).unwrap();
    let mut rng = Rng::new(4, Purpose::Test, 0, 0);
    for _ in 0..100_000 {
        let u = rng.pair();
        let (p, _) = grid.sample(u);
        let back = grid.invert(p).unwrap();
        assert!((back[0] - u[0]).abs() < 1e-12 && (back[1] - u[1]).abs() < 1e-12);
    }
    assert!(grid.invert([0.5, 0.5]).is_none());
    for corner in [[0.0, 0.0], [0.0, BELOW_ONE], [BELOW_ONE, 0.0], [BELOW_ONE, BELOW_ONE]] {
        let (p, pdf) = grid.sample(corner);
        assert!(pdf > 0.0 && p.iter().all(|x| (0.0..1.0).contains(x)));
    }
}
