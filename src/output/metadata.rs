//! What an EXR says about its origin, and how that becomes attributes.
//!
//! Names and types: OpenEXR "Standard Attributes" for `worldToCamera`, `worldToNDC`, `chromaticities`, `capDate`,
//! `utcOffset`, `software`; `renderTimeSeconds` and `samplesPerPixel` as pbrt writes them; `renderTime` as Blender does;
//! `colorInteropID` from the ASWF Color Interop Forum's texture identifiers. The rest is Ajar's and says so: `ajar:…`.
//!
//! `capDate`, `renderTime` and `renderTimeSeconds` differ from run to run; whoever compares files compares pixels.

use std::time::{Duration, SystemTime};

use exr::{
    math::Vec2,
    meta::{
        attribute::{AttributeValue, Chromaticities, Text},
        header::{ImageAttributes, LayerAttributes},
    },
};

use crate::{BlockVariances, CameraMatrices};

const SOFTWARE: &str = concat!("ajar ", env!("CARGO_PKG_VERSION"));

/// Where a picture comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// Where the camera stood.
    pub camera: Option<CameraMatrices>,
    /// When the image was finished; stored in UTC.
    pub captured: Option<SystemTime>,
    /// Wall-clock seconds spent rendering, all runs of a resumed render together.
    pub render_seconds: f64,
    /// Mean number of samples (mutations, for MLT) a pixel.
    pub samples_per_pixel: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Rounds that the image is the mean of.
    pub rounds: u32,
    /// Name of the integrator.
    pub integrator: String,
    /// Hash of the scene that was rendered.
    pub scene_hash: String,
    /// Mutations for each sample, where chains work beside samples.
    pub mutations_per_sample: Option<f64>,
    /// Estimated relative error, if it could be estimated.
    pub noise: Option<f64>,
    /// Whether the stop rule was reached; `false` for snapshots and interrupted renders.
    pub complete: bool,
    /// Whether no light reached the camera; written only then.
    pub black: bool,
    /// Which part of how many a shard holds, as given to `--shard i/n`.
    pub shard: Option<(u32, u32)>,
    /// What people should know of it.
    pub comment: Option<String>,
    /// Errors of areas, of every side that is kept.
    pub block_variances: Vec<BlockVariances>,
}

impl Metadata {
    pub(crate) fn layer_attributes(&self) -> LayerAttributes {
        let mut attributes = LayerAttributes {
            software_name: Some(text(SOFTWARE)),
            capture_date: self.captured.map(|time| text(&exr_date(time))),
            comments: self.comment.as_deref().map(text),
            utc_offset: self.captured.map(|_| 0.0),
            world_to_camera: self.camera.map(|camera| flat(camera.world_to_camera)),
            world_to_normalized_device: self.camera.map(|camera| flat(camera.world_to_ndc)),
            ..LayerAttributes::default()
        };
        attributes.other.extend(self.custom().into_iter().map(|(name, value)| (text(name), value)));
        attributes.other.extend(self.block_variances.iter().map(BlockVariances::attribute));
        attributes
    }

    fn custom(&self) -> Vec<(&'static str, AttributeValue)> {
        use AttributeValue::{F32, I32, Text};
        let integer = |value: u32| I32(value.try_into().unwrap_or(i32::MAX));
        let mut custom = vec![
            ("renderTime", Text(text(&clock(self.render_seconds)))),
            ("renderTimeSeconds", F32(self.render_seconds as f32)),
            ("samplesPerPixel", integer(self.samples_per_pixel)),
            ("colorInteropID", Text(text("lin_rec709_scene"))),
            // A text: the format's integers have 32 bits.
            ("ajar:seed", Text(text(&self.seed.to_string()))),
            ("ajar:rounds", integer(self.rounds)),
            ("ajar:integrator", Text(text(&self.integrator))),
            ("ajar:sceneHash", Text(text(&self.scene_hash))),
            ("ajar:complete", I32(self.complete.into())),
        ];
        custom.extend(self.black.then_some(("ajar:black", I32(1))));
        custom.extend(self.mutations_per_sample.map(|n| ("ajar:mutationsPerSample", F32(n as f32))));
        custom.extend(self.noise.map(|noise| ("ajar:noise", F32(noise as f32))));
        custom.extend(self.shard.map(|(i, n)| ("ajar:shard", Text(text(&format!("{i}/{n}"))))));
        custom
    }
}

/// Rec.709 primaries and the D65 white point, ITU-R BT.709-6.
pub(crate) fn declare_rec709(attributes: &mut ImageAttributes) {
    attributes.chromaticities = Some(Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    });
}

/// EXR texts are bytes; readers take them for UTF-8.
pub(crate) fn text(value: &str) -> Text {
    Text::from_slice_unchecked(value.as_bytes())
}

fn flat(rows: [[f32; 4]; 4]) -> [f32; 16] {
    std::array::from_fn(|i| rows[i / 4][i % 4])
}

/// `hh:mm:ss.cc`.
fn clock(seconds: f64) -> String {
    let whole = Duration::try_from_secs_f64(seconds).unwrap_or_default();
    let (seconds, cents) = (whole.as_secs(), whole.subsec_millis() / 10);
    format!("{:02}:{:02}:{:02}.{cents:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// `YYYY:MM:DD hh:mm:ss` in UTC. Days to calendar: Howard Hinnant, "chrono-compatible low-level date algorithms".
fn exr_date(time: SystemTime) -> String {
    let seconds = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_secs();
    // Days since 1 March of the year 0, so that leap days come last.
    let days = seconds / 86_400 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{year:04}:{month:02}:{day:02} {hour:02}:{minute:02}:{second:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_match_the_calendar() {
        // `date -u -d @SECONDS '+%Y:%m:%d %H:%M:%S'`
        for (seconds, date) in [
            (0, "1970:01:01 00:00:00"),
            (951_782_399, "2000:02:28 23:59:59"),
            (951_782_400, "2000:02:29 00:00:00"),
            (1_709_251_199, "2024:02:29 23:59:59"),
            (1_709_251_200, "2024:03:01 00:00:00"),
            (4_107_542_400, "2100:03:01 00:00:00"),
        ] {
            assert_eq!(exr_date(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)), date);
        }
    }

    #[test]
    fn render_time_is_a_clock() {
        assert_eq!(clock(3_725.678), "01:02:05.67");
        assert_eq!(clock(f64::NAN), "00:00:00.00");
    }
}
