//! Where a scene is, and the camera and light that a scene without any gets.

use std::f64::consts::PI;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::{Camera, Diagnostic, Id, Light, LightKind, Material, Mesh, Node, Projection, Scene};

/// Vertical angle of the camera that frames a scene, radians.
const YFOV: f64 = 40.0 * PI / 180.0;

/// From the scene's centre towards that camera: in front, to the right, above.
const VIEW: DVec3 = DVec3::new(0.6, 0.5, 1.0);

/// Radiance of the default studio, cd/m².
const STUDIO_GREY: f32 = 0.35;

/// Illuminance of its key light, lux.
const STUDIO_KEY: f32 = 2.2;

/// Full angle of the key light, radians: soft shadows.
const STUDIO_KEY_ANGLE: f32 = 0.35;

/// Where the key light shines.
const STUDIO_KEY_DIRECTION: DVec3 = DVec3::new(0.55, -0.9, -0.5);

impl Scene {
    /// The smallest box along the world's axes that holds all triangles of visible meshes: lower and upper corner in
    /// metres. `None` without triangles. Vertices that are not finite or that no triangle uses do not count.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let mut bounds: Option<(DVec3, DVec3)> = None;
        for placed in self.placed().iter().filter(|placed| placed.visible) {
            for mesh in placed.node.meshes.iter().filter_map(|&id| self.meshes.get(id)) {
                for &index in mesh.triangles.iter().flatten() {
                    let Some(position) = mesh.positions.get(index as usize) else { continue };
                    let point = placed.world.transform_point3(position.as_dvec3());
                    if point.is_finite() {
                        let (low, high) = bounds.unwrap_or((point, point));
                        bounds = Some((low.min(point), high.max(point)));
                    }
                }
            }
        }
        bounds
    }

    /// Whether some node places a camera.
    pub fn has_camera(&self) -> bool {
        self.placed().iter().any(|placed| placed.node.camera.is_some())
    }

    /// Whether there is anything to see by: a visible light, or a visible mesh that emits more than 1 cd/m². Dimmer ones
    /// are labels and displays, made for renderers whose emission lights nothing.
    pub fn has_light(&self) -> bool {
        self.placed().iter().filter(|placed| placed.visible).any(|placed| {
            let material = |mesh: &Mesh| self.materials.get(placed.node.material.or(mesh.material)?);
            placed.node.light.is_some()
                || placed
                    .node
                    .meshes
                    .iter()
                    .filter_map(|&id| material(self.meshes.get(id)?))
                    .any(|material: &Material| !material.unlit && material.emission.value.max_element() > 1.0)
        })
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

    /// Adds a neutral studio unless there is light, and says so: grey surroundings, and a large soft key light from above,
    /// left of the default camera, so that white things show their shape. A white surface that faces the key light has a
    /// radiance near 1.
    pub fn add_default_light(&mut self) -> Option<Diagnostic> {
        if self.has_light() {
            return None;
        }
        let sky = LightKind::Environment { radiance: STUDIO_GREY, texture: None };
        let key = LightKind::Directional { illuminance: STUDIO_KEY, angle: STUDIO_KEY_ANGLE };
        for (name, kind) in [("studio", sky), ("studio key", key)] {
            let light = Some(self.lights.push(Light { name: name.to_owned(), color: Vec3::ONE, kind }));
            let transform = looking(DVec3::ZERO, STUDIO_KEY_DIRECTION, DVec3::Y);
            self.add_root(Node { name: name.to_owned(), transform, light, ..Node::default() });
        }
        Some(Diagnostic::note("the scene has no light, added a grey studio with a soft key light"))
    }

    /// Adds a node at the top of the hierarchy.
    pub fn add_root(&mut self, node: Node) -> Id<Node> {
        let id = self.nodes.push(node);
        self.roots.push(id);
        id
    }
}

/// A perspective camera that sees the whole bounding sphere of the scene's bounds from the front, right and above, in an
/// image `aspect` times as wide as high, and its place in the world. A scene without bounds counts as a ball of 1 m at
/// the origin.
pub fn framing_camera(scene: &Scene, aspect: f64) -> (Camera, DAffine3) {
    let (low, high) = scene.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let center = (low + high) / 2.0;
    let extent = (high - low).length() / 2.0;
    let radius = if extent > 0.0 { extent } else { 1.0 };
    // The sphere must fit the narrower of the two angles: it touches a cone of half angle a at distance r / sin a.
    let half = ((YFOV / 2.0).tan() * aspect.min(1.0)).atan();
    let distance = radius / half.sin();
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

/// The rigid motion to `position` that turns −Z along `forward` and +Y as near to `up` as it can; where `up` lies along
/// `forward`, −Z of the world takes its place.
pub(crate) fn looking(position: DVec3, forward: DVec3, up: DVec3) -> DAffine3 {
    let back = -forward.normalize_or(DVec3::NEG_Z);
    let right = up.cross(back);
    let right = if right.length() > 1e-9 * up.length() { right } else { DVec3::NEG_Z.cross(back) };
    let right = right.try_normalize().unwrap_or(DVec3::X);
    DAffine3::from_mat3_translation(DMat3::from_cols(right, back.cross(right), back), position)
}
