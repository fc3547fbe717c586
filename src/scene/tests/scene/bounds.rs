//! Bounds, and the camera and light of scenes that have none.

use glam::{DAffine3, DVec3, Vec3};

use crate::sample;
use ajar_scene::*;

fn triangle(offset: f32) -> Mesh {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 2.0, 3.0), Vec3::splat(1e6), Vec3::NAN];
    Mesh {
        positions: positions.map(|p| p + offset).to_vec(),
        triangles: vec![[0, 1, 2], [0, 1, 4], [0, 1, 99]],
        ..Mesh::default()
    }
}

#[test]
fn bounds_hold_visible_triangles() {
    let mut scene = Scene::default();
    assert_eq!(scene.bounds(), None);
    let mesh = scene.meshes.push(triangle(0.0));
    scene.add_root(Node { meshes: vec![mesh], visible: false, ..Node::default() });
    let flat = DAffine3::from_scale(DVec3::new(9.0, 0.0, 9.0));
    scene.add_root(Node { meshes: vec![mesh], transform: flat, ..Node::default() });
    assert_eq!(scene.bounds(), None);
    let turn = DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0));
    let child = scene.nodes.push(Node { meshes: vec![mesh], transform: turn, ..Node::default() });
    let moved = DAffine3::from_translation(DVec3::new(0.0, 0.0, 10.0));
    scene.add_root(Node { children: vec![child], transform: moved, ..Node::default() });
    assert_eq!(scene.bounds(), Some((DVec3::new(-2.0, 0.0, 10.0), DVec3::new(0.0, 2.0, 13.0))));
}

/// Every corner of the bounds falls inside the image, and the outermost near its edge.
#[test]
fn framing_camera_sees_the_bounds() {
    for (aspect, size) in [(1.0, 1.0), (16.0 / 9.0, 1e-3), (0.4, 1e4)] {
        let mut scene = Scene::default();
        let mesh = scene.meshes.push(triangle(0.0));
        let transform = DAffine3::from_scale(DVec3::splat(size));
        scene.add_root(Node { meshes: vec![mesh], transform, ..Node::default() });
        let (low, high) = scene.bounds().unwrap();
        let (center, radius) = ((low + high) / 2.0, low.distance(high) / 2.0);
        let (camera, place) = framing_camera(&scene, aspect);
        let Projection::Perspective { yfov, focus_distance, .. } = camera.projection else { panic!() };
        assert!((f64::from(yfov).to_degrees() - 40.0).abs() < 1e-5);
        let view = place.inverse();
        let seen = view.transform_point3(center);
        assert!(
            seen.truncate().length() < 1e-9 * radius
                && (seen.z + f64::from(focus_distance)).abs() < 1e-5 * radius
        );
        let half = (f64::from(yfov) / 2.0).tan();
        let mut most: f64 = 0.0;
        for i in 0..8 {
            let corner = [0, 1, 2].map(|axis| if i >> axis & 1 > 0 { high[axis] } else { low[axis] });
            let p = view.transform_point3(corner.into());
            most = most.max((p.x / -p.z / (half * aspect)).abs()).max((p.y / -p.z / half).abs());
        }
        assert!((most - 0.9).abs() < 1e-6, "{aspect} {most}");
        // In front, to the right, above, upright.
        let from = place.translation - center;
        assert!(from.z > from.x && from.x > 0.0 && from.y > 0.0);
        assert!(
            place.transform_vector3(DVec3::X).y.abs() < 1e-12 && place.transform_vector3(DVec3::Y).y > 0.0
        );
    }
}

#[test]
fn defaults_are_added_once() {
    let mut scene = Scene::default();
    let camera = scene.add_default_camera(1.5).unwrap();
    assert_eq!(camera.to_string(), "note: the scene has no camera, added one that sees all of it");
    let light = scene.add_default_light().unwrap();
    assert_eq!(light.to_string(), "note: the scene has no light, added a grey studio with a soft key light");
    assert_eq!((scene.add_default_camera(1.5), scene.add_default_light()), (None, None));
    assert!(scene.validate().is_empty(), "{:?}", scene.validate());
    assert_eq!((scene.roots.len(), scene.cameras.len(), scene.lights.len()), (3, 1, 2));
    assert!(matches!(scene.lights[Id::new(0)].kind, LightKind::Environment { texture: Some(_), .. }));
}

#[test]
fn light_is_what_can_be_seen() {
    let mut scene = sample();
    assert!(scene.has_light() && scene.has_camera());
    scene.nodes[Id::new(1)].visible = false;
    assert!(!scene.has_light(), "hidden lights do not count");
    scene.nodes[Id::new(1)].visible = true;
    scene.nodes[Id::new(1)].light = None;
    assert!(!scene.has_light());
    let glow =
        scene.materials.push(Material { emission: Input::constant(2.0 * Vec3::X), ..Material::default() });
    assert!(!scene.has_light(), "materials without a mesh do not count");
    scene.nodes[Id::new(0)].material = Some(glow);
    assert!(scene.has_light());
    scene.meshes[Id::new(0)].positions.push(Vec3::splat(10.0));
    scene.meshes[Id::new(0)].triangles.push([0, 3, 3]);
    assert!(!scene.has_light(), "a filament lights nothing");
    scene.materials[glow].emission.value *= 1000.0;
    assert!(scene.has_light(), "but a bright one");
    scene.materials[glow] = Material { unlit: true, ..Material::default() };
    assert!(!scene.has_light(), "unlit things light nothing");
    scene.materials[glow] = Material { emission: Input::constant(Vec3::X), ..Material::default() };
    assert!(!scene.has_light(), "labels light nothing");
}
