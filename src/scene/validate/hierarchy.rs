//! Nodes: a forest of finite transforms whose handles lead somewhere.

use super::{Findings, label};
use crate::{Diagnostic, Id, Node, Scene, scene::is_singular};

pub(super) fn check(scene: &Scene, findings: &mut Findings) {
    for (index, node) in scene.nodes.iter().enumerate() {
        let name = || label("node", &node.name, index);
        transform(node, &name, findings);
        let dangling = [
            ("child", first_dangling(&node.children, scene.nodes.len())),
            ("mesh", first_dangling(&node.meshes, scene.meshes.len())),
            ("material", first_dangling(node.material.as_slice(), scene.materials.len())),
            ("light", first_dangling(node.light.as_slice(), scene.lights.len())),
            ("camera", first_dangling(node.camera.as_slice(), scene.cameras.len())),
        ];
        for (kind, id) in dangling {
            if let Some(id) = id {
                let message = format!("names {kind} #{id}, which does not exist");
                findings.add("nodes name what does not exist", name, Diagnostic::error(message));
            }
        }
    }
    if let Some(id) = first_dangling(&scene.roots, scene.nodes.len()) {
        let message = format!("name node #{id}, which does not exist");
        findings.add("roots name what does not exist", || "roots".into(), Diagnostic::error(message));
    }
    parents(scene, findings);
    cycles(scene, findings);
}

fn first_dangling<T>(ids: &[Id<T>], len: usize) -> Option<usize> {
    ids.iter().map(|id| id.index()).find(|&index| index >= len)
}

fn transform(node: &Node, name: &impl Fn() -> String, findings: &mut Findings) {
    if !node.transform.is_finite() {
        let message = "the transform is not finite";
        findings.add("transforms are not finite", name, Diagnostic::error(message));
    } else if is_singular(&node.transform) {
        let message = "the transform flattens space; meshes and lights here and below are hidden";
        findings.add("transforms flatten space", name, Diagnostic::warning(message));
    }
}

fn parents(scene: &Scene, findings: &mut Findings) {
    let mut count = vec![0_usize; scene.nodes.len()];
    let children = scene.nodes.iter().flat_map(|node| &node.children);
    for id in children.chain(&scene.roots) {
        if let Some(count) = count.get_mut(id.index()) {
            *count += 1;
        }
    }
    for (index, (node, count)) in scene.nodes.iter().zip(count).enumerate() {
        if count > 1 {
            let message = format!("is named {count} times as child or root; a node has one parent");
            let name = || label("node", &node.name, index);
            findings.add("nodes have more than one parent", name, Diagnostic::error(message));
        }
    }
}

/// Depth-first search with an explicit stack; an edge back to a node that is still open closes a cycle.
fn cycles(scene: &Scene, findings: &mut Findings) {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        Open,
        Done,
    }
    let mut state = vec![State::New; scene.nodes.len()];
    for start in scene.nodes.ids() {
        let mut stack = vec![(start, 0)];
        while let Some((id, next)) = stack.pop() {
            let (Some(node), Some(mine)) = (scene.nodes.get(id), state.get_mut(id.index())) else { continue };
            if next == 0 {
                match *mine {
                    State::New => *mine = State::Open,
                    State::Open => {
                        let name = || label("node", &node.name, id.index());
                        let message = Diagnostic::error("is its own ancestor");
                        findings.add("nodes are their own ancestors", name, message);
                        continue;
                    }
                    State::Done => continue,
                }
            }
            match node.children.get(next) {
                Some(&child) => stack.extend([(id, next + 1), (child, 0)]),
                None => *mine = State::Done,
            }
        }
    }
}
