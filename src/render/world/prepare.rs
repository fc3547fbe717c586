//! Scene → World: textures, tangents, geometry, emitters, camera.

use std::sync::Arc;

use ajar_scene::{
    Camera, Diagnostic, Id, Input, Light, LightKind, Material, Mesh, Scene, Severity, TextureInput,
};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

use super::{
    Instance, World,
    emitters::emitters,
    previous::{Previous, Tangents, same_shape},
};
use crate::{
    bvh::{self, Geometry, InstanceGeometry},
    camera,
    light::tessellate,
    material,
    texture::{LoadedBefore, load_textures},
};

/// What a world needs to know besides the scene.
#[derive(Clone, Copy, Debug)]
pub struct PrepareOptions {
    /// Camera and its place.
    pub camera: (Id<Camera>, DAffine3),
    /// Film size in pixels.
    pub size: [u32; 2],
    /// Bytes that decoded textures may take.
    pub texture_memory: u64,
}

/// Prepares a validated scene. Warnings name what is missing in the picture.
///
/// # Errors
/// Images that cannot be decoded.
pub fn prepare(scene: Scene, options: &PrepareOptions) -> Result<(World, Vec<Diagnostic>), Vec<Diagnostic>> {
    prepare_after(scene, options, None)
}

/// As [`prepare`], with the same result, but what is as it was in the `previous` world is shared with it: decoded images,
/// trees of geometry, tangents, surroundings.
///
/// # Errors
/// Images that cannot be decoded.
pub fn prepare_after(
    mut scene: Scene,
    options: &PrepareOptions,
    previous: Option<Previous<'_>>,
) -> Result<(World, Vec<Diagnostic>), Vec<Diagnostic>> {
    let camera = &scene.cameras[options.camera.0];
    let [width, height] = options.size;
    let camera = camera::Camera::new(camera, &options.camera.1, width, height);
    let solids = scene.meshes.len();
    shapes_to_meshes(&mut scene);
    let before = previous.map(|it| LoadedBefore { textures: &it.world.textures, changed: it.changed });
    let (textures, diagnostics) = load_textures(&scene, options.texture_memory, before);
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        return Err(diagnostics);
    }
    let default_material = scene.materials.push(Material { name: "default".into(), ..Material::default() });
    let instances = instances(&scene, default_material);
    let old = previous.map(|previous| previous.world);
    let geometry = geometry(&scene, &instances, solids, old);
    let materials = materials(&scene, &instances);
    let tangents = generate_tangents(&scene, &instances, old);
    let uses = |test: fn(&material::Material) -> bool| {
        instances.iter().any(|instance| test(&materials[instance.material as usize]))
    };
    let mut world = World {
        camera,
        lights: Arc::default(),
        shortest_edge: 0.0,
        has_alpha: uses(material::Material::has_alpha),
        has_culling: uses(material::Material::cull_back),
        has_absorption: uses(|m| m.absorption().is_some()),
        scene: Arc::new(scene),
        geometry,
        instances,
        solids,
        materials,
        textures,
        surroundings: Vec::new(),
        tangents,
    };
    let sphere = world.bounding_sphere();
    // Closer neighbours carry no light: it keeps 1/r² in corners finite, far below what a pixel shows.
    world.shortest_edge = 1e-7 * sphere.1;
    world.lights = Arc::new(emitters(&mut world, sphere, old));
    Ok((world, diagnostics))
}

impl World {
    /// Centre and radius of a sphere around everything, the camera included.
    fn bounding_sphere(&self) -> (DVec3, f64) {
        let (mut low, mut high) = self.geometry.bounds();
        let lens = self.camera.ray(glam::DVec2::ZERO, [0.5; 2]).origin;
        if !(low.cmple(high).all()) {
            (low, high) = (lens, lens);
        }
        let centre = (low + high) / 2.0;
        (centre, ((high - low).length() / 2.0).max(1e-6) * (1.0 + 1e-6))
    }
}

/// Replaces every light with a shape by a mesh that shines.
fn shapes_to_meshes(scene: &mut Scene) {
    for index in 0..scene.nodes.len() {
        let node = Id::new(index);
        let Some(light) = scene.nodes[node].light.and_then(|id| scene.lights.get(id)) else { continue };
        let Some(mut mesh) = tessellate(&light.kind) else { continue };
        mesh.name.clone_from(&light.name);
        mesh.material = Some(scene.materials.push(emitting_material(light)));
        let mesh = scene.meshes.push(mesh);
        scene.nodes[node].meshes.push(mesh);
        scene.nodes[node].light = None;
    }
}

fn emitting_material(light: &Light) -> Material {
    let (radiance, texture) = match light.kind {
        LightKind::Rect { radiance, texture, .. } => (radiance, texture),
        LightKind::Disk { radiance, .. }
        | LightKind::Sphere { radiance, .. }
        | LightKind::Cylinder { radiance, .. } => (radiance, None),
        LightKind::Point { .. }
        | LightKind::Spot { .. }
        | LightKind::Directional { .. }
        | LightKind::Environment { .. } => (0.0, None),
    };
    let texture = texture.map(|texture| TextureInput { texture, channel: ajar_scene::Channel::R });
    Material {
        name: light.name.clone(),
        base_color: Input::constant(Vec3::ZERO),
        specular: Input::constant(0.0),
        emission: Input { value: light.color * radiance, texture },
        double_sided: false,
        ..Material::default()
    }
}

