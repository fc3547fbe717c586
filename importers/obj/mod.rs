//! Wavefront OBJ and MTL.
//!
//! Sources: Alias|Wavefront, "Advanced Visualizer" appendix B1, *Object files (.obj)*, and *Material library file
//! (.mtl)*, version 4.2 (1995); the PBR extension of MTL by Exocortex (`Pr`, `Pm`, `Pc`, …); colours after `v`, which
//! several tools write, sRGB-encoded as Blender does.
//!
//! # Who reads what
//!
//! `tobj` reads the materials. Geometry is read here: `tobj` loses smoothing groups and the lines of errors, fans out
//! concave polygons, takes NaN, and is silent about unknown materials; making up for that would need a second reader
//! of the same statements beside it.
//!
//! # What becomes what
//!
//! The file is a root node; each object and group below it is a node named `object/group`; each material used in it is
//! one mesh named `object/group/material`. Faces are split by ear clipping. `vn` wins over smoothing groups; without
//! either a face is flat. Materials that no face uses are left out.
//!
//! | MTL | here |
//! |---|---|
//! | `Kd`, `map_Kd` | base colour, numbers linear as written, map sRGB |
//! | `Ks`, `map_Ks` | `illum` 0, 1: no highlight; else weight 2·max(Ks) up to 1 (0.5 is an ordinary dielectric, as Blender writes it) and colour; absent: none, or an ordinary dielectric where the PBR extension is used |
//! | `Ns` | roughness (2 / (Ns + 2))^¼, 0 from 1000 on; absent: 0 for mirrors and glass, else 0.5 |
//! | `map_Ns` | factor of `Ns`, made into an image of roughness |
//! | `Pr`, `Pm`, `Pc`, `Pcr`, `aniso`, `anisor`, all but the last with map | roughness (wins over `Ns`), metal, coat, its roughness, anisotropy, its rotation in turns |
//! | `Ps`, `map_Ps` | grey sheen of roughness 0.3 |
//! | `Ke`, `map_Ke` | emission in cd/m², both sides: the format has no front |
//! | `d`, `Tr` = 1 − d | opacity, as coverage; `d` wins |
//! | `map_d` | mask at 0.5, or factor of `d` where d < 1; read from alpha if it is the file of `map_Kd`, else its luminance |
//! | `Ni` | index of refraction where above 1, else 1.5 |
//! | `illum` 3, 5, 8 | mirror: metal of colour Kd + Ks and weight Ks / (Kd + Ks), unless `Pm` is given |
//! | `illum` 4, 6, 7, 9 | glass of tint `Tf` where `Ni` > 1 (or is absent and `illum` is 6 or 7, or d < 1); `d` is then its transparency, already said |
//! | `norm`, and `map_Bump` or `bump` of a file named like a normal map | normal map of scale `-bm` |
//! | other `map_Bump` or `bump` | heights, made into a normal map; their unit, which the format leaves open, is `-bm` texels |
//! | `disp`, `refl`, `decal`, … | dropped with a warning |
//! | `Ka`, `map_Ka` | ignored with a note |
//!
//! A colour or weight of 0 with a map that can be read is taken as 1, with a warning. Texture options: see `texture.rs`.

mod bake;
mod build;
mod geometry;
mod lines;
mod material;
mod mtl;
mod texture;

use std::collections::{HashMap, HashSet};

use ajar_scene::{Diagnostic, Feature, Id, ImportRequest, Imported, Importer, Material, Severity};

use crate::{budget::Budget, report::Report};

use self::{geometry::Geometry, mtl::Definition, texture::Textures};

/// The importer of OBJ files.
pub struct Obj;

const FEATURES: &[Feature] = &[
    Feature { name: "faces", support: "any polygon, also concave; indices from the front or the back" },
    Feature { name: "o, g, usemtl", support: "one node an object and group, one mesh a material in it" },
    Feature { name: "vn, s", support: "normals as written, else averaged in smoothing groups, else flat" },
    Feature { name: "vt", support: "one set" },
    Feature { name: "vertex colours", support: "r g b after the coordinates, sRGB" },
    Feature { name: "points, lines, curves, surfaces", support: "dropped with a warning" },
    Feature {
        name: "encodings",
        support: "UTF-8, UTF-16 with a mark, else Latin-1; all line ends, continued lines",
    },
    Feature { name: "units, up axis", support: "the format states none: metres, Y up" },
    Feature { name: "MTL colours", support: "Kd, Ks, Ke, Tf, Ns, Ni, d, Tr, illum; Ka ignored" },
    Feature { name: "MTL PBR extension", support: "Pr, Pm, Pc, Pcr, Ps, aniso, anisor" },
    Feature {
        name: "MTL maps",
        support: "map_Kd, map_Ks, map_Ke, map_Ns, map_d, map_Pr, map_Pm, map_Pc, map_Pcr, map_Ps, norm; disp, refl and \
                  decal dropped",
    },
    Feature {
        name: "map_Bump, bump",
        support: "normal maps, told by the file's name; others are heights, which become normal maps",
    },
    Feature {
        name: "map options",
        support: "-s -o -mm -bm -clamp -imfchan -blendu -blendv -colorspace; -t -boost -texres -type -cc dropped",
    },
];

