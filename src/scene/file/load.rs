//! From the file to the scene.

use std::path::{Path, PathBuf};

use toml::de::DeTable;

use super::{
    SceneFile, camera,
    keys::Keys,
    light, material, placement,
    report::{Complaint, Report, advice},
    settings,
    texture::Assets,
    value::text,
};
use crate::{
    Diagnostic, ImportRequest, Imported, Node, OutputSettings, Overrides, Preference, RenderSettings, Scene,
    Severity,
};

/// Reads a scene file below changes from the command line. `import` turns each file it names into a scene; it is given
/// the folder of the scene file as one more folder that may be read.
///
/// # Errors
/// All errors that were found, in the order of the file, with the warnings among them.
pub fn load(
    path: &Path,
    overrides: &Overrides,
    import: &dyn Fn(&ImportRequest) -> Result<Imported, Diagnostic>,
) -> Result<SceneFile, Vec<Diagnostic>> {
    let refuse = |message: String| vec![Diagnostic::error(message).in_file(path)];
    let bytes = std::fs::read(path).map_err(|e| refuse(format!("cannot be read: {e}")))?;
    let text = std::str::from_utf8(&bytes).map_err(|e| {
        let before = String::from_utf8_lossy(bytes.get(..e.valid_up_to()).unwrap_or_default()).into_owned();
        let report = Report::new(path, &before);
        report.push(&(before.len()..before.len()), Diagnostic::error("is not text in UTF-8"));
        report.finish()
    })?;

    let report = Report::new(path, text);
    let (document, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        for error in errors {
            report.push(&error.span().unwrap_or(0..0), Diagnostic::error(error.message()));
        }
        // What follows on the same line is mostly the parser finding its feet again.
        let mut found = report.finish();
        found.dedup_by_key(|diagnostic| diagnostic.place.map(|(line, _)| line));
        return Err(found);
    }

    let request = ImportRequest::new(path);
    let assets = Assets {
        request: &request,
        scene: Scene::default(),
        files: vec![path.to_owned()],
        preference: Preference::default(),
    };
    let changes = overrides.table();
    let keys = Keys::new(&report, Some(&document), changes.get_ref());
    let (file, imported) = read(keys, assets, import);
    sound(file, [report.finish(), imported].concat())
}

/// Changes from the command line applied to an imported asset, as if a scene file imported nothing else.
///
/// # Errors
/// What is wrong with the changes.
pub fn load_asset(
    path: &Path,
    overrides: &Overrides,
    imported: Imported,
) -> Result<SceneFile, Vec<Diagnostic>> {
    let Imported { scene, diagnostics, files, render: preference } = imported;
    let request = ImportRequest::new(path);
    let report = Report::new(path, "");
    let changes = overrides.table();
    let keys = Keys::new(&report, None, changes.get_ref());
    let nothing = |_: &ImportRequest| Ok(Imported::default());
    let (file, _) = read(keys, Assets { request: &request, scene, files, preference }, &nothing);
    sound(file, [report.finish(), diagnostics].concat())
}

/// The file with what was said about it, unless that is an error.
fn sound(file: SceneFile, diagnostics: Vec<Diagnostic>) -> Result<SceneFile, Vec<Diagnostic>> {
    let file = SceneFile { diagnostics, ..file };
    if file.diagnostics.iter().any(|it| it.severity == Severity::Error) {
        return Err(file.diagnostics);
    }
    Ok(file)
}

/// Reads the document; returns also what the importers said.
fn read(
    mut keys: Keys<'_>,
    mut assets: Assets<'_>,
    import: &dyn Fn(&ImportRequest) -> Result<Imported, Diagnostic>,
) -> (SceneFile, Vec<Diagnostic>) {
    let mut imported = Vec::new();
    let mut complete = true;
    for table in keys.tables("import", import_name) {
        complete &= add_import(table, &mut assets, &mut imported, import);
    }
    for (index, table) in keys.tables("camera", own_name).into_iter().enumerate() {
        camera::read(table, index, &mut assets.scene);
    }
    for (index, table) in keys.tables("light", own_name).into_iter().enumerate() {
        light::read(table, index, &mut assets);
    }
    if let Some(mut tables) = keys.table("material") {
        for (pattern, table) in tables.named_tables() {
            material::read(&pattern, table, &mut assets, complete);
        }
    }
    let mut render = match keys.table("render") {
        Some(table) => {
            let settings = settings::render(table);
            check_camera(&mut keys, &settings, &assets.scene, complete);
            settings
        }
        None => RenderSettings::default(),
    };
    render.camera = render.camera.or(assets.preference.camera);
    render.size = render.size.or(assets.preference.size);
    let output = keys.table("output").map_or_else(OutputSettings::default, settings::output);
    keys.finish();
    let files = assets.files;
    (SceneFile { scene: assets.scene, render, output, diagnostics: Vec::new(), files }, imported)
}

fn own_name(table: &DeTable<'_>) -> Option<String> {
    table.get("name").and_then(|name| name.get_ref().as_str()).map(str::to_owned)
}

/// An import is called after its file where nothing else is said.
fn import_name(table: &DeTable<'_>) -> Option<String> {
    let file = table.get("file").and_then(|file| file.get_ref().as_str());
    own_name(table).or_else(|| file.map(|file| stem(Path::new(file))))
}

/// Imports one file below a node of its own. Returns whether that worked.
fn add_import(
    mut keys: Keys<'_>,
    assets: &mut Assets<'_>,
    diagnostics: &mut Vec<Diagnostic>,
    import: &dyn Fn(&ImportRequest) -> Result<Imported, Diagnostic>,
) -> bool {
    let file = keys.required("file", |value| assets.file(value));
    let name = keys.optional("name", text);
    let transform = placement::import(&mut keys);
    keys.finish();
    let Some(path) = file else { return false };
    let name = name.unwrap_or_else(|| stem(&path));
    let allowed = vec![assets.request.folder().to_owned()];
    match import(&ImportRequest { path, allowed, memory_limit: assets.request.memory_limit }) {
        Ok(Imported { scene, diagnostics: found, files, render }) => {
            assets.preference.complete(render);
            diagnostics.extend(found);
            assets.files.extend(files);
            let children = assets.scene.append(scene);
            assets.scene.add_root(Node { name, transform, children, ..Node::default() });
            true
        }
        Err(diagnostic) => {
            diagnostics.push(diagnostic);
            false
        }
    }
}

fn stem(path: &Path) -> String {
    PathBuf::from(path.file_stem().unwrap_or_default()).to_string_lossy().into_owned()
}

/// The camera that `[render]` names must exist.
fn check_camera(keys: &mut Keys<'_>, settings: &RenderSettings, scene: &Scene, complete: bool) {
    let Some(name) = settings.camera.as_ref().filter(|_| complete) else { return };
    let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    if !names.contains(&name.as_str())
        && let Some(render) = keys.table("render")
    {
        render.complain("camera", Complaint::new("no camera has this name").hint(advice(name, names)));
    }
}
