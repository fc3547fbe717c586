//! Proof that indices point to something and that the nodes form trees, before anything follows them.

use ajar_scene::Diagnostic;
use gltf::json::Root;

use super::at;

/// Checks the indices of the core document, used or not.
///
/// # Errors
/// Names the first element that points beyond its list.
pub(super) fn indices(root: &Root) -> Result<(), Diagnostic> {
    for (i, view) in root.buffer_views.iter().enumerate() {
        at(&root.buffers, view.buffer.value(), "buffers", &format!("bufferViews[{i}].buffer"))?;
    }
    let view = |index: usize, element: &str| at(&root.buffer_views, index, "bufferViews", element).map(drop);
    for (i, accessor) in root.accessors.iter().enumerate() {
        let element = format!("accessors[{i}]");
        if let Some(index) = accessor.buffer_view {
            view(index.value(), &format!("{element}.bufferView"))?;
        }
        if let Some(sparse) = &accessor.sparse {
            view(sparse.indices.buffer_view.value(), &format!("{element}.sparse.indices.bufferView"))?;
            view(sparse.values.buffer_view.value(), &format!("{element}.sparse.values.bufferView"))?;
        }
    }
    for (i, image) in root.images.iter().enumerate() {
        if let Some(index) = image.buffer_view {
            view(index.value(), &format!("images[{i}].bufferView"))?;
        }
    }
    for (i, texture) in root.textures.iter().enumerate() {
        if let Some(sampler) = texture.sampler {
            at(&root.samplers, sampler.value(), "samplers", &format!("textures[{i}].sampler"))?;
        }
        // The crate stands the largest number for a texture without source.
        if texture.source.value() != u32::MAX as usize {
            at(&root.images, texture.source.value(), "images", &format!("textures[{i}].source"))?;
        }
    }
    primitives(root)?;
    nodes(root)
}

fn primitives(root: &Root) -> Result<(), Diagnostic> {
    for (i, mesh) in root.meshes.iter().enumerate() {
        for (j, primitive) in mesh.primitives.iter().enumerate() {
            let element = format!("meshes[{i}].primitives[{j}]");
            for accessor in primitive.attributes.values() {
                at(&root.accessors, accessor.value(), "accessors", &format!("{element}.attributes"))?;
            }
            if let Some(accessor) = primitive.indices {
                at(&root.accessors, accessor.value(), "accessors", &format!("{element}.indices"))?;
            }
            if let Some(material) = primitive.material {
                at(&root.materials, material.value(), "materials", &format!("{element}.material"))?;
            }
        }
    }
    Ok(())
}

fn nodes(root: &Root) -> Result<(), Diagnostic> {
    for (i, skin) in root.skins.iter().enumerate() {
        for (j, joint) in skin.joints.iter().enumerate() {
            at(&root.nodes, joint.value(), "nodes", &format!("skins[{i}].joints[{j}]"))?;
        }
    }
    for (i, node) in root.nodes.iter().enumerate() {
        if let Some(skin) = node.skin {
            at(&root.skins, skin.value(), "skins", &format!("nodes[{i}].skin"))?;
        }
        if let Some(mesh) = node.mesh {
            at(&root.meshes, mesh.value(), "meshes", &format!("nodes[{i}].mesh"))?;
        }
        if let Some(camera) = node.camera {
            at(&root.cameras, camera.value(), "cameras", &format!("nodes[{i}].camera"))?;
        }
        for (j, child) in node.children.iter().flatten().enumerate() {
            at(&root.nodes, child.value(), "nodes", &format!("nodes[{i}].children[{j}]"))?;
        }
    }
    for (i, scene) in root.scenes.iter().enumerate() {
        for (j, node) in scene.nodes.iter().enumerate() {
            at(&root.nodes, node.value(), "nodes", &format!("scenes[{i}].nodes[{j}]"))?;
        }
    }
    match root.scene {
        Some(scene) => at(&root.scenes, scene.value(), "scenes", "scene").map(drop),
        None => Ok(()),
    }
}

/// The parent of each node; call it after [`indices`].
///
/// # Errors
/// A node has two parents or is its own ancestor.
pub(super) fn parents(root: &Root) -> Result<Vec<Option<usize>>, Diagnostic> {
    let mut parents = vec![None; root.nodes.len()];
    for (i, node) in root.nodes.iter().enumerate() {
        for (j, child) in node.children.iter().flatten().enumerate() {
            let child = child.value();
            let Some(parent) = parents.get_mut(child) else { continue };
            if let Some(other) = parent.replace(i) {
                return Err(Diagnostic::error(format!(
                    "nodes[{child}] is already a child of nodes[{other}]; a node may have one parent"
                ))
                .element(format!("nodes[{i}].children[{j}]")));
            }
        }
    }
    // With one parent each, the nodes that a walk from the roots does not meet are those in or below cycles.
    let mut open: Vec<_> = (0..parents.len()).filter(|&i| parents.get(i) == Some(&None)).collect();
    let mut met = vec![false; parents.len()];
    while let Some(i) = open.pop() {
        if let Some(met) = met.get_mut(i) {
            *met = true;
        }
        let children = root.nodes.get(i).and_then(|node| node.children.as_ref());
        open.extend(children.into_iter().flatten().map(|child| child.value()));
    }
    match met.iter().position(|met| !met) {
        Some(i) => Err(Diagnostic::error("the node is its own ancestor, or lies below one that is")
            .element(format!("nodes[{i}]"))),
        None => Ok(parents),
    }
}
