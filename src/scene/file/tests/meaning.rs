//! What right files mean.

use std::{f64::consts::PI, path::PathBuf, time::Duration};

use glam::{DMat3, DVec3, Vec3};

use super::{super::placement::rotation, folder, import, read, right};
use crate::{
    AlphaMode, Channel, ColorSpace, Filter, ImageSource, ImportRequest, LightKind, Node, OutputSettings,
    Overrides, Projection, RenderSettings, SceneFile, Severity, Wrap,
};

fn close(a: DVec3, b: DVec3) -> bool {
    a.distance(b) < 1e-12
}

fn node<'a>(file: &'a SceneFile, name: &str) -> &'a Node {
    file.scene.nodes.iter().find(|node| node.name == name).unwrap()
}

#[test]
fn empty() {
    let file = right("", &[]);
    assert_eq!(file.scene, crate::Scene::default());
    assert_eq!((file.render, file.output), (RenderSettings::default(), OutputSettings::default()));
    assert_eq!(file.diagnostics, []);
    assert_eq!(file.files.len(), 1);
}

#[test]
fn settings() {
    let file = right(
        "[render]\nintegrator = \"bdpt\"\nsize = [640, 480]\nspp = 0x10\nrounds = 7\ntime = \"1h30m\"\nnoise = \"2%\"\n\
         seed = 5\nmax_depth = 3\ncrop = [0, 0.5, 0.25, 1]\nmutations = { lens = 1, window = 0.5 }\n\
         mutation_choice = \"equal\"\nchain_length = 99\nlens_subpaths = \"list\"\n\
         [output]\npath = \"a.exr\"\npng = \"b.png\"\ntone_map = \"aces\"\nexposure = -1\naov = [\"depth\"]\nfloat = true\n",
        &[],
    );
    let render = RenderSettings {
        integrator: Some("bdpt".into()),
        camera: None,
        size: Some([640, 480]),
        spp: Some(16),
        rounds: Some(7),
        time: Some(Duration::from_secs(5400)),
        noise: Some(0.02),
        seed: Some(5),
        max_depth: Some(3),
        crop: Some([0.0, 0.5, 0.25, 1.0]),
        mutations: [("lens".into(), 1.0), ("window".into(), 0.5)].into(),
        mutation_choice: Some("equal".into()),
        chain_length: Some(99),
        lens_subpaths: Some("list".into()),
    };
    let output = OutputSettings {
        path: Some("a.exr".into()),
        png: Some("b.png".into()),
        tone_map: Some("aces".into()),
        exposure: Some(-1.0),
        aov: Some(vec!["depth".into()]),
        float: Some(true),
    };
    assert_eq!((file.render, file.output), (render, output));
    assert_eq!(right("[render]\ntime = 90\nnoise = 0.5", &[]).render.time, Some(Duration::from_secs(90)));
}

#[test]
fn imports_are_placed() {
    let file = right(
        "[[import]]\nfile = \"a.glb\"\n[[import]]\nfile = \"sub/b.obj\"\nname = \"two\"\nup = \"z\"\nunit = 0.01\n\
         scale = [2, 3, 4]\nrotate = [0, 90, 0]\ntranslate = [1, 2, 3]\n",
        &["a.glb", "sub/b.obj"],
    );
    assert_eq!(node(&file, "a").transform, glam::DAffine3::IDENTITY);
    // z-up point (x, y, z) → (x, z, −y), in centimetres, scaled, a quarter turn about Y takes X to −Z and Z to X.
    let world = node(&file, "two").transform.transform_point3(DVec3::new(100.0, 200.0, 300.0));
    assert!(close(world, DVec3::new(1.0 - 8.0, 2.0 + 9.0, 3.0 - 2.0)), "{world}");

    // Both copies kept their own meshes, materials, textures and lights.
    let scene = &file.scene;
    assert_eq!(
        (scene.meshes.len(), scene.materials.len(), scene.textures.len(), scene.lights.len()),
        (2, 4, 2, 2)
    );
    let placed = scene.placed();
    assert_eq!(placed.iter().map(|p| &p.node.name[..]).collect::<Vec<_>>(), ["a", "part", "two", "part"]);
    let second = placed[3].node;
    assert_eq!(second.meshes[0].index(), 1);
    assert_eq!(scene.meshes[second.meshes[0]].material.unwrap().index(), 2);
    assert_eq!(scene.materials.iter().last().unwrap().roughness.texture.unwrap().texture.index(), 1);
    assert_eq!(scene.textures.iter().last().unwrap().image.index(), 1);
    let light = &scene.lights[second.light.unwrap()];
    assert!(matches!(light.kind, LightKind::Rect { texture: Some(id), .. } if id.index() == 1));
    assert!(scene.validate().is_empty(), "{:?}", scene.validate());

    assert_eq!(file.diagnostics.len(), 2);
    assert!(file.diagnostics.iter().all(|it| it.severity == Severity::Warning));
    let names: Vec<_> = file.files.iter().map(|path| path.file_name().unwrap().to_owned()).collect();
    assert_eq!(names, ["scene.toml", "a.glb", "a.bin", "b.obj", "b.bin"]);
}

