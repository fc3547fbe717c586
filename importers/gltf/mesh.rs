//! Meshes: each primitive that makes triangles becomes one mesh.

use ajar_scene::{Diagnostic, Id, Mesh, Scene};
use gltf::json::{
    accessor::ComponentType,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

use super::{Asset, Context, accessor::Accessor, attributes::Vertices, material::Materials, topology};

/// Bytes that one corner costs while its triangle is made: the corner, the triangle, and the renumbering.
const CORNER: u64 = 4 + 12 + 16;

/// Makes the meshes of all `meshes[i]`, in file order.
pub(super) fn meshes(
    asset: &Asset,
    context: &mut Context,
    scene: &mut Scene,
    materials: &Materials,
) -> Result<Vec<Vec<Id<Mesh>>>, Diagnostic> {
    let mut all = Vec::with_capacity(asset.root.meshes.len());
    for (i, mesh) in asset.root.meshes.iter().enumerate() {
        let name = mesh.name.clone().unwrap_or_else(|| format!("meshes[{i}]"));
        let mut made = Vec::new();
        for (j, primitive) in mesh.primitives.iter().enumerate() {
            let element = format!("meshes[{i}].primitives[{j}]");
            let material = materials.of(primitive.material.map(|index| index.value()));
            if let Some(mesh) = self::primitive(asset, context, primitive, &element)? {
                made.push(scene.meshes.push(Mesh { name: name.clone(), material, ..mesh }));
            }
        }
        all.push(made);
    }
    Ok(all)
}

/// The mesh of a primitive, without name and material; `None`, with a warning, where it has no triangles.
fn primitive(
    asset: &Asset,
    context: &mut Context,
    primitive: &Primitive,
    element: &str,
) -> Result<Option<Mesh>, Diagnostic> {
    let mode = match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
        Checked::Valid(mode) => {
            let what = if mode == Mode::Points { "points" } else { "lines" };
            context.report.warn(element, format!("{what} are dropped, only triangles are rendered"));
            return Ok(None);
        }
        Checked::Invalid => return Err(Diagnostic::error("unknown mode").element(format!("{element}.mode"))),
    };
    if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
        context
            .report
            .warn(format!("{element}.targets"), "morph targets are ignored, the base shape is shown");
    }
    let Some(index) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
        context.report.warn(element, "the primitive has no POSITION and is dropped");
        return Ok(None);
    };
    let user = format!("{element}.attributes.POSITION");
    let positions = Accessor::open(asset, context, index.value(), &[3], &user)?;
    let corners = corners(asset, context, primitive, positions.count, element)?;
    if mode == Mode::Triangles && corners.len() % 3 != 0 {
        context.report.warn(element, "the number of corners is no multiple of three; the rest is dropped");
    }
    let mut triangles = topology::triangles(mode, &corners);
    if triangles.is_empty() {
        context.report.warn(element, "the primitive has no triangles");
        return Ok(None);
    }
    let used = topology::compact(&mut triangles, positions.count);
    let vertices = Vertices { asset, primitive, element, used: &used, count: positions.count };
    vertices.mesh(context, &positions, triangles).map(Some)
}

/// The vertex of each corner.
fn corners(
    asset: &Asset,
    context: &mut Context,
    primitive: &Primitive,
    count: u32,
    element: &str,
) -> Result<Vec<u32>, Diagnostic> {
    let Some(index) = primitive.indices else {
        context.charge(u64::from(count) * CORNER, element)?;
        return Ok((0..count).collect());
    };
    let element = format!("{element}.indices");
    let indices = Accessor::open(asset, context, index.value(), &[1], &element)?;
    if !matches!(indices.kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
        return Err(Diagnostic::error("indices must be unsigned integers").element(element));
    }
    if indices.is_all_zeros() {
        context.report.warn(&element, "the accessor has no data, all its elements are zero");
    }
    context.charge(u64::from(indices.count) * CORNER, &element)?;
    let corners: Vec<_> = (0..indices.count).map(|i| indices.index(i)).collect();
    match corners.iter().position(|&corner| corner >= count) {
        Some(at) => {
            let corner = corners.get(at).copied().unwrap_or_default();
            let message = format!("points to vertex {corner}, but there are only {count}");
            Err(Diagnostic::error(message).element(format!("{element}[{at}]")))
        }
        None => Ok(corners),
    }
}
