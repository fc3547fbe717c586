//! Morph targets and skins: how a node bends its mesh (specification, sections 3.7.2.2 and 3.7.3).

use ajar_scene::Diagnostic;
use glam::{DAffine3, DMat3, DMat4, Vec3};
use gltf::json::{
    Index, Node, Root,
    accessor::Accessor as Source,
    mesh::{MorphTarget, Semantic},
};

use super::{Asset, Context, accessor::Accessor, at, attributes::Vertices};

/// Sets of joints of one vertex, four joints each, that are followed.
const MOST_SETS: u32 = 16;

/// How a mesh is bent. The default: not at all.
#[derive(Default)]
pub(super) struct Shape {
    /// Weight of each morph target.
    pub weights: Vec<f32>,
    /// From the mesh in its bind pose to the node's space, by joint; `None`: no skin.
    pub joints: Option<Vec<DAffine3>>,
}

impl Shape {
    /// Of the mesh that a node places, whose space lies at `globals` in the file's.
    ///
    /// # Errors
    /// The skin is broken, or memory runs out.
    pub fn of(
        node: usize,
        asset: &Asset,
        context: &mut Context,
        globals: &[DAffine3],
    ) -> Result<Self, Diagnostic> {
        let element = format!("nodes[{node}]");
        let source = at(&asset.root.nodes, node, "nodes", &element)?;
        let weights = weights(&asset.root, source).unwrap_or_default();
        let Some(skin) = source.skin else { return Ok(Self { weights, joints: None }) };
        let skin = skin.value();
        let joints = joints(skin, asset, context, globals)?;
        let to_node = globals.get(node).map_or(DAffine3::IDENTITY, DAffine3::inverse);
        if !to_node.is_finite() {
            context.report.warn(element, "the node has no extent; its mesh is not bent by the skin");
            return Ok(Self { weights, joints: None });
        }
        Ok(Self { weights, joints: Some(joints.into_iter().map(|joint| to_node * joint).collect()) })
    }

    /// Whether the node bends its mesh otherwise than other nodes do.
    pub fn is_own(root: &Root, node: &Node) -> bool {
        let mesh = node.mesh.and_then(|mesh| root.meshes.get(mesh.value()));
        node.skin.is_some() || mesh.is_some_and(|mesh| weights(root, node) != mesh.weights)
    }
}

/// Those of the node, else those of its mesh.
fn weights(root: &Root, node: &Node) -> Option<Vec<f32>> {
    let mesh = node.mesh.and_then(|mesh| root.meshes.get(mesh.value()));
    node.weights.clone().or_else(|| mesh?.weights.clone())
}

/// From the bind pose to the file's space, by joint.
fn joints(
    skin: usize,
    asset: &Asset,
    context: &mut Context,
    globals: &[DAffine3],
) -> Result<Vec<DAffine3>, Diagnostic> {
    let element = format!("skins[{skin}]");
    let source = at(&asset.root.skins, skin, "skins", &element)?;
    let count = source.joints.len();
    context.charge(count as u64 * 2 * size_of::<DAffine3>() as u64, &element)?;
    let inverses = match source.inverse_bind_matrices {
        Some(index) => {
            let user = format!("{element}.inverseBindMatrices");
            let accessor = Accessor::open(asset, context, index.value(), &[16], &user)?;
            if (accessor.count as usize) < count {
                return Err(Diagnostic::error("there are fewer matrices than joints").element(user));
            }
            Some(accessor)
        }
        None => None,
    };
    let joint = |(i, joint): (usize, &Index<Node>)| {
        let global = *at(globals, joint.value(), "nodes", &format!("{element}.joints[{i}]"))?;
        let inverse = inverses.as_ref().map_or(DAffine3::IDENTITY, |inverses| {
            let columns = inverses.get::<16>(i as u32, 0.0).map(f64::from);
            DAffine3::from_mat4(DMat4::from_cols_array(&columns))
        });
        Ok(global * inverse)
    };
    source.joints.iter().enumerate().map(joint).collect()
}

/// An attribute of a morph target: its name and where it is.
type Field<'a> = (&'a str, fn(&MorphTarget) -> Option<Index<Source>>);

