//! A content hash of scenes: BLAKE3 over a canonical stream of bytes, the same on every platform.
//!
//! Numbers count by their bits (so −0 is not 0), little-endian; every list is led by its length and every choice by a
//! tag, so no two scenes share a stream. Every struct is taken apart without `..`: a new field does not compile until it
//! is hashed.

use std::{fs::File, path::Path};

use glam::{DAffine3, Vec3};

use crate::{
    AlphaMode, Arena, Camera, Channel, ColorSpace, Filter, Id, Image, ImageSource, Input, Light, LightKind,
    Material, Mesh, Node, NormalMap, Projection, Scene, Texture, TextureInput, Wrap,
};

impl Scene {
    /// BLAKE3 of the scene's content, 64 hexadecimal digits. Scenes with the same values have the same hash. Image
    /// files count by their bytes, not by where they lie or what they are called; one that cannot be read counts as
    /// such.
    pub fn content_hash(&self) -> String {
        let Scene { nodes, roots, meshes, materials, textures, images, lights, cameras } = self;
        let mut sink = Sink(blake3::Hasher::new());
        sink.text("ajar scene 1");
        sink.all(nodes, Sink::node);
        sink.ids(roots);
        sink.all(meshes, Sink::mesh);
        sink.all(materials, Sink::material);
        sink.all(textures, Sink::texture);
        sink.all(images, Sink::image);
        sink.all(lights, Sink::light);
        sink.all(cameras, Sink::camera);
        sink.0.finalize().to_hex().to_string()
    }
}

struct Sink(blake3::Hasher);

/// Primitives.
impl Sink {
    fn tag(&mut self, tag: u8) {
        self.0.update(&[tag]);
    }

    fn len(&mut self, len: usize) {
        self.0.update(&(len as u64).to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.len(text.len());
        self.0.update(text.as_bytes());
    }

    fn f32s<const N: usize>(&mut self, values: [f32; N]) {
        for value in values {
            self.0.update(&value.to_le_bytes());
        }
    }

    /// A whole slice at once where memory already holds the canonical bytes.
    fn slice<T: bytemuck::NoUninit>(&mut self, items: &[T]) {
        self.len(items.len());
        let words: &[u32] = bytemuck::cast_slice(items);
        if cfg!(target_endian = "little") {
            self.0.update(bytemuck::cast_slice(words));
        } else {
            for word in words {
                self.0.update(&word.to_le_bytes());
            }
        }
    }

    fn some<T>(&mut self, value: Option<T>, hash: impl FnOnce(&mut Self, T)) {
        self.tag(u8::from(value.is_some()));
        if let Some(value) = value {
            hash(self, value);
        }
    }

    fn id<T>(&mut self, id: Id<T>) {
        self.0.update(&(id.index() as u32).to_le_bytes());
    }

    fn ids<T>(&mut self, ids: &[Id<T>]) {
        self.len(ids.len());
        ids.iter().for_each(|&id| self.id(id));
    }

    fn all<T>(&mut self, items: &Arena<T>, hash: fn(&mut Self, &T)) {
        self.len(items.len());
        items.iter().for_each(|item| hash(self, item));
    }
}

/// The parts of a scene.
impl Sink {
    fn node(&mut self, node: &Node) {
        let Node { name, transform, children, meshes, material, light, camera, visible } = node;
        self.text(name);
        self.transform(transform);
        self.ids(children);
        self.ids(meshes);
        self.some(*material, Self::id);
        self.some(*light, Self::id);
        self.some(*camera, Self::id);
        self.tag(u8::from(*visible));
    }

