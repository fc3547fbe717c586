//! The scenes that integrators must agree on.

use ajar_render::World;
use ajar_scene::{AlphaMode, Id, Input, LightKind, Material, NormalMap, Projection, Texture, TextureInput};
use glam::{DVec3, Vec3};

use super::{Builder, diffuse, pinhole, shapes};

/// A scene with the depth at which it is rendered.
pub struct TestScene {
    pub name: &'static str,
    pub world: fn() -> World,
    pub depth: usize,
}

const fn scene(name: &'static str, depth: usize, world: fn() -> World) -> TestScene {
    TestScene { name, world, depth }
}

/// All of them.
pub const SCENES: &[TestScene] = &[
    scene("diffuse room", 6, diffuse_room),
    scene("rough metal and plastic", 6, rough_metal_and_plastic),
    scene("mirror and glass", 8, mirror_and_glass),
    scene("rough glass", 8, rough_glass),
    scene("prisms", 8, prisms),
    scene("cloth, leaf and pearl", 6, cloth_leaf_and_pearl),
    scene("point light", 5, point_light),
    scene("spot light", 5, spot_light),
    scene("sun without extent", 5, directional_light),
    scene("sun and sky", 5, sun_and_sky),
    scene("thin lens", 5, thin_lens),
    scene("orthographic", 5, orthographic),
    scene("partial opacity", 5, partial_opacity),
];

/// A room with coloured walls, open to the camera, and a lamp under its ceiling.
fn room(lamp: bool) -> Builder {
    let mut b = Builder::default();
    let white = b.diffuse(Vec3::splat(0.7));
    let (red, green) = (b.diffuse(Vec3::new(0.6, 0.1, 0.1)), b.diffuse(Vec3::new(0.1, 0.5, 0.1)));
    let side = |o, a, b| shapes::quad(o, a, b);
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let low = Vec3::splat(-1.0);
    b.mesh(side(low, z, x), white).mesh(side(low + y, x, z), white).mesh(side(low, x, y), white);
    b.mesh(side(low, y, z), red).mesh(side(low + x, z, y), green);
    if lamp {
        let light = b.emitter(Vec3::new(17.0, 12.0, 6.0));
        b.mesh(side(Vec3::new(-0.25, 0.98, -0.25), Vec3::X * 0.5, Vec3::Z * 0.5), light);
    }
    b.camera(pinhole(0.7), DVec3::new(0.0, 0.0, 3.8), DVec3::ZERO);
    b
}

fn diffuse_room() -> World {
    let mut b = room(true);
    let white = b.diffuse(Vec3::splat(0.7));
    b.mesh(shapes::cuboid(Vec3::new(-0.6, -1.0, -0.5), Vec3::new(-0.1, 0.2, 0.0), false), white);
    b.world(32)
}

fn rough_metal_and_plastic() -> World {
    let mut b = room(true);
    let metal = b.material(Material {
        metallic: Input::constant(1.0),
        roughness: Input::constant(0.45),
        anisotropy: Input::constant(0.5),
        ..Material::default()
    });
    let coated = b.material(Material {
        base_color: Input::constant(Vec3::new(0.2, 0.3, 0.8)),
        coat: Input::constant(1.0),
        coat_roughness: Input::constant(0.4),
        ..Material::default()
    });
    b.mesh(shapes::sphere(Vec3::new(-0.4, -0.6, -0.2), 0.4, 16, true), metal);
    b.mesh(shapes::sphere(Vec3::new(0.45, -0.6, 0.2), 0.4, 8, true), coated);
    b.world(32)
}

fn mirror_and_glass() -> World {
    let mut b = room(true);
    let mirror = b.material(Material {
        metallic: Input::constant(1.0),
        roughness: Input::constant(0.0),
        ..Material::default()
    });
    let glass = b.material(Material {
        base_color: Input::constant(Vec3::ONE),
        transmission: Input::constant(1.0),
        roughness: Input::constant(0.0),
        attenuation_color: Vec3::new(0.9, 0.5, 0.5),
        attenuation_distance: 0.5,
        ..Material::default()
    });
    b.mesh(shapes::cuboid(Vec3::new(-0.7, -1.0, -0.6), Vec3::new(-0.1, 0.1, -0.1), false), mirror);
    b.mesh(shapes::sphere(Vec3::new(0.4, -0.4, 0.2), 0.4, 24, true), glass);
    b.world(32)
}

