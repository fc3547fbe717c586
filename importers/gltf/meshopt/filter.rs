//! What numbers were turned into before they were compressed, undone.

use std::f32::consts::FRAC_1_SQRT_2;

use serde::Deserialize;

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum Filter {
    #[default]
    None,
    /// Unit vectors as points of an octahedron.
    Octahedral,
    /// Unit quaternions without their largest component.
    Quaternion,
    /// Numbers with a common exponent.
    Exponential,
}

impl Filter {
    /// Undoes it in elements of `stride` bytes; `None` if it does not go with them.
    pub fn apply(self, bytes: &mut [u8], stride: usize) -> Option<()> {
        let elements = bytes.chunks_exact_mut(stride);
        match (self, stride) {
            (Self::None, _) => {}
            (Self::Octahedral, 4) => elements.for_each(|element| {
                let [x, y, one, _] = [0, 1, 2, 3].map(|i| f32::from(element[i] as i8));
                let normal = octahedral(x, y, one).map(|c| (c * 127.0).round() as i8 as u8);
                element[..3].copy_from_slice(&normal);
            }),
            (Self::Octahedral, 8) => elements.for_each(|element| {
                let [x, y, one, _] = shorts(element).map(f32::from);
                let [x, y, z] = octahedral(x, y, one).map(|c| (c * 32767.0).round() as i16);
                let [.., last] = shorts(element);
                store(element, [x, y, z, last]);
            }),
            (Self::Quaternion, 8) => elements.for_each(|element| {
                let found = quaternion(shorts(element));
                store(element, found);
            }),
            (Self::Exponential, _) => bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|number| {
                let bits = i32::from_le_bytes(*number);
                let (mantissa, exponent) = (bits << 8 >> 8, bits >> 24);
                let value = f64::from(mantissa) * f64::from(exponent).exp2();
                *number = (value as f32).to_le_bytes();
            }),
            _ => return None,
        }
        Some(())
    }
}

/// The unit vector of a point of the octahedron whose largest coordinate is `one`.
fn octahedral(x: f32, y: f32, one: f32) -> [f32; 3] {
    let z = one - x.abs() - y.abs();
    // The lower half is folded over the edges of the upper one.
    let fold = z.min(0.0);
    let [x, y] = [x, y].map(|c| if c >= 0.0 { c + fold } else { c - fold });
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|c| if length > 0.0 { c / length } else { 0.0 })
}

/// The quaternion of three components; the fourth number holds the scale and which component is missing.
fn quaternion([x, y, z, scale]: [i16; 4]) -> [i16; 4] {
    let unit = FRAC_1_SQRT_2 / f32::from(scale | 3);
    let small = [x, y, z].map(|c| f32::from(c) * unit);
    let large = (1.0 - small.iter().map(|c| c * c).sum::<f32>()).max(0.0).sqrt();
    let missing = (scale & 3) as usize;
    let mut found = [0; 4];
    for (k, component) in [large, small[0], small[1], small[2]].into_iter().enumerate() {
        found[(missing + k) & 3] = (component * 32767.0).round() as i16;
    }
    found
}

fn shorts(element: &[u8]) -> [i16; 4] {
    std::array::from_fn(|i| i16::from_le_bytes([element[2 * i], element[2 * i + 1]]))
}

fn store(element: &mut [u8], numbers: [i16; 4]) {
    for (bytes, number) in element.as_chunks_mut::<2>().0.iter_mut().zip(numbers) {
        *bytes = number.to_le_bytes();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octahedra_become_unit_vectors() {
        for (point, expected) in [
            ([0i8, 0, 127, 5], [0i8, 0, 127, 5]),
            ([127, 0, 127, 0], [127, 0, 0, 0]),
            ([0, -127, 127, 0], [0, -127, 0, 0]),
            // Beyond the edge x + y = 1 lies the lower half.
            ([127, 127, 127, 9], [0, 0, -127, 9]),
            ([42, 42, 127, 0], [73, 73, 74, 0]),
        ] {
            let mut bytes = point.map(|x| x as u8);
            Filter::Octahedral.apply(&mut bytes, 4).unwrap();
            assert_eq!(bytes.map(|x| x as i8), expected);
        }
    }

    #[test]
    fn quaternions_get_their_largest_component_back() {
        let mut bytes = [0u8; 8];
        // Scale 32767 with the last component missing: the identity.
        store(&mut bytes, [0, 0, 0, 32767]);
        Filter::Quaternion.apply(&mut bytes, 8).unwrap();
        assert_eq!(shorts(&bytes), [0, 0, 0, 32767]);
        // The first component missing, the second at its most, 1/√2.
        store(&mut bytes, [32767, 0, 0, 32764]);
        Filter::Quaternion.apply(&mut bytes, 8).unwrap();
        assert_eq!(shorts(&bytes), [23170, 23170, 0, 0]);
    }

    #[test]
    fn exponents_scale_mantissas() {
        let mut bytes = [3, 0, 0, 0xff, 0xff, 0xff, 0xff, 2].to_vec();
        Filter::Exponential.apply(&mut bytes, 8).unwrap();
        let [a, b] = [&bytes[..4], &bytes[4..]].map(|b| f32::from_le_bytes(b.try_into().unwrap()));
        assert_eq!((a, b), (1.5, -4.0));
        assert!(Filter::Octahedral.apply(&mut bytes, 6).is_none());
    }
}
