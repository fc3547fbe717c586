//! EXT_mesh_gpu_instancing: a node whose mesh is shown many times.

use ajar_scene::{Diagnostic, Id, Node, Scene};
use glam::{DAffine3, DQuat, DVec3};
use serde::Deserialize;
use std::collections::BTreeMap;

use super::{Asset, Context, accessor::Accessor, extensions};

const NAME: &str = "EXT_mesh_gpu_instancing";

#[derive(Deserialize)]
struct Instancing {
    #[serde(default)]
    attributes: BTreeMap<String, u32>,
}

/// Moves the meshes of nodes with instances to a node below for each instance, after all nodes of the file.
///
/// # Errors
/// An accessor is broken or memory runs out.
pub(super) fn expand(asset: &Asset, context: &mut Context, scene: &mut Scene) -> Result<(), Diagnostic> {
    for (i, node) in asset.root.nodes.iter().enumerate() {
        let element = format!("nodes[{i}]");
        let others = node.extensions.as_ref().map(|extensions| &extensions.others);
        let Some(found) = extensions::read::<Instancing>(others, NAME, &element, &mut context.report) else {
            continue;
        };
        let element = format!("{element}.extensions.{NAME}.attributes");
        let places = places(&found, asset, context, &element)?;
        let node = &mut scene.nodes[Id::new(i)];
        let (meshes, name) = (std::mem::take(&mut node.meshes), node.name.clone());
        for (k, transform) in places.into_iter().enumerate() {
            let name = format!("{name}[{k}]");
            let below = Node { name, transform, meshes: meshes.clone(), ..Node::default() };
            let below = scene.nodes.push(below);
            scene.nodes[Id::new(i)].children.push(below);
        }
    }
    Ok(())
}

/// The transform of each instance.
fn places(
    found: &Instancing,
    asset: &Asset,
    context: &mut Context,
    element: &str,
) -> Result<Vec<DAffine3>, Diagnostic> {
    let mut open = |name: &str, width: usize| {
        let Some(&index) = found.attributes.get(name) else { return Ok(None) };
        Accessor::open(asset, context, index as usize, &[width], &format!("{element}.{name}")).map(Some)
    };
    let translations = open("TRANSLATION", 3)?;
    let rotations = open("ROTATION", 4)?;
    let scales = open("SCALE", 3)?;
    let counts: Vec<_> =
        [&translations, &rotations, &scales].into_iter().flatten().map(|a| a.count).collect();
    let Some(&count) = counts.first() else {
        context.report.warn(element, "no attribute places the instances; they are not shown");
        return Ok(Vec::new());
    };
    if counts.iter().any(|&other| other != count) {
        return Err(Diagnostic::error("the attributes have not the same number of elements").element(element));
    }
    context.charge(u64::from(count) * 2 * size_of::<Node>() as u64, element)?;
    let vector = |accessor: &Option<Accessor>, i, missing| {
        accessor.as_ref().map_or(missing, |a| DVec3::from(a.get::<3>(i, 0.0).map(f64::from)))
    };
    let place = |i: u32| {
        let rotation = rotations.as_ref().map(|a| DQuat::from_array(a.get::<4>(i, 0.0).map(f64::from)));
        let rotation =
            rotation.filter(|q| q.length_squared() > 0.0).map_or(DQuat::IDENTITY, DQuat::normalize);
        let (scale, translation) = (vector(&scales, i, DVec3::ONE), vector(&translations, i, DVec3::ZERO));
        DAffine3::from_scale_rotation_translation(scale, rotation, translation)
    };
    let places: Vec<_> = (0..count).map(place).collect();
    match places.iter().position(|place| !place.is_finite()) {
        Some(k) => {
            Err(Diagnostic::error(format!("the transform of instance {k} is not finite")).element(element))
        }
        None => Ok(places),
    }
}
