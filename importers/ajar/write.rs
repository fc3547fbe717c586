//! From the scene to bytes that hold all of it, images too.

use std::fs;

use ajar_scene::{Cause, Diagnostic, ImageSource, Mesh, Preference, Scene};
use bytemuck::NoUninit;
use serde_json::{Value, json};

use super::{array::Range, container, form};

/// The scene as one self-contained file.
///
/// # Errors
/// An image that cannot be read, or a scene beyond 4 GiB.
pub fn write(scene: &Scene, render: &Preference) -> Result<Vec<u8>, Diagnostic> {
    let mut binary = Vec::new();
    let meshes: Vec<_> = scene.meshes.iter().map(|mesh| form_of(mesh, &mut binary)).collect();
    let mut images = Vec::new();
    for image in scene.images.iter() {
        let range = match &image.source {
            ImageSource::Embedded(bytes) => append(bytes, &mut binary),
            ImageSource::File(path) => {
                let bytes = fs::read(path)
                    .map_err(|e| Diagnostic::error(format!("cannot be read: {e}")).in_file(path))?;
                append(&bytes, &mut binary)
            }
        };
        images.push(json!({ "name": image.name, "bytes": range }));
    }
    let json = json!({
        "ajar": form::VERSION,
        "roots": scene.roots,
        "nodes": scene.nodes,
        "meshes": meshes,
        "materials": scene.materials,
        "textures": scene.textures,
        "images": images,
        "lights": scene.lights,
        "cameras": scene.cameras,
        "render": render,
    });
    container::join(json.to_string().into_bytes(), binary).ok_or_else(|| {
        Diagnostic::error("the scene is larger than the 4 GiB that a file can hold").because(Cause::Resource)
    })
}

fn form_of(mesh: &Mesh, binary: &mut Vec<u8>) -> Value {
    let uvs: Vec<_> = mesh.uvs.iter().map(|set| append(set, binary)).collect();
    json!({
        "name": mesh.name,
        "positions": append(&mesh.positions, binary),
        "triangles": append(&mesh.triangles, binary),
        "normals": mesh.normals.as_ref().map(|n| append(n, binary)),
        "tangents": mesh.tangents.as_ref().map(|t| append(t, binary)),
        "uvs": uvs,
        "colors": mesh.colors.as_ref().map(|c| append(c, binary)),
        "material": mesh.material,
    })
}

/// Adds the items to the chunk, from a multiple of four bytes.
fn append<T: NoUninit>(items: &[T], binary: &mut Vec<u8>) -> Range {
    binary.resize(binary.len().next_multiple_of(4), 0);
    let range = Range { offset: binary.len() as u64, count: items.len() as u64 };
    binary.extend_from_slice(bytemuck::cast_slice(items));
    range
}
