//! glTF 2.0, text and binary.
//!
//! Source: Khronos Group, *glTF 2.0 Specification* (version 2.0.1, 2021) and the extensions in its repository; the
//! rows of [`FEATURES`] say which. The `gltf` crate names the JSON; everything that can be wrong in a file is checked
//! here, since the crate's own reader refuses required extensions it does not know, and its accessors trust the file.
//!
//! The way of a file: `container` splits a GLB, `document` turns JSON into the crate's types, `check` proves that
//! indices point to something and nodes form trees, `buffers` and `accessor` give numbers, `animation` writes what moves
//! into the JSON, and `mesh`, `material`, `light`, `camera` and `node` make the scene. Meshes are split into one mesh per
//! primitive; nodes keep their indices, and those of `instances` follow.

mod accessor;
mod animation;
mod attributes;
mod buffers;
mod camera;
mod check;
mod container;
mod cube;
mod deform;
mod document;
mod draco;
mod effects;
mod extensions;
mod gloss;
mod image;
mod instances;
mod layers;
mod light;
mod material;
mod mesh;
mod meshopt;
mod node;
mod surroundings;
mod texture;
mod topology;
mod uri;
mod variants;

use std::{collections::HashSet, path::PathBuf};

use ajar_scene::{Cause, Choice, Diagnostic, Feature, ImportRequest, Imported, Importer, Scene};
use gltf::json::Root;

use crate::report::Report;

pub use extensions::FEATURES;

/// The importer of `.gltf` and `.glb` files.
pub struct Gltf;

impl Importer for Gltf {
    fn name(&self) -> &'static str {
        "gltf"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["gltf", "glb"]
    }

    fn sniff(&self, head: &[u8]) -> bool {
        container::looks_like_gltf(head)
    }

    fn features(&self) -> &'static [Feature] {
        FEATURES
    }

    fn import(&self, request: &ImportRequest) -> Result<Imported, Diagnostic> {
        read(request).map_err(|mut error| {
            error.file.get_or_insert_with(|| request.path.clone());
            error
        })
    }
}

/// What every part needs: the limits of the request, and a place for findings.
struct Context<'a> {
    request: &'a ImportRequest,
    report: Report,
    files: Vec<PathBuf>,
    budget: u64,
    /// Accessors that something has asked for.
    opened: HashSet<usize>,
}

impl Context<'_> {
    /// Counts `bytes` of memory that the file asks for, before they are allocated.
    fn charge(&mut self, bytes: u64, element: &str) -> Result<(), Diagnostic> {
        let limit = self.request.memory_limit;
        self.budget = self.budget.checked_sub(bytes).ok_or_else(|| {
            Diagnostic::error(format!("needs more memory than the limit of {limit} bytes"))
                .because(Cause::Resource)
                .element(element)
                .hint("raise the memory limit, --memory-limit, if the file is to be trusted")
        })?;
        Ok(())
    }
}

/// The JSON and the bytes that belong to it.
struct Asset {
    root: Root,
    buffers: buffers::Buffers,
}

impl<'a> Context<'a> {
    fn new(request: &'a ImportRequest) -> Self {
        Self {
            request,
            report: Report::default(),
            files: vec![request.path.clone()],
            budget: request.memory_limit,
            opened: HashSet::new(),
        }
    }
}

fn read(request: &ImportRequest) -> Result<Imported, Diagnostic> {
    let mut context = Context::new(request);
    let file = uri::read_file(&request.path, &mut context, "the file").map_err(|mut error| {
        error.element = None;
        error
    })?;
    convert(file, context)
}

/// The scene in the bytes of a GLB that a plug-in made of the file of `request`, variants and moment chosen.
///
/// # Errors
/// What an import of the bytes as a file would return.
pub(crate) fn decode(bytes: Vec<u8>, request: &ImportRequest) -> Result<Imported, Diagnostic> {
    let request = ImportRequest { choice: Choice::default(), ..request.clone() };
    convert(bytes, Context::new(&request))
}

/// Whether the bytes are a GLB.
pub(crate) fn is_container(bytes: &[u8]) -> bool {
    container::is_binary(bytes)
}

fn convert(file: Vec<u8>, mut context: Context) -> Result<Imported, Diagnostic> {
    let mut asset = load(file, &mut context)?;
    check::indices(&asset.root)?;
    draco::expand(&mut asset, &mut context)?;
    let parents = check::parents(&asset.root)?;

    let mut scene = Scene::default();
    let materials = material::materials(&asset, &mut context, &mut scene)?;
    let places = node::Places::new(&asset.root, &mut context, &parents)?;
    let (variants, sets) = variants::Variants::chosen(&asset.root, &mut context)?;
    let meshes = mesh::Maker { asset: &asset, materials, variants, globals: &places.globals };
    let meshes = meshes.meshes(&mut context, &mut scene)?;
    let lights = light::lights(&asset.root, &mut context, &mut scene);
    let cameras = camera::cameras(&asset.root, &mut context, &mut scene);
    node::nodes(&asset.root, &mut context, &mut scene, node::Parts { places, meshes, lights, cameras })?;
    instances::expand(&asset, &mut context, &mut scene)?;
    let shown = asset.root.scene.map_or(0, |scene| scene.value());
    scene.roots = node::roots(&asset.root, shown, &parents, &mut context);
    let surroundings = surroundings::place(&asset, shown, &mut context, &mut scene)?;
    scene.roots.extend(surroundings);
    if scene.roots.is_empty() {
        context.report.add(Diagnostic::warning("the scene places no nodes, there is nothing to see"));
    }
    accessor::check_unused(&asset, &mut context);
    asset.buffers.check_unused(&mut context);
    let mut met = HashSet::new();
    context.files.retain(|path| met.insert(path.clone()));
    let diagnostics = context.report.finish(&context.request.path);
    Ok(Imported { scene, diagnostics, files: context.files, variants: sets, ..Imported::default() })
}

/// The document at the moment that is asked for, and its buffers.
fn load(file: Vec<u8>, context: &mut Context) -> Result<Asset, Diagnostic> {
    let document::Document { mut json, animations, binary } = document::parse(file, context)?;
    let moment = context.request.choice.seconds().filter(|_| !animations.is_empty());
    let Some(seconds) = moment else {
        if !animations.is_empty() {
            context.report.note("animations", "the rest pose is shown; --frame or --at chooses a moment");
        }
        let root = document::root(json)?;
        let buffers = buffers::Buffers::load(&root, binary, context)?;
        return Ok(Asset { root, buffers });
    };
    let root = document::root(json.clone())?;
    let buffers = buffers::Buffers::load(&root, binary, context)?;
    let mut asset = Asset { root, buffers };
    animation::apply(&animations, seconds, &asset, context, &mut json)?;
    asset.root = document::root(json)?;
    Ok(asset)
}

/// The item at `index`, or an error that names the element which points beyond.
fn at<'a, T>(items: &'a [T], index: usize, list: &str, element: &str) -> Result<&'a T, Diagnostic> {
    items.get(index).ok_or_else(|| {
        Diagnostic::error(format!("points to {list}[{index}], but there are only {}", items.len()))
            .element(element)
    })
}