fn rough_glass() -> World {
    let mut b = room(true);
    let frosted = b.material(Material {
        base_color: Input::constant(Vec3::new(0.9, 0.9, 1.0)),
        transmission: Input::constant(1.0),
        roughness: Input::constant(0.5),
        ..Material::default()
    });
    b.mesh(shapes::sphere(Vec3::new(0.1, -0.4, 0.2), 0.5, 16, true), frosted);
    b.world(32)
}

fn prisms() -> World {
    let mut b = room(true);
    let mut glass = |roughness| {
        b.material(Material {
            transmission: Input::constant(1.0),
            roughness: Input::constant(roughness),
            dispersion: 4.0,
            ..Material::default()
        })
    };
    let (smooth, rough) = (glass(0.0), glass(0.4));
    b.mesh(shapes::sphere(Vec3::new(-0.4, -0.5, 0.2), 0.4, 16, true), smooth);
    b.mesh(shapes::cuboid(Vec3::new(0.2, -0.8, -0.2), Vec3::new(0.8, 0.0, 0.4), false), rough);
    b.world(32)
}

fn cloth_leaf_and_pearl() -> World {
    let mut b = room(true);
    let cloth = b.material(Material {
        base_color: Input::constant(Vec3::new(0.2, 0.1, 0.4)),
        sheen_color: Input::constant(Vec3::new(0.9, 0.7, 0.8)),
        sheen_roughness: Input::constant(0.4),
        coat: Input::constant(0.5),
        ..Material::default()
    });
    let leaf = b.material(Material {
        base_color: Input::constant(Vec3::new(0.3, 0.5, 0.1)),
        diffuse_transmission: Input::constant(0.6),
        diffuse_transmission_color: Input::constant(Vec3::new(0.7, 0.9, 0.2)),
        attenuation_color: Vec3::new(0.9, 0.7, 0.5),
        attenuation_distance: 0.5,
        ..Material::default()
    });
    let pearl = b.material(Material {
        film: Input::constant(1.0),
        film_thickness: Input::constant(500.0),
        roughness: Input::constant(0.3),
        ..Material::default()
    });
    b.mesh(shapes::sphere(Vec3::new(-0.5, -0.6, -0.2), 0.4, 16, true), cloth);
    b.mesh(shapes::quad(Vec3::new(-0.6, 0.2, -0.5), Vec3::X * 1.2, Vec3::Z), leaf);
    b.mesh(shapes::cuboid(Vec3::new(-0.1, -1.0, 0.3), Vec3::new(0.2, -0.5, 0.6), false), leaf);
    b.mesh(shapes::sphere(Vec3::new(0.5, -0.6, 0.2), 0.4, 16, true), pearl);
    b.world(32)
}

fn lit_by(kind: LightKind) -> World {
    let mut b = room(false);
    let white = b.diffuse(Vec3::splat(0.7));
    b.mesh(shapes::sphere(Vec3::new(0.1, -0.4, 0.0), 0.3, 6, true), white);
    b.light(kind, DVec3::new(0.3, 0.7, 1.5), DVec3::new(0.0, -0.7, -0.3));
    b.world(32)
}

fn point_light() -> World {
    lit_by(LightKind::Point { intensity: 3.0 })
}

fn spot_light() -> World {
    lit_by(LightKind::Spot { intensity: 8.0, inner: 0.3, outer: 0.6 })
}

fn directional_light() -> World {
    lit_by(LightKind::Directional { illuminance: 4.0, angle: 0.0 })
}

fn sun_and_sky() -> World {
    let mut b = room(false);
    let white = b.diffuse(Vec3::splat(0.5));
    b.mesh(shapes::sphere(Vec3::new(0.1, -0.4, 0.0), 0.3, 8, true), white);
    b.light(LightKind::Environment { radiance: 0.7, texture: None }, DVec3::ZERO, DVec3::NEG_Z);
    b.light(
        LightKind::Directional { illuminance: 3.0, angle: 0.2 },
        DVec3::ZERO,
        DVec3::new(0.2, -0.5, -0.8),
    );
    b.world(32)
}

