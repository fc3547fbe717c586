//! The scene file against whole files: what they mean, and what is said about broken ones.

mod broken;
mod choice;
mod layers;
mod meaning;
mod nodes;
mod reference;
mod shown;
mod textures;

use std::{fs, path::Path};

use tempfile::TempDir;

use super::{Overrides, SceneFile, load};
use crate::{Diagnostic, ImportRequest, Imported, Light, LightKind, Material, Mesh, Node, Scene, Texture};

/// A folder with this `scene.toml` and empty files of these names.
fn folder(toml: &str, files: &[&str]) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.toml"), toml).unwrap();
    for file in files {
        let path = folder.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, file).unwrap();
    }
    folder
}

/// An importer whose files all hold one triangle of material "Chrome" and a second material "Glass" with an image.
fn import(request: &ImportRequest) -> Result<Imported, Diagnostic> {
    if request.path.ends_with("bad.glb") {
        return Err(Diagnostic::error("is no asset").in_file("bad.glb"));
    }
    let mut scene = Scene::default();
    let source = crate::ImageSource::Embedded(vec![1, 2, 3].into());
    let image = scene.images.push(crate::Image { name: "pixels".into(), source });
    let texture = scene.textures.push(Texture::new(image));
    let chrome = scene.materials.push(Material { name: "Chrome".into(), ..Material::default() });
    let mut glass = Material { name: "Glass".into(), ..Material::default() };
    glass.roughness.texture = Some(crate::TextureInput { texture, channel: crate::Channel::G });
    glass.roughness.value = 0.5;
    scene.materials.push(glass);
    let mesh = scene.meshes.push(Mesh {
        name: "tri".into(),
        positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Z],
        triangles: vec![[0, 1, 2]],
        material: Some(chrome),
        ..Mesh::default()
    });
    let light = scene.lights.push(Light {
        name: "bulb".into(),
        color: glam::Vec3::ONE,
        kind: LightKind::Rect { radiance: 1.0, width: 1.0, height: 1.0, texture: Some(texture) },
    });
    scene.add_root(Node { name: "part".into(), meshes: vec![mesh], light: Some(light), ..Node::default() });
    let warning = Diagnostic::warning("something was dropped");
    let files = vec![request.path.with_extension("bin")];
    Ok(Imported { scene, diagnostics: vec![warning], files, ..Imported::default() })
}

fn read(folder: &Path) -> Result<SceneFile, Vec<Diagnostic>> {
    load(&ImportRequest::new(folder.join("scene.toml")), &Overrides::default(), &import)
}

/// The scene file of this text, which must be right.
fn right(toml: &str, files: &[&str]) -> SceneFile {
    let folder = folder(toml, files);
    read(folder.path()).unwrap_or_else(|errors| panic!("{toml}\n{errors:#?}"))
}

/// What is said about this text, without the path, which must be wrong.
fn wrong(toml: &str, files: &[&str]) -> Vec<String> {
    let folder = folder(toml, files);
    let prefix = format!("{}/scene.toml:", folder.path().display());
    let errors = read(folder.path()).err().unwrap_or_else(|| panic!("accepted: {toml}"));
    errors.iter().map(|error| error.to_string().replace(&prefix, "")).collect()
}
