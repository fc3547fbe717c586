//! Vertices, faces, groups, normals, encodings.

use ajar_importers::obj::Obj;
use ajar_scene::Importer;
use glam::{Vec2, Vec3};

use super::{ROOF, area, close, geometry, import, meshes, warnings};

#[test]
fn a_file_becomes_root_groups_and_meshes() {
    let imported = geometry(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no A\ng x  y\nf 1 2 3\nusemtl red\nf 3 2 1\ng\nf 1 2 3\ng x y\nf 1 2 3\n",
    );
    let names: Vec<_> = meshes(&imported).iter().map(|m| (m.name.as_str(), m.triangles.len())).collect();
    assert_eq!(names, [("default", 1), ("A/x y", 1), ("A/x y/red", 2), ("A/red", 1)]);
    let nodes: Vec<_> =
        imported.scene.placed().iter().map(|p| (p.node.name.clone(), p.depth, p.node.meshes.len())).collect();
    let expected = [("main", 0, 0), ("default", 1, 1), ("A/x y", 1, 2), ("A", 1, 1)];
    assert_eq!(nodes, expected.map(|(name, depth, meshes)| (name.to_owned(), depth, meshes)));
    assert_eq!(warnings(&imported), ["material \"red\" is in no library; the default is used"]);
}

#[test]
fn indices_count_from_both_ends_and_forward() {
    let imported = geometry("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf -4/ -3// -1\n");
    let mesh = meshes(&imported)[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3]]);
    assert_eq!(mesh.positions[3], Vec3::Z);
    assert!(mesh.normals.is_none() && mesh.uvs.is_empty() && mesh.colors.is_none());
}

#[test]
fn v_of_texture_coordinates_is_flipped_once() {
    let imported = geometry("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.75\nvt .5\nf 1/1 2/2 3\n");
    assert_eq!(meshes(&imported)[0].uvs, [[Vec2::new(0.25, 0.25), Vec2::new(0.5, 1.0), Vec2::new(0.0, 1.0)]]);
    assert!(warnings(&imported)[0].contains("taken as (0, 0)"));
}

#[test]
fn vertices_are_joined_unless_an_attribute_differs() {
    let text =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/1 3/1 4/1\nf 1/2 3/1 4/1\n";
    assert_eq!(meshes(&geometry(text))[0].positions.len(), 5);
}

#[test]
fn concave_polygons_keep_their_area() {
    // An L of area 3; the fan from its first corner would have area 4 or more.
    let imported = geometry("v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nf 1 2 3 4 5 6\n");
    let mesh = meshes(&imported)[0];
    assert_eq!(mesh.triangles.len(), 4);
    assert!((area(mesh) - 3.0).abs() < 1e-6);
    assert!(warnings(&imported).is_empty());
}

#[test]
fn smoothing_groups_smooth_inside_and_not_across() {
    let smooth = geometry(&format!("{ROOF}s 7\nf 1 2 4 3\nf 3 4 6 5\n"));
    let mesh = meshes(&smooth)[0];
    assert_eq!(mesh.positions.len(), 6);
    let normals = mesh.normals.as_ref().unwrap();
    for (position, normal) in mesh.positions.iter().zip(normals) {
        let side = (position.x - 1.0) / 2.0_f32.sqrt();
        let expected = if side == 0.0 { Vec3::Y } else { Vec3::new(side, 0.5_f32.sqrt(), 0.0) };
        assert!(close(*normal, expected), "{position}: {normal}");
    }
    let split = geometry(&format!("{ROOF}s 1\nf 1 2 4 3\ns 2\nf 3 4 6 5\n"));
    let mesh = meshes(&split)[0];
    assert_eq!(mesh.positions.len(), 8);
    assert!(mesh.normals.as_ref().unwrap().iter().all(|n| (n.y - 0.5_f32.sqrt()).abs() < 1e-6));
    let half = geometry(&format!("{ROOF}s 1\nf 1 2 4 3\ns off\nf 3 4 6 5\n"));
    assert_eq!(meshes(&half)[0].positions.len(), 8);
    for flat in ["s off", "s 0", ""] {
        let flat = geometry(&format!("{ROOF}{flat}\nf 1 2 4 3\nf 3 4 6 5\n"));
        assert!(meshes(&flat)[0].normals.is_none() && meshes(&flat)[0].positions.len() == 6);
    }
}

