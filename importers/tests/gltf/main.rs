//! The glTF importer on small files made here, on real files, and on damaged ones.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test may panic, also in what its functions share, and says what it skips"
)]

mod assets;
mod attributes;
mod build;
mod compressed;
mod deform;
mod documents;
mod draco;
mod effects;
mod geometry;
mod hostile;
mod layers;
mod lights;
mod materials;
mod motion;
mod nodes;
mod not_finite;
mod surroundings;
mod variants;

use ajar_scene::{Diagnostic, Imported, Mesh, Severity};

use build::Asset;

/// The only mesh of a file that must be imported.
fn only_mesh(asset: &Asset) -> Mesh {
    let imported = asset.import().unwrap();
    assert_eq!(imported.scene.meshes.len(), 1, "{:?}", imported.diagnostics);
    imported.scene.meshes.iter().next().unwrap().clone()
}

/// `element: message` of all diagnostics of at least this severity.
fn messages(imported: &Imported, least: Severity) -> Vec<String> {
    let worth = imported.diagnostics.iter().filter(|d| d.severity >= least);
    worth.map(|d| format!("{}: {}", d.element.as_deref().unwrap_or("-"), d.message)).collect()
}

fn warnings(imported: &Imported) -> Vec<String> {
    messages(imported, Severity::Warning)
}

/// Element and message of the error that the file must cause.
fn failure(asset: &Asset) -> (String, String) {
    let error = asset.import().map(|_| ()).unwrap_err();
    assert_eq!(error.severity, Severity::Error);
    assert!(error.file.is_some(), "no file in {error}");
    parts(error)
}

fn parts(error: Diagnostic) -> (String, String) {
    (error.element.unwrap_or_default(), error.message)
}
