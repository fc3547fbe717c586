//! Lights and cameras in the units that people use.

use ajar_scene::{Camera, Light, LightKind, Projection};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct LightEntry<'a> {
    pub name: &'a str,
    pub kind: &'static str,
    pub strength: f32,
    /// Unit of the strength.
    pub unit: &'static str,
    pub color: [f32; 3],
    /// Lengths in metres, angles in degrees.
    pub shape: Vec<(&'static str, f64)>,
    pub texture: Option<usize>,
}

#[derive(Serialize)]
pub(super) struct CameraEntry<'a> {
    pub name: &'a str,
    pub kind: &'static str,
    /// Full vertical angle, degrees; of perspective cameras.
    pub fov: Option<f64>,
    /// Metres.
    pub lens_radius: Option<f32>,
    /// Metres.
    pub focus_distance: Option<f32>,
    /// Full vertical extent, metres; of orthographic cameras.
    pub height: Option<f32>,
    pub exposure: f32,
}

impl<'a> LightEntry<'a> {
    pub fn new(light: &'a Light) -> Self {
        let angle = |radians: f32| f64::from(radians).to_degrees();
        let length = f64::from;
        let (kind, strength, unit, shape, texture) = match &light.kind {
            LightKind::Point { intensity } => ("point", *intensity, "cd", vec![], None),
            LightKind::Spot { intensity, inner, outer } => {
                let shape = vec![("inner half angle", angle(*inner)), ("outer half angle", angle(*outer))];
                ("spot", *intensity, "cd", shape, None)
            }
            LightKind::Directional { illuminance, angle: disc } => {
                ("directional", *illuminance, "lx", vec![("angle", angle(*disc))], None)
            }
            LightKind::Rect { radiance, width, height, texture } => {
                let shape = vec![("width", length(*width)), ("height", length(*height))];
                ("rect", *radiance, "cd/m²", shape, *texture)
            }
            LightKind::Disk { radiance, radius } => {
                ("disk", *radiance, "cd/m²", vec![("radius", length(*radius))], None)
            }
            LightKind::Sphere { radiance, radius } => {
                ("sphere", *radiance, "cd/m²", vec![("radius", length(*radius))], None)
            }
            LightKind::Cylinder { radiance, radius, length: along } => {
                let shape = vec![("radius", length(*radius)), ("length", length(*along))];
                ("cylinder", *radiance, "cd/m²", shape, None)
            }
            LightKind::Environment { radiance, texture } => {
                ("environment", *radiance, "cd/m²", vec![], *texture)
            }
        };
        let color = light.color.to_array();
        let texture = texture.map(|id| id.index());
        Self { name: &light.name, kind, strength, unit, color, shape, texture }
    }
}

impl<'a> CameraEntry<'a> {
    pub fn new(camera: &'a Camera) -> Self {
        let mut entry = Self {
            name: &camera.name,
            kind: "orthographic",
            fov: None,
            lens_radius: None,
            focus_distance: None,
            height: None,
            exposure: camera.exposure,
        };
        match camera.projection {
            Projection::Perspective { yfov, lens_radius, focus_distance, .. } => {
                entry.kind = "perspective";
                entry.fov = Some(f64::from(yfov).to_degrees());
                entry.lens_radius = Some(lens_radius);
                entry.focus_distance = Some(focus_distance);
            }
            Projection::Orthographic { half_height } => entry.height = Some(2.0 * half_height),
        }
        entry
    }
}
