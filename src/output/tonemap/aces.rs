//! ACES 1.0: reference and sRGB output rendering transform in Stephen Hill's fit (2016, published in Matt Pettineo's
//! BakingLab, `ACES.hlsl`). As in ACES itself, middle grey 0.18 shows as a tenth of white.

use super::transform;

/// Rec.709 to AP1 with D65 to D60 and the RRT's desaturation.
const TO_ACES: [[f32; 3]; 3] =
    [[0.597_19, 0.354_58, 0.048_23], [0.076_00, 0.908_34, 0.015_66], [0.028_40, 0.133_83, 0.837_77]];
/// The ODT's desaturation and the way back.
const FROM_ACES: [[f32; 3]; 3] =
    [[1.604_75, -0.531_08, -0.073_67], [-0.102_08, 1.108_13, -0.006_05], [-0.003_27, -0.072_76, 1.076_02]];

pub(super) fn apply(scene: [f32; 3]) -> [f32; 3] {
    transform(&FROM_ACES, transform(&TO_ACES, scene).map(curve))
}

fn curve(v: f32) -> f32 {
    (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081)
}
