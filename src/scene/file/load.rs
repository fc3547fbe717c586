//! From the file to the scene.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use toml::de::DeTable;

use super::{
    SceneFile, VariedImport, camera, choice,
    keys::Keys,
    layers, light, material, node, placement,
    report::{Complaint, advice},
    settings,
    source::{Settings, Source},
    texture::Assets,
    value::text,
};
use crate::{
    Diagnostic, ImportRequest, Imported, Looked, Node, OutputSettings, Overrides, RenderSettings, Scene,
    Severity, VariantSet,
};

/// Reads the scene file of `request`, over the files that it extends, below `overrides`. `import` turns each file it names
/// into a scene; it is given the folder of the scene file as one more folder that may be read.
///
/// # Errors
/// All errors that were found, in the order of the files, with the warnings among them.
pub fn load(
    request: &ImportRequest,
    overrides: &Overrides,
    import: &dyn Fn(&ImportRequest) -> Result<Imported, Diagnostic>,
) -> Result<SceneFile, Vec<Diagnostic>> {
    let texts = layers::read(request)?;
    let assets = Assets { files: texts.iter().map(|text| text.path.clone()).collect(), ..Assets::default() };
    let mut sources = overrides.sources(&request.path);
    sources.extend(layers::sources(&texts));
    assemble(sources, request, assets, import)
}

/// Changes applied to the asset of `request`, imported, as if a scene file imported nothing else.
///
/// # Errors
/// What is wrong with the changes.
pub fn load_asset(
    request: &ImportRequest,
    overrides: &Overrides,
    imported: Imported,
) -> Result<SceneFile, Vec<Diagnostic>> {
    let Imported { scene, diagnostics, files, render: preference, variants } = imported;
    let varied = varied(stem(&request.path), variants).into_iter().collect();
    let assets = Assets { scene, files, preference, varied };
    let nothing = |_: &ImportRequest| Ok(Imported::default());
    let file = assemble(overrides.sources(&request.path), request, assets, &nothing)?;
    sound(SceneFile { diagnostics: [file.diagnostics, diagnostics].concat(), ..file })
}

/// What the sources together say, with what is to be said about them. They look for files as `request` does.
fn assemble(
    mut sources: Vec<Source<'_>>,
    request: &ImportRequest,
    assets: Assets,
    import: &dyn Fn(&ImportRequest) -> Result<Imported, Diagnostic>,
) -> Result<SceneFile, Vec<Diagnostic>> {
    for source in &mut sources {
        source.request.allowed.clone_from(&request.allowed);
        source.request.looked = request.looked.clone();
    }
    let settings = Settings::default();
    let (mut file, imported) = read(Keys::new(&sources, &settings), assets, import);
    file.diagnostics =
        sources.into_iter().flat_map(|source| source.report.finish()).chain(imported).collect();
    file.settings = settings.into_inner();
    sound(file)
}

/// The file with what was said about it, unless that is an error.
fn sound(file: SceneFile) -> Result<SceneFile, Vec<Diagnostic>> {
    if file.diagnostics.iter().any(|it| it.severity == Severity::Error) {
        return Err(file.diagnostics);
    }
    Ok(file)
}

/// Reads the document; returns also what the importers said.
fn read(
    mut keys: Keys<'_>,
    mut assets: Assets,
    import: &dyn Fn(&ImportRequest) -> Result<Imported, Diagnostic>,
) -> (SceneFile, Vec<Diagnostic>) {
    // Read before, by `layers`.
    keys.optional(layers::EXTENDS, text);
    let mut imported = Vec::new();
    let mut complete = true;
    for table in keys.tables("import", import_name) {
        complete &= add_import(table, &mut assets, &mut imported, import);
    }
    let mut names = BTreeSet::new();
    for (index, table) in keys.tables("camera", own_name).into_iter().enumerate() {
        camera::read(table, index, &mut assets.scene, &mut names, complete);
    }
    for (index, table) in keys.tables("light", own_name).into_iter().enumerate() {
        light::read(table, index, &mut assets);
    }
    if let Some(tables) = keys.table("material") {
        for (pattern, table) in tables.named_tables() {
            material::read(&pattern, table, &mut assets, complete);
        }
    }
    if let Some(tables) = keys.table("node") {
        for (pattern, table) in tables.named_tables() {
            node::read(&pattern, table, &mut assets, complete);
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
    let file = SceneFile {
        scene: assets.scene,
        render,
        output,
        diagnostics: Vec::new(),
        files,
        varied: assets.varied,
        settings: Vec::new(),
    };
    (file, imported)
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
    assets: &mut Assets,
    diagnostics: &mut Vec<Diagnostic>,
    import: &dyn Fn(&ImportRequest) -> Result<Imported, Diagnostic>,
) -> bool {
    let (mut allowed, mut looked) = (Vec::new(), Looked::default());
    let file = keys.required_of("file", |value, source| {
        allowed.push(source.request.folder().to_owned());
        looked = source.request.looked.clone();
        assets.file(value, source)
    });
    let name = keys.optional("name", text);
    let transform = placement::import(&mut keys);
    let choice = choice::read(&mut keys);
    keys.finish();
    let Some(path) = file else { return false };
    let name = name.unwrap_or_else(|| stem(&path));
    match import(&ImportRequest { allowed, choice, looked, ..ImportRequest::new(path) }) {
        Ok(Imported { scene, diagnostics: found, files, render, variants }) => {
            assets.preference.complete(render);
            assets.varied.extend(varied(name.clone(), variants));
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

fn varied(name: String, variants: Vec<VariantSet>) -> Option<VariedImport> {
    (!variants.is_empty()).then_some(VariedImport { name, variants })
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