/// An asset may use files anywhere below the scene file's folder.
#[test]
fn imports_may_read_the_scene_folder() {
    let folder = folder("[[import]]\nfile = \"sub/a.glb\"\n", &["sub/a.glb", "textures/t.png"]);
    let file = super::load(
        &ImportRequest::new(folder.path().join("scene.toml")),
        &Overrides::default(),
        &|request| {
            request.resolve("../textures/t.png")?;
            import(request)
        },
    );
    assert!(file.is_ok(), "{file:?}");
}

#[test]
fn rotations() {
    for (degrees, from, to) in [
        ([90.0, 0.0, 0.0], DVec3::Y, DVec3::Z),
        ([0.0, 90.0, 0.0], DVec3::Z, DVec3::X),
        ([0.0, 0.0, 90.0], DVec3::X, DVec3::Y),
        ([-90.0, 0.0, 0.0], DVec3::Z, DVec3::Y),
        // X first: Y goes to Z, which the turn about Y takes to X, which the turn about Z takes to Y.
        ([90.0, 90.0, 90.0], DVec3::Y, DVec3::Y),
        ([90.0, 0.0, 90.0], DVec3::Y, DVec3::Z),
        ([450.0, -270.0, 0.0], DVec3::Y, DVec3::X),
    ] {
        assert_eq!(rotation(degrees.into()) * from, to, "{degrees:?}");
    }
    let r = rotation(DVec3::new(10.0, 20.0, 30.0));
    let [x, y, z] = [10.0_f64, 20.0, 30.0].map(f64::to_radians);
    let expected = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
    assert!(r.abs_diff_eq(expected, 1e-15));
}

#[test]
fn cameras() {
    let file = right(
        "[[camera]]\nname = \"main\"\nposition = [1, 2, 3]\ntarget = [4, 2, 3]\nyfov = 90\nlens_radius = 0.1\nshift = [0, 0.5]\n\
         [[camera]]\nposition = [0, 5, 0]\ntarget = [0, 0, 0]\nhalf_height = 2\nexposure = 3\n[[camera]]\n",
        &[],
    );
    let main = node(&file, "main").transform;
    assert!(close(main.transform_vector3(DVec3::NEG_Z), DVec3::X));
    assert!(close(main.transform_vector3(DVec3::Y), DVec3::Y));
    assert!(close(main.transform_vector3(DVec3::X), DVec3::Z));
    assert_eq!(main.translation, DVec3::new(1.0, 2.0, 3.0));
    let cameras: Vec<_> = file.scene.cameras.iter().collect();
    let Projection::Perspective { yfov, lens_radius, focus_distance, shift } = cameras[0].projection else {
        panic!()
    };
    assert_eq!((yfov, lens_radius, focus_distance, shift), ((PI / 2.0) as f32, 0.1, 3.0, [0.0, 0.5]));

    // Straight down, with no up said: −Z of the world is up in the image, as on a map.
    let down = node(&file, "camera 2").transform;
    assert!(close(down.transform_vector3(DVec3::NEG_Z), DVec3::NEG_Y));
    assert!(close(down.transform_vector3(DVec3::Y), DVec3::NEG_Z));
    assert!((down.matrix3.determinant() - 1.0).abs() < 1e-12);
    assert_eq!(cameras[1].projection, Projection::Orthographic { half_height: 2.0 });
    assert_eq!(cameras[1].exposure, 3.0);
    assert_eq!(node(&file, "camera 3").transform, glam::DAffine3::IDENTITY);
}

#[test]
fn lights() {
    let file = right(
        "[[light]]\nname = \"key\"\ntype = \"rect\"\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nradiance = 100\nwidth = 2\n\
         texture = \"sky.HDR\"\ncolor = [1, 0.5, 0]\n\
         [[light]]\ntype = \"spot\"\ndirection = [1, 0, 0]\nintensity = 5\n\
         [[light]]\ntype = \"directional\"\nrotate = [-90, 0, 0]\nilluminance = 3\n\
         [[light]]\ntype = \"environment\"\nrotate = [0, 90, 0]\ntexture = { file = \"sky.HDR\", wrap = \"clamp\" }\n\
         [[light]]\ntype = \"cylinder\"\nlength = 4\n[[light]]\ntype = \"sphere\"\n[[light]]\ntype = \"disk\"\n[[light]]\ntype = \"point\"\n",
        &["sky.HDR"],
    );
    let scene = &file.scene;
    for (name, forward) in
        [("key", DVec3::NEG_Y), ("light 2", DVec3::X), ("light 3", DVec3::NEG_Y), ("light 4", DVec3::NEG_X)]
    {
        assert!(close(node(&file, name).transform.transform_vector3(DVec3::NEG_Z), forward), "{name}");
    }
    let kinds: Vec<_> = scene.lights.iter().map(|light| light.kind.clone()).collect();
    assert!(matches!(
        kinds[0],
        LightKind::Rect { radiance: 100.0, width: 2.0, height: 1.0, texture: Some(_) }
    ));
    let LightKind::Spot { intensity, inner, outer } = kinds[1] else { panic!() };
    assert_eq!((intensity, inner, outer), (5.0, 20_f64.to_radians() as f32, 30_f64.to_radians() as f32));
    assert_eq!(kinds[2], LightKind::Directional { illuminance: 3.0, angle: 0.53_f64.to_radians() as f32 });
    assert_eq!(kinds[4], LightKind::Cylinder { radiance: 1.0, radius: 1.0, length: 4.0 });
    assert_eq!(scene.lights.iter().next().unwrap().color, Vec3::new(1.0, 0.5, 0.0));
    // One image, two ways to read it, both raw because HDR files hold light.
    assert_eq!((scene.images.len(), scene.textures.len()), (1, 2));
    assert!(scene.textures.iter().all(|texture| texture.color_space == ColorSpace::Raw));
    assert!(scene.validate().is_empty());
}

