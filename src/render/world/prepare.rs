//! Scene → World: textures, tangents, geometry, emitters, camera.

use ajar_scene::{
    Camera, Diagnostic, Id, Input, Light, LightKind, Material, Mesh, Scene, Severity, TextureInput,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::{Instance, World};
use crate::{
    bvh::{Geometry, InstanceGeometry},
    camera,
    environment::Environment,
    light::{DiracLight, Lights, TriangleLight, tessellate},
    material,
    math::{Frame, scalar},
    tangents,
    texture::{Textures, load_textures},
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
pub fn prepare(
    mut scene: Scene,
    options: &PrepareOptions,
) -> Result<(World, Vec<Diagnostic>), Vec<Diagnostic>> {
    let camera = &scene.cameras[options.camera.0];
    let [width, height] = options.size;
    let camera = camera::Camera::new(camera, &options.camera.1, width, height);
    shapes_to_meshes(&mut scene);
    let (textures, diagnostics) = load_textures(&scene, options.texture_memory);
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        return Err(diagnostics);
    }
    let default_material = scene.materials.push(Material { name: "default".into(), ..Material::default() });
    let instances = instances(&scene, default_material);
    let geometry = build_geometry(&scene, &instances);
    let materials = materials(&scene, &instances);
    let tangents = generate_tangents(&scene, &instances);
    let uses = |test: fn(&material::Material) -> bool| {
        instances.iter().any(|instance| test(&materials[instance.material as usize]))
    };
    let mut world = World {
        camera,
        lights: Lights::default(),
        shortest_edge: 0.0,
        has_alpha: uses(material::Material::has_alpha),
        has_culling: uses(material::Material::cull_back),
        has_absorption: uses(|m| m.absorption().is_some()),
        scene,
        geometry,
        instances,
        materials,
        textures,
        tangents,
    };
    let sphere = world.bounding_sphere();
    // Closer neighbours carry no light: it keeps 1/r² in corners finite, far below what a pixel shows.
    world.shortest_edge = 1e-7 * sphere.1;
    world.lights = emitters(&mut world, sphere);
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

fn build_geometry(scene: &Scene, instances: &[Instance]) -> Geometry {
    let meshes: Vec<&Mesh> = scene.meshes.iter().collect();
    let placements: Vec<InstanceGeometry> = instances
        .iter()
        .map(|instance| InstanceGeometry { mesh: instance.mesh.index(), to_world: instance.to_world })
        .collect();
    Geometry::build(&meshes, &placements)
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
fn generate_tangents(scene: &Scene, instances: &[Instance]) -> Vec<Option<Vec<[glam::Vec4; 3]>>> {
    let mut sets: Vec<Option<u32>> = vec![None; scene.meshes.len()];
    for instance in instances {
        let mesh = &scene.meshes[instance.mesh];
        let set = tangent_uv_set(scene, &scene.materials[Id::new(instance.material as usize)]);
        if mesh.tangents.is_none() && set.is_some_and(|set| (set as usize) < mesh.uvs.len()) {
            sets[instance.mesh.index()] = set;
        }
    }
    let meshes: Vec<&Mesh> = scene.meshes.iter().collect();
    meshes.into_par_iter().zip(sets).map(|(mesh, set)| tangents::generate(mesh, set? as usize)).collect()
}

/// The texture coordinate set that a material's tangents follow, if it needs tangents.
fn tangent_uv_set(scene: &Scene, material: &Material) -> Option<u32> {
    if let Some(map) = material.normal_map {
        return scene.textures.get(map.texture).map(|texture| texture.uv_set);
    }
    (material.anisotropy.value > 0.0).then_some(0)
}

fn emitters(world: &mut World, sphere: (DVec3, f64)) -> Lights {
    let mut dirac = Vec::new();
    let mut sky = Environment::default();
    for placed in world.scene.placed().into_iter().filter(|p| p.visible) {
        let Some(light) = placed.node.light.map(|id| &world.scene.lights[id]) else { continue };
        add_light(light, &placed.world, &world.textures, &mut dirac, &mut sky);
    }
    let sky = (!sky.is_empty()).then_some(sky);
    let first = dirac.len() + usize::from(sky.is_some());
    let mut triangles = Vec::new();
    for index in 0..world.instances.len() {
        if world.materials[world.instances[index].material as usize].emits() {
            world.instances[index].first_emitter = Some((first + triangles.len()) as u32);
            let count = world.scene.meshes[world.instances[index].mesh].triangles.len() as u32;
            triangles.par_extend((0..count).into_par_iter().map(|t| triangle_light(world, index as u32, t)));
        }
    }
    Lights::new(dirac, sky, triangles, sphere)
}

fn add_light(
    light: &Light,
    to_world: &DAffine3,
    textures: &Textures,
    dirac: &mut Vec<DiracLight>,
    sky: &mut Environment,
) {
    let color = light.color.as_dvec3();
    let axis = to_world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
    match light.kind {
        LightKind::Point { intensity } => dirac.push(DiracLight::Point {
            position: to_world.translation,
            intensity: color * f64::from(intensity),
        }),
        LightKind::Spot { intensity, inner, outer } => dirac.push(DiracLight::Spot {
            position: to_world.translation,
            frame: Frame::from_z(axis),
            intensity: color * f64::from(intensity),
            inner: f64::from(inner).cos(),
            outer: f64::from(outer).cos(),
        }),
        LightKind::Directional { illuminance, angle } => {
            let illuminance = color * f64::from(illuminance);
            if angle > 0.0 {
                sky.add_sun(-axis, angle.into(), illuminance);
            } else {
                dirac.push(DiracLight::Directional { to_light: -axis, illuminance });
            }
        }
        LightKind::Environment { radiance, texture } => {
            let radiance = color * f64::from(radiance);
            match texture.and_then(|id| textures.get(id)) {
                Some(image) => sky.add_image(image.clone(), rotation(to_world), radiance),
                None => sky.add_uniform(radiance),
            }
        }
        LightKind::Rect { .. }
        | LightKind::Disk { .. }
        | LightKind::Sphere { .. }
        | LightKind::Cylinder { .. } => {}
    }
}

/// The rotation of an affine map, by orthonormalizing its axes.
fn rotation(map: &DAffine3) -> DMat3 {
    let z = map.transform_vector3(DVec3::Z).normalize_or(DVec3::Z);
    let frame = Frame::from_zx(z, map.transform_vector3(DVec3::X));
    DMat3::from_cols(frame.x, frame.y, frame.z)
}

/// Barycentric points at which the emission of a triangle is averaged.
const EMISSION_PROBES: [[f64; 2]; 7] =
    [[1.0 / 3.0, 1.0 / 3.0], [0.6, 0.2], [0.2, 0.6], [0.2, 0.2], [0.05, 0.05], [0.9, 0.05], [0.05, 0.9]];

fn triangle_light(world: &World, instance: u32, triangle: u32) -> TriangleLight {
    let placed = &world.instances[instance as usize];
    let material = &world.materials[placed.material as usize];
    let vertices = world.geometry.vertices(instance, triangle);
    let [a, b, c] = vertices;
    let normal = (b - a).cross(c - a);
    let probe = |uv| scalar(material.emission(&world.textures, &world.point(placed, triangle, uv)));
    let mean = EMISSION_PROBES.iter().map(|&uv| probe(uv)).sum::<f64>() / EMISSION_PROBES.len() as f64;
    // Probes may miss the bright texels of a texture: some density stays wherever the material might shine.
    TriangleLight {
        instance,
        triangle,
        vertices,
        normal: normal.normalize_or(DVec3::Z) * placed.handedness,
        area: normal.length() / 2.0,
        rounding: world.geometry.rounding(instance, &vertices),
        both_sides: material.emits_both_sides(),
        brightness: mean.max(0.02 * scalar(material.emission_factor())),
    }
}
