//! Real files, skipped where they are absent.

use std::path::{Path, PathBuf};

use ajar_importers::obj::Obj;
use ajar_scene::{ImportRequest, Importer};
use glam::Vec3;

use super::{area, close, meshes, warnings};

/// The folder of shared test assets, if there is one on this machine.
fn shared() -> Option<PathBuf> {
    let root = std::env::var_os("AJAR_SHARED").map(PathBuf::from);
    let root = root.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"));
    let assets = root.join("assets");
    if !assets.is_dir() {
        println!("skipped: no shared assets");
        return None;
    }
    Some(assets)
}

#[test]
fn real_files() {
    let Some(assets) = shared() else { return };
    let load = |name: &str| {
        let imported =
            Obj.import(&ImportRequest::new(assets.join(format!("obj/{name}/{name}.obj")))).unwrap();
        let triangles: usize = imported.scene.meshes.iter().map(|m| m.triangles.len()).sum();
        let said = warnings(&imported).join("; ");
        println!("{name}: {triangles} triangles, {} meshes; {said}", imported.scene.meshes.len());
        (imported, triangles, said)
    };
    let (cornell, triangles, said) = load("cornell_box");
    assert_eq!((triangles, cornell.scene.meshes.len(), cornell.scene.materials.len()), (36, 8, 4));
    assert!(cornell.scene.materials.iter().all(|m| m.specular.value == 0.0) && said.is_empty(), "{said}");
    assert_eq!(meshes(&cornell)[1].name, "light/light");
    assert!((area(meshes(&cornell)[1]) - 130.0 * 105.0).abs() < 1.0);

    let (colors, triangles, _) = load("cube-vertexcol");
    assert_eq!(triangles, 12);
    assert!(meshes(&colors).iter().all(|m| m.colors.is_some()));
    let (cubes, triangles, _) = load("hundred_cubes");
    assert_eq!((cubes.scene.meshes.len(), triangles, cubes.scene.materials.len()), (100, 1200, 3));
    let (concave, triangles, said) = load("issue-319-003");
    // Corners in line: the area is that of the outline, computed from its coordinates.
    assert!((7..=8).contains(&triangles) && said.is_empty(), "{triangles}: {said}");
    assert!((area(meshes(&concave)[0]) / OUTLINE_319 - 1.0).abs() < 1e-4, "{}", area(meshes(&concave)[0]));
    let (_, triangles, said) = load("pbr-mat-ext");
    assert_eq!(triangles, 2);
    for lost in ["map_Ps", "norm: \"normalmap.tex\" cannot be read", "map_Ke", "map_Pm", "map_Pr"] {
        assert!(said.contains(lost), "{lost}: {said}");
    }
    assert_eq!(load("single_triangle_negative_indices").1, 1);
    let (smooth, triangles, _) = load("smoothing-normal");
    assert_eq!(triangles, 6);
    let front = meshes(&smooth)[0];
    let edge = front.positions.iter().position(|p| *p == Vec3::new(0.0, 0.0, 2.0)).unwrap();
    let expected = Vec3::new(0.0, -1.0, 1.0).normalize();
    assert!(close(front.normals.as_ref().unwrap()[edge], expected));
    assert!(meshes(&smooth)[1].normals.is_none());
    let (options, _, said) = load("texture-options-issue-85");
    assert!(
        options.scene.textures.is_empty() && said.contains("map_Kd: \"diffuse.jpg\" cannot be read"),
        "{said}"
    );
    for lost in
        ["statement \"Kt\" is dropped", "option -t of map_Ns is dropped", "map_Bump: \"bumpmap.jpg\" cannot"]
    {
        assert!(said.contains(lost), "{lost}: {said}");
    }
    let (both, _, said) = load("tr-and-d-issue-43");
    assert!(said.contains("d and Tr disagree"));
    assert!(both.scene.materials.iter().all(|m| m.opacity.value == 0.75));
    let (changes, ..) = load("usemtl-issue-68");
    assert_eq!((changes.scene.meshes.len(), changes.scene.materials.len()), (2, 2));
}

/// Area of the polygon of `issue-319-003` by the shoelace formula in its own plane.
const OUTLINE_319: f32 = 616.909;

#[test]
fn malformed_real_files() {
    let Some(assets) = shared() else { return };
    for (name, place, part) in [
        ("inf_nan", (1, 3), "not finite"),
        ("issue-140-zero-face-idx", (16, 3), "is no index"),
        ("malformed", (28, 3), "is no index"),
        ("test-nan", (12, 3), "not finite"),
    ] {
        let path = assets.join(format!("malformed/obj_{name}/{name}.obj"));
        let e = Obj.import(&ImportRequest::new(path)).unwrap_err();
        assert!(e.place == Some(place) && e.message.contains(part), "{name}: {e}");
    }
    let path = assets.join("malformed/obj_invalid-face-definition/invalid-face-definition.obj");
    let said = warnings(&Obj.import(&ImportRequest::new(path)).unwrap());
    assert!(
        said.contains(&"faces with fewer than three corners are dropped (and at 1 more place)".to_owned()),
        "{said:?}"
    );
}
