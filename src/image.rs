//! A rendered film as files: EXR with its layers, PNG preview, numbers as JSON.

use std::{
    path::{Path, PathBuf},
    time::SystemTime,
};

use ajar_integrators::{Report, Settings, features::Features};
use ajar_output::{
    BlockVariances, CameraMatrices, Channel, Layer, Metadata, OutputError, Picture, Precision, ToneMap,
    write_atomically, write_exr, write_png,
};
use ajar_render::{
    film::{BLOCK_SIDES, Film},
    math::Rgb,
};
use ajar_scene::{Camera, Cause, Diagnostic};
use glam::DAffine3;
use serde::{Deserialize, Serialize};

use crate::{session::Status, shard::Shard};

/// An auxiliary layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Aov {
    /// Reflectance at the first surface.
    Albedo,
    /// Shading normal.
    Normal,
    /// Geometric normal.
    GeometricNormal,
    /// Depth along the optical axis.
    Depth,
    /// World position.
    Position,
    /// First texture coordinates.
    Uv,
    /// Material number.
    MaterialId,
    /// Number of the placed mesh.
    ObjectId,
    /// Estimated variance of the pixel's mean.
    Variance,
}

impl Aov {
    const ALL: [(&'static str, Self); 9] = [
        ("albedo", Self::Albedo),
        ("normal", Self::Normal),
        ("geometric_normal", Self::GeometricNormal),
        ("depth", Self::Depth),
        ("position", Self::Position),
        ("uv", Self::Uv),
        ("material_id", Self::MaterialId),
        ("object_id", Self::ObjectId),
        ("variance", Self::Variance),
    ];

    /// The layer of a name as users write it.
    ///
    /// # Errors
    /// Unknown names, with those that exist.
    pub fn parse(name: &str) -> Result<Self, Diagnostic> {
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, aov)| *aov).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|(name, _)| *name).collect();
            Diagnostic::error(format!("there is no AOV \"{name}\""))
                .because(Cause::Usage)
                .hint(format!("choose from: {}", known.join(", ")))
        })
    }
}

/// Where results go and in which form.
#[derive(Clone, Debug)]
pub struct Destination {
    /// The image.
    pub exr: PathBuf,
    /// The preview.
    pub png: PathBuf,
    /// Its form.
    pub form: Form,
}

impl Destination {
    /// Checks that no image takes the place of the other, or of a file that the scene was read from, and that they have
    /// folders to go to: who waited for an image must not lose it for a typing error.
    ///
    /// # Errors
    /// One does, of the cause [`Cause::Usage`], or has none, of the cause [`Cause::System`].
    pub fn check(&self, read: &[PathBuf]) -> Result<(), Diagnostic> {
        let taken = |what: &str, path: &Path| {
            let message = format!("the image would take the place of {what}");
            Err(Diagnostic::error(message).because(Cause::Usage).in_file(path))
        };
        if self.exr == self.png {
            return taken("its own preview", &self.exr);
        }
        for path in [&self.exr, &self.png] {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            if folder.is_some_and(|folder| !folder.is_dir()) {
                let error = Diagnostic::error("cannot write: there is no such folder").because(Cause::System);
                return Err(error.in_file(path).hint("make it first"));
            }
            // What is not there can take no place.
            let Ok(real) = path.canonicalize() else { continue };
            if read.iter().any(|file| file.canonicalize().is_ok_and(|file| file == real)) {
                return taken("a file of the scene", path);
            }
        }
        Ok(())
    }
}

/// What is written of a film.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Form {
    /// Tone map of the preview.
    pub tone_map: ToneMap,
    /// Exposure of the preview, stops.
    pub exposure: f64,
    /// Layers besides the beauty.
    pub aovs: Vec<Aov>,
    /// Full floats for colours.
    pub float: bool,
}

