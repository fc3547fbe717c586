//! Errors with their places; damaged and hostile files.

use std::{
    fs,
    time::{Duration, Instant},
};

use ajar_importers::obj::Obj;
use ajar_scene::{ImportRequest, Importer, Severity};
use glam::Vec3;

use super::{ROOF, failure, geometry, warnings};

#[test]
fn errors_name_line_and_column() {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (text, place, part) in [
        ("v 0 0 0\nv 1 nan 0\n", (2, 5), "not finite"),
        ("v 1e39 0 0\n", (1, 3), "not finite"),
        ("v 1 2\n", (1, 1), "needs 3 numbers"),
        ("v 1 2 x\n", (1, 7), "not a number"),
        (&format!("{v}f 1 0 3\n"), (4, 5), "\"0\" is no index"),
        (&format!("{v}f 1 2/a 3\n"), (4, 7), "is not an index"),
        (&format!("{v}f 1 2 /3\n"), (4, 7), "not a corner"),
        (&format!("{v}vt 0 0\nvn 0 0 1\nf 1 2 3/1/1/1\n"), (6, 7), "not a corner"),
        (&format!("{v}f 1 2 -4\n"), (4, 7), "before the first"),
        (&format!("{v}\nf 1 2 4\n"), (5, 1), "vertex 4, the file has 3"),
        (&format!("{v}f 1/1 2/1 3/1\n"), (4, 1), "texture coordinate 1, the file has 0"),
        (&format!("{v}f 1 2 99999999999\n"), (4, 7), "larger"),
    ] {
        let e = failure(text);
        assert_eq!((e.place, e.severity), (Some(place), Severity::Error), "{text}: {e}");
        assert!(e.message.contains(part) && e.file.is_some(), "{text}: {e}");
    }
    assert!(failure("{\"asset\": 1}").message.contains("no OBJ statement"));
    assert!(warnings(&geometry("v 0 0 0\n")).contains(&"holds no faces".to_owned()));
}

#[test]
fn the_memory_limit_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("main.obj");
    fs::write(&path, format!("v 0 0 0\nf{}\n", " 1".repeat(10_000))).unwrap();
    let request = |memory_limit| ImportRequest { memory_limit, ..ImportRequest::new(&path) };
    assert!(
        Obj.import(&request(10_000)).unwrap_err().message.contains("bytes are more than the memory limit")
    );
    assert!(Obj.import(&request(1_000_000)).unwrap_err().message.contains("more than the memory limit"));
    assert!(Obj.import(&request(10_000_000)).is_ok());
}

#[test]
fn damaged_files_end_without_panic() {
    let obj = format!(
        "mtllib m.mtl\n{ROOF}vt 0 0\nvt 1 0 0\nvn 0 0 1\no a\ng b\ns 1\nusemtl m\nf 1/1/1 2/2/1 4/1 3\ns off\nf -1 -2 -3 1 2\n"
    );
    let mtl = "newmtl m\nKd 1 0 0\nNs 10\nd 0.5\nmap_Kd -s 1 1 1 -o 0 a.png\nPr 0.5\nKe 1 1 1\nillum 2\nTf .1\nnewmtl n\nKs 1\n";
    let folder = tempfile::tempdir().unwrap();
    let [obj_path, mtl_path] = ["main.obj", "m.mtl"].map(|name| folder.path().join(name));
    let junk: [&[u8]; 12] =
        [b"-", b"/", b" ", b"\n", b"\\\n", b"0", b"9999999999", b"nan", b"1e38", b"\xff", b"f ", b"#"];
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (start, mut imported) = (Instant::now(), 0);
    fs::write(&mtl_path, mtl).unwrap();
    for round in 0..2000 {
        // First the geometry is damaged; then it is whole again, and the library is.
        if round == 1200 {
            fs::write(&obj_path, &obj).unwrap();
        }
        let (whole, path) = if round < 1200 { (obj.as_str(), &obj_path) } else { (mtl, &mtl_path) };
        let mut text = whole.as_bytes().to_vec();
        for _ in 0..=random(4) {
            let (from, word) = (random(text.len()), junk[random(junk.len())]);
            let to = (from + random(4)).min(text.len());
            text.splice(from..to, word.iter().copied());
        }
        fs::write(path, &text).unwrap();
        if let Ok(result) = Obj.import(&ImportRequest::new(&obj_path)) {
            imported += 1;
            for mesh in result.scene.meshes.iter() {
                assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
                let unit = |n: &Vec3| (n.length() - 1.0).abs() < 1e-3;
                assert!(mesh.normals.iter().flatten().all(unit), "{:?}", mesh.normals);
                assert!(mesh.positions.iter().all(|p| p.is_finite()));
            }
            for m in result.scene.materials.iter() {
                assert!(
                    m.base_color.value.is_finite()
                        && m.emission.value.is_finite()
                        && m.roughness.value.is_finite()
                );
            }
        }
    }
    assert!(imported > 500, "the damage leaves too little to test: {imported}");
    assert!(start.elapsed() < Duration::from_secs(60), "no damaged file may hang");
}

#[test]
fn hostile_sizes_end() {
    let start = Instant::now();
    let many: String =
        (0..200_000).map(|i| format!("v {} {} 0\n", (i * 7919) % 100_003, (i * 31) % 99_991)).collect();
    let face: String = (1..=200_000).map(|i| format!(" {i}")).collect();
    assert!(warnings(&geometry(&format!("{many}f{face}\n")))[0].contains("crosses itself"));
    let keywords: String = (0..5000).map(|i| format!("x{i}\n")).collect();
    assert!(warnings(&geometry(&format!("v 0 0 0\n{keywords}"))).len() <= 102);
    assert!(start.elapsed() < Duration::from_secs(60), "hostile files may not hang");
}
