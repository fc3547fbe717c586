//! All textures of a scene.

use std::{collections::BTreeSet, path::PathBuf, sync::Arc};

use ajar_scene::{Diagnostic, Id, Image, ImageSource, LightKind, Scene};
use rayon::prelude::*;

use super::{
    Bitmap, Texture,
    decode::{decode, probe, too_large},
};

/// The textures of a scene that something visible uses.
#[derive(Clone, Debug, Default)]
pub struct Textures {
    textures: Vec<Option<Texture>>,
    images: Vec<Loaded>,
}

impl Textures {
    /// The texture of a handle; `None` if nothing visible uses it or its image could not be decoded.
    pub fn get(&self, id: Id<ajar_scene::Texture>) -> Option<&Texture> {
        self.textures.get(id.index())?.as_ref()
    }
}

/// A decoded image.
#[derive(Clone, Debug)]
struct Loaded {
    image: Image,
    /// Memory that it counts for.
    bytes: u64,
    bitmap: Arc<Bitmap>,
    warning: Option<Diagnostic>,
}

/// Textures that were loaded before.
#[derive(Clone, Copy, Debug)]
pub struct LoadedBefore<'a> {
    /// They.
    pub textures: &'a Textures,
    /// Files that may hold something else by now.
    pub changed: &'a BTreeSet<PathBuf>,
}

impl LoadedBefore<'_> {
    /// The same image, if it was among them.
    fn find(&self, image: &Image) -> Option<Loaded> {
        let changed = matches!(&image.source, ImageSource::File(path) if self.changed.contains(path));
        let mut images = self.textures.images.iter().filter(|_| !changed);
        images.find(|it| it.image == *image).cloned()
    }
}

/// Decodes each image that a visible material or light uses, once, in parallel; those that were loaded `before` are taken
/// over, with the same result.
///
/// Together they may take `memory_limit` bytes, given out in the order of the images. Images that cannot be decoded are
/// missing in the result and have an error among the diagnostics, repaired ones a warning; the caller decides what to
/// do about them.
pub fn load_textures(
    scene: &Scene,
    memory_limit: u64,
    before: Option<LoadedBefore<'_>>,
) -> (Textures, Vec<Diagnostic>) {
    let used = used_textures(scene);
    let images: BTreeSet<Id<Image>> =
        used.iter().filter_map(|&id| scene.textures.get(id)).map(|texture| texture.image).collect();
    let images: Vec<(Id<Image>, &Image)> =
        images.into_iter().filter_map(|id| Some((id, scene.images.get(id)?))).collect();

    let sources: Vec<_> = images.iter().map(|(_, image)| *image).collect();
    let loaded = load_images(&sources, memory_limit, before);
    let mut textures = Textures::default();
    let mut diagnostics = Vec::new();
    let mut decoded: Vec<Option<Arc<Bitmap>>> = vec![None; scene.images.len()];
    for ((id, _), loaded) in images.iter().zip(loaded) {
        match loaded {
            Ok(loaded) => {
                diagnostics.extend(loaded.warning.clone());
                decoded[id.index()] = Some(Arc::clone(&loaded.bitmap));
                textures.images.push(loaded);
            }
            Err(diagnostic) => diagnostics.push(diagnostic),
        }
    }
    let texture = |id| {
        let texture = used.contains(&id).then(|| scene.textures.get(id)).flatten()?;
        Some(Texture::new(decoded.get(texture.image.index())?.clone()?, texture))
    };
    textures.textures = scene.textures.ids().map(texture).collect();
    (textures, diagnostics)
}

/// What became of each of the `images`.
fn load_images(
    images: &[&Image],
    memory_limit: u64,
    before: Option<LoadedBefore<'_>>,
) -> Vec<Result<Loaded, Diagnostic>> {
    // Headers first: who gets memory must not depend on which thread is faster.
    let headers: Vec<_> = images
        .par_iter()
        .map(|image| match before.and_then(|before| before.find(image)) {
            Some(kept) => Ok((kept.bytes, Some(kept))),
            None => probe(image).map(|header| (header.bytes, None)),
        })
        .collect();
    let mut left = memory_limit;
    let granted: Vec<_> = headers
        .into_iter()
        .zip(images)
        .map(|(header, image)| {
            let (bytes, kept) = header?;
            left = left.checked_sub(bytes).ok_or_else(|| too_large(image, bytes, left))?;
            Ok((bytes, kept))
        })
        .collect();
    let load = |bytes, image: &Image| {
        decode(image, bytes).map(|decoded| {
            let warning = decoded.warning(image);
            Loaded { image: image.clone(), bytes, bitmap: Arc::new(decoded.bitmap), warning }
        })
    };
    granted
        .into_par_iter()
        .zip(images)
        .map(|(granted, image)| granted.and_then(|(bytes, kept)| kept.map_or_else(|| load(bytes, image), Ok)))
        .collect()
}

/// Handles of all textures that visible meshes and lights refer to.
fn used_textures(scene: &Scene) -> BTreeSet<Id<ajar_scene::Texture>> {
    let mut materials = BTreeSet::new();
    let mut used = BTreeSet::new();
    for placed in scene.placed().into_iter().filter(|placed| placed.visible) {
        let meshes = placed.node.meshes.iter().filter_map(|&id| scene.meshes.get(id));
        materials.extend(meshes.filter_map(|mesh| placed.node.material.or(mesh.material)));
        let light = placed.node.light.and_then(|id| scene.lights.get(id)).map(|light| &light.kind);
        if let Some(LightKind::Rect { texture, .. } | LightKind::Environment { texture, .. }) = light {
            used.extend(*texture);
        }
    }
    for material in materials.into_iter().filter_map(|id| scene.materials.get(id)) {
        used.extend(material.textures());
    }
    used
}

#[cfg(test)]
mod tests;