fn thin_lens() -> World {
    let mut b = room(true);
    let white = b.diffuse(Vec3::splat(0.7));
    b.mesh(shapes::sphere(Vec3::new(0.3, -0.5, 0.6), 0.3, 8, true), white);
    let lens =
        Projection::Perspective { yfov: 0.7, lens_radius: 0.15, focus_distance: 3.2, shift: [0.1, 0.0] };
    b.camera(lens, DVec3::new(0.0, 0.0, 3.8), DVec3::ZERO);
    b.world(32)
}

fn orthographic() -> World {
    let mut b = room(true);
    let mirror = b.material(Material {
        metallic: Input::constant(1.0),
        roughness: Input::constant(0.0),
        ..Material::default()
    });
    b.mesh(shapes::sphere(Vec3::new(0.3, -0.5, 0.0), 0.4, 12, true), mirror);
    b.camera(Projection::Orthographic { half_height: 1.1 }, DVec3::new(0.3, 0.2, 3.0), DVec3::ZERO);
    b.world(32)
}

fn partial_opacity() -> World {
    let mut b = room(true);
    let veil = b.material(Material {
        opacity: Input::constant(0.4),
        alpha_mode: AlphaMode::Blend,
        ..diffuse(Vec3::new(0.2, 0.6, 0.6))
    });
    b.mesh(shapes::quad(Vec3::new(-0.8, 0.3, -0.6), Vec3::X * 1.6, Vec3::Z * 1.4), veil);
    let glowing = b.material(Material {
        opacity: Input::constant(0.4),
        alpha_mode: AlphaMode::Blend,
        emission: Input::constant(Vec3::new(0.5, 0.9, 0.4)),
        ..diffuse(Vec3::new(0.2, 0.6, 0.6))
    });
    b.mesh(shapes::quad(Vec3::new(-0.8, -0.9, 0.3), Vec3::X * 0.9, Vec3::Y * 0.9), glowing);
    b.world(32)
}

/// A surface whose colour, roughness and normals come from images. Needs normals and texture coordinates.
pub fn plaster(b: &mut Builder) -> Id<Material> {
    let angle = |texel: u32| std::f32::consts::TAU * texel as f32 / 8.0;
    let color =
        b.texture([8, 8], |x, y| [90 + 20 * x as u8, 200 - 15 * y as u8, 100 + 30 * (x ^ y) as u8 / 2]);
    let roughness = b.texture([8, 1], |x, _| [130 + 15 * x as u8; 3]);
    let normals = b.texture([8, 8], |x, y| {
        let n = Vec3::new(0.4 * angle(x).sin(), 0.4 * angle(y).cos(), 1.0).normalize();
        (n * 0.5 + 0.5).to_array().map(|c| (c * 255.0).round() as u8)
    });
    let read = |texture| Some(TextureInput { texture, channel: Default::default() });
    b.material(Material {
        base_color: Input { value: Vec3::splat(0.9), texture: read(color) },
        roughness: Input { value: 1.0, texture: read(roughness) },
        normal_map: Some(NormalMap { texture: normals, scale: 1.0 }),
        ..Material::default()
    })
}

/// A blue sky over brown earth, with a bright spot.
pub fn sky(b: &mut Builder) -> Id<Texture> {
    b.texture([8, 4], |x, y| match (x, y) {
        (3, 1) => [255, 230, 180],
        (_, 0 | 1) => [60 + 8 * x as u8, 100, 160 - 10 * x as u8],
        _ => [50, 40, 30],
    })
}

/// Textures, normal maps and surroundings from images, through a thin lens.
pub const IMAGES: TestScene = scene("images", 5, images);

fn images() -> World {
    let mut b = Builder::default();
    let (plaster, white) = (plaster(&mut b), b.diffuse(Vec3::splat(0.7)));
    let low = Vec3::splat(-1.0);
    b.mesh(shapes::board(low, Vec3::Z * 2.0, Vec3::X * 2.0), plaster);
    b.mesh(shapes::board(low, Vec3::X * 2.0, Vec3::Y * 2.0), plaster);
    b.mesh(shapes::sphere(Vec3::new(0.3, -0.4, 0.2), 0.4, 8, true), white);
    let texture = Some(sky(&mut b));
    b.light(LightKind::Environment { radiance: 2.0, texture }, DVec3::ZERO, DVec3::NEG_Z);
    let lens = Projection::Perspective { yfov: 0.7, lens_radius: 0.1, focus_distance: 3.4, shift: [0.0; 2] };
    b.camera(lens, DVec3::new(0.0, 0.1, 3.8), DVec3::ZERO);
    b.world(32)
}

