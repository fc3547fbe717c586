//! Whether a scene is fit to render, and if not, why not.

mod findings;
mod hierarchy;
mod mesh;
mod parts;

use findings::Findings;

use crate::{Diagnostic, Scene};

impl Scene {
    /// Everything that is wrong with the scene. An error makes it unfit to render; a warning says what will happen
    /// instead. Elements are named by the first visible way down the hierarchy that leads to them,
    /// `node "Lamp"/mesh "Bulb"`. The same complaint is made about three elements at most and then counted.
    pub fn validate(&self) -> Vec<Diagnostic> {
        let mut findings = Findings::default();
        hierarchy::check(self, &mut findings);
        mesh::check(self, &mut findings);
        parts::check(self, &mut findings);
        findings.finish()
    }
}

/// `mesh "Bulb"`, or `mesh #4` without a name.
fn label(kind: &str, name: &str, index: usize) -> String {
    if name.is_empty() { format!("{kind} #{index}") } else { format!("{kind} \"{}\"", name.escape_debug()) }
}

/// `label` of a thing, below the first node that places it.
fn placed_label(scene: &Scene, kind: &str, name: &str, index: usize, node: Option<usize>) -> String {
    let own = label(kind, name, index);
    match node.and_then(|node| scene.nodes.get(crate::Id::new(node)).map(|it| (node, it))) {
        Some((node, it)) => format!("{}/{own}", label("node", &it.name, node)),
        None => own,
    }
}
