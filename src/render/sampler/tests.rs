use super::*;

const EVEN: usize = 4 * EVEN_SETS as usize;

fn points(samples: std::ops::Range<u64>) -> Vec<Vec<f64>> {
    let sequence = Sequence::new(11, 3, 7);
    let point = |i| {
        let mut sobol = sequence.sample(i);
        (0..EVEN).map(|_| sobol.next_1d()).collect()
    };
    samples.map(point).collect()
}

/// Asserts that every box of 2^-shape[k] in dimension `first + k` holds as many of the points as any other.
fn assert_even(points: &[Vec<f64>], first: usize, shape: &[u32]) {
    let boxes = 1 << shape.iter().sum::<u32>();
    let mut counts = vec![0; boxes];
    for p in points {
        let cell = |cell, (k, &bits): (usize, &u32)| {
            cell << bits | (p[first + k] * f64::from(1u32 << bits)) as usize
        };
        counts[shape.iter().enumerate().fold(0, cell)] += 1;
    }
    assert!(counts.iter().all(|&n| n == points.len() / boxes), "{shape:?} from dimension {first}");
}

#[test]
fn every_interval_of_every_even_dimension_holds_one_sample() {
    for k in [0, 4, 10, 16] {
        let points = points(0..1 << k);
        (0..EVEN).for_each(|dimension| assert_even(&points, dimension, &[k]));
    }
}

#[test]
fn the_first_pair_of_each_set_is_a_net_and_the_whole_set_almost() {
    let points = points(0..256);
    for first in (0..EVEN).step_by(4) {
        (0..=8).for_each(|shape| assert_even(&points, first, &[shape, 8 - shape]));
        // The polynomials have degrees 0, 1, 2 and 3, so that boxes of 2³ samples are exact (Niederreiter 1987).
        for shape in [[2, 1, 1, 1], [1, 2, 1, 1], [1, 1, 2, 1], [1, 1, 1, 2], [0, 0, 2, 3], [0, 2, 0, 3]] {
            assert_even(&points, first, &shape);
        }
    }
}

#[test]
fn rounds_alone_and_together_are_nets() {
    let rounds: Vec<_> = (0..16).map(|round| points(round * 16..(round + 1) * 16)).collect();
    for first in (0..EVEN).step_by(4) {
        for round in &rounds {
            (0..=4).for_each(|shape| assert_even(round, first, &[shape, 4 - shape]));
        }
        (0..=8).for_each(|shape| assert_even(&rounds.concat(), first, &[shape, 8 - shape]));
        (0..=7).for_each(|shape| assert_even(&rounds[8..].concat(), first, &[shape, 7 - shape]));
    }
}

#[test]
fn pairs_stay_inside_one_set_and_long_paths_go_on() {
    let (mut a, mut b) = (Sequence::new(1, 0, 9).sample(5), Sequence::new(1, 0, 9).sample(5));
    (0..3).for_each(|_| _ = (a.next_1d(), b.next_1d()));
    b.next_1d();
    let set = b.next_4d();
    assert_eq!(a.next_2d(), [set[0], set[1]]);
    assert_eq!(a.next_2d(), [set[2], set[3]]);
    let mut sum = 0.0;
    for _ in 0..2000 {
        let x = a.next_1d();
        assert!((0.0..1.0).contains(&x));
        sum += x;
    }
    assert!((sum / 2000.0 - 0.5).abs() < 0.03);
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - 0.5) * (b - 0.5)).sum::<f64>() / a.len() as f64 * 12.0
}

#[test]
fn pixels_streams_and_seeds_are_uncorrelated_and_reproducible() {
    let column = |seed, stream, pixel| -> Vec<f64> {
        (0..4096).map(|i| Sequence::new(seed, stream, pixel).sample(i).next_1d()).collect()
    };
    let base = column(1, 1, 1);
    assert_eq!(base, column(1, 1, 1));
    for other in [column(2, 1, 1), column(1, 2, 1), column(1, 1, 2), column(1, 1, 1 << 20)] {
        // Standard deviation is 1/64.
        assert!(correlation(&base, &other).abs() < 0.08);
        let means = (base.iter().sum::<f64>() - other.iter().sum::<f64>()).abs() / 4096.0;
        assert!(means < 1e-3);
    }
}

#[test]
fn dimensions_even_and_random_are_uncorrelated() {
    let columns: Vec<Vec<f64>> = (0..EVEN + 8)
        .map(|dimension| {
            let value = |i| {
                let mut sobol = Sequence::new(4, 0, 2).sample(i);
                (0..dimension).for_each(|_| _ = sobol.next_1d());
                sobol.next_1d()
            };
            (0..4096).map(value).collect()
        })
        .collect();
    for i in 0..columns.len() {
        for j in 0..i {
            // Standard deviation is 1/64; the largest of 946.
            let found = correlation(&columns[i], &columns[j]);
            assert!(found.abs() < 5.0 / 64.0, "{i} {j}: {found}");
        }
    }
}

#[test]
fn a_single_sample_is_uniform_over_pixels_in_all_bits() {
    // χ² with 63 degrees of freedom stays below 120 with probability 0.99998.
    for shift in [0, 17, 26, 40] {
        let mut counts = [0u32; 64];
        for pixel in 0..20_000 {
            let sample = Sequence::new(3, 0, pixel).sample(2).next_2d()[1];
            let bits = (sample * (1u64 << 52) as f64) as u64;
            counts[(bits << 12 << shift >> 58) as usize] += 1;
        }
        let chi: f64 = counts.iter().map(|&c| (f64::from(c) - 312.5).powi(2) / 312.5).sum();
        assert!(chi < 120.0, "bits from {shift}: {chi}");
    }
}

#[test]
fn more_than_a_table_of_samples_begins_a_new_scramble() {
    let value = |sample| Sequence::new(1, 0, 1).sample(sample).next_1d();
    for block in [1, 2, 1 << 33] {
        assert_ne!(value(5), value(5 + (block << 16)));
        let mean = (block << 16..(block << 16) + 1024).map(value).sum::<f64>() / 1024.0;
        assert!((mean - 0.5).abs() < 1e-3);
    }
}
