//! Ajar scenes: written and read again, written by hand, and damaged.

#![expect(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a test may fail by panic and says what it skips"
)]

mod damaged;
mod polygons;
mod round_trip;

use std::fs;

use ajar_importers::ajar::Ajar;
use ajar_scene::{Diagnostic, ImportRequest, Imported, Importer};
use serde_json::Value;

/// Imports `scene.ajar` of these bytes.
fn import(bytes: &[u8]) -> Result<Imported, Diagnostic> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ajar");
    fs::write(&path, bytes).unwrap();
    Ajar.import(&ImportRequest { memory_limit: 1 << 28, ..ImportRequest::new(path) })
}

/// Imports a scene that is JSON alone.
fn import_json(scene: &Value) -> Result<Imported, Diagnostic> {
    import(scene.to_string().as_bytes())
}

/// Element and message of the error that a scene must cause.
fn failure(scene: &Value) -> (String, String) {
    let error = import_json(scene).map(|_| ()).unwrap_err();
    (error.element.unwrap_or_default(), error.message)
}
