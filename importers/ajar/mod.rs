//! Ajar's own scene files: the scene graph as JSON, with its arrays and images in one binary chunk.
//!
//! `docs/ajar-scene.md` is the specification. Plug-ins write the same on standard output.

mod array;
mod container;
mod form;
mod mesh;
mod write;

use ajar_scene::{Diagnostic, Feature, ImportRequest, Imported, Importer};

use crate::files;

pub use write::write;

/// The importer of `.ajar` files.
pub struct Ajar;

/// What [`Ajar`] supports.
const FEATURES: &[Feature] = &[
    Feature {
        name: "scene graph",
        support: "everything that Ajar can render; polygons and subdivision surfaces",
    },
    Feature { name: "container", support: "JSON with one binary chunk, or JSON alone" },
    Feature { name: "images", support: "embedded, or files below the scene's folder" },
];

impl Importer for Ajar {
    fn name(&self) -> &'static str {
        "ajar"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["ajar"]
    }

    fn sniff(&self, head: &[u8]) -> bool {
        head.starts_with(container::MAGIC)
    }

    fn features(&self) -> &'static [Feature] {
        FEATURES
    }

    fn import(&self, request: &ImportRequest) -> Result<Imported, Diagnostic> {
        let within = || -> Result<Imported, Diagnostic> {
            request.refuse_variants()?;
            let bytes = files::read(&request.path, request.memory_limit)?;
            let mut imported = decode(&bytes, request)?;
            imported.files.insert(0, request.path.clone());
            Ok(imported)
        };
        within().map_err(|mut error| {
            error.file.get_or_insert_with(|| request.path.clone());
            error
        })
    }
}

/// The scene in `bytes`, with the image files that it names.
///
/// # Errors
/// Bytes that are no scene; the element is named.
pub(crate) fn decode(bytes: &[u8], request: &ImportRequest) -> Result<Imported, Diagnostic> {
    let (json, binary) = container::split(bytes)?;
    let mut imported = form::scene(json, binary, request)?;
    for diagnostic in &mut imported.diagnostics {
        diagnostic.file.get_or_insert_with(|| request.path.clone());
    }
    Ok(imported)
}
