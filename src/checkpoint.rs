//! A render so far as a file: to go on with it, or to put it together with the parts that other machines made.
//!
//! Rounds are pure functions of world, settings and round number, so the sum of the finished ones and their number are
//! all the state there is (mlt.md §6 of the design). What the image needs besides goes along: an image can be made of
//! parts where the scene is not at hand.

use std::{collections::BTreeMap, path::Path};

use ajar_integrators::{
    Metropolis, Settings, Window,
    features::Features,
    mlt::{choice::Choice, lens_subpaths::Spread},
};
use ajar_output::{Checkpoint, OutputError, read_checkpoint, write_checkpoint};
use ajar_render::film::Film;
use ajar_scene::{Camera, Cause, Diagnostic};
use glam::{DAffine3, Vec2, Vec3};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{
    image::{Form, Run},
    shard::Shard,
};

/// Everything that decides what a round deposits: only rounds of equal subjects add up to an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Subject {
    /// Program and version: another one may draw other numbers.
    pub program: String,
    /// Content hash of the scene.
    pub scene: String,
    /// The camera.
    pub camera: Camera,
    /// Its place.
    pub camera_place: DAffine3,
    /// Full frame, pixels.
    pub size: [u32; 2],
    /// The pixels rendered: left, right, top, bottom, the second bounds excluded.
    pub pixel_bounds: [u32; 4],
    /// Name of the integrator.
    pub integrator: String,
    /// Seed of all randomness.
    pub seed: u64,
    /// Edges of the longest path.
    pub max_depth: usize,
    /// Eye samples a pixel in one round.
    pub samples_per_round: u32,
    /// Weights of mutations that replace the usual ones.
    pub mutations: BTreeMap<String, f64>,
    /// How the choice between mutations is weighed.
    pub mutation_choice: String,
    /// Steps of a chain.
    pub chain_length: u32,
    /// How lens subpaths spread.
    pub lens_subpaths: String,
}

/// The one of `all` with that name; the default for a name of another version, which does not fit anyway.
fn named<T: Copy + Default>(all: &[T], name: fn(T) -> &'static str, wanted: &str) -> T {
    all.iter().copied().find(|one| name(*one) == wanted).unwrap_or_default()
}

impl Subject {
    /// The pictures of `camera` by `integrator`.
    pub fn new(
        scene_hash: &str,
        camera: &(Camera, DAffine3),
        size: [u32; 2],
        integrator: &str,
        settings: &Settings,
    ) -> Self {
        // A new setting changes what rounds deposit: this pattern asks to put it here.
        let Settings { seed, max_depth, samples_per_round, window, metropolis } = settings.clone();
        let Metropolis { weights, choice, chain_length, lens_subpaths } = metropolis;
        let Window { x0, y0, x1, y1 } = window;
        Self {
            program: concat!("ajar ", env!("CARGO_PKG_VERSION")).into(),
            scene: scene_hash.into(),
            camera: camera.0.clone(),
            camera_place: camera.1,
            size,
            pixel_bounds: [x0, x1, y0, y1],
            integrator: integrator.into(),
            seed,
            max_depth,
            samples_per_round,
            mutations: weights,
            mutation_choice: choice.name().into(),
            chain_length,
            lens_subpaths: lens_subpaths.name().into(),
        }
    }

    /// The settings in the form that integrators read.
    pub fn settings(&self) -> Settings {
        let [x0, x1, y0, y1] = self.pixel_bounds;
        let window = Window { x0, y0, x1, y1 };
        let Self { seed, max_depth, samples_per_round, .. } = *self;
        let metropolis = Metropolis {
            weights: self.mutations.clone(),
            choice: named(&Choice::ALL, Choice::name, &self.mutation_choice),
            chain_length: self.chain_length,
            lens_subpaths: named(&Spread::ALL, Spread::name, &self.lens_subpaths),
        };
        Settings { seed, max_depth, samples_per_round, window, metropolis }
    }

    /// What is not as in `wanted`, an error each about the file `this`. The scene is the file's fault,
    /// all else the user's.
    pub fn differences(&self, wanted: &Self, this: &Path) -> Vec<Diagnostic> {
        let fields = |subject: &Self| match serde_json::to_value(subject) {
            Ok(Value::Object(fields)) => fields,
            _ => serde_json::Map::new(),
        };
        let is_short = |value: &Value| !value.is_object() && value.as_array().is_none_or(|a| a.len() <= 4);
        let wanted = fields(wanted);
        let differ = fields(self).into_iter().filter(|(key, value)| wanted.get(key) != Some(value));
        let error = |(key, value): (String, Value)| {
            let cause = if key == "scene" { Cause::Asset } else { Cause::Usage };
            let name = key.replace('_', " ");
            let message = match wanted.get(&key).filter(|_| is_short(&value)) {
                Some(other) => format!("rendered with {name} {value}, not {other}"),
                None => format!("rendered with another {name}"),
            };
            Diagnostic::error(message).because(cause).in_file(this)
        };
        differ.map(error).collect()
    }

