//! The scenes that integrators must agree on.

use ajar_render::World;
use ajar_scene::{AlphaMode, Input, LightKind, Material, Projection};
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
    b.mesh(shapes::quad(Vec3::new(-0.8, -0.9, 0.3), Vec3::X * 0.9, Vec3::Y * 0.9), veil);
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
