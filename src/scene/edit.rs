//! Joining scenes.

use crate::{Arena, Id, LightKind, Material, NormalMap, Scene, Texture, TextureInput};

impl Scene {
    /// Adds everything that `other` holds, with handles renumbered, and returns the nodes that were its roots. They do
    /// not become roots of this scene: the caller places them. What dangled in `other` dangles here too.
    pub fn append(&mut self, other: Scene) -> Vec<Id<crate::Node>> {
        let Scene { nodes, roots, meshes, materials, textures, images, lights, cameras } = other;
        let node = Shift::new(&self.nodes, &nodes);
        let mesh = Shift::new(&self.meshes, &meshes);
        let material = Shift::new(&self.materials, &materials);
        let texture = Shift::new(&self.textures, &textures);
        let image = Shift::new(&self.images, &images);
        let light = Shift::new(&self.lights, &lights);
        let camera = Shift::new(&self.cameras, &cameras);

        for mut item in nodes {
            item.children.iter_mut().for_each(|id| node.apply(id));
            item.meshes.iter_mut().for_each(|id| mesh.apply(id));
            item.material.iter_mut().for_each(|id| material.apply(id));
            item.light.iter_mut().for_each(|id| light.apply(id));
            item.camera.iter_mut().for_each(|id| camera.apply(id));
            self.nodes.push(item);
        }
        for mut item in meshes {
            item.material.iter_mut().for_each(|id| material.apply(id));
            self.meshes.push(item);
        }
        for mut item in materials {
            item.textures_mut().for_each(|id| texture.apply(id));
            self.materials.push(item);
        }
        for mut item in textures {
            image.apply(&mut item.image);
            self.textures.push(item);
        }
        for mut item in lights {
            if let LightKind::Rect { texture: Some(id), .. }
            | LightKind::Environment { texture: Some(id), .. } = &mut item.kind
            {
                texture.apply(id);
            }
            self.lights.push(item);
        }
        for item in images {
            self.images.push(item);
        }
        for item in cameras {
            self.cameras.push(item);
        }
        roots.into_iter().map(|mut id| (node.apply(&mut id), id).1).collect()
    }
}

impl Material {
    /// The handles of all textures that this material names.
    pub fn textures(&self) -> impl Iterator<Item = Id<Texture>> + use<> {
        let mut copy = self.clone();
        copy.textures_mut().map(|id| *id).collect::<Vec<_>>().into_iter()
    }

    fn textures_mut(&mut self) -> impl Iterator<Item = &mut Id<Texture>> {
        let inputs: [&mut Option<TextureInput>; 18] = [
            &mut self.base_color.texture,
            &mut self.diffuse_roughness.texture,
            &mut self.metallic.texture,
            &mut self.roughness.texture,
            &mut self.anisotropy.texture,
            &mut self.specular.texture,
            &mut self.specular_color.texture,
            &mut self.transmission.texture,
            &mut self.diffuse_transmission.texture,
            &mut self.diffuse_transmission_color.texture,
            &mut self.sheen_color.texture,
            &mut self.sheen_roughness.texture,
            &mut self.film.texture,
            &mut self.film_thickness.texture,
            &mut self.coat.texture,
            &mut self.coat_roughness.texture,
            &mut self.emission.texture,
            &mut self.opacity.texture,
        ];
        let maps = [&mut self.normal_map, &mut self.coat_normal_map].into_iter().flatten();
        let others = maps.map(|NormalMap { texture, .. }| texture).chain(&mut self.anisotropy_direction);
        inputs.into_iter().flatten().map(|input| &mut input.texture).chain(others)
    }
}

/// Renumbers handles of one kind.
struct Shift {
    offset: usize,
    len: usize,
}

impl Shift {
    fn new<T>(into: &Arena<T>, from: &Arena<T>) -> Self {
        Self { offset: into.len(), len: from.len() }
    }

    /// A handle that dangles must not point at something by accident after more is added.
    fn apply<T>(&self, id: &mut Id<T>) {
        let inside = id.index() < self.len;
        *id = Id::new(if inside { id.index() + self.offset } else { u32::MAX as usize });
    }
}
