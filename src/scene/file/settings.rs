//! `[render]` and `[output]`.

use std::{
    ops::Bound,
    path::{Component, PathBuf},
};

use toml::de::DeValue;

use super::{
    keys::Keys,
    report::Complaint,
    source::Source,
    value::{ANY, flag, number, numbers, quantity, text, texts, whole},
};
use crate::{OutputSettings, RenderSettings, parse_duration, parse_percent};

/// Largest width or height of an image.
const MAX_SIZE: i64 = 65_535;

/// Reads `[render]`.
pub(super) fn render(mut keys: Keys<'_>) -> RenderSettings {
    let settings = RenderSettings {
        integrator: keys.optional("integrator", text),
        camera: keys.optional("camera", text),
        size: keys.optional("size", size),
        spp: keys.optional("spp", whole(1..=i64::from(u32::MAX))).map(|spp| spp as u32),
        rounds: keys.optional("rounds", whole(1..)).map(|rounds| rounds as u64),
        time: keys.optional("time", quantity(parse_duration)),
        noise: keys.optional("noise", quantity(parse_percent)),
        seed: keys.optional("seed", whole(0..)).map(|seed| seed as u64),
        max_depth: keys.optional("max_depth", whole(1..=i64::from(u32::MAX))).map(|depth| depth as u32),
        crop: keys.optional("crop", crop),
        mutations: keys.table("mutations").map(|keys| keys.numbers_by_name(0.0..)).unwrap_or_default(),
        mutation_choice: keys.optional("mutation_choice", text),
        chain_length: keys.optional("chain_length", whole(1..=i64::from(u32::MAX))).map(|steps| steps as u32),
        lens_subpaths: keys.optional("lens_subpaths", text),
    };
    if settings.noise == Some(0.0) {
        keys.complain("noise", Complaint::new("must be greater than 0, is 0"));
    }
    if settings.time.is_some_and(|time| time.is_zero()) {
        keys.complain("time", Complaint::new("must be greater than 0, is 0"));
    }
    keys.finish();
    settings
}

/// Reads `[output]`.
pub(super) fn output(mut keys: Keys<'_>) -> OutputSettings {
    let settings = OutputSettings {
        path: keys.optional_of("path", file_to_write("exr")),
        png: keys.optional_of("png", file_to_write("png")),
        tone_map: keys.optional("tone_map", text),
        exposure: keys.optional("exposure", number(ANY)),
        aov: keys.optional("aov", texts),
        float: keys.optional("float", flag),
    };
    keys.finish();
    settings
}

/// The name of a file that will be written. A scene that came from somebody else must not write anywhere else than in the
/// current folder, where it is rendered; the command line may.
fn file_to_write(ending: &str) -> impl Fn(&DeValue<'_>, &Source<'_>) -> Result<PathBuf, Complaint> + '_ {
    move |value, source| {
        let path = PathBuf::from(text(value)?);
        if !path.extension().is_some_and(|it| it.eq_ignore_ascii_case(ending)) {
            return Err(Complaint::new(format!("must end with .{ending}")));
        }
        let is_inside =
            path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if is_inside || source.is_command_line() {
            return Ok(path);
        }
        let complaint = Complaint::new("must lie in the current folder");
        Err(complaint.hint(Some("name other folders on the command line, by -o".into())))
    }
}

fn size(value: &DeValue<'_>) -> Result<[u32; 2], Complaint> {
    let sides = numbers::<2>((Bound::Included(1.0), Bound::Included(MAX_SIZE as f64)))(value)?;
    if sides.iter().all(|side| side.fract() == 0.0) {
        Ok(sides.map(|side| side as u32))
    } else {
        Err(Complaint::new("must be whole numbers of pixels"))
    }
}

fn crop(value: &DeValue<'_>) -> Result<[f64; 4], Complaint> {
    let crop @ [left, right, top, bottom] = numbers::<4>(0.0..=1.0)(value)?;
    if left < right && top < bottom {
        Ok(crop)
    } else {
        Err(Complaint::new("must be left < right and top < bottom, in the order [left, right, top, bottom]"))
    }
}
