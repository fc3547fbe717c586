//! The camera and the light that a scene without any gets.

use std::f64::consts::PI;

use glam::{BVec3, DAffine3, DVec3, Vec3};

use crate::{
    Camera, Diagnostic, Image, ImageSource, Light, LightKind, Mesh, Node, Projection, Scene, Texture,
    bounds::looking,
};

/// Vertical angle of the camera that frames a scene, radians.
const YFOV: f64 = 40.0 * PI / 180.0;

/// The share of its image that the bounds may fill, across or up.
const FILLED: f64 = 0.9;

/// From the scene's centre towards that camera: in front, to the right, above.
const VIEW: DVec3 = DVec3::new(0.6, 0.5, 1.0);

/// Mean radiance of the default studio, cd/m².
const STUDIO_GREY: f32 = 0.35;

/// How much brighter its top is than its mean, and how much darker its ground: mirrors and glass would vanish in
/// surroundings that are everywhere the same.
const STUDIO_SLOPE: f64 = 0.7;

/// Rows of its image.
const STUDIO_ROWS: u32 = 64;

/// Illuminance of its key light, lux.
const STUDIO_KEY: f32 = 2.2;

/// Full angle of the key light, radians: soft shadows.
const STUDIO_KEY_ANGLE: f32 = 0.35;

/// Where the key light shines.
const STUDIO_KEY_DIRECTION: DVec3 = DVec3::new(0.55, -0.9, -0.5);

/// Least radiance of an emitter, cd/m²: dimmer ones are labels and displays, made for renderers whose emission lights
/// nothing.
const LEAST_EMISSION: f32 = 1.0;

/// Least illuminance that emitters together must give a sphere around the scene, lux: less is the glow of a filament, in
/// which nothing can be seen.
const LEAST_ILLUMINANCE: f64 = 0.05;

impl Scene {
    /// Whether some node places a camera.
    pub fn has_camera(&self) -> bool {
        self.placed().iter().any(|placed| placed.node.camera.is_some())
    }

    /// Whether there is anything to see by: a visible light, or visible meshes that emit enough.
    pub fn has_light(&self) -> bool {
        let placed = self.placed();
        if placed.iter().any(|placed| placed.visible && placed.node.light.is_some()) {
            return true;
        }
        let mut intensity = 0.0;
        for placed in placed.iter().filter(|placed| placed.visible) {
            for mesh in placed.node.meshes.iter().filter_map(|&id| self.meshes.get(id)) {
                let material = placed.node.material.or(mesh.material).and_then(|id| self.materials.get(id));
                let radiance =
                    material.filter(|it| !it.unlit).map_or(0.0, |it| it.emission.value.max_element());
                if radiance > LEAST_EMISSION {
                    intensity += f64::from(radiance) * area(mesh, &placed.world);
                }
            }
        }
        // A flux of π L A through a sphere of area 4π R².
        let square = || self.bounds().map_or(0.0, |(low, high)| (high - low).length_squared());
        intensity > 0.0 && intensity >= LEAST_ILLUMINANCE * square()
    }

    /// Adds a [`framing_camera`] unless there is a camera, and says so.
    pub fn add_default_camera(&mut self, aspect: f64) -> Option<Diagnostic> {
        if self.has_camera() {
            return None;
        }
        let (camera, transform) = framing_camera(self, aspect);
        let name = camera.name.clone();
        let camera = Some(self.cameras.push(camera));
        self.add_root(Node { name, transform, camera, ..Node::default() });
        Some(Diagnostic::note("the scene has no camera, added one that sees all of it"))
    }

