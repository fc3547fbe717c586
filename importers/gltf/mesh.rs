//! Meshes: each primitive that makes triangles becomes one mesh.

use ajar_scene::{Diagnostic, Id, Mesh, Scene};
use glam::DAffine3;
use gltf::json::{
    accessor::ComponentType,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

use super::{
    Asset, Context,
    accessor::{Accessor, first},
    at,
    attributes::Vertices,
    deform::Shape,
    material::Materials,
    topology,
    variants::Variants,
};

/// Bytes that one corner costs while its triangle is made: the corner, the triangle, and the renumbering.
const CORNER: u64 = 4 + 12 + 16;

/// Makes meshes.
pub(super) struct Maker<'a> {
    pub asset: &'a Asset,
    pub materials: Materials,
    pub variants: Variants,
    /// From each node's space to the file's.
    pub globals: &'a [DAffine3],
}

impl Maker<'_> {
    /// The meshes of each node. Nodes share them unless one bends them its own way; meshes that no node places are made
    /// too.
    ///
    /// # Errors
    /// A mesh or skin is broken, or memory runs out.
    pub fn meshes(&self, context: &mut Context, scene: &mut Scene) -> Result<Vec<Vec<Id<Mesh>>>, Diagnostic> {
        let root = &self.asset.root;
        let mut is_shared = vec![true; root.meshes.len()];
        let (own, plain): (Vec<_>, Vec<_>) = root.nodes.iter().partition(|node| Shape::is_own(root, node));
        for (nodes, shared) in [(own, false), (plain, true)] {
            for mesh in nodes.iter().filter_map(|node| node.mesh) {
                if let Some(is_shared) = is_shared.get_mut(mesh.value()) {
                    *is_shared = shared;
                }
            }
        }
        let mut shared = Vec::with_capacity(root.meshes.len());
        for (i, (mesh, is_shared)) in root.meshes.iter().zip(is_shared).enumerate() {
            let shape = Shape { weights: mesh.weights.clone().unwrap_or_default(), joints: None };
            shared.push(if is_shared { self.mesh(i, &shape, context, scene)? } else { Vec::new() });
        }
        let mut all = Vec::with_capacity(root.nodes.len());
        for (i, node) in root.nodes.iter().enumerate() {
            let Some(mesh) = node.mesh.map(|mesh| mesh.value()) else {
                all.push(Vec::new());
                continue;
            };
            all.push(if Shape::is_own(root, node) {
                let shape = Shape::of(i, self.asset, context, self.globals)?;
                self.mesh(mesh, &shape, context, scene)?
            } else {
                shared.get(mesh).cloned().unwrap_or_default()
            });
        }
        Ok(all)
    }

    /// The meshes of the primitives of `meshes[index]`.
    fn mesh(
        &self,
        index: usize,
        shape: &Shape,
        context: &mut Context,
        scene: &mut Scene,
    ) -> Result<Vec<Id<Mesh>>, Diagnostic> {
        let mesh = at(&self.asset.root.meshes, index, "meshes", "nodes")?;
        let name = mesh.name.clone().unwrap_or_else(|| format!("meshes[{index}]"));
        let mut made = Vec::new();
        for (j, primitive) in mesh.primitives.iter().enumerate() {
            let element = format!("meshes[{index}].primitives[{j}]");
            let material = self.variants.material(primitive, context, &element);
            if let Some(material) = material {
                at(&self.asset.root.materials, material, "materials", &element)?;
            }
            let material = self.materials.of(material);
            if let Some(mesh) = self::primitive(self.asset, context, primitive, shape, &element)? {
                made.push(scene.meshes.push(Mesh { name: name.clone(), material, ..mesh }));
            }
        }
        Ok(made)
    }
}

/// The mesh of a primitive, without name and material; `None`, with a warning, where it has no triangles.
fn primitive(
    asset: &Asset,
    context: &mut Context,
    primitive: &Primitive,
    shape: &Shape,
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
    let mut triangles = topology::triangles(mode, corners);
    if triangles.is_empty() {
        context.report.warn(element, "the primitive has no triangles");
        return Ok(None);
    }
    let used = topology::compact(&mut triangles, positions.count);
    let vertices = Vertices { asset, primitive, element, used: &used, count: positions.count, shape };
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
        context.report.approximate(&element, "the accessor has no data, all its elements are zero");
    }
    context.charge(u64::from(indices.count) * CORNER, &element)?;
    let corners = indices.indices();
    match first(&corners, |&corner| corner >= count) {
        Some(at) => {
            let corner = corners.get(at).copied().unwrap_or_default();
            let message = format!("points to vertex {corner}, but there are only {count}");
            Err(Diagnostic::error(message).element(format!("{element}[{at}]")))
        }
        None => Ok(corners),
    }
}