    fn transform(&mut self, transform: &DAffine3) {
        for value in transform.to_cols_array() {
            self.0.update(&value.to_le_bytes());
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        let Mesh { name, positions, triangles, normals, tangents, uvs, colors, material } = mesh;
        self.text(name);
        self.slice(positions);
        self.slice(triangles);
        self.some(normals.as_deref(), Self::slice);
        self.some(tangents.as_deref(), Self::slice);
        self.len(uvs.len());
        uvs.iter().for_each(|set| self.slice(set));
        self.some(colors.as_deref(), Self::slice);
        self.some(*material, Self::id);
    }

    fn material(&mut self, material: &Material) {
        let Material {
            name,
            path,
            base_color,
            diffuse_roughness,
            metallic,
            roughness,
            anisotropy,
            anisotropy_rotation,
            anisotropy_direction,
            specular,
            specular_color,
            ior,
            dispersion,
            transmission,
            diffuse_transmission,
            diffuse_transmission_color,
            thin_walled,
            attenuation_color,
            attenuation_distance,
            sheen_color,
            sheen_roughness,
            film,
            film_ior,
            film_thickness,
            coat,
            coat_roughness,
            coat_ior,
            emission,
            double_sided,
            cull_back,
            opacity,
            alpha_mode,
            normal_map,
            coat_normal_map,
            unlit,
        } = material;
        self.text(name);
        self.text(path);
        [base_color, specular_color, emission, diffuse_transmission_color, sheen_color]
            .into_iter()
            .for_each(|input| self.color(input));
        [
            diffuse_roughness,
            metallic,
            roughness,
            anisotropy,
            specular,
            transmission,
            diffuse_transmission,
            sheen_roughness,
            film,
            film_thickness,
            coat,
            coat_roughness,
            opacity,
        ]
        .into_iter()
        .for_each(|input| self.scalar(input));
        self.f32s([*anisotropy_rotation, *ior, *dispersion, *attenuation_distance, *film_ior, *coat_ior]);
        self.some(*anisotropy_direction, Self::id);
        self.f32s(attenuation_color.to_array());
        [thin_walled, double_sided, cull_back, unlit].into_iter().for_each(|&flag| self.tag(u8::from(flag)));
        match *alpha_mode {
            AlphaMode::Opaque => self.tag(0),
            AlphaMode::Mask(cutoff) => {
                self.tag(1);
                self.f32s([cutoff]);
            }
            AlphaMode::Blend => self.tag(2),
        }
        for map in [normal_map, coat_normal_map] {
            self.some(*map, |sink, NormalMap { texture, scale }| {
                sink.id(texture);
                sink.f32s([scale]);
            });
        }
    }

    fn color(&mut self, Input { value, texture }: &Input<Vec3>) {
        self.f32s(value.to_array());
        self.some(*texture, Self::texture_input);
    }

    fn scalar(&mut self, Input { value, texture }: &Input<f32>) {
        self.f32s([*value]);
        self.some(*texture, Self::texture_input);
    }

    fn texture_input(&mut self, TextureInput { texture, channel }: TextureInput) {
        self.id(texture);
        self.tag(match channel {
            Channel::R => 0,
            Channel::G => 1,
            Channel::B => 2,
            Channel::A => 3,
            Channel::L => 4,
        });
    }

    fn texture(&mut self, texture: &Texture) {
        let Texture { image, color_space, wrap_u, wrap_v, filter, uv_set, transform, scale, bias } = texture;
        self.id(*image);
        self.tag(match color_space {
            ColorSpace::Srgb => 0,
            ColorSpace::Raw => 1,
            ColorSpace::Auto => 2,
        });
        [wrap_u, wrap_v].into_iter().for_each(|wrap| {
            self.tag(match wrap {
                Wrap::Repeat => 0,
                Wrap::Mirror => 1,
                Wrap::Clamp => 2,
                Wrap::Black => 3,
            });
        });
        self.tag(match filter {
            Filter::Linear => 0,
            Filter::Nearest => 1,
        });
        self.0.update(&uv_set.to_le_bytes());
        self.f32s(transform.to_cols_array());
        self.f32s(scale.to_array());
        self.f32s(bias.to_array());
    }

    /// By content: the name, meant for messages, may be a path, and the same picture may lie in another folder.
    fn image(&mut self, Image { name: _, source }: &Image) {
        let content = match source {
            ImageSource::Embedded(bytes) => Some(blake3::hash(bytes)),
            ImageSource::File(path) => file_hash(path),
        };
        self.some(content, |sink, hash| {
            sink.0.update(hash.as_bytes());
        });
    }

    fn light(&mut self, Light { name, color, kind }: &Light) {
        self.text(name);
        self.f32s(color.to_array());
        match *kind {
            LightKind::Point { intensity } => self.kind(0, [intensity]),
            LightKind::Spot { intensity, inner, outer } => self.kind(1, [intensity, inner, outer]),
            LightKind::Directional { illuminance, angle } => self.kind(2, [illuminance, angle]),
            LightKind::Rect { radiance, width, height, texture } => {
                self.kind(3, [radiance, width, height]);
                self.some(texture, Self::id);
            }
            LightKind::Disk { radiance, radius } => self.kind(4, [radiance, radius]),
            LightKind::Sphere { radiance, radius } => self.kind(5, [radiance, radius]),
            LightKind::Cylinder { radiance, radius, length } => self.kind(6, [radiance, radius, length]),
            LightKind::Environment { radiance, texture } => {
                self.kind(7, [radiance]);
                self.some(texture, Self::id);
            }
        }
    }

    fn camera(&mut self, Camera { name, projection, aspect, exposure }: &Camera) {
        self.text(name);
        match *projection {
            Projection::Perspective { yfov, lens_radius, focus_distance, shift: [right, up] } => {
                self.kind(0, [yfov, lens_radius, focus_distance, right, up]);
            }
            Projection::Orthographic { half_height } => self.kind(1, [half_height]),
        }
        self.some(*aspect, |sink, aspect| sink.f32s([aspect]));
        self.f32s([*exposure]);
    }

    fn kind<const N: usize>(&mut self, tag: u8, values: [f32; N]) {
        self.tag(tag);
        self.f32s(values);
    }
}

fn file_hash(path: &Path) -> Option<blake3::Hash> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(File::open(path).ok()?).ok()?;
    Some(hasher.finalize())
}
