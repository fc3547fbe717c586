//! How to render and what to write, as far as a scene file says it; `None` means that it says nothing, so that the
//! command line can overrule and defaults apply last.

use std::{collections::BTreeMap, path::PathBuf, time::Duration};

use serde::{Deserialize, Serialize};

/// The table `[render]`. Names of integrators are not checked here: their list lives with the integrators.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RenderSettings {
    /// Name of the integrator. Default `ajar`.
    pub integrator: Option<String>,
    /// Name of the camera. Default: the first camera of the scene.
    pub camera: Option<String>,
    /// Width and height in pixels, 1 to 65535. Default 1280 × 720.
    pub size: Option<[u32; 2]>,
    /// Stop after this many samples a pixel on average, at least 1. Default 64 if there is no other stop rule.
    pub spp: Option<u32>,
    /// Stop after this many rounds, at least 1. Default: no limit.
    pub rounds: Option<u64>,
    /// Stop after this much time on the clock. Default: no limit.
    pub time: Option<Duration>,
    /// Stop when the estimated relative error of the image falls to this fraction, in (0, 1]. Default: no limit.
    pub noise: Option<f64>,
    /// Key of all random numbers. Default 0.
    pub seed: Option<u64>,
    /// Edges of the longest path, at least 1. Default 16.
    pub max_depth: Option<u32>,
    /// The part of the image to render: left, right, top, bottom as fractions of the size. Default all, `[0, 1, 0, 1]`.
    pub crop: Option<[f64; 4]>,
    /// Weights, 0 or more, of mutations of Metropolis light transport, where they shall not be the usual ones. Names are
    /// not checked here.
    pub mutations: BTreeMap<String, f64>,
    /// Name of the way in which mutations are weighed. Default `fixed`.
    pub mutation_choice: Option<String>,
    /// Steps of a chain of Metropolis light transport, at least 1. Default 512.
    pub chain_length: Option<u32>,
    /// Name of the way in which lens subpaths spread over the image. Default `across-chains`.
    pub lens_subpaths: Option<String>,
}

/// The table `[output]`. Names of tone maps and AOVs are not checked here: their lists live with the writers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OutputSettings {
    /// The EXR, relative to the current folder. Default: name of the scene's folder with `.exr`.
    pub path: Option<PathBuf>,
    /// The PNG, relative to the current folder. Default: beside the EXR.
    pub png: Option<PathBuf>,
    /// Name of the tone map of the PNG. Default `agx`.
    pub tone_map: Option<String>,
    /// Exposure of the PNG in stops (EV). Default 0.
    pub exposure: Option<f64>,
    /// Names of further layers of the EXR. Default: none.
    pub aov: Option<Vec<String>>,
    /// Whether colours are written as full floats too. Default `false`: half floats.
    pub float: Option<bool>,
}
