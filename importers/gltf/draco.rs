//! KHR_draco_mesh_compression: primitives whose vertices and indices are one Draco stream. What is decoded becomes buffer
//! views of its own, to which the primitive's accessors then point, so that nothing after this knows of it.

use std::collections::BTreeMap;

use ajar_scene::Diagnostic;
use draco_oxide_core::{
    attribute::{Attribute, ComponentDataType},
    mesh::Mesh,
    types::PointIdx,
};
use gltf::json::{
    Index, Root,
    accessor::{ComponentType, GenericComponentType},
    buffer::View,
    validation::{Checked, USize64},
};
use serde::Deserialize;

use super::{Asset, Context, at, extensions};
use crate::guard;

const NAME: &str = "KHR_draco_mesh_compression";

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer_view: usize,
    /// Which of the stream's attributes, by its unique id, stands for each of the primitive's.
    attributes: BTreeMap<String, usize>,
}

/// The accessors that a stream fills, as indices.
struct Targets {
    indices: Option<usize>,
    /// With the id in the stream and the semantic's name.
    attributes: Vec<(usize, usize, String)>,
}

/// Decodes all compressed primitives; call it after the indices are checked.
///
/// # Errors
/// A stream is broken and there is no uncompressed fallback, or memory runs out.
pub(super) fn expand(asset: &mut Asset, context: &mut Context) -> Result<(), Diagnostic> {
    for i in 0..asset.root.meshes.len() {
        for j in 0..asset.root.meshes.get(i).map_or(0, |mesh| mesh.primitives.len()) {
            let element = format!("meshes[{i}].primitives[{j}]");
            let Some((compressed, targets)) = find(&asset.root, [i, j], context, &element) else { continue };
            let element = format!("{element}.extensions.{NAME}");
            if let Err(error) = primitive(asset, context, &compressed, &targets, &element) {
                let fallback = targets.all().all(|index| has_data(&asset.root, index));
                if !fallback || error.cause == ajar_scene::Cause::Resource {
                    return Err(error);
                }
                context.report.warn(element, format!("{}; the uncompressed fallback is used", error.message));
            }
        }
    }
    Ok(())
}

impl Targets {
    fn all(&self) -> impl Iterator<Item = usize> {
        self.attributes.iter().map(|&(accessor, ..)| accessor).chain(self.indices)
    }
}

fn has_data(root: &Root, accessor: usize) -> bool {
    root.accessors.get(accessor).is_some_and(|accessor| accessor.buffer_view.is_some())
}

fn find(
    root: &Root,
    [i, j]: [usize; 2],
    context: &mut Context,
    element: &str,
) -> Option<(Compressed, Targets)> {
    let primitive = root.meshes.get(i)?.primitives.get(j)?;
    let others = primitive.extensions.as_ref().map(|e| &e.others);
    let compressed: Compressed = extensions::read(others, NAME, element, &mut context.report)?;
    let named = primitive.attributes.iter().filter_map(|(semantic, accessor)| {
        let Checked::Valid(semantic) = semantic else { return None };
        let name = semantic.to_string();
        Some((accessor.value(), *compressed.attributes.get(&name)?, name))
    });
    let targets =
        Targets { attributes: named.collect(), indices: primitive.indices.map(|accessor| accessor.value()) };
    Some((compressed, targets))
}

fn primitive(
    asset: &mut Asset,
    context: &mut Context,
    compressed: &Compressed,
    targets: &Targets,
    element: &str,
) -> Result<(), Diagnostic> {
    let view = asset.buffers.view(&asset.root, compressed.buffer_view, element)?;
    // While it is decoded a stream takes several times what comes of it.
    let count = |index: usize| asset.root.accessors.get(index).map_or(0, |accessor| accessor.count.0);
    let elements = targets.all().map(count).fold(0u64, u64::saturating_add);
    context.charge(elements.saturating_mul(64), element)?;
    let error = |why: String| Diagnostic::error(why).element(element);
    let mesh = guard::catch(|| draco_oxide_decoder::decode_mesh(view.bytes))
        .map_err(|why| error(format!("the Draco stream cannot be decoded: {why}")))?
        .map_err(|why| error(format!("the Draco stream is broken: {why}")))?;
    let like = at(&asset.root.buffer_views, compressed.buffer_view, "bufferViews", element)?.clone();
    let points = mesh.get_attributes().iter().map(Attribute::len).max().unwrap_or_default();
    for (accessor, id, name) in &targets.attributes {
        let attribute = mesh.get_attributes().iter().find(|attribute| attribute.get_id().as_usize() == *id);
        let attribute =
            attribute.ok_or_else(|| error(format!("the stream has no attribute {id} for {name}")))?;
        if attribute.len() != points {
            return Err(error(format!("the stream's {name} are fewer than its points")));
        }
        let kind = component(attribute.get_component_type())
            .ok_or_else(|| error(format!("the stream's {name} are of an unknown type")))?;
        fill(asset, &like, *accessor, values(attribute, kind.size()), points, kind);
    }
    if let Some(accessor) = targets.indices {
        let count = 3 * mesh.get_faces().len();
        fill(asset, &like, accessor, indices(&mesh, points, element)?, count, ComponentType::U32);
    }
    Ok(())
}

/// Makes `accessors[accessor]` one of `count` elements in a new buffer view of these bytes.
fn fill(asset: &mut Asset, like: &View, accessor: usize, bytes: Vec<u8>, count: usize, kind: ComponentType) {
    let view = asset.root.buffer_views.len();
    asset.root.buffer_views.push(View { byte_stride: None, extensions: None, ..like.clone() });
    asset.buffers.add(view, bytes);
    if let Some(accessor) = asset.root.accessors.get_mut(accessor) {
        accessor.buffer_view = Some(Index::new(view as u32));
        accessor.byte_offset = None;
        accessor.sparse = None;
        accessor.count = USize64::from(count);
        accessor.component_type = Checked::Valid(GenericComponentType(kind));
    }
}

fn component(kind: ComponentDataType) -> Option<ComponentType> {
    Some(match kind {
        ComponentDataType::I8 => ComponentType::I8,
        ComponentDataType::U8 => ComponentType::U8,
        ComponentDataType::I16 => ComponentType::I16,
        ComponentDataType::U16 => ComponentType::U16,
        ComponentDataType::U32 => ComponentType::U32,
        ComponentDataType::F32 => ComponentType::F32,
        _ => return None,
    })
}

/// The values of all points, one after the other.
fn values(attribute: &Attribute, size: usize) -> Vec<u8> {
    let (bytes, width) = (attribute.get_data_as_bytes(), size * attribute.get_num_components());
    let mut values = Vec::with_capacity(attribute.len() * width);
    for point in 0..attribute.len() {
        let start = usize::from(attribute.get_unique_val_idx(PointIdx::from(point))) * width;
        match bytes.get(start..start + width) {
            Some(value) => values.extend_from_slice(value),
            None => values.resize(values.len() + width, 0),
        }
    }
    values
}

fn indices(mesh: &Mesh, points: usize, element: &str) -> Result<Vec<u8>, Diagnostic> {
    let corners = mesh.get_faces().iter().flatten().map(|&corner| usize::from(corner));
    let mut bytes = Vec::with_capacity(12 * mesh.get_faces().len());
    for corner in corners {
        if corner >= points {
            let message = format!("the stream points to vertex {corner}, but has only {points}");
            return Err(Diagnostic::error(message).element(element));
        }
        bytes.extend_from_slice(&(corner as u32).to_le_bytes());
    }
    Ok(bytes)
}