#[test]
fn smoothing_does_not_depend_on_how_polygons_are_cut_and_crosses_materials() {
    // A cube's corner: each face weighs the same, whether a square or two triangles.
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\ns 1\n";
    let imported = geometry(&format!("{cube}f 5 6 7 8\nusemtl b\nf 2 3 7\nf 2 7 6\nf 4 8 7 3\n"));
    for mesh in meshes(&imported) {
        let corner = mesh.positions.iter().position(|p| *p == Vec3::ONE).unwrap();
        assert!(close(mesh.normals.as_ref().unwrap()[corner], Vec3::ONE.normalize()));
    }
}

#[test]
fn written_normals_win_and_are_normalized() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nvn 0 0 0\ns 1\nf 1//1 2//2 3\n";
    let imported = geometry(text);
    let normals = meshes(&imported)[0].normals.clone().unwrap();
    assert!(close(normals[0], Vec3::new(0.0, 0.6, 0.8)) && normals[1] == Vec3::Z && normals[2] == Vec3::Z);
}

#[test]
fn vertex_colours_are_decoded() {
    let imported = geometry("v 0 0 0\nv 1 0 0 0.5 1 0\nv 0 1 0 2 0 0\nf 1 2 3\n");
    let colors = meshes(&imported)[0].colors.clone().unwrap();
    assert_eq!(colors[0].truncate(), Vec3::ONE);
    assert!(close(colors[1].truncate(), Vec3::new(0.214_041_14, 1.0, 0.0)) && colors[1].w == 1.0);
    assert_eq!(colors[2].truncate(), Vec3::X);
}

#[test]
fn what_is_dropped_is_said_once() {
    let imported = geometry(
        "v 0 0 0\nv 1 0 0\nv 0 1 0 0.5\nl 1 2\nl 2 3\np 1\nf 1 2 3\nf 1 2\nf 1 1 2\nbevel on\nf 1 2 3 1 2 3\n",
    );
    assert_eq!(
        warnings(&imported),
        [
            "numbers after the coordinates of a vertex are neither w = 1 nor r g b; dropped",
            "lines are dropped (`l`) (and at 1 more place)",
            "points are dropped (`p`)",
            "faces with fewer than three corners are dropped",
            "statement \"bevel\" is not supported and dropped",
            "faces without area are dropped",
            "a polygon crosses itself or is too intricate; its triangles may overlap",
        ]
    );
    assert_eq!(imported.diagnostics[2].place, Some((4, 1)));
}

#[test]
fn encodings_and_line_ends() {
    let triangle = "v 0 0 0 # comment\r\nv 1 \\\r\n 0 0\r\n# C:\\folder\\\r\nv 0 1 0\r\nf 1 2 3\r\n";
    for text in [triangle.to_owned(), triangle.replace("\r\n", "\r"), format!("\u{feff}{triangle}")] {
        assert_eq!(meshes(&geometry(&text))[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    }
    let marked = format!("\u{feff}{triangle}");
    for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let mut wide: Vec<u8> = marked.encode_utf16().flat_map(to_bytes).collect();
        let imported = import(&[("main.obj", &wide)]).unwrap();
        assert_eq!(meshes(&imported)[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
        wide.extend(to_bytes(0xd800));
        let error = import(&[("main.obj", &wide)]).unwrap_err();
        assert!(error.message.contains("broken UTF-16"), "{error}");
    }
    // Names meet in whatever encoding both files share.
    let latin = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl caf\xe9\nf 1 2 3\n";
    let latin = import(&[("main.obj", latin), ("a.mtl", b"newmtl caf\xe9\nKd 1 0 0\n")]).unwrap();
    assert_eq!(latin.scene.materials.iter().next().unwrap().name, "caf\u{e9}");
    assert!(warnings(&latin).is_empty() && latin.diagnostics.iter().any(|d| d.message.contains("Latin-1")));
}

#[test]
fn sniffing() {
    for head in ["# x\nv 1 2 3\n", "\r\nmtllib a.mtl", "# Exported OBJ File\n#"] {
        assert!(Obj.sniff(head.as_bytes()), "{head}");
    }
    for head in ["glTF\u{2}", "#usda 1.0\ndef Xform", "{\"asset\":", "ply\nformat"] {
        assert!(!Obj.sniff(head.as_bytes()), "{head}");
    }
}
