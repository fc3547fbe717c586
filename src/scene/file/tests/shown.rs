//! `[material]` by the path where materials are shown.

use super::{import, right, wrong};
use crate::{
    Imported, Material, Node, Overrides, Scene,
    file::{load_asset, shown},
};

const TWO: &str = "[[import]]\nfile = \"a.glb\"\n[[import]]\nfile = \"b.glb\"\n";

/// What the meshes show at each place, in the order of nodes.
fn shown(scene: &Scene) -> Vec<(String, f32)> {
    let mut found = Vec::new();
    scene.paths(|placed, path| {
        for &mesh in &placed.node.meshes {
            let material = placed.node.material.or(scene.meshes[mesh].material).unwrap();
            found.push((path.to_owned(), scene.materials[material].ior));
        }
    });
    found
}

fn changed(pattern: &str) -> Vec<bool> {
    let file = right(&format!("{TWO}[material.\"{pattern}\"]\nior = 2\n"), &["a.glb", "b.glb"]);
    shown(&file.scene).iter().map(|(_, ior)| *ior == 2.0).collect()
}

#[test]
fn patterns_with_a_slash_are_paths() {
    for (pattern, places) in [
        ("Chrome", [true, true]),
        ("a/part/Chrome", [true, false]),
        ("b/*", [false, true]),
        ("*/part/Chr?me", [true, true]),
        ("/part/Chrome", [true, true]),
        ("/b/part/*", [false, true]),
    ] {
        assert_eq!(changed(pattern), places, "{pattern}");
    }
}

/// One material, shown by two nodes that share a mesh and by a third that has it among others.
fn shared() -> Scene {
    let mut scene = import(&crate::ImportRequest::new("a.glb")).unwrap().scene;
    let [chrome, glass]: [_; 2] = scene.materials.ids().collect::<Vec<_>>().try_into().unwrap();
    let mesh = scene.meshes.ids().next().unwrap();
    let uvs = vec![vec![glam::Vec2::ZERO; 3]];
    let window = crate::Mesh { uvs, material: Some(glass), ..scene.meshes[mesh].clone() };
    let window = scene.meshes.push(window);
    scene.add_root(Node { name: "other".into(), meshes: vec![mesh], ..Node::default() });
    let mixed = vec![mesh, window, mesh];
    scene.add_root(Node { name: "mixed".into(), meshes: mixed, ..Node::default() });
    assert_eq!(scene.meshes[mesh].material, Some(chrome));
    scene
}

fn edited(changes: &[&str]) -> Scene {
    let imported = Imported { scene: shared(), ..Imported::default() };
    let overrides = Overrides::parse(changes).unwrap();
    load_asset(&crate::ImportRequest::new("a.glb"), &overrides, imported).unwrap().scene
}

#[test]
fn materials_have_paths_in_their_own_files() {
    for (pattern, found) in [("/World/Looks/Chrome", 1), ("/Looks/*", 1), ("/World/Car/*", 0)] {
        let mut scene = shared();
        scene.materials.iter_mut().next().unwrap().path = "/World/Looks/Chrome".into();
        assert_eq!(shown::fitting(pattern, &mut scene).len(), found, "{pattern}");
        assert_eq!(scene.materials.len(), 2, "nothing is split");
    }
}

#[test]
fn materials_that_are_shown_elsewhere_are_split() {
    let scene = edited(&["material.'other/*'.ior=2"]);
    assert_eq!(shown(&scene).iter().map(|it| it.1).collect::<Vec<_>>(), [1.5, 2.0, 1.5, 1.5, 1.5]);
    assert_eq!(scene.materials.iter().filter(|it| it.name == "Chrome").count(), 2);

    // Two of three meshes of a node show it: they move into nodes below.
    let scene = edited(&["material.'mixed/Chrome'.ior=2"]);
    let places = shown(&scene);
    assert_eq!(places.iter().filter(|(_, ior)| *ior == 2.0).count(), 2, "{places:?}");
    assert!(places.iter().all(|(path, ior)| *ior == 1.5 || path.starts_with("mixed/")), "{places:?}");
    assert_eq!(scene.validate(), []);

    // By name, both halves change again; what fits everywhere is not split.
    let scene = edited(&["material.'other/*'.ior=2", "material.Chrome.ior=3"]);
    assert!(shown(&scene).iter().all(|(path, ior)| *ior == 3.0 || path == "mixed"));
    assert_eq!(edited(&["material.'*/Chrome'.ior=2"]).materials.len(), 2);
}

#[test]
fn paths_that_fit_nothing_are_named() {
    let errors = wrong(&format!("{TWO}[material.\"/World/Looks/Chrom\"]\n"), &["a.glb", "b.glb"]);
    let says = "no import shows a material at this path\n  hint: did you mean \"Chrome\"?";
    assert!(errors[0].ends_with(says), "{errors:?}");
    let file = right(&format!("{TWO}[material.\"c/*\"]\nior = 2\n"), &["a.glb", "b.glb"]);
    assert!(file.diagnostics.iter().any(|it| it.message == "no imported material fits this pattern"));
    let unseen: Vec<&Material> = file.scene.materials.iter().filter(|it| it.ior == 2.0).collect();
    assert!(unseen.is_empty());
}
