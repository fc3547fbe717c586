//! Meshes: attributes of one length, finite numbers, indices that lead somewhere.

use std::collections::HashSet;

use super::{Findings, label, placed_label};
use crate::{Diagnostic, Mesh, Scene};

pub(super) fn check(scene: &Scene, findings: &mut Findings) {
    let mut user = vec![None; scene.meshes.len()];
    for placed in scene.placed() {
        for id in &placed.node.meshes {
            if let Some(user) = user.get_mut(id.index()) {
                user.get_or_insert(placed.id.index());
            }
        }
    }
    for (index, (mesh, user)) in scene.meshes.iter().zip(user).enumerate() {
        let name = || placed_label(scene, "mesh", &mesh.name, index, user);
        if mesh.material.is_some_and(|id| scene.materials.get(id).is_none()) {
            findings.add("meshes name materials that do not exist", name, missing_material(mesh));
        }
        if mesh.triangles.is_empty() {
            findings.add("meshes without triangles", name, Diagnostic::warning("has no triangles"));
        }
        indices(mesh, &name, findings);
        attributes(mesh, &name, findings);
    }
    uv_sets(scene, findings);
}

/// Every pair of a mesh and a material that are placed together: are there the texture coordinates that textures ask for?
fn uv_sets(scene: &Scene, findings: &mut Findings) {
    let mut met = HashSet::new();
    for placed in scene.placed() {
        for &id in &placed.node.meshes {
            let Some(mesh) = scene.meshes.get(id) else { continue };
            let Some(material_id) = placed.node.material.or(mesh.material) else { continue };
            let Some(material) = scene.materials.get(material_id) else { continue };
            if !met.insert((id.index(), material_id.index())) {
                continue;
            }
            let sets = material.textures().filter_map(|texture| Some(scene.textures.get(texture)?.uv_set));
            let Some(missing) = sets.filter(|&set| set as usize >= mesh.uvs.len()).min() else { continue };
            let name = || placed_label(scene, "mesh", &mesh.name, id.index(), Some(placed.id.index()));
            let material = label("material", &material.name, material_id.index());
            let message = format!(
                "{material} has a texture on UV set {missing}, which the mesh lacks; its colour at (0, 0) is used"
            );
            findings.add("textures on UV sets that meshes lack", name, Diagnostic::warning(message));
        }
    }
}

fn missing_material(mesh: &Mesh) -> Diagnostic {
    let id = mesh.material.map_or(0, |id| id.index());
    Diagnostic::error(format!("names material #{id}, which does not exist"))
}

fn indices(mesh: &Mesh, name: &impl Fn() -> String, findings: &mut Findings) {
    let len = mesh.positions.len();
    let outside = |triangle: &[u32; 3]| triangle.iter().any(|&index| index as usize >= len);
    if let Some((first, triangle)) = mesh.triangles.iter().enumerate().find(|(_, triangle)| outside(triangle))
    {
        let count = mesh.triangles.iter().filter(|triangle| outside(triangle)).count();
        let message =
            format!("triangle {first} names vertices {triangle:?} of {len}{}", others(count, "triangles"));
        findings.add("triangles name vertices that do not exist", name, Diagnostic::error(message));
    }
}

fn attributes(mesh: &Mesh, name: &impl Fn() -> String, findings: &mut Findings) {
    let len = mesh.positions.len();
    let mut see = |what: &str, count: Option<usize>, first_bad: Option<usize>, bad: usize| {
        if let Some(count) = count.filter(|&count| count != len) {
            let message = format!("has {count} {what} for {len} positions");
            findings.add("attributes of the wrong length", name, Diagnostic::error(message));
        }
        if let Some(first) = first_bad {
            let message = format!("{what}[{first}] is not finite{}", others(bad, "of them"));
            findings.add("vertices are not finite", name, Diagnostic::error(message));
        }
    };
    let (first, bad) = non_finite(&mesh.positions, |it| it.is_finite());
    see("positions", None, first, bad);
    if let Some(normals) = &mesh.normals {
        let (first, bad) = non_finite(normals, |it| it.is_finite());
        see("normals", Some(normals.len()), first, bad);
    }
    if let Some(tangents) = &mesh.tangents {
        let (first, bad) = non_finite(tangents, |it| it.is_finite());
        see("tangents", Some(tangents.len()), first, bad);
    }
    for (set, uvs) in mesh.uvs.iter().enumerate() {
        let (first, bad) = non_finite(uvs, |it| it.is_finite());
        see(&format!("uvs[{set}]"), Some(uvs.len()), first, bad);
    }
    if let Some(colors) = &mesh.colors {
        let (first, bad) = non_finite(colors, |it| it.is_finite());
        see("colors", Some(colors.len()), first, bad);
    }
}

/// The first item that is not finite, and how many there are.
fn non_finite<T>(items: &[T], finite: impl Fn(&T) -> bool) -> (Option<usize>, usize) {
    let first = items.iter().position(|item| !finite(item));
    (first, first.map_or(0, |_| items.iter().filter(|item| !finite(item)).count()))
}

fn others(count: usize, of: &str) -> String {
    if count > 1 { format!(", like {} more {of}", count - 1) } else { String::new() }
}
