//! What a scene holds, as the numbers and names that people ask for: the shape of `ajar inspect --json`.

use std::{borrow::Cow, path::Path};

use ajar_scene::{Diagnostic, Image, ImageSource, Material, Placed, Scene, Setting, Texture};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::optics::{CameraEntry, LightEntry};
use crate::session::Loaded;

/// Everything `ajar inspect` says. Items refer to each other by position in their lists.
#[derive(Serialize)]
pub(super) struct Contents<'a> {
    pub file: Cow<'a, str>,
    pub scene_hash: &'a str,
    pub counts: Counts,
    /// Box around all that is visible, metres.
    pub bounds: Option<Bounds>,
    /// Parents before children.
    pub nodes: Vec<NodeEntry<'a>>,
    pub meshes: Vec<MeshEntry<'a>>,
    pub materials: Vec<MaterialEntry<'a>>,
    pub textures: Vec<TextureEntry<'a>>,
    pub lights: Vec<LightEntry<'a>>,
    pub cameras: Vec<CameraEntry<'a>>,
    pub diagnostics: Vec<&'a Diagnostic>,
    /// Every value that scene files and command line set, and who did.
    pub settings: &'a [Setting],
    /// Every file that was read or looked for.
    pub files: Vec<String>,
}

/// How many there are.
#[derive(Serialize)]
pub(super) struct Counts {
    pub nodes: usize,
    pub meshes: usize,
    /// Meshes as often as visible nodes place them.
    pub instances: usize,
    /// Triangles of all meshes, each once.
    pub triangles: usize,
    /// Triangles of all instances.
    pub placed_triangles: usize,
    pub vertices: usize,
    pub materials: usize,
    pub textures: usize,
    pub images: usize,
    pub lights: usize,
    pub cameras: usize,
}

#[derive(Serialize)]
pub(super) struct Bounds {
    pub low: [f64; 3],
    pub high: [f64; 3],
    pub size: [f64; 3],
}

#[derive(Serialize)]
pub(super) struct NodeEntry<'a> {
    pub name: &'a str,
    /// Nodes above.
    pub depth: usize,
    /// Position in the list of nodes.
    pub parent: Option<usize>,
    /// Position among the children of its parent.
    pub sibling: usize,
    pub children: usize,
    pub visible: bool,
    /// Origin in the world, metres.
    pub position: [f64; 3],
    pub meshes: Vec<usize>,
    pub material: Option<usize>,
    pub light: Option<usize>,
    pub camera: Option<usize>,
}

#[derive(Serialize)]
pub(super) struct MeshEntry<'a> {
    pub name: &'a str,
    pub triangles: usize,
    pub vertices: usize,
    pub normals: bool,
    pub tangents: bool,
    pub uv_sets: usize,
    pub colors: bool,
    pub material: Option<usize>,
    /// How often nodes place it.
    pub placed: usize,
}

#[derive(Serialize)]
pub(super) struct MaterialEntry<'a> {
    pub name: &'a str,
    /// Its path in its own file, where it has one.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub own_path: &'a str,
    /// The first path that it is shown at; `[material]` tables may name both.
    pub path: Option<String>,
    /// At how many places it is shown.
    pub shown: usize,
    /// Parameters that differ from the default material, as the scene graph has them.
    pub parameters: Map<String, Value>,
}

#[derive(Serialize)]
pub(super) struct TextureEntry<'a> {
    /// Name of its image.
    pub image: &'a str,
    pub file: Option<Cow<'a, str>>,
    /// Size of the encoded image; absent if the file has gone.
    pub bytes: Option<u64>,
    pub color_space: Value,
    pub uv_set: u32,
    /// What else differs from how textures are read by default, as the scene graph has it.
    pub parameters: Map<String, Value>,
}

impl<'a> Contents<'a> {
    pub fn new(file: &'a Path, loaded: &'a Loaded) -> Self {
        let scene = &loaded.file.scene;
        let placed = scene.placed();
        let meshes = meshes(scene, &placed);
        Self {
            file: file.to_string_lossy(),
            scene_hash: &loaded.hash,
            counts: counts(scene, &placed),
            bounds: scene.bounds().map(|(low, high)| Bounds {
                low: low.to_array(),
                high: high.to_array(),
                size: (high - low).to_array(),
            }),
            nodes: nodes(&placed),
            meshes,
            materials: materials(scene),
            textures: scene
                .textures
                .iter()
                .filter_map(|it| Some(texture(it, scene.images.get(it.image)?)))
                .collect(),
            lights: scene.lights.iter().map(LightEntry::new).collect(),
            cameras: scene.cameras.iter().map(CameraEntry::new).collect(),
            diagnostics: loaded.file.diagnostics.iter().chain(&loaded.added).collect(),
            settings: &loaded.file.settings,
            files: loaded.file.files.iter().map(|file| file.to_string_lossy().into_owned()).collect(),
        }
    }
}

