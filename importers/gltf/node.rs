//! Nodes: transforms, what they place, and which of them are in the scene.

use ajar_scene::{Camera, Diagnostic, Id, Light, Mesh, Node, Scene};
use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};
use gltf::json::Root;
use serde::Deserialize;

use super::{Context, at, extensions, light};

/// Where nodes are.
pub(super) struct Places {
    /// From each node's space to its parent's.
    pub locals: Vec<DAffine3>,
    /// From each node's space to the file's.
    pub globals: Vec<DAffine3>,
}

impl Places {
    /// # Errors
    /// A transform is not finite.
    pub fn new(root: &Root, context: &mut Context, parents: &[Option<usize>]) -> Result<Self, Diagnostic> {
        let local = |(i, node)| transform(node, context, &format!("nodes[{i}]"));
        let locals = root.nodes.iter().enumerate().map(local).collect::<Result<Vec<_>, _>>()?;
        let mut globals = locals.clone();
        let mut open: Vec<_> = (0..parents.len()).filter(|&i| parents.get(i) == Some(&None)).collect();
        while let Some(i) = open.pop() {
            let (Some(node), Some(&place)) = (root.nodes.get(i), globals.get(i)) else { continue };
            for child in node.children.iter().flatten().map(|child| child.value()) {
                if let (Some(global), Some(local)) = (globals.get_mut(child), locals.get(child)) {
                    *global = place * *local;
                    open.push(child);
                }
            }
        }
        Ok(Self { locals, globals })
    }
}

/// What nodes place, by the indices of the file.
pub(super) struct Parts {
    pub places: Places,
    /// One mesh per primitive of the node's mesh.
    pub meshes: Vec<Vec<Id<Mesh>>>,
    /// `None` where dropped.
    pub lights: Vec<Option<Id<Light>>>,
    /// `None` where dropped.
    pub cameras: Vec<Option<Id<Camera>>>,
}

#[derive(Deserialize)]
struct PlacedLight {
    light: u32,
}

#[derive(Deserialize)]
struct Visibility {
    #[serde(default = "shown")]
    visible: bool,
}

fn shown() -> bool {
    true
}

/// Adds all nodes, in file order, so that indices and handles agree.
///
/// # Errors
/// A light's index points beyond the list.
pub(super) fn nodes(
    root: &Root,
    context: &mut Context,
    scene: &mut Scene,
    parts: Parts,
) -> Result<(), Diagnostic> {
    let shown = root.nodes.iter().zip(parts.places.locals).zip(parts.meshes);
    for (i, ((node, transform), meshes)) in shown.enumerate() {
        let element = format!("nodes[{i}]");
        let others = node.extensions.as_ref().map(|extensions| &extensions.others);
        let placed: Option<PlacedLight> =
            extensions::read(others, light::NAME, &element, &mut context.report);
        let light = match placed {
            Some(placed) => {
                let user = format!("{element}.extensions.{}.light", light::NAME);
                *at(&parts.lights, placed.light as usize, "lights", &user)?
            }
            None => None,
        };
        let visibility: Option<Visibility> =
            extensions::read(others, "KHR_node_visibility", &element, &mut context.report);
        let camera = node.camera.and_then(|camera| parts.cameras.get(camera.value()));
        scene.nodes.push(Node {
            name: node.name.clone().unwrap_or_else(|| element.clone()),
            transform,
            children: node.children.iter().flatten().map(|child| Id::new(child.value())).collect(),
            meshes,
            material: None,
            light,
            camera: camera.copied().flatten(),
            visible: visibility.is_none_or(|visibility| visibility.visible),
        });
    }
    Ok(())
}

/// From the node's space to its parent's: the matrix, or translation × rotation × scale.
fn transform(node: &gltf::json::Node, context: &mut Context, element: &str) -> Result<DAffine3, Diagnostic> {
    let parts = node.translation.is_some() || node.rotation.is_some() || node.scale.is_some();
    let transform = match &node.matrix {
        Some(columns) => {
            let matrix = DMat4::from_cols_array(&columns.map(f64::from));
            if matrix.row(3) != DVec4::W {
                context
                    .report
                    .warn(format!("{element}.matrix"), "the last row is not 0 0 0 1 and is ignored");
            }
            if parts {
                context.report.warn(element, "translation, rotation and scale beside a matrix are ignored");
            }
            DAffine3::from_mat4(matrix)
        }
        None => {
            let vector =
                |parts: Option<[f32; 3]>, missing| parts.map_or(missing, |p| DVec3::from(p.map(f64::from)));
            let quaternion = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
            let rotation = if quaternion.length_squared() > 0.0 {
                quaternion.normalize()
            } else {
                context.report.warn(format!("{element}.rotation"), "the rotation is zero and is ignored");
                DQuat::IDENTITY
            };
            let (scale, translation) =
                (vector(node.scale, DVec3::ONE), vector(node.translation, DVec3::ZERO));
            DAffine3::from_scale_rotation_translation(scale, rotation, translation)
        }
    };
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(Diagnostic::error("the transform is not finite").element(element))
    }
}

/// The roots of the scene at `index`, or all nodes without parent if there are no scenes.
pub(super) fn roots(
    root: &Root,
    index: usize,
    parents: &[Option<usize>],
    context: &mut Context,
) -> Vec<Id<Node>> {
    let is_root = |i: usize| parents.get(i) == Some(&None);
    let Some(scene) = root.scenes.get(index) else {
        return (0..root.nodes.len()).filter(|&i| is_root(i)).map(Id::new).collect();
    };
    if root.scenes.len() > 1 {
        let count = root.scenes.len();
        context.report.note(format!("scenes[{index}]"), format!("this one of {count} scenes is read"));
    }
    let mut met = vec![false; root.nodes.len()];
    let mut roots = Vec::new();
    for (j, node) in scene.nodes.iter().enumerate() {
        let node = node.value();
        let again = met.get_mut(node).is_some_and(|met| std::mem::replace(met, true));
        if again || !is_root(node) {
            let why = if again { "listed twice" } else { "a child of another node" };
            let element = format!("scenes[{index}].nodes[{j}]");
            context.report.warn(element, format!("the node is {why}; this entry is ignored"));
        } else {
            roots.push(Id::new(node));
        }
    }
    roots
}