    /// Whether a film of `pixels` pixels can be of it; files may say anything.
    fn is_possible(&self, pixels: usize) -> bool {
        let ([x0, x1, y0, y1], [width, height]) = (self.pixel_bounds, self.size);
        let fits = x0 < x1 && x1 <= width && y0 < y1 && y1 <= height && width.max(height) <= 65535;
        fits && self.samples_per_round > 0 && self.settings().window.pixels() == pixels
    }
}

/// The text of a checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Header {
    subject: Subject,
    shard: [u32; 2],
    complete: bool,
    seconds: f64,
    mutations_per_sample: Option<f64>,
    form: Form,
}

/// A render so far, as it was saved.
#[derive(Clone, Debug)]
pub struct Saved {
    /// What it is of.
    pub subject: Subject,
    /// Which rounds.
    pub shard: Shard,
    /// Whether a stop rule ended it.
    pub complete: bool,
    /// Time spent, all runs together.
    pub seconds: f64,
    /// Mutations for each sample, where chains work beside samples.
    pub mutations_per_sample: Option<f64>,
    /// How its image is written.
    pub form: Form,
    /// The sum of the rounds.
    pub film: Film,
    /// First hits of its pixels.
    pub features: Vec<Features>,
}

/// Saves `run`, whose image is written in `form`.
///
/// # Errors
/// The file cannot be written.
pub fn save(path: &Path, run: &Run<'_>, form: &Form) -> Result<(), OutputError> {
    let header = Header {
        subject: Subject::new(run.scene_hash, run.camera, run.size, run.integrator, run.settings),
        shard: [run.shard.index, run.shard.count],
        complete: run.complete,
        seconds: run.status.elapsed.as_secs_f64(),
        mutations_per_sample: run.report.number("mutations_per_sample"),
        form: form.clone(),
    };
    let text = serde_json::to_string(&header).map_err(|error| OutputError::Encode(error.to_string()))?;
    let floats: Vec<f32> = run.features.iter().flat_map(numbers).collect();
    write_checkpoint(path, &text, run.film, &floats)
}

/// Opens what [`save`] wrote.
///
/// # Errors
/// The file cannot be read, is none, or is damaged.
pub fn open(path: &Path) -> Result<Saved, Diagnostic> {
    let checkpoint = read_checkpoint(path).map_err(|e| Diagnostic::error(e.to_string()).in_file(path))?;
    understand(checkpoint)
        .ok_or_else(|| Diagnostic::error("the checkpoint says what cannot be").in_file(path))
}

fn understand(Checkpoint { text, film, floats }: Checkpoint) -> Option<Saved> {
    let Header { subject, shard: [index, count], complete, seconds, mutations_per_sample, form } =
        serde_json::from_str(&text).ok()?;
    let (chunks, rest) = floats.as_chunks();
    let features: Vec<_> = chunks.iter().map(from_numbers).collect();
    let possible = subject.is_possible(film.pixels())
        && film.state()?.width == subject.settings().window.width()
        && index < count
        && features.len() == film.pixels()
        && rest.is_empty()
        && (0.0..1e15).contains(&seconds);
    possible.then_some(Saved {
        subject,
        shard: Shard { index, count },
        complete,
        seconds,
        mutations_per_sample,
        form,
        film,
        features,
    })
}

/// How many numbers the features of a pixel are.
const NUMBERS: usize = 18;

fn numbers(features: &Features) -> [f32; NUMBERS] {
    let Features { albedo, normal, geometric_normal, alpha, depth, position, uv, material, object } =
        *features;
    // Ids go through unchanged, whatever float their bits are.
    let ids = [f32::from_bits(material), f32::from_bits(object)];
    let ([a, b, c], [d, e, f], [g, h, i]) =
        (albedo.to_array(), normal.to_array(), geometric_normal.to_array());
    let [x, y, z] = position.to_array();
    [a, b, c, d, e, f, g, h, i, alpha, depth, x, y, z, uv.x, uv.y, ids[0], ids[1]]
}

fn from_numbers(numbers: &[f32; NUMBERS]) -> Features {
    let [a, b, c, d, e, f, g, h, i, alpha, depth, x, y, z, u, v, material, object] = *numbers;
    Features {
        albedo: Vec3::new(a, b, c),
        normal: Vec3::new(d, e, f),
        geometric_normal: Vec3::new(g, h, i),
        alpha,
        depth,
        position: Vec3::new(x, y, z),
        uv: Vec2::new(u, v),
        material: material.to_bits(),
        object: object.to_bits(),
    }
}
