//! The OBJ importer on small files of its own, on real files, and on damaged ones.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

mod assets;
mod geometry;
mod hostile;
mod maps;
mod materials;

use std::fs;

use ajar_importers::obj::Obj;
use ajar_scene::{Diagnostic, ImportRequest, Imported, Importer, Material, Mesh, Severity};
use glam::Vec3;

/// Imports `main.obj` from a folder with these files.
fn import(files: &[(&str, &[u8])]) -> Result<Imported, Diagnostic> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    Obj.import(&ImportRequest::new(folder.path().join("main.obj")))
}

fn geometry(text: &str) -> Imported {
    import(&[("main.obj", text.as_bytes())]).unwrap()
}

fn failure(text: &str) -> Diagnostic {
    import(&[("main.obj", text.as_bytes())]).unwrap_err()
}

/// A triangle of one material `m` with these statements, beside images `a.png`, `b c.png` and `rock_normal.png`.
fn material(statements: &str) -> (Material, Imported) {
    let imported = import(&[
        ("main.obj", b"mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("m.mtl", format!("newmtl m\n{statements}\n").as_bytes()),
        ("a.png", b""),
        ("b c.png", b""),
        ("rock_normal.png", b""),
    ])
    .unwrap();
    assert_eq!(imported.scene.materials.len(), 1);
    (imported.scene.materials.iter().next().unwrap().clone(), imported)
}

fn meshes(imported: &Imported) -> Vec<&Mesh> {
    imported.scene.meshes.iter().collect()
}

/// Messages of warnings; every import must hold the note about units and nothing worse than a warning.
fn warnings(imported: &Imported) -> Vec<String> {
    assert!(imported.diagnostics.iter().any(|d| d.message.starts_with("OBJ states no units")));
    assert!(imported.diagnostics.iter().all(|d| d.severity < Severity::Error));
    let warnings = imported.diagnostics.iter().filter(|d| d.severity == Severity::Warning);
    warnings.map(|d| d.message.clone()).collect()
}

fn close(a: Vec3, b: Vec3) -> bool {
    a.abs_diff_eq(b, 1e-5)
}

/// The sum of the triangles' areas.
fn area(mesh: &Mesh) -> f32 {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).length() / 2.0
    };
    mesh.triangles.iter().map(area).sum()
}

/// Two slopes that meet in the edge of vertices 3 and 4.
const ROOF: &str = "v 0 0 0\nv 0 0 1\nv 1 1 0\nv 1 1 1\nv 2 0 0\nv 2 0 1\n";