/// A room that gets all its light through the gap of a door, from an emitter in the next room: a metal ball, a glass one
/// and a block on a table, everything else diffuse and flat.
pub const DOOR_AJAR: TestScene = scene("door ajar", 16, door_ajar);

fn door_ajar() -> World {
    let mut b = Builder::default();
    let (white, wood) = (b.diffuse(Vec3::splat(0.73)), b.diffuse(Vec3::new(0.5, 0.4, 0.3)));
    let red = b.diffuse(Vec3::new(0.6, 0.2, 0.15));
    let metal = b.material(Material {
        base_color: Input::constant(Vec3::ONE),
        metallic: Input::constant(1.0),
        roughness: Input::constant(0.3),
        ..Material::default()
    });
    let glass = b.material(Material {
        base_color: Input::constant(Vec3::ONE),
        transmission: Input::constant(1.0),
        roughness: Input::constant(0.0),
        ..Material::default()
    });
    let lamp = b.emitter(Vec3::new(1000.0, 900.0, 700.0));
    let mut block = |low: [f32; 3], high: [f32; 3], material| {
        b.mesh(shapes::cuboid(low.into(), high.into(), false), material);
    };
    // Floor, ceiling and outer walls; the camera's room ends at z = -2, the bright one at z = -4.5.
    block([-2.2, -0.2, -4.7], [2.2, 0.0, 2.2], wood);
    block([-2.2, 2.6, -4.7], [2.2, 2.8, 2.2], white);
    block([-2.2, -0.1, -4.7], [-2.0, 2.7, 2.2], white);
    block([2.0, -0.1, -4.7], [2.2, 2.7, 2.2], white);
    block([-2.2, -0.1, 2.0], [2.2, 2.7, 2.2], white);
    block([-2.2, -0.1, -4.7], [2.2, 2.7, -4.5], white);
    // The wall between, with its opening.
    block([-2.1, -0.1, -2.1], [0.4, 2.7, -2.0], white);
    block([1.3, -0.1, -2.1], [2.1, 2.7, -2.0], white);
    block([0.3, 2.05, -2.1], [1.4, 2.7, -2.0], white);
    // The table and the block on it.
    block([-1.0, 0.7, -0.7], [0.4, 0.75, 0.2], wood);
    for (x, z) in [(-0.95, -0.65), (0.3, -0.65), (-0.95, 0.1), (0.3, 0.1)] {
        block([x, -0.01, z], [x + 0.05, 0.71, z + 0.05], wood);
    }
    block([-0.85, 0.75, -0.4], [-0.6, 1.0, -0.15], red);
    // The door hangs on the right and opens towards the camera by five degrees.
    let mut door = shapes::cuboid(Vec3::new(-0.898, 0.003, -0.04), Vec3::new(0.0, 2.045, 0.0), false);
    let turn = glam::Quat::from_rotation_y(5f32.to_radians());
    for p in &mut door.positions {
        *p = turn * *p + Vec3::new(1.299, 0.0, -2.0);
    }
    b.mesh(door, red);
    b.mesh(shapes::sphere(Vec3::new(-0.3, 0.9, -0.35), 0.15, 24, true), metal);
    b.mesh(shapes::sphere(Vec3::new(0.05, 0.9, -0.2), 0.15, 24, true), glass);
    b.mesh(shapes::quad(Vec3::new(-1.5, 0.6, -4.48), Vec3::X * 2.1, Vec3::Y * 1.6), lamp);
    b.camera(pinhole(45f32.to_radians()), DVec3::new(-1.0, 1.45, 1.7), DVec3::new(-0.05, 0.85, -0.9));
    b.world(32)
}

/// Caustics of a light without extent, which path tracing does not find.
pub const POINT_LIGHT_AND_GLASS: TestScene = scene("point light and glass", 6, point_light_and_glass);

fn point_light_and_glass() -> World {
    let mut b = room(false);
    let glass = b.material(Material {
        transmission: Input::constant(1.0),
        roughness: Input::constant(0.0),
        ..Material::default()
    });
    b.mesh(shapes::cuboid(Vec3::new(-0.5, -0.3, -0.4), Vec3::new(0.4, 0.0, 0.4), false), glass);
    b.light(LightKind::Point { intensity: 3.0 }, DVec3::new(0.1, 0.8, 0.1), DVec3::ZERO);
    b.world(32)
}
