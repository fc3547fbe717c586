//! The USD importer with its Python, on small stages of its own, on real files, and on hostile ones.
//!
//! Runs where `AJAR_USD_PYTHON` names a Python that has the packages; nothing is installed for tests.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

mod assets;
mod composition;
mod geometry;
mod hostile;
mod lights;
mod materials;
mod skinning;

use std::fs;

use ajar_importers::usd::Usd;
use ajar_scene::{Choice, Diagnostic, ImportRequest, Imported, Importer, Moment, Severity};

/// Whether the importer can run; says that a test is skipped if not.
fn can_run() -> bool {
    let can = std::env::var_os("AJAR_USD_PYTHON").is_some_and(|python| !python.is_empty());
    if !can {
        println!("skipped: AJAR_USD_PYTHON is not set");
    }
    can
}

/// Files in a folder of their own, and what is asked of `main.usda`.
struct Stage {
    folder: tempfile::TempDir,
    request: ImportRequest,
}

impl Stage {
    /// A stage in metres with these prims, +Y up.
    fn new(prims: &str) -> Self {
        Self::whole(&format!("#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n{prims}"))
    }

    fn whole(text: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("main.usda"), lines(text)).unwrap();
        let request = ImportRequest::new(folder.path().join("main.usda"));
        Self { folder, request }
    }

    fn with(self, name: &str, bytes: impl AsRef<[u8]>) -> Self {
        let path = self.folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
        self
    }

    fn variant(mut self, name: &str) -> Self {
        self.request.choice.variants.push(name.into());
        self
    }

    fn at(mut self, moment: Moment) -> Self {
        self.request.choice = Choice { moment: Some(moment), ..self.request.choice };
        self
    }

    fn import(&self) -> Result<Imported, Diagnostic> {
        Usd.import(&self.request)
    }

    fn scene(&self) -> Imported {
        self.import().unwrap()
    }
}

/// USD wants a line for each statement; here blocks may be on one.
fn lines(text: &str) -> String {
    text.replace("{ ", "{\n").replace(" }", "\n}")
}

/// The messages of warnings.
fn warnings(imported: &Imported) -> Vec<String> {
    let warnings = imported.diagnostics.iter().filter(|d| d.severity == Severity::Warning);
    warnings.map(|d| format!("{}: {}", d.element.as_deref().unwrap_or_default(), d.message)).collect()
}
