//! Vector registers and arrays compute the same.

use super::rng;
use crate::bvh::lanes::{Eight, Four};

#[path = "../lanes_portable.rs"]
mod portable;

/// Numbers of many sizes, and those that are special.
fn number(rng: &mut crate::rng::Rng) -> f32 {
    const SPECIAL: [f32; 7] = [0.0, -0.0, 1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE];
    match rng.below(20) {
        i if i < SPECIAL.len() => SPECIAL[i],
        _ => (rng.f64() * 2.0 - 1.0) as f32 * 2f32.powi(rng.below(8) as i32 - 4),
    }
}

/// Bits, with all NaN alike.
fn bits<const N: usize>(x: [f32; N]) -> [u32; N] {
    x.map(|x| if x.is_nan() { 1 } else { x.to_bits() })
}

#[test]
fn registers_and_arrays_agree() {
    let mut rng = rng(9);
    for _ in 0..20_000 {
        let (x, y): ([f32; 4], [f32; 4]) =
            (std::array::from_fn(|_| number(&mut rng)), std::array::from_fn(|_| number(&mut rng)));
        let (a, b) = (Four::new(&x), Four::new(&y));
        let (p, q) = (portable::Four::new(&x), portable::Four::new(&y));
        assert_eq!(bits((a + b).to_array()), bits((p + q).to_array()));
        assert_eq!(bits((a - b).to_array()), bits((p - q).to_array()));
        assert_eq!(bits((a * b).to_array()), bits((p * q).to_array()));
        assert_eq!(bits(a.min(b).to_array()), bits(p.min(q).to_array()));
        assert_eq!(bits(a.max(b).to_array()), bits(p.max(q).to_array()));
        assert_eq!(bits(a.inverse().to_array()), bits(p.inverse().to_array()));
        assert_eq!((a.at_most(b) | a.is_zero()).bits(), (p.at_most(q) | p.is_zero()).bits());
        assert_eq!((a.below(b) & b.at_most(a)).bits(), (p.below(q) & q.at_most(p)).bits());

        let (x, y): ([f32; 8], [f32; 8]) =
            (std::array::from_fn(|_| number(&mut rng)), std::array::from_fn(|_| number(&mut rng)));
        let (a, b) = (Eight::new(&x), Eight::new(&y));
        let (p, q) = (portable::Eight::new(&x), portable::Eight::new(&y));
        assert_eq!(a.at_most(b), p.at_most(q));
        assert_eq!(bits(a.min(b).to_array()), bits(p.min(q).to_array()));
        assert_eq!(bits(a.max(b).to_array()), bits(p.max(q).to_array()));
        let one = (Eight::splat(1.0), portable::Eight::splat(1.0));
        let (c, r) = (a.multiply_subtract(one.0, b), p.multiply_subtract(one.1, q));
        assert_eq!(bits(c.to_array()), bits(r.to_array()));
    }
}
