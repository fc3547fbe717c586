//! Material libraries, materials, textures.

use std::f32::consts::FRAC_PI_2;

use ajar_scene::{AlphaMode, Channel, ColorSpace, Wrap};
use glam::{Vec2, Vec3};

use super::{close, import, material, warnings};

#[test]
fn libraries_with_several_names_and_spaces() {
    let obj =
        |line: &str| format!("{line}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b b\nf 1 2 3\n");
    let (a, b): (&[u8], &[u8]) = (b"newmtl a\nmap_Kd t.png\n", b"newmtl b b\nKd 0.5\n");
    for (line, second) in [("mtllib sub/a.mtl b.mtl", "b.mtl"), ("mtllib my b.mtl sub\\a.mtl", "my b.mtl")] {
        let files = [("main.obj", obj(line)), ("sub/t.png", String::new())];
        let [(main, text), (image, empty)] = &files;
        let imported =
            import(&[(main, text.as_bytes()), ("sub/a.mtl", a), (second, b), (image, empty.as_bytes())])
                .unwrap();
        assert!(warnings(&imported).is_empty(), "{:?}", warnings(&imported));
        assert_eq!(imported.scene.materials.len(), 2);
        assert_eq!(imported.scene.images.len(), 1);
        assert_eq!(imported.files.len(), 4);
    }
    let imported = import(&[("main.obj", obj("mtllib c.mtl ../up.mtl /etc/hostname").as_bytes())]).unwrap();
    let said = warnings(&imported);
    assert!(said.len() == 5 && said[0].starts_with("material library: \"c.mtl\" cannot be read"), "{said:?}");
    assert_eq!(imported.files.len(), 2, "only what lies in the folder is watched: {:?}", imported.files);
}