    /// Adds a neutral studio unless there is light, and says so: grey surroundings that are brighter above than below, and
    /// a large soft key light from above, left of the default camera, so that things show their shape. A white surface
    /// that faces the key light has a radiance near 1.
    pub fn add_default_light(&mut self) -> Option<Diagnostic> {
        if self.has_light() {
            return None;
        }
        let source = ImageSource::Embedded(studio().into());
        let image = self.images.push(Image { name: "studio".to_owned(), source });
        let texture = Some(self.textures.push(Texture::new(image)));
        let sky = LightKind::Environment { radiance: STUDIO_GREY, texture };
        let key = LightKind::Directional { illuminance: STUDIO_KEY, angle: STUDIO_KEY_ANGLE };
        let aim = looking(DVec3::ZERO, STUDIO_KEY_DIRECTION, DVec3::Y);
        for (name, kind, transform) in [("studio", sky, DAffine3::IDENTITY), ("studio key", key, aim)] {
            let light = Some(self.lights.push(Light { name: name.to_owned(), color: Vec3::ONE, kind }));
            self.add_root(Node { name: name.to_owned(), transform, light, ..Node::default() });
        }
        Some(Diagnostic::note("the scene has no light, added a grey studio with a soft key light"))
    }
}

/// Area of a placed mesh, square metres.
fn area(mesh: &Mesh, world: &DAffine3) -> f64 {
    let corner =
        |&index: &u32| mesh.positions.get(index as usize).map(|p| world.transform_point3(p.as_dvec3()));
    let triangle = |triangle: &[u32; 3]| {
        let [Some(a), Some(b), Some(c)] = triangle.each_ref().map(corner) else { return 0.0 };
        (b - a).cross(c - a).length() / 2.0
    };
    mesh.triangles.iter().map(triangle).filter(|area| area.is_finite()).sum()
}

fn corners(low: DVec3, high: DVec3) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |i| DVec3::select(BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low))
}

/// The surroundings of the studio as a Radiance HDR image of mean 1 (G. Ward, "Real pixels", Graphics Gems II, 1991),
/// grey from 1 + slope at the top to 1 − slope at the bottom.
fn studio() -> Vec<u8> {
    let mut file = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {STUDIO_ROWS} +X 2\n").into_bytes();
    for row in 0..STUDIO_ROWS {
        let height = (PI * (f64::from(row) + 0.5) / f64::from(STUDIO_ROWS)).cos();
        // All values lie in (1/4, 2): with one exponent for all, steps are of 1/128.
        let mantissa = (128.0 * (1.0 + STUDIO_SLOPE * height)) as u8;
        file.extend([[mantissa, mantissa, mantissa, 129]; 2].as_flattened());
    }
    file
}

/// A perspective camera that sees the whole box of the scene's bounds from the front, right and above, as large as fits
/// in an image `aspect` times as wide as high with a narrow margin, and its place in the world. A scene without bounds
/// counts as a cube of 2 m around the origin.
pub fn framing_camera(scene: &Scene, aspect: f64) -> (Camera, DAffine3) {
    let bounds = scene.bounds().filter(|(low, high)| low != high);
    let (low, high) = bounds.unwrap_or((DVec3::NEG_ONE, DVec3::ONE));
    let center = (low + high) / 2.0;
    let turn = looking(DVec3::ZERO, -VIEW, DVec3::Y).inverse();
    let half = (YFOV / 2.0).tan() * FILLED;
    let farthest = |corner: DVec3| {
        let seen = turn.transform_vector3(corner - center);
        // A corner is seen if it lies within the angle, from the distance that its own depth leaves.
        (seen.x.abs() / (half * aspect)).max(seen.y.abs() / half) + seen.z
    };
    let distance = corners(low, high).map(farthest).fold(f64::MIN_POSITIVE, f64::max);
    let camera = Camera {
        name: "default".to_owned(),
        projection: Projection::Perspective {
            yfov: YFOV as f32,
            lens_radius: 0.0,
            focus_distance: distance as f32,
            shift: [0.0, 0.0],
        },
        aspect: None,
        exposure: 1.0,
    };
    (camera, looking(center + distance * VIEW.normalize(), -VIEW, DVec3::Y))
}
