//! Texture statements of a material: options, file name, and the texture they make.
//!
//! Options after the 1995 specification of MTL: `-s` and `-o` scale and shift the coordinates, `-mm base gain` makes
//! `base + gain · texel`, `-clamp on` ends the image at its edge, `-blendu off -blendv off` shows texels as squares,
//! `-imfchan` picks the channel of scalars, `-bm` scales bumps; `-colorspace` is a later addition. Turbulence (`-t`),
//! sharpening (`-boost`), colour correction (`-cc on`), `-texres` and the shapes of reflection maps (`-type`) are named and
//! dropped.

use std::{
    collections::HashMap,
    path::{Component, PathBuf},
};

use ajar_scene::{
    Channel, ColorSpace, Diagnostic, Filter, Id, Image, ImageSource, ImportRequest, Loss, Scene, Texture,
    TextureInput, Wrap,
};
use glam::{Affine2, Mat2, Vec2, Vec4};

use super::{
    bake::{self, Recipe},
    mtl::Definition,
};
use crate::{budget::Budget, report::Report};

/// The options and the file name of one statement.
pub(super) struct Map {
    pub file: String,
    pub scale: Vec2,
    pub offset: Vec2,
    pub base: f32,
    pub gain: f32,
    pub clamp: bool,
    /// Whether texels blend along u and v.
    pub blend: [bool; 2],
    pub channel: Option<Channel>,
    pub bump: f32,
    pub color_space: Option<ColorSpace>,
    /// Options without effect here.
    pub dropped: Vec<&'static str>,
}

/// Options with the most arguments that they take.
const OPTIONS: [(&str, usize); 14] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-bm", 1),
    ("-boost", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-colorspace", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
];

impl Map {
    /// Reads the statement after its keyword. Options may also follow the name, which may hold spaces.
    pub fn parse(text: &str) -> Self {
        let mut map = Self {
            file: String::new(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            base: 0.0,
            gain: 1.0,
            clamp: false,
            blend: [true; 2],
            channel: None,
            bump: 1.0,
            color_space: None,
            dropped: Vec::new(),
        };
        let mut rest = text.trim();
        while !rest.is_empty() {
            let word = first_word(rest);
            let Some(&(name, most)) = OPTIONS.iter().find(|(name, _)| *name == word) else {
                let end = name_end(rest);
                map.file = rest[..end].trim().trim_matches('"').to_owned();
                rest = rest[end..].trim_start();
                continue;
            };
            rest = rest[word.len()..].trim_start();
            let mut arguments = Vec::new();
            while arguments.len() < most {
                let word = first_word(rest);
                let number = word.parse::<f32>().is_ok_and(f32::is_finite);
                if word.is_empty() || (matches!(name, "-o" | "-s" | "-t" | "-mm" | "-bm") && !number) {
                    break;
                }
                arguments.push(word);
                rest = rest[word.len()..].trim_start();
            }
            map.option(name, &arguments);
        }
        map
    }

    fn option(&mut self, name: &'static str, arguments: &[&str]) {
        let number =
            |at: usize, default: f32| arguments.get(at).and_then(|a| a.parse().ok()).unwrap_or(default);
        let word = arguments.first().map(|word| word.to_ascii_lowercase()).unwrap_or_default();
        let understood = match (name, word.as_str()) {
            ("-s", _) => return self.scale = Vec2::new(number(0, 1.0), number(1, 1.0)),
            ("-o", _) => return self.offset = Vec2::new(number(0, 0.0), number(1, 0.0)),
            ("-mm", _) => return (self.base, self.gain) = (number(0, 0.0), number(1, 1.0)),
            ("-bm", _) => return self.bump = number(0, 1.0),
            ("-clamp", _) => return self.clamp = word == "on",
            ("-blendu", _) => return self.blend[0] = word != "off",
            ("-blendv", _) => return self.blend[1] = word != "off",
            ("-imfchan", "l") => return self.channel = Some(Channel::L),
            ("-imfchan", "r") => return self.channel = Some(Channel::R),
            ("-imfchan", "g") => return self.channel = Some(Channel::G),
            ("-imfchan", "b") => return self.channel = Some(Channel::B),
            ("-imfchan", "m") => return self.channel = Some(Channel::A),
            ("-colorspace", "srgb") => return self.color_space = Some(ColorSpace::Srgb),
            ("-colorspace", "linear" | "raw" | "non-color") => {
                return self.color_space = Some(ColorSpace::Raw);
            }
            // What they are without being said.
            ("-cc", "off") => true,
            ("-t", _) => arguments.iter().all(|a| a.parse() == Ok(0.0)),
            _ => false,
        };
        if !understood {
            self.dropped.push(name);
        }
    }
}

/// Where a file that is not there would be, for those who wait for it; nothing outside the scene's folder.
pub(super) fn looked_for(request: &ImportRequest, reference: &str) -> Option<PathBuf> {
    let reference = PathBuf::from(reference.replace('\\', "/"));
    let below = reference.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    below.then(|| request.folder().join(reference))
}

fn first_word(text: &str) -> &str {
    text.split_ascii_whitespace().next().unwrap_or_default()
}

/// Where a file name at the start of `text` ends: before the next option.
fn name_end(text: &str) -> usize {
    let starts = text.match_indices(" -").map(|(at, _)| at);
    let mut options =
        starts.filter(|&at| OPTIONS.iter().any(|(name, _)| *name == first_word(&text[at + 1..])));
    options.next().unwrap_or(text.len())
}

/// Makes textures in a scene.
pub(super) struct Textures<'a> {
    pub request: &'a ImportRequest,
    pub scene: &'a mut Scene,
    pub files: &'a mut Vec<PathBuf>,
    pub report: &'a mut Report,
    /// By the file and what was made of it.
    pub images: HashMap<(PathBuf, String), Id<Image>>,
    /// For images that are made of others.
    pub budget: Budget,
}