#[test]
fn phong_materials() {
    let (m, i) = material("Ka 0.1 0.1 0.1\nKd 0.1 0.2 0.3\nKs 0 0 0\nNs 30\nillum 2");
    assert_eq!(m.base_color.value, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!((m.specular.value, m.metallic.value, m.ior), (0.0, 0.0, 1.5));
    assert!((m.roughness.value - 0.5).abs() < 1e-6);
    assert!(warnings(&i).is_empty() && i.diagnostics.iter().any(|d| d.message.contains("ambient")));
    let (m, _) = material("Kd 1\nKs 0.5 0.25 0.5\nNs 1000\nNi 1.33");
    assert_eq!((m.specular.value, m.roughness.value, m.ior), (1.0, 0.0, 1.33));
    assert_eq!(m.specular_color.value, Vec3::new(1.0, 0.5, 1.0));
    assert_eq!(material("Ks 1 1 1\nillum 1").0.specular.value, 0.0);
    let (m, _) = material("Kd 0 0 0\nKs 0.9 0.9 0.9\nillum 5");
    assert_eq!((m.metallic.value, m.base_color.value, m.roughness.value), (1.0, Vec3::splat(0.9), 0.0));
    let (m, _) = material("Kd 0.2 0.2 0.2\nKs 0.6 0.6 0.6\nillum 3\nNs 30");
    assert!(close(m.base_color.value * (1.0 - m.metallic.value), Vec3::splat(0.2)));
    assert!(close(m.base_color.value * m.metallic.value, Vec3::splat(0.6)));
}

#[test]
fn emission_opacity_and_glass() {
    let (m, _) = material("Kd 1 1 1\nKe 10 20 30");
    assert_eq!((m.emission.value, m.double_sided), (Vec3::new(10.0, 20.0, 30.0), true));
    for (statements, opacity) in [("d 0.75", 0.75), ("Tr 0.25", 0.75), ("d -halo 0.5", 0.5)] {
        let (m, i) = material(statements);
        assert_eq!((m.opacity.value, m.alpha_mode), (opacity, AlphaMode::Blend));
        assert!(warnings(&i).is_empty());
    }
    let (m, i) = material("Tr 0.5\nd 0.75");
    assert_eq!((m.opacity.value, warnings(&i).len()), (0.75, 1));
    let (m, _) = material("Kd 0 0 0\nTf 0.5 0.6 0.7\nNi 1.45\nd 0.1\nillum 7");
    assert_eq!((m.transmission.value, m.ior, m.roughness.value), (1.0, 1.45, 0.0));
    assert_eq!((m.base_color.value, m.alpha_mode), (Vec3::new(0.5, 0.6, 0.7), AlphaMode::Opaque));
    let (m, i) = material("Kd 0.5 0.5 0.5\nTf 1 1 1\nNi 1\nillum 4");
    assert_eq!((m.transmission.value, m.alpha_mode), (0.0, AlphaMode::Opaque));
    assert!(i.diagnostics.iter().any(|d| d.message.contains("taken as opaque")));
}

#[test]
fn the_pbr_extension() {
    let (m, i) = material(
        "Kd .5 .5 .5\nNs 30\nPr 0.2\nPm 0.3\nPs 0.4\nPc 0.5\nPcr 0.6\naniso 0.7\nanisor 0.25\nmap_Pm -imfchan b a.png\n\
         map_refl x.png\ndisp a.png\nnorm -bm 0.5 a.png\nmap_Ke a.png\n",
    );
    assert_eq!((m.roughness.value, m.metallic.value, m.coat.value), (0.2, 0.3, 0.5));
    assert_eq!((m.coat_roughness.value, m.anisotropy.value), (0.6, 0.7));
    assert!((m.anisotropy_rotation - FRAC_PI_2).abs() < 1e-6);
    let input = m.metallic.texture.unwrap();
    assert_eq!((input.channel, i.scene.textures[input.texture].color_space), (Channel::B, ColorSpace::Raw));
    assert_eq!(m.normal_map.unwrap().scale, 0.5);
    assert_eq!((m.sheen_color.value, m.sheen_roughness.value), (Vec3::splat(0.4), 0.3));
    assert_eq!(m.emission.value, Vec3::ONE);
    assert_eq!(i.scene.textures[m.emission.texture.unwrap().texture].color_space, ColorSpace::Srgb);
    assert_eq!((i.scene.images.len(), i.scene.textures.len()), (1, 3));
    let dropped = ["\"disp\" is dropped: surfaces are not displaced", "\"map_refl\" is dropped"];
    assert_eq!(warnings(&i), dropped.map(|message| format!("statement {message}")));
    assert_eq!(i.diagnostics.last().unwrap().element.as_deref(), Some("newmtl m"));
}

#[test]
fn texture_options_and_names() {
    let (m, i) =
        material("map_Kd -s 2 3 1 -o 0.5 0.25 -mm 0.1 0.8 -clamp on -colorspace linear b c.png -bm 2");
    let texture = &i.scene.textures[m.base_color.texture.unwrap().texture];
    assert_eq!((texture.wrap_u, texture.color_space), (Wrap::Clamp, ColorSpace::Raw));
    assert_eq!((texture.scale.x, texture.bias.x), (0.8, 0.1));
    // As the file means it: u, v from the bottom left.
    let (u, v) = (0.3, 0.4);
    let mapped = texture.transform.transform_point2(Vec2::new(u, 1.0 - v));
    assert!(mapped.abs_diff_eq(Vec2::new(2.0 * u + 0.5, 1.0 - (3.0 * v + 0.25)), 1e-6));
    assert!(warnings(&i).is_empty());

    let (m, i) = material(
        "map_Kd -type sphere -t 0.1 0.2 0.3 -blendu off \"a.png\"\nd 1\nmap_d a.png\nmap_Bump rock_normal.png",
    );
    assert_eq!((m.opacity.texture.unwrap().channel, m.alpha_mode), (Channel::A, AlphaMode::Mask(0.5)));
    assert!(m.normal_map.is_some());
    assert_eq!(warnings(&i).len(), 3);

    let (m, i) = material("map_Kd gone.png\nbump -bm 3 a.png\nKd 0 0 0");
    assert!(m.base_color.texture.is_none() && m.normal_map.is_none() && m.base_color.value == Vec3::ZERO);
    let said = warnings(&i);
    assert!(said.iter().any(|w| w.starts_with("map_Kd: \"gone.png\" cannot be read")), "{said:?}");
    assert!(said.iter().any(|w| w.starts_with("map_Bump: \"a.png\"")));
    assert!(i.files.iter().any(|file| file.ends_with("gone.png")), "watched until it comes");
}

#[test]
fn bad_statements_cost_only_themselves() {
    let (m, i) = material(
        "Kd nan 0 0\nKd 1 2\nKs spectral x.rfl\nPr\nillum x\nmap_Kd\nmap_Kd ../../secret.png\nKd 2 1 0",
    );
    assert_eq!(m.base_color.value, Vec3::new(1.0, 1.0, 0.0));
    assert_eq!(warnings(&i).len(), 8, "{:?}", warnings(&i));
}
