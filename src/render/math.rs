//! Small geometry: colours, frames, polar angles.

use glam::DVec3;

/// Linear Rec.709 radiance, throughput or reflectance.
pub type Rgb = DVec3;

/// A right-handed orthonormal basis.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// X axis.
    pub x: DVec3,
    /// Y axis.
    pub y: DVec3,
    /// Z axis, the normal.
    pub z: DVec3,
}

impl Frame {
    /// Some basis around the unit vector `z` (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
    #[inline]
    pub fn from_z(z: DVec3) -> Self {
        let sign = 1f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: DVec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// The basis around the unit vector `z` whose X is closest to `x`; any if `x` is parallel to `z`.
    pub fn from_zx(z: DVec3, x: DVec3) -> Self {
        let tangent = x - z * z.dot(x);
        let length = tangent.length();
        if length <= 1e-9 * x.length() || length.is_nan() {
            return Self::from_z(z);
        }
        let x = tangent / length;
        Self { x, y: z.cross(x), z }
    }

    /// World to local.
    #[inline]
    pub fn to_local(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.dot(self.x), w.dot(self.y), w.dot(self.z))
    }

    /// Local to world.
    #[inline]
    pub fn to_world(&self, w: DVec3) -> DVec3 {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}

/// The scalar that Metropolis light transport and Russian roulette see: the mean of the channels, which keeps
/// `f_c / f*` at most 3.
pub fn scalar(c: Rgb) -> f64 {
    (c.x + c.y + c.z) / 3.0
}

/// Whether all channels are zero.
pub fn is_black(c: Rgb) -> bool {
    c == DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for z in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(1.0, -2.0, -0.3).normalize()] {
            for frame in
                [Frame::from_z(z), Frame::from_zx(z, DVec3::new(0.3, 0.2, 0.9)), Frame::from_zx(z, z)]
            {
                assert!((frame.x.cross(frame.y) - frame.z).length() < 1e-14);
                assert!((frame.x.length() - 1.0).abs() < 1e-14);
                let w = DVec3::new(0.2, -0.5, 0.7);
                assert!((frame.to_world(frame.to_local(w)) - w).length() < 1e-14);
            }
        }
    }
}