/// A finished render and what it came from.
pub struct Run<'a> {
    /// Camera and its place.
    pub camera: &'a (Camera, DAffine3),
    /// Full frame, pixels.
    pub size: [u32; 2],
    /// First hits of the pixels rendered.
    pub features: &'a [Features],
    /// Name of the integrator.
    pub integrator: &'a str,
    /// Its settings.
    pub settings: &'a Settings,
    /// The film.
    pub film: &'a Film,
    /// Which rounds it is of.
    pub shard: Shard,
    /// How far it is.
    pub status: &'a Status,
    /// Whether a stop rule ended the render.
    pub complete: bool,
    /// What the integrator tells.
    pub report: &'a Report,
    /// Hash of the scene.
    pub scene_hash: &'a str,
    /// What people should know of it.
    pub comment: Option<&'a str>,
}

/// Writes EXR and PNG; returns notes for the user.
///
/// # Errors
/// A file cannot be written, or pixels are not finite.
pub fn write(run: &Run<'_>, to: &Destination) -> Result<Vec<Diagnostic>, OutputError> {
    let (first_hits, form) = (run.features, &to.form);
    let beauty = beauty(run);
    let window = run.settings.window;
    let precision = if form.float { Precision::Float } else { Precision::Half };
    let mut layers = vec![layer(
        "",
        precision,
        "RGBA",
        |p, c| match c {
            3 => first_hits[p].alpha,
            _ => beauty[p * 3 + c],
        },
        window.pixels(),
    )];
    layers.extend(form.aovs.iter().map(|aov| aov_layer(*aov, run, first_hits, precision)));
    let picture = Picture {
        width: window.width(),
        height: window.height(),
        offset: (window.x0 as i32, window.y0 as i32),
        full_size: run.size.into(),
        layers,
        metadata: metadata(run),
    };
    let widened = write_exr(&to.exr, &picture)?;
    write_png(&to.png, &beauty, None, window.width(), window.height(), form.tone_map, form.exposure as f32)?;
    let mut notes: Vec<_> = widened
        .iter()
        .map(|w| {
            let layer = if w.layer.is_empty() { "the image" } else { &w.layer };
            Diagnostic::note(format!("{layer} has values up to {} and was written as full floats", w.peak))
        })
        .collect();
    let rejected = run.film.rejected();
    if rejected > 0 {
        notes
            .push(Diagnostic::warning(format!("{rejected} contributions were not finite and were left out")));
    }
    notes.extend(run.report.warnings.iter().map(|w| Diagnostic::warning(w.as_str())));
    if run.is_black() {
        let tried = run.report.number("samples_in_vain").filter(|tried| *tried > 0.0);
        let search =
            tried.map_or(String::new(), |tried| format!("; {tried} samples looked for some in vain"));
        notes.push(Diagnostic::warning(format!("the image is black: no light reaches the camera{search}")));
    }
    Ok(notes)
}

/// Interleaved RGB with the camera's exposure.
fn beauty(run: &Run<'_>) -> Vec<f32> {
    let exposure = run.exposure();
    (0..run.settings.window.pixels())
        .flat_map(|p| (run.film.mean(p) * exposure).as_vec3().to_array())
        .collect()
}

/// A layer whose channels are the letters of `names`.
fn layer(
    name: &str,
    precision: Precision,
    names: &str,
    value: impl Fn(usize, usize) -> f32,
    pixels: usize,
) -> Layer {
    let channels = names
        .chars()
        .enumerate()
        .map(|(c, name)| Channel { name: name.into(), samples: (0..pixels).map(|p| value(p, c)).collect() })
        .collect();
    Layer { name: name.into(), precision, channels }
}

fn ids(name: &str, value: impl Fn(&Features) -> u32, hits: &[Features]) -> Layer {
    // Ids are whole numbers in floats: readers scale unsigned integers when they convert them.
    let samples = hits.iter().map(|hit| value(hit) as f32).collect();
    let channels = vec![Channel { name: name.into(), samples }];
    Layer { name: String::new(), precision: Precision::Float, channels }
}

