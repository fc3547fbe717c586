//! Khronos PBR Neutral Tone Mapper, "PBR Neutral Specification" (KhronosGroup/ToneMapping, 2024); its symbols in
//! comments.

/// Reflectance at normal incidence of common dielectrics, which is taken off so that base colours return. F90
const REFLECTANCE: f32 = 0.04;
/// Where highlights start to be compressed. Ks
const COMPRESSION_START: f32 = 0.8 - REFLECTANCE;
/// How fast compressed highlights lose their colour. Kd
const DESATURATION: f32 = 0.15;

pub(super) fn apply(scene: [f32; 3]) -> [f32; 3] {
    let least = scene.into_iter().fold(f32::INFINITY, f32::min);
    let offset =
        if least <= 2.0 * REFLECTANCE { least - least * least / (4.0 * REFLECTANCE) } else { REFLECTANCE };
    let base = scene.map(|value| value - offset);
    let peak = base.into_iter().fold(0.0, f32::max); // p
    if peak <= COMPRESSION_START {
        return base;
    }
    let room = 1.0 - COMPRESSION_START;
    let shown_peak = 1.0 - room * room / (peak + room - COMPRESSION_START); // p_n
    let colour = 1.0 / (DESATURATION * (peak - shown_peak) + 1.0); // g
    base.map(|value| value * shown_peak / peak * colour + shown_peak * (1.0 - colour))
}
