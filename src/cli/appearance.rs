//! In which form images are written; the same for all commands that render.

use ajar_output::ToneMap;
use ajar_scene::{Diagnostic, OutputSettings};

use super::{arguments::parse_number, job::wrong};
use crate::{
    image::{Aov, Form},
    watch::Said,
};

#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct Appearance {
    /// Layers to add, with commas between: albedo, normal, geometric_normal, depth, position, uv, material_id, object_id,
    /// variance
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    aov: Option<Vec<String>>,
    /// Tone map of the PNG: agx, aces, neutral or srgb
    #[arg(long, value_name = "NAME")]
    tone_map: Option<String>,
    /// Exposure of the PNG in stops
    #[arg(long, value_name = "EV", value_parser = parse_number, allow_negative_numbers = true)]
    exposure: Option<f64>,
    /// Write colours as 32-bit floats instead of halves
    #[arg(long)]
    float: bool,
}

impl Appearance {
    /// Adds what is said about the look of images.
    pub fn say(&self, said: &mut Said) {
        if let Some(names) = &self.aov {
            said.say("output", "aov", names.clone());
        }
        if let Some(name) = &self.tone_map {
            said.say("output", "tone_map", name.as_str());
        }
        if let Some(stops) = self.exposure {
            said.say("output", "exposure", stops);
        }
        if self.float {
            said.say("output", "float", true);
        }
    }

    /// The form of what a file's settings say something about.
    ///
    /// # Errors
    /// A name that nothing has; of the cause `Usage`.
    pub fn form(&self, output: &OutputSettings) -> Result<Form, Diagnostic> {
        let tone_map = self.tone_map.as_deref().or(output.tone_map.as_deref()).unwrap_or("agx");
        let names = self.aov.clone().or_else(|| output.aov.clone()).unwrap_or_default();
        Ok(Form {
            tone_map: tone_map
                .parse::<ToneMap>()
                .map_err(|e| of_file(&self.tone_map, "tone_map", wrong(e.to_string())))?,
            exposure: self.exposure.or(output.exposure).unwrap_or(0.0),
            aovs: names
                .iter()
                .map(|name| Aov::parse(name).map_err(|d| of_file(&self.aov, "aov", d)))
                .collect::<Result<_, _>>()?,
            float: self.float || output.float.unwrap_or(false),
        })
    }
}

/// A complaint about a value that is `given` on the command line, or is that of the file under this key of `[output]`.
fn of_file<T>(given: &Option<T>, key: &str, complaint: Diagnostic) -> Diagnostic {
    if given.is_some() { complaint } else { complaint.element(format!("output.{key}")) }
}
