//! Small scenes built in code, and statistics to compare images.
#![allow(dead_code, clippy::unwrap_used, reason = "shared by several tests; a failing test panics")]

pub mod compare;
pub mod reversibility;
pub mod samples;
pub mod scenes;
pub mod shapes;
pub mod stationarity;

use ajar_integrators::{
    Context, Integrator, Settings, Window, brightness,
    mlt::{
        path::{Path, Space},
        seeds::{Bootstrap, resample},
    },
};
use ajar_render::{
    World,
    film::Film,
    rng::{Purpose, Rng},
    world::{PrepareOptions, prepare},
};
use ajar_scene::{
    Camera, Id, Image, ImageSource, Input, Light, LightKind, Material, Mesh, Node, Projection, Scene, Texture,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::{io::Cursor, sync::atomic::AtomicBool};

/// Adds meshes, lights and the camera to a scene.
#[derive(Default)]
pub struct Builder {
    pub scene: Scene,
    camera: Option<(Id<Camera>, DAffine3)>,
}

impl Builder {
    pub fn material(&mut self, material: Material) -> Id<Material> {
        self.scene.materials.push(material)
    }

    pub fn diffuse(&mut self, color: Vec3) -> Id<Material> {
        self.material(diffuse(color))
    }

    pub fn emitter(&mut self, radiance: Vec3) -> Id<Material> {
        self.material(Material {
            emission: Input::constant(radiance),
            double_sided: false,
            ..diffuse(Vec3::ZERO)
        })
    }

    /// A texture of 8 bits a channel, read as it is.
    pub fn texture(&mut self, [width, height]: [u32; 2], color: impl Fn(u32, u32) -> [u8; 3]) -> Id<Texture> {
        let mut bytes = Cursor::new(Vec::new());
        let image = image::RgbImage::from_fn(width, height, |x, y| image::Rgb(color(x, y)));
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let source = ImageSource::Embedded(bytes.into_inner().into());
        let image = self.scene.images.push(Image { name: "image".into(), source });
        self.scene.textures.push(Texture::new(image))
    }

    pub fn mesh(&mut self, mut mesh: Mesh, material: Id<Material>) -> &mut Self {
        mesh.material = Some(material);
        let mesh = self.scene.meshes.push(mesh);
        self.node(Node { meshes: vec![mesh], ..Node::default() })
    }

    pub fn node(&mut self, node: Node) -> &mut Self {
        let node = self.scene.nodes.push(node);
        self.scene.roots.push(node);
        self
    }

    /// A light at `position` that shines towards `target`.
    pub fn light(&mut self, kind: LightKind, position: DVec3, target: DVec3) -> &mut Self {
        let light = self.scene.lights.push(Light { name: String::new(), color: Vec3::ONE, kind });
        let transform = look(position, target);
        self.node(Node { light: Some(light), transform, ..Node::default() })
    }

    pub fn camera(&mut self, projection: Projection, position: DVec3, target: DVec3) -> &mut Self {
        let camera = Camera { name: String::new(), projection, aspect: None, exposure: 1.0 };
        self.camera = Some((self.scene.cameras.push(camera), look(position, target)));
        self
    }

    pub fn world(self, size: u32) -> World {
        let problems = self.scene.validate();
        assert!(problems.is_empty(), "{problems:?}");
        let camera = self.camera.unwrap();
        let options = PrepareOptions { camera, size: [size, size], texture_memory: 1 << 28 };
        prepare(self.scene, &options).unwrap().0
    }
}

pub fn diffuse(color: Vec3) -> Material {
    Material { base_color: Input::constant(color), specular: Input::constant(0.0), ..Material::default() }
}

pub fn pinhole(yfov: f32) -> Projection {
    Projection::Perspective { yfov, lens_radius: 0.0, focus_distance: 1.0, shift: [0.0; 2] }
}

fn look(position: DVec3, target: DVec3) -> DAffine3 {
    let up = if (target - position).normalize().y.abs() > 0.99 { DVec3::X } else { DVec3::Y };
    let z = (position - target).normalize();
    let x = up.cross(z).normalize();
    DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), position)
}

pub fn settings(world: &World, seed: u64, max_depth: usize, samples_per_round: u32) -> Settings {
    let window = Window { x0: 0, y0: 0, x1: world.camera.width, y1: world.camera.height };
    Settings { seed, max_depth, samples_per_round, window, metropolis: Default::default() }
}

/// Paths in proportion to their contribution.
pub fn seeds(world: &World, depth: usize, count: usize) -> (Space<'_>, Vec<Path>) {
    let settings = settings(world, 11, depth, 1);
    let space = Space::new(world, settings.window, depth);
    let bootstrap = Bootstrap::new(space, (11, 0), 4 * count as u32);
    let mut candidates = bootstrap.candidates();
    let chosen = resample(&mut candidates, count, &mut Rng::new(11, Purpose::Test, 0, 0));
    let mut tracer = bootstrap.tracer();
    let paths = chosen.iter().filter_map(|&i| {
        let mut path = Path::with_capacity();
        bootstrap.replay(&candidates[i as usize], &mut tracer, &mut path)?;
        Some(path)
    });
    (space, paths.collect())
}

/// So many in continuous integration, fifty times as many where `AJAR_RELEASE_TESTS` is set.
pub fn sized(count: usize) -> usize {
    if std::env::var_os("AJAR_RELEASE_TESTS").is_some() { 50 * count } else { count }
}

/// Renders `rounds` rounds.
pub fn render(world: &World, integrator: &dyn Integrator, settings: &Settings, rounds: u32) -> Film {
    let cancel = AtomicBool::new(false);
    let mut film = Film::new(settings.window.pixels(), brightness(world, settings.max_depth));
    let prepared = integrator.prepare(Context { world, settings, cancel: &cancel });
    for round in 0..rounds {
        let deposits = film.round();
        prepared.render(round, &deposits);
        film.merge(&deposits, prepared.scale());
    }
    assert_eq!(film.rejected(), 0);
    film
}

/// Block means of `rounds` rounds, each on its own.
pub fn render_blocks(
    world: &World,
    integrator: &dyn Integrator,
    settings: &Settings,
    rounds: u32,
) -> compare::Blocks {
    let cancel = AtomicBool::new(false);
    let unit = brightness(world, settings.max_depth);
    let prepared = integrator.prepare(Context { world, settings, cancel: &cancel });
    let mut blocks = compare::Blocks { rounds: Vec::new() };
    for round in 0..rounds {
        let mut film = Film::new(settings.window.pixels(), unit);
        let deposits = film.round();
        prepared.render(round, &deposits);
        film.merge(&deposits, prepared.scale());
        blocks.add(&film, world.camera.width as usize);
    }
    blocks
}
