//! Cameras: at the node's origin, looking along −Z, +Y up.

use serde::{Deserialize, Serialize};

/// A camera, placed by a node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Name from the asset; not necessarily unique.
    pub name: String,
    /// Kind and field of view.
    pub projection: Projection,
    /// Width over height that the view was composed for. A film of another shape shows more, never less; without it the
    /// vertical extent is kept.
    pub aspect: Option<f32>,
    /// Multiplies everything that the film receives.
    pub exposure: f32,
}

/// How points become raster positions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Projection {
    /// Central projection, with a thin lens where `lens_radius` > 0.
    Perspective {
        /// Full vertical angle, radians.
        yfov: f32,
        /// Metres; 0 is a pinhole.
        lens_radius: f32,
        /// Distance of the plane in focus along the axis, metres.
        focus_distance: f32,
        /// Shift of the image's centre in units of its half height, right and up.
        shift: [f32; 2],
    },
    /// Parallel projection.
    Orthographic {
        /// Half the vertical extent, metres.
        half_height: f32,
    },
}
