//! The sRGB transfer function (IEC 61966-2-1).

/// From encoded to linear, clamped to [0, 1].
pub(crate) fn linear(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
