//! All textures of a scene.

use std::{collections::BTreeSet, sync::Arc};

use ajar_scene::{Diagnostic, Id, Image, LightKind, Scene};
use rayon::prelude::*;

use super::{
    Bitmap, Texture,
    decode::{decode, probe, too_large},
};

/// The textures of a scene that something visible uses.
#[derive(Clone, Debug, Default)]
pub struct Textures(Vec<Option<Texture>>);

impl Textures {
    /// The texture of a handle; `None` if nothing visible uses it or its image could not be decoded.
    pub fn get(&self, id: Id<ajar_scene::Texture>) -> Option<&Texture> {
        self.0.get(id.index())?.as_ref()
    }
}

/// Decodes each image that a visible material or light uses, once, in parallel.
///
/// Together they may take `memory_limit` bytes, given out in the order of the images. Images that cannot be decoded are
/// missing in the result and have an error among the diagnostics, repaired ones a warning; the caller decides what to
/// do about them.
pub fn load_textures(scene: &Scene, memory_limit: u64) -> (Textures, Vec<Diagnostic>) {
    let used = used_textures(scene);
    let images: BTreeSet<Id<Image>> =
        used.iter().filter_map(|&id| scene.textures.get(id)).map(|texture| texture.image).collect();
    let images: Vec<(Id<Image>, &Image)> =
        images.into_iter().filter_map(|id| Some((id, scene.images.get(id)?))).collect();

    let (bitmaps, diagnostics) = load_images(&images, memory_limit);
    let mut decoded: Vec<Option<Arc<Bitmap>>> = vec![None; scene.images.len()];
    for ((id, _), bitmap) in images.iter().zip(bitmaps) {
        decoded[id.index()] = bitmap;
    }
    let texture = |id| {
        let texture = used.contains(&id).then(|| scene.textures.get(id)).flatten()?;
        Some(Texture::new(decoded.get(texture.image.index())?.clone()?, texture))
    };
    (Textures(scene.textures.ids().map(texture).collect()), diagnostics)
}

/// Bitmaps in the order of `images`, and messages in that order too.
fn load_images(
    images: &[(Id<Image>, &Image)],
    memory_limit: u64,
) -> (Vec<Option<Arc<Bitmap>>>, Vec<Diagnostic>) {
    // Headers first: who gets memory must not depend on which thread is faster.
    let headers: Vec<_> = images.par_iter().map(|(_, image)| probe(image)).collect();
    let mut left = memory_limit;
    let granted: Vec<Result<u64, Diagnostic>> = headers
        .into_iter()
        .zip(images)
        .map(|(header, (_, image))| {
            let header = header?;
            left = left.checked_sub(header.bytes).ok_or_else(|| too_large(image, &header, left))?;
            Ok(header.bytes)
        })
        .collect();
    let decoded: Vec<_> = granted
        .into_par_iter()
        .zip(images)
        .map(|(granted, (_, image))| granted.and_then(|bytes| decode(image, bytes)))
        .collect();

    let mut diagnostics = Vec::new();
    let bitmaps = decoded
        .into_iter()
        .zip(images)
        .map(|(decoded, (_, image))| match decoded {
            Ok(decoded) => {
                diagnostics.extend(decoded.warning(image));
                Some(Arc::new(decoded.bitmap))
            }
            Err(diagnostic) => {
                diagnostics.push(diagnostic);
                None
            }
        })
        .collect();
    (bitmaps, diagnostics)
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