impl Importer for Obj {
    fn name(&self) -> &'static str {
        "obj"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["obj"]
    }

    fn sniff(&self, head: &[u8]) -> bool {
        let text = String::from_utf8_lossy(head);
        let first = lines::Lines::new(&text).next();
        let known = ["v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl"];
        first.map_or_else(|| text.contains("OBJ"), |line| known.contains(&line.keyword()))
    }

    fn features(&self) -> &'static [Feature] {
        FEATURES
    }

    fn import(&self, request: &ImportRequest) -> Result<Imported, Diagnostic> {
        request.refuse_variants()?;
        let file = request.path.as_path();
        let mut report = Report::default();
        report.add(Diagnostic::note("OBJ states no units or up axis; taken as metres, Y up").in_file(file));
        let (text, damaged) = lines::read(file, request.memory_limit)?;
        if damaged {
            report.add(Diagnostic::note("is not UTF-8; read as Latin-1").in_file(file));
        }
        let geometry = geometry::parse(&text, file, request.memory_limit, &mut report)?;
        drop(text);
        let mut imported = Imported { files: vec![file.to_owned()], ..Imported::default() };
        let definitions = libraries(&geometry, request, &mut imported, &mut report);
        let materials = materials(&geometry, definitions, request, &mut imported, &mut report);
        build::build(&geometry, &materials, file, &mut imported.scene, &mut report);
        imported.diagnostics = report.finish(file);
        Ok(imported)
    }
}

/// Reads all material libraries.
fn libraries(
    geometry: &Geometry,
    request: &ImportRequest,
    imported: &mut Imported,
    report: &mut Report,
) -> Vec<Definition> {
    let mut definitions = Vec::new();
    for (argument, line) in &geometry.libraries {
        for name in library_names(request, argument) {
            let found = request.resolve(&name);
            let path =
                found.as_ref().map_or_else(|_| texture::looked_for(request, &name), |p| Some(p.clone()));
            if path.as_ref().is_some_and(|path| imported.files.contains(path)) {
                continue;
            }
            imported.files.extend(path);
            match found.and_then(|path| Ok((lines::read(&path, request.memory_limit)?.0, path))) {
                Ok((text, path)) => {
                    let folder = name.replace('\\', "/");
                    let folder = folder.rsplit_once('/').map_or("", |(folder, _)| folder);
                    definitions.extend(mtl::parse(&text, &path, folder, report));
                }
                Err(mut e) => {
                    e.severity = Severity::Warning;
                    e.message = format!("material library: {}", e.message);
                    report.add(e.in_file(&request.path).at(*line, 1));
                }
            }
        }
    }
    definitions
}

/// The files of an `mtllib` statement: one name that may hold spaces, or several that each end in `.mtl`.
fn library_names(request: &ImportRequest, argument: &str) -> Vec<String> {
    let argument = argument.trim_matches('"');
    if request.resolve(argument).is_ok() {
        return vec![argument.to_owned()];
    }
    let mut names = Vec::new();
    let mut name = String::new();
    for word in argument.split_ascii_whitespace() {
        if !name.is_empty() {
            name.push(' ');
        }
        name.push_str(word);
        if word.to_ascii_lowercase().ends_with(".mtl") {
            names.push(std::mem::take(&mut name));
        }
    }
    names.extend(Some(name).filter(|rest| !rest.is_empty()));
    names
}

/// Converts the materials that faces use, by name.
fn materials<'a>(
    geometry: &'a Geometry,
    definitions: Vec<Definition>,
    request: &ImportRequest,
    imported: &mut Imported,
    report: &mut Report,
) -> HashMap<&'a str, Id<Material>> {
    let mut by_name: HashMap<String, Definition> = HashMap::new();
    for definition in definitions {
        let name = definition.source.name.clone();
        if let Some(first) = by_name.get(&name) {
            let message = format!("material {} is defined again; the first counts", lines::quote(&name));
            report.add(Diagnostic::warning(message).in_file(&first.file).at(definition.line, 1));
        } else {
            by_name.insert(name, definition);
        }
    }
    let Imported { scene, files, .. } = imported;
    let budget = Budget::new(request.memory_limit);
    let mut textures = Textures { request, scene, files, report, images: HashMap::new(), budget };
    let (mut converted, mut missing) = (HashMap::new(), HashSet::new());
    for (part, line) in &geometry.parts {
        let Some(name) = part.material.as_deref().filter(|&name| !converted.contains_key(name)) else {
            continue;
        };
        if let Some(definition) = by_name.remove(name) {
            let material = material::convert(definition, &mut textures);
            converted.insert(name, textures.scene.materials.push(material));
        } else if missing.insert(name) {
            let message = format!("material {} is in no library; the default is used", lines::quote(name));
            textures.report.add(Diagnostic::warning(message).in_file(&request.path).at(*line, 1));
        }
    }
    converted
}
