use super::*;

const ALL: [ToneMap; 4] = [ToneMap::Agx, ToneMap::Aces, ToneMap::Neutral, ToneMap::Srgb];

fn close(a: f32, b: f32, tolerance: f32) {
    assert!((a - b).abs() <= tolerance, "{a} is not {b} ± {tolerance}");
}

fn gray(map: ToneMap, value: f32) -> f32 {
    map.apply([value; 3])[1]
}

/// Angle around the grey axis, degrees.
fn hue([r, g, b]: [f32; 3]) -> f32 {
    (3.0_f32.sqrt() * (g - b)).atan2(2.0 * r - g - b).to_degrees()
}

fn saturation(rgb: [f32; 3]) -> f32 {
    let (low, high) = (rgb.into_iter().fold(f32::MAX, f32::min), rgb.into_iter().fold(0.0, f32::max));
    (high - low) / high
}

#[test]
fn names_round_trip() {
    for map in ALL {
        assert_eq!(map.to_string().parse(), Ok(map));
    }
    assert_eq!("AGX".parse::<ToneMap>(), Err(UnknownToneMap("AGX".into())));
}

#[test]
fn black_is_black_and_brightest_is_white() {
    for map in ALL {
        assert!(map.apply([0.0; 3]).iter().all(|&value| value < 1e-6), "{map}: {:?}", map.apply([0.0; 3]));
        let white = map.apply([f32::MAX; 3]);
        assert!(white.iter().all(|&value| value > 0.995), "{map}: {white:?}");
    }
}

#[test]
fn grays_stay_gray_and_rise() {
    for map in ALL {
        let mut before = 0.0;
        for step in -48..=40 {
            let shown = map.apply([0.18 * (step as f32 / 4.0).exp2(); 3]);
            // A code is 3e-4 wide at its narrowest.
            assert!(shown[1] >= before - 1e-6, "{map} falls at step {step}");
            close(shown[0], shown[1], 2e-3);
            close(shown[2], shown[1], 2e-3);
            before = shown[1];
        }
    }
}

#[test]
fn nothing_leaves_the_display() {
    for map in ALL {
        for rgb in [[-1.0, 2.0, 0.5], [1e30, 0.0, 0.0], [f32::INFINITY, 0.0, 1.0], [0.0, 0.0, 1e-30]] {
            let shown = map.apply(rgb);
            assert!(
                shown.iter().all(|value| (0.0..=1.0).contains(value)),
                "{map} shows {rgb:?} as {shown:?}"
            );
        }
    }
}

/// Where the curves put middle grey: AgX at half of the codes of a 2.2 display, ACES at a tenth of white (4.8 of 48 nits,
/// SMPTE ST 2065), Neutral at 0.18 − F90.
#[test]
fn middle_gray_lies_where_published() {
    close(gray(ToneMap::Agx, 0.18).powf(1.0 / 2.2), 0.5, 1e-3);
    close(gray(ToneMap::Aces, 0.18), 0.1, 0.01);
    close(gray(ToneMap::Neutral, 0.18), 0.14, 1e-6);
    close(gray(ToneMap::Srgb, 0.18), 0.18, 0.0);
}

/// The polynomial of Wrensch's post, an independent fit to the look-up table of the original.
#[test]
fn agx_sigmoid_agrees_with_wrenschs_polynomial() {
    for step in 0..=1000 {
        let x = f64::from(step) / 1000.0;
        let polynomial = 15.5 * x.powi(6) - 40.14 * x.powi(5) + 31.96 * x.powi(4) - 6.868 * x.powi(3)
            + 0.4298 * x.powi(2)
            + 0.1191 * x
            - 0.002_32;
        close(agx::sigmoid(x as f32), polynomial as f32, 0.006);
    }
    close(agx::sigmoid(0.0), 0.0, 1e-6);
    close(agx::sigmoid(1.0), 1.0, 1e-6);
}

#[test]
fn neutral_takes_off_the_reflectance_only() {
    for rgb in [[0.08, 0.3, 0.8], [0.8, 0.1, 0.1], [0.5, 0.5, 0.08]] {
        for (shown, given) in ToneMap::Neutral.apply(rgb).into_iter().zip(rgb) {
            close(shown, given - 0.04, 1e-6);
        }
    }
}

/// By hand from the formulas: x = 0.02 gives f = 0.0175, p = 1.9825, p_n = 1 − 0.0576 / 1.4625, g = 1 / (0.15 (p − p_n) + 1).
#[test]
fn neutral_compresses_as_specified() {
    let shown = ToneMap::Neutral.apply([2.0, 0.5, 0.02]);
    for (value, expected) in shown.into_iter().zip([0.960_615, 0.330_396, 0.128_726]) {
        close(value, expected, 2e-6);
    }
}

/// Bright saturated light fades towards white; with Neutral, which promises it, its hue stays. A plain clip turns it.
#[test]
fn bright_colours_fade_to_white() {
    let orange = [1.0, 0.35, 0.05];
    for map in [ToneMap::Agx, ToneMap::Neutral] {
        let shown = |gain: f32| map.apply(orange.map(|value| value * gain));
        assert!(saturation(shown(16.0)) < 0.9 * saturation(shown(1.0)), "{map}");
        assert!(saturation(shown(256.0)) < 0.35, "{map} {:?}", shown(256.0));
    }
    for gain in [1.0, 4.0, 16.0, 64.0] {
        let light = orange.map(|value| value * gain);
        close(hue(ToneMap::Neutral.apply(light)), hue(orange), 3.0);
    }
    let clipped = hue(ToneMap::Srgb.apply(orange.map(|value| value * 16.0)));
    assert!((clipped - hue(orange)).abs() > 25.0, "the check sees hue shifts: {clipped}");
}

/// IEC 61966-2-1: published code values of an 18 % grey, of half light, and of the end of the linear part.
#[test]
fn srgb_codes_are_the_standards() {
    close(srgb_encode(0.18) * 255.0, 117.6, 0.1);
    close(srgb_encode(0.5) * 255.0, 187.5, 0.1);
    close(srgb_encode(0.003_130_8), 0.040_45, 1e-5);
    close(srgb_encode(1.0), 1.0, 1e-6);
}