impl Textures<'_> {
    /// The texture of statement `name`, or nothing and a warning when its file cannot be read.
    pub fn add(&mut self, of: &Definition, name: &str, map: &Map, space: ColorSpace) -> Option<TextureInput> {
        let key = (self.file(of, name, map)?, String::new());
        let image = self.images.get(&key).copied().unwrap_or_else(|| {
            let source = ImageSource::File(key.0.clone());
            self.keep(key, Image { name: map.file.clone(), source })
        });
        let levels = Texture {
            color_space: map.color_space.unwrap_or(space),
            scale: Vec4::splat(map.gain),
            bias: Vec4::splat(map.base),
            ..Texture::new(image)
        };
        Some(TextureInput { texture: self.placed(map, levels), channel: map.channel.unwrap_or_default() })
    }

    /// The texture of an image made of that of statement `name`, which is a scalar, or nothing and a warning.
    pub fn bake(&mut self, of: &Definition, name: &str, map: &Map, recipe: Recipe) -> Option<Id<Texture>> {
        let path = self.file(of, name, map)?;
        let channel = map.channel.unwrap_or(Channel::L);
        let read = bake::Read { channel, srgb: map.color_space == Some(ColorSpace::Srgb) };
        let key = (path, format!("{read:?} {recipe:?}"));
        let image = match self.images.get(&key) {
            Some(&known) => known,
            None => match bake::bake(&key.0, read, recipe, &self.budget) {
                Ok(bytes) => {
                    let source = ImageSource::Embedded(bytes.into());
                    self.keep(key, Image { name: format!("{} ({name})", map.file), source })
                }
                Err(why) => {
                    self.warn(of, name, format!("{name}: \"{}\" {why}", map.file.escape_debug()));
                    return None;
                }
            },
        };
        Some(self.placed(map, Texture::new(image)))
    }

    fn keep(&mut self, key: (PathBuf, String), image: Image) -> Id<Image> {
        let image = self.scene.images.push(image);
        self.images.insert(key, image);
        image
    }

    /// The file of a statement; what of its options is dropped is told.
    fn file(&mut self, of: &Definition, name: &str, map: &Map) -> Option<PathBuf> {
        for option in &map.dropped {
            self.warn(of, name, format!("option {option} of {name} is dropped"));
        }
        if map.blend[0] != map.blend[1] {
            let message = format!("{name} blends texels one way only; taken as both");
            self.lose(of, name, message, Loss::Approximated);
        }
        let found = self.find(&of.folder, &map.file);
        found.map_err(|e| self.warn(of, name, format!("{name}: {}", e.message))).ok()
    }

    /// A texture where the options put it.
    fn placed(&mut self, map: &Map, levels: Texture) -> Id<Texture> {
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        // The options speak of coordinates from the bottom left: v = 1 − v', and back.
        let shift = Vec2::new(map.offset.x, 1.0 - map.scale.y - map.offset.y);
        self.scene.textures.push(Texture {
            wrap_u: wrap,
            wrap_v: wrap,
            filter: if map.blend == [false; 2] { Filter::Nearest } else { Filter::Linear },
            transform: Affine2::from_mat2_translation(Mat2::from_diagonal(map.scale), shift),
            ..levels
        })
    }

    /// Looks beside the library, then beside the OBJ file.
    fn find(&mut self, folder: &str, file: &str) -> Result<PathBuf, Diagnostic> {
        let beside = if folder.is_empty() { file.to_owned() } else { format!("{folder}/{file}") };
        let found = self.request.resolve(&beside).or_else(|e| self.request.resolve(file).map_err(|_| e));
        let path =
            found.as_ref().map_or_else(|_| looked_for(self.request, &beside), |path| Some(path.clone()));
        self.files.extend(path.filter(|path| !self.files.contains(path)));
        found
    }

    /// Reports that a statement of the material, or something about it, is dropped.
    pub fn warn(&mut self, of: &Definition, statement: &str, message: String) {
        self.lose(of, statement, message, Loss::Dropped);
    }

    /// Reports what of a statement was approximated or dropped.
    pub fn lose(&mut self, of: &Definition, statement: &str, message: String, loss: Loss) {
        let line = of.lines.get(statement).copied().unwrap_or(of.line);
        let warning = Diagnostic::warning(message).losing(loss).in_file(&of.file).at(line, 1);
        self.report.add(warning.element(format!("newmtl {}", of.source.name.escape_debug())));
    }
}