fn aov_layer(aov: Aov, run: &Run<'_>, hits: &[Features], color: Precision) -> Layer {
    let full = Precision::Float;
    let pixels = hits.len();
    match aov {
        Aov::Albedo => layer("albedo", color, "RGB", |p, c| hits[p].albedo[c], pixels),
        Aov::Normal => layer("N", color, "XYZ", |p, c| hits[p].normal[c], pixels),
        Aov::GeometricNormal => layer("Ng", color, "XYZ", |p, c| hits[p].geometric_normal[c], pixels),
        Aov::Depth => layer("", full, "Z", |p, _| hits[p].depth, pixels),
        Aov::Position => layer("P", full, "XYZ", |p, c| hits[p].position[c], pixels),
        Aov::Uv => layer("uv", full, "UV", |p, c| hits[p].uv[c], pixels),
        Aov::MaterialId => ids("materialId", |f| f.material, hits),
        Aov::ObjectId => ids("objectId", |f| f.object, hits),
        Aov::Variance => {
            let exposure = run.exposure();
            let variance = |p: usize| {
                let v = run.film.variance_of_mean(p) * exposure * exposure;
                // One round says nothing about its error; the file says it with the largest number.
                v.min(Rgb::splat(f32::MAX.into())).as_vec3()
            };
            layer("variance", full, "RGB", |p, c| variance(p)[c], pixels)
        }
    }
}

fn metadata(run: &Run<'_>) -> Metadata {
    let (status, [width, height]) = (run.status, run.size);
    Metadata {
        camera: Some(CameraMatrices::new(&run.camera.0, &run.camera.1, width, height)),
        captured: Some(SystemTime::now()),
        render_seconds: status.elapsed.as_secs_f64(),
        samples_per_pixel: status.samples.min(u32::MAX.into()) as u32,
        seed: run.settings.seed,
        rounds: status.rounds.min(u32::MAX.into()) as u32,
        integrator: run.integrator.into(),
        scene_hash: run.scene_hash.into(),
        mutations_per_sample: run.report.number("mutations_per_sample"),
        noise: status.noise.map(|n| n.typical),
        complete: run.complete,
        black: run.is_black(),
        shard: (!run.shard.is_whole()).then_some((run.shard.index, run.shard.count)),
        comment: run.comment.map(str::to_owned),
        block_variances: block_variances(run),
    }
}

impl Run<'_> {
    /// What the camera multiplies the film by.
    fn exposure(&self) -> f64 {
        self.camera.0.exposure.into()
    }

    /// Whether no light has reached the camera.
    fn is_black(&self) -> bool {
        (0..self.film.pixels()).all(|pixel| self.film.mean(pixel) == Rgb::ZERO)
    }

    /// Numbers about the render.
    pub fn stats(&self) -> serde_json::Value {
        let status = self.status;
        let details: serde_json::Map<_, _> =
            self.report.numbers.iter().map(|(name, value)| (name.clone(), (*value).into())).collect();
        serde_json::json!({
            "details": details,
            "integrator": self.integrator,
            "seed": self.settings.seed,
            "rounds": status.rounds,
            "samples_per_pixel": status.samples,
            "seconds": status.elapsed.as_secs_f64(),
            "noise": status.noise.map(|n| n.typical),
            "noise_worst_tile": status.noise.map(|n| n.worst_tile),
            "rejected_contributions": self.film.rejected(),
            "scene_hash": self.scene_hash,
            "complete": self.complete,
            "black": self.is_black(),
        })
    }
}

/// Errors of areas, for those who compare images; nothing where one round says nothing about its error.
fn block_variances(run: &Run<'_>) -> Vec<BlockVariances> {
    let exposure = run.exposure();
    let sides = BLOCK_SIDES.iter().map(|side| Some(*side as u32)).chain([None]);
    let level = |(level, side)| {
        let variances = run.film.block_variances(level)?;
        let stored = |v: Rgb| (v * exposure * exposure).min(Rgb::splat(f32::MAX.into())).as_vec3().to_array();
        Some(BlockVariances { side, values: variances.into_iter().flat_map(stored).collect() })
    };
    sides.enumerate().filter_map(level).collect()
}

/// Writes the numbers about a render as JSON.
///
/// # Errors
/// The file cannot be written.
pub fn write_stats(run: &Run<'_>, path: &Path) -> Result<(), OutputError> {
    let text = run.stats().to_string();
    write_atomically(path, |file| file.write_all(text.as_bytes()))
}