#[test]
fn materials() {
    let file = right(
        "[[import]]\nfile = \"a.glb\"\n[[import]]\nfile = \"b.glb\"\n\
         [material.\"*\"]\nroughness = 0.2\nnormal_scale = 3\n\
         [material.Chrome]\nbase_color_texture = \"wood.png\"\nmetallic = 1\n\
         metallic_texture = { file = \"wood.png\", channel = \"a\", filter = \"nearest\", wrap = \"mirror\", uv_set = 1 }\n\
         normal_texture = \"wood.png\"\nattenuation_distance = inf\nanisotropy_rotation = 180\nalpha_mode = \"mask\"\n\
         alpha_cutoff = 0.25\nthin_walled = true\nemission = [0, 5, 0]\n\
         [material.\"Gl?ss\"]\nroughness_texture = \"wood.png\"\nattenuation_distance = 2\n[material.\"Q*\"]\n",
        &["a.glb", "b.glb", "wood.png"],
    );
    let scene = &file.scene;
    let [chrome, glass, chrome_b, glass_b] = &scene.materials.iter().collect::<Vec<_>>()[..] else {
        panic!()
    };
    assert_eq!((chrome_b.base_color, glass_b.roughness), (chrome.base_color, glass.roughness));
    assert_eq!((chrome.roughness.value, chrome.roughness.texture), (0.2, None));
    assert_eq!(chrome.base_color.value, Vec3::ONE);
    let base = &scene.textures[chrome.base_color.texture.unwrap().texture];
    assert_eq!(base.color_space, ColorSpace::Srgb);
    let metallic = chrome.metallic.texture.unwrap();
    assert_eq!((chrome.metallic.value, metallic.channel), (1.0, Channel::A));
    let metallic = &scene.textures[metallic.texture];
    assert_eq!(
        (metallic.color_space, metallic.filter, metallic.wrap_u, metallic.wrap_v, metallic.uv_set),
        (ColorSpace::Raw, Filter::Nearest, Wrap::Mirror, Wrap::Mirror, 1)
    );
    let normal = chrome.normal_map.unwrap();
    assert_eq!((normal.scale, scene.textures[normal.texture].color_space), (1.0, ColorSpace::Raw));
    assert_eq!(chrome.attenuation_distance, f32::INFINITY);
    assert_eq!(chrome.anisotropy_rotation, PI as f32);
    assert_eq!(chrome.alpha_mode, AlphaMode::Mask(0.25));
    assert!(chrome.thin_walled);
    assert_eq!(chrome.emission.value, Vec3::new(0.0, 5.0, 0.0));
    // The later table wins: its texture stands alone.
    assert_eq!(glass.roughness.value, 1.0);
    assert_eq!(scene.textures[glass.roughness.texture.unwrap().texture].color_space, ColorSpace::Raw);
    assert_eq!(glass.attenuation_distance, 2.0);
    assert_eq!((glass.normal_map, glass.base_color.texture), (None, None));
    // Two embedded images, wood.png once.
    let files: Vec<_> = scene.images.iter().filter(|it| matches!(it.source, ImageSource::File(_))).collect();
    assert_eq!(files.len(), 1);
    let warnings: Vec<_> = file.diagnostics.iter().map(|it| it.message.as_str()).collect();
    assert_eq!(
        warnings,
        ["no imported material fits this pattern", "something was dropped", "something was dropped"]
    );
}

/// The same text in two folders is the same scene by content, and a changed texture changes it.
#[test]
fn hash_follows_content() {
    let toml = "[[light]]\ntype = \"environment\"\ntexture = \"sky.hdr\"\n";
    let folders = [folder(toml, &["sky.hdr"]), folder(toml, &["sky.hdr"])];
    let hash = |index: usize| read(folders[index].path()).unwrap().scene.content_hash();
    assert_eq!(hash(0), hash(1));
    std::fs::write(folders[1].path().join("sky.hdr"), "other light").unwrap();
    assert_ne!(hash(0), hash(1));
    let path = |index: usize| PathBuf::from(folders[index].path());
    assert_ne!(path(0), path(1));
}
