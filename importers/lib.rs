//! Asset files into the scene graph: the list of importers and the way in.
//!
//! An importer reads one format and knows no renderer. A new one is a folder beside the others and a row in
//! [`importers`].

pub mod ajar;
mod budget;
mod files;
pub mod gltf;
mod guard;
mod json;
pub mod obj;
pub mod plugin;
mod polygon;
pub mod python;
mod report;
mod srgb;
pub mod usd;

use std::path::Path;

use ajar_scene::{Diagnostic, ImportRequest, Imported, Importer};

/// Bytes at the start of a file that importers may sniff.
const HEAD: u64 = 256;

/// All importers, in the order in which they are asked.
pub fn importers() -> &'static [&'static dyn Importer] {
    &[&ajar::Ajar, &gltf::Gltf, &obj::Obj, &usd::Usd, &plugin::PlugIns]
}

/// The importer for the file at `path`: by its extension, by what plug-ins claim, else by its first bytes.
///
/// # Errors
/// The extension is unknown and the file cannot be read or looks like no known format, or a plug-in cannot be asked.
pub fn find(path: &Path) -> Result<&'static dyn Importer, Diagnostic> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    if let Some(importer) = importers().iter().find(|i| i.extensions().contains(&extension.as_str())) {
        return Ok(*importer);
    }
    let head = files::head(path, HEAD)?;
    if plugin::claimant(path, &head)?.is_some() {
        return Ok(&plugin::PlugIns);
    }
    importers().iter().find(|i| i.sniff(&head)).copied().ok_or_else(|| unknown(path))
}

fn unknown(path: &Path) -> Diagnostic {
    let known: Vec<_> = importers().iter().flat_map(|i| i.extensions()).map(|e| format!(".{e}")).collect();
    Diagnostic::error("is of no known format")
        .in_file(path)
        .hint(format!("known extensions are {}", known.join(", ")))
}

/// Reads the file with the importer that [`find`] names.
///
/// # Errors
/// What [`find`] and the importer return, and a diagnostic for an importer that panics.
pub fn import(request: &ImportRequest) -> Result<Imported, Diagnostic> {
    let importer = find(&request.path)?;
    guard::catch(|| importer.import(request)).unwrap_or_else(|message| {
        Err(Diagnostic::error(format!("the {} importer failed: {message}", importer.name()))
            .in_file(&request.path)
            .hint("this is a defect of the importer, please report it with the file"))
    })
}