/// Adds the morph targets of a primitive to a vertex attribute, of which `field` of a target moves `values`.
pub(super) fn morph(
    vertices: &Vertices,
    context: &mut Context,
    field: Field,
    values: &mut [Vec3],
) -> Result<(), Diagnostic> {
    let targets = vertices.primitive.targets.as_deref().unwrap_or_default();
    let (name, field) = field;
    for (k, (target, &weight)) in targets.iter().zip(&vertices.shape.weights).enumerate() {
        let Some(index) = field(target).filter(|_| weight != 0.0) else { continue };
        let user = format!("{}.targets[{k}].{name}", vertices.element);
        let accessor = Accessor::open(vertices.asset, context, index.value(), &[3], &user)?;
        if accessor.count != vertices.count {
            let message = "the target is dropped: it has not as many elements as POSITION";
            context.report.warn(user, message);
            continue;
        }
        for (value, &i) in values.iter_mut().zip(vertices.used) {
            *value += Vec3::from(accessor.get(i, 0.0)) * weight;
        }
    }
    Ok(())
}

/// The transform of each vertex by the skin, `None` where there is none.
///
/// # Errors
/// A vertex names a joint that the skin has not, or an accessor is broken.
pub(super) fn skin(vertices: &Vertices, context: &mut Context) -> Result<Option<Vec<DAffine3>>, Diagnostic> {
    let Some(joints) = &vertices.shape.joints else { return Ok(None) };
    let mut sums: Vec<DMat4> = Vec::new();
    for set in 0..MOST_SETS {
        let Some(influences) = Influences::open(vertices, context, set)? else { break };
        if sums.is_empty() {
            let bytes = size_of::<DMat4>() + size_of::<DAffine3>();
            context.charge((vertices.used.len() * bytes) as u64, vertices.element)?;
            sums = vec![DMat4::ZERO; vertices.used.len()];
        }
        for (sum, &i) in sums.iter_mut().zip(vertices.used) {
            *sum += influences.of(i, joints)?;
        }
    }
    if sums.is_empty() {
        let message = "the mesh has no joints and weights; the skin does not bend it";
        context.report.warn(vertices.element, message);
        return Ok(None);
    }
    // The last row holds the sum of the weights, which exporters round. A vertex without any follows the first joint.
    let first = joints.first().copied().unwrap_or(DAffine3::IDENTITY);
    let whole = |sum: DMat4| {
        let weight = sum.w_axis.w;
        if weight > 0.0 { DAffine3::from_mat4(sum * (1.0 / weight)) } else { first }
    };
    Ok(Some(sums.into_iter().map(whole).collect()))
}

/// Four joints of every vertex and their weights.
struct Influences<'a> {
    joints: Accessor<'a>,
    weights: Accessor<'a>,
    name: String,
}

impl<'a> Influences<'a> {
    fn open(vertices: &'a Vertices, context: &mut Context, set: u32) -> Result<Option<Self>, Diagnostic> {
        let name = format!("{}.attributes.JOINTS_{set}", vertices.element);
        let Some(joints) = vertices.accessor(context, Semantic::Joints(set), &name, &[4])? else {
            return Ok(None);
        };
        let other = format!("{}.attributes.WEIGHTS_{set}", vertices.element);
        let weights = vertices.accessor(context, Semantic::Weights(set), &other, &[4])?;
        Ok(weights.map(|weights| Self { joints, weights, name }))
    }

    /// The weighted sum of the joints' transforms.
    fn of(&self, vertex: u32, joints: &[DAffine3]) -> Result<DMat4, Diagnostic> {
        let mut sum = DMat4::ZERO;
        for (joint, weight) in
            self.joints.get::<4>(vertex, 0.0).into_iter().zip(self.weights.get::<4>(vertex, 0.0))
        {
            // Unused slots may name any joint.
            if weight > 0.0 {
                let joint = at(joints, joint as usize, "joints", &self.name)?;
                sum += DMat4::from(*joint) * f64::from(weight);
            }
        }
        Ok(sum)
    }
}

/// Directions of areas, which turn against lengths where a transform stretches: the cofactors.
pub(super) fn for_normals(transform: &DAffine3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = transform.matrix3;
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}