/// Everything visible, in the order of the hierarchy.
fn instances(scene: &Scene, default_material: Id<Material>) -> Vec<Instance> {
    let mut found = Vec::new();
    for placed in scene.placed().into_iter().filter(|p| p.visible) {
        for &mesh in &placed.node.meshes {
            let linear = placed.world.matrix3;
            let determinant = linear.determinant();
            if determinant == 0.0 || scene.meshes[mesh].triangles.is_empty() {
                continue;
            }
            let material = placed.node.material.or(scene.meshes[mesh].material).unwrap_or(default_material);
            found.push(Instance {
                mesh,
                node: placed.id,
                material: material.index() as u32,
                to_world: placed.world,
                normal_to_world: linear.inverse().transpose(),
                handedness: determinant.signum(),
                first_emitter: None,
            });
        }
    }
    found
}

/// What rays meet. Meshes from number `solids` on are the shapes of lights.
fn geometry(scene: &Scene, instances: &[Instance], solids: usize, old: Option<&World>) -> Arc<Geometry> {
    let placements = placements_of(instances, solids);
    let same = old.map(|old| same_shapes(scene, instances, &old.scene)).unwrap_or_default();
    let old_placements = old.map(|old| placements_of(&old.instances, old.solids)).unwrap_or_default();
    let previous =
        old.map(|old| bvh::Previous { geometry: &old.geometry, instances: &old_placements, same: &same });
    if let (Some(old), Some(previous)) = (old, previous)
        && previous.is_of(&placements)
    {
        return Arc::clone(&old.geometry);
    }
    let meshes: Vec<&Mesh> = scene.meshes.iter().collect();
    Arc::new(Geometry::build_after(&meshes, &placements, previous))
}

fn placements_of(instances: &[Instance], solids: usize) -> Vec<InstanceGeometry> {
    let place = |instance: &Instance| InstanceGeometry {
        mesh: instance.mesh.index(),
        to_world: instance.to_world,
        is_lamp: instance.mesh.index() >= solids,
    };
    instances.iter().map(place).collect()
}

/// For each mesh that is used whether the old scene has the same shape at that number.
fn same_shapes(scene: &Scene, instances: &[Instance], old: &Scene) -> Vec<bool> {
    let mut used = vec![false; scene.meshes.len()];
    instances.iter().for_each(|instance| used[instance.mesh.index()] = true);
    let meshes: Vec<_> = scene.meshes.ids().zip(used).collect();
    let is_same = |(id, used): (Id<Mesh>, bool)| {
        used && old.meshes.get(id).is_some_and(|old| same_shape(&scene.meshes[id], old))
    };
    meshes.into_par_iter().map(is_same).collect()
}

fn materials(scene: &Scene, instances: &[Instance]) -> Vec<material::Material> {
    let mut colored = vec![false; scene.materials.len()];
    for instance in instances.iter().filter(|i| scene.meshes[i.mesh].colors.is_some()) {
        colored[instance.material as usize] = true;
    }
    scene
        .materials
        .iter()
        .zip(colored)
        .map(|(source, colored)| material::Material::new(source.in_range(), colored))
        .collect()
}

/// Tangents for meshes that have none and a material that needs them.
fn generate_tangents(scene: &Scene, instances: &[Instance], old: Option<&World>) -> Vec<Option<Tangents>> {
    let mut sets: Vec<Option<u32>> = vec![None; scene.meshes.len()];
    for instance in instances {
        let mesh = &scene.meshes[instance.mesh];
        let set = tangent_uv_set(scene, &scene.materials[Id::new(instance.material as usize)]);
        if mesh.tangents.is_none() && set.is_some_and(|set| (set as usize) < mesh.uvs.len()) {
            sets[instance.mesh.index()] = set;
        }
    }
    let meshes: Vec<_> = scene.meshes.ids().zip(sets).collect();
    meshes
        .into_par_iter()
        .map(|(id, set)| {
            let (mesh, set) = (&scene.meshes[id], set?);
            let kept = old.and_then(|old| Tangents::kept(old, id, mesh, set));
            kept.or_else(|| Tangents::new(mesh, set))
        })
        .collect()
}

/// The texture coordinate set that a material's tangents follow, if it needs tangents.
fn tangent_uv_set(scene: &Scene, material: &Material) -> Option<u32> {
    let map = material.normal_map.or(material.coat_normal_map).map(|map| map.texture);
    if let Some(texture) = map.or(material.anisotropy_direction) {
        return scene.textures.get(texture).map(|texture| texture.uv_set);
    }
    (material.anisotropy.value > 0.0).then_some(0)
}
