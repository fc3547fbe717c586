//! Assets as they were imported, as long as the files that they came from stay as they are.

use std::{
    cell::RefCell,
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use ajar_scene::{Choice, Diagnostic, ImageSource, ImportRequest, Imported, Looked};

use crate::session::Import;

#[derive(Default)]
pub(super) struct Imports(RefCell<Vec<Kept>>);

struct Kept {
    path: PathBuf,
    allowed: Vec<PathBuf>,
    choice: Choice,
    imported: Imported,
    /// Files that were looked for.
    looked: BTreeSet<PathBuf>,
    /// Whether it was asked for since the last sweep.
    is_used: bool,
}

impl Kept {
    fn answers(&self, request: &ImportRequest) -> bool {
        self.path == request.path && self.allowed == request.allowed && self.choice == request.choice
    }

    /// Whether importing again could have another result. Importers name images and leave it to others to read them.
    fn depends_on(&self, file: &Path) -> bool {
        let is_image =
            |image: &ajar_scene::Image| matches!(&image.source, ImageSource::File(it) if it == file);
        self.looked.contains(file) && !(file.is_file() && self.imported.scene.images.iter().any(is_image))
    }
}

impl Imports {
    /// What `import` makes of a request, now or before.
    pub fn ask(&self, request: &ImportRequest, import: &Import<'_>) -> Result<Imported, Diagnostic> {
        if let Some(kept) = self.0.borrow_mut().iter_mut().find(|kept| kept.answers(request)) {
            kept.is_used = true;
            kept.looked.iter().for_each(|file| request.looked.note(file));
            return Ok(kept.imported.clone());
        }
        let own = Looked::default();
        let found = import(&ImportRequest { looked: own.clone(), ..request.clone() });
        own.note(&request.path);
        found.iter().flat_map(|imported| &imported.files).for_each(|file| own.note(file));
        let looked = own.take();
        looked.iter().for_each(|file| request.looked.note(file));
        let imported = found?;
        self.0.borrow_mut().push(Kept {
            path: request.path.clone(),
            allowed: request.allowed.clone(),
            choice: request.choice.clone(),
            imported: imported.clone(),
            looked,
            is_used: true,
        });
        Ok(imported)
    }

    /// Forgets what files changed for.
    pub fn forget(&self, changed: &BTreeSet<PathBuf>) {
        self.0.borrow_mut().retain(|kept| !changed.iter().any(|file| kept.depends_on(file)));
    }

    /// Forgets what nobody asked for since this was last called.
    pub fn sweep(&self) {
        self.0.borrow_mut().retain_mut(|kept| std::mem::take(&mut kept.is_used));
    }
}
