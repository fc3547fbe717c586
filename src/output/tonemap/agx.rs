//! AgX, the base look: Troy Sobotka, "AgX" (github.com/sobotka/AgX). Matrices for Rec.709 as in Benjamin Wrensch,
//! "Minimal AgX Implementation" (iolite-engine.com, 2023). Its polynomial stands for the look-up table of the original,
//! which came from Jed Smith's sigmoid with slope 2, powers 3 and 3.25; here the sigmoid itself is evaluated.

use super::transform;

/// Moves the primaries inwards, so that pure colours have somewhere to fade to.
const INSET: [[f32; 3]; 3] = [
    [0.842_479_06, 0.078_433_6, 0.079_223_745],
    [0.042_328_242, 0.878_468_6, 0.079_166_13],
    [0.042_375_655, 0.078_433_6, 0.879_143],
];
/// The inverse of [`INSET`].
const OUTSET: [[f32; 3]; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];
/// 0.18 · 2^−10 and 0.18 · 2^6.5, in stops.
const DARKEST: f32 = -12.473_93;
const BRIGHTEST: f32 = 4.026_069;
/// Middle grey lies 10 of 16.5 stops up and becomes half of the code range.
const PIVOT: [f32; 2] = [10.0 / 16.5, 0.5];
const SLOPE: f32 = 2.0;
const TOE_POWER: f32 = 3.0;
const SHOULDER_POWER: f32 = 3.25;

pub(super) fn apply(scene: [f32; 3]) -> [f32; 3] {
    let logarithmic = transform(&INSET, scene)
        .map(|value| ((value.log2() - DARKEST) / (BRIGHTEST - DARKEST)).clamp(0.0, 1.0));
    // The codes are meant for a display with a power of 2.2.
    transform(&OUTSET, logarithmic.map(sigmoid)).map(|code| code.max(0.0).powf(2.2))
}

/// Two power hyperbolas that meet at the pivot; 0 → 0, 1 → 1.
pub(super) fn sigmoid(x: f32) -> f32 {
    let [x_pivot, y_pivot] = PIVOT;
    if x < x_pivot {
        let scale = -limb_scale(x_pivot, y_pivot, TOE_POWER);
        scale * hyperbola(SLOPE * (x - x_pivot) / scale, TOE_POWER) + y_pivot
    } else {
        let scale = limb_scale(1.0 - x_pivot, 1.0 - y_pivot, SHOULDER_POWER);
        scale * hyperbola(SLOPE * (x - x_pivot) / scale, SHOULDER_POWER) + y_pivot
    }
}

fn hyperbola(x: f32, power: f32) -> f32 {
    x / (1.0 + x.powf(power)).powf(1.0 / power)
}

/// The height at which a limb `width` wide must level off to end at `height`.
fn limb_scale(width: f32, height: f32, power: f32) -> f32 {
    let run = (SLOPE * width).powf(-power);
    let rise = (SLOPE * width / height).powf(power) - 1.0;
    (run * rise).powf(-1.0 / power)
}
