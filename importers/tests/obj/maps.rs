//! Maps that become other images, options of maps, and maps that nothing can show.

use std::{fs, io::Cursor};

use ajar_importers::obj::Obj;
use ajar_scene::{
    Channel, Filter, ImageSource, ImportRequest, Imported, Importer, Loss, Material, Severity, Wrap,
};
use glam::Vec3;
use image::{GrayImage, ImageFormat, Luma, Rgb, RgbImage};

use super::{import, warnings};

const TRIANGLE: &[u8] = b"mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A texel further right is this much higher.
const STEP: f32 = 8.0 / 255.0;

/// `ramp.png`, which rises to the right; `grey.png`; `green.png`.
fn images() -> [(&'static str, Vec<u8>); 3] {
    let png = |image: &dyn Fn(&mut Cursor<Vec<u8>>)| {
        let mut file = Cursor::new(Vec::new());
        image(&mut file);
        file.into_inner()
    };
    let ramp = GrayImage::from_fn(16, 8, |x, _| Luma([8 * x as u8]));
    let grey = GrayImage::from_pixel(4, 4, Luma([51]));
    let green = RgbImage::from_pixel(4, 4, Rgb([0, 255, 0]));
    [
        ("ramp.png", png(&|file| ramp.write_to(file, ImageFormat::Png).unwrap())),
        ("grey.png", png(&|file| grey.write_to(file, ImageFormat::Png).unwrap())),
        ("green.png", png(&|file| green.write_to(file, ImageFormat::Png).unwrap())),
    ]
}

/// A triangle of a material with these statements.
fn mapped(statements: &str) -> (Material, Imported) {
    let (images, library) = (images(), format!("newmtl m\n{statements}\n"));
    let mut files: Vec<(&str, &[u8])> = vec![("main.obj", TRIANGLE), ("m.mtl", library.as_bytes())];
    files.extend(images.iter().map(|(name, bytes)| (*name, bytes.as_slice())));
    let imported = import(&files).unwrap();
    (imported.scene.materials.iter().next().unwrap().clone(), imported)
}

/// A texel of an image that was made.
fn texel(imported: &Imported, texture: ajar_scene::Id<ajar_scene::Texture>, x: u32, y: u32) -> [f32; 3] {
    let image = &imported.scene.images[imported.scene.textures[texture].image];
    let ImageSource::Embedded(bytes) = &image.source else { panic!("{image:?}") };
    image::load_from_memory(bytes).unwrap().into_rgb32f().get_pixel(x, y).0
}

/// To within what 16 bits hold.
fn close(a: Vec3, b: Vec3) -> bool {
    a.abs_diff_eq(b, 1e-4)
}

fn normal(statements: &str, x: u32, y: u32) -> Vec3 {
    let (material, imported) = mapped(statements);
    Vec3::from(texel(&imported, material.normal_map.unwrap().texture, x, y)) * 2.0 - 1.0
}

#[test]
fn heights_become_normals() {
    let (material, imported) = mapped("bump -bm 2 -mm 0.5 3 ramp.png");
    // Factors of heights are factors of slopes.
    assert_eq!(material.normal_map.unwrap().scale, 6.0);
    assert_eq!(imported.scene.images.iter().next().unwrap().name, "ramp.png (map_Bump)");
    let said: Vec<_> = imported.diagnostics.iter().filter(|d| d.severity == Severity::Warning).collect();
    assert!(said.len() == 1 && said[0].loss == Some(Loss::Approximated), "{said:?}");
    assert_eq!(said[0].place, Some((2, 1)), "the line of the statement");

    let rising = Vec3::new(-STEP, 0.0, 1.0).normalize();
    assert!(close(normal("bump ramp.png", 5, 3), rising));
    // Over the edge it falls to the other side, unless the image ends there.
    assert!(normal("bump ramp.png", 15, 3).x > 0.1);
    assert!(close(normal("bump -clamp on ramp.png", 15, 3), Vec3::new(-STEP / 2.0, 0.0, 1.0).normalize()));
    assert!(close(normal("bump -s -1 1 ramp.png", 5, 3), rising * Vec3::new(-1.0, 1.0, 1.0)));
    assert!(close(normal("bump green.png", 1, 1), Vec3::Z));
}

/// One image in the scene, however many materials name it.
#[test]
fn images_are_made_once() {
    let obj =
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n";
    let mtl = "newmtl a\nbump ramp.png\nnewmtl b\nbump -bm 3 ramp.png\nnewmtl c\nbump -clamp on ramp.png\n";
    let [ramp, ..] = images();
    let imported =
        import(&[("main.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes()), (ramp.0, &ramp.1)]).unwrap();
    assert_eq!((imported.scene.textures.len(), imported.scene.images.len()), (3, 2));
}

#[test]
fn exponents_become_roughness() {
    // A fifth of 150 is 30, whose roughness is a half.
    for statements in ["Ns 150\nmap_Ns grey.png", "Ns 60\nmap_Ns -mm 0.3 1 grey.png"] {
        let (material, imported) = mapped(statements);
        let map = material.roughness.texture.unwrap();
        let [roughness, ..] = texel(&imported, map.texture, 1, 2);
        assert!((material.roughness.value * roughness - 0.5).abs() < 1e-4, "{statements}: {roughness}");
        assert!(warnings(&imported).is_empty());
    }
    let (material, imported) = mapped("map_Ns green.png");
    let [roughness, ..] = texel(&imported, material.roughness.texture.unwrap().texture, 1, 2);
    // Its luminance of the 1000 that is taken.
    assert!((roughness - (2.0_f32 / 717.2).sqrt().sqrt()).abs() < 1e-4, "{roughness}");
    assert_eq!(warnings(&imported), ["map_Ns is there without an Ns above 0, which is taken as 1000"]);
    let (material, imported) = mapped("Pr 0.3\nNs 10\nmap_Ns grey.png");
    assert_eq!((material.roughness.value, material.roughness.texture), (0.3, None));
    assert_eq!(warnings(&imported), ["map_Ns beside Pr is dropped"]);
}

#[test]
fn channels_and_filters_are_as_written() {
    let (material, imported) = mapped("map_d -imfchan l green.png\nmap_Pr -blendu off -blendv off grey.png");
    let (opacity, roughness) = (material.opacity.texture.unwrap(), material.roughness.texture.unwrap());
    assert_eq!((opacity.channel, roughness.channel), (Channel::L, Channel::R));
    assert_eq!(imported.scene.textures[roughness.texture].filter, Filter::Nearest);
    assert_eq!(imported.scene.textures[opacity.texture].wrap_u, Wrap::Repeat);
    assert_eq!(mapped("map_d -imfchan g green.png").0.opacity.texture.unwrap().channel, Channel::G);
    assert!(warnings(&imported).is_empty());
    assert!(warnings(&mapped("map_Kd -t 0 0 0 -cc off -blendu on grey.png").1).is_empty());
}

/// What cannot be shown is named, each with its line.
#[test]
fn what_is_not_shown_is_named_at_its_line() {
    let (_, imported) = mapped(
        "disp grey.png\ndecal grey.png\nrefl -type sphere grey.png\nmap_aat on\n\
         map_Kd -t 1 1 1 -boost 2 -texres 256 -cc on -blendu off -imfchan z grey.png",
    );
    let warnings = imported.diagnostics.iter().filter(|d| d.severity == Severity::Warning);
    let mut said: Vec<_> = warnings.map(|d| (d.place.unwrap().0, d.message.clone())).collect();
    said.sort();
    let dropped = |line: usize, message: &str| (line, message.to_owned());
    let mut wanted = vec![
        dropped(2, "statement \"disp\" is dropped: surfaces are not displaced"),
        dropped(3, "statement \"decal\" is dropped: there is no mask between Kd and map_Kd"),
        dropped(4, "statement \"refl\" is dropped: surfaces reflect the scene itself"),
        dropped(5, "statement \"map_aat\" is dropped: all textures are smoothed by samples"),
        dropped(6, "map_Kd blends texels one way only; taken as both"),
    ];
    wanted.extend(
        ["-t", "-boost", "-texres", "-cc", "-imfchan"]
            .map(|option| dropped(6, &format!("option {option} of map_Kd is dropped"))),
    );
    wanted.sort();
    assert_eq!(said, wanted);
}

#[test]
fn images_that_cannot_be_made_cost_only_their_map() {
    for (statement, name) in [("bump bad.png", "map_Bump"), ("map_Ns bad.png", "map_Ns")] {
        for bytes in [&b""[..], b"\x89PNG\r\n\x1a\n\0\0", b"no image at all"] {
            let library = format!("newmtl m\nNs 30\n{statement}\n");
            let files = [("main.obj", TRIANGLE), ("m.mtl", library.as_bytes()), ("bad.png", bytes)];
            let imported = import(&files).unwrap();
            let material = imported.scene.materials.iter().next().unwrap();
            assert_eq!((material.normal_map, material.roughness.texture), (None, None));
            assert!((material.roughness.value - 0.5).abs() < 1e-6);
            let said = warnings(&imported);
            assert!(said.len() == 1 && said[0].starts_with(&format!("{name}: \"bad.png\" ")), "{said:?}");
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("main.obj");
    fs::write(&path, TRIANGLE).unwrap();
    fs::write(folder.path().join("m.mtl"), "newmtl m\nbump ramp.png\n").unwrap();
    let [ramp, ..] = images();
    fs::write(folder.path().join(ramp.0), ramp.1).unwrap();
    let imported = Obj.import(&ImportRequest { memory_limit: 3000, ..ImportRequest::new(path) }).unwrap();
    assert_eq!(warnings(&imported), ["map_Bump: \"ramp.png\" is larger than the memory limit allows"]);
}
