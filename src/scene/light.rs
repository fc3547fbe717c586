//! Lights in photometric units; colours are linear Rec.709.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::{Id, Texture};

/// A light, placed by a node. It shines along the node's −Z where it has a direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// Name from the asset; not necessarily unique.
    pub name: String,
    /// Colour that multiplies the kind's intensity.
    pub color: Vec3,
    /// Shape and strength.
    pub kind: LightKind,
}

/// Shape and strength of a light. Lengths are in the node's space, so the node's scale changes sizes but never candela,
/// lux or cd/m².
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LightKind {
    /// Shines alike in all directions.
    Point {
        /// Candela.
        intensity: f32,
    },
    /// A cone with soft edge: full inside `inner`, nothing outside `outer`, smooth between (KHR_lights_punctual).
    Spot {
        /// Candela on the axis.
        intensity: f32,
        /// Half angle, radians.
        inner: f32,
        /// Half angle, radians, at most π/2.
        outer: f32,
    },
    /// From infinitely far.
    Directional {
        /// Lux on a surface that faces it.
        illuminance: f32,
        /// Full angle of the disc in the sky, radians; 0 is a single direction.
        angle: f32,
    },
    /// A rectangle in the XY plane.
    Rect {
        /// cd/m².
        radiance: f32,
        /// Along X, metres.
        width: f32,
        /// Along Y, metres.
        height: f32,
        /// Multiplies the radiance over the rectangle.
        texture: Option<Id<Texture>>,
    },
    /// A disc in the XY plane.
    Disk {
        /// cd/m².
        radiance: f32,
        /// Metres.
        radius: f32,
    },
    /// A ball that shines outwards.
    Sphere {
        /// cd/m².
        radiance: f32,
        /// Metres.
        radius: f32,
    },
    /// A tube along X without caps that shines outwards.
    Cylinder {
        /// cd/m².
        radiance: f32,
        /// Metres.
        radius: f32,
        /// Along X, metres.
        length: f32,
    },
    /// The sky: a latitude-longitude image seen from inside, or one colour. Pole +Y; the image's centre faces +Z, its
    /// left edge is at longitude +π (UsdLux DomeLight). Only the node's rotation counts.
    Environment {
        /// cd/m², multiplies the texture.
        radiance: f32,
        /// The image; absent: uniform.
        texture: Option<Id<Texture>>,
    },
}