fn counts(scene: &Scene, placed: &[Placed<'_>]) -> Counts {
    let visible = placed.iter().filter(|it| it.visible);
    let instances: Vec<_> = visible.flat_map(|it| &it.node.meshes).collect();
    let triangles = |mesh: &ajar_scene::Mesh| mesh.triangles.len();
    Counts {
        nodes: placed.len(),
        meshes: scene.meshes.len(),
        instances: instances.len(),
        triangles: scene.meshes.iter().map(triangles).sum(),
        placed_triangles: instances.iter().filter_map(|id| scene.meshes.get(**id)).map(triangles).sum(),
        vertices: scene.meshes.iter().map(|mesh| mesh.positions.len()).sum(),
        materials: scene.materials.len(),
        textures: scene.textures.len(),
        images: scene.images.len(),
        lights: scene.lights.len(),
        cameras: scene.cameras.len(),
    }
}

fn nodes<'a>(placed: &[Placed<'a>]) -> Vec<NodeEntry<'a>> {
    // Of each level the node that the walk is below, and how many of its siblings came before.
    let mut above: Vec<(usize, usize)> = Vec::new();
    let mut entries = Vec::with_capacity(placed.len());
    for (index, Placed { node, world, visible, depth, .. }) in placed.iter().enumerate() {
        above.truncate(depth + 1);
        let sibling = above.get(*depth).map_or(0, |(_, before)| before + 1);
        above.truncate(*depth);
        let parent = above.last().map(|(parent, _)| *parent);
        above.push((index, sibling));
        entries.push(NodeEntry {
            name: &node.name,
            depth: *depth,
            parent,
            sibling,
            children: node.children.len(),
            visible: *visible,
            position: world.translation.to_array(),
            meshes: node.meshes.iter().map(|id| id.index()).collect(),
            material: node.material.map(|id| id.index()),
            light: node.light.map(|id| id.index()),
            camera: node.camera.map(|id| id.index()),
        });
    }
    entries
}

fn meshes<'a>(scene: &'a Scene, placed: &[Placed<'_>]) -> Vec<MeshEntry<'a>> {
    let mut uses = vec![0; scene.meshes.len()];
    for id in placed.iter().flat_map(|it| &it.node.meshes) {
        if let Some(uses) = uses.get_mut(id.index()) {
            *uses += 1;
        }
    }
    let entry = |(mesh, placed): (&'a ajar_scene::Mesh, usize)| MeshEntry {
        name: &mesh.name,
        triangles: mesh.triangles.len(),
        vertices: mesh.positions.len(),
        normals: mesh.normals.is_some(),
        tangents: mesh.tangents.is_some(),
        uv_sets: mesh.uvs.len(),
        colors: mesh.colors.is_some(),
        material: mesh.material.map(|id| id.index()),
        placed,
    };
    scene.meshes.iter().zip(uses).map(entry).collect()
}

/// The fields that differ from the default, but for those that are told apart, with single-precision numbers as short as
/// they can be written.
fn differing<T: Serialize>(it: &T, default: &T, apart: &[&str]) -> Map<String, Value> {
    let fields = |it: &T| -> Map<String, Value> {
        let text = serde_json::to_string(it).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    };
    let (mut found, default) = (fields(it), fields(default));
    found.retain(|key, value| !apart.contains(&key.as_str()) && default.get(key) != Some(value));
    found
}

fn materials(scene: &Scene) -> Vec<MaterialEntry<'_>> {
    let mut entries: Vec<_> = scene.materials.iter().map(material).collect();
    scene.paths(|placed, path| {
        for mesh in placed.node.meshes.iter().filter_map(|&id| scene.meshes.get(id)) {
            let material = placed.node.material.or(mesh.material);
            let Some(entry) = material.and_then(|id| entries.get_mut(id.index())) else { continue };
            entry.shown += 1;
            entry.path.get_or_insert_with(|| format!("{path}/{}", entry.name));
        }
    });
    entries
}

fn material(material: &Material) -> MaterialEntry<'_> {
    let parameters = differing(material, &Material::default(), &["name", "path"]);
    MaterialEntry { name: &material.name, own_path: &material.path, path: None, shown: 0, parameters }
}

fn texture<'a>(texture: &Texture, image: &'a Image) -> TextureEntry<'a> {
    let (file, bytes) = match &image.source {
        ImageSource::File(path) => {
            (Some(path.to_string_lossy()), std::fs::metadata(path).ok().map(|m| m.len()))
        }
        ImageSource::Embedded(bytes) => (None, Some(bytes.len() as u64)),
    };
    let color_space = json!(texture.color_space);
    let parameters = differing(texture, &Texture::new(texture.image), &["color_space", "uv_set"]);
    TextureEntry { image: &image.name, file, bytes, color_space, uv_set: texture.uv_set, parameters }
}
