//! Joining scenes.

use crate::sample;
use ajar_scene::*;

#[test]
fn append_keeps_meaning() {
    let mut scene = sample();
    let roots = scene.append(sample());
    assert_eq!(roots.iter().map(|id| id.index()).collect::<Vec<_>>(), [4, 5]);
    assert_eq!(scene.roots.len(), 2);
    scene.roots.extend(roots);
    assert!(scene.validate().is_empty(), "{:?}", scene.validate());

    // Taken alone, the second half is the sample again.
    let second = |index: usize| index >= 3;
    assert!(scene.nodes.iter().skip(3).flat_map(|node| &node.children).all(|id| second(id.index())));
    let placed = scene.placed();
    let names: Vec<_> = placed.iter().map(|it| it.node.name.as_str()).collect();
    assert_eq!(names, ["World", "Lamp", "View", "World", "Lamp", "View"]);
    let lamp = placed[4].node;
    assert_eq!((lamp.meshes[0].index(), lamp.material.unwrap().index()), (1, 1));
    assert_eq!(placed[5].node.camera.unwrap().index(), 1);
    assert_eq!(scene.materials[Id::new(1)].textures().map(|id| id.index()).collect::<Vec<_>>(), [1, 1]);
    assert_eq!(scene.textures[Id::new(1)].image.index(), 1);
}

/// What dangles may not come to point at what is appended later.
#[test]
fn dangling_handles_stay_dangling() {
    let mut broken = sample();
    broken.nodes[Id::new(0)].meshes = vec![Id::new(1), Id::new(u32::MAX as usize)];
    let mut scene = Scene::default();
    scene.append(broken);
    scene.append(sample());
    let ids: Vec<_> =
        scene.nodes[Id::new(0)].meshes.iter().map(|&id| scene.meshes.get(id).is_some()).collect();
    assert_eq!(ids, [false, false]);
}

#[test]
fn appending_to_nothing_changes_nothing() {
    let mut scene = Scene::default();
    scene.roots = scene.append(sample());
    assert_eq!(scene, sample());
}
